// SPDX-License-Identifier: Apache-2.0
#include "server/cli/settings_file.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace aeolis::server {
namespace {

/// The value of an option on the command line of `serve`.
std::optional<std::string> on_command_line(int argc, char** argv, std::string_view name) {
    const auto option = "--" + std::string{name};
    for (int i = 2; i < argc; ++i) {
        const std::string_view word = argv[i];
        if (word == option && i + 1 < argc) return argv[i + 1];
        if (word.starts_with(option) && word.substr(option.size()).starts_with('='))
            return std::string{word.substr(option.size() + 1)};
    }
    return std::nullopt;
}

std::string variable_of(std::string_view option) {
    auto variable = "AEOLIS_" + std::string{option};
    for (char& c : variable) c = c == '-' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    return variable;
}

bool is_given(const CLI::Option& option, std::span<const std::string> words) {
    const auto gives = [&](const std::string& word) {
        const auto is_long = [&](const std::string& name) {
            return word == "--" + name || word.starts_with("--" + name + "=");
        };
        const auto is_short = [&](const std::string& name) { return word.starts_with("-" + name); };
        return std::ranges::any_of(option.get_lnames(), is_long) || std::ranges::any_of(option.get_snames(), is_short);
    };
    return std::ranges::any_of(words, gives);
}

bool serves(int argc, char** argv) {
    return argc >= 2 && std::string_view{argv[1]} == "serve";
}

Result<std::vector<CLI::ConfigItem>> lines_of(const std::filesystem::path& file) {
    std::ifstream in{file};
    if (!in) return Error{file.string() + " cannot be read"};
    CLI::ConfigINI reader;
    reader.arrayBounds(
        '\x01',
        '\x01');  // otherwise it splits values at commas and blanks, as options with several values do themselves
    return reader.from_config(in);
}

Result<void> take_file(CLI::App& command, const std::filesystem::path& file) {
    const auto lines = lines_of(file);
    if (!lines) return lines.error();
    for (const auto& item : *lines) {
        auto* option = item.name == "config" ? nullptr : command.get_option_no_throw("--" + item.name);
        if (option == nullptr || item.inputs.size() != 1)
            return Error{fmt::format("{}: '{}' is not an option of aeolis {} that takes one value", file.string(),
                                     item.fullname(), command.get_name())};
        try {
            option->run_callback_for_default()->default_val(item.inputs.front());
        } catch (const CLI::Error& error) {
            return Error{file.string() + ": " + error.what()};
        }
    }
    return {};
}

}  // namespace

void name_environment(CLI::App& command) {
    for (auto* option : command.get_options()) {
        const auto& name = option->get_lnames().front();
        if (name == "help" || name == "config") continue;
        option->envname(variable_of(name));
    }
}

Result<std::optional<std::string>> setting_in_file(const std::filesystem::path& file, std::string_view option) {
    const auto lines = lines_of(file);
    if (!lines) return lines.error();
    std::optional<std::string> value;
    for (const auto& item : *lines)
        if (item.name == option && item.inputs.size() == 1) value = item.inputs.front();
    return value;
}

std::vector<std::string> with_environment(const CLI::App& program, int argc, char** argv) {
    std::vector<std::string> words{argv + std::min(argc, 1), argv + argc};
    const CLI::App* command = &program;
    std::size_t behind = 0;
    while (behind < words.size()) {
        const auto named =
            command->get_subcommands([&](const CLI::App* each) { return each->get_name() == words[behind]; });
        if (named.empty()) break;
        command = named.front();
        ++behind;
    }
    std::vector<std::string> set;
    for (const CLI::Option* option : command->get_options()) {
        const auto variable = option->get_envname();
        if (variable.empty() || option->get_lnames().empty() || is_given(*option, words)) continue;
        if (const char* const value = std::getenv(variable.c_str()); value != nullptr && *value != '\0')
            set.push_back(fmt::format("--{}={}", option->get_lnames().front(), value));
    }
    words.insert(words.begin() + static_cast<std::ptrdiff_t>(behind), set.begin(), set.end());
    return words;
}

std::optional<std::string> setting_given(int argc, char** argv, std::string_view option) {
    if (!serves(argc, argv)) return std::nullopt;
    if (auto given = on_command_line(argc, argv, option)) return given;
    if (const char* const variable = std::getenv(variable_of(option).c_str())) return variable;
    const auto file = on_command_line(argc, argv, "config");
    if (!file) return std::nullopt;
    auto set = setting_in_file(*file, option);
    return set ? std::move(*set) : std::nullopt;
}

Result<void> take_settings(CLI::App& program, int argc, char** argv) {
    if (!serves(argc, argv)) return {};
    const auto file = on_command_line(argc, argv, "config");
    return file ? take_file(*program.get_subcommand("serve"), *file) : Result<void>{};
}

}  // namespace aeolis::server
