// SPDX-License-Identifier: Apache-2.0
#include "server/procedures/procedure.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace aeolis::server::procedures {
namespace {

constexpr std::array comparisons{Comparison::equal,   Comparison::unequal, Comparison::less,
                                 Comparison::at_most, Comparison::greater, Comparison::at_least};

}  // namespace

std::string_view name_of(Position position) {
    switch (position) {
    case Position::flight_director: return "flight_director";
    case Position::command: return "command";
    case Position::edl_communications: return "edl_communications";
    case Position::gnc: return "gnc";
    case Position::navigation: return "navigation";
    case Position::relay_and_station: return "relay_and_station";
    case Position::systems: return "systems";
    }
    return "";
}

std::optional<Position> position_named(std::string_view name) {
    for (const Position position : positions)
        if (name_of(position) == name) return position;
    return std::nullopt;
}

std::string_view name_of(EntryTime::Where where) {
    switch (where) {
    case EntryTime::Where::vehicle: return "vehicle";
    case EntryTime::Where::sent: return "sent";
    case EntryTime::Where::received: return "received";
    }
    return "";
}

std::string text_of(const EntryTime& time) {
    constexpr std::int64_t minute_ms = 60'000, hour_ms = 60 * minute_ms;
    const auto all_ms = static_cast<std::int64_t>(std::llround(std::abs(time.e_s) * 1000.0));
    std::string text = time.e_s < 0.0 ? "E\u2212" : "E+";
    if (all_ms >= hour_ms)
        text += fmt::format("{}:{:02}", all_ms / hour_ms, all_ms % hour_ms / minute_ms);
    else
        text += fmt::format("{}", all_ms / minute_ms);
    text += fmt::format(":{:02}", all_ms % minute_ms / 1000);
    if (all_ms % 1000 != 0) text += fmt::format(".{:03}", all_ms % 1000);
    return fmt::format("{} {}", text, name_of(time.where));
}

std::string_view name_of(Comparison comparison) {
    switch (comparison) {
    case Comparison::equal: return "==";
    case Comparison::unequal: return "!=";
    case Comparison::less: return "<";
    case Comparison::at_most: return "<=";
    case Comparison::greater: return ">";
    case Comparison::at_least: return ">=";
    }
    return "";
}

std::optional<Comparison> comparison_named(std::string_view name) {
    for (const Comparison comparison : comparisons)
        if (name_of(comparison) == name) return comparison;
    return std::nullopt;
}

bool holds(Comparison comparison, double left, double right) {
    switch (comparison) {
    case Comparison::equal: return left == right;
    case Comparison::unequal: return left != right;
    case Comparison::less: return left < right;
    case Comparison::at_most: return left <= right;
    case Comparison::greater: return left > right;
    case Comparison::at_least: return left >= right;
    }
    return false;
}

std::string_view name_of(Since since) {
    switch (since) {
    case Since::run: return "run";
    case Since::procedure: return "procedure";
    case Since::step: return "step";
    }
    return "";
}

const std::string& text_now(const Procedure& procedure, const Step& step) {
    const auto last = std::find_if(procedure.redlines.rbegin(), procedure.redlines.rend(), [&](const Redline& redline) {
        return redline.step == step.id && !redline.approved_by.empty();
    });
    return last == procedure.redlines.rend() ? step.text : last->text;
}

}  // namespace aeolis::server::procedures
