// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/api/http_message.hpp"

#include <filesystem>
#include <string_view>

namespace aeolis::server {

/// Serves the built console: the files of one directory and nothing outside it. "/" and the console's own views (paths
/// without a dot) give index.html. Without a built console, a page says how to build it.
class StaticFiles {
  public:
    static constexpr std::uintmax_t file_octets_max = 16 << 20;  ///< chosen: the console is below 1 MB

    explicit StaticFiles(std::filesystem::path directory) : directory_(std::move(directory)) {}
    HttpResponse file(std::string_view path) const;

  private:
    std::filesystem::path directory_;
};

}  // namespace aeolis::server
