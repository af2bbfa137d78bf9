#include "tests/structure/source_tree.hpp"
#include "tests/support/catch.hpp"

#include <map>

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

/// flight/timeline/timepoint.hpp → tests/flight/timepoint_test.cpp
std::string test_file_of(const std::string& header) {
    const std::string folder = header.substr(0, header.find('/'));
    const auto name = header.substr(header.rfind('/') + 1);
    return "tests/" + folder + "/" + name.substr(0, name.size() - 4) + "_test.cpp";
}

bool exists(const std::string& path) { return std::filesystem::exists(std::filesystem::path{AEOLIS_SOURCE_DIR} / path); }

} // namespace

TEST_CASE("every public header has a test file of its name, or a reason why not", "[structure]") {
    const auto excused = exceptions();
    std::string without;
    for (const std::string folder : {"common", "dictionaries", "flight", "telemetry", "commands"}) {
        for (const std::string& header : files_under(folder, {".hpp"})) {
            if (!exists(test_file_of(header)) && !excused.contains(header)) {
                without += header + " lacks " + test_file_of(header) + "\n";
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
        } else if (exists(test_file_of(header))) {
            stale += header + ": has its test file now\n";
        }
    }
    INFO(stale);
    CHECK(stale.empty());
}
