// SPDX-License-Identifier: Apache-2.0
#include "tests/structure/source_tree.hpp"
#include "tests/support/catch.hpp"

#include <array>
#include <cstdio>
#include <iostream>
#include <map>
#include <memory>
#include <regex>
#include <set>

namespace structure_verification_matrix_test {

using namespace aeolis::structure;

namespace {

constexpr int rows_in_matrix = 63;

struct Row {
    std::string claim;
    std::string state;
    std::vector<std::string> tests;  // names of Catch2 tests, or paths of files that the other runners take
};

/// Rows of docs/verification.md: | R1 | claim | open or shown | `test`<br>`test` |
std::vector<std::pair<int, Row>> matrix() {
    static const std::regex line_pattern{R"(^\| R(\d+) \|([^|]*)\|([^|]*)\|([^|]*)\|\s*$)"};
    static const std::regex test_pattern{"`([^`]+)`"};
    std::vector<std::pair<int, Row>> rows;
    for (const std::string& line : lines_of("docs/verification.md")) {
        std::smatch match;
        if (!std::regex_match(line, match, line_pattern)) {
            continue;
        }
        Row row{trimmed(match[2].str()), trimmed(match[3].str()), {}};
        const std::string tests = match[4];
        for (std::sregex_iterator it{tests.begin(), tests.end(), test_pattern}, end; it != end; ++it) {
            row.tests.push_back((*it)[1]);
        }
        rows.emplace_back(std::stoi(match[1]), row);
    }
    return rows;
}

/// What this executable has registered, asked of the executable itself.
std::set<std::string> listed_by_this_executable(const std::string& arguments) {
    const std::string program = std::filesystem::read_symlink("/proc/self/exe").string();
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe{
        popen(("'" + program + "' " + Catch::list_names + " " + arguments).c_str(), "r"), pclose};
    REQUIRE(pipe);
    std::string text;
    std::array<char, 4096> chunk{};
    for (std::size_t read = 0; (read = std::fread(chunk.data(), 1, chunk.size(), pipe.get())) > 0;) {
        text.append(chunk.data(), read);
    }
    std::set<std::string> names;
    for (std::size_t start = 0; start < text.size();) {
        const std::size_t end = std::min(text.find('\n', start), text.size());
        names.insert(trimmed(std::string_view{text}.substr(start, end - start)));
        start = end + 1;
    }
    return names;
}

/// Test name → its tags, read from the sources, where adjacent literals make one name.
std::map<std::string, std::string> tags_in_sources() {
    static const std::regex test{R"re(TEST_CASE\(\s*((?:"(?:[^"\\]|\\.)*"\s*)+),\s*((?:"[^"]*"\s*)+)\))re"};
    static const std::regex literal{R"re("((?:[^"\\]|\\.)*)")re"};
    const auto joined = [](const std::string& text) {
        std::string all;
        for (std::sregex_iterator it{text.begin(), text.end(), literal}, end; it != end; ++it) {
            all += (*it)[1];
        }
        return std::regex_replace(all, std::regex{R"(\\(.))"}, "$1");
    };
    std::map<std::string, std::string> tags;
    for (const std::string& file : files_under("tests", {"_test.cpp"})) {
        const std::string text = text_of(file);
        for (std::sregex_iterator it{text.begin(), text.end(), test}, end; it != end; ++it) {
            tags[joined((*it)[1])] = joined((*it)[2]);
        }
    }
    return tags;
}

/// Whether ./test gives this file to node's or the console's runner.
bool is_run_by_file(const std::string& path) {
    const bool browser = path.starts_with("tests/browser/") && path.ends_with("_test.mjs");
    const bool console = path.starts_with("web/src/") && path.find(".spec.ts") != std::string::npos;
    const bool runner = path == "test" || path == "setup/lint";  // sanitizers and lint are what these do
    return (browser || console || runner) && std::filesystem::exists(std::filesystem::path{AEOLIS_SOURCE_DIR} / path);
}

}  // namespace

TEST_CASE("the verification matrix has each of R1 to R63 once, open or shown by tests", "[structure]") {
    std::map<int, int> times;
    for (const auto& [number, row] : matrix()) {
        INFO("R" << number);
        ++times[number];
        CHECK(!row.claim.empty());
        CHECK((row.state == "open" || row.state == "shown"));
        CHECK((row.state == "shown") == !row.tests.empty());
    }
    for (int number = 1; number <= rows_in_matrix; ++number) {
        INFO("R" << number);
        CHECK(times[number] == 1);
    }
    CHECK(times.size() == rows_in_matrix);
}

TEST_CASE("every test that the verification matrix names runs, and carries the row's tag", "[structure]") {
    const auto registered = listed_by_this_executable("");
    const auto hidden = listed_by_this_executable("'[.]'");
    const auto tags = tags_in_sources();
    std::string wrong;
    int open = 0;
    std::string open_rows;
    for (const auto& [number, row] : matrix()) {
        const std::string tag = "[R" + std::to_string(number) + "]";
        if (row.state == "open") {
            ++open;
            open_rows += " R" + std::to_string(number);
        }
        for (const std::string& test : row.tests) {
            if (is_run_by_file(test)) {
                continue;
            }
            if (!registered.contains(test) || hidden.contains(test)) {
                wrong += tag + " names what ./test does not run: " + test + "\n";
            } else if (!tags.contains(test) || tags.at(test).find(tag) == std::string::npos) {
                wrong += tag + " names a test without its tag: " + test + "\n";
            }
        }
    }
    std::cout << "verification matrix: " << open << " of " << rows_in_matrix << " rows are open:" << open_rows << "\n";
    INFO(wrong);
    CHECK(wrong.empty());
}

TEST_CASE("no test's name has a colon so late that Catch2 cannot indent behind it: it would write without end",
          "[structure]") {
    constexpr std::size_t late = 75;  // a heading has 79 columns, and a letter with its hyphen takes two
    for (const auto& [name, tags] : tags_in_sources()) {
        const auto colon = name.find(": ");
        INFO(name);
        CHECK((colon == std::string::npos || colon <= late));
    }
}

TEST_CASE("no test's name has a quotation mark: in a file of names Catch2 takes the name as ending there",
          "[structure]") {
    for (const auto& [name, tags] : tags_in_sources()) {
        INFO(name);
        CHECK(name.find('"') == std::string::npos);
    }
}

}  // namespace structure_verification_matrix_test
