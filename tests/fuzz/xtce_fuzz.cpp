// SPDX-License-Identifier: Apache-2.0
// An XTCE file as anyone may have left it, to our own dictionary's reader and to that of other missions: what is wrong
// is said with a line of the text; what is left decodes any octets. The first octet says where in the text a packet
// begins.
#include "dictionaries/xtce/packet_model.hpp"
#include "dictionaries/xtce/space_system.hpp"
#include "telemetry/other_mission.hpp"

#include <algorithm>
#include <cstdlib>
#include <string>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace aeolis;
    if (size == 0) return 0;
    const std::string text{data + 1, data + size};
    const auto lines = static_cast<unsigned>(std::ranges::count(text, '\n')) + 1;
    std::vector<dictionary::Finding> all;
    dictionary::Findings findings{"t.xml", all};
    const auto ours = dictionary::xtce::read_space_system(text, findings);
    if (!ours && all.empty()) std::abort();  // refused without a reason
    const auto model = dictionary::xtce::read_packet_model(text, findings);
    for (const auto& finding : all)
        if (finding.line < 1 || finding.line > lines || finding.message.empty()) std::abort();
    if (!model) return 0;
    const telemetry::ContainerDecoder decoder{*model};
    const std::size_t start = std::min<std::size_t>(data[0] * 16U, text.size());
    const auto contents = decoder.decode(std::span{data + 1 + start, text.size() - start});
    for (const auto& value : contents.values) (void)telemetry::datum_text(value.calibrated);
    const telemetry::OtherMission mission{*model, 1};
    telemetry::Decoded decoded;
    const std::span packet{data + 1 + start, text.size() - start};
    if (mission.decode(packet, decoded)) return 0;
    const auto& fields = mission.dictionary().packets[decoded.packet].fields;
    if (decoded.value.size() != fields.size()) std::abort();
    // Compiled or not, the values are those of the decoder of all containers.
    const auto whole = mission.contents(packet);
    if (decoded.packet != whole.container_index || decoded.timed != whole.time.has_value()) std::abort();
    std::size_t defined = 0, in_contents = 0;
    for (const auto& value : decoded.value) defined += value ? 1 : 0;
    for (const auto& value : whole.values)
        in_contents += std::holds_alternative<std::monostate>(value.calibrated) ? 0 : 1;
    if (defined > in_contents) std::abort();
    return 0;
}
