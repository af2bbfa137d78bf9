// SPDX-License-Identifier: Apache-2.0
#include "server/base/json.hpp"
#include "server/cli/commands.hpp"
#include "server/cli/long_work.hpp"
#include "server/cli/options.hpp"
#include "server/cli/shipped_paths.hpp"
#include "server/scenario/scenario_text.hpp"
#include "server/shadow/forecast_report.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <google/protobuf/struct.pb.h>
#include <memory>
#include <thread>

namespace aeolis::server {
namespace {

constexpr unsigned forecast_jobs_max = 256;  // chosen: each holds a landing

struct ForecastOptions {
    SharedOptions shared;
    std::string scenario, at, by = "truth";
    std::uint64_t seed = 1;
    std::uint64_t cases = 32, draw_seed = 1;
    unsigned jobs = 0;  ///< 0: one per processor
    std::vector<std::string> commands, faults;
    bool json = false;
};

/// Reads "E-600", "E+200.5".
Result<double> entry_time(const std::string& text) {
    const Error wrong{fmt::format("--at: '{}' is not seconds from entry, like E-600 or E+200", text)};
    if (text.size() < 3 || text[0] != 'E' || (text[1] != '+' && text[1] != '-')) return wrong;
    const char* const first = text.data() + (text[1] == '+' ? 2 : 1);
    const char* const end = text.data() + text.size();
    if (text[2] == '-') return wrong;  // which a number may begin with
    double e_s = 0.0;
    const auto [read_to, fault] = std::from_chars(first, end, e_s);
    if (fault != std::errc{} || read_to != end || !std::isfinite(e_s)) return wrong;
    return e_s;
}

/// Reads "NAME" or "NAME {arguments}". "from_solution": true fills in ground's navigation solution.
Result<commands::Request> command_given(const std::string& text) {
    commands::Request request;
    const auto space = text.find(' ');
    request.command = text.substr(0, space);
    // Who assumes a command has armed and confirmed it.
    request.armed = true;
    request.confirmation = request.command;
    if (space == std::string::npos) return request;
    google::protobuf::Struct arguments;
    if (const auto parsed = from_json(text.substr(space + 1), arguments); !parsed)
        return Error{fmt::format("--command {}: {}", request.command, parsed.error().message)};
    for (const auto& [name, value] : arguments.fields()) {
        if (name == "from_solution" && value.kind_case() == google::protobuf::Value::kBoolValue)
            request.from_solution = value.bool_value();
        else if (value.kind_case() == google::protobuf::Value::kNumberValue)
            request.arguments.push_back({name, value.number_value()});
        else
            return Error{fmt::format("--command {}: {}: a number is wanted", request.command, name)};
    }
    std::ranges::sort(request.arguments, {}, &commands::NamedValue::name);
    return request;
}

Result<simulation::Fault> fault_given(const std::string& text, const simulation::Scenario& scenario) {
    v1::FaultInjection injection;
    if (const auto parsed = from_json(text, injection); !parsed)
        return Error{fmt::format("--fault {}: {}", text, parsed.error().message)};
    const auto fault = fault_from_message(injection, scenario);
    if (!fault) return Error{fmt::format("--fault {}: {}", text, fault.error().message)};
    return *fault;
}

/// The landing of the scenario and seed at that time, as `aeolis rehearse` flies it.
/// @param heard  told of what ground receives meanwhile
Result<ScriptedLanding> flown_to(const ForecastOptions& options, const FlightInputs& inputs, double e_s,
                                 shadow::HeardFlight& heard) {
    const auto& scenario = inputs.scenario;
    if (-e_s > scenario.start_before_entry_s)
        return Error{
            fmt::format("--at {}: {} begins at E-{} s", options.at, options.scenario, scenario.start_before_entry_s)};
    ScriptedLanding landing{scenario, options.seed, 0, inputs.dictionary};
    const auto until = scenario.entry_sclk + e_s;
    while (landing.landing().outcome() == simulation::Outcome::running && landing.landing().sclk() < until &&
           !stop_asked()) {
        auto& received = landing.step();
        landing.hear(received);
        heard.hear(received);
        landing.take_stages();
    }
    if (landing.landing().outcome() != simulation::Outcome::running)
        return Error{fmt::format("--at {}: the landing of {} with seed {} is over by then: {}, {}", options.at,
                                 options.scenario, options.seed, name_of(landing.landing().outcome()),
                                 landing.landing().outcome_reason())};
    return landing;
}

/// The script's commands are the scenario's: ground's own flight sends them itself.
archive::FlownRun sent_of(const ScriptedLanding& landing) {
    archive::FlownRun run;
    run.clock = landing.landing().correlation();
    return run;
}

std::uint64_t cycle_of(const ScriptedLanding& landing) {
    return landing.landing().counters().cycles;
}

int forecast(const ForecastOptions& options) {
    const auto e_s = entry_time(options.at);
    if (!e_s) return failed(e_s.error().message, 2);
    shadow::Assumption assumption;
    for (const std::string& text : options.commands) {
        auto command = command_given(text);
        if (!command) return failed(command.error().message, 2);
        assumption.commands.push_back(std::move(*command));
    }
    const auto ready = flight_inputs(options.shared, options.scenario);
    if (!ready) return failed(ready.error().message);
    for (const std::string& text : options.faults) {
        auto fault = fault_given(text, ready->scenario);
        if (!fault) return failed(fault.error().message, 2);
        assumption.faults.push_back(*fault);
    }
    if (ready->scenario.test_venue == simulation::TestVenue::performance)
        return failed(options.scenario + ": the test venue performance runs by the real clock: no forecast");

    shadow::ForecastCall call{options.scenario, options.seed, {}, options.commands};
    call.assumed.insert(call.assumed.end(), options.faults.begin(), options.faults.end());
    call.order.seed = options.draw_seed;
    call.order.cases = options.cases;
    call.order.jobs = options.jobs > 0 ? options.jobs : std::max(1U, std::thread::hardware_concurrency());
    stop_at_interrupt();
    Result<shadow::FlownForecast> flown = Error{};
    {
        ProgressLine line;
        line.draw("flown to " + options.at);
        shadow::HeardFlight heard{ready->dictionary};
        const auto landing = flown_to(options, *ready, *e_s, heard);
        if (!landing) return failed(landing.error().message);
        const auto tell = [&](const shadow::ForecastProgress& so_far) { line.draw(shadow::progress_line(so_far)); };
        if (options.by == name_of(shadow::Basis::truth)) {
            flown = shadow::forecast_from_truth(*landing, ready->scenario, ready->dictionary, assumption, call.order,
                                                stop_asked(), tell);
        } else {
            const auto ground = shadow::fly_by_ground(ready->scenario, landing->landing().solution(), sent_of(*landing),
                                                      heard, {cycle_of(*landing), true}, ready->dictionary,
                                                      [] { return stop_asked().load(); });
            if (!ground) return failed(ground.error().message);
            flown = shadow::forecast_by_ground(*ground, ready->scenario, ready->dictionary, assumption, call.order,
                                               stop_asked(), tell);
        }
    }
    if (!flown) return failed(flown.error().message);
    const auto& limits = ready->scenario.limits;
    if (options.json)
        fmt::print("{}\n", shadow::forecast_json(*flown, limits, call));
    else
        fmt::print("{}", shadow::forecast_table(*flown, limits, call));
    return 0;
}

}  // namespace

void add_forecast_command(CLI::App& program, int& exit_code) {
    const auto options = std::make_shared<ForecastOptions>();
    auto& command = *program.add_subcommand(
        "forecast",
        "flies a landing to a time, and from there many cases to their ends: what would come of it, with and "
        "without commands and faults that are assumed");
    command.add_option("--scenario", options->scenario, "a file, or the name of a shipped one")->required();
    command.add_option("--at", options->at, "seconds from entry at the vehicle: E-600, E+200")->required();
    command
        .add_option("--by", options->by,
                    "truth: from the landing's own state, an instructor's view; telemetry: from what ground had heard")
        ->check(CLI::IsMember({name_of(shadow::Basis::truth), name_of(shadow::Basis::telemetry)}))
        ->capture_default_str();
    command.add_option("--seed", options->seed, "seed of the landing's errors, as of rehearse")
        ->check(whole_number())
        ->capture_default_str();
    command.add_option("--cases", options->cases, "cases of each side")
        ->check(whole_number())
        ->check(CLI::Range(std::uint64_t{1}, shadow::forecast_cases_max))
        ->capture_default_str();
    command.add_option("--draw-seed", options->draw_seed, "seed of the errors that the cases draw anew")
        ->check(whole_number())
        ->capture_default_str();
    command
        .add_option("--command", options->commands,
                    "assumed: a command sent then, 'NAME {\"argument\": 1}'; several are sent one after another")
        ->take_all();
    command
        .add_option("--fault", options->faults,
                    "assumed: a fault from then on, as POST /api/v1/rehearsals/current takes one to inject: "
                    "'{\"computer_reset\": true}'")
        ->take_all();
    command.add_option("--jobs", options->jobs, "cases flown at a time; one per processor if left out")
        ->check(whole_number())
        ->check(CLI::Range(1U, forecast_jobs_max));
    command.add_flag("--json", options->json, "print one JSON object");
    add_shared(command, options->shared);
    command.callback([options, &exit_code] { exit_code = forecast(*options); });
}

}  // namespace aeolis::server
