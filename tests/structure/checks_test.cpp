// SPDX-License-Identifier: Apache-2.0
#include "tests/structure/source_tree.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <algorithm>

namespace structure_checks_test {

using namespace aeolis::structure;

namespace {

bool some_line(const std::string& file, std::initializer_list<const char*> words) {
    for (const std::string& line : lines_of(file)) {
        bool all = !line.starts_with("#");
        for (const char* word : words) all = all && line.find(word) != std::string::npos;
        if (all) return true;
    }
    return false;
}

}  // namespace

TEST_CASE("every event and every tone of prime's that the dictionary words is asked for by flight or by a row of the "
          "timeline",
          "[structure][R48]") {
    const auto& dictionary = aeolis::tests::shipped_dictionary();
    std::string flight;
    for (const std::string& file : files_under("flight", {".cpp", ".hpp"}))
        for (const std::string& line : lines_of(file)) flight += line + '\n';
    std::string unused;
    for (const auto& event : dictionary.events) {
        const bool by_timeline =
            std::ranges::count(dictionary.timeline, event.name, &aeolis::dictionary::TimelineRow::event) > 0;
        if (!by_timeline && flight.find("evr::" + event.name) == std::string::npos) unused += event.name + ' ';
    }
    for (const auto& tone : dictionary.tones) {
        if (tone.set != aeolis::dictionary::ToneSet::prime) continue;
        const bool by_timeline =
            std::ranges::any_of(dictionary.timeline, [&](const auto& row) { return row.tone == tone.id; });
        if (!by_timeline && flight.find("tone::" + tone.name) == std::string::npos) unused += tone.name + ' ';
    }
    INFO("nobody asks for " << unused);
    CHECK(unused.empty());
}

TEST_CASE("static analysis, sanitizers and the memory checker are part of the checks, and reviews are recorded",
          "[structure][R37]") {
    CHECK(some_line(".ci/run", {"xargs", "clang-tidy-19"}));
    CHECK(some_line(".ci/run", {"flight", "status=1"}));
    CHECK(some_line(".ci/run", {"cppcheck", "--enable"}));
    CHECK(some_line("test", {"valgrind", "--error-exitcode"}));
    CHECK(some_line("CMakePresets.json", {"-fsanitize=address,undefined", "-fno-sanitize-recover=all"}));
    CHECK(some_line("CMakePresets.json", {"-fsanitize=thread"}));
    CHECK(some_line("test", {"build_target", "dev"}));
    CHECK(some_line("test", {"build_target", "tsan", "cpp threads tsan '[threads]'"}));
    CHECK(some_line("test", {"stage", "threads"}));
    CHECK(files_under("docs/reviews", {".md"}).size() >= 2);  // one beside the README
}

}  // namespace structure_checks_test
