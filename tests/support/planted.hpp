// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/support/catch.hpp"
#include "tests/support/mission_copy.hpp"

#include <string>

namespace aeolis::tests {

/// A rule broken by a small change of a shipped file, and the only finding that this must give.
struct Planted {
    const char* rule;
    const char* file;
    const char* find;  ///< first occurrence in the file
    const char* replace;
    const char* message;  ///< part of the finding's text
    int line_offset = 0;  ///< of the finding, from the first changed line
};

inline void check_planted(const Planted& planted) {
    INFO(planted.rule);
    const MissionCopy mission;
    std::string text = mission.text(planted.file);
    const std::size_t position = text.find(planted.find);
    REQUIRE(position != std::string::npos);
    const unsigned line = line_at(text, position) + static_cast<unsigned>(planted.line_offset);
    text.replace(position, std::string_view{planted.find}.size(), planted.replace);
    mission.write(planted.file, text);

    const dictionary::Loaded loaded = mission.load();
    INFO(lines_of(loaded));
    CHECK_FALSE(loaded.dictionary);
    REQUIRE(loaded.findings.size() == 1);
    CHECK(loaded.findings.front().file == planted.file);
    CHECK(loaded.findings.front().line == line);
    CHECK_THAT(loaded.findings.front().message, Catch::Contains(planted.message));
}

}  // namespace aeolis::tests
