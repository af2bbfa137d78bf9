// SPDX-License-Identifier: Apache-2.0
#include "server/net/console_backend.hpp"

#include "server/archive/reader.hpp"
#include "tests/server/running_server.hpp"
#include "tests/server/web_client.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"
#include "tests/support/temporary_folder.hpp"

#include <algorithm>
#include <atomic>
#include <fstream>
#include <thread>

namespace server_console_backend_test {

using namespace aeolis;
using namespace aeolis::server;

TEST_CASE("a server that does not come up makes no account: the one that does tells the first password", "[access]") {
    test::TemporaryFolder folder;
    ConsoleBackend::Settings settings;
    settings.accounts = folder / "accounts.json";
    settings.archive = folder / "no_archive";
    settings.web = settings.scenarios = folder / "";
    std::ofstream{settings.archive} << "not an archive";
    CHECK_FALSE(ConsoleBackend::open(settings, tests::shipped_dictionary()));
    CHECK_FALSE(std::filesystem::exists(settings.accounts));
    settings.archive = folder / "a.db";
    const auto backend = ConsoleBackend::open(settings, tests::shipped_dictionary());
    REQUIRE(backend);
    CHECK_FALSE((*backend)->first_password().empty());
}

TEST_CASE("a jump of the system's clock during a rehearsal is in its shift log, at the run's own time",
          "[clock][http]") {
    std::atomic<std::int64_t> moved_us{0};
    test::RunningServer server{[&moved_us] {
        auto reading = read_clocks();
        reading.system_us += moved_us;
        return reading;
    }};
    moved_us = 5'000'000;  // no run goes on: there is no shift log to write it into
    std::string metrics;
    for (int i = 0; i < 300 && metrics.find("aeolis_clock_jumps_total 1\n") == std::string::npos; ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds{20});
        metrics = test::web_request(server.port(), "GET", "/metrics").body;
    }
    CHECK_THAT(metrics, Catch::Contains("aeolis_clock_jumps_total 1\n"));
    REQUIRE(
        test::web_request(server.port(), "POST", "/api/v1/rehearsals", R"({"scenario":"nominal","pace":1})").status ==
        201);
    std::this_thread::sleep_for(std::chrono::milliseconds{300});  // its clocks are told ten times a second
    moved_us = -3'600'000'000;
    std::string notes;
    for (int i = 0; i < 300 && notes.find("jumped") == std::string::npos; ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds{20});
        notes = test::web_request(server.port(), "GET", "/api/v1/runs/1/notes").body;
    }
    CHECK_THAT(notes, Catch::Contains("jumped 3605.000 s back") && Catch::Contains("\"by\":\"server\"") &&
                          Catch::Contains("\"at\":\"2012-"));
}

TEST_CASE("an audit that was cut off while no server ran is found at the start, in the log and the audit from then on",
          "[audit][access]") {
    test::RunningServer server{test::RunningServer::WithAccounts{}};
    const auto wrong = R"({"user":"administrator","password":"not it"})";
    const auto first = fmt::format(R"({{"user":"administrator","password":"{}"}})", server.first_password());
    CHECK(test::web_request(server.port(), "POST", "/api/v1/session", wrong).status == 401);
    CHECK(test::web_request(server.port(), "POST", "/api/v1/session", first).status == 201);
    server.end();
    const auto head_of = [&] {
        return archive::read_head(archive::head_file(server.archive(), server.accounts().parent_path())).value();
    };
    const auto kept = head_of();
    REQUIRE(kept);
    {
        auto database =
            archive::sqlite::Database::open(server.archive().string(), archive::sqlite::Mode::read_write_create);
        REQUIRE(database);
        REQUIRE(*archive::audit_head(*database) == *kept);
        REQUIRE(database->execute("DELETE FROM audit"));
    }
    server.restart();
    auto reader = archive::Reader::open(server.archive(), tests::shipped_dictionary());
    REQUIRE(reader);
    std::vector<archive::AuditEntry> entries;
    for (int i = 0; i < 300 && entries.empty(); ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds{20});
        entries = reader->audit(0, 10).value();
    }
    REQUIRE(entries.size() == 1);
    CHECK(entries[0].action == "audit");
    CHECK_THAT(entries[0].detail, Catch::Contains("was known to be there, and is gone: the audit is empty"));
    server.end();
    CHECK(head_of()->entry == 1);  // told once
    server.restart();
    server.end();
    CHECK(head_of()->entry == 1);
}

}  // namespace server_console_backend_test
