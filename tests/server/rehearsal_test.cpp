#include "server/api/json.hpp"
#include "server/rehearsal/digest.hpp"
#include "server/rehearsal/landing_report.hpp"
#include "tests/server/running_server.hpp"

#include <google/protobuf/struct.pb.h>

using namespace aeolis;
using namespace aeolis::server;

TEST_CASE("the digest is SHA-256 of all octets, however they are cut", "[digest]") {
    Digest whole, pieces;
    const std::vector<std::uint8_t> abc{'a', 'b', 'c'};
    whole.add(abc);
    for (const auto octet : abc)
        pieces.add({&octet, 1});
    CHECK(whole.text() == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"); // [fips-180-4]
    CHECK(pieces.text() == whole.text());
    CHECK(Digest{}.text() == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

TEST_CASE("a landing's report is the object of the design, its real time proven by its recording", "[rehearsal][R41]") {
    Rehearsal rehearsal{test::shipped_scenario("nominal_auto"), 1, 0, tests::shipped_dictionary()};
    while (!rehearsal.finished())
        rehearsal.step();
    INFO(landing_table(rehearsal, 1.0));
    CHECK(rehearsal.script_refusals().empty());

    google::protobuf::Struct report;
    REQUIRE(from_json(landing_json(rehearsal, 1.0), report));
    const auto& fields = report.fields();
    for (const char* name : {"scenario", "seed", "outcome", "digest", "events", "peak_deceleration_mps2", "touchdown",
                             "heatshield_least_m", "backshell_least_m", "test_venue", "timepoints", "tones", "packets", "cycles",
                             "overruns", "wall_s", "real_time_factor"}) {
        INFO(name);
        CHECK(fields.contains(name));
    }
    CHECK(fields.size() == 17);
    CHECK(fields.at("backshell_least_m").number_value() > 10.0); // the sidestep
    CHECK(fields.at("outcome").string_value() == "touchdown");
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
    CHECK(fields.at("timepoints").list_value().values_size() >= 60);
}

TEST_CASE("the scenarios in which a computer fails end on the ground", "[.long][rehearsal][R32][R33]") {
    for (const char* name : {"pre_edl", "second_chance"}) {
        INFO(name);
        Rehearsal rehearsal{test::shipped_scenario(name), 1, 0, tests::shipped_dictionary()};
        while (!rehearsal.finished())
            rehearsal.step();
        CHECK(rehearsal.outcome() == "touchdown");
        CHECK(rehearsal.proof().holds());
        CHECK(rehearsal.landing().counters().resets == 1);
    }
}
