// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace aeolis::server {

/// The text of a file of at most `octets_max`.
///
/// Fails, "FILE: why", for a directory, a file that cannot be opened, and a larger one.
/// @param what  it is to be, for the message: "scenario"
Result<std::string> bounded_text(const std::filesystem::path& file, std::size_t octets_max, std::string_view what);

}  // namespace aeolis::server
