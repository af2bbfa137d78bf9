// SPDX-License-Identifier: Apache-2.0
#include "server/cli/new_file.hpp"

#include <fstream>

namespace aeolis::server {

Result<void> can_be_made(const std::filesystem::path& file) {
    std::error_code ignored;
    if (std::filesystem::exists(file, ignored)) return Error{file.string() + " is there already"};
    if (file.has_parent_path() && !std::filesystem::is_directory(file.parent_path(), ignored))
        return Error{file.string() + " cannot be written: there is no folder " + file.parent_path().string()};
    return {};
}

Result<void> make_file(const std::filesystem::path& file, std::string_view octets) {
    if (const auto possible = can_be_made(file); !possible) return possible;
    std::ofstream to{file, std::ios::binary};
    to.write(octets.data(), static_cast<std::streamsize>(octets.size()));
    to.close();
    if (to.fail()) return Error{file.string() + " cannot be written"};
    return {};
}

}  // namespace aeolis::server
