// SPDX-License-Identifier: Apache-2.0
#include "server/cli/settings_file.hpp"

#include <CLI/CLI.hpp>
#include <cctype>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace aeolis::server {
namespace {

std::optional<std::filesystem::path> settings_given(int argc, char** argv) {
    constexpr std::string_view option = "--config";
    for (int i = 2; i < argc; ++i) {
        const std::string_view word = argv[i];
        if (word == option && i + 1 < argc) return argv[i + 1];
        if (word.starts_with(option) && word.substr(option.size()).starts_with('='))
            return word.substr(option.size() + 1);
    }
    return std::nullopt;
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
            return Error{fmt::format("{}: '{}' is no option of aeolis {} with one value", file.string(),
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
        std::string variable = "AEOLIS_" + name;
        for (char& c : variable) c = c == '-' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
        option->envname(variable);
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

Result<void> take_settings(CLI::App& program, int argc, char** argv) {
    if (argc < 2 || std::string_view{argv[1]} != "serve") return {};
    const auto file = settings_given(argc, argv);
    return file ? take_file(*program.get_subcommand("serve"), *file) : Result<void>{};
}

}  // namespace aeolis::server
