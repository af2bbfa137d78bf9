// SPDX-License-Identifier: Apache-2.0
#include "telemetry/station/link_ledger.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <string_view>

namespace aeolis::telemetry {

void merge(LinkTotals& into, LinkTotals later) {
    auto sequences = std::move(into.sequences);
    std::map<std::pair<bool, std::string>, std::size_t> places;
    if (!later.sequences.empty())
        for (std::size_t i = 0; i < sequences.size(); ++i) places[{sequences[i].packets, sequences[i].name}] = i;
    for (auto& each : later.sequences) {
        const auto [place, is_new] = places.try_emplace({each.packets, each.name}, sequences.size());
        if (is_new)
            sequences.push_back(std::move(each));
        else
            sequences[place->second].counters = each.counters;
    }
    into = std::move(later);
    into.sequences = std::move(sequences);
}

void LinkLedger::received(Ert ert, std::size_t octets) {
    octets_ += octets;
    rate_.add(ert, octets);
}

void LinkLedger::end(const PacketSource& source) {
    ended_ += source.link();
    ended_packets_ += source.packets();
    ended_pointers_ += source.pointers();
    for (const auto& sequence : source.sequences())
        sequences_[row_of({sequence.packets, sequence.name})].ended += sequence.counters;
}

/// The row that a sequence is counted in, always the same: its own, or that of the others.
LinkLedger::Key LinkLedger::row_of(Key name) {
    constexpr std::size_t rows_of_others = 2;
    for (const bool packets : {false, true}) sequences_.try_emplace({packets, other_sequences});
    const bool room = sequences_.size() < sequences_named_max + rows_of_others;
    if (!room && !sequences_.contains(name)) name.second = other_sequences;
    return name;
}

LinkTotals LinkLedger::totals(const PacketSource* source, Ert now) {
    LinkTotals totals{link_, ended_, rate_.per_second(now), ended_packets_, bad_datagrams_, {}, ended_pointers_};
    std::map<Key, SequenceCounters> of_source;
    if (source != nullptr) {
        totals.counters += source->link();
        totals.packets += source->packets();
        totals.pointers += source->pointers();
        for (const auto& each : source->sequences()) {
            const auto row = row_of({each.packets, each.name});
            sequences_.try_emplace(row);
            of_source[row] += each.counters;
        }
    }
    totals.counters.octets = octets_;
    for (auto& [key, sequence] : sequences_) {
        auto counters = sequence.ended;
        if (const auto more = of_source.find(key); more != of_source.end()) counters += more->second;
        if (sequence.told == counters) continue;
        sequence.told = counters;
        totals.sequences.push_back({key.second, key.first, counters});
    }
    return totals;
}

bool LinkLedger::changed(const LinkTotals& totals) {
    const bool same = last_ && totals.sequences.empty() && last_->counters == totals.counters &&
                      last_->packets == totals.packets && last_->bad_datagrams == totals.bad_datagrams &&
                      last_->octets_per_s == totals.octets_per_s;
    last_ = totals;
    return !same;
}

bool LinkLedger::heard_sequences() const {
    return std::ranges::any_of(sequences_, [](const auto& row) { return row.second.ended != SequenceCounters{}; });
}

std::string LinkLedger::faults_since(const LinkTotals& totals) {
    const auto& link = totals.counters;
    const auto& packets = totals.packets;
    const std::array<std::pair<std::string_view, std::uint64_t>, 14> faults{
        {{"frames with a wrong CRC", link.bad_crc},
         {"frames with a wrong header", link.bad_header},
         {"frames that Reed-Solomon could not correct", link.uncorrectable_frames},
         {"frames missing", link.missing_frames},
         {"frames cut off", link.cut_frames},
         {"frames late", link.late_frames},
         {"restarts of a count", link.restarts},
         {"slips of bits", link.slips},
         {"frames whose data are not packets", link.other_data_frames},
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

}  // namespace aeolis::telemetry
