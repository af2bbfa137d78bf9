// SPDX-License-Identifier: Apache-2.0
#include "server/archive/sqlite.hpp"
#include "server/base/json.hpp"
#include "tests/server/running_server.hpp"
#include "tests/server/web_client.hpp"
#include "tests/support/catch.hpp"

#include "aeolis/v1/run.pb.h"
#include "aeolis/v1/what_if.pb.h"

#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <google/protobuf/util/message_differencer.h>
#include <thread>

namespace server_what_if_routes_test {

using namespace aeolis;
using namespace aeolis::server;
using test::RunningServer;
using test::web_request;

namespace {

/// A server with a landing that was flown to its end as run 1.
class Landed {
  public:
    Landed() : server_(test::short_landing(), 0.0) {
        spdlog::set_level(spdlog::level::off);
        until([&] { return current().state() == v1::RunState::finished; });
    }

    std::uint16_t port() const { return server_.port(); }
    RunningServer& server() { return server_; }
    v1::RunState current() const {
        v1::RunState state;
        const auto answer = web_request(port(), "GET", "/api/v1/rehearsals/current");
        if (answer.status == 200) REQUIRE(from_json(answer.body, state));  // else it has not begun
        return state;
    }
    auto post(const std::string& path, const std::string& body) const {
        return web_request(port(), "POST", "/api/v1" + path, body);
    }
    void execute(const char* sql) {
        auto database =
            archive::sqlite::Database::open(server_.archive().string(), archive::sqlite::Mode::read_write_create);
        REQUIRE(database);
        const auto done = database->execute(sql);
        INFO((done ? "" : done.error().message));
        REQUIRE(done);
    }
    v1::Forecast forecast(std::uint64_t number, int run = 1) const {
        v1::Forecast told;
        const auto path = fmt::format("/api/v1/runs/{}/forecasts/{}", run, number);
        REQUIRE(from_json(web_request(port(), "GET", path).body, told));
        return told;
    }
    v1::Forecast ended(std::uint64_t number) const {
        until([&] {
            const auto state = forecast(number).state();
            return state != v1::Forecast::queued && state != v1::Forecast::flying;
        });
        return forecast(number);
    }
    static void until(const std::function<bool()>& done) {
        while (!done()) std::this_thread::sleep_for(std::chrono::milliseconds{20});
    }

  private:
    RunningServer server_;
};

double part(const v1::Forecast& forecast, const char* side, const char* figure) {
    return forecast.result()
        .fields()
        .at(side)
        .struct_value()
        .fields()
        .at("within_limits")
        .struct_value()
        .fields()
        .at(figure)
        .number_value();
}

}  // namespace

TEST_CASE("a forecast of a recorded run is flown beside everything else, kept with what was asked, and read back after "
          "a restart",
          "[forecast][http][R58][idle]") {
    Landed landed;
    const auto asked = landed.post("/runs/1/forecasts", R"({"at":"E+6:00","cases":2,"faults":[{"device_fault":{"device":
        "DEVICE_RADAR","unit":"REDUNDANT_UNIT_A","kind":"DEVICE_FAULT_KIND_SILENT","duration_s":500}}]})");
    INFO(asked.body);
    REQUIRE(asked.status == 201);
    const auto ready = landed.ended(1);
    CHECK(ready.reason().empty());
    REQUIRE(ready.state() == v1::Forecast::ready);
    CHECK(ready.at_e_s() == 360.0);
    CHECK(ready.request().faults_size() == 1);
    CHECK(ready.result().fields().at("from").string_value() == "truth");
    CHECK(part(ready, "without", "part") == 2.0);
    CHECK(part(ready, "with", "of") == 2.0);

    landed.server().restart();
    CHECK(google::protobuf::util::MessageDifferencer::Equals(landed.forecast(1), ready));
    v1::ForecastList list;
    REQUIRE(from_json(web_request(landed.port(), "GET", "/api/v1/runs/1/forecasts").body, list));
    REQUIRE(list.forecasts_size() == 1);
    CHECK(list.forecasts(0).state() == v1::Forecast::ready);
    CHECK_FALSE(list.forecasts(0).has_result());
}

TEST_CASE("a forecast by telemetry says what ground had last heard, and is flown from there",
          "[forecast][http][R58][idle]") {
    Landed landed;
    REQUIRE(landed.post("/runs/1/forecasts", R"({"at":"E+5:30","cases":2,"from":"telemetry"})").status == 201);
    const auto ready = landed.ended(2);
    INFO(ready.reason());
    REQUIRE(ready.state() == v1::Forecast::ready);
    CHECK(ready.result().fields().at("from").string_value() == "telemetry");
    CHECK(std::abs(ready.result().fields().at("heard_e_s").number_value() - 330.0) < 3.0);
    CHECK(part(ready, "without", "of") == 2.0);
}

TEST_CASE("a forecast that is cancelled, or abandoned by the end of the server, says so",
          "[forecast][http][R58][idle]") {
    Landed landed;
    for (int i = 0; i < 3; ++i)
        REQUIRE(landed.post("/runs/1/forecasts", R"({"at":"E-10:00","cases":500})").status == 201);
    CHECK(landed.post("/runs/1/forecasts/3/cancel", "{}").status == 202);  // it waits
    CHECK(landed.ended(3).state() == v1::Forecast::cancelled);
    CHECK(landed.post("/runs/1/forecasts/1/cancel", "{}").status == 202);  // it flies
    CHECK(landed.ended(1).state() == v1::Forecast::cancelled);
    CHECK(landed.post("/runs/1/forecasts/1/cancel", "{}").status == 409);
    landed.server().restart();
    CHECK(landed.forecast(5).state() == v1::Forecast::abandoned);
}

TEST_CASE("a forecast that cannot be is refused in words, or kept with the reason why it failed",
          "[forecast][http][R58][idle]") {
    Landed landed;
    const auto refusal = [&](const std::string& body) {
        const auto answer = landed.post("/runs/1/forecasts", body);
        CHECK(answer.status == 422);
        return answer.body;
    };
    CHECK_THAT(refusal("{}"), Catch::Contains("at: an instant of the run is wanted"));
    CHECK_THAT(refusal(R"({"at":"E+1:00","cases":1001})"), Catch::Contains("cases: 1001 is more than 1000"));
    CHECK_THAT(refusal(R"({"at":"E+1:00","faults":[{}]})"), Catch::Contains("faults[0]: "));
    CHECK_THAT(refusal(R"({"at":"E-9:00:00"})"), Catch::Contains("is before run 1 begins"));
    CHECK(landed.post("/runs/7/forecasts", R"({"at":"E+1:00"})").status == 404);
    CHECK(web_request(landed.port(), "GET", "/api/v1/runs/1/forecasts/9").status == 404);

    CHECK_THAT(refusal(R"({"at":"E+2:00:00"})"), Catch::Contains("at: E+7200.0 s is after the record of run 1 ends"));
    REQUIRE(
        landed.post("/runs/1/forecasts", R"({"at":"E-8:20","cases":1,"commands":[{"command":"DO_NOTHING"}]})").status ==
        201);
    const auto unknown = landed.ended(1);
    CHECK(unknown.state() == v1::Forecast::failed);
    CHECK_THAT(unknown.reason(), Catch::StartsWith("DO_NOTHING is refused: "));
}

TEST_CASE("a forecast of a run that does not come out the same is none: it names the packet that differs",
          "[forecast][http][R58][idle]") {
    Landed landed;
    landed.execute("UPDATE packets SET octets = zeroblob(length(octets)) WHERE key ="
                   " (SELECT key FROM packets WHERE link = 1 ORDER BY key LIMIT 1 OFFSET 100)");
    REQUIRE(landed.post("/runs/1/forecasts", R"({"at":"E+6:00","cases":1})").status == 201);
    const auto other = landed.ended(1);
    CHECK(other.state() == v1::Forecast::failed);
    CHECK_THAT(other.reason(), Catch::StartsWith("run 1: flown again, packet "));
}

TEST_CASE("a forecast of now knows what was done while the run waits there", "[forecast][fork][http][R58][idle]") {
    Landed landed;
    REQUIRE(landed.post("/rehearsals", R"({"fork":{"run":1,"at":"E+1:30","paused":true},"pace":0})").status == 201);
    REQUIRE(landed.post("/rehearsals/current", R"({"inject":{"computer_reset":true}})").status == 202);
    Landed::until([&] {  // 202 says that it was asked for
        const auto done = web_request(landed.port(), "GET", "/api/v1/runs/2/interventions");
        return done.body.find("computer_reset") != std::string::npos;
    });
    REQUIRE(landed.post("/runs/2/forecasts", R"({"cases":1})").status == 201);
    CHECK(landed.post("/runs/2/forecasts", R"({"at":"E+1:31"})").status == 422);  // yet to come
    Landed::until([&] { return landed.forecast(1, 2).state() == v1::Forecast::ready; });
    const auto lost = landed.forecast(1, 2);
    CHECK(lost.at_e_s() == 90.0);
    CHECK(part(lost, "without", "part") == 0.0);  // nobody takes over from the computer that was reset
}

TEST_CASE("a fork is begun over HTTP, waits at its instant, and is laid over its parent", "[fork][http][R60]") {
    Landed landed;
    CHECK(landed.post("/rehearsals", R"({"fork":{"run":1,"at":"E+90"},"seed":4})").status == 422);
    const auto forked = landed.post("/rehearsals", R"({"fork":{"run":1,"at":"E+1:30","paused":true},"pace":0})");
    INFO(forked.body);
    REQUIRE(forked.status == 201);
    v1::RunState state;
    REQUIRE(from_json(forked.body, state));
    CHECK(state.run() == 2);
    CHECK(state.state() == v1::RunState::paused);
    CHECK(state.forked_from().run() == 1);
    CHECK(state.clocks().e_s() == 90.0);
    CHECK(state.last_seq() > 1'000);
    CHECK(landed.post("/rehearsals/current", R"({"inject":{"computer_reset":true}})").status == 202);
    CHECK(landed.post("/rehearsals/current", R"({"pause":false})").status == 202);
    Landed::until([&] { return landed.current().state() == v1::RunState::finished; });
    v1::RunDifferences found;
    REQUIRE(from_json(web_request(landed.port(), "GET", "/api/v1/runs/2/differences?with=1").body, found));
    CHECK(found.part_e_s() == 90.0);
    CHECK(found.events_size() > 0);
    CHECK(found.run().forked_from().e_s() == 90.0);
    CHECK(web_request(landed.port(), "GET", "/api/v1/runs/2/differences").status == 400);
    CHECK(web_request(landed.port(), "GET", "/api/v1/runs/2/differences?with=9").status == 400);
}

}  // namespace server_what_if_routes_test
