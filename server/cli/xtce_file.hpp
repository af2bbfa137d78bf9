// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "dictionaries/xtce/packet_model.hpp"
#include "telemetry/time_source.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace aeolis::server {

/// Reads the text of a file. The Error is one line that names the file.
Result<std::string> text_of_file(const std::filesystem::path& path);

/// The XTCE of another mission, as given on the command line.
struct MissionXtce {
    std::vector<std::filesystem::path> files;
    std::string root;  ///< name of the container with which packets begin; empty: the only one that can
    std::string leading_size = "bits";  ///< what a LeadingSize counts: bits or octets
    std::string time;                   ///< telemetry::TimeSource; empty: as the file says

    bool empty() const { return files.empty(); }
    std::string text() const;  ///< the names of the files, without folders
};

/// The model read from it. Faults and unsupported elements have been printed to stderr with their files and lines.
struct XtceFile {
    std::optional<dictionary::xtce::PacketModel> model;  ///< none: the fault was printed
    int exit_code = 0;
    std::uint16_t id = 0;  ///< changes with every change of the files, and of the options given with them
    std::optional<telemetry::TimeSource> time{};
    std::size_t findings = 0;  ///< number of things in the files that are not understood
    explicit operator bool() const { return model.has_value(); }
};
XtceFile read_xtce(const MissionXtce& xtce);

}  // namespace aeolis::server
