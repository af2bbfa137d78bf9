// SPDX-License-Identifier: Apache-2.0
#include "commands/number.hpp"
#include "commands/parameter_table.hpp"
#include "server/base/json.hpp"
#include "server/cli/commands.hpp"
#include "server/cli/options.hpp"
#include "server/cli/shipped_paths.hpp"
#include "server/scenario/loaded_parameters.hpp"

#include "aeolis/v1/run.pb.h"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <fstream>
#include <memory>
#include <set>
#include <sstream>

namespace aeolis::server {
namespace {

constexpr const char* stage_command = "EDL_STAGE_PARAMETER";

struct ParametersOptions {
    std::filesystem::path directory = SharedOptions{}.dictionary;
    std::string scenario;  ///< whose vehicle it is; none: one with the defaults
    std::uint16_t table = 0;
    std::vector<std::filesystem::path> after;  ///< the command files by which the table held was made, in their order
    std::vector<std::string> changes;          ///< "guidance_gain=4.0"
};

struct Change {
    ParameterId id;
    double value = 0.0;
};

Result<Change> change_of(const std::string& text, const dictionary::Dictionary& dictionary) {
    const auto equals = text.find('=');
    if (equals == std::string::npos) return Error{text + ": a change is NAME=VALUE"};
    const std::string name = text.substr(0, equals);
    const auto row = std::ranges::find(dictionary.parameters, name, &dictionary::ParameterRow::name);
    if (row == dictionary.parameters.end()) return Error{fmt::format("parameters.csv has no parameter '{}'", name)};
    double value = 0.0;
    const char* const end = text.data() + text.size();
    const auto [read_to, error] = std::from_chars(text.data() + equals + 1, end, value);
    if (error != std::errc{} || read_to != end) return Error{text + ": the value is no number"};
    return Change{row->id, value};
}

double argument_of(const v1::CommandRequest& command, std::string_view name) {
    for (const v1::CommandArgument& argument : command.arguments())
        if (argument.name() == name) return argument.value();
    return -1.0;  // no row
}

/// Makes the changes of a command file.
Result<void> apply(const std::filesystem::path& path, commands::ParameterTable& table) {
    std::ifstream file{path, std::ios::binary};
    std::ostringstream text;
    text << file.rdbuf();
    v1::CommandSequence sequence;
    const auto parsed = file ? from_json(text.str(), sequence) : Result<void>{Error{"it cannot be read"}};
    if (!parsed) return Error{fmt::format("--after {}: {}", path.string(), parsed.error().message)};
    for (const v1::CommandRequest& command : sequence.commands()) {
        if (command.command() != stage_command) continue;
        const double row = argument_of(command, "parameter");
        const bool possible = row >= 0.0 && row <= 65535.0;
        if (!possible) return Error{fmt::format("--after {}: {} names no row", path.string(), stage_command)};
        const auto set = table.set(ParameterId{static_cast<std::uint16_t>(row)}, argument_of(command, "value"));
        if (!set) return Error{fmt::format("--after {}: {}", path.string(), set.error().message)};
    }
    return {};
}

using Arguments = std::vector<std::pair<const char*, double>>;

/// A line of a command file.
std::string line_of(const char* command, const Arguments& arguments = {}) {
    std::string text = fmt::format("  {{\"command\": \"{}\"", command);
    for (std::size_t i = 0; i < arguments.size(); ++i)
        text += fmt::format("{}{{\"name\": \"{}\", \"value\": {}}}", i == 0 ? ", \"arguments\": [" : ", ",
                            arguments[i].first, commands::shortest_text(arguments[i].second));
    return text + (arguments.empty() ? "}" : "]}");
}

/// The command file that changes the table: whatever was staged is discarded first.
Result<std::string> command_file(const ParametersOptions& options, const dictionary::Dictionary& dictionary) {
    std::vector<std::pair<ParameterId, double>> loaded;
    if (!options.scenario.empty()) {
        const auto scenario = scenario_given(options.scenario, SharedOptions{}.scenarios);
        if (!scenario) return Error{"--scenario " + scenario.error().message};
        // By the numbers of their rows: those of the dictionary that flight was built from.
        if (const auto of_flight = dictionary_of_flight(options.directory); !of_flight)
            return Error{"--scenario: " + of_flight.error().message};
        loaded = loaded_parameters(scenario->parameters);
    }
    commands::ParameterTable table{dictionary, loaded};
    for (const auto& file : options.after)
        if (const auto applied = apply(file, table); !applied) return applied.error();
    std::string text = "{\"commands\": [\n" + line_of("EDL_DISCARD_PARAMETERS");
    std::set<std::uint16_t> named;
    for (const std::string& given : options.changes) {
        const auto change = change_of(given, dictionary);
        if (!change) return change.error();
        if (!named.insert(change->id.value).second) return Error{given + ": the parameter is named twice"};
        if (const auto set = table.set(change->id, change->value); !set) return set.error();
        text += ",\n" + line_of(stage_command, {{"parameter", change->id.value}, {"value", change->value}});
    }
    if (const auto possible = table.check_deviations(); !possible) return possible.error();
    return text + ",\n" +
           line_of("EDL_ACTIVATE_PARAMETERS", {{"parameter_version", options.table},
                                               {"parameter_changes", static_cast<double>(options.changes.size())},
                                               {"parameter_crc", table.crc()}}) +
           "\n]}\n";
}

int parameters(const ParametersOptions& options) {
    const auto dictionary = loaded_dictionary(options.directory);
    if (!dictionary) return 1;
    const auto text = command_file(options, *dictionary);
    if (!text) return failed("parameters: " + text.error().message, 2);
    fmt::print("{}", *text);
    return 0;
}

}  // namespace

void add_parameters_command(CLI::App& program, int& exit_code) {
    const auto options = std::make_shared<ParametersOptions>();
    auto& command = *program.add_subcommand(
        "parameters",
        "prints the command file that changes flight's parameters, with the CRC of the table that it makes");
    command.add_option("CHANGES", options->changes, "NAME=VALUE, up to 32, names and ranges as in parameters.csv")
        ->required()
        ->expected(1, 32);
    command
        .add_option("--table", options->table, "version of the new table; it must differ from that of the table held")
        ->required()
        ->check(CLI::Range(1, 65535));
    command
        .add_option("--after", options->after,
                    "command file that changed the table held; give each such file, in their order; if left out, the "
                    "table held is the one built in")
        ->allow_extra_args(false);
    command.add_option("--scenario", options->scenario,
                       "a file, or the name of a shipped one: its vehicle is loaded with parameters of its own");
    command.add_option("--dictionary", options->directory, "the dictionary's directory")->capture_default_str();
    command.callback([options, &exit_code] { exit_code = parameters(*options); });
}

}  // namespace aeolis::server
