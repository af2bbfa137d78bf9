// SPDX-License-Identifier: Apache-2.0
// The repository's own files, as the structure tests read them.
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

namespace aeolis::structure {

/// Repository-relative paths, sorted, of the files under `folder` that end with one of `endings`.
inline std::vector<std::string> files_under(const std::string& folder, const std::vector<std::string>& endings) {
    namespace fs = std::filesystem;
    const fs::path root{AEOLIS_SOURCE_DIR};
    std::vector<std::string> found;
    if (!fs::exists(root / folder)) {
        return found;
    }
    for (auto entry = fs::recursive_directory_iterator(root / folder); entry != fs::recursive_directory_iterator{};
         ++entry) {
        if (entry->is_directory() &&
            (entry->path().filename() == "node_modules" || entry->path().filename() == "gen")) {
            entry.disable_recursion_pending();
            continue;
        }
        const std::string path = fs::relative(entry->path(), root).generic_string();
        if (entry->is_regular_file() &&
            std::any_of(endings.begin(), endings.end(), [&](const std::string& end) { return path.ends_with(end); })) {
            found.push_back(path);
        }
    }
    std::sort(found.begin(), found.end());
    return found;
}

inline std::string text_of(const std::string& path) {
    std::ifstream in{std::filesystem::path{AEOLIS_SOURCE_DIR} / path, std::ios::binary};
    return {std::istreambuf_iterator<char>{in}, {}};
}

inline std::vector<std::string> lines_of(const std::string& path) {
    std::ifstream in{std::filesystem::path{AEOLIS_SOURCE_DIR} / path};
    std::vector<std::string> lines;
    for (std::string line; std::getline(in, line);) {
        lines.push_back(line);
    }
    return lines;
}

inline std::string trimmed(std::string_view text) {
    const auto first = text.find_first_not_of(" \t");
    if (first == std::string_view::npos) {
        return {};
    }
    return std::string{text.substr(first, text.find_last_not_of(" \t") - first + 1)};
}

}  // namespace aeolis::structure
