// SPDX-License-Identifier: Apache-2.0
#include "telemetry/silence_class.hpp"

#include "tests/support/catch.hpp"

#include <set>
#include <string>

namespace telemetry_silence_class_test {

using namespace aeolis::telemetry;

TEST_CASE("the reason of a silence is its class in words, then what ground knows of it", "[station][silence]") {
    CHECK(reason_text(SilenceClass::blackout, "predicted from E+0:45 to E+1:38") ==
          "plasma blackout: predicted from E+0:45 to E+1:38");
    CHECK(reason_text(SilenceClass::recording_complete, "") == "recording complete");
    CHECK(reason_text({}, "nominal") == "nominal");
}

TEST_CASE("each class of silence has its own name, and the API's names are those of the classes",
          "[station][silence]") {
    CHECK(std::string{name_of(SilenceClass::light_time)} == "light_time");
    CHECK(std::string{name_of(SilenceClass::earth_set)} == "earth_set");
    CHECK(std::string{name_of(SilenceClass::unexplained)} == "unexplained");
    std::set<std::string> names;
    for (std::size_t i = 0; i < silence_classes; ++i) names.insert(name_of(static_cast<SilenceClass>(i)));
    CHECK(names.size() == silence_classes);
}

TEST_CASE("a silence that is over awaits nothing, and one that should not be is lost", "[station][silence]") {
    int over = 0, lost = 0;
    for (std::size_t i = 0; i < silence_classes; ++i) {
        over += static_cast<int>(is_over(static_cast<SilenceClass>(i)));
        lost += static_cast<int>(is_lost(static_cast<SilenceClass>(i)));
    }
    CHECK(over == 3);
    CHECK(lost == 2);
    CHECK(is_lost(SilenceClass::unexplained));
    CHECK_FALSE(is_lost(SilenceClass::blackout));
}

}  // namespace telemetry_silence_class_test
