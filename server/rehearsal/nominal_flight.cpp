// SPDX-License-Identifier: Apache-2.0
#include "server/rehearsal/nominal_flight.hpp"

#include "common/check.hpp"
#include "server/rehearsal/predict_silences.hpp"
#include "server/rehearsal/recorded_firings.hpp"
#include "server/rehearsal/scripted_landing.hpp"
#include "telemetry/packet_stream.hpp"
#include "telemetry/station/silence_classifier.hpp"
#include "telemetry/text.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <exception>
#include <fmt/format.h>
#include <limits>
#include <utility>

namespace aeolis::server {
namespace {

using telemetry::SilenceClass;

constexpr std::string_view set_parameters = "EDL_SET_PARAMETERS", do_edl = "EDL_DO_EDL";
constexpr double commands_apart_s = 10.0;  // chosen: the reply to one is there before the next
constexpr std::uint64_t cycles_between_stops = 64;

std::string in_small_letters(std::string name) {
    std::ranges::transform(name, name.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return name;
}

/// The planned commands, from the start of the flight on: those of the script that would have left before follow each
/// other at its beginning.
std::vector<simulation::ScriptedCommand> planned_commands(const simulation::Scenario& scenario, double start_s) {
    auto commands = scenario.commands;
    if (std::ranges::find(commands, do_edl, &simulation::ScriptedCommand::command) == commands.end()) {
        simulation::ScriptedCommand parameters;
        parameters.command = set_parameters;
        parameters.from_solution = true;
        simulation::ScriptedCommand begin;
        begin.command = do_edl;
        commands.push_back(parameters);
        commands.push_back(begin);
        for (auto& command : commands) command.send_before_entry_s = std::numeric_limits<double>::max();
    }
    std::ranges::stable_sort(commands, std::ranges::greater{}, &simulation::ScriptedCommand::send_before_entry_s);
    double at_s = start_s;
    for (auto& command : commands)
        command.send_before_entry_s = at_s = std::min(command.send_before_entry_s, at_s - commands_apart_s);
    return commands;
}

/// The scenario to fly: as expected, over links that are always there and take no time.
simulation::Scenario flown_scenario(const simulation::Scenario& expected) {
    simulation::Scenario flown = expected;
    flown.start_before_entry_s = std::min(expected.start_before_entry_s, nominal_flight_before_entry_s);
    flown.commands = planned_commands(expected, flown.start_before_entry_s);
    flown.second_person.clear();
    flown.radio.light_time_s = 0.0;
    flown.radio.relay_passes.clear();
    flown.radio.tracking_passes.clear();
    return flown;
}

/// Collects what the recorded packets tell: the first sample of each second of every channel, and event reports.
class Telemetry {
  public:
    Telemetry(const dictionary::Dictionary& dictionary, Sclk entry)
        : dictionary_(dictionary), entry_(entry), decommutator_(dictionary), samples_(dictionary.channels.size()),
          second_(dictionary.channels.size(), std::numeric_limits<double>::lowest()) {}

    void read(std::span<const std::uint8_t> recorded) {
        telemetry::PacketStream packets{recorded};
        while (const auto packet = packets.next()) {
            if (decommutator_.decode(*packet, decoded_)) continue;
            const double e_s = decoded_.header.time - entry_;
            sample(e_s);
            const auto* event = telemetry::event_of(dictionary_, decoded_);
            if (event != nullptr && event->level == dictionary::EventLevel::activity_hi && !is_of_timepoint(*event))
                events_.push_back({in_small_letters(event->name), false, e_s});
        }
    }

    std::vector<std::vector<NominalFlight::Sample>> take_samples() { return std::move(samples_); }
    std::vector<NominalFlight::Event> take_events() { return std::move(events_); }

  private:
    void sample(double e_s) {
        const auto& fields = dictionary_.packets[decoded_.packet].fields;
        for (std::size_t i = 0; i < fields.size(); ++i) {
            if (!fields[i].channel) continue;
            const auto channel = fields[i].channel->value;
            const double second = std::floor(e_s);
            if (second <= second_[channel]) continue;
            second_[channel] = second;
            if (decoded_.value[i]) samples_[channel].push_back({e_s, *decoded_.value[i]});
        }
    }
    /// Whether a timepoint of the same name reports it.
    bool is_of_timepoint(const dictionary::Event& event) const {
        return std::ranges::any_of(dictionary_.timeline, [&](const dictionary::TimelineRow& row) {
            return row.event == event.name && row.name == in_small_letters(event.name);
        });
    }

    const dictionary::Dictionary& dictionary_;
    Sclk entry_;
    telemetry::Decommutator decommutator_;
    telemetry::Decoded decoded_;
    std::vector<std::vector<NominalFlight::Sample>> samples_;
    std::vector<double> second_;  ///< by channel: of its last sample
    std::vector<NominalFlight::Event> events_;
};

/// Adds the times in which no bent pipe is in view, and the passes.
void add_passes(const telemetry::PredictedSilences& silences, double from_s,
                std::vector<NominalFlight::Window>& windows) {
    if (silences.passes.empty()) return;
    const std::string live{telemetry::uhf_live_link.name};
    auto passes = silences.passes;
    std::ranges::sort(passes, {}, &telemetry::PredictedSilences::OrbiterPass::rise_s);
    double heard_until_s = from_s;
    for (const auto& pass : passes) {
        windows.push_back({true, pass.stored ? "uhf_" + pass.orbiter : live, pass.orbiter, pass.rise_s, pass.set_s});
        if (pass.stored) continue;
        if (pass.rise_s > heard_until_s)
            windows.push_back({false, live, telemetry::title_of(SilenceClass::no_orbiter), heard_until_s, pass.rise_s});
        heard_until_s = std::max(heard_until_s, pass.set_s);
    }
    windows.push_back({false, live, telemetry::title_of(SilenceClass::no_orbiter), heard_until_s, {}});
}

}  // namespace

std::vector<NominalFlight::Window> windows_of(const telemetry::PredictedSilences& silences, double from_s,
                                              double hand_over_s) {
    std::vector<NominalFlight::Window> windows;
    const std::string live{telemetry::uhf_live_link.name}, x_band{telemetry::x_band_link.name};
    const auto add = [&](const std::string& link, SilenceClass why, double begin_s, std::optional<double> end_s) {
        windows.push_back({false, link, telemetry::title_of(why), begin_s, end_s});
    };
    if (silences.uhf_start_s) add(live, SilenceClass::not_begun, from_s, silences.uhf_start_s);
    if (silences.x_band_tones_s) {
        add(x_band, SilenceClass::not_begun, from_s, silences.x_band_tones_s);
        add(telemetry::x_band_telemetry_link.name, SilenceClass::switched_off, *silences.x_band_tones_s, {});
    }
    if (silences.blackout) add(live, SilenceClass::blackout, silences.blackout->from_s, silences.blackout->to_s);
    if (silences.hand_over_s)
        add(live, SilenceClass::hand_over, *silences.hand_over_s, *silences.hand_over_s + hand_over_s);
    if (silences.uhf_stop_s) add(live, SilenceClass::switched_off, *silences.uhf_stop_s, {});
    if (silences.carrier_weak)
        add(x_band, SilenceClass::weak_carrier, silences.x_band_tones_s.value_or(from_s), silences.earth_set_s);
    if (silences.earth_set_s) add(x_band, SilenceClass::earth_set, *silences.earth_set_s, {});
    add_passes(silences, from_s, windows);
    std::ranges::stable_sort(windows, {}, &NominalFlight::Window::from_s);
    return windows;
}

std::optional<NominalFlight::Ellipse> ellipse_of(const simulation::Scenario& scenario) {
    const auto& target = scenario.target;
    if (target.ellipse_major_m == 0.0) return std::nullopt;
    return NominalFlight::Ellipse{target.ellipse_major_m, target.ellipse_minor_m,
                                  std::fmod(simulation::course_at_target_deg(scenario), 180.0)};
}

simulation::Scenario expected_scenario(simulation::Scenario scenario) {
    scenario = simulation::as_believed(simulation::undispersed(std::move(scenario)));
    scenario.name.clear();
    scenario.title.clear();
    scenario.disperse_before_entry_s.reset();
    scenario.system_faults.clear();
    scenario.device_faults.clear();
    scenario.computer_resets.clear();
    scenario.station_outages.clear();
    scenario.orbiter_outages.clear();
    scenario.uhf_losses.clear();
    scenario.wind_shifts.clear();
    scenario.air_shifts.clear();
    scenario.false_tones.clear();
    scenario.sensor_errors.clear();
    scenario.bus_message_error_fraction = 0.0;
    scenario.radio.uhf_loss_fraction = 0.0;
    scenario.radio.uplink_loss_fraction = 0.0;
    scenario.radio.delivery_restarts_after_touchdown_s.clear();
    scenario.ground_flight.reset();             // chosen by the pace of a run, and so are:
    scenario.radio.tones_from_samples = false;  // chosen by the pace of a run
    // The same software, without the threads that measure it.
    if (scenario.test_venue == simulation::TestVenue::performance)
        scenario.test_venue = simulation::TestVenue::flight_software;
    return scenario;
}

Result<NominalFlight> fly_nominally(const simulation::Scenario& expected, const dictionary::Dictionary& dictionary,
                                    const std::function<bool()>& stop) {
    if (expected.test_venue == simulation::TestVenue::gnc_alone)
        return Error{fmt::format("the test venue {} has no telemetry to predict", name_of(expected.test_venue))};
    const simulation::Scenario flown = flown_scenario(expected);
    Telemetry telemetry{dictionary, flown.entry_sclk};
    RecordedFirings firings{dictionary};
    NominalFlight flight;
    try {
        ScriptedLanding landing{flown, 0, 0, dictionary};
        for (std::uint64_t cycle = 0; !landing.landing().flown(); ++cycle) {
            if (cycle % cycles_between_stops == 0 && stop && stop())
                return Error{.message = "the nominal flight was stopped", .internal = true};
            auto& received = landing.step();
            if (!landing.script_sent()) {
                landing.hear(received);
                landing.take_stages();
            }
            const auto& report = landing.landing().report();
            telemetry.read(report.recorded);
            firings.read(report.recorded);
        }
        flight.outcome = simulation::name_of(landing.landing().outcome());
        if (landing.landing().outcome() != simulation::Outcome::touchdown)
            return Error{fmt::format("the nominal flight of this scenario does not land ({})", flight.outcome)};
        flight.windows = windows_of(predict_silences(expected, dictionary), -expected.start_before_entry_s,
                                    expected.radio.uhf_hand_over_s);
    } catch (const CheckFailed& bug) {
        return Error{text_of_bug(bug)};
    } catch (const std::exception& error) {
        return Error{std::string{"the simulation ended: "} + error.what()};
    }
    flight.ellipse = ellipse_of(expected);
    flight.samples = telemetry.take_samples();
    flight.events = telemetry.take_events();
    for (const auto& firing : firings.all())
        flight.events.push_back({firing.name, true, firing.fired_sclk - flown.entry_sclk.seconds});
    std::ranges::stable_sort(flight.events, {}, &NominalFlight::Event::e_s);
    return flight;
}

}  // namespace aeolis::server
