// SPDX-License-Identifier: Apache-2.0
// What a client asks for, as a command of the shipped dictionary: it is refused in words, or it reads back as it was
// meant. Then the same octets as an uplinked packet.
#include "commands/encoder.hpp"

#include <cstdlib>
#include <cstring>

namespace {

using namespace aeolis;

const dictionary::Dictionary& mission() {
    static const auto loaded = dictionary::load(AEOLIS_SOURCE_DIR "/dictionaries/msl");
    if (!loaded.dictionary) std::abort();
    return *loaded.dictionary;
}

/// Nine octets a value: the first chooses the argument (or a name that there is not), the others are the double.
std::vector<commands::NamedValue> arguments_of(const dictionary::Command& command, std::span<const std::uint8_t> data) {
    std::vector<commands::NamedValue> arguments;
    for (; data.size() >= 9 && arguments.size() < 64; data = data.subspan(9)) {
        double value = 0.0;
        std::memcpy(&value, data.data() + 1, sizeof value);
        const std::size_t index = data[0] % (command.arguments.size() + 1);
        arguments.push_back({index < command.arguments.size() ? command.arguments[index].name : "no_such", value});
    }
    return arguments;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    const auto& command = mission().commands[data[0] % mission().commands.size()];
    const auto arguments = arguments_of(command, {data + 1, size - 1});
    const auto packet = commands::encode(command, arguments, 0);
    if (!packet && packet.error().message.empty()) std::abort();
    if (packet) {
        const auto back = commands::decode(command, *packet);
        if (!back) std::abort();
        const auto again = commands::encode(command, *back, 0);
        if (!again || *again != *packet) std::abort();
    }
    (void)commands::decode(command, {data, size});
    return 0;
}
