// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/case_messages.hpp"

#include "server/base/digest.hpp"
#include "simulation/landing.hpp"

#include <algorithm>
#include <array>
#include <string_view>

namespace aeolis::server::cluster {
namespace {

constexpr std::string_view order_prefix = "aeolis.campaigns.";
constexpr std::array struck_bodies{"heatshield", "backshell"};

bool is_outcome(const std::string& name) {
    using enum simulation::Outcome;
    return std::ranges::any_of(std::array{touchdown, impact, lost, not_commanded, timeout},
                               [&](auto outcome) { return name == simulation::name_of(outcome); });
}

}  // namespace

CampaignSubjects::CampaignSubjects(const std::string& kind, const std::string& campaign)
    : order(std::string{order_prefix} + kind + "." + campaign), cases("aeolis.cases." + campaign),
      answers("aeolis.answers." + campaign), case_consumer("workers-" + campaign),
      answer_consumer("collector-" + campaign) {}

std::string kind_of(const campaign::Identity& identity) {
    constexpr std::size_t digits = 16;
    const auto text = identity.program + " " + identity.dictionary;
    Digest digest;
    digest.add({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
    return digest.text().substr(0, digits);
}

std::string campaign_of(const std::string& subject, const std::string& kind) {
    const auto prefix = std::string{order_prefix} + kind + ".";
    return subject.starts_with(prefix) ? subject.substr(prefix.size()) : "";
}

v1::FlownCase message_of(const campaign::CaseResult& result) {
    v1::FlownCase message;
    message.set_outcome(result.outcome);
    message.set_reason(result.reason);
    message.set_limits_exceeded(result.limits_exceeded);
    message.set_end_cycle(result.end_cycle);
    if (result.touchdown) {
        auto& touchdown = *message.mutable_touchdown();
        touchdown.set_vertical_mps(result.touchdown->vertical_mps);
        touchdown.set_horizontal_mps(result.touchdown->horizontal_mps);
        touchdown.set_miss_m(result.touchdown->miss_m);
        touchdown.set_latitude_deg(result.touchdown->latitude_deg);
        touchdown.set_longitude_deg(result.touchdown->longitude_deg);
        touchdown.set_tilt_deg(result.touchdown->tilt_deg);
        touchdown.set_east_m(result.east_m);
        touchdown.set_north_m(result.north_m);
    }
    if (result.parachute) {
        message.mutable_parachute()->set_mach(result.parachute->mach);
        message.mutable_parachute()->set_dynamic_pressure_pa(result.parachute->dynamic_pressure_Pa);
    }
    if (const auto least_m = result.separation.heatshield_least_m) message.set_heatshield_least_m(*least_m);
    if (const auto least_m = result.separation.backshell_least_m) message.set_backshell_least_m(*least_m);
    if (result.separation.struck != nullptr) message.set_struck_by(result.separation.struck);
    message.set_peak_deceleration_mps2(result.peak_deceleration_mps2);
    message.set_propellant_kg(result.propellant_kg);
    for (const auto& margin : result.margins) {
        auto& added = *message.add_margins();
        added.set_timepoint(margin.timepoint);
        added.set_margin_s(margin.margin_s);
    }
    for (const auto& event : result.events) {
        auto& added = *message.add_events();
        added.set_name(event.name);
        added.set_e_s(event.e_s);
        added.set_altitude_m(event.altitude_m);
        added.set_speed_mps(event.speed_mps);
        added.set_east_m(event.east_m);
        added.set_north_m(event.north_m);
    }
    for (const auto& draw : result.draws) {
        auto& added = *message.add_draws();
        added.set_name(draw.name);
        added.set_value(draw.value);
    }
    return message;
}

Result<campaign::CaseResult> result_of(const v1::CaseAnswer& answer) {
    const auto& message = answer.flown();
    if (!is_outcome(message.outcome())) return Error{"no outcome of a landing: '" + message.outcome() + "'"};
    campaign::CaseResult result;
    result.number = answer.number();
    result.outcome = message.outcome();
    result.reason = message.reason();
    result.limits_exceeded = message.limits_exceeded();
    result.end_cycle = message.end_cycle();
    if (message.has_touchdown()) {
        const auto& touchdown = message.touchdown();
        result.touchdown =
            simulation::TouchdownReport{touchdown.vertical_mps(), touchdown.horizontal_mps(), touchdown.miss_m(),
                                        touchdown.latitude_deg(), touchdown.longitude_deg(),  touchdown.tilt_deg()};
        result.east_m = touchdown.east_m();
        result.north_m = touchdown.north_m();
    }
    if (message.has_parachute())
        result.parachute =
            simulation::ParachuteReport{message.parachute().mach(), message.parachute().dynamic_pressure_pa()};
    if (message.has_heatshield_least_m()) result.separation.heatshield_least_m = message.heatshield_least_m();
    if (message.has_backshell_least_m()) result.separation.backshell_least_m = message.backshell_least_m();
    if (!message.struck_by().empty()) {
        const auto* body = std::ranges::find(struck_bodies, message.struck_by());
        if (body == struck_bodies.end()) return Error{"no body that separates: '" + message.struck_by() + "'"};
        result.separation.struck = *body;
    }
    result.peak_deceleration_mps2 = message.peak_deceleration_mps2();
    result.propellant_kg = message.propellant_kg();
    for (const auto& margin : message.margins()) result.margins.push_back({margin.timepoint(), margin.margin_s()});
    for (const auto& event : message.events())
        result.events.push_back(
            {event.name(), event.e_s(), event.altitude_m(), event.speed_mps(), event.east_m(), event.north_m()});
    for (const auto& draw : message.draws()) result.draws.push_back({draw.name(), draw.value()});
    return result;
}

}  // namespace aeolis::server::cluster
