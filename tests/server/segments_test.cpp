#include "server/archive/archive.hpp"
#include "server/archive/packet_columns.hpp"
#include "server/archive/sqlite.hpp"
#include "server/pipeline/segment_builder.hpp"
#include "tests/server/small_mission.hpp"
#include "tests/support/catch.hpp"

#include <array>
#include <cmath>
#include <limits>

using namespace aeolis;
using namespace aeolis::archive;
using pipeline::SegmentBuilder;

namespace {

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
constexpr std::uint16_t navigation = 0, status = 1; // packets of the small mission

struct Fixture {
    dictionary::Dictionary dictionary = test::small_dictionary();
    PacketColumns columns{dictionary};
    SegmentBuilder builder{columns, 4};
    std::vector<SegmentRecord> full;

    void add(Sequence unit, Source source, double altitude_m, double speed_mps) {
        const std::array values{altitude_m, speed_mps};
        builder.add(navigation, source, unit, Sclk{static_cast<double>(unit)}, values, full);
    }
};

} // namespace

TEST_CASE("a packet's channels are its columns, and a channel knows its packets", "[segments]") {
    Fixture fixture;
    CHECK(fixture.columns.channels(navigation) == std::vector<ChannelId>{test::altitude, test::speed});
    CHECK(fixture.columns.channels(3).empty()); // an event: its fields are no channels
    REQUIRE(fixture.columns.places(test::phase).size() == 1);
    CHECK(fixture.columns.places(test::phase).front().packet == status);
}

TEST_CASE("a segment is handed over when full, column by column, and the next one begins empty", "[segments]") {
    Fixture fixture;
    for (Sequence unit = 10; unit < 15; ++unit)
        fixture.add(unit, Source::realtime, 100.0 * static_cast<double>(unit), static_cast<double>(unit));
    REQUIRE(fixture.full.size() == 1);
    const auto& segment = fixture.full.front();
    CHECK(segment.first_unit == 10);
    CHECK(segment.last_unit == 13);
    CHECK(segment.sclk_s == std::vector<double>{10, 11, 12, 13});
    CHECK(segment.values == std::vector<double>{1000, 1100, 1200, 1300, 10, 11, 12, 13});

    std::vector<SegmentRecord> rest;
    fixture.builder.seal(rest);
    REQUIRE(rest.size() == 1);
    CHECK(rest.front().first_unit == 14);
    CHECK(rest.front().values == std::vector<double>{1400, 14});
    rest.clear();
    fixture.builder.seal(rest);
    CHECK(rest.empty());
}

TEST_CASE("real time and recording fill segments of their own", "[segments]") {
    Fixture fixture;
    for (Sequence unit = 1; unit <= 8; ++unit)
        fixture.add(unit, unit % 2 == 0 ? Source::realtime : Source::recorded, 1.0, 2.0);
    REQUIRE(fixture.full.size() == 2);
    CHECK(fixture.full[0].source == Source::recorded);
    CHECK(fixture.full[0].sclk_s == std::vector<double>{1, 3, 5, 7});
    CHECK(fixture.full[1].source == Source::realtime);
}

TEST_CASE("a stored column tells its least, largest, first and last defined value", "[segments][R43]") {
    Fixture fixture;
    fixture.add(1, Source::realtime, undefined, undefined);
    fixture.add(2, Source::realtime, -5.0, undefined);
    fixture.add(3, Source::realtime, 7.0, undefined);
    fixture.add(4, Source::realtime, 1.0, undefined);
    test::TemporaryFolder folder;
    const auto file = folder / "a.db";
    auto archive = Archive::open(file);
    REQUIRE(archive.ok());
    const auto run = archive->begin_run({}, fixture.dictionary);
    Batch batch;
    batch.segments = fixture.full;
    REQUIRE(archive->append(*run, batch).ok());

    auto database = sqlite::Database::open(file.string(), sqlite::Mode::read_only);
    auto rows = database->prepare("SELECT defined, least, least_sclk, largest, largest_sclk, first, last FROM "
                                  "channel_segments WHERE channel = ? AND source = 'realtime'");
    REQUIRE(rows.ok());
    rows->bind(1, std::string_view("altitude_m"));
    REQUIRE(*rows->step());
    CHECK(rows->integer(0) == 3);
    CHECK(rows->real(1) == -5.0);
    CHECK(rows->real(2) == 2.0);
    CHECK(rows->real(3) == 7.0);
    CHECK(rows->real(4) == 3.0);
    CHECK(rows->real(5) == -5.0);
    CHECK(rows->real(6) == 1.0);
    rows->reset();
    rows->bind(1, std::string_view("speed_mps"));
    REQUIRE(*rows->step());
    CHECK(rows->integer(0) == 0);
    CHECK(rows->is_null(1));
}
