// SPDX-License-Identifier: Apache-2.0
#include "server/archive/sample_table.hpp"
#include "tests/server/small_mission.hpp"
#include "tests/support/catch.hpp"

#include <array>
#include <limits>

namespace archive_sample_table_test {

using namespace aeolis;
using namespace aeolis::archive;

TEST_CASE("samples become rows that plain SQL reads, in a file that is whole or not there", "[archive][export]") {
    test::TemporaryFolder folder;
    const auto dictionary = test::small_dictionary();
    const auto file = folder / "samples.db";
    const double infinity = std::numeric_limits<double>::infinity();
    const std::array samples{ChannelValue{test::altitude, 12.5, Sclk{1001.0}, Source::realtime},
                             ChannelValue{test::speed, -infinity, Sclk{1002.0}, Source::recorded}};
    {
        auto abandoned = SampleTable::create(file);
        REQUIRE(abandoned.ok());
        REQUIRE(abandoned->add(RunId{3}, Sclk{1000.0}, dictionary, samples).ok());
    }
    CHECK_FALSE(std::filesystem::exists(file));
    auto table = SampleTable::create(file);
    REQUIRE(table.ok());
    REQUIRE(table->add(RunId{3}, Sclk{1000.0}, dictionary, samples).ok());
    REQUIRE(table->finish().ok());
    auto database = sqlite::Database::open(file.string(), sqlite::Mode::read_only);
    auto rows = database->prepare("SELECT run, channel, sclk, e_s, value, unit, source FROM samples ORDER BY sclk");
    REQUIRE(rows.ok());
    REQUIRE(*rows->step());
    CHECK(rows->integer(0) == 3);
    CHECK(rows->text(1) == "altitude_m");
    CHECK(rows->real(2) == 1001.0);
    CHECK(rows->real(3) == 1.0);
    CHECK(rows->real(4) == 12.5);
    CHECK(rows->text(5) == "m");
    CHECK(rows->text(6) == "realtime");
    REQUIRE(*rows->step());
    CHECK(rows->real(4) == -infinity);
    CHECK_FALSE(*rows->step());
    CHECK(SampleTable::create(file).error().message == file.string() + " is there already: nothing is overwritten");
}

}  // namespace archive_sample_table_test
