// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/autocoder/parameters_header.hpp"

#include "generated/parameters.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/mission_copy.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <algorithm>
#include <string>
#include <vector>

namespace dictionaries_parameters_header_test {

using namespace aeolis;
using Change = dictionary::ParameterRow::Change;

namespace {

const dictionary::ParameterRow& row(std::string_view name) {
    const auto& rows = tests::shipped_dictionary().parameters;
    const auto found = std::ranges::find(rows, name, &dictionary::ParameterRow::name);
    INFO(name);
    REQUIRE(found != rows.end());
    return *found;
}

}  // namespace

TEST_CASE("flight was built from the parameters that the ground loads, by id", "[dictionary][autocoder][R25][R48]") {
    const auto& dictionary = tests::shipped_dictionary();
    CHECK(tests::text_of(std::filesystem::path{AEOLIS_BINARY_DIR} / "generated" / "parameters.hpp") ==
          dictionary::autocoder::parameters_header(dictionary));
    REQUIRE(flight::parameter_count == dictionary.parameters.size());
    const flight::Parameters parameters;
    for (std::size_t i = 0; i < flight::parameter_count; ++i) {
        const auto& of_ground = dictionary.parameters[i];
        const auto& spec = flight::parameter_specs.at(i);
        INFO(of_ground.name);
        CHECK(of_ground.id.value == i);
        CHECK(spec.min == of_ground.min);
        CHECK(spec.max == of_ground.max);
        CHECK((spec.member == nullptr) == (of_ground.change == Change::build));
        CHECK((spec.member != nullptr ? parameters.*spec.member : spec.fixed) == of_ground.default_value);
    }
    CHECK(dictionary.parameters[flight::parameter::guidance_gain.value].name == "guidance_gain");
}

TEST_CASE("few parameters are fixed at build, and each says why", "[dictionary][R25]") {
    std::size_t fixed = 0;
    for (const auto& parameter : tests::shipped_dictionary().parameters) {
        if (parameter.change != Change::build) continue;
        ++fixed;
        INFO(parameter.name);
        CHECK_THAT(parameter.text, Catch::Contains("Fixed: "));
    }
    CHECK(fixed <= 19);
}

TEST_CASE("what ground judges the timeline by is fixed, so that ground and board judge by the same numbers",
          "[dictionary][R25][R51]") {
    // commands/timeline_judge, server/archive/reader_timepoints, and flight's own navigation of the time of entry.
    for (const char* const name : {"entry_moved_max_s", "do_edl_margin_s", "late_cruise_before_entry_s",
                                   "entry_radius_m", "entry_step_fraction", "entry_steps_max"})
        CHECK(row(name).change == Change::build);
}

TEST_CASE("no change of a parameter breaks what the proof of the timeline takes as ensured by GNC",
          "[dictionary][timeline][R19][R25][R51]") {
    // The bounds above zero of the rows `ensured`, and the parameters by which GNC keeps them.
    const std::vector<std::pair<std::string_view, std::string_view>> kept_by{
        {"heatshield", "heatshield_delay_min_s"},
        {"powered_approach", "powered_approach_delay_s"},
        {"rover_separation", "sky_crane_settle_s"},
    };
    std::size_t bounds = 0;
    const auto& dictionary = tests::shipped_dictionary();
    for (const auto& constraint : dictionary.constraints) {
        if (constraint.kind != dictionary::ConstraintRow::Kind::ensured) continue;
        if (constraint.minimum_s.value_or(0.0) <= 0.0) continue;
        const std::string& anchor = dictionary.anchors[constraint.to.index].name;
        const auto kept = std::ranges::find(kept_by, anchor, &std::pair<std::string_view, std::string_view>::first);
        INFO(anchor);
        REQUIRE(kept != kept_by.end());
        CHECK(row(kept->second).min >= *constraint.minimum_s);
        ++bounds;
    }
    CHECK(bounds == kept_by.size());
}

}  // namespace dictionaries_parameters_header_test
