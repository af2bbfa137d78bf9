// SPDX-License-Identifier: Apache-2.0
#include "commands/number.hpp"

#include "common/bytes.hpp"

#include <bit>
#include <charconv>
#include <cstdio>

namespace aeolis::commands {

std::string shortest_text(double value) {
    char buffer[40];
    return {buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr};
}

std::string text_of(Sclk time) {
    char buffer[48];
    std::snprintf(buffer, sizeof buffer, "%.3f", time.seconds);
    return buffer;
}

double number_of(const dictionary::Type& type, std::uint64_t word) {
    switch (type.encoding) {
    case dictionary::Encoding::unsigned_integer: return static_cast<double>(word);
    case dictionary::Encoding::twos_complement: return static_cast<double>(sign_extend(word, type.bits));
    case dictionary::Encoding::ieee754:
        AEOLIS_CHECK(type.bits == 32 || type.bits == 64);
        return type.bits == 32 ? static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(word)))
                               : std::bit_cast<double>(word);
    }
    return 0.0;
}

}  // namespace aeolis::commands
