// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/api/http_message.hpp"

#include <filesystem>
#include <string_view>

namespace aeolis::server {

/// Serves the built console: the files of one directory and nothing outside it. "/" gives index.html. Without a built
/// console, a page says how to build it.
class StaticFiles {
  public:
    static constexpr std::uintmax_t file_octets_max = 16 << 20;  ///< chosen: the console is below 1 MB

    explicit StaticFiles(std::filesystem::path directory) : directory_(std::move(directory)) {}
    /// Whether the path may be one of the console's files: "/", or a name with a dot outside /api/. Looks at no disk.
    static bool may_have(std::string_view path) {
        return path == "/" || (path.find('.') != std::string_view::npos && !path.starts_with("/api/"));
    }
    HttpResponse file(std::string_view path) const;

  private:
    std::filesystem::path directory_;
};

}  // namespace aeolis::server
