// SPDX-License-Identifier: Apache-2.0
#include "server/rehearsal/landing_report.hpp"

#include "server/base/json_object.hpp"
#include "server/scenario/scenario_text.hpp"
#include "server/venue/task_report.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <tuple>

namespace aeolis::server {
namespace {

std::vector<simulation::TruthEvent> sorted_events(const Rehearsal& rehearsal) {
    auto events = rehearsal.events();
    std::ranges::sort(events, {}, [](const simulation::TruthEvent& event) { return std::tie(event.e_s, event.name); });
    return events;
}

double real_time_factor(const Rehearsal& rehearsal, double wall_s) {
    return wall_s > 0.0 ? static_cast<double>(rehearsal.cycles()) * seconds_per_tick / wall_s : 0.0;
}

std::string metres_json(const std::optional<double>& metres) {
    return metres ? json_number(*metres) : "null";
}

std::string nearest_text(const char* body, const std::optional<double>& metres) {
    return metres ? fmt::format("the {} came within {:.1f} m again\n", body, *metres) : "";
}

}  // namespace

std::string landing_json(const Rehearsal& rehearsal, double wall_s) {
    const auto& landing = rehearsal.landing();
    const auto touchdown = landing.touchdown();
    const auto separation = landing.separation();
    const auto proof = rehearsal.proof();
    const auto tones = rehearsal.tones();
    const auto event_json = [](const simulation::TruthEvent& event) {
        return JsonObject{}
            .text("name", event.name)
            .number("e_s", event.e_s)
            .number("sclk", event.sclk.seconds)
            .number("altitude_m", event.altitude_m)
            .number("speed_mps", event.speed_mps)
            .str();
    };
    const auto firing_json = [](const RecordedFiring& firing) {
        return JsonObject{}
            .text("name", firing.name)
            .number("fired_sclk", firing.fired_sclk)
            .text("verdict", firing.verdict)
            .str();
    };
    const auto touchdown_json = !touchdown ? std::string{"null"}
                                           : JsonObject{}
                                                 .number("vertical_mps", touchdown->vertical_mps)
                                                 .number("horizontal_mps", touchdown->horizontal_mps)
                                                 .number("miss_m", touchdown->miss_m)
                                                 .number("latitude_deg", touchdown->latitude_deg)
                                                 .number("longitude_deg", touchdown->longitude_deg)
                                                 .number("tilt_deg", touchdown->tilt_deg)
                                                 .str();
    const auto judgement = rehearsal.judgement();
    const auto exceeded_json = [](const simulation::ExceededLimit& one) {
        return JsonObject{}.text("limit", one.name).number("value", one.value).number("bound", one.limit).str();
    };
    JsonObject report;
    report.text("scenario", rehearsal.scenario().name)
        .text("test_venue", name_of(rehearsal.scenario().test_venue))
        .count("seed", rehearsal.seed())
        .text("outcome", name_of(rehearsal.outcome()))
        .text("verdict", name_of(judgement.verdict))
        .raw("limits_exceeded", json_array(judgement.exceeded, exceeded_json))
        .text("digest", rehearsal.digest())
        .raw("events", json_array(sorted_events(rehearsal), event_json))
        .number("peak_deceleration_mps2", landing.peak_deceleration_mps2())
        .raw("touchdown", touchdown_json)
        .raw("heatshield_least_m", metres_json(separation.heatshield_least_m))
        .raw("backshell_least_m", metres_json(separation.backshell_least_m))
        .raw("timepoints", json_array(rehearsal.firings(), firing_json))
        .raw("tones", JsonObject{}
                          .count("sent", tones.sent)
                          .count("decoded", tones.decoded)
                          .count("wrong", tones.wrong)
                          .count("missed", tones.missed)
                          .str())
        .raw("packets", JsonObject{}
                            .count("recorded", proof.recorded)
                            .count("realtime", proof.realtime)
                            .count("realtime_not_recorded", proof.realtime_not_recorded)
                            .count("realtime_differs", proof.realtime_differs)
                            .str())
        .count("cycles", rehearsal.cycles())
        .count("overruns", landing.counters().overruns)
        .number("wall_s", wall_s)
        .number("real_time_factor", real_time_factor(rehearsal, wall_s));
    if (const auto times = rehearsal.task_times())
        report.raw("tasks", task_json(*times)).raw("all_tasks", all_tasks_json(*times));
    return report.str();
}

std::string landing_table(const Rehearsal& rehearsal, double wall_s) {
    const auto& landing = rehearsal.landing();
    std::string text = fmt::format("{} (seed {}, {}): {}, {}", rehearsal.scenario().name, rehearsal.seed(),
                                   name_of(rehearsal.scenario().test_venue), name_of(rehearsal.outcome()),
                                   name_of(rehearsal.judgement().verdict));
    if (const auto reason = rehearsal.outcome_reason(); !reason.empty()) text += " - " + reason;
    text += fmt::format("\n\n{:<28}{:>10}{:>14}{:>12}\n", "event", "E+s", "altitude m", "speed m/s");
    for (const auto& event : sorted_events(rehearsal))
        text += fmt::format("{:<28}{:>10.2f}{:>14.1f}{:>12.2f}\n", event.name, event.e_s, event.altitude_m,
                            event.speed_mps);
    text += fmt::format("\npeak deceleration {:.2f} m/s2\n", landing.peak_deceleration_mps2());
    if (const auto touchdown = landing.touchdown())
        text +=
            fmt::format("touchdown {:.2f} m/s down, {:.2f} m/s across, the stage {:.1f} deg off the vertical, {:.0f} m "
                        "from the target, at {:.4f}, {:.4f}\n",
                        touchdown->vertical_mps, touchdown->horizontal_mps, touchdown->tilt_deg, touchdown->miss_m,
                        touchdown->latitude_deg, touchdown->longitude_deg);
    const auto separation = landing.separation();
    text += nearest_text("heatshield", separation.heatshield_least_m) +
            nearest_text("backshell", separation.backshell_least_m);
    const auto tones = rehearsal.tones();
    text += fmt::format("{} timepoints fired; tones: {} sent, {} decoded, {} wrong, {} missed\n",
                        rehearsal.firings().size(), tones.sent, tones.decoded, tones.wrong, tones.missed);
    const auto proof = rehearsal.proof();
    text += proof.recorded == 0 ? "nothing was recorded\n" : telemetry::text_of(proof) + '\n';
    for (const auto& [identity, product] : rehearsal.products().products())
        text += "product " + telemetry::text_of(identity, product) + '\n';
    for (const auto& refusal : rehearsal.script_refusals()) text += "scripted command refused: " + refusal + '\n';
    text += fmt::format("digest {} (SHA-256 of the recording)\n{} cycles, {} overruns, {:.2f} s, {:.0f} x real time\n",
                        rehearsal.digest(), rehearsal.cycles(), landing.counters().overruns, wall_s,
                        real_time_factor(rehearsal, wall_s));
    if (const auto times = rehearsal.task_times()) text += '\n' + task_table(*times);
    return text;
}

}  // namespace aeolis::server
