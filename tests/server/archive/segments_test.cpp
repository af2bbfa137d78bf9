// SPDX-License-Identifier: Apache-2.0
#include "server/archive/archive.hpp"
#include "server/archive/packet_columns.hpp"
#include "server/archive/sqlite.hpp"
#include "server/pipeline/segment_builder.hpp"
#include "tests/server/small_mission.hpp"
#include "tests/support/catch.hpp"

#include <array>
#include <cmath>
#include <limits>

namespace archive_segments_test {

using namespace aeolis;
using namespace aeolis::archive;
using pipeline::SegmentBuilder;

namespace {

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
constexpr std::uint16_t navigation = 0, status = 1;  // packets of the small mission

struct Fixture {
    dictionary::Dictionary dictionary = test::small_dictionary();
    PacketColumns columns{dictionary};
    SegmentBuilder builder{columns};
    Batch batch;

    void add(Sequence packet_seq, Source source, double altitude_m, double speed_mps) {
        const std::array values{altitude_m, speed_mps};
        builder.add(navigation, source, packet_seq, Sclk{static_cast<double>(packet_seq)}, values, batch);
    }
};

}  // namespace

TEST_CASE("a packet's channels are its columns, and a channel knows its packets", "[segments]") {
    Fixture fixture;
    CHECK(fixture.columns.channels(navigation) == std::vector<ChannelId>{test::altitude, test::speed});
    CHECK(fixture.columns.channels(3).empty());  // an event: its fields are no channels
    REQUIRE(fixture.columns.places(test::phase).size() == 1);
    CHECK(fixture.columns.places(test::phase).front().packet == status);
}

TEST_CASE("a segment is handed over when full, column by column, and the next one begins empty", "[segments]") {
    Fixture fixture;
    for (Sequence packet_seq = 10; packet_seq < 11 + segment_samples; ++packet_seq)
        fixture.add(packet_seq, Source::realtime, 100.0 * static_cast<double>(packet_seq),
                    static_cast<double>(packet_seq));
    REQUIRE(fixture.batch.segments.size() == 1);
    const auto& segment = fixture.batch.segments.front();
    CHECK(segment.position == 0);
    CHECK(segment.first_packet_seq == 10);
    CHECK(segment.last_packet_seq == 9 + segment_samples);
    REQUIRE(segment.sclk_s.size() == segment_samples);
    REQUIRE(segment.values.size() == 2 * segment_samples);
    bool in_place = true;
    for (std::size_t i = 0; i < segment_samples; ++i)
        in_place = in_place && segment.sclk_s[i] == static_cast<double>(10 + i) &&
                   segment.values[i] == 100.0 * segment.sclk_s[i] &&
                   segment.values[segment_samples + i] == segment.sclk_s[i];
    CHECK(in_place);

    Batch rest;
    fixture.builder.seal(rest);
    REQUIRE(rest.segments.size() == 1);
    CHECK(rest.segments.front().position == 1);
    CHECK(rest.segments.front().first_packet_seq == 10 + segment_samples);
    CHECK(rest.segments.front().values == std::vector<double>{100.0 * (10 + segment_samples), 10 + segment_samples});
    rest.clear();
    fixture.builder.seal(rest);
    CHECK(rest.segments.empty());
}

TEST_CASE("real time and recording fill segments of their own", "[segments]") {
    Fixture fixture;
    for (Sequence packet_seq = 1; packet_seq <= 2 * segment_samples; ++packet_seq)
        fixture.add(packet_seq, packet_seq % 2 == 0 ? Source::realtime : Source::recorded, 1.0, 2.0);
    const auto& segments = fixture.batch.segments;
    REQUIRE(segments.size() == 2);
    CHECK(segments[0].source == Source::recorded);
    CHECK(segments[0].sclk_s.front() == 1.0);
    CHECK(segments[0].sclk_s.back() == 2.0 * segment_samples - 1.0);
    CHECK(segments[1].source == Source::realtime);
    CHECK(segments[1].position == 0);
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
    fixture.builder.seal(fixture.batch);
    REQUIRE(archive->append(*run, fixture.batch).ok());

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

}  // namespace archive_segments_test
