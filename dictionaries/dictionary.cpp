// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/dictionary.hpp"

#include "common/check.hpp"

#include <algorithm>

namespace aeolis::dictionary {
namespace {

template <typename T, typename Fits>
const T* first(const std::vector<T>& all, Fits fits) {
    const auto found = std::ranges::find_if(all, fits);
    return found == all.end() ? nullptr : &*found;
}

}  // namespace

bool Precondition::holds(double latest) const {
    if (comparison == "==") return latest == value;
    if (comparison == "!=") return latest != value;
    if (comparison == "<") return latest < value;
    if (comparison == "<=") return latest <= value;
    if (comparison == ">") return latest > value;
    AEOLIS_CHECK(comparison == ">=");  // the loader accepts no other
    return latest >= value;
}

const Channel* Dictionary::channel(std::string_view name_or_alias) const {
    return first(channels, [&](const Channel& c) { return c.name == name_or_alias || c.alias == name_or_alias; });
}
const Command* Dictionary::command(std::string_view name) const {
    return first(commands, [&](const Command& c) { return c.name == name; });
}
const Command* Dictionary::command(Opcode opcode) const {
    return first(commands, [&](const Command& c) { return c.opcode == opcode; });
}
const Event* Dictionary::event(EvrId wanted) const {
    return first(events, [&](const Event& e) { return e.id == wanted; });
}
const Event* Dictionary::event(std::string_view name) const {
    return first(events, [&](const Event& e) { return e.name == name; });
}
const ClockCorrelation* Dictionary::clock_at(Sclk t) const {
    const auto after = std::ranges::find_if(clock, [&](const ClockRow& row) { return row.valid_from > t; });
    return after == clock.begin() ? nullptr : &std::prev(after)->correlation;
}

const Packet* Dictionary::packet(std::string_view name) const {
    return first(packets, [&](const Packet& p) { return p.name == name; });
}

bool needs_text(const Type& type) {
    constexpr unsigned exact_bits = 53;  // of a double
    if (type.kind == ValueKind::text) return true;
    return type.kind == ValueKind::integer && type.calibrator.empty() && type.bits > exact_bits;
}

std::optional<std::size_t> field_index(const Packet& packet, std::string_view name) {
    for (std::size_t i = 0; i < packet.fields.size(); ++i)
        if (packet.fields[i].name == name) return i;
    return std::nullopt;
}

std::string Finding::text() const {
    return file + ":" + std::to_string(line) + ": " + message;
}

}  // namespace aeolis::dictionary
