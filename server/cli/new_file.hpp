// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <filesystem>
#include <string_view>

// Files that a command makes and never replaces.
namespace aeolis::server {

/// Refuses, before the work, a file that is there already or whose folder is missing.
Result<void> can_be_made(const std::filesystem::path& file);
/// Fails when the file is there already or cannot be written whole.
Result<void> make_file(const std::filesystem::path& file, std::string_view octets);

}  // namespace aeolis::server
