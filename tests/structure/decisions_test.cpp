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

/// Every file of docs/decisions/ but the index.
std::vector<std::string> decision_records() {
    auto records = files_under("docs/decisions", {".md"});
    std::erase(records, "docs/decisions/README.md");
    return records;
}

}  // namespace

TEST_CASE("each decision record lists what the chosen way costs, and what each refused one would have",
          "[structure][R49]") {
    const auto records = decision_records();
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

TEST_CASE("the index of decisions names each record, with its title", "[structure][R49]") {
    const std::string index = text_of("docs/decisions/README.md");
    for (const std::string& record : decision_records()) {
        INFO(record);
        const std::string title = lines_of(record).front().substr(2);  // behind "# "
        const std::string file = record.substr(record.rfind('/') + 1);
        CHECK(index.find("[" + title + "](" + file + ")") != std::string::npos);
    }
}

}  // namespace structure_decisions_test
