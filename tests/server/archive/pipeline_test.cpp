// SPDX-License-Identifier: Apache-2.0
#include "server/archive/reader.hpp"
#include "server/archive/sqlite.hpp"
#include "server/pipeline/pipeline.hpp"
#include "server/pipeline/situation_feed.hpp"
#include "telemetry/station/station_packets.hpp"
#include "tests/server/small_mission.hpp"
#include "tests/support/acknowledged.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/shipped_dictionary.hpp"
#include "tests/support/slept_time.hpp"

#include <cmath>
#include <csignal>
#include <cstdio>
#include <sys/resource.h>

namespace archive_pipeline_test {

using namespace aeolis;
using namespace aeolis::test;
using archive::Archive;
using archive::Reader;
using archive::Sequence;
using pipeline::Pipeline;

namespace {

struct Ground {
    TemporaryFolder folder;
    dictionary::Dictionary dictionary;
    std::filesystem::path file = folder / "a.db";
    Archive archive = std::move(Archive::open(file)).value();
    Pipeline pipeline{archive, dictionary};
    std::vector<std::shared_ptr<const pipeline::PublishedBatch>> published;

    explicit Ground(dictionary::Dictionary of = small_dictionary()) : dictionary(std::move(of)) {
        pipeline.on_publish([this](auto batch) { published.push_back(std::move(batch)); });
        archive::RunStart start;
        start.scenario = "test";
        start.entry = Sclk{1000.0};
        start.light_time_s = 10.0;
        start.correlation = {Sclk{100.0}, Scet{0}};
        start.tone_model = "statistical";
        start.solution = {{"solution_id", 1.0}};
        REQUIRE(pipeline.begin(start).ok());
    }
    Reader reader() { return std::move(Reader::open(file, dictionary)).value(); }
    archive::RunId run() const { return *pipeline.run(); }
    std::vector<v1::Item> items() const {
        std::vector<v1::Item> all;
        for (const auto& batch : published) all.insert(all.end(), batch->items.begin(), batch->items.end());
        return all;
    }
    /// A bit of everything.
    void feed() {
        REQUIRE(pipeline.accept({telemetry::uhf_live_link, Ert{5}, true, "nominal"}).ok());
        REQUIRE(pipeline.accept(live(navigation_packet(0, 1000.0, 9000.0F, 5900.0F))).ok());
        REQUIRE(pipeline.accept(live(navigation_packet(1, 1001.0, {}, 6100.0F))).ok());  // in alarm
        REQUIRE(pipeline.accept(live(status_packet(0, 1001.0, 2))).ok());
        REQUIRE(pipeline.accept(live(mortar_packet(0, 1002.0, 405.0F))).ok());
        REQUIRE(pipeline.accept(live(fired_packet(0, 1002.0, 2))).ok());
        REQUIRE(pipeline.accept(live({1, 2, 3})).ok());
        telemetry::ReceivedTone tone;
        tone.start = Ert{20'000'000};
        tone.end = Ert{30'000'000};
        tone.tone = ToneId{9};
        tone.likelihood = 0.999;
        tone.lock = CarrierLock::fluctuating;
        tone.best = BestTones{{{9, 0.999}, {8, 0.0004}, {200, 0.0003}, {0, 0.0002}, {255, 0.0001}}};
        tone.spectrum.emplace().fill(60);
        (*tone.spectrum)[4] = 111;
        REQUIRE(pipeline.accept(tone).ok());
        archive::StageRecord stage;
        stage.command = 1;
        stage.name = "NO_OP";
        stage.stage = commands::Stage::queued;
        stage.status = commands::Status::ok;
        stage.arguments = "a=1";
        stage.octets = {0xAB, 0xCD};
        REQUIRE(pipeline.accept(stage).ok());
    }
};

std::string text_of(const std::vector<v1::Item>& items) {
    std::string text;
    for (const auto& item : items) text += item.ShortDebugString() + "\n";
    return text;
}

/// A run whose clock drifts as no clock does: to be seen.
archive::RunStart drifting(double entry_sclk_s) {
    archive::RunStart start;
    start.scenario = "drifting";
    start.entry = Sclk{entry_sclk_s};
    start.correlation = {Sclk{100.0}, Scet{0}};
    start.correlation.rate = 1.25;
    start.correlation.version = 7;
    return start;
}

}  // namespace

TEST_CASE("nothing is published before it is committed", "[pipeline]") {
    Ground ground;
    ground.feed();
    CHECK(ground.published.empty());
    CHECK(ground.pipeline.last_durable() == 0);
    REQUIRE(ground.pipeline.commit().ok());
    REQUIRE(ground.published.size() == 1);
    CHECK(ground.pipeline.last_durable() == ground.published.front()->last_seq);
    CHECK(ground.pipeline.pending_items() == 0);
}

TEST_CASE("a run keeps its clock, and its drift counts where ground dates what it received", "[pipeline][time]") {
    Ground ground;
    REQUIRE(ground.pipeline.finish({archive::Outcome::stopped, "", "", ""}).ok());
    auto start = drifting(1000.0);
    start.correlation.leap_seconds = 35;
    REQUIRE(ground.pipeline.begin(start).ok());
    telemetry::ReceivedTone tone;
    tone.start = Ert{20'000'000};
    tone.end = Ert{30'000'000};
    REQUIRE(ground.pipeline.accept(tone).ok());
    REQUIRE(ground.pipeline.commit().ok());
    CHECK(ground.items().back().tone().sclk() == Approx(116.0));  // 20 s of UTC are 16 of this clock
    const auto state = ground.reader().run(ground.run());
    REQUIRE(state.ok());
    CHECK(state->clock().version() == 7);
    CHECK(state->clock().rate() == 1.25);
    CHECK(state->clock().leap_seconds() == 35);
    CHECK(state->clock().sclk() == 100.0);
    CHECK(state->clock().scet_us() == 0);
}

TEST_CASE("the clocks of runs and what commands waited for are told in plain SQL", "[pipeline][archive]") {
    Ground ground;
    REQUIRE(ground.pipeline.finish({archive::Outcome::stopped, "", "", ""}).ok());
    REQUIRE(ground.pipeline.begin(drifting(1100.0)).ok());
    archive::StageRecord stage;
    stage.command = 3;
    stage.name = "NO_OP";
    stage.stage = commands::Stage::released;
    stage.status = commands::Status::pending;
    stage.evidence = "waits for the approval of another controller than Ann";
    stage.ert = Ert{60'000'000};
    stage.needs_approval = true;
    stage.asked_by = "Ann";
    REQUIRE(ground.pipeline.accept(stage).ok());
    REQUIRE(ground.pipeline.commit().ok());

    auto database =
        std::move(archive::sqlite::Database::open(ground.file.string(), archive::sqlite::Mode::read_only)).value();
    const auto row_of = [&](const char* sql) {
        auto rows = database.prepare(sql);
        REQUIRE(rows.ok());
        std::string text;
        REQUIRE(*rows->step());
        for (int column = 0; column < 5; ++column) text += std::string(rows->text(column)) + " ";
        return text;
    };
    CHECK(row_of("SELECT scenario, version, drift, scet, entry_scet FROM clock_log WHERE run = 2") ==
          "drifting 7 0.25 2000-001T12:00:00.000 2000-001T12:20:50.000 ");
    CHECK(row_of("SELECT run, command, asked_by, needs_approval, at FROM command_wait_log") ==
          "2 3 Ann 1 2000-001T12:01:00.000 ");
}

TEST_CASE("the history of a command says in fields that it is held or needs approval, and no longer once it has left",
          "[pipeline][gateway]") {
    Ground ground;
    const auto say = [&](commands::Stage stage, commands::Status status, bool held, bool needs_approval) {
        archive::StageRecord record;
        record.command = 1;
        record.name = "NO_OP";
        record.stage = stage;
        record.status = status;
        record.held = held;
        record.needs_approval = needs_approval;
        if (needs_approval) record.asked_by = "Ann";
        REQUIRE(ground.pipeline.accept(record).ok());
        REQUIRE(ground.pipeline.commit().ok());
        auto reader = ground.reader();
        const auto list = reader.commands(ground.run());
        REQUIRE(list.ok());
        return list->commands(0);
    };
    CHECK_FALSE(say(commands::Stage::queued, commands::Status::ok, false, false).held());
    const auto waits = say(commands::Stage::released, commands::Status::pending, true, true);
    CHECK(waits.held());
    CHECK(waits.needs_approval());
    CHECK(waits.stages(1).command_stage().asked_by() == "Ann");
    CHECK(waits.stages(1).command_stage().held());
    CHECK_FALSE(say(commands::Stage::released, commands::Status::pending, true, false).needs_approval());
    CHECK_FALSE(say(commands::Stage::released, commands::Status::ok, false, false).held());
}

TEST_CASE("items are numbered from 1 without a gap, and read back as they were published", "[pipeline][R42][R43]") {
    Ground ground;
    ground.feed();
    REQUIRE(ground.pipeline.commit().ok());
    const auto items = ground.items();
    for (std::size_t i = 0; i < items.size(); ++i) {
        CHECK(items[i].seq() == i + 1);
        CHECK(items[i].item_case() != v1::Item::ITEM_NOT_SET);
    }
    auto reader = ground.reader();
    const auto page = reader.items(ground.run(), 0, 1000);
    REQUIRE(page.ok());
    CHECK_FALSE(page->more);
    CHECK(page->complete_through == items.back().seq());
    CHECK(text_of(page->items) == text_of(items));
}

TEST_CASE("reading after any number, in pages of any size, gives every item once", "[pipeline][reader]") {
    Ground ground;
    for (int i = 0; i < 3; ++i) ground.feed();
    REQUIRE(ground.pipeline.commit().ok());
    const auto all = ground.items();
    auto reader = ground.reader();
    for (const auto& [limit, octets_max] : {std::pair<std::size_t, std::size_t>{1, SIZE_MAX},
                                            {2, SIZE_MAX},
                                            {3, SIZE_MAX},
                                            {7, SIZE_MAX},
                                            {1'000, 1},
                                            {1'000, 200}}) {
        for (Sequence first = 0; first <= all.back().seq(); ++first) {
            std::vector<v1::Item> read;
            Sequence after = first;
            for (bool more = true; more;) {
                auto page = reader.items(ground.run(), after, limit, {.octets_max = octets_max});
                REQUIRE(page.ok());
                REQUIRE(page->items.size() <= limit);
                if (octets_max == 1) REQUIRE(std::ranges::count_if(page->items, &v1::Item::has_unit) <= 1);
                REQUIRE((page->complete_through > after || !page->more));
                read.insert(read.end(), page->items.begin(), page->items.end());
                after = page->complete_through;
                more = page->more;
            }
            REQUIRE(text_of(read) == text_of({all.begin() + static_cast<std::ptrdiff_t>(first), all.end()}));
        }
    }
    const auto events = reader.items(ground.run(), 0, 1000, {false, false});
    REQUIRE(events.ok());
    CHECK(events->complete_through == all.back().seq());
    for (const auto& item : events->items) CHECK_FALSE((item.has_unit() || item.has_samples()));
}

TEST_CASE("a packet of the recording that was seen in real time is kept as proof and not doubled", "[pipeline][R29]") {
    Ground ground;
    for (std::uint16_t i = 0; i < 10; ++i)
        if (i % 2 == 0) REQUIRE(ground.pipeline.accept(live(navigation_packet(i, 1000.0 + i, 100.0F * i, 1.0F))).ok());
    REQUIRE(ground.pipeline.accept(live(mortar_packet(0, 1002.0, 405.0F))).ok());
    for (std::uint16_t i = 0; i < 10; ++i)
        REQUIRE(ground.pipeline.accept(recorded(navigation_packet(i, 1000.0 + i, 100.0F * i, 1.0F))).ok());
    REQUIRE(ground.pipeline.accept(recorded(mortar_packet(0, 1002.0, 405.0F))).ok());
    ground.pipeline.relay_progress(0.5);
    REQUIRE(ground.pipeline.commit().ok());

    auto reader = ground.reader();
    const auto series = reader.series(ground.run(), {{"altitude_m"}, {}, {}});
    REQUIRE(series.ok());
    const auto& altitude_series = series->channels(0);
    REQUIRE(altitude_series.sclk_size() == 10);
    for (int i = 0; i < 10; ++i) {
        CHECK(altitude_series.sclk(i) == 1000.0 + i);
        CHECK(altitude_series.source(i) == (i % 2 == 0 ? v1::SOURCE_REALTIME : v1::SOURCE_RECORDED));
    }
    const auto proof = reader.recording(ground.run());
    REQUIRE(proof.ok());
    CHECK(proof->recorded() == 11);
    CHECK(proof->realtime() == 6);
    CHECK(proof->realtime_not_recorded() == 0);
    CHECK(proof->realtime_differs() == 0);
    CHECK(proof->never_seen_live() == 5);
    CHECK(proof->progress() == 0.5);
    CHECK(reader.events(ground.run(), {})->events_size() == 1);
    archive::EventQuery both;
    both.duplicates = true;
    CHECK(reader.events(ground.run(), both)->events_size() == 2);
}

TEST_CASE("a packet whose octets differ in the recording is told", "[pipeline][R29]") {
    Ground ground;
    REQUIRE(ground.pipeline.accept(live(status_packet(0, 1000.0, 2))).ok());
    REQUIRE(ground.pipeline.accept(recorded(status_packet(0, 1000.0, 3))).ok());
    CHECK(ground.pipeline.totals().realtime_differs == 1);
}

TEST_CASE("what cannot be decoded is stored and says why", "[pipeline]") {
    Ground ground;
    auto broken = navigation_packet(0, 1000.0, 1.0F, 1.0F);
    broken[20] ^= 0xFFU;
    REQUIRE(ground.pipeline.accept(live(broken)).ok());
    REQUIRE(ground.pipeline.commit().ok());
    REQUIRE(ground.items().size() == 1);
    CHECK(ground.items().front().unit().name() == "not decoded: bad_crc");
    CHECK(ground.reader().packets(ground.run(), {})->packets(0).hex().size() == 2 * broken.size());
}

TEST_CASE("spectra are kept as packets that ground made, whole, and none of it was heard",
          "[pipeline][archive][R53][R54]") {
    Ground ground{tests::shipped_dictionary()};
    telemetry::Received received;
    for (int second = 0; second < 3; ++second) {
        auto& spectrum = received.spectra.emplace_back();
        spectrum.middle = Ert{20'000'000 + second * 1'000'000};
        spectrum.ert = Ert{20'500'000 + second * 1'000'000};
        spectrum.row.first_hz = -8192.0;
        spectrum.row.bin_hz = 32.0;
        spectrum.row.levels.assign(telemetry::thinned_bins, static_cast<std::uint8_t>(60 + second));
    }
    REQUIRE(ground.pipeline.accept(received).ok());
    CHECK(ground.pipeline.totals().realtime == 0);
    CHECK(ground.pipeline.totals().not_decoded == 0);
    REQUIRE(ground.pipeline.commit().ok());
    archive::PacketQuery query;
    query.name = "StationSpectrum";
    const auto list = ground.reader().packets(ground.run(), query);
    REQUIRE(list.ok());
    REQUIRE(list->packets_size() == 3);
    for (int second = 0; second < 3; ++second) {
        const auto& packet = list->packets(second);
        CHECK(packet.verdict() == "made_on_ground");
        CHECK(packet.problem().empty());
        CHECK(packet.unit().sclk() == 110.0 + second);
        CHECK_THAT(packet.hex(), Catch::Contains(second == 0 ? "3c3c3c3c" : second == 1 ? "3d3d3d3d" : "3e3e3e3e"));
    }
}

TEST_CASE(
    "the carrier and what its Doppler shows are kept as packets, samples and events that ground made, and none of "
    "it was heard",
    "[pipeline][archive][R53][R54]") {
    Ground ground{tests::shipped_dictionary()};
    telemetry::ReceivedCarrier carrier;
    carrier.ert = Ert{20'500'000};
    carrier.middle = Ert{20'000'000};
    carrier.predict_hz = -450'000.25;
    carrier.lock = CarrierLock::locked;
    carrier.estimate = {-12.5, 0.0625, -0.5, 22.25};
    telemetry::Received received;
    received.carrier.push_back(carrier);
    carrier.middle = Ert{20'125'000};
    carrier.lock = CarrierLock::coasting;
    carrier.estimate.reset();
    received.carrier.push_back(carrier);
    received.seen.push_back(
        {telemetry::SeenByDoppler::Feature::parachute, Ert{20'750'000}, Ert{20'000'000}, 1166.5, 0.5});
    REQUIRE(ground.pipeline.accept(received).ok());
    REQUIRE(ground.pipeline.accept(telemetry::EarthTime{Ert{21'000'000}}).ok());
    CHECK(ground.pipeline.totals().realtime == 0);
    CHECK(ground.pipeline.totals().realtime_not_recorded == 0);
    CHECK(ground.pipeline.totals().not_decoded == 0);
    REQUIRE(ground.pipeline.commit().ok());

    auto reader = ground.reader();
    const auto series = reader.series(ground.run(), {{"STA-0001", "STA-0002", "STA-0003", "STA-0006"}, {}, {}});
    REQUIRE(series.ok());
    const auto value = [&](int channel, int sample) { return series->channels(channel).value(sample); };
    for (const auto& each : series->channels()) {
        REQUIRE(each.value_size() == 2);
        CHECK(each.sclk(0) == 110.0);  // 20 s on Earth are 10 s after SCLK 100, by 10 s of light time
        CHECK(each.sclk(1) == 110.125);
    }
    CHECK((value(0, 0) == 0.0 && value(0, 1) == 2.0));
    CHECK((value(1, 0) == -450'000.25 && value(1, 1) == -450'000.25));
    CHECK(value(2, 0) == -12.5);
    CHECK(value(3, 0) == 22.25);
    CHECK((std::isnan(value(2, 1)) && std::isnan(value(3, 1))));

    const auto events = reader.events(ground.run(), {});
    REQUIRE(events->events_size() == 1);
    CHECK(events->events(0).event().name() == "SEEN_BY_DOPPLER");
    CHECK(events->events(0).event().sclk() == 110.0);
    CHECK_THAT(events->events(0).event().text(), Catch::StartsWith("parachute seen by Doppler"));
    CHECK_THAT(events->events(0).event().text(), Catch::Contains("1166.5"));

    const auto packets = reader.packets(ground.run(), {});
    REQUIRE(packets->packets_size() == 3);
    for (const auto& packet : packets->packets()) {
        CHECK(packet.unit().link() == "station");
        CHECK(packet.verdict() == "made_on_ground");
    }
    archive::PacketQuery of_ground;
    of_ground.verdict = "made_on_ground";
    CHECK(reader.packets(ground.run(), of_ground)->packets_size() == 3);
    of_ground.verdict = "pending";
    CHECK(reader.packets(ground.run(), of_ground)->packets_size() == 0);
    const auto proof = reader.proof(ground.run());
    CHECK(proof->streams_size() == 0);
    CHECK(proof->links_size() == 0);
    archive::RawQuery brought;
    brought.packets = true;
    CHECK(reader.raw(ground.run(), brought, {})->pieces.empty());
    for (const auto& item : ground.items()) CHECK_FALSE(item.has_staleness());
}

TEST_CASE("a packet that only ground makes is not taken from a link", "[pipeline][R53]") {
    Ground ground{tests::shipped_dictionary()};
    telemetry::ReceivedCarrier carrier;
    carrier.estimate = telemetry::ReceivedCarrier::Estimate{};
    const auto forged = telemetry::station_carrier_packet(carrier, Sclk{110.0}, 0, ground.dictionary.id);
    REQUIRE(ground.pipeline.accept(live(forged)).ok());
    REQUIRE(ground.pipeline.commit().ok());
    REQUIRE(ground.items().size() == 1);
    CHECK(ground.items().front().unit().name() == "not decoded: made_on_ground");
    CHECK(ground.pipeline.totals().not_decoded == 1);
}

TEST_CASE("of a mission whose dictionary has no station nothing of it is kept", "[pipeline]") {
    Ground ground;
    telemetry::Received received;
    received.carrier.emplace_back();
    received.seen.emplace_back();
    REQUIRE(ground.pipeline.accept(received).ok());
    CHECK(ground.pipeline.pending_items() == 0);
}

TEST_CASE("alarms are raised and cleared by real-time samples only", "[pipeline]") {
    Ground ground;
    REQUIRE(ground.pipeline.accept(live(navigation_packet(0, 1000.0, 1.0F, 6100.0F))).ok());
    REQUIRE(ground.pipeline.accept(live(navigation_packet(1, 1001.0, 1.0F, 5900.0F))).ok());
    REQUIRE(ground.pipeline.accept(recorded(navigation_packet(2, 1002.0, 1.0F, 6100.0F))).ok());
    REQUIRE(ground.pipeline.commit().ok());
    std::vector<std::string> severities;
    for (const auto& item : ground.items())
        if (item.has_alarm()) severities.push_back(v1::Alarm::Severity_Name(item.alarm().severity()));
    CHECK(severities == std::vector<std::string>{"warning", "none"});
}

TEST_CASE("a packet that was decoded on its way is not decoded again: what that decode says is stored", "[pipeline]") {
    Ground ground;
    const auto decoded_as = [&](const std::vector<std::uint8_t>& octets) {
        auto decoded = std::make_shared<telemetry::DecodedPacket>();
        telemetry::PacketDecoder{ground.dictionary}.decode(octets, *decoded);
        return decoded;
    };
    auto navigation = live(navigation_packet(0, 1000.0, 1.0F, 6100.0F));
    navigation.decoded = decoded_as(navigation_packet(0, 1000.0, 1.0F, 5555.0F));
    auto mortar = live(mortar_packet(0, 1000.0, 405.0F));
    mortar.decoded = decoded_as(mortar_packet(0, 1000.0, 333.0F));
    auto refused = live(mortar_packet(1, 1001.0, 405.0F));
    refused.decoded = decoded_as({1, 2, 3});
    for (const auto& packet : {navigation, mortar, refused}) REQUIRE(ground.pipeline.accept(packet).ok());
    REQUIRE(ground.pipeline.commit().ok());
    const auto stored = text_of(ground.items());
    CHECK(stored.find("5555") != std::string::npos);
    CHECK(stored.find("6100") == std::string::npos);
    CHECK(stored.find("333") != std::string::npos);
    CHECK(stored.find("405") == std::string::npos);
    CHECK(stored.find("not_a_packet") != std::string::npos);
    CHECK(ground.pipeline.totals().not_decoded == 1);
}

TEST_CASE("the tone's vehicle time is its start less the light time", "[pipeline][R42]") {
    Ground ground;
    ground.feed();
    REQUIRE(ground.pipeline.commit().ok());
    const auto tones = ground.reader().tones(ground.run(), {});
    REQUIRE(tones.ok());
    REQUIRE(tones->tones_size() == 1);
    CHECK(tones->tones(0).tone().sclk() == Approx(110.0));  // 20 s after the correlation at SCLK 100, less 10 s
    CHECK(tones->tones(0).tone().meaning() == "parachute deployed");
}

TEST_CASE("an event that tells the phase is believed at once: what the new phase does not promise is not missed",
          "[pipeline][alarms][staleness]") {
    const bool event_heard = GENERATE(true, false);
    TemporaryFolder folder;
    auto dictionary = small_dictionary();
    dictionary::Type of_phase = dictionary.channels[phase.value].type;
    of_phase.name = "EdlPhase";
    of_phase.kind = dictionary::ValueKind::enumerated;
    of_phase.enumeration = {{2, "sky_crane"}, {9, "landed"}};
    dictionary.channels[phase.value].type = dictionary.packets[1].fields[0].type = of_phase;
    const unsigned data = tm_data_offset_octets * 8;
    dictionary::Packet changed{"EDL_PHASE_CHANGED", "", event_apid, EvrId{8}, tm_overhead_octets + 3, {}, {}, {}};
    changed.fields = {{"event_id", whole(16), {}, data, {}}, {"phase", of_phase, {}, data + 16, {}}};
    dictionary.packets.push_back(changed);
    dictionary.model = tests::packet_model_of(dictionary);
    auto& row = dictionary.telemetry_plan.emplace_back();
    row.plan = "all";
    row.packet = "Navigation";
    row.every = {64, 64, 64, 0};
    auto archive = std::move(Archive::open(folder / "a.db")).value();
    Pipeline pipeline{archive, dictionary};
    REQUIRE(pipeline.begin({}).ok());
    REQUIRE(pipeline.accept(telemetry::LinkState{telemetry::uhf_live_link, Ert{0}, true, "nominal"}).ok());
    REQUIRE(pipeline.accept(live(status_packet(0, 1000.0, 2), 100'000)).ok());
    for (std::uint16_t i = 0; i < 3; ++i)
        REQUIRE(pipeline.accept(live(navigation_packet(i, 1000.5 + i, 1.0F, 2.0F), 500'000 + 1'000'000 * i)).ok());
    Octets event(tm_overhead_octets + 3);
    BitWriter bits{std::span<std::uint8_t>(event).subspan(tm_data_offset_octets)};
    bits.put(8, 16);
    bits.put(9, 8);
    seal_tm_packet(event, event_apid, 0, Sclk{1003.0}, dictionary_id);
    if (event_heard) REQUIRE(pipeline.accept(live(event, 3'000'000)).ok());
    REQUIRE(pipeline.accept(live(status_packet(1, 1002.0, 2), 3'500'000)).ok());  // told before the event, and late
    REQUIRE(pipeline.accept(telemetry::EarthTime{Ert{12'000'000}}).ok());
    REQUIRE(pipeline.commit().ok());
    auto database = archive::sqlite::Database::open((folder / "a.db").string(), archive::sqlite::Mode::read_only);
    CHECK(database->integer_of("SELECT count(*) FROM staleness WHERE packet = 0 AND expected_s > 0").value() ==
          (event_heard ? 0 : 1));
}

TEST_CASE("tones are found by words and come in pages", "[pipeline][reader]") {
    Ground ground;
    for (int i = 0; i < 5; ++i) {
        telemetry::ReceivedTone tone;
        tone.start = Ert{(20 + 10 * i) * 1'000'000};
        tone.end = Ert{(30 + 10 * i) * 1'000'000};
        if (i != 2) tone.tone = ToneId{static_cast<std::uint8_t>(i % 2 == 0 ? 9 : 8)};
        REQUIRE(ground.pipeline.accept(tone).ok());
    }
    REQUIRE(ground.pipeline.commit().ok());
    auto reader = ground.reader();
    const auto found = [&](const char* text) { return reader.tones(ground.run(), {{}, text})->tones_size(); };
    CHECK(found("") == 5);
    CHECK(found("DEPLOY para") == 2);  // beginnings, in any order and case
    CHECK(found("chute") == 0);
    CHECK(found("--") == 0);
    archive::ToneQuery page;
    page.limit = 2;
    std::string starts;
    do {
        const auto tones = reader.tones(ground.run(), page);
        REQUIRE(tones.ok());
        for (const auto& item : tones->tones()) starts += std::to_string(item.tone().ert_start_us() / 1'000'000) + " ";
        starts += "| ";
        page.after = tones->next_after();
    } while (page.after != 0);
    CHECK(starts == "20 30 | 40 50 | 60 | ");
    CHECK_FALSE(reader.tones(ground.run(), {{}, "", 0, 0}).ok());
    CHECK(reader.tones(ground.run(), {{120.0, 130.0}, ""})->tones_size() == 2);
}

TEST_CASE("commands are found by when Earth heard what left the vehicle in a range", "[pipeline][reader]") {
    Ground ground;
    for (const auto& [command, at_s] : {std::pair{1, 30}, {2, 50}, {1, 70}}) {
        archive::StageRecord stage;
        stage.command = static_cast<std::uint64_t>(command);
        stage.name = "NO_OP";
        stage.stage = commands::Stage::queued;
        stage.status = commands::Status::ok;
        stage.ert = Ert{at_s * 1'000'000};
        REQUIRE(ground.pipeline.accept(stage).ok());
    }
    REQUIRE(ground.pipeline.commit().ok());
    auto reader = ground.reader();
    const auto found = [&](archive::SclkRange range) {
        std::string numbers;
        const auto list = reader.commands(ground.run(), {range, ""});
        REQUIRE(list.ok());
        for (const auto& command : list->commands())
            numbers += std::to_string(command.command()) + ":" + std::to_string(command.stages_size()) + " ";
        return numbers;
    };
    // SCLK 100 is 10 s on Earth: what leaves then is heard 10 s later.
    CHECK(found({}) == "1:2 2:1 ");
    CHECK(found({130.0, 140.0}) == "2:1 ");
    CHECK(found({120.0, 120.0}) == "1:2 ");  // with all its stages
    CHECK(found({150.0, {}}) == "1:2 ");
    CHECK(found({{}, 119.0}).empty());
    CHECK_FALSE(reader.commands(ground.run(), {{2.0, 1.0}, ""}).ok());
}

TEST_CASE("a tone's evidence is kept and read back: lock, the best five, the spectrum", "[pipeline][archive][R31]") {
    Ground ground;
    ground.feed();
    REQUIRE(ground.pipeline.commit().ok());
    const auto list = ground.reader().tones(ground.run(), {});
    REQUIRE(list.ok());
    const v1::Tone& tone = list->tones(0).tone();
    CHECK(tone.lock() == v1::Carrier::fluctuating);
    CHECK_FALSE(tone.locked());
    REQUIRE(tone.best_size() == 5);
    CHECK(tone.best(0).tone() == 9);
    CHECK(tone.best(4).tone() == 255);
    CHECK(tone.best(2).likelihood() == 0.0003);
    CHECK(tone.runner_up() == 8);
    REQUIRE(tone.spectrum().size() == 128);
    CHECK(tone.spectrum()[4] == 111);
    CHECK(tone.spectrum()[5] == 60);
}

TEST_CASE("a tone that was drawn has no spectrum", "[pipeline][archive][R31]") {
    Ground ground;
    telemetry::ReceivedTone tone;
    tone.best = BestTones{};
    REQUIRE(ground.pipeline.accept(tone).ok());
    REQUIRE(ground.pipeline.commit().ok());
    CHECK_FALSE(ground.items().front().tone().has_spectrum());
    CHECK_FALSE(ground.reader().tones(ground.run(), {})->tones(0).tone().has_spectrum());
}

TEST_CASE("commits come by time or by number, never empty", "[pipeline]") {
    Ground ground;
    const auto start = std::chrono::steady_clock::time_point{} + std::chrono::hours{1};
    REQUIRE(ground.pipeline.commit_if_due(start).ok());
    CHECK(ground.published.empty());
    REQUIRE(ground.pipeline.accept(live(status_packet(0, 1000.0, 1))).ok());
    REQUIRE(ground.pipeline.commit_if_due(start).ok());
    CHECK(ground.published.size() == 1);
    REQUIRE(ground.pipeline.accept(live(status_packet(1, 1001.0, 1))).ok());
    REQUIRE(ground.pipeline.commit_if_due(start + pipeline::commit_interval / 2).ok());
    CHECK(ground.published.size() == 1);
    REQUIRE(ground.pipeline.commit_if_due(start + pipeline::commit_interval).ok());
    CHECK(ground.published.size() == 2);
    REQUIRE(ground.pipeline.commit_if_full().ok());
    CHECK(ground.published.size() == 2);
}

TEST_CASE("items are not built while nobody wants them, but are stored", "[pipeline]") {
    Ground ground;
    ground.pipeline.want_items(false);
    ground.feed();
    REQUIRE(ground.pipeline.commit().ok());
    REQUIRE(ground.published.size() == 1);
    CHECK_FALSE(ground.published.front()->built);
    CHECK(ground.published.front()->items.empty());
    CHECK(ground.reader().items(ground.run(), 0, 1000)->complete_through == ground.published.front()->last_seq);
}

TEST_CASE("while the disk is full nothing is published or lost, and it goes on when there is room", "[pipeline]") {
    Ground ground;
    ground.feed();
    REQUIRE(ground.pipeline.commit().ok());
    const auto before = ground.published.size();
    // The kernel refuses to let files grow: as a full disk, but for this process only.
    rlimit usual{};
    ::getrlimit(RLIMIT_FSIZE, &usual);
    const auto ignored = std::signal(SIGXFSZ, SIG_IGN);
    for (std::uint16_t i = 0; i < 3000; ++i)
        REQUIRE(ground.pipeline.accept(live(navigation_packet(i, 2000.0 + i, 1.0F, 2.0F))).ok());
    rlimit full = usual;
    full.rlim_cur = std::filesystem::file_size(ground.folder / "a.db-wal") + 10'000;
    ::setrlimit(RLIMIT_FSIZE, &full);
    const auto pending = ground.pipeline.pending_items();
    for (int attempt = 0; attempt < 3; ++attempt) {
        const auto failed = ground.pipeline.commit();
        CHECK_FALSE(failed.ok());
        if (!failed) CHECK(failed.error().message.find("a.db") != std::string::npos);
    }
    CHECK(ground.published.size() == before);
    CHECK(ground.pipeline.pending_items() == pending);
    ::setrlimit(RLIMIT_FSIZE, &usual);
    std::signal(SIGXFSZ, ignored);
    REQUIRE(ground.pipeline.commit().ok());
    const auto page = ground.reader().items(ground.run(), 0, 10'000);
    REQUIRE(page.ok());
    CHECK(text_of(page->items) == text_of(ground.items()));
    CHECK(ground.reader().series(ground.run(), {{"altitude_m"}, {2000.0, {}}, {}})->channels(0).samples() == 3000);
}

TEST_CASE("finishing seals the series and says how the run ended", "[pipeline][R43]") {
    Ground ground;
    ground.feed();
    const auto run = ground.run();
    REQUIRE(ground.pipeline.finish({archive::Outcome::touchdown, "nominal", "d1", "2026-01-01T00:00:00Z"}).ok());
    CHECK_FALSE(ground.pipeline.run().has_value());
    auto reader = ground.reader();
    const auto state = reader.run(run);
    REQUIRE(state.ok());
    CHECK(state->state() == v1::RunState::finished);
    CHECK(state->outcome() == v1::Landing::touchdown);
    CHECK(state->digest() == "d1");
    CHECK(state->last_seq() == ground.items().back().seq());
    CHECK(state->solution(0).name() == "solution_id");
    CHECK(reader.series(run, {{"altitude_m", "GNC-0002"}, {}, {}})->channels(1).sclk_size() == 2);
}

TEST_CASE("part of a test: a recording that is killed", "[.part]") {
    const auto file = variable("AEOLIS_TEST_ARCHIVE");
    REQUIRE_FALSE(file.empty());
    const auto dictionary = small_dictionary();
    auto archive = Archive::open(file);
    REQUIRE(archive);
    const Acknowledging acknowledges{file};
    Pipeline pipeline(*archive, dictionary);
    pipeline.on_publish([&](const auto& batch) { acknowledges(batch->last_seq); });
    REQUIRE(pipeline.begin({}));
    for (std::uint32_t i = 0;; ++i) {
        const auto count = static_cast<std::uint16_t>(i & 0x3FFFU);
        REQUIRE(pipeline.accept(live(navigation_packet(count, i / 64.0, 1.0F, 2.0F))));
        if (i % 50 == 49) REQUIRE(pipeline.commit());
    }
}

TEST_CASE("kill -9 takes back nothing that was acknowledged", "[pipeline][archive]") {
    TemporaryFolder folder;
    const auto file = folder / "a.db";
    auto recording =
        ChildProcess::part("part of a test: a recording that is killed", {{"AEOLIS_TEST_ARCHIVE", file.string()}});
    const Sequence acknowledged = killed_after(recording, 20'000, file);
    REQUIRE(acknowledged >= 20'000);

    const auto dictionary = small_dictionary();
    const tests::SleptTime time;
    auto archive = Archive::open(file);
    REQUIRE(archive.ok());
    CHECK(time.passed() < std::chrono::seconds{1});
    CHECK(archive->interrupted() == std::vector<archive::RunId>{archive::RunId{1}});
    auto reader = Reader::open(file, dictionary);
    const auto state = reader->run(archive::RunId{1});
    REQUIRE(state.ok());
    CHECK(state->state() == v1::RunState::interrupted);
    CHECK(state->last_seq() >= acknowledged);
    Sequence after = 0;
    for (bool more = true; more;) {
        const auto page = reader->items(archive::RunId{1}, after, 10'000);
        REQUIRE(page.ok());
        for (const auto& item : page->items) REQUIRE(item.seq() == ++after);
        more = page->more;
    }
    CHECK(after == state->last_seq());
    const auto series = reader->series(archive::RunId{1}, {{"altitude_m"}, {}, {}});
    REQUIRE(series.ok());
    CHECK(series->channels(0).samples() == after / 2);  // sealed segments and the open tail together
}

TEST_CASE("a situation is an item like every other: numbered, published, read back with its list, and said once until "
          "it changes",
          "[pipeline][situation]") {
    Ground ground;
    REQUIRE(ground.pipeline.accept(telemetry::LinkState{telemetry::uhf_live_link, Ert{0}, true, "nominal"}).ok());
    const auto pass = [&](std::int64_t at_s) {
        REQUIRE(ground.pipeline.accept(telemetry::EarthTime{Ert{at_s * 1'000'000}}).ok());
        REQUIRE(ground.pipeline.commit().ok());
    };
    for (const std::int64_t at_s : {1, 2, 3}) pass(at_s);
    REQUIRE(ground.items().size() == 2);
    const auto said = ground.items().back();
    CHECK(said.seq() == 2);
    CHECK(said.ert_us() == 1'000'000);
    REQUIRE(said.has_situation());
    CHECK(said.situation().entries_size() > 0);
    REQUIRE(ground.pipeline
                .accept(telemetry::LinkState{telemetry::uhf_live_link, Ert{3'500'000}, false,
                                             "unexplained: nothing is predicted to silence it now", true})
                .ok());
    pass(4);
    REQUIRE(ground.items().size() == 4);
    CHECK(ground.items().back().situation().entries(0).subject() == "uhf_live");
    auto reader = ground.reader();
    const auto page = reader.items(ground.run(), 0, 10);
    REQUIRE(page.ok());
    REQUIRE(page->items.size() == 4);
    for (std::size_t i = 0; i < 4; ++i)
        CHECK(page->items[i].SerializeAsString() == ground.items()[i].SerializeAsString());
}

TEST_CASE("a followed mission that has a packet of the shadow's name is not decoded by our model", "[pipeline]") {
    auto followed = small_dictionary();
    followed.model = nullptr;
    followed.packets.front().name = "ShadowExpects";
    REQUIRE(followed.packet("ShadowExpects") != nullptr);
    pipeline::SituationFeed feed{followed, archive::RunStart{}};
    feed.follow(archive::Batch{});
    CHECK(feed.changed(Ert{1'000'000}).has_value());
    CHECK_FALSE(feed.changed().has_value());  // as it was told
}

}  // namespace archive_pipeline_test
