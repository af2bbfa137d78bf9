// SPDX-License-Identifier: Apache-2.0
#include "server/rehearsal/recorded_firings.hpp"

#include "telemetry/packet_stream.hpp"
#include "telemetry/text.hpp"

#include <fmt/format.h>

namespace aeolis::server {
namespace {

constexpr const char* firing_packet_name = "TimepointFired";

}  // namespace

RecordedFirings::RecordedFirings(const dictionary::Dictionary& dictionary)
    : dictionary_(&dictionary), packet_(dictionary.packet(firing_packet_name)), decommutator_(dictionary) {}

void RecordedFirings::read(std::span<const std::uint8_t> recorded) {
    if (recorded.empty() || packet_ == nullptr) return;
    telemetry::PacketStream packets{recorded};
    while (const auto packet = packets.next()) {
        const auto header = read_primary_header(*packet);
        if (!header || header->apid != packet_->apid || decommutator_.decode(*packet, decoded_)) continue;
        const auto value = [&](std::string_view name) {
            const auto field = telemetry::field_index(*packet_, name);
            return field ? decoded_.value[*field] : std::nullopt;
        };
        const auto timepoint = value("timepoint"), triggered = value("triggered_sclk"), fired = value("fired_sclk");
        const auto verdict = telemetry::field_index(*packet_, "verdict");
        if (!timepoint || !triggered || !fired || !verdict) continue;
        const auto row = static_cast<std::size_t>(*timepoint);
        const auto& timeline = dictionary_->timeline;
        firings_.push_back({row < timeline.size() ? timeline[row].name : fmt::format("timepoint {}", row), *fired,
                            telemetry::number_text(packet_->fields[*verdict].type, decoded_.value[*verdict]), row,
                            *triggered});
    }
}

}  // namespace aeolis::server
