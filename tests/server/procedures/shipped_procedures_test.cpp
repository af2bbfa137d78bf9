// SPDX-License-Identifier: Apache-2.0
#include "server/procedures/procedure_reader.hpp"
#include "server/procedures/procedure_text.hpp"
#include "tests/server/procedures/written_procedure.hpp"
#include "tests/support/catch.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace server_procedures_shipped_procedures_test {

using namespace aeolis;
using namespace aeolis::server::procedures;

namespace {

const std::filesystem::path folder = AEOLIS_SOURCE_DIR "/dictionaries/msl/procedures";

std::vector<std::string> shipped_names() {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator{folder}) names.push_back(entry.path().stem().string());
    std::ranges::sort(names);
    return names;
}

Procedure shipped_procedure(const std::string& name) {
    std::ifstream file{folder / (name + ".yaml"), std::ios::binary};
    const std::string text{std::istreambuf_iterator<char>{file}, {}};
    const auto read = read_procedure(text, name + ".yaml", tests::shipped_dictionary(), shipped_names());
    for (const auto& finding : read.findings) UNSCOPED_INFO(finding.text());
    REQUIRE(read.procedure);
    return *read.procedure;
}

}  // namespace

TEST_CASE("the eight procedures that ship break no rule of the shipped dictionary", "[procedures]") {
    CHECK(shipped_names() == std::vector<std::string>{"commanding_closed", "computer_reset", "day_after",
                                                      "navigation_delivery", "second_chance_enabled", "start",
                                                      "tones_lost", "uhf_lost"});
    for (const std::string& name : shipped_names()) {
        INFO(name);
        const auto procedure = shipped_procedure(name);
        CHECK(procedure.approvals.empty());  // nobody has approved them, and none says so
        CHECK_THAT(procedure.source, Catch::Contains("Aeolis's own."));
    }
}

TEST_CASE("a procedure is printed for paper: no line is too long, and each step has its box, its people and its words",
          "[procedures]") {
    for (const std::string& name : shipped_names()) {
        INFO(name);
        const auto procedure = shipped_procedure(name);
        const std::string page = printed(procedure, tests::shipped_dictionary());
        std::size_t column = 0;
        for (const char c : page) {
            if ((static_cast<unsigned char>(c) & 0xC0U) == 0x80U) continue;
            column = c == '\n' ? 0 : column + 1;
            CHECK(column <= page_columns);
        }
        for (const auto* part : {&procedure.preconditions, &procedure.body, &procedure.confirmation})
            for (const Step& step : *part)
                CHECK_THAT(page, Catch::Contains("[ ]   " + step.id + ", " + std::string{name_of(step.who)} + "\n"));
    }
    const std::string page = printed(shipped_procedure("second_chance_enabled"), tests::shipped_dictionary());
    CHECK_THAT(page, Catch::Contains("send: SECOND_CHANCE_ENABLE enabled=yes\n") &&
                         Catch::Contains("warning: Whether Second Chance may land the vehicle when the prime") &&
                         Catch::Contains("HOLD until released by flight_director ____") &&
                         Catch::Contains("by E−47:00 sent\n") &&
                         Catch::Contains("( ) No go: go to the end, not confirmed\n") &&
                         Catch::Contains("check: second_chance_enabled == true for 10 s\n") &&
                         Catch::Contains("approved    by nobody: a draft\n"));
}

TEST_CASE("an approved redline is the step's text, printed beside the one before; others are named as not approved",
          "[procedures]") {
    tests::WrittenProcedure written;
    written.rest =
        "redlines:\n  - {step: a, do: A at once., reason: R, by: B. Li, on: 2026-11-28, approved_by: A. Ng}\n"
        "  - {step: a, do: A later., reason: S, by: C. Yo, on: 2026-11-29}\n";
    const auto procedure = tests::procedure_of(written);
    CHECK(text_now(procedure, procedure.body.at(0)) == "A at once.");
    const std::string page = printed(procedure, tests::shipped_dictionary());
    CHECK_THAT(page,
               Catch::Contains("[ ]   a, gnc\n      A at once.\n      REDLINED; before: A\n"
                               "      REDLINE NOT APPROVED: A later.\n") &&
                   Catch::Contains("step a, by B. Li on 2026-11-28, approved by A. Ng\n      now: A at once.\n      "
                                   "because R\n") &&
                   Catch::Contains("step a, by C. Yo on 2026-11-29, not approved\n"));
}

}  // namespace server_procedures_shipped_procedures_test
