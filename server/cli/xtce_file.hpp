// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "dictionaries/xtce/packet_model.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace aeolis::server {

/// Reads the text of a file. The Error is one line that names the file.
Result<std::string> text_of_file(const std::filesystem::path& path);

/// Any mission's XTCE file. Faults and unsupported elements have been printed to stderr with their lines.
struct XtceFile {
    std::optional<dictionary::xtce::PacketModel> model;  ///< none: the fault was printed
    int exit_code = 0;
    std::uint16_t id = 0;  ///< changes with every change of the file
    explicit operator bool() const { return model.has_value(); }
};
/// @param root  name of the container with which packets begin; empty: the only one that can
XtceFile read_xtce_file(const std::filesystem::path& path, const std::string& root);

}  // namespace aeolis::server
