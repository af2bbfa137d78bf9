// SPDX-License-Identifier: Apache-2.0
#include "server/archive/records.hpp"

#include "server/archive/item_tables.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace aeolis::archive {

namespace {
constexpr std::array<const char*, procedure_act_kinds> act_names{"begin", "tick", "sign",    "choose",      "skip",
                                                                 "sent",  "hold", "release", "acknowledge", "stop"};
constexpr std::array<const char*, position_act_kinds> position_act_names{"take", "offer", "leave",
                                                                         "poll", "go",    "no_go"};
constexpr std::array verdict_names{"unknown", "completed", "verified", "unverified", "no_operation", "refused"};
}  // namespace

const char* name_of(FiringVerdict verdict) {
    return verdict_names[static_cast<std::size_t>(verdict)];
}

FiringVerdict firing_verdict(std::string_view word) {
    const auto found = std::ranges::find(verdict_names, word);
    return found == verdict_names.end() ? FiringVerdict::unknown
                                        : static_cast<FiringVerdict>(found - verdict_names.begin());
}

const char* name_of(ProcedureActKind kind) {
    return act_names[static_cast<std::size_t>(kind)];
}

std::optional<ProcedureActKind> procedure_act_kind(std::string_view name) {
    const auto found = std::ranges::find(act_names, name);
    if (found == act_names.end()) return std::nullopt;
    return static_cast<ProcedureActKind>(found - act_names.begin());
}

const char* name_of(PositionActKind kind) {
    return position_act_names[static_cast<std::size_t>(kind)];
}

std::optional<PositionActKind> position_act_kind(std::string_view name) {
    const auto found = std::ranges::find(position_act_names, name);
    if (found == position_act_names.end()) return std::nullopt;
    return static_cast<PositionActKind>(found - position_act_names.begin());
}

const char* name_of(Outcome outcome) {
    constexpr std::array names{"running", "touchdown", "impact", "lost", "not_commanded", "timeout", "stopped"};
    return names[static_cast<std::size_t>(outcome)];
}

void Extremes::add(const Extremes& later) {
    if (later.defined == 0) return;
    if (defined == 0 || later.least < least) {
        least = later.least;
        least_sclk_s = later.least_sclk_s;
    }
    if (defined == 0 || later.largest > largest) {
        largest = later.largest;
        largest_sclk_s = later.largest_sclk_s;
    }
    defined += later.defined;
}

void Batch::add(Annotation annotation) {
    std::visit(
        [this]<typename Record>(Record& record) { (this->*ItemTable<Record>::of_batch).push_back(std::move(record)); },
        annotation);
}

void Batch::clear() {
    first_seq = last_seq = 0;
    octets.clear();
    values.clear();
    samples.clear();
    for_item_kinds([this]<typename Record>(ItemKind<Record>) { (this->*ItemTable<Record>::of_batch).clear(); });
    segments.clear();
    requests.clear();
    pyramid.clear();
    totals.reset();
    link_totals.clear();
    raw.clear();
    raw_octets = 0;
    end.reset();
}

}  // namespace aeolis::archive
