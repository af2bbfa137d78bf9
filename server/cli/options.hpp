// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/cli/shipped_paths.hpp"
#include "server/links/frame_format.hpp"

#include <CLI/CLI.hpp>
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>

// Options that several subcommands have.
namespace aeolis::server {

/// --dictionary and --scenarios.
void add_shared(CLI::App& command, SharedOptions& shared);

/// Refuses what CLI11 reads into an unsigned number without complaint, such as -1.
CLI::Validator whole_number();

/// How a file or link carries packets. @return the options, each of which may need another
std::array<CLI::Option*, 3> add_stream_format(CLI::App& command, DownlinkForm& format);

inline constexpr const char* default_archive = "run-data/aeolis.db";

/// Which archive is read, and by which dictionary.
struct ArchiveOptions {
    SharedOptions shared;
    std::filesystem::path archive = default_archive;
    std::filesystem::path xtce;  ///< of the mission that was followed; empty: the dictionary's own
    std::optional<std::uint32_t> run;
};
void add_archive_file(CLI::App& command, std::filesystem::path& archive);
/// --archive, --dictionary and --xtce.
void add_archive_and_words(CLI::App& command, ArchiveOptions& options);

}  // namespace aeolis::server
