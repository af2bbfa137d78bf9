// SPDX-License-Identifier: Apache-2.0
#include "tests/structure/source_tree.hpp"
#include "tests/support/catch.hpp"

#include <map>
#include <sstream>

namespace structure_public_headers_test {

using namespace aeolis::structure;

namespace {

/// Header → why it has no test file of its own.
std::map<std::string, std::string> exceptions() {
    std::map<std::string, std::string> found;
    for (const std::string& line : lines_of("tests/structure/exceptions.txt")) {
        if (line.empty() || line.front() == '#') {
            continue;
        }
        const auto space = line.find(' ');
        found[line.substr(0, space)] = space == std::string::npos ? "" : trimmed(std::string_view{line}.substr(space));
    }
    return found;
}

/// flight/gnc/mars.hpp → tests/flight/mars_test.cpp, or with a folder's name before it: tests/flight/gnc_mars_test.cpp
std::vector<std::string> test_files_of(const std::string& header) {
    std::vector<std::string> parts;
    std::stringstream path{header};
    for (std::string part; std::getline(path, part, '/');) {
        parts.push_back(part);
    }
    const std::string name = parts.back().substr(0, parts.back().size() - 4) + "_test.cpp";
    std::vector<std::string> files{"tests/" + parts.front() + "/" + name};
    for (std::size_t i = 1; i + 1 < parts.size(); ++i) {
        files.push_back("tests/" + parts.front() + "/" + parts[i] + "_" + name);
    }
    return files;
}

bool exists(const std::string& path) {
    return std::filesystem::exists(std::filesystem::path{AEOLIS_SOURCE_DIR} / path);
}

bool has_test_file(const std::string& header) {
    const auto files = test_files_of(header);
    return std::any_of(files.begin(), files.end(), exists);
}

}  // namespace

TEST_CASE("every public header has a test file of its name, or a reason why not", "[structure]") {
    const auto excused = exceptions();
    std::string without;
    for (const std::string folder : {"common", "dictionaries", "flight", "telemetry", "commands"}) {
        for (const std::string& header : files_under(folder, {".hpp"})) {
            if (!has_test_file(header) && !excused.contains(header)) {
                without += header + " lacks " + test_files_of(header).front() + "\n";
            }
        }
    }
    INFO(without);
    CHECK(without.empty());
}

TEST_CASE("every exception has a reason and is still needed", "[structure]") {
    std::string stale;
    for (const auto& [header, reason] : exceptions()) {
        if (reason.empty()) {
            stale += header + ": no reason\n";
        } else if (!exists(header)) {
            stale += header + ": no such header\n";
        } else if (has_test_file(header)) {
            stale += header + ": has its test file now\n";
        }
    }
    INFO(stale);
    CHECK(stale.empty());
}

}  // namespace structure_public_headers_test
