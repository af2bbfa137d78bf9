// SPDX-License-Identifier: Apache-2.0
// DELETE /api/v1/runs/N of a server while a rehearsal goes on.
#include "server/archive/sqlite.hpp"
#include "server/pipeline/derivation.hpp"
#include "tests/server/running_server.hpp"
#include "tests/server/web_client.hpp"
#include "tests/support/catch.hpp"

#include <thread>

namespace server_prune_while_running_test {

using namespace aeolis;
using namespace aeolis::test;

namespace {

std::int64_t ask(const std::filesystem::path& file, const char* sql) {
    auto database = archive::sqlite::Database::open(file.string(), archive::sqlite::Mode::read_only);
    REQUIRE(database);
    auto answer = database->integer_of(sql);
    REQUIRE(answer);
    return *answer;
}

/// Waits until the statement selects a number other than 0.
bool comes(const std::filesystem::path& file, const char* sql) {
    for (int i = 0; i < 2000; ++i) {
        if (ask(file, sql) != 0) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds{20});
    }
    return false;
}

}  // namespace

TEST_CASE("a run is removed, and its space returned, while another is recorded, which lacks nothing",
          "[prune][http][archive]") {
    RunningServer server;
    const auto start = [&](const char* body) {
        unsigned status = 409;  // while the one before still goes on
        for (int i = 0; i < 500 && status == 409; ++i) {
            status = web_request(server.port(), "POST", "/api/v1/rehearsals", body).status;
            if (status == 409) std::this_thread::sleep_for(std::chrono::milliseconds{20});
        }
        return status;
    };
    REQUIRE(start(R"({"scenario":"nominal_auto","pace":0})") == 201);
    const auto remove = [&](const char* path) { return web_request(server.port(), "DELETE", path); };
    CHECK(remove("/api/v1/runs/1").status == 409);  // it goes on
    REQUIRE(comes(server.archive(), "SELECT count(*) > 20000 FROM packets"));
    REQUIRE(web_request(server.port(), "POST", "/api/v1/rehearsals/current", R"({"stop":true})").status == 202);
    REQUIRE(comes(server.archive(), "SELECT count(*) FROM runs WHERE run = 1 AND state = 'finished'"));
    CHECK_THAT(remove("/api/v1/runs/1").body, Catch::Contains("the consoles show it"));
    REQUIRE(start(R"({"scenario":"nominal_auto","pace":50})") == 201);
    REQUIRE(comes(server.archive(), "SELECT count(*) FROM runs WHERE run = 2"));
    CHECK(remove("/api/v1/runs/latest").status == 409);
    CHECK(remove("/api/v1/runs/7").status == 404);
    REQUIRE(remove("/api/v1/runs/1").status == 204);
    CHECK(web_request(server.port(), "GET", "/api/v1/runs/1").status == 404);
    REQUIRE(comes(server.archive(),
                  "SELECT NOT EXISTS (SELECT 1 FROM packets WHERE run = 1) AND NOT EXISTS (SELECT 1 "
                  "FROM segments WHERE run = 1) AND NOT EXISTS (SELECT 1 FROM pyramid WHERE run = 1)"));
    CHECK(ask(server.archive(), "SELECT count(*) FROM runs WHERE run = 2 AND state = 'running'") == 1);
    CHECK(ask(server.archive(), "SELECT count(*) FROM audit WHERE action = 'prune' AND detail = 'runs 1'") == 1);
    REQUIRE(web_request(server.port(), "POST", "/api/v1/rehearsals/current", R"({"stop":true})").status == 202);
    REQUIRE(comes(server.archive(), "SELECT count(*) FROM runs WHERE run = 2 AND state = 'finished'"));
    server.end();
    const auto found = pipeline::verify(server.archive(), {}, tests::shipped_dictionary(), nullptr,
                                        std::filesystem::temp_directory_path());
    REQUIRE(found.ok());
    CHECK(found->faults == std::vector<std::string>{});
}

}  // namespace server_prune_while_running_test
