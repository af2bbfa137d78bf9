// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <unistd.h>

// A copy of the shipped dictionary in its own folder, for a test to break.
namespace aeolis::tests {

inline const std::filesystem::path shipped_mission = std::filesystem::path{AEOLIS_SOURCE_DIR} / "dictionaries" / "msl";

inline std::string text_of(const std::filesystem::path& file) {
    std::ifstream in{file, std::ios::binary};
    return {std::istreambuf_iterator<char>{in}, {}};
}

class MissionCopy {
  public:
    MissionCopy() {
        static unsigned number = 0;
        path_ = std::filesystem::temp_directory_path() /
                ("aeolis-mission-" + std::to_string(::getpid()) + "-" + std::to_string(number++));
        std::filesystem::remove_all(path_);
        std::filesystem::copy(shipped_mission, path_, std::filesystem::copy_options::recursive);
    }
    MissionCopy(const MissionCopy&) = delete;
    MissionCopy& operator=(const MissionCopy&) = delete;
    ~MissionCopy() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }

    const std::filesystem::path& path() const { return path_; }
    std::string text(const std::string& file) const { return text_of(path_ / file); }
    void write(const std::string& file, std::string_view text) const {
        std::ofstream out{path_ / file, std::ios::binary | std::ios::trunc};
        out << text;
    }
    dictionary::Loaded load() const { return dictionary::load(path_); }

  private:
    std::filesystem::path path_;
};

/// The line, from 1, of the character at `position`.
inline unsigned line_at(std::string_view text, std::size_t position) {
    return 1 + static_cast<unsigned>(std::ranges::count(text.substr(0, position), '\n'));
}

/// All findings, one a line.
inline std::string lines_of(const dictionary::Loaded& loaded) {
    std::string lines;
    for (const auto& finding : loaded.findings) lines += finding.text() + "\n";
    return lines;
}

}  // namespace aeolis::tests
