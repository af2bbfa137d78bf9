// SPDX-License-Identifier: Apache-2.0
#include "server/links/link_ledger.hpp"

#include <array>
#include <fmt/format.h>
#include <string_view>

namespace aeolis::server {

void LinkLedger::received(Ert ert, std::size_t octets) {
    octets_ += octets;
    rate_.add(ert, octets);
}

void LinkLedger::end(const telemetry::PacketSource& source) {
    ended_ += source.link();
    ended_packets_ += source.packets();
    for (const auto& sequence : source.sequences())
        ended_sequences_[{sequence.packets, sequence.name}] += sequence.counters;
}

archive::LinkTotals LinkLedger::totals(const telemetry::PacketSource* source, Ert now) {
    archive::LinkTotals totals{link_, ended_, rate_.per_second(now), ended_packets_, bad_datagrams_, {}};
    Sequences sequences = ended_sequences_;
    if (source != nullptr) {
        totals.counters += source->link();
        totals.packets += source->packets();
        for (const auto& each : source->sequences()) sequences[{each.packets, each.name}] += each.counters;
    }
    totals.counters.octets = octets_;
    for (const auto& [key, counters] : sequences) {
        auto& told = told_[key];
        if (told == counters) continue;
        told = counters;
        totals.sequences.push_back({key.second, key.first, counters});
    }
    return totals;
}

bool LinkLedger::changed(const archive::LinkTotals& totals) {
    const bool same = last_ && totals.sequences.empty() && last_->counters == totals.counters &&
                      last_->packets == totals.packets && last_->bad_datagrams == totals.bad_datagrams &&
                      last_->octets_per_s == totals.octets_per_s;
    last_ = totals;
    return !same;
}

std::string LinkLedger::faults_since(const archive::LinkTotals& totals) {
    const auto& link = totals.counters;
    const auto& packets = totals.packets;
    const std::array<std::pair<std::string_view, std::uint64_t>, 13> faults{
        {{"frames with a wrong CRC", link.bad_crc},
         {"frames with a wrong header", link.bad_header},
         {"frames that Reed-Solomon could not correct", link.uncorrectable_frames},
         {"frames missing", link.missing_frames},
         {"frames cut off", link.cut_frames},
         {"frames late", link.late_frames},
         {"restarts of a count", link.restarts},
         {"slips of bits", link.slips},
         {"encapsulation packets not decoded", packets.encapsulation_packets},
         {"packets cut off", packets.cut_packets},
         {"segments without the rest", packets.lost_segments},
         {"octets unreadable", packets.unreadable_octets},
         {"bad datagrams", totals.bad_datagrams}}};
    logged_.resize(faults.size());
    std::string words;
    for (std::size_t i = 0; i < faults.size(); ++i) {
        const auto& [what, number] = faults.at(i);
        if (number > logged_[i]) words += fmt::format("{}{} {}", words.empty() ? "" : ", ", number - logged_[i], what);
        logged_[i] = number;
    }
    return words;
}

}  // namespace aeolis::server
