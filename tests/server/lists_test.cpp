// SPDX-License-Identifier: Apache-2.0
// The lists of the API over a socket, of a run with thousands of commands, and what memory they take.

#include "aeolis/v1/access.pb.h"
#include "aeolis/v1/layout.pb.h"
#include "aeolis/v1/plan.pb.h"
#include "aeolis/v1/run.pb.h"
#include "server/base/json.hpp"
#include "tests/server/run_writer.hpp"
#include "tests/server/running_server.hpp"
#include "tests/server/web_client.hpp"
#include "tests/support/catch.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <memory>
#include <string>

namespace server_lists_test {

using namespace aeolis;
using namespace aeolis::test;

namespace {

constexpr std::size_t body_octets_max = 8 << 20;

/// A finished run 1 of so many rounds of RunWriter.
std::unique_ptr<RunningServer> server_with(std::uint64_t rounds, const std::string& words) {
    auto server = std::make_unique<RunningServer>();
    server->end();
    {
        auto archive = archive::Archive::open(server->archive());
        REQUIRE(archive);
        const auto run = archive->begin_run({}, tests::shipped_dictionary());
        REQUIRE(run);
        RunWriter rows{*archive, *run, words};
        for (std::uint64_t written = 0; written < rounds; written += 512)
            rows.add(std::min<std::uint64_t>(512, rounds - written));
        rows.finish();
    }
    server->restart();
    return server;
}

/// The target of the next page; empty: this was the last.
std::string next_of(const WebReply& reply) {
    for (const auto& [name, value] : reply.fields)
        if (name == "Link") {
            CHECK_THAT(value, Catch::StartsWith("<") && Catch::EndsWith(">; rel=\"next\""));
            return value.substr(1, value.find('>') - 1);
        }
    return {};
}

/// Follows the links from `target` to the last page. @return the number of lines
std::size_t lines_of_all_pages(std::uint16_t port, std::string target) {
    std::size_t lines = 0;
    for (int pages = 0; !target.empty() && pages < 1'000; ++pages) {
        const auto reply = web_request(port, "GET", target);
        INFO(target);
        REQUIRE(reply.status == 200);
        CHECK(reply.body.size() <= body_octets_max);
        CHECK((reply.next_after == "0") == next_of(reply).empty());
        lines += static_cast<std::size_t>(std::ranges::count(reply.body, '\n'));
        target = next_of(reply);
    }
    return lines;
}

/// The largest resident set of this process since the last call, kB.
std::size_t largest_since_last_kb() {
    std::size_t largest = 0;
    std::ifstream status{"/proc/self/status"};
    for (std::string line; std::getline(status, line);)
        if (line.starts_with("VmHWM:")) largest = std::stoul(line.substr(6));
    std::ofstream{"/proc/self/clear_refs"} << "5";
    return largest;
}

/// Logs the administrator in, with a password of their own. @return the headers of its requests
Headers own_password(const RunningServer& server) {
    const auto log_in = [&](const std::string& password) {
        const auto reply = web_request(server.port(), "POST", "/api/v1/session",
                                       fmt::format(R"({{"user":"administrator","password":"{}"}})", password));
        REQUIRE(reply.status == 201);
        return Headers{{"Cookie", reply.set_cookie.substr(0, reply.set_cookie.find(';'))}};
    };
    const auto given = server.first_password();
    const auto headers = log_in(given);
    REQUIRE(web_request(server.port(), "PATCH", "/api/v1/users/administrator",
                        fmt::format(R"({{"password":"a password of my own","current_password":"{}"}})", given), headers)
                .status == 200);
    return headers;
}

const std::vector<std::string> lists{"events", "tones",    "explanations", "alarms",
                                     "notes",  "commands", "packets",      "interventions"};

}  // namespace

TEST_CASE("the instructors' plans come in pages as every list does, each once", "[http][R62]") {
    const RunningServer server;
    const auto ask = [&](const std::string& query) {
        return web_request(server.port(), "GET", "/api/v1/plans" + query);
    };
    v1::PlanList all;
    REQUIRE(server::from_json(ask("").body, all).ok());
    REQUIRE(all.plans_size() > 2);
    CHECK(all.next_after() == 0);
    for (const bool newest : {false, true}) {
        std::vector<std::string> names;
        for (std::uint64_t after = 0;;) {
            const auto reply = ask(fmt::format("?limit=2&after={}&order={}", after, newest ? "newest" : "oldest"));
            REQUIRE(reply.status == 200);
            CHECK((reply.next_after == "0") == next_of(reply).empty());
            v1::PlanList page;
            REQUIRE(server::from_json(reply.body, page).ok());
            CHECK(page.plans_size() <= 2);
            CHECK(page.library_size() == all.library_size());
            for (const auto& plan : page.plans()) names.push_back(plan.name());
            after = page.next_after();
            if (after == 0) break;
        }
        if (newest) std::ranges::reverse(names);
        REQUIRE(names.size() == static_cast<std::size_t>(all.plans_size()));
        for (int i = 0; i < all.plans_size(); ++i) CHECK(names[static_cast<std::size_t>(i)] == all.plans(i).name());
    }
    CHECK_THAT(ask("?format=csv").body, Catch::StartsWith("name,title,purpose,scenario,injects\n"));
    CHECK(ask("?order=sideways").status == 400);
}

TEST_CASE("every list of a run goes on by Link and Aeolis-Next-After, in each format and either order", "[http][R62]") {
    const auto server = server_with(40, "as planned");
    for (const auto& list : lists)
        for (const auto* order : {"oldest", "newest"}) {
            const auto target = fmt::format("/api/v1/runs/1/{}?limit=7&order={}", list, order);
            CHECK(lines_of_all_pages(server->port(), target + "&format=jsonl") == 40);
            CHECK(lines_of_all_pages(server->port(), target + "&format=csv") == 40 + 6);  // with a header a page
            const auto json = web_request(server->port(), "GET", target);
            CHECK_THAT(json.body, Catch::Contains(fmt::format("\"next_after\":\"{}\"", json.next_after)));
        }
    const auto link = next_of(web_request(server->port(), "GET",
                                          "/api/v1/runs/latest/events?after=3&text=as%20planned&limit=2&order=newest"));
    CHECK(link.empty());  // before 3 there is one
    CHECK(next_of(web_request(server->port(), "GET", "/api/v1/runs/latest/events?text=as%20planned&after=0&limit=2")) ==
          "/api/v1/runs/1/events?text=as%20planned&limit=2&after=16");  // another may begin between two pages
    CHECK(lines_of_all_pages(server->port(), "/api/v1/runs?format=jsonl&limit=1") == 1);
    CHECK(lines_of_all_pages(server->port(), "/api/v1/runs?format=jsonl&order=oldest") == 1);
}

TEST_CASE("lists of what people made go on by Link and Aeolis-Next-After too", "[http][R62]") {
    RunningServer server;
    const std::vector<std::string> names{"Approach", "Entry", "Landing"};
    for (const auto& name : names)
        REQUIRE(web_request(server.port(), "PUT", "/api/v1/layouts/" + name, "{}").status == 200);
    std::string forth, back;
    for (auto [order, all] : {std::pair{"oldest", &forth}, std::pair{"newest", &back}}) {
        std::string target = fmt::format("/api/v1/layouts?limit=1&order={}", order);
        for (int pages = 0; !target.empty() && pages < 5; ++pages) {
            const auto reply = web_request(server.port(), "GET", target);
            v1::LayoutList list;
            REQUIRE(server::from_json(reply.body, list));
            REQUIRE(list.layouts_size() == 1);
            *all += list.layouts(0).name()[0];
            target = next_of(reply);
        }
    }
    CHECK(forth == "AEL");
    CHECK(back == "LEA");
    const auto scenarios = [&](const std::string& query) {
        return lines_of_all_pages(server.port(), "/api/v1/scenarios?format=jsonl" + query);
    };
    CHECK(scenarios("") > 2);
    CHECK(scenarios("&limit=2&order=newest") == scenarios(""));
    CHECK(lines_of_all_pages(server.port(), "/api/v1/campaigns?format=csv") == 1);  // the header
    for (const auto* list : {"scenarios", "layouts", "campaigns"})
        for (const auto* query : {"order=up", "limit=0", "after=-1", "format=xml", "colour=red"}) {
            INFO(list << ' ' << query);
            CHECK(web_request(server.port(), "GET", fmt::format("/api/v1/{}?{}", list, query)).status == 400);
        }
}

TEST_CASE("users and tokens come in pages", "[http][access][R62]") {
    RunningServer server{RunningServer::WithAccounts{}};
    const auto administrator = own_password(server);
    for (const auto* user : {"ann", "bob", "eve"})
        REQUIRE(web_request(server.port(), "POST", "/api/v1/users",
                            fmt::format(R"({{"user":"{}","role":"observer","password":"given by another"}})", user),
                            administrator)
                    .status == 201);
    for (const auto* name : {"one", "two"})
        REQUIRE(web_request(server.port(), "POST", "/api/v1/tokens",
                            fmt::format(R"({{"name":"{}","role":"observer"}})", name), administrator)
                    .status == 201);
    const auto get = [&](const char* target) { return web_request(server.port(), "GET", target, {}, administrator); };
    const auto first = get("/api/v1/users?limit=2");
    v1::UserList users;
    REQUIRE(server::from_json(first.body, users));
    CHECK((users.users_size() == 2 && users.users(1).user() == "ann" && users.next_after() == 2));
    CHECK(next_of(first) == "/api/v1/users?limit=2&after=2");
    REQUIRE(server::from_json(get("/api/v1/users?limit=2&after=2").body, users));
    CHECK((users.users_size() == 2 && users.users(1).user() == "eve" && users.next_after() == 0));
    v1::TokenList tokens;
    REQUIRE(server::from_json(get("/api/v1/tokens?order=newest").body, tokens));
    CHECK((tokens.tokens_size() == 2 && tokens.tokens(0).name() == "two"));
    CHECK_THAT(get("/api/v1/tokens?format=csv").body, Catch::StartsWith("name,role,"));
}

TEST_CASE("the newest rows come first where that is asked", "[http][R62]") {
    const auto server = server_with(5, "as planned");
    const auto numbers = [&](const char* query) {
        v1::CommandList list;
        REQUIRE(server::from_json(
            web_request(server->port(), "GET", std::string{"/api/v1/runs/1/commands"} + query).body, list));
        std::vector<std::uint64_t> all;
        for (const auto& command : list.commands()) all.push_back(command.command());
        return all;
    };
    CHECK(numbers("") == std::vector<std::uint64_t>{1, 2, 3, 4, 5});
    CHECK(numbers("?order=newest") == std::vector<std::uint64_t>{5, 4, 3, 2, 1});
    CHECK(numbers("?order=newest&after=4&limit=2") == std::vector<std::uint64_t>{3, 2});
    CHECK(numbers("?after=4") == std::vector<std::uint64_t>{5});
    CHECK(numbers("?after=9223372036854775807").empty());
}

TEST_CASE("an order, a limit or a position that no list has is refused in one sentence", "[http]") {
    const auto server = server_with(1, "as planned");
    const auto error = [&](const std::string& target) {
        const auto reply = web_request(server->port(), "GET", target);
        v1::ErrorReply problem;
        CHECK(reply.status == 400);
        REQUIRE(server::from_json(reply.body, problem));
        return problem.detail();
    };
    for (const auto& list : lists) {
        const auto target = "/api/v1/runs/1/" + list;
        CHECK(error(target + "?order=latest") == "order: 'latest' is none of oldest, newest");
        CHECK(error(target + "?order=") == "order: '' is none of oldest, newest");
        CHECK(error(target + "?limit=0") == "limit: 0 asks for nothing");
        CHECK_THAT(error(target + "?limit=10001"), Catch::StartsWith("limit: 10001 is more than "));
        CHECK(error(target + "?after=-1") == "after: '-1' is not a whole number from 0");
        CHECK_THAT(error(target + "?after=9223372036854775808"), Catch::Contains("is more than 9223372036854775807"));
    }
    CHECK(error("/api/v1/runs?order=up") == "order: 'up' is none of oldest, newest");
}

// Its words are as long as evidence gets; the sanitizers weigh otherwise.
TEST_CASE("no list of a run with 4096 commands is longer than 8 MiB, and all of them take little memory",
          "[http][R62][release]") {
    const auto server = server_with(4'096, std::string(400, '"'));  // each is two octets of JSON
    const auto before_kb = (largest_since_last_kb(), largest_since_last_kb());
    std::size_t largest = 0;
    for (const auto& list : lists)
        for (const auto* query : {"", "?order=newest", "?format=csv", "?format=jsonl"}) {
            const auto most = list == "packets" || list == "commands" ? 1'000 : 10'000;
            const auto target =
                fmt::format("/api/v1/runs/1/{}{}{}limit={}", list, query, *query == 0 ? "?" : "&", most);
            const auto reply = web_request(server->port(), "GET", target);
            INFO(target);
            CHECK(reply.status == 200);
            CHECK(reply.body.size() <= body_octets_max);
            largest = std::max(largest, reply.body.size());
        }
    for (const auto* question : {"state", "report", "timepoints", "proof"}) {
        const auto reply = web_request(server->port(), "GET", fmt::format("/api/v1/runs/1/{}", question));
        INFO(question);
        CHECK(reply.status == 200);
        CHECK(reply.body.size() <= body_octets_max);
    }
    CHECK(lines_of_all_pages(server->port(), "/api/v1/runs/1/commands?format=jsonl") == 4'096);
    const auto grown_kb = largest_since_last_kb() - before_kb;
    INFO(fmt::format("{} octets, {} kB more", largest, grown_kb));
    CHECK(grown_kb < 250'000);  // with this client, and caches of seven readers; 900 MB when lists were built whole
}

}  // namespace server_lists_test
