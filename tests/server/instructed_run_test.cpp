// SPDX-License-Identifier: Apache-2.0
#include "aeolis/v1/stream.pb.h"
#include "server/archive/items.hpp"
#include "server/base/json.hpp"
#include "tests/server/instructed_run.hpp"
#include "tests/server/web_client.hpp"

#include <algorithm>
#include <map>
#include <regex>

namespace server_instructed_run_test {

using namespace aeolis;
using namespace aeolis::server;
using namespace aeolis::test;

namespace {

constexpr const char* plan_text = R"(plan: p
title: T
purpose: P
source: S
injects:
  - {inject: early, title: A, when: [{from: "E-14:00 vehicle"}], fault: {station_outage_s: 20}}
  - {inject: late, title: B, when: [{from: "E-9:00 vehicle"}], fault: {device: imu, unit: a, kind: dropout, duration_s: 2}}
  - {inject: by_hand, title: C, when: by hand, fault: {station_outage_s: 5}}
  - {inject: left_out, title: D, when: [{from: "E-8:00 vehicle"}], fault: {station_outage_s: 5}}
)";

InterveneRun order_to(const char* inject, bool skip) {
    InterveneRun order;
    order.intervention.set_inject(inject);
    if (skip) order.intervention.set_skipped(true);
    return order;
}

constexpr archive::RunId first{1};

}  // namespace

TEST_CASE("a plan's injects are done at their times, by hand or not at all, and each is kept with its id",
          "[rehearsal][instruction][R59]") {
    InstructedRuns flown;
    CHECK(flown
              .fly_new(plan_of_text(plan_text), -470.0,
                       [](RehearsalRunner& runner) {
                           CHECK(runner.order(order_to("by_hand", false)));
                           CHECK(runner.order(order_to("left_out", true)));
                           CHECK_THAT(runner.order(order_to("nothing", false)).error().message,
                                      Catch::Contains("no inject 'nothing'"));
                       })
              .empty());
    const auto told = flown.told(first);
    CHECK_THAT(told, Catch::StartsWith("early done -840.0\nlate done -540.0\nby_hand done -"));
    CHECK_THAT(told, Catch::Contains("left_out skipped -"));
    CHECK(flown.interventions(first) == 4);
}

TEST_CASE("a run with a plan that was cut off has each inject once, wherever it is continued, and a fork goes on by "
          "the same plan",
          "[rehearsal][instruction][R59]") {
    InstructedRuns flown;
    REQUIRE(flown.fly_new(plan_of_text(plan_text), -620.0, {}, 100.0).empty());
    CHECK(flown.told(first) == "early done -840.0\nlate waiting\nby_hand waiting\nleft_out waiting\n");
    v1::StartRehearsal request;
    request.set_continue_run(1);
    CHECK(flown.fly_again(request) == "");
    const std::string whole = "early done -840.0\nlate done -540.0\nby_hand waiting\nleft_out done -480.0\n";
    CHECK(flown.told(first) == whole);
    CHECK(flown.interventions(first) == 3);
    std::uint32_t newest = 1;
    for (const char* at : {"E-14:10", "E-9:30", "E-1:00"}) {
        request.Clear();
        request.mutable_fork()->set_run(1);
        request.mutable_fork()->set_at(at);
        INFO(at);
        CHECK(flown.fly_again(request) == "");
        const archive::RunId fork{++newest};
        CHECK(flown.told(fork) == whole);
        CHECK(flown.interventions(fork) == 3);
    }
}

namespace {

constexpr const char* hidden_plan = R"(plan: p
title: hidden_words
purpose: hidden_words
source: hidden_words
injects:
  - {inject: hidden_words, title: hidden_words, when: [{from: "E-9:00 vehicle"}], fault: {station_outage_s: 20}}
)";

/// A rehearsal on a server with accounts, as a controller gets it.
class Controlled {
  public:
    explicit Controlled(const std::string& plan) {
        const auto administrator = log_in("administrator", server_.first_password());
        for (const char* role : {"controller", "instructor"}) {
            const auto body = fmt::format(R"({{"user":"{}","role":"{}","password":"given by another"}})", role, role);
            REQUIRE(web_request(server_.port(), "POST", "/api/v1/users", body, administrator).status == 201);
            log_in(role, "given by another");
        }
        v1::StartRehearsal start;
        *start.mutable_inline_scenario() = scenario_to_message(short_landing());
        start.set_seed(7);
        start.set_pace(1.0);
        start.set_inline_plan(plan);
        const auto begun = ask("instructor", "POST", "/api/v1/rehearsals", to_json(start));
        INFO(begun.body);
        REQUIRE(begun.status == 201);
    }

    WebReply ask(const std::string& role, std::string_view method, std::string_view target,
                 std::string_view body = {}) const {
        return web_request(server_.port(), method, target, body, as_.at(role));
    }
    /// Everything that a controller can ask of the run and do to it, with status and answer. What tells the wall
    /// clock's time is left out.
    std::vector<std::string> everything() const {
        std::vector<std::string> all;
        const auto add = [&](std::string_view method, const std::string& target, std::string_view body = {}) {
            const auto reply = ask("controller", method, target, body);
            all.push_back(
                fmt::format("{} {} {}\n{} {}", method, target, body, reply.status, without_wall_clock(reply.body)));
        };
        for (const char* what : {"",
                                 "/channels?names=altitude_m",
                                 "/packets?limit=50",
                                 "/tones",
                                 "/items?limit=200",
                                 "/events",
                                 "/commands",
                                 "/alarms",
                                 "/alarms?state=current",
                                 "/notes",
                                 "/procedures",
                                 "/procedures/1/acts",
                                 "/positions",
                                 "/interventions",
                                 "/plan",
                                 "/timepoints",
                                 "/explanations",
                                 "/limits",
                                 "/touchdown",
                                 "/recording",
                                 "/staleness",
                                 "/proof",
                                 "/report",
                                 "/state?at=E-10:00",
                                 "/prediction",
                                 "/samples?names=altitude_m&to=E-10:00",
                                 "/forecasts",
                                 "/raw?link=uhf_live&format=bin",
                                 "/rows",
                                 "/score",
                                 "/differences?with=1",
                                 "/preconditions?command=NO_OP"})
            add("GET", std::string{"/api/v1/runs/1"} + what);
        for (const char* path :
             {"/api/v1/rehearsals", "/api/v1/rehearsals/current", "/api/v1/runs", "/api/v1/plans", "/api/v1/scenarios",
              "/api/v1/layouts", "/api/v1/procedures", "/api/v1/procedures/start"})
            add("GET", path);
        for (const char* body : {R"({"plan":{"inject":"hidden_words"}})", R"({"inject":{"computer_reset":true}})",
                                 R"({"note":{"text":"x"}})"})
            add("POST", "/api/v1/rehearsals/current", body);
        add("POST", "/api/v1/rehearsals", R"({"scenario":"nominal","plan":"left_alone"})");
        return all;
    }
    /// Each item's octets.
    std::vector<std::string> items() const {
        std::vector<std::string> all;
        for (std::uint64_t after = 0;;) {
            const auto reply =
                ask("controller", "GET", fmt::format("/api/v1/runs/1/items?format=protobuf&after={}", after));
            REQUIRE(reply.status == 200);
            v1::Batch batch;
            REQUIRE(batch.ParseFromString(reply.body));
            for (const auto& item : batch.items()) all.push_back(item.SerializeAsString());
            if (batch.complete_through() == after) return all;
            after = batch.complete_through();
        }
    }
    void wait_for_the_end() const {
        for (int i = 0; i < 6'000; ++i, std::this_thread::sleep_for(std::chrono::milliseconds{10}))
            if (ask("controller", "GET", "/api/v1/runs/1").body.find("\"finished\"") != std::string::npos) return;
        FAIL("the run does not end");
    }
    void order(const char* body) const {
        const auto reply = ask("instructor", "POST", "/api/v1/rehearsals/current", body);
        INFO(reply.body);
        REQUIRE(reply.status == 202);
    }

  private:
    Headers log_in(const std::string& user, const std::string& given) {
        constexpr const char* chosen = "a password of my own";
        const auto reply = web_request(server_.port(), "POST", "/api/v1/session",
                                       fmt::format(R"({{"user":"{}","password":"{}"}})", user, given));
        REQUIRE(reply.status == 201);
        const Headers headers{{"Cookie", reply.set_cookie.substr(0, reply.set_cookie.find(';'))}};
        REQUIRE(web_request(server_.port(), "PATCH", "/api/v1/users/" + user,
                            fmt::format(R"({{"password":"{}","current_password":"{}"}})", chosen, given), headers)
                    .status == 200);
        as_[user] = headers;
        return headers;
    }
    static std::string without_wall_clock(const std::string& body) {
        static const std::regex times{R"re("(started|attained_pace|pace|clocks)":("[^"]*"|\{[^}]*\}|[-0-9.e+]+))re"};
        return std::regex_replace(body, times, "");
    }

    RunningServer server_{RunningServer::WithAccounts{}};
    std::map<std::string, Headers> as_;
};

}  // namespace

TEST_CASE("a controller gets the same octets with a plan and without one, until an inject shows itself",
          "[rehearsal][instruction][access][R59]") {
    Controlled planned{hidden_plan};
    Controlled plain{""};
    const auto waits = [](const Controlled& run) {  // what is asked of a run that goes on, of both at one instant
        run.order(R"({"pause":true})");
        return run.ask("controller", "GET", "/api/v1/runs/1/plan");
    };
    const auto refused = waits(planned), refused_too = waits(plain);
    CHECK(refused.status == 403);
    CHECK(refused.body == refused_too.body);
    for (const auto& told : planned.everything()) {
        INFO(told.substr(0, 400));
        const auto asked = told.find("\n");  // what a controller asks for may say it
        CHECK(told.find("hidden_words", asked) == std::string::npos);
    }
    for (const auto* run : {&planned, &plain}) {
        run->order(R"({"pace":0})");
        run->order(R"({"pause":false})");
        run->wait_for_the_end();
    }
    const auto with = planned.items(), without = plain.items();
    const auto [differs, other] = std::ranges::mismatch(with, without);
    REQUIRE(differs != with.end());
    REQUIRE(other != without.end());
    v1::Item first_other, instead;
    REQUIRE(first_other.ParseFromString(*differs));
    REQUIRE(instead.ParseFromString(*other));
    v1::RunState run;
    REQUIRE(from_json(planned.ask("controller", "GET", "/api/v1/runs/1").body, run));
    const double e_s = archive::sclk_at_ert(run, Ert{first_other.ert_us()}).seconds - run.entry_sclk();
    INFO(to_json(first_other) << "\n" << to_json(instead));
    CHECK(e_s >= -540.0);
    CHECK(e_s < -530.0);
    CHECK_THAT(planned.ask("controller", "GET", "/api/v1/runs/1/plan").body, Catch::Contains("hidden_words"));
}

TEST_CASE("of a plan that does nothing a controller gets nothing at all, over every route",
          "[instruction][access][R59]") {
    const std::string never =
        std::regex_replace(std::string{hidden_plan}, std::regex{R"(\[\{from[^\]]*\])"}, "by hand");
    Controlled planned{never};
    Controlled plain{""};
    for (const auto* run : {&planned, &plain}) {
        run->order(R"({"pace":0})");
        run->wait_for_the_end();
    }
    CHECK(planned.items() == plain.items());
    const auto with = planned.everything(), without = plain.everything();
    REQUIRE(with.size() == without.size());
    for (std::size_t i = 0; i < with.size(); ++i) {
        INFO(with[i].substr(0, 600) << "\n" << without[i].substr(0, 600));
        const bool of_the_plan = with[i].starts_with("GET /api/v1/runs/1/plan ");  // everybody may read it then
        CHECK((with[i] == without[i]) == !of_the_plan);
    }
}

TEST_CASE("a fork of a hidden run, which a director may make, tells nobody of the plan while either goes on",
          "[instruction][access][R59]") {
    Controlled run{hidden_plan};
    const auto status = [&](const char* what) { return run.ask("controller", "GET", what).status; };
    run.order(R"({"pace":0})");
    run.wait_for_the_end();
    CHECK(status("/api/v1/runs/1/plan") == 200);
    REQUIRE(run.ask("instructor", "POST", "/api/v1/rehearsals",
                    R"({"fork":{"run":1,"at":"E-10:00","paused":true},"pace":1})")
                .status == 201);
    for (const char* what :
         {"/api/v1/runs/1/plan", "/api/v1/runs/1/interventions", "/api/v1/runs/1/score", "/api/v1/runs/2/plan"})
        CHECK(status(what) == 403);
    const auto audit = run.ask("administrator", "GET", "/api/v1/audit").body;
    CHECK_THAT(audit, Catch::Contains("GET /api/v1/runs/2/plan"));
    CHECK_THAT(run.ask("controller", "GET", "/metrics").body,
               !Catch::Contains("/api/v1/rehearsals/current") && !Catch::Contains("/api/v1/plans"));
    run.order(R"({"stop":true})");
    for (int i = 0; i < 500 && status("/api/v1/runs/2/plan") != 200; ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds{20});
    for (const char* what :
         {"/api/v1/runs/1/plan", "/api/v1/runs/1/interventions", "/api/v1/runs/1/score", "/api/v1/runs/2/plan"})
        CHECK(status(what) == 200);
}

}  // namespace server_instructed_run_test
