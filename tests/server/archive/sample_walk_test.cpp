// SPDX-License-Identifier: Apache-2.0
#include "server/archive/archive.hpp"
#include "server/archive/reader.hpp"
#include "server/archive/sqlite.hpp"
#include "server/pipeline/segment_builder.hpp"
#include "tests/server/small_mission.hpp"
#include "tests/support/catch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace archive_sample_walk_test {

using namespace aeolis;
using namespace aeolis::archive;

namespace {

constexpr std::size_t samples = 300'000;
constexpr std::uint16_t navigation = 0;

/// A long run of two sources, some samples undefined, now and then one that comes late: as segments and pyramid only.
struct Long {
    test::TemporaryFolder folder;
    dictionary::Dictionary dictionary = test::small_dictionary();
    std::filesystem::path file = folder / "a.db";
    std::vector<std::pair<double, double>> all;  ///< defined ones, by time

    Long() {
        const PacketColumns columns(dictionary);
        auto archive = Archive::open(file);
        const auto run = archive->begin_run({}, dictionary);
        pipeline::SegmentBuilder builder(columns);
        Batch batch;
        std::mt19937_64 random(11);
        for (std::size_t i = 0; i < samples; ++i) {
            const bool live = i < samples * 3 / 4;
            const double sclk_s =
                static_cast<double>(i) / 64.0 - (random() % 100 == 0 ? 3.0 : 0.0) + static_cast<double>(i) * 1e-7;
            const double value = random() % 20 == 0 ? std::numeric_limits<double>::quiet_NaN()
                                                    : std::sin(static_cast<double>(i) * 1e-3) +
                                                          static_cast<double>(random() % 1000) * 1e-5;
            const std::array values{value, 0.0};
            builder.add(navigation, live ? Source::realtime : Source::recorded, 2 * i + 1, Sclk{sclk_s}, values, batch);
            if (!std::isnan(value)) all.emplace_back(sclk_s, value);
        }
        builder.seal(batch);
        batch.end = RunEnd{archive::Outcome::touchdown, "", "", ""};
        REQUIRE(archive->append(*run, batch).ok());
        std::ranges::sort(all);
    }
    std::vector<std::pair<double, double>> expected(double from_s, double to_s) const {
        std::vector<std::pair<double, double>> found;
        for (const auto& each : all)
            if (each.first >= from_s && each.first <= to_s) found.push_back(each);
        return found;
    }
};

/// The defined points.
std::vector<std::pair<double, double>> points_of(const v1::ChannelSeries& series) {
    std::vector<std::pair<double, double>> points;
    for (int i = 0; i < series.sclk_size(); ++i)
        if (!std::isnan(series.value(i))) points.emplace_back(series.sclk(i), series.value(i));
    return points;
}

}  // namespace

TEST_CASE("any range of a long run is found through the pyramid, sample by sample and thinned",
          "[archive][pyramid][R43]") {
    const Long recorded;
    auto reader = Reader::open(recorded.file, recorded.dictionary);
    REQUIRE(reader.ok());
    std::mt19937_64 random(5);
    const double end_s = samples / 64.0;
    for (int round = 0; round < 60; ++round) {
        const double length_s = end_s / static_cast<double>(1ULL << (random() % 12));
        double from_s = static_cast<double>(random() % 100'000) * 1e-5 * (end_s - length_s), to_s = from_s + length_s;
        if (round == 0) from_s = -1e300, to_s = 1e300;
        if (round == 1) from_s = end_s + 100.0, to_s = 1e9;
        INFO("from " << from_s << " to " << to_s);
        auto expected = recorded.expected(from_s, to_s);
        if (expected.size() < 150'000) {
            const auto exact = reader->series(RunId{1}, {{"altitude_m"}, {from_s, to_s}, {}});
            REQUIRE(exact.ok());
            auto points = points_of(exact->channels(0));
            std::ranges::sort(points);
            REQUIRE(points == expected);
        }
        const std::size_t wanted = random() % 2 == 0 ? 2000 : 20;
        const auto thinned = reader->series(RunId{1}, {{"altitude_m"}, {from_s, to_s}, wanted});
        REQUIRE(thinned.ok());
        const auto& series = thinned->channels(0);
        REQUIRE(series.samples() == expected.size());
        REQUIRE(static_cast<std::size_t>(series.sclk_size()) <= wanted);
        REQUIRE(std::is_sorted(series.sclk().begin(), series.sclk().end()));
        if (expected.empty()) continue;
        const auto by_value = [](const auto& each) { return each.second; };
        const auto points = points_of(series);
        REQUIRE(by_value(std::ranges::min(points, {}, by_value)) == by_value(std::ranges::min(expected, {}, by_value)));
        REQUIRE(by_value(std::ranges::max(points, {}, by_value)) == by_value(std::ranges::max(expected, {}, by_value)));
        for (const auto& point : points) REQUIRE(std::ranges::binary_search(expected, point));
        // A plot has no holes: at least a quarter of the points that were asked for, where there are samples enough.
        if (expected.size() > 2 * wanted) REQUIRE(static_cast<std::size_t>(series.sclk_size()) >= wanted / 4);
    }
}

TEST_CASE("a segment or block that is damaged is named, not plotted", "[archive][codec]") {
    const Long recorded;
    const auto spoil = [&](const char* sql) {
        auto database = sqlite::Database::open(recorded.file.string(), sqlite::Mode::read_write_create);
        REQUIRE(database->execute(sql).ok());
    };
    const auto refusal = [&](std::optional<std::size_t> points) {
        auto reader = Reader::open(recorded.file, recorded.dictionary);
        const auto answer = reader->series(RunId{1}, {{"altitude_m"}, {0.0, 100.0}, points});
        return answer.ok() ? std::string("answered") : answer.error().message;
    };
    CHECK(refusal({}) == "answered");
    SECTION("a value's octet") {
        spoil("UPDATE segment_columns SET value = CAST(substr(value, 1, 40) || x'00FF' || substr(value, 43) AS BLOB) "
              "WHERE key = 8388609 * 65536");
        CHECK(refusal({}).find("a.db: segment 8388609, channel 0 is damaged: ") != std::string::npos);
    }
    SECTION("times that are cut off") {
        spoil("UPDATE segments SET sclk = substr(sclk, 1, 4) WHERE segment = 8388608");
        CHECK(refusal({}).find("segment 8388608, its times is damaged: it is cut off") != std::string::npos);
    }
    SECTION("a column that is gone") {
        spoil("DELETE FROM segment_columns WHERE key = 8388608 * 65536");
        CHECK(refusal({}).find("channel 0 is damaged: it is missing") != std::string::npos);
    }
    SECTION("a number of samples that cannot be") {
        spoil("UPDATE segments SET samples = 100000000 WHERE segment = 8388608");
        CHECK(refusal({}).find("its number of samples is damaged") != std::string::npos);
    }
    SECTION("a block of the pyramid") {
        spoil("UPDATE pyramid_columns SET nodes = substr(nodes, 1, 720) WHERE key = 8388608 * 65536");
        CHECK(refusal(100).find("the pyramid is damaged: level 1 of channel 0 ends at node") != std::string::npos);
        spoil("UPDATE pyramid SET spans = x'00'");
        CHECK(refusal(100).find("of the pyramid is damaged") != std::string::npos);
    }
}

}  // namespace archive_sample_walk_test
