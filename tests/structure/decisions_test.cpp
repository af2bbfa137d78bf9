// SPDX-License-Identifier: Apache-2.0
#include "tests/structure/source_tree.hpp"
#include "tests/support/catch.hpp"

namespace structure_decisions_test {

using namespace aeolis::structure;

namespace {

/// The bullets under the bold heading that begins with `heading`, each with its continued lines.
std::vector<std::string> bullets_under(const std::string& file, const std::string& heading) {
    std::vector<std::string> bullets;
    bool inside = false;
    for (const std::string& line : lines_of(file)) {
        if (line.starts_with("**")) {
            inside = line.starts_with("**" + heading);
        } else if (inside && line.starts_with("- ")) {
            bullets.push_back(line);
        } else if (inside && line.starts_with("  ") && !bullets.empty()) {
            bullets.back() += line;
        }
    }
    return bullets;
}

}  // namespace

TEST_CASE("each decision record lists what the chosen way costs, and what each refused one would have",
          "[structure][R49]") {
    const auto records = files_under("docs/decisions", {".md"});
    CHECK(records.size() >= 4);
    for (const std::string& record : records) {
        INFO(record);
        CHECK(!bullets_under(record, "What the way chosen costs").empty());
        const auto refused = bullets_under(record, "What was refused, and what it would have cost");
        CHECK(!refused.empty());
        for (const std::string& way : refused) {
            INFO(way);
            CHECK(way.find("ost") != std::string::npos);  // "Cost: …", "costs …"
        }
    }
}

}  // namespace structure_decisions_test
