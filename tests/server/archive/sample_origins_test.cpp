// SPDX-License-Identifier: Apache-2.0
#include "server/archive/sample_origins.hpp"

#include "server/archive/reader.hpp"
#include "server/pipeline/pipeline.hpp"
#include "tests/server/small_mission.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/silent_link.hpp"

#include <algorithm>
#include <cmath>

namespace archive_sample_origins_test {

using namespace aeolis;
using namespace aeolis::test;
using archive::Reader;
using archive::RunId;

namespace {

constexpr std::int64_t second_us = 1'000'000;

/// A run with light time 10 s that enters at SCLK 1000: 20 s live over one link, then none for 15 s, then 5 s over
/// another.
struct Landing {
    TemporaryFolder folder;
    dictionary::Dictionary dictionary = small_dictionary();
    archive::Archive archive = std::move(archive::Archive::open(folder / "a.db")).value();
    pipeline::Pipeline pipeline{archive, dictionary};

    Landing() {
        archive::RunStart start;
        start.entry = Sclk{1000.0};
        start.light_time_s = 10.0;
        start.correlation = {Sclk{1000.0}, Scet{0}};
        REQUIRE(pipeline.begin(start).ok());
        link(true, 0, "nominal");
        for (std::uint16_t i = 0; i < 20; ++i) take({telemetry::uhf_live_link, heard(i), packet(i)});
        link(false, 20, "plasma blackout: predicted from E+19 s to E+36 s");
        link(true, 35, "nominal");
        for (std::uint16_t i = 35; i < 40; ++i) take({{"uhf_mro", false}, heard(i), packet(i)});
    }
    static Ert heard(std::int64_t e_s) { return Ert{(e_s + 10) * second_us}; }
    static Octets packet(std::uint16_t i) {
        return navigation_packet(i, 1000.0 + i, i == 12 ? std::nullopt : std::optional(10.0F * i), 3.0F);
    }
    void take(telemetry::ReceivedPacket received) { REQUIRE(pipeline.accept(received).ok()); }
    void link(bool up, std::int64_t e_s, const char* reason) {
        REQUIRE(pipeline
                    .accept(up ? telemetry::LinkState{telemetry::uhf_live_link, heard(e_s), true, reason}
                               : tests::silent_link(telemetry::uhf_live_link, heard(e_s), reason))
                    .ok());
    }
    v1::ChannelSeries series(archive::SclkRange range = {}, std::optional<archive::Source> source = {},
                             std::optional<std::size_t> points = {}) {
        REQUIRE(pipeline.commit().ok());
        auto reader = std::move(Reader::open(folder / "a.db", dictionary)).value();
        const auto list = reader.series(RunId{1}, {{"altitude_m"}, range, points, source, true});
        REQUIRE(list.ok());
        return list->channels(0);
    }
};

std::string text_of(const v1::ChannelSeries& series) {
    std::string text;
    for (const auto& origin : series.origins())
        text += std::to_string(origin.samples()) + " " +
                (origin.source() == v1::SOURCE_RECORDED ? "recorded" : "live") + " " + origin.link() + " " +
                origin.verdict() + " " + std::to_string(static_cast<int>(origin.from_sclk())) + "-" +
                std::to_string(static_cast<int>(origin.to_sclk())) + "; ";
    for (const auto& gap : series.gaps())
        text += "gap " + std::to_string(static_cast<int>(gap.from_sclk())) + "-" +
                std::to_string(static_cast<int>(gap.to_sclk())) + " " + gap.reason() + "; ";
    return text;
}

}  // namespace

TEST_CASE("before the recording is down a series tells its links and names its gaps", "[reader][archive][R43]") {
    Landing landing;
    CHECK(
        text_of(landing.series()) ==
        "19 live uhf_live pending 1000-1019; 5 live uhf_mro pending 1035-1039; "
        "gap 1011-1013 undefined on board; gap 1019-1035 uhf_live: plasma blackout: predicted from E+19 s to E+36 s; ");
    // An end of the range is one of a gap only where it was asked for.
    CHECK(text_of(landing.series({1005.0, 1025.0}))
              .ends_with("gap 1019-1025 uhf_live: plasma blackout: predicted from E+19 s to E+36 s; "));
    CHECK(text_of(landing.series({1038.0, 1060.0})) == "2 live uhf_mro pending 1038-1039; gap 1039-1060 ; ");
    CHECK(text_of(landing.series({1036.0, {}})) == "4 live uhf_mro pending 1036-1039; ");
}

TEST_CASE("a gap is named by the link that the plan had bring telemetry then, not by the other, which was off",
          "[reader][archive][R43]") {
    Landing landing;
    const auto tell = [&](const telemetry::Link& link, std::int64_t e_s, const char* reason) {
        REQUIRE(landing.pipeline.accept(tests::silent_link(link, Landing::heard(e_s), reason)).ok());
    };
    tell(telemetry::x_band_telemetry_link, 0, "switched off: X-band sends tones from E−12:30");
    CHECK_THAT(text_of(landing.series()),
               Catch::Contains("gap 1019-1035 uhf_live: plasma blackout: predicted from E+19 s to E+36 s; "));
    tell(telemetry::x_band_telemetry_link, 40, "unexplained: nothing is predicted to silence it now");
    tell(telemetry::uhf_live_link, 40, "not begun: planned at E+1:20");
    CHECK_THAT(text_of(landing.series({1036.0, 1060.0})),
               Catch::Contains("gap 1039-1060 x_band_telemetry: unexplained"));
}

TEST_CASE("when the recording is down every sample has its path and its verdict, and they add up",
          "[reader][archive][R43]") {
    Landing landing;
    for (std::uint16_t i = 0; i < 40; ++i) {
        if (i == 3) continue;  // lost on board
        auto octets = Landing::packet(i);
        if (i == 36) octets = navigation_packet(i, 1000.0 + i, 5.0F, 3.0F);
        landing.take(recorded(octets));
    }
    landing.pipeline.relay_progress(1.0);
    const bool finished = GENERATE(false, true);  // samples from raw packets, or from segments
    if (finished) REQUIRE(landing.pipeline.finish({archive::Outcome::touchdown, "", "", ""}).ok());
    auto reader = std::move(Reader::open(landing.folder / "a.db", landing.dictionary)).value();
    if (!finished) REQUIRE(landing.pipeline.commit().ok());
    const auto list = reader.series(RunId{1}, {{"altitude_m"}, {}, {}, {}, true});
    REQUIRE(list.ok());
    const auto& series = list->channels(0);
    CHECK(text_of(series) == "3 live uhf_live identical 1000-1002; 1 live uhf_live missing_in_recording 1003-1003; 15 "
                             "live uhf_live identical 1004-1019; "
                             "15 recorded relay never_seen_live 1020-1034; 1 live uhf_mro identical 1035-1035; 1 live "
                             "uhf_mro differs 1036-1036; "
                             "3 live uhf_mro identical 1037-1039; gap 1011-1013 undefined on board; ");
    int sample = 0;
    const auto next_defined = [&] {
        while (sample < series.value_size() && std::isnan(series.value(sample))) ++sample;
    };
    for (const auto& origin : series.origins())
        for (std::uint64_t i = 0; i < origin.samples(); ++i, ++sample) {
            next_defined();
            CHECK(series.source(sample) == origin.source());
        }
    next_defined();
    CHECK(sample == series.value_size());
    CHECK(series.samples() == static_cast<std::uint64_t>(std::ranges::count_if(
                                  series.value(), [](double value) { return !std::isnan(value); })));
    // Thinned, the origins are those of all samples that the points stand for; unasked for they do not come.
    const auto thinned = reader.series(RunId{1}, {{"altitude_m"}, {}, std::size_t{4}, {}, true});
    CHECK(text_of(thinned->channels(0)) == text_of(series));
    CHECK(reader.series(RunId{1}, {{"altitude_m"}, {}, {}})->channels(0).origins_size() == 0);
}

TEST_CASE("of one source a series tells the gaps of that source", "[reader][archive]") {
    Landing landing;
    for (std::uint16_t i = 0; i < 40; ++i) landing.take(recorded(Landing::packet(i)));
    CHECK(text_of(landing.series({}, archive::Source::realtime)).find("gap 1019-1035 uhf_live: plasma blackout") !=
          std::string::npos);
    CHECK(text_of(landing.series({}, archive::Source::recorded)) == "15 recorded relay never_seen_live 1020-1034; ");
    // By the outage of a link that is not asked about no gap is explained.
    CHECK(text_of(landing.series({1010.0, 1040.0}, archive::Source::recorded)) ==
          "15 recorded relay never_seen_live 1020-1034; gap 1010-1020 ; gap 1034-1040 ; ");
}

TEST_CASE("once some of the recording has come, the archive says when packets were stale by all that came of them",
          "[reader][archive][R43]") {
    Landing landing;
    const auto stale = [&] {
        REQUIRE(landing.pipeline.commit().ok());
        auto reader = std::move(Reader::open(landing.folder / "a.db", landing.dictionary)).value();
        const auto report = reader.recorded_staleness(RunId{1});
        REQUIRE(report.ok());
        std::string text;
        for (const auto& packet : report->packets()) {
            text += packet.packet() + " after " + std::to_string(static_cast<int>(packet.stale_after_s())) + " s:";
            for (const auto& each : packet.stretches())
                text += " " + std::to_string(static_cast<int>(each.from_sclk())) + "-" +
                        (each.has_to_sclk() ? std::to_string(static_cast<int>(each.to_sclk())) : std::string{});
        }
        return text;
    };
    CHECK(stale().empty());
    landing.take(recorded(Landing::packet(0)));
    CHECK(stale() == "Navigation after 5 s: 1024-1035 1044-");
    for (std::uint16_t i = 20; i < 26; ++i) landing.take(recorded(Landing::packet(i)));
    CHECK(stale() == "Navigation after 5 s: 1030-1035 1044-");
    for (std::uint16_t i = 26; i < 42; ++i) landing.take(recorded(Landing::packet(i)));
    CHECK(stale() == "Navigation after 5 s: 1046-");
}

TEST_CASE("where the recording has not come, a packet that the link's plan thins is not stale between two",
          "[reader][archive][R43]") {
    Landing landing;
    dictionary::TelemetryPlanRow thinned;
    thinned.packet = "Navigation";
    thinned.every.fill(512);  // of 64 Hz: 8 s
    landing.dictionary.telemetry_plan.push_back(thinned);
    landing.take(recorded(Landing::packet(50)));
    REQUIRE(landing.pipeline.commit().ok());
    auto reader = std::move(Reader::open(landing.folder / "a.db", landing.dictionary)).value();
    const auto report = reader.recorded_staleness(RunId{1});
    REQUIRE(report.ok());
    REQUIRE(report->packets_size() == 1);
    // 1019 to 1035 came live, before four intervals of the plan were over; from 1039 to 1050 the second is recorded: 5 s.
    INFO(report->ShortDebugString());
    REQUIRE(report->packets(0).stretches_size() == 2);
    CHECK(report->packets(0).stretches(0).from_sclk() == 1044.0);
    CHECK(report->packets(0).stretches(1).from_sclk() == 1055.0);
}

}  // namespace archive_sample_origins_test
