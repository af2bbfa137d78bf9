// SPDX-License-Identifier: Apache-2.0
#include "commands/number.hpp"
#include "server/instruction/inject_plan.hpp"
#include "server/procedures/condition.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace aeolis::server::instruction {
namespace {

/// "DEVICE_DESCENT_ENGINES" as "descent engines".
std::string enumerator_words(const std::string& name, std::string_view prefix) {
    if (!name.starts_with(prefix)) return "of another version";
    std::string words = name.substr(prefix.size());
    std::ranges::transform(words, words.begin(), [](unsigned char letter) {
        return letter == '_' ? ' ' : static_cast<char>(std::tolower(letter));
    });
    return words;
}

std::string percent_text(double fraction) {
    return commands::shortest_text(std::round(1000.0 * fraction) / 10.0);
}

std::string any_of(const std::vector<std::string>& names) {
    return fmt::format("{}", fmt::join(names, " or "));
}

}  // namespace

std::string_view name_of(Skill skill) {
    constexpr std::array<std::string_view, skills.size()> names{"detection", "diagnosis", "action", "procedure",
                                                                "communication"};
    return names[static_cast<std::size_t>(skill)];
}

const Handling& Rubric::handling_of(const v1::FaultInjection& fault) const {
    static const Handling nothing;
    const auto fits = std::ranges::find_if(faults, [&](const FaultHandling& each) {
        if (each.kind != fault.fault_case()) return false;
        if (!fault.has_device_fault()) return true;
        return (!each.device || *each.device == fault.device_fault().device()) &&
               (!each.device_kind || *each.device_kind == fault.device_fault().kind());
    });
    return fits == faults.end() ? nothing : fits->handling;
}

double share_of(std::optional<double> after_s, double within_s, double none_s) {
    if (!after_s || *after_s >= none_s) return 0.0;
    return *after_s <= within_s ? 1.0 : (none_s - *after_s) / (none_s - within_s);
}

std::string text_of(const v1::FaultInjection& injected) {
    const auto seconds = [](double duration_s) { return commands::shortest_text(duration_s) + " s"; };
    switch (injected.fault_case()) {
    case v1::FaultInjection::kDeviceFault: {
        const auto& fault = injected.device_fault();
        return fmt::format(
            "{} {} {}{}, for {}", enumerator_words(v1::Device_Name(fault.device()), "DEVICE_"),
            fault.unit() == v1::REDUNDANT_UNIT_B ? 'B' : 'A',
            enumerator_words(v1::DeviceFaultKind_Name(fault.kind()), "DEVICE_FAULT_KIND_"),
            fault.kind() == v1::DEVICE_FAULT_KIND_LATE && fault.has_late_s() ? " by " + seconds(fault.late_s()) : "",
            seconds(fault.duration_s()));
    }
    case v1::FaultInjection::kStationOutage:
        return "the ground station brings nothing, for " + seconds(injected.station_outage().duration_s());
    case v1::FaultInjection::kSystemFault:
        return "a system outside EDL, for " + seconds(injected.system_fault().duration_s());
    case v1::FaultInjection::kComputerReset: return "the prime computer starts anew";
    case v1::FaultInjection::kOrbiterOutage:
        return "no orbiter relays, for " + seconds(injected.orbiter_outage().duration_s());
    case v1::FaultInjection::kUhfLoss:
        return fmt::format("UHF loses {} % of its octets at least, for {}",
                           percent_text(injected.uhf_loss().fraction()), seconds(injected.uhf_loss().duration_s()));
    case v1::FaultInjection::kWindShift:
        return fmt::format("the wind changes by {} m/s to the east and {} m/s to the north, for {}",
                           commands::shortest_text(injected.wind_shift().east_mps()),
                           commands::shortest_text(injected.wind_shift().north_mps()),
                           seconds(injected.wind_shift().duration_s()));
    case v1::FaultInjection::kAirShift: {
        const auto& shift = injected.air_shift();
        return fmt::format("the air is {} % {}, for {}", percent_text(std::abs(shift.fraction())),
                           shift.fraction() < 0.0 ? "thinner" : "denser", seconds(shift.duration_s()));
    }
    case v1::FaultInjection::kSensorError: {
        const auto& error = injected.sensor_error();
        const bool imu = error.device() == v1::DEVICE_IMU;
        std::string off;
        if (error.off_by() != 0.0)
            off = fmt::format(" by {} {}", commands::shortest_text(error.off_by()), imu ? "m/s²" : "m/s");
        if (error.grows_per_s() != 0.0)
            off += fmt::format("{} {} {} more each second", off.empty() ? " by" : " and",
                               commands::shortest_text(error.grows_per_s()), imu ? "m/s²" : "m/s");
        return fmt::format("{} {} measures {} wrongly{}, for {}",
                           enumerator_words(v1::Device_Name(error.device()), "DEVICE_"),
                           error.unit() == v1::REDUNDANT_UNIT_B ? 'B' : 'A', imu ? "forces" : "velocities", off,
                           seconds(error.duration_s()));
    }
    case v1::FaultInjection::kFalseTone:
        return fmt::format("the vehicle sends tone {} in place of its own, for {}", injected.false_tone().tone(),
                           seconds(injected.false_tone().duration_s()));
    case v1::FaultInjection::FAULT_NOT_SET: break;
    }
    return "nothing";
}

std::string text_of(const Expectation& expectation) {
    const auto& [of, act, names, within_s] = expectation;
    const auto within = commands::shortest_text(within_s);
    switch (act) {
    case Expectation::Act::acknowledge: return fmt::format("acknowledges {} within {} s", any_of(names), within);
    case Expectation::Act::note:
        return names.empty() ? fmt::format("writes a line of the log within {} s", within)
                             : fmt::format("writes of “{}” in the log within {} s", fmt::join(names, "” or “"), within);
    case Expectation::Act::command: return fmt::format("sends {} within {} s", any_of(names), within);
    case Expectation::Act::no_command: break;
    }
    return fmt::format("sends no {} for {} s", names.empty() ? "command" : any_of(names), within);
}

std::vector<std::string> team_texts(const Inject& inject, const Rubric& rubric) {
    const auto& handling = inject.handling.team.empty() ? rubric.handling_of(inject.fault) : inject.handling;
    std::vector<std::string> all;
    all.reserve(handling.team.size());
    for (const auto& expectation : handling.team)
        all.push_back(fmt::format("{}: {}", name_of(expectation.of), text_of(expectation)));
    return all;
}

std::string when_text(const Inject& inject, const dictionary::Dictionary& dictionary) {
    std::string text;
    for (const auto& condition : inject.when) {
        const auto* of_event = std::get_if<procedures::EventCondition>(&condition);
        const auto* event = of_event == nullptr ? nullptr : dictionary.event(of_event->event);
        text += (text.empty() ? "" : ", and ") +
                (event == nullptr ? procedures::text_of(condition, dictionary) : event->name + " on board");
    }
    if (inject.after_s > 0.0) text += fmt::format(", {} s later", commands::shortest_text(inject.after_s));
    return text;
}

}  // namespace aeolis::server::instruction
