// SPDX-License-Identifier: Apache-2.0
#include "server/shadow/forecast_report.hpp"

#include "server/base/json_object.hpp"
#include "server/campaign/campaign_report.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <span>

namespace aeolis::server::shadow {
namespace {

using campaign::km;

constexpr double percent = 100.0;

std::string proportion_json(const Proportion& part) {
    return JsonObject{}
        .count("part", part.part)
        .count("of", part.of)
        .number("low_99", part.low)
        .number("high_99", part.high)
        .str();
}

std::string values_json(const Values& values) {
    JsonObject object;
    object.count("count", values.count);
    if (values.count == 0) return object.str();
    object.number("least", values.least)
        .number("median", values.median)
        .number("most", values.most)
        .number("next_between", values.between);
    return object
        .raw("interval_99",
             values.interval_99
                 ? JsonObject{}.number("from", values.interval_99->from).number("to", values.interval_99->to).str()
                 : "null")
        .str();
}

std::string outside_json(const Prospect::Outside& one) {
    return JsonObject{}.count("case", one.number).text("outcome", one.outcome).text("reason", one.reason).str();
}

std::string prospect_json(const Prospect& prospect) {
    JsonObject outcomes;
    for (const auto& [outcome, count] : prospect.outcomes) outcomes.count(outcome, count);
    return JsonObject{}
        .count("cases", prospect.cases)
        .raw("outcomes", outcomes.str())
        .raw("within_limits", proportion_json(prospect.within))
        .raw("events",
             json_array(prospect.events,
                        [](const EventTimes& event) {
                            return JsonObject{}.text("name", event.name).raw("e_s", values_json(event.e_s)).str();
                        }))
        .raw("outside_limits", json_array(prospect.outside, outside_json))
        .raw("ellipse_99", prospect.ellipse_99 ? campaign::ellipse_json(*prospect.ellipse_99) : "null")
        .raw("miss_m", values_json(prospect.miss_m))
        .raw("east_m", values_json(prospect.east_m))
        .raw("north_m", values_json(prospect.north_m))
        .raw("vertical_mps", values_json(prospect.vertical_mps))
        .raw("horizontal_mps", values_json(prospect.horizontal_mps))
        .raw("propellant_kg", values_json(prospect.propellant_kg))
        .raw("peak_deceleration_mps2", values_json(prospect.peak_deceleration_mps2))
        .raw("least_timeline_margin_s", values_json(prospect.least_margin_s))
        .raw("limits", json_array(prospect.limits, campaign::limit_json))
        .str();
}

std::string pairs_json(const Pairs& pairs) {
    return JsonObject{}
        .count("within_both", pairs.within_both)
        .count("within_only_without", pairs.only_without)
        .count("within_only_with", pairs.only_with)
        .count("within_neither", pairs.within_neither)
        .raw("miss_change_m", values_json(pairs.miss_change_m))
        .raw("propellant_change_kg", values_json(pairs.propellant_change_kg))
        .str();
}

// ---- for people ------------------------------------------------------------------------------------------------

std::string cell(const Values& values, int digits, double scale) {
    if (values.count == 0) return "none";
    const auto number = [&](double value) { return fmt::format("{:.{}f}", value * scale, digits); };
    const auto range = values.interval_99 ? fmt::format("{} ... {}, 99 %", number(values.interval_99->from),
                                                        number(values.interval_99->to))
                                          : fmt::format("{} ... {}", number(values.least), number(values.most));
    return fmt::format("{} ({})", number(values.median), range);
}

/// Two columns, or one when nothing is assumed.
class Table {
  public:
    Table(const Prospect& without, const Prospect* with) : without_(without), with_(with) {}

    template <typename Text>
    void row(const std::string& name, const Text& text) {
        text_ += fmt::format("{:<32}{:>38}", name, text(without_));
        if (with_ != nullptr) text_ += fmt::format("{:>38}", text(*with_));
        text_ += '\n';
    }
    void values(const std::string& name, Values Prospect::* member, int digits, double scale = 1.0) {
        row(name, [&](const Prospect& side) { return cell(side.*member, digits, scale); });
    }
    const std::string& text() const { return text_; }

  private:
    const Prospect& without_;
    const Prospect* with_;
    std::string text_;
};

std::string within_text(const Proportion& part) {
    return fmt::format("{} of {}: {:.1f} ... {:.1f} %", part.part, part.of, percent * part.low, percent * part.high);
}

std::string ellipse_text(const Prospect& side) {
    const auto& ellipse = side.ellipse_99;
    return ellipse ? fmt::format("{:.2f} x {:.2f} km at {:.0f} deg", ellipse->major_m * km, ellipse->minor_m * km,
                                 ellipse->azimuth_deg)
                   : "too few";
}

std::string event_cell(const Prospect& side, const std::string& name) {
    const auto found = std::ranges::find(side.events, name, &EventTimes::name);
    if (found == side.events.end()) return "in no case";
    const std::string times = cell(found->e_s, 2, 1.0);
    return found->e_s.count == side.cases ? times : fmt::format("{} in {}", times, found->e_s.count);
}

std::vector<std::string> event_names(const Prospect& without, const Prospect* with) {
    std::vector<std::string> names;
    names.reserve(without.events.size());
    for (const EventTimes& event : without.events) names.push_back(event.name);
    if (with == nullptr) return names;
    for (const EventTimes& event : with->events)
        if (std::ranges::find(names, event.name) == names.end()) names.push_back(event.name);
    return names;
}

std::string limit_cell(const Prospect& side, const std::string& name) {
    const auto found = std::ranges::find(side.limits, name, &campaign::LimitMargin::limit);
    if (found == side.limits.end() || found->number == 0) return "no figure";
    return fmt::format("{:.4g} by case {}{}", found->margin, found->number,
                       found->exceeded == 0 ? "" : fmt::format(", {} exceeded", found->exceeded));
}

std::string outcomes_text(const Prospect& side) {
    std::string text;
    for (const auto& [outcome, count] : side.outcomes)
        text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, outcome);
    return text;
}

/// Why cases are not within limits: each reason once, with the first case that has it, and five reasons at most.
std::string reasons_text(const std::string& side, const std::vector<Prospect::Outside>& outside) {
    struct Reason {
        const Prospect::Outside* first;
        std::size_t cases;
    };
    std::vector<Reason> reasons;
    for (const auto& one : outside) {
        const auto same = std::ranges::find(reasons, one.reason, [](const Reason& each) { return each.first->reason; });
        if (same != reasons.end())
            ++same->cases;
        else
            reasons.push_back({&one, 1});
    }
    constexpr std::size_t shown = 5;
    std::string text;
    for (const auto& [first, cases] : std::span{reasons}.first(std::min(shown, reasons.size())))
        text += fmt::format("{}case {}: {}: {}{}\n", side, first->number, first->outcome, first->reason,
                            cases == 1 ? "" : fmt::format(" ({} cases)", cases));
    if (reasons.size() > shown) text += fmt::format("{}{} more reasons: see --json\n", side, reasons.size() - shown);
    return text;
}

}  // namespace

std::string entry_time_text(double e_s) {
    return fmt::format("E{:+.1f} s", e_s);
}

std::string progress_line(const ForecastProgress& progress) {
    auto text = fmt::format("{}/{} flown, {} of {} landed within limits", progress.done, progress.of,
                            progress.within_without, progress.without);
    if (progress.with > 0) text += fmt::format(" without, {} of {} with", progress.within_with, progress.with);
    return text;
}

namespace {

std::string known_json(const simulation::StateKnowledge& known) {
    JsonObject object;
    object.number("position_m", known.position_m).number("velocity_mps", known.velocity_mps);
    if (known.height_m) object.number("height_m", *known.height_m);
    return object.str();
}

}  // namespace

std::string forecast_json(const FlownForecast& forecast, const simulation::Limits& limits, const ForecastCall& call) {
    const Prospect without = prospect_of(forecast.without, limits, forecast.from_e_s);
    JsonObject object;
    object.text("from", name_of(forecast.basis));
    if (forecast.basis == Basis::telemetry)
        object.raw("heard_e_s", forecast.heard_e_s ? fmt::format("{}", *forecast.heard_e_s) : "null")
            .raw("state_known_by", known_json(*forecast.knowledge));
    object.text("scenario", call.scenario)
        .count("landing_seed", call.landing_seed)
        .number("from_e_s", forecast.from_e_s)
        .number("apart_e_s", forecast.apart_e_s)
        .count("seed", call.order.seed)
        .count("cases", call.order.cases)
        .raw("assumed", json_array(call.assumed, [](const std::string& words) { return json_text(words); }))
        .raw("without", prospect_json(without));
    if (!forecast.with.empty())
        object.raw("with", prospect_json(prospect_of(forecast.with, limits, forecast.from_e_s)))
            .raw("pairs", pairs_json(pairs_of(forecast.without, forecast.with)));
    return object.count("jobs", call.order.jobs)
        .number("processor_s", forecast.processor_s)
        .number("wall_s", forecast.wall_s)
        .str();
}

std::string forecast_table(const FlownForecast& forecast, const simulation::Limits& limits, const ForecastCall& call) {
    const Prospect without = prospect_of(forecast.without, limits, forecast.from_e_s);
    const bool compared = !forecast.with.empty();
    const Prospect with = prospect_of(forecast.with, limits, forecast.from_e_s);
    Table table{without, compared ? &with : nullptr};
    table.row("", [&](const Prospect& side) {
        return std::string{!compared ? "" : &side == &without ? "without" : "with what is assumed"};
    });
    table.row("outcomes", outcomes_text);
    table.row("within limits, 99 % confidence", [](const Prospect& side) { return within_text(side.within); });
    for (const std::string& name : event_names(without, compared ? &with : nullptr))
        table.row(name + "  E+s", [&](const Prospect& side) { return event_cell(side, name); });
    table.row("99 % ellipse", ellipse_text);
    table.values("miss km", &Prospect::miss_m, 2, km);
    table.values("touchdown vertical m/s", &Prospect::vertical_mps, 3);
    table.values("touchdown horizontal m/s", &Prospect::horizontal_mps, 3);
    table.values("propellant left kg", &Prospect::propellant_kg, 1);
    table.values("peak deceleration m/s2", &Prospect::peak_deceleration_mps2, 1);
    table.values("least timeline margin s", &Prospect::least_margin_s, 2);
    for (const campaign::LimitMargin& one : without.limits)
        table.row("margin to " + one.limit, [&](const Prospect& side) { return limit_cell(side, one.limit); });

    const std::string from = forecast.basis == Basis::truth ? "the truth"
                             : forecast.heard_e_s
                                 ? fmt::format("what ground heard until {}", entry_time_text(*forecast.heard_e_s))
                                 : "ground's solution alone";
    std::string text = fmt::format("from {} of {}, seed {}, at {}: {} cases, whose errors differ from {}\n", from,
                                   call.scenario, call.landing_seed, entry_time_text(forecast.from_e_s),
                                   call.order.cases, entry_time_text(forecast.apart_e_s));
    for (const std::string& words : call.assumed) text += "assumed: " + words + "\n";
    text += table.text();
    if (compared) {
        const Pairs pairs = pairs_of(forecast.without, forecast.with);
        text += fmt::format("case by case: within limits in both {}, only without {}, only with {}, in neither {}",
                            pairs.within_both, pairs.only_without, pairs.only_with, pairs.within_neither);
        text += pairs.miss_change_m.count == 0
                    ? "\n"
                    : fmt::format("; miss changes by {} m, propellant by {} kg\n", cell(pairs.miss_change_m, 1, 1.0),
                                  cell(pairs.propellant_change_kg, 2, 1.0));
    }
    text += reasons_text(compared ? "without, " : "", without.outside) + reasons_text("with, ", with.outside);
    if (without.cases < values_for_99)
        text += fmt::format(
            "median (least ... most of these cases); for a 99 % interval {} cases are too few, it takes {}: "
            "the next one lies between with {:.0f} %\n",
            without.cases, values_for_99, percent * (1.0 - 2.0 / static_cast<double>(without.cases + 1)));
    return text + fmt::format("{:.1f} s, {:.1f} s of processor time, {} jobs\n", forecast.wall_s, forecast.processor_s,
                              call.order.jobs);
}

}  // namespace aeolis::server::shadow
