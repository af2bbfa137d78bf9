// SPDX-License-Identifier: Apache-2.0
#include "aeolis/v1/prediction.pb.h"
#include "server/base/json.hpp"
#include "server/rehearsal/prediction_service.hpp"
#include "tests/server/running_server.hpp"
#include "tests/server/web_client.hpp"
#include "tests/support/slept_time.hpp"

#include <chrono>
#include <fmt/format.h>

namespace server_prediction_test {

using namespace aeolis;
using namespace aeolis::test;
using server::from_json;
using server::PredictionService;

namespace {

/// Asks until the nominal flight has been flown.
WebReply prediction_of(const RunningServer& server, int run, const std::string& query = {}) {
    const auto target = fmt::format("/api/v1/runs/{}/prediction{}", run, query);
    for (int i = 0; i < 3000; ++i) {
        auto reply = web_request(server.port(), "GET", target);
        if (reply.status != 404 && reply.body.find("\"state\":\"flying\"") == std::string::npos) return reply;
        std::this_thread::sleep_for(std::chrono::milliseconds{20});
    }
    return {};
}

PredictionService::Answer answer_of(PredictionService& service, const simulation::Scenario& scenario) {
    for (int i = 0; i < 3000; ++i) {
        auto answer = service.prediction(scenario);
        if (answer.flight || !answer.none.empty()) return answer;
        std::this_thread::sleep_for(std::chrono::milliseconds{20});
    }
    return {};
}

/// A scenario of which nothing is predicted, at once: they differ by `number`.
simulation::Scenario of_no_telemetry(int number) {
    auto scenario = shipped_scenario("gnc_alone");
    scenario.radio.light_time_s = number;
    return scenario;
}

}  // namespace

TEST_CASE("runs that differ in seed and faults have one prediction, to the octet, and it is flown once",
          "[prediction][http]") {
    RunningServer server;
    const auto start = [&](const std::string& name, const std::string& faults, int seed) {
        return web_request(
            server.port(), "POST", "/api/v1/rehearsals",
            fmt::format(R"({{"inline_scenario":{{"name":"{}","entry_scet":"2012-08-06T05:10:47.4",)"
                        R"("target":{{"ellipse_major_m":20000,"ellipse_minor_m":7000}},)"
                        R"("commands":[{{"send_before_entry_s":1190,"command":"EDL_SET_PARAMETERS",)"
                        R"("from_solution":true}},{{"send_before_entry_s":1170,"command":"EDL_DO_EDL"}}])"
                        R"({}}},"seed":{},"pace":1}})",
                        name, faults, seed));
    };
    const auto first = start("calm", "", 1);
    INFO(first.body);
    REQUIRE(first.status == 201);
    const auto asked_at_once = web_request(server.port(), "GET", "/api/v1/runs/1/prediction?channels=altitude_m");
    CHECK(asked_at_once.status == 200);
    CHECK_THAT(asked_at_once.body, Catch::Contains("\"state\":\"flying\"") && Catch::Contains("\"events\":[]"));
    const auto one = prediction_of(server, 1, "?channels=altitude_m,radar_altitude_m");
    REQUIRE(web_request(server.port(), "POST", "/api/v1/rehearsals/current", R"({"stop":true})").status == 202);
    WebReply second;
    for (int i = 0; i < 500 && second.status != 201; ++i) {
        second = start("surprise",
                       R"(,"computer_resets":[{"before_entry_s":300}],"station_outages":[{"begin_before_entry_s":200,)"
                       R"("duration_s":30}],"bus_message_error_fraction":0.001)",
                       99);
        if (second.status != 201) std::this_thread::sleep_for(std::chrono::milliseconds{20});
    }
    INFO(second.body);
    REQUIRE(second.status == 201);
    const auto other =
        web_request(server.port(), "GET", "/api/v1/runs/2/prediction?channels=altitude_m,radar_altitude_m");
    CHECK(other.body == one.body);  // at once: it is not flown again

    v1::Prediction prediction;
    REQUIRE(from_json(one.body, prediction));
    CHECK(prediction.state() == "ready");
    CHECK(prediction.reason().empty());
    CHECK(prediction.dictionary_id() == tests::shipped_dictionary().id);
    CHECK_THAT(prediction.basis(), Catch::Contains("the nominal flight of this scenario") &&
                                       Catch::Contains("not the mission's own prediction"));
    REQUIRE(prediction.channels_size() == 2);
    CHECK(prediction.channels(0).name() == "altitude_m");
    CHECK(prediction.channels(0).sclk_size() > 400);
    bool touchdown = false;
    for (const auto& event : prediction.events()) {
        touchdown = touchdown || event.name() == "touchdown";
        CHECK_THAT(event.scet(), Catch::StartsWith("2012-219T0"));
        CHECK(event.ert() == event.scet());  // the light time is 0
    }
    CHECK(touchdown);
    const auto blackout = std::ranges::find_if(
        prediction.windows(), [](const v1::PredictedWindow& window) { return window.words() == "plasma blackout"; });
    REQUIRE(blackout != prediction.windows().end());
    CHECK(blackout->link() == "uhf_live");
    CHECK(blackout->from_e_s() < blackout->to_e_s());
    CHECK(prediction.ellipse().major_m() == 20'000.0);
    CHECK(prediction.ellipse().azimuth_deg() == Approx(94.0).margin(2.0));  // [od137]: entry at 93.35°

    // A range cuts the series, and Protobuf says the same.
    {
        const auto part = prediction_of(
            server, 1, fmt::format("?channels=altitude_m&from={}&to={}&format=protobuf", 397501715.0, 397501725.0));
        CHECK(part.content_type == "application/x-protobuf");
        v1::Prediction cut;
        REQUIRE(cut.ParseFromString(part.body));
        CHECK(cut.channels(0).sclk_size() == 11);
        v1::ChannelSeriesList list;
        REQUIRE(list.ParseFromString(part.body));  // the reader of the archive's samples reads it too
        CHECK(list.channels(0).value_size() == 11);
    }
    // What cannot be asked is refused by name, and the largest answer has its limit.
    {
        const auto refused = [&](const char* query) {
            const auto reply = web_request(server.port(), "GET", fmt::format("/api/v1/runs/1/prediction{}", query));
            CHECK(reply.status == 400);
            return reply.body;
        };
        CHECK_THAT(refused("?channels=altitud_m"),
                   Catch::Contains("there is no channel 'altitud_m'; the nearest name is 'altitude_m'"));
        CHECK_THAT(refused("?from=2&to=1"), Catch::Contains("upside down"));
        CHECK_THAT(refused("?names=altitude_m"), Catch::Contains("names"));
        CHECK_THAT(refused("?format=csv"), Catch::Contains("none of json, protobuf"));
        CHECK(web_request(server.port(), "GET", "/api/v1/runs/9/prediction").status == 404);
        std::string names, more;
        for (std::size_t i = 0; i < 64; ++i) names += (i > 0 ? "," : "") + tests::shipped_dictionary().channels[i].name;
        CHECK(prediction_of(server, 1, "?channels=" + names).body.size() <= (8U << 20U));
        for (int i = 0; i < 65; ++i) more += "altitude_m,";
        CHECK_THAT(refused(("?channels=" + more).c_str()), Catch::Contains("65 of them, at most 64 at once"));
    }
}

TEST_CASE("the service keeps a few nominal flights, and of those flown forgets the one asked for longest ago",
          "[prediction]") {
    PredictionService service{tests::shipped_dictionary()};
    for (int i = 0; i < 4; ++i)
        CHECK_THAT(answer_of(service, of_no_telemetry(i)).none, Catch::Contains("no telemetry"));
    CHECK(service.flown() == 4);
    CHECK_FALSE(service.prediction(of_no_telemetry(0)).none.empty());  // known at once, and now the newest
    CHECK_FALSE(answer_of(service, of_no_telemetry(4)).none.empty());
    CHECK_FALSE(service.prediction(of_no_telemetry(0)).none.empty());
    CHECK(service.prediction(of_no_telemetry(1)).none.empty());  // forgotten: it is flown anew
    CHECK_FALSE(answer_of(service, of_no_telemetry(1)).none.empty());
    CHECK(service.flown() == 6);
}

TEST_CASE("a service that ends does not fly to the end", "[prediction]") {
    const tests::SleptTime time;
    {
        PredictionService service{tests::shipped_dictionary()};
        CHECK_FALSE(service.prediction(shipped_scenario("nominal_auto")).flight);
    }
    CHECK(time.passed() < std::chrono::seconds{1});
}

}  // namespace server_prediction_test
