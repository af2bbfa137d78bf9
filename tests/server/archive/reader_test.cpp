// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/timeline_plan.hpp"
#include "server/archive/reader.hpp"
#include "server/archive/sqlite.hpp"
#include "server/pipeline/pipeline.hpp"
#include "tests/server/small_mission.hpp"
#include "tests/support/catch.hpp"

#include <cmath>

namespace archive_reader_test {

using namespace aeolis;
using namespace aeolis::test;
using archive::Archive;
using archive::Reader;
using archive::RunId;

namespace {

constexpr std::size_t samples = 5000;  // four sealed segments and an open tail

double altitude_at(std::size_t i) {
    return std::round(1000.0 * std::sin(static_cast<double>(i) / 100.0));
}

/// A run of `samples` navigation packets at 64 Hz from SCLK 1000; with `finished` all is sealed.
struct Recorded {
    TemporaryFolder folder;
    dictionary::Dictionary dictionary = small_dictionary();
    std::filesystem::path file = folder / "a.db";
    Archive archive = std::move(Archive::open(file)).value();
    Reader reader;

    explicit Recorded(bool finished) : reader(make(finished)) {}
    Reader make(bool finished) {
        pipeline::Pipeline pipeline(archive, dictionary);
        archive::RunStart start;
        start.scenario = "nominal";
        start.entry = Sclk{1000.0};
        REQUIRE(pipeline.begin(start).ok());
        for (std::size_t i = 0; i < samples; ++i) {
            const auto sclk_s = 1000.0 + static_cast<double>(i) / 64.0;
            std::optional<float> value;
            if (i % 10 != 9) value = static_cast<float>(altitude_at(i));
            REQUIRE(pipeline.accept(live(navigation_packet(static_cast<std::uint16_t>(i), sclk_s, value, 3.0F))).ok());
            if (i % 64 == 0)
                REQUIRE(pipeline.accept(live(status_packet(static_cast<std::uint16_t>(i / 64), sclk_s, 2))).ok());
        }
        REQUIRE(pipeline.accept(live(fired_packet(0, 1002.0, 1))).ok());
        REQUIRE(pipeline.accept(recorded(fired_packet(0, 1002.0, 1))).ok());
        REQUIRE(pipeline.accept(live(mortar_packet(0, 1003.0, 405.0F))).ok());
        if (finished)
            REQUIRE(pipeline.finish({archive::Outcome::touchdown, "", "", ""}).ok());
        else
            REQUIRE(pipeline.commit().ok());
        return std::move(Reader::open(file, dictionary)).value();
    }
};

std::string refusal(const Error& error) {
    return error.message;
}

}  // namespace

TEST_CASE("a series is exact, undefined samples too, whether sealed or still open", "[reader][R43]") {
    const bool finished = GENERATE(false, true);
    Recorded recorded_run(finished);
    const auto list = recorded_run.reader.series(RunId{1}, {{"altitude_m"}, {}, {}});
    REQUIRE(list.ok());
    const auto& series = list->channels(0);
    CHECK(series.samples() == samples * 9 / 10);
    CHECK_FALSE(series.thinned());
    CHECK(series.unit() == "m");
    REQUIRE(series.value_size() == static_cast<int>(samples));
    for (std::size_t i = 0; i < samples; ++i) {
        const int point = static_cast<int>(i);
        REQUIRE(series.sclk(point) == 1000.0 + static_cast<double>(i) / 64.0);
        REQUIRE((i % 10 == 9 ? std::isnan(series.value(point)) : series.value(point) == altitude_at(i)));
    }
}

TEST_CASE("samples of one instant keep the order of reception, in one packet and in several, sealed and open",
          "[reader][R54]") {
    const bool finished = GENERATE(false, true);
    CAPTURE(finished);
    auto dictionary = small_dictionary();
    dictionary::Packet echo{"Echo", "", Apid{0x21}, {}, tm_overhead_octets + 4, {}, 64.0, {}};
    echo.fields = {{"altitude_m", dictionary.channels[0].type, altitude, tm_data_offset_octets * 8, {}}};
    dictionary.packets.push_back(echo);
    dictionary.model = tests::packet_model_of(dictionary);
    const TemporaryFolder folder;
    auto archive = std::move(Archive::open(folder / "a.db")).value();
    pipeline::Pipeline pipeline(archive, dictionary);
    REQUIRE(pipeline.begin({}).ok());
    // A clock of whole seconds that is set back once: ten packets a second, of two types in turn.
    const std::vector<double> seconds{1000.0, 1001.0, 1002.0, 900.0, 901.0, 1001.0};
    std::vector<std::pair<double, double>> received;
    for (std::size_t i = 0; i < 10 * seconds.size(); ++i) {
        const auto number = static_cast<std::uint16_t>(i);
        const double sclk_s = seconds[i / 10];
        received.emplace_back(sclk_s, static_cast<double>(i));
        auto octets = navigation_packet(number, sclk_s, static_cast<float>(i), 3.0F);
        if (i % 2 == 1) {
            octets.assign(tm_overhead_octets + 4, 0);
            BitWriter{std::span<std::uint8_t>(octets).subspan(tm_data_offset_octets)}.put_float(static_cast<float>(i));
            seal_tm_packet(octets, Apid{0x21}, number, Sclk{sclk_s}, dictionary_id);
        }
        REQUIRE(pipeline.accept(live(octets)).ok());
    }
    REQUIRE((finished ? pipeline.finish({archive::Outcome::touchdown, "", "", ""}) : pipeline.commit()).ok());
    std::ranges::stable_sort(received, {}, &std::pair<double, double>::first);
    auto reader = std::move(Reader::open(folder / "a.db", dictionary)).value();

    const auto list = reader.series(RunId{1}, {{"altitude_m"}, {}, {}});
    REQUIRE(list);
    std::vector<std::pair<double, double>> given;
    for (int i = 0; i < list->channels(0).value_size(); ++i)
        given.emplace_back(list->channels(0).sclk(i), list->channels(0).value(i));
    CHECK(given == received);
    const auto latest = reader.latest(RunId{1}, Sclk{1001.5});
    REQUIRE(latest);
    CHECK(latest->front().value == 59.0);

    // Thinned, an instant has its least and its largest value.
    const auto few = reader.series(RunId{1}, {{"altitude_m"}, {{1002.0}, {}}, {2}});
    REQUIRE(few);
    REQUIRE(few->channels(0).value_size() == 2);
    CHECK(few->channels(0).value(0) == 20.0);
    CHECK(few->channels(0).value(1) == 29.0);
}

TEST_CASE("all samples of a run come in order of time, whole, whatever is asked for", "[reader][export]") {
    const bool finished = GENERATE(false, true);
    Recorded run(finished);
    std::vector<archive::ChannelValue> all;
    const auto take = [&](std::span<const archive::ChannelValue> some) -> Result<void> {
        all.insert(all.end(), some.begin(), some.end());
        return {};
    };
    REQUIRE(run.reader.each_sample(RunId{1}, {}, {}, take).ok());
    CHECK(all.size() == samples + samples + 79);
    CHECK(std::ranges::is_sorted(all, {}, [](const auto& sample) { return sample.sclk.seconds; }));
    all.clear();
    REQUIRE(run.reader.each_sample(RunId{1}, {"speed_mps"}, {1001.0, 1002.0}, take).ok());
    REQUIRE(all.size() == 65);
    CHECK(all.front().sclk == Sclk{1001.0});
    CHECK(all.back().sclk == Sclk{1002.0});
    CHECK(all.back().channel == speed);
    all.clear();
    REQUIRE(run.reader.each_sample(RunId{1}, {"speed_mps"}, {2000.0, {}}, take).ok());
    CHECK(all.empty());
    CHECK(run.reader.each_sample(RunId{1}, {"altitud"}, {}, take).error().message == "no channel 'altitud'");
    const auto full = run.reader.each_sample(RunId{1}, {}, {}, [](auto) -> Result<void> { return Error{"full"}; });
    CHECK(full.error().message == "full");
}

TEST_CASE("pages of samples, one after the other, are all samples, each once", "[reader][export]") {
    TemporaryFolder folder;
    const auto dictionary = small_dictionary();
    auto archive = std::move(Archive::open(folder / "a.db")).value();
    pipeline::Pipeline pipeline(archive, dictionary);
    REQUIRE(pipeline.begin({}).ok());
    constexpr std::size_t packets = 70'000;  // of two samples: many pages; with a long silence in the middle
    for (std::size_t i = 0; i < packets; ++i)
        REQUIRE(pipeline
                    .accept(live(navigation_packet(static_cast<std::uint16_t>(i),
                                                   (i < packets / 2 ? 0.0 : 1e6) + static_cast<double>(i) / 64.0,
                                                   static_cast<float>(i), 3.0F)))
                    .ok());
    REQUIRE(pipeline.commit().ok());
    auto reader = std::move(Reader::open(folder / "a.db", dictionary)).value();

    std::size_t pages = 0, seen = 0;
    double last_s = -1.0;
    std::optional<archive::SampleCursor> after;
    for (bool more = true; more; ++pages) {
        const auto page = reader.sample_page(RunId{1}, {}, {}, after);
        REQUIRE(page.ok());
        REQUIRE(std::ranges::is_sorted(page->samples, {}, [](const auto& sample) { return sample.sclk.seconds; }));
        if (!page->samples.empty()) {
            CHECK(page->samples.front().sclk.seconds > last_s);
            last_s = page->samples.back().sclk.seconds;
        }
        seen += page->samples.size();
        CHECK(page->samples.size() <= 40'000);
        more = page->next.has_value();
        after = page->next;
    }
    CHECK(pages > 3);
    CHECK(pages < 100);
    CHECK(seen == 2 * packets);
}

TEST_CASE("a range includes both its ends", "[reader]") {
    const bool finished = GENERATE(false, true);
    Recorded run(finished);
    const auto list = run.reader.series(RunId{1}, {{"speed_mps"}, {1001.0, 1002.0}, {}});
    REQUIRE(list.ok());
    CHECK(list->channels(0).sclk_size() == 65);
    CHECK(list->channels(0).sclk(0) == 1001.0);
    CHECK(list->channels(0).sclk(64) == 1002.0);
}

TEST_CASE("a thinned series keeps the least and the largest sample of every interval", "[reader]") {
    const bool finished = GENERATE(false, true);
    Recorded run(finished);
    const auto points = static_cast<std::size_t>(GENERATE(2, 3, 10, 100, 1999));
    const auto exact = run.reader.series(RunId{1}, {{"altitude_m"}, {}, {}});
    const auto list = run.reader.series(RunId{1}, {{"altitude_m"}, {}, points});
    REQUIRE(list.ok());
    const auto& all = exact->channels(0);
    const auto& thin = list->channels(0);
    CHECK(thin.thinned());
    CHECK(thin.samples() == all.samples());
    CHECK(thin.sclk_size() <= static_cast<int>(points));
    CHECK(std::is_sorted(thin.sclk().begin(), thin.sclk().end()));
    CHECK(*std::max_element(thin.value().begin(), thin.value().end()) ==
          *std::max_element(all.value().begin(), all.value().end()));
    CHECK(*std::min_element(thin.value().begin(), thin.value().end()) ==
          *std::min_element(all.value().begin(), all.value().end()));
    // Each point is a sample at its own time.
    for (int i = 0; i < thin.sclk_size(); ++i) {
        const auto found = std::lower_bound(all.sclk().begin(), all.sclk().end(), thin.sclk(i));
        REQUIRE(found != all.sclk().end());
        REQUIRE(*found == thin.sclk(i));
        REQUIRE(all.value(static_cast<int>(found - all.sclk().begin())) == thin.value(i));
    }
}

TEST_CASE("a series of one source has nothing of the other, exact or thinned", "[reader]") {
    TemporaryFolder folder;
    const dictionary::Dictionary dictionary = small_dictionary();
    Archive archive = std::move(Archive::open(folder / "a.db")).value();
    pipeline::Pipeline pipeline(archive, dictionary);
    archive::RunStart start;
    start.scenario = "nominal";
    start.entry = Sclk{1000.0};
    REQUIRE(pipeline.begin(start).ok());
    constexpr std::size_t all = 2000, live_each = 8;  // the rest only the recording has, and there it is larger
    for (std::size_t i = 0; i < all; ++i) {
        const auto packet = navigation_packet(static_cast<std::uint16_t>(i), 1000.0 + static_cast<double>(i) / 64.0,
                                              i % live_each == 0 ? 1.0F : 2.0F, 3.0F);
        REQUIRE(pipeline.accept(i % live_each == 0 ? live(packet) : recorded(packet)).ok());
    }
    if (GENERATE(false, true))
        REQUIRE(pipeline.finish({archive::Outcome::touchdown, "", "", ""}).ok());
    else
        REQUIRE(pipeline.commit().ok());
    Reader reader = std::move(Reader::open(folder / "a.db", dictionary)).value();
    const auto points = GENERATE(std::optional<std::size_t>{}, std::optional<std::size_t>{50});
    for (const auto source : {archive::Source::realtime, archive::Source::recorded}) {
        const bool came_live = source == archive::Source::realtime;
        const auto list = reader.series(RunId{1}, {{"altitude_m"}, {}, points, source});
        REQUIRE(list.ok());
        const auto& series = list->channels(0);
        CHECK(series.samples() == (came_live ? all / live_each : all - all / live_each));
        CHECK(series.thinned() == points.has_value());
        CHECK(std::ranges::all_of(series.value(), [&](double value) { return value == (came_live ? 1.0 : 2.0); }));
    }
}

TEST_CASE("fewer samples than points are given exactly", "[reader]") {
    Recorded run(true);
    const auto list = run.reader.series(RunId{1}, {{"edl_phase"}, {}, 2000});
    REQUIRE(list.ok());
    CHECK_FALSE(list->channels(0).thinned());
    CHECK(list->channels(0).sclk_size() == static_cast<int>(list->channels(0).samples()));
}

TEST_CASE("the state at a time is each channel's newest value up to then", "[reader]") {
    Recorded run(GENERATE(false, true));
    const auto values = run.reader.latest(RunId{1}, Sclk{1000.0 + 100.5 / 64.0});
    REQUIRE(values.ok());
    REQUIRE(values->size() == 3);
    CHECK((*values)[0].value == altitude_at(100));
    CHECK((*values)[0].sclk == Sclk{1000.0 + 100.0 / 64.0});
    CHECK((*values)[2].sclk == Sclk{1001.0});
    CHECK(run.reader.latest(RunId{1}, Sclk{10.0})->empty());
    // The newest altitude of all is undefined (the 5000th), and not the value before.
    const auto newest = run.reader.latest(RunId{1}, {});
    REQUIRE(newest->size() == 3);
    CHECK(std::isnan((*newest)[0].value));
    CHECK_FALSE(std::isnan((*newest)[1].value));
}

TEST_CASE("what a client asks wrongly is answered in words", "[reader]") {
    Recorded run(true);
    auto& reader = run.reader;
    CHECK(refusal(reader.run(RunId{7}).error()) == "no run 7");
    CHECK(refusal(reader.series(RunId{7}, {{"altitude_m"}, {}, {}}).error()) == "no run 7");
    CHECK(refusal(reader.series(RunId{1}, {{"altitud"}, {}, {}}).error()) == "no channel 'altitud'");
    CHECK(refusal(reader.series(RunId{1}, {{}, {}, {}}).error()) == "no channel is named");
    CHECK(refusal(reader.series(RunId{1}, {{"altitude_m"}, {2.0, 1.0}, {}}).error()).find("upside down") !=
          std::string::npos);
    CHECK_FALSE(reader.series(RunId{1}, {{"altitude_m"}, {std::nan(""), 1.0}, {}}).ok());
    CHECK_FALSE(reader.series(RunId{1}, {{"altitude_m"}, {}, std::size_t{1}}).ok());
    CHECK_FALSE(reader.series(RunId{1}, {std::vector<std::string>(65, "altitude_m"), {}, {}}).ok());
    CHECK_FALSE(reader.items(RunId{1}, 0, 0).ok());
    CHECK_FALSE(reader.items(RunId{1}, 0, archive::items_page_max + 1).ok());
    CHECK(reader.items(RunId{1}, ~archive::Sequence{0}, 10)->items.empty());
    archive::PacketQuery unknown;
    unknown.name = "Navigatio";
    CHECK(refusal(reader.packets(RunId{1}, unknown).error()) == "no packet 'Navigatio'");
    archive::PacketQuery beyond;
    beyond.after = ~archive::Sequence{0};
    CHECK(reader.packets(RunId{1}, beyond)->packets_size() == 0);
    CHECK_FALSE(Reader::open(run.folder / "none.db", run.dictionary).ok());
}

TEST_CASE("packets come in pages with octets and fields in words", "[reader][R43]") {
    Recorded run(true);
    archive::PacketQuery query;
    query.name = "Status";
    query.limit = 30;
    std::size_t count = 0;
    for (;;) {
        const auto page = run.reader.packets(RunId{1}, query);
        REQUIRE(page.ok());
        for (const auto& packet : page->packets()) {
            ++count;
            CHECK(packet.unit().name() == "Status");
            CHECK(packet.hex().size() == 2 * packet.unit().octets());
            REQUIRE(packet.fields_size() == 1);
            CHECK(packet.fields(0).name() == "edl_phase");
            CHECK(packet.fields(0).text() == "2");
        }
        if (page->next_after() == 0) break;
        query.after = page->next_after();
    }
    CHECK(count == 79);  // 5000 / 64, begun ones too
}

TEST_CASE("events are found by level and by text of any case", "[reader]") {
    Recorded run(true);
    archive::EventQuery query;
    query.text = "MORTAR";
    CHECK(run.reader.events(RunId{1}, query)->events_size() == 1);
    query.levels = {"FATAL"};
    CHECK(run.reader.events(RunId{1}, query)->events_size() == 0);
    query.levels = {"ACTIVITY_HI"};
    const auto found = run.reader.events(RunId{1}, query);
    REQUIRE(found->events_size() == 1);
    CHECK(found->events(0).event().text() == "mortar fired at 405.0 m/s");
}

TEST_CASE("the timeline tells plan, real time and recording of each timepoint", "[reader][R43]") {
    Recorded run(true);
    const auto list = run.reader.timepoints(RunId{1});
    REQUIRE(list.ok());
    CHECK(list->timeline_version() == 3);
    REQUIRE(list->timepoints_size() == 3);
    CHECK(list->timepoints(0).planned_e_s() == -826.0);
    CHECK(list->timepoints(0).verdict() == "pending");
    CHECK(list->timepoints(1).planned_e_s() == -816.0);
    CHECK(list->timepoints(1).realtime_sclk() == 1002.0);
    CHECK(list->timepoints(1).recorded_sclk() == 1002.0);
    CHECK(list->timepoints(1).verdict() == "completed");
    CHECK_FALSE(list->timepoints(2).has_planned_e_s());
    REQUIRE(list->anchors_size() == 2);  // by the number that commands give them
    CHECK(list->anchors(0).parent().empty());
    CHECK((list->anchors(1).id() == 1 && list->anchors(1).name() == "entry" && list->anchors(1).parent() == "root"));
    CHECK_FALSE(list->anchors(1).has_offset_s());
}

TEST_CASE("a timepoint is predicted from what was known, or says why it is not", "[reader][timeline]") {
    Recorded run(true);
    const auto list = run.reader.timepoints(RunId{1});
    REQUIRE(list.ok());
    CHECK(list->timepoints(0).predicted_e_s() == -826.0);
    CHECK(list->timepoints(0).heard_by().empty());
    CHECK(list->timepoints(1).heard_by() == "uhf");
    CHECK(list->timepoints(1).triggered_sclk() == 1001.75);
    CHECK(list->timepoints(1).predicted_e_s() == -816.0);  // as it was predicted before
    CHECK_FALSE(list->timepoints(2).has_predicted_e_s());
    CHECK(list->timepoints(2).not_predicted() == "its desired offset is undefined");
    CHECK(list->anchors(0).state() == "defined");
    CHECK(list->anchors(0).basis() == "clock");
    CHECK(list->anchors(1).state() == "predicted");
    CHECK(list->anchors(1).basis() == "plan");
    CHECK(list->anchors(1).e_s() == 0.0);
    CHECK_FALSE(list->has_known_at_e_s());
    CHECK_FALSE(list->command_moves());
}

TEST_CASE("a timepoint whose anchor is overdue is predicted for now, and expected when the design has it",
          "[reader][timeline]") {
    auto dictionary = small_dictionary();
    dictionary.anchors.push_back({AnchorId{2}, "parachute", AnchorId{0}, {}, ""});
    dictionary.predicted_anchor_e_s = {{}, 0.0, 256.0};
    auto& deploy = dictionary.timeline[2];
    deploy.anchor = AnchorId{2};
    deploy.desired_offset_s = 0.0;
    deploy.minimum_offset_s = 0.0;
    const TemporaryFolder folder;
    auto archive = archive::Archive::open(folder / "a.db");
    REQUIRE(archive.ok());
    archive::RunStart start;
    start.entry = Sclk{1000.0};
    pipeline::Pipeline pipeline{*archive, dictionary};
    REQUIRE(pipeline.begin(start).ok());
    auto reader = Reader::open(folder / "a.db", dictionary);
    REQUIRE(reader.ok());
    const auto deployed = [&](double e_s) {
        const auto list = reader->timepoints(RunId{1}, {.at = Sclk{1000.0 + e_s}});
        REQUIRE(list.ok());
        return std::pair{list->timepoints(2).predicted_e_s(), list->timepoints(2).expected_e_s()};
    };
    CHECK(deployed(200.0) == std::pair{256.0, 256.0});
    CHECK(deployed(300.0) == std::pair{300.0, 256.0});
}

TEST_CASE("a timeline of the past knows nothing that came later, or that only the recording told",
          "[reader][timeline]") {
    Recorded run(true);
    const auto before = run.reader.timepoints(RunId{1}, {.at = Sclk{1001.0}});
    REQUIRE(before.ok());
    CHECK(before->known_at_e_s() == 1.0);
    CHECK(before->timepoints(1).heard_by().empty());
    CHECK(before->timepoints(1).verdict() == "pending");
    CHECK_FALSE(before->timepoints(1).has_realtime_sclk());
    const auto live = run.reader.timepoints(RunId{1}, {.recorded = false});
    REQUIRE(live.ok());
    CHECK(live->timepoints(1).realtime_sclk() == 1002.0);
    CHECK_FALSE(live->timepoints(1).has_recorded_sclk());
}

TEST_CASE("the effect of a command is told for what it moves, and never for what has fired", "[reader][timeline]") {
    Recorded run(true);
    const auto with = [&](std::optional<Sclk> at, dictionary::OffsetChange change) {
        return std::move(run.reader.timepoints(RunId{1}, {.at = at, .change = change})).value();
    };
    const dictionary::OffsetChange later{dictionary::OffsetChange::OfTimepoint{TimepointId{1}, 20.0, 0.0}};
    const auto before = with(Sclk{1001.0}, later);
    CHECK(before.command_moves());
    CHECK(before.timepoints(1).predicted_e_s() == -816.0);
    CHECK(before.timepoints(1).moved_e_s() == -806.0);
    CHECK_FALSE(before.timepoints(0).has_moved_e_s());
    CHECK_FALSE(with({}, later).timepoints(1).has_moved_e_s());
    const dictionary::OffsetChange entry{dictionary::OffsetChange::OfAnchor{AnchorId{1}, 1005.0}};
    const auto moved = with(Sclk{1001.0}, entry);
    CHECK(moved.timepoints(0).moved_e_s() == -821.0);
    CHECK(moved.timepoints(1).moved_e_s() == -811.0);
}

TEST_CASE("a run is predicted by the design with which it began", "[reader][timeline][R43]") {
    TemporaryFolder folder;
    const auto file = folder / "a.db";
    auto then = small_dictionary();
    then.predicted_anchor_e_s = {{}, 5.0};
    {
        REQUIRE(Archive::open(file)->begin_run({}, then).ok());
    }
    auto today = small_dictionary();  // the same on board: only ground's sheet has changed
    today.predicted_anchor_e_s = {2.0, 9.0};
    const auto kept = Reader::open(file, today)->timepoints(RunId{1});
    REQUIRE(kept.ok());
    CHECK_FALSE(kept->anchors(0).has_predicted_e_s());
    CHECK(kept->anchors(1).predicted_e_s() == 5.0);
}

TEST_CASE("a channel that is named twice, or by name and alias, is given once", "[reader][bounds]") {
    Recorded run(true);
    const auto alias = run.dictionary.channel("altitude_m")->alias;
    const auto list = run.reader.series(RunId{1}, {{"altitude_m", "speed_mps", "altitude_m", alias}, {}, {}});
    REQUIRE(list.ok());
    REQUIRE(list->channels_size() == 2);
    CHECK(list->channels(0).name() == "altitude_m");
    CHECK(list->channels(1).name() == "speed_mps");
}

TEST_CASE("a run of another dictionary shows its packets, and says why it shows no series", "[reader]") {
    Recorded run(true);
    auto other = small_dictionary();
    other.id = 815;
    auto reader = Reader::open(run.file, other);
    REQUIRE(reader.ok());
    CHECK(refusal(reader->series(RunId{1}, {{"altitude_m"}, {}, {}}).error()).find("dictionary 4711") !=
          std::string::npos);
    CHECK(refusal(reader->scenario_text(RunId{1}).error()).find("dictionary 4711") != std::string::npos);
    CHECK(reader->packets(RunId{1}, {})->packets_size() == 100);
    const auto page = reader->items(RunId{1}, 0, 10);
    REQUIRE(page.ok());
    CHECK(page->items.size() == 10);
}

TEST_CASE("an archive that no program has open can be read", "[reader]") {
    TemporaryFolder folder;
    const auto file = folder / "a.db";
    const auto dictionary = small_dictionary();
    {
        auto archive = Archive::open(file);
        REQUIRE(archive->begin_run({}, dictionary).ok());
    }
    auto reader = Reader::open(file, dictionary);
    REQUIRE(reader.ok());
    CHECK(reader->runs()->runs_size() == 1);
}

TEST_CASE("one bit that differs between live and recorded is found, with the octets of both", "[reader][R41]") {
    TemporaryFolder folder;
    const auto dictionary = small_dictionary();
    auto archive = std::move(Archive::open(folder / "a.db")).value();
    pipeline::Pipeline pipeline(archive, dictionary);
    REQUIRE(pipeline.begin(archive::RunStart{}).ok());
    constexpr std::uint16_t packets = 20;
    const auto packet = [](std::uint16_t i) {
        return navigation_packet(i, 1000.0 + i, 10.0F * static_cast<float>(i), 3.0F);
    };
    for (std::uint16_t i = 0; i < 12; ++i) REQUIRE(pipeline.accept(live(packet(i))).ok());  // of 20 that were recorded
    REQUIRE(pipeline.accept(telemetry::ReceivedPacket{{"uhf_mro", false}, Ert{1}, packet(3)})
                .ok());  // the same over another orbiter
    REQUIRE(pipeline.commit().ok());
    auto reader = std::move(Reader::open(folder / "a.db", dictionary)).value();
    auto early = reader.proof(RunId{1});
    REQUIRE(early.ok());
    CHECK_FALSE(early->recording_complete());
    REQUIRE(early->streams_size() == 1);
    CHECK(early->streams(0).pending() == 12);
    CHECK(early->streams(0).missing_in_recording() == 0);
    archive::PacketQuery pending;
    pending.verdict = "pending";
    CHECK(reader.packets(RunId{1}, pending)->packets_size() == 13);

    for (std::uint16_t i = 0; i < packets; ++i) {
        if (i == 5) continue;  // lost on board
        auto octets = packet(i);
        if (i == 7) {
            octets = navigation_packet(i, 1000.0 + i, 10.0F * static_cast<float>(i), 3.0F);
            octets[tm_data_offset_octets + 1] ^= 0x10;
            const auto sealed = octets;
            seal_tm_packet(octets, read_primary_header(sealed)->apid, i, Sclk{1000.0 + i}, dictionary.id);
        }
        REQUIRE(pipeline.accept(recorded(octets)).ok());
    }
    pipeline.relay_progress(1.0);
    pipeline.link_totals({{"uhf_live",
                           {.octets = 100,
                            .frames = 3,
                            .bad_crc = 1,
                            .bad_header = 0,
                            .skipped_octets = 4,
                            .gaps = 1,
                            .missing_frames = 2,
                            .repeated_frames = 0,
                            .other_data_frames = 6,
                            .corrected_headers = 7},
                           12.5,
                           {.packets = 9, .cut_packets = 2},
                           4,
                           {{"spacecraft 76, virtual channel 1", false, {.received = 3, .gaps = 1, .missing = 2}},
                            {"APID 5", true, {.received = 9, .wraps = 1}}}}});
    REQUIRE(pipeline.commit().ok());

    const auto report = reader.proof(RunId{1});
    REQUIRE(report.ok());
    CHECK(report->recording_complete());
    REQUIRE(report->streams_size() == 1);
    const auto& stream = report->streams(0);
    CHECK(stream.realtime() == 12);
    CHECK(stream.identical() == 10);
    CHECK(stream.differs() == 1);
    CHECK(stream.missing_in_recording() == 1);
    CHECK(stream.recorded() == 19);
    CHECK(stream.never_seen_live() == 8);
    REQUIRE(report->links_size() == 3);
    CHECK(report->links(2).name() == "uhf_mro");
    CHECK(report->links(2).identical() == 1);
    REQUIRE(report->counters_size() == 1);
    CHECK(report->counters(0).missing_frames() == 2);
    CHECK(report->counters(0).cut_packets() == 2);
    CHECK(report->counters(0).bad_datagrams() == 4);
    CHECK(report->counters(0).other_data_frames() == 6);
    CHECK(report->counters(0).corrected_headers() == 7);
    CHECK(report->counters(0).octets_per_s() == 12.5);
    REQUIRE(report->counters(0).sequences_size() == 2);
    CHECK(report->counters(0).sequences(0).missing() == 2);
    CHECK(report->counters(0).sequences(1).name() == "APID 5");
    CHECK(report->counters(0).sequences(1).packets());

    archive::PacketQuery differing;
    differing.verdict = "differs";
    const auto found = reader.packets(RunId{1}, differing);
    REQUIRE(found->packets_size() == 2);  // the live one and the recorded one
    const auto& one = found->packets(0);
    CHECK(one.unit().source() == v1::SOURCE_REALTIME);
    CHECK(one.hex() != one.other_hex());
    CHECK(one.other_hex() == found->packets(1).hex());
    archive::PacketQuery missing;
    missing.verdict = "missing_in_recording";
    REQUIRE(reader.packets(RunId{1}, missing)->packets_size() == 1);
    CHECK(reader.packets(RunId{1}, missing)->packets(0).unit().sclk() == 1005.0);
}

}  // namespace archive_reader_test
