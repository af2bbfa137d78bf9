// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/cli/shipped_paths.hpp"
#include "server/cli/xtce_file.hpp"
#include "server/cluster/engine.hpp"
#include "server/links/frame_format.hpp"

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

// Options shared by several subcommands.
namespace aeolis::server {

/// Adds --dictionary and --scenarios.
void add_shared(CLI::App& command, SharedOptions& shared);

/// Refuses text that CLI11 would accept for an unsigned number, such as -1.
CLI::Validator whole_number();

/// Adds the options for how a file or link carries packets. @return the options, each of which may need another
std::vector<CLI::Option*> add_stream_format(CLI::App& command, PacketStreamFormat& format);
/// Adds --xtce, which may be given several times, and the options that go with it: --root, --leading-size, --time.
/// @return --xtce
CLI::Option* add_mission_xtce(CLI::App& command, MissionXtce& xtce, const std::string& description);

/// Adds --nats and the options that go with it. @return --nats
CLI::Option* add_engine(CLI::App& command, cluster::EngineAddress& address, const std::string& description);
/// Adds how a program shows an engine who it is.
std::vector<CLI::Option*> add_engine_credentials(CLI::App& command, cluster::EngineAddress& address);

inline constexpr const char* default_archive = "run-data/aeolis.db";

/// The archive to read, and the dictionary to read it with.
struct ArchiveOptions {
    SharedOptions shared;
    std::filesystem::path archive = default_archive;
    MissionXtce xtce;  ///< of the mission that was followed; empty: the dictionary's own
    std::optional<std::uint32_t> run;
};
void add_archive_file(CLI::App& command, std::filesystem::path& archive);
/// Adds --archive, --dictionary, --xtce and the options that go with --xtce.
void add_archive_and_dictionary(CLI::App& command, ArchiveOptions& options);

}  // namespace aeolis::server
