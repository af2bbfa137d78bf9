// SPDX-License-Identifier: Apache-2.0
#include "server/base/digest.hpp"
#include "server/base/json.hpp"
#include "server/rehearsal/landing_report.hpp"
#include "telemetry/packet_stream.hpp"
#include "tests/server/running_server.hpp"

#include <google/protobuf/struct.pb.h>
#include <map>

namespace server_rehearsal_test {

using namespace aeolis;
using namespace aeolis::server;

TEST_CASE("the digest is SHA-256 of all octets, however they are cut", "[digest]") {
    Digest whole, pieces;
    const std::vector<std::uint8_t> abc{'a', 'b', 'c'};
    whole.add(abc);
    for (const auto octet : abc) pieces.add({&octet, 1});
    CHECK(whole.text() == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");  // [fips-180-4]
    CHECK(pieces.text() == whole.text());
    CHECK(Digest{}.text() == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

TEST_CASE("a landing's report is the object of the design, its real time proven by its recording", "[rehearsal][R41]") {
    Rehearsal rehearsal{test::shipped_scenario("nominal_auto"), 1, 0, tests::shipped_dictionary()};
    while (!rehearsal.finished()) rehearsal.step();
    INFO(landing_table(rehearsal, 1.0));
    CHECK(rehearsal.script_refusals().empty());

    google::protobuf::Struct report;
    REQUIRE(from_json(landing_json(rehearsal, 1.0), report));
    const auto& fields = report.fields();
    for (const char* name : {"scenario", "seed", "outcome", "digest", "events", "peak_deceleration_mps2", "touchdown",
                             "heatshield_least_m", "backshell_least_m", "test_venue", "timepoints", "tones", "packets",
                             "cycles", "overruns", "wall_s", "real_time_factor", "verdict", "limits_exceeded"}) {
        INFO(name);
        CHECK(fields.contains(name));
    }
    CHECK(fields.size() == 19);
    CHECK(fields.at("backshell_least_m").number_value() > 10.0);  // the sidestep
    CHECK(fields.at("outcome").string_value() == "touchdown");
    CHECK(fields.at("verdict").string_value() == "landed");
    CHECK(fields.at("limits_exceeded").list_value().values_size() == 0);
    double previous = -1.0e9;
    for (const auto& event : fields.at("events").list_value().values()) {
        const double e_s = event.struct_value().fields().at("e_s").number_value();
        CHECK(e_s >= previous);
        previous = e_s;
    }
    const auto& packets = fields.at("packets").struct_value().fields();
    CHECK(packets.at("realtime").number_value() > 1000);
    CHECK(packets.at("recorded").number_value() > packets.at("realtime").number_value());
    CHECK(packets.at("realtime_not_recorded").number_value() == 0);
    CHECK(packets.at("realtime_differs").number_value() == 0);
    CHECK(fields.at("overruns").number_value() == 0);
    CHECK(fields.at("timepoints").list_value().values_size() >= 45);
}

TEST_CASE("the scenarios in which a computer fails end on the ground", "[.long][rehearsal][R32][R33]") {
    for (const char* name : {"pre_edl", "second_chance"}) {
        INFO(name);
        Rehearsal rehearsal{test::shipped_scenario(name), 1, 0, tests::shipped_dictionary()};
        while (!rehearsal.finished()) rehearsal.step();
        CHECK(rehearsal.outcome() == archive::Outcome::touchdown);
        CHECK(rehearsal.proof().holds());
        CHECK(rehearsal.landing().counters().resets == 1);
    }
}

TEST_CASE("do edl among another's 1400 commands is executed, each of its stages is known, and so are theirs",
          "[release][rehearsal][bounds][R63]") {
    const double uhf_rate_bps = GENERATE(8000.0, 4000.0);
    const bool is_director = GENERATE(false, true);
    // Expedited, so that nothing waits for a report of the vehicle; or as it comes.
    const char* const service = GENERATE("BD", "");
    INFO(uhf_rate_bps << " b/s, " << (is_director ? "a director" : "a controller") << ", service '" << service << "'");
    auto scenario = test::shipped_scenario("nominal_auto");
    scenario.radio.uhf_rate_bps = uhf_rate_bps;
    Rehearsal rehearsal{scenario, 1, 0, tests::shipped_dictionary()};
    using Stages = std::map<commands::Stage, commands::Status>;
    std::map<std::string, std::map<std::uint64_t, Stages>> fates;
    v1::CommandRequest flood;
    flood.set_command("NO_OP");
    flood.set_service(service);
    int asked = 0;
    while (rehearsal.clocks().e_s() < -1170.0 + 60.0) {
        rehearsal.step();
        for (int now = 0; rehearsal.clocks().e_s() > -1172.0 && now < 8 && asked < 1400; ++now, ++asked)
            REQUIRE(rehearsal.submit(flood, "greedy", is_director).accepted());
        for (const auto& stage : rehearsal.take_stages()) fates[stage.name][stage.command][stage.stage] = stage.status;
    }
    REQUIRE(fates["EDL_DO_EDL"].size() == 1);
    for (const auto& [stage, status] : fates["EDL_DO_EDL"].begin()->second) {
        INFO(commands::name_of(stage) << ", " << commands::name_of(status));
        CHECK(status == commands::Status::ok);
    }
    CHECK(fates["EDL_DO_EDL"].begin()->second.contains(commands::Stage::executed));
    std::size_t executed = 0;
    for (const auto& [number, stages] : fates["NO_OP"]) {
        if (!stages.contains(commands::Stage::radiated) || stages.at(commands::Stage::radiated) != commands::Status::ok)
            continue;
        executed += stages.contains(commands::Stage::executed) ? 1 : 0;
        for (const auto& [stage, status] : stages) CHECK(status != commands::Status::unknown);
    }
    // A minute's, less those whose answers are under way.
    const double carried =
        60.0 * uhf_rate_bps / 8.0 * commands::ReleasePace::downlink_share / commands::ReleasePace::answer_octets;
    CHECK(static_cast<double>(executed) >= 0.8 * carried);
}

TEST_CASE("over three orbiters a packet keeps one identity, and the recording comes down in passes",
          "[rehearsal][relay][R29][R41]") {
    auto scenario = test::shipped_scenario("relay_passes");
    scenario.radio.delivery_restarts_after_touchdown_s = {200.0};
    Rehearsal rehearsal{scenario, 2, 0, tests::shipped_dictionary()};
    telemetry::PacketRegister packets;
    std::map<std::string, std::uint64_t> seen;
    std::uint64_t again = 0;
    while (!rehearsal.finished())
        for (const auto& packet : rehearsal.step().packets) {
            ++seen[packet.link.name];
            if (packet.link.recorded) continue;
            again += packets.add(packet.octets, telemetry::Path::realtime) == telemetry::Standing::again;
        }
    CHECK(rehearsal.outcome() == archive::Outcome::touchdown);
    CHECK(seen["uhf_live"] > 5000);
    CHECK(seen["uhf_mro"] > 1000);
    CHECK(seen["uhf_mex"] > 1000);
    CHECK(again > 0);
    CHECK(packets.counts().realtime > seen["uhf_live"]);  // what the bent pipe lost another orbiter had
    CHECK(packets.counts().realtime + again ==
          seen["uhf_live"] + seen["uhf_mro"] + seen["uhf_mex"] + seen["x_band_telemetry"]);
    CHECK(rehearsal.recording_progress() == 1.0);
    CHECK(rehearsal.station().recording().asked() > 0);
    const auto proof = rehearsal.proof();
    CHECK(proof.holds());
    CHECK(proof.realtime == packets.counts().realtime);
    std::uint64_t recorded = 0;
    for (telemetry::PacketStream recording{rehearsal.landing().recording()}; recording.next();) ++recorded;
    CHECK(seen["relay"] == recorded);
}

TEST_CASE("what comes live is decoded when it arrives, once, and what a recording brings only where it is needed",
          "[rehearsal]") {
    Rehearsal rehearsal{test::shipped_scenario("nominal_auto"), 1, 0, tests::shipped_dictionary()};
    std::uint64_t live = 0, recorded = 0, recorded_decoded = 0;
    bool all_live = true, as_they_are = true;
    const telemetry::PacketDecoder decoder{tests::shipped_dictionary()};
    telemetry::DecodedPacket again;
    while (!rehearsal.finished() && (live < 1000 || recorded < 1000))
        for (const auto& packet : rehearsal.step().packets) {
            ++(packet.link.recorded ? recorded : live);
            all_live = all_live && (packet.link.recorded || packet.decoded != nullptr);
            if (packet.decoded == nullptr) continue;
            recorded_decoded += packet.link.recorded ? 1 : 0;
            decoder.decode(packet.octets, again);
            as_they_are = as_they_are && packet.decoded->content.raw == again.content.raw &&
                          packet.decoded->text == again.text && packet.decoded->refusal == again.refusal;
        }
    CHECK(live >= 1000);
    CHECK(recorded >= 1000);
    CHECK(all_live);
    CHECK(as_they_are);
    CHECK(recorded_decoded < recorded);
}

TEST_CASE("when no pass is left to bring the recording down, nothing is said to be proven", "[rehearsal][relay][R41]") {
    auto scenario = test::shipped_scenario("relay_passes");
    scenario.radio.relay_passes.resize(1);  // the bent pipe of the landing alone
    scenario.radio.relay_passes[0].set_after_entry_s = 300.0;
    Rehearsal rehearsal{scenario, 1, 0, tests::shipped_dictionary()};
    while (!rehearsal.finished()) rehearsal.step();
    CHECK(rehearsal.outcome() == archive::Outcome::touchdown);
    CHECK(rehearsal.recording_progress() == 0.0);
    const auto proof = rehearsal.proof();
    CHECK_FALSE(proof.holds());
    CHECK(proof.recorded == 0);
    CHECK(proof.realtime_not_recorded == proof.realtime);
}

TEST_CASE("commands over an uplink that loses frames are sent again, and the landing is commanded",
          "[rehearsal][gateway][R44]") {
    auto scenario = test::shipped_scenario("nominal_auto");
    scenario.radio.uplink_loss_fraction = 0.05;
    unsigned again = 0, commanded = 0;
    for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U, 6U}) {
        Rehearsal rehearsal{scenario, seed, 0, tests::shipped_dictionary()};
        bool executed = false, reported = false;
        for (int i = 0; i < 64 * 180; ++i) {
            rehearsal.step();
            for (const auto& stage : rehearsal.take_stages()) {
                again += stage.stage == commands::Stage::radiated && stage.evidence.starts_with("transmission");
                executed |= stage.name == "EDL_DO_EDL" && stage.stage == commands::Stage::executed &&
                            stage.status == commands::Status::ok;
                reported |= stage.name == "EDL_DO_EDL" && stage.stage == commands::Stage::received &&
                            stage.status == commands::Status::unknown;
            }
        }
        CHECK((executed || reported || !rehearsal.script_refusals().empty()));  // never silence
        commanded += executed;
    }
    CHECK(again > 0);
    CHECK(commanded >= 4);
}

}  // namespace server_rehearsal_test
