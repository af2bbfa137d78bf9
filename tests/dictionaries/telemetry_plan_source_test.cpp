// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/autocoder/telemetry_plan_source.hpp"

#include "tests/support/mission_copy.hpp"
#include "tests/support/shipped_dictionary.hpp"

namespace dictionaries_telemetry_plan_source_test {

using namespace aeolis;

TEST_CASE("each row of the plan is code under its line, with plan, packet and priority as symbols",
          "[dictionary][autocoder][R30][R40]") {
    const auto& dictionary = tests::shipped_dictionary();
    const std::string source = dictionary::autocoder::telemetry_plan_source(dictionary);
    for (const auto& row : dictionary.telemetry_plan) {
        INFO(row.packet);
        const std::string line = "#line " + std::to_string(row.line) + " \"telemetry_plan.csv\"\n    {";
        const std::size_t begin = source.find(line);
        REQUIRE(begin != std::string::npos);
        const std::size_t from = begin + line.size();
        const std::string code = source.substr(from, source.find('\n', from) - from);
        CHECK_THAT(code, Catch::StartsWith(row.plan == "all" ? "std::nullopt, " : "Plan::" + row.plan + ", "));
        if (row.packet != "events") CHECK_THAT(code, Catch::Contains("packet::" + row.packet + "::apid, "));
        CHECK_THAT(code, Catch::Contains(".entry = " + std::to_string(row.every[1]) + ", "));
    }
    CHECK_THAT(source, Catch::Contains("evr::COMMAND_ACCEPTED::apid, TelemetryPriority::first, "));
    CHECK(tests::text_of(std::filesystem::path{AEOLIS_BINARY_DIR} / "generated" / "telemetry_plan.cpp") == source);
}

}  // namespace dictionaries_telemetry_plan_source_test
