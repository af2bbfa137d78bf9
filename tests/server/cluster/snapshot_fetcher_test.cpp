// SPDX-License-Identifier: Apache-2.0
#include "server/archive/archive_comparison.hpp"
#include "server/cluster/run_messages.hpp"
#include "server/cluster/snapshot_fetcher.hpp"
#include "tests/server/cluster/followed.hpp"
#include "tests/server/cluster/snapshot_server.hpp"
#include "tests/support/catch.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <memory>
#include <thread>

// Late followers, of which the engine no longer has the beginning of a run.
namespace server_cluster_snapshot_fetcher_test {

using namespace aeolis;
using namespace aeolis::tests;
using cluster::SnapshotFetcher;

namespace {

/// What comes of a request, to its end.
struct Came {
    std::size_t messages = 0;
    std::optional<SnapshotFetcher::Listed> listed{};
    SnapshotFetcher::Ended ended{};
};
Came came_of(SnapshotFetcher& fetcher) {
    Came came;
    bool over = false;
    REQUIRE(comes([&] {
        while (auto news = fetcher.next()) {
            if (std::holds_alternative<v1::RunRows>(*news)) ++came.messages;
            if (auto* runs = std::get_if<SnapshotFetcher::Listed>(&*news)) came.listed = std::move(*runs);
            if (auto* ended = std::get_if<SnapshotFetcher::Ended>(&*news)) came.ended = std::move(*ended);
            over = over || !std::holds_alternative<v1::RunRows>(*news);
        }
        return over;
    }));
    return came;
}

/// An origin whose engine has nothing of what was recorded, and the server's other part.
struct LateScene {
    test::TemporaryFolder folder;
    NatsServer engine;
    Origin origin{folder / "origin.db", engine.url()};
    SnapshotServer server{origin.file()};

    void published() {
        REQUIRE(comes([&] {
            const auto now = origin.publisher->status();
            return now.steps > 0 && now.waiting_items == 0 && all_of_runs_is_published();
        }));
    }
    /// Steps without items follow the last item.
    bool all_of_runs_is_published() {
        const auto steps = origin.publisher->status().steps;
        std::this_thread::sleep_for(100ms);
        return origin.publisher->status().steps == steps;
    }
    void forget(const std::string& subject) {
        auto client = connected(engine);
        REQUIRE(client.clear(cluster::run_stream, subject));
    }
    void forget_all() { forget(cluster::subject_of_runs(origin.identity())); }
    std::unique_ptr<Copy> late(const char* name) {
        return std::make_unique<Copy>(folder / name, engine.url(), "", followed_dictionary.id, cluster::ChosenRuns{},
                                      server.source());
    }
    /// What a server gives of a run, beginning with nothing.
    std::size_t octets_of(RunId run) const {
        auto snapshot = cluster::RunSnapshot::begin(origin.file(), run, {});
        REQUIRE(snapshot);
        std::size_t octets = 0;
        for (auto message = snapshot->next(); message && *message; message = snapshot->next())
            octets += (*message)->size();
        return octets;
    }
    void is_equal(Copy& copy) {
        std::vector<std::string> differences;
        CHECK(comes([&] {
            const auto compared = archive::compare(origin.file(), copy.file());
            if (compared) differences = compared->differences;
            return compared && differences.empty();
        }));
        INFO(fmt::format("{}\n{}", cluster::text_of(copy.follower->status()), fmt::join(differences, "\n")));
        CHECK(differences.empty());
        CHECK(comes([&] { return same(origin.file(), copy.file()); }));
        CHECK_FALSE(copy.gaps());
        CHECK(test::faults_of(copy.file()).empty());
        CHECK(comes([&] {
            const auto now = copy.follower->status();
            return now.behind_items == 0 && now.fetching.empty() && now.fetch_fault.empty();
        }));
        CHECK(copy.follower->status().left_out.empty());
        CHECK(copy.follower->status().refused == 0);
    }
};

/// A run that is under way, in packets.
struct UnderWay {
    pipeline::Pipeline pipeline;
    std::uint16_t count = 0;
    explicit UnderWay(Archive& archive) : pipeline(archive, followed_dictionary) { REQUIRE(pipeline.begin({})); }
    void go_on(int packets) {
        for (int packet = 0; packet < packets; ++packet) REQUIRE(pipeline.accept(test::navigation(count++)));
        REQUIRE(comes([&] { return pipeline.commit().ok(); }));
    }
    void land() {
        REQUIRE(comes([&] { return pipeline.finish({archive::Outcome::touchdown, "", "", ""}).ok(); }));
    }
};

}  // namespace

TEST_CASE("a fetcher gives what a server answers, to its end or with the reason", "[cluster][R61]") {
    test::TemporaryFolder folder;
    const auto file = folder / "origin.db";
    auto archive = Archive::open(file);
    REQUIRE(archive);
    REQUIRE(SharedArchive::open(file)->identity());
    test::record_run(*archive, followed_dictionary, 9'000);
    SnapshotServer server{file};
    SnapshotFetcher fetcher{server.source()};
    CHECK_FALSE(fetcher.next().has_value());
    fetcher.list();
    const auto listed = came_of(fetcher);
    REQUIRE(listed.listed.has_value());
    REQUIRE(listed.listed->size() == 1);
    CHECK(listed.listed->front().run == RunId{1});
    CHECK(listed.listed->front().last > 9'000);

    fetcher.fetch(RunId{1}, {});
    const auto whole = came_of(fetcher);
    CHECK(whole.ended.fault.empty());
    CHECK(whole.messages > 1);
    server.octets_max = server.octets / 2;
    fetcher.fetch(RunId{1}, {});
    const auto half = came_of(fetcher);
    CHECK(half.ended.fault == "its answer was cut off");
    CHECK((half.messages > 0 && half.messages < whole.messages));
    server.octets_max = SIZE_MAX;
    fetcher.fetch(RunId{9}, {});
    const auto none = came_of(fetcher);
    CHECK(none.ended.fault == "it answers 404: run 9: there is none");
    CHECK(none.ended.gone);
    server.refuses = 401;
    fetcher.list();
    CHECK(came_of(fetcher).ended.fault == "it answers 401: log in first");

    server.refuses = 0;
    server.waits = true;
    fetcher.fetch(RunId{1}, {});
    REQUIRE(comes([&] { return server.paths().size() == 6; }));
    fetcher.break_off();
    CHECK_FALSE(came_of(fetcher).ended.fault.empty());
    fetcher.fetch(RunId{1}, {});  // and its end, while that waits, is not held up
}

TEST_CASE("links that fill a request's head are left out of it", "[cluster][R61]") {
    std::string asked;
    SnapshotFetcher fetcher{{"http://origin", [&](const std::string& path, const auto&, const auto&) {
                                 asked = path;
                                 return Result<cluster::SnapshotSource::Answer>{{.status = 200}};
                             }}};
    v1::RunPosition held;
    held.set_seq(77);
    (*held.mutable_raw())["uhf live"] = 12;
    fetcher.fetch(RunId{3}, held);
    CHECK(came_of(fetcher).ended.fault.empty());
    CHECK_THAT(asked, Catch::StartsWith("/api/v1/runs/3/rows?held=%7B") && Catch::Contains("uhf%20live"));
    for (int link = 0; link < 400; ++link) (*held.mutable_raw())["link " + std::to_string(link)] = 1'000'000;
    fetcher.fetch(RunId{3}, held);
    CHECK(came_of(fetcher).ended.fault.empty());
    CHECK_THAT(asked, Catch::Contains("77") && !Catch::Contains("link"));
}

TEST_CASE("a late follower fetches what the engine no longer has, and follows on without a seam", "[cluster][R61]") {
    if (!NatsServer::present()) return;
    const bool cut = GENERATE(false, true);
    LateScene scene;
    test::record_run(scene.origin.archive, followed_dictionary, 12'000);  // run 1, of which the engine has nothing
    UnderWay second{scene.origin.archive};                                // run 2, of which it has the end
    second.go_on(6'000);
    scene.published();
    scene.forget_all();
    second.go_on(500);
    if (cut) {
        scene.server.part_octets = 1'000;
        scene.server.octets_max = scene.octets_of(RunId{1}) / 2;  // more than a step
    }
    auto late = scene.late("late.db");
    for (int time = 0; time < 20; ++time) {  // while it fetches
        second.go_on(100);
        std::this_thread::sleep_for(10ms);
    }
    second.land();
    record_slowly(scene.origin.archive, 200, 1ms);
    scene.is_equal(*late);
    CHECK(late->follower->status().fetched_steps > 0);
    if (cut) CHECK(scene.server.cut > 1);
    test::add_note(scene.origin.archive, RunId{1}, "the day after");
    scene.is_equal(*late);
}

TEST_CASE("what was fetched is not fetched again: a cut answer goes on from where it was", "[cluster][R61]") {
    if (!NatsServer::present()) return;
    LateScene scene;
    test::record_run(scene.origin.archive, followed_dictionary, 12'000);
    scene.published();
    scene.forget_all();
    const auto octets_whole = scene.octets_of(RunId{1});
    scene.server.part_octets = 1'000;
    scene.server.octets_max = octets_whole / 2;
    const auto late = scene.late("late.db");
    scene.is_equal(*late);
    CHECK(scene.server.answers >= 2);
    // Of each answer but the last one a step at most comes twice.
    CHECK(scene.server.octets < octets_whole + scene.server.answers * (octets_whole / 3));
}

TEST_CASE("a follower that ends while it fetches, or had nowhere to fetch from, has all when it comes back",
          "[cluster][R61]") {
    if (!NatsServer::present()) return;
    const bool had_source = GENERATE(true, false);
    LateScene scene;
    UnderWay first{scene.origin.archive};
    first.go_on(9'000);
    scene.published();
    scene.forget_all();
    first.go_on(300);
    first.land();
    record_slowly(scene.origin.archive, 100, 0ms);  // run 2, behind the rest of run 1 in the engine
    if (had_source) {
        scene.server.octets_max = scene.octets_of(RunId{1}) * 2 / 3;
        const auto late = scene.late("late.db");
        REQUIRE(comes([&] { return late->follower->status().fetched_steps > 0; }));
    } else {
        const Copy late{scene.folder / "late.db", scene.engine.url()};
        REQUIRE(comes([&] { return !late.follower->status().left_out.empty(); }));
        CHECK_THAT(cluster::text_of(late.follower->status()), Catch::Contains("--snapshot-from"));
        REQUIRE(comes([&] { return late.follower->status().steps > 0; }));
        std::this_thread::sleep_for(100ms);
    }
    scene.server.octets_max = SIZE_MAX;
    const auto late = scene.late("late.db");
    scene.is_equal(*late);
}

TEST_CASE("a server that refuses, or is of another archive or dictionary, is told in a line and asked again",
          "[cluster][R61]") {
    if (!NatsServer::present()) return;
    LateScene scene;
    record_slowly(scene.origin.archive, 200, 0ms);
    scene.published();
    scene.forget_all();
    const auto told = [](Copy& copy, const std::string& words) {
        const bool came = comes([&] { return copy.follower->status().fetch_fault.find(words) != std::string::npos; });
        INFO(cluster::text_of(copy.follower->status()));
        CHECK(came);
        CHECK(cluster::text_of(copy.follower->status()).find('\n') == std::string::npos);
    };
    SECTION("a token that it does not know") {
        scene.server.refuses = 401;
        const auto late = scene.late("late.db");
        told(*late, "http://origin: it answers 401: log in first");
        scene.server.refuses = 0;
        scene.is_equal(*late);
    }
    SECTION("another archive") {
        Origin other{scene.folder / "other.db", scene.engine.url()};
        record_slowly(other.archive, 200, 0ms);
        SnapshotServer server{other.file()};
        Copy late{scene.folder / "late.db", scene.engine.url(), scene.origin.identity(), followed_dictionary.id, {},
                  server.source()};
        told(late, fmt::format("run 1 from http://origin: it has runs of the archive {:.8}, this server follows {:.8}",
                               other.identity(), scene.origin.identity()));
        CHECK(late.follower->status().refused > 0);
    }
    SECTION("another dictionary") {
        // Of an archive that says it is the origin's, with runs that are not.
        const auto forged = scene.folder / "forged.db";
        REQUIRE(archive::backup(scene.origin.file(), forged));
        {
            auto database = archive::sqlite::Database::open(forged.string(), archive::sqlite::Mode::read_write_create);
            REQUIRE(database);
            REQUIRE(database->execute("UPDATE runs SET dictionary = 9"));
        }
        SnapshotServer server{forged};
        Copy late{scene.folder / "late.db", scene.engine.url(), "", followed_dictionary.id, {}, server.source()};
        told(late, fmt::format("it has the dictionary 9, this server {}", followed_dictionary.id));
        CHECK(late.follower->status().items == 0);
    }
    SECTION("rows that are not those of the origin's fingerprint") {
        const auto forged = scene.folder / "forged.db";
        REQUIRE(archive::backup(scene.origin.file(), forged));
        {
            auto database = archive::sqlite::Database::open(forged.string(), archive::sqlite::Mode::read_write_create);
            REQUIRE(database);
            REQUIRE(database->execute("UPDATE packets SET octets = zeroblob(length(octets)) WHERE key ="
                                      " (SELECT max(key) FROM packets)"));
        }
        SnapshotServer server{forged};
        Copy late{scene.folder / "late.db", scene.engine.url(), "", followed_dictionary.id, {}, server.source()};
        told(late, "fingerprint");
    }
    SECTION("another follower that has less than the engine begins with") {
        UnderWay second{scene.origin.archive};
        second.go_on(200);
        scene.published();
        const auto behind = scene.folder / "behind.db";
        const auto last = [&] { return (**archive::RunRowsReader::open(scene.origin.file())->run(RunId{2})).last_seq; };
        const auto held_by_other = last();
        REQUIRE(archive::backup(scene.origin.file(), behind));
        second.go_on(200);
        scene.published();
        scene.forget_all();
        const auto forgotten = last();
        second.go_on(200);
        second.land();
        SnapshotServer server{behind};
        Copy late{scene.folder / "late.db", scene.engine.url(), "", followed_dictionary.id, {}, server.source()};
        told(late, fmt::format("run 2 from http://origin: it has items up to {}, the engine those behind {}",
                               held_by_other, forgotten));
        std::filesystem::remove(behind);
        REQUIRE(archive::backup(scene.origin.file(), behind));
        scene.is_equal(late);
    }
}

TEST_CASE("chosen runs alone are fetched", "[cluster][R61]") {
    if (!NatsServer::present()) return;
    LateScene scene;
    for (int run = 0; run < 3; ++run) record_slowly(scene.origin.archive, 100, 0ms);
    scene.published();
    scene.forget_all();
    auto chosen = cluster::ChosenRuns::parse("2-");
    REQUIRE(chosen);
    const Copy late{scene.folder / "late.db", scene.engine.url(), "", followed_dictionary.id, *chosen,
                    scene.server.source()};
    REQUIRE(comes([&] { return late.follower->status().items >= 400 && late.follower->status().fetching.empty(); }));
    std::this_thread::sleep_for(300ms);
    for (const auto& path : scene.server.paths()) CHECK_THAT(path, !Catch::Contains("/runs/1/"));
    CHECK(late.follower->status().items == 400);
}

}  // namespace server_cluster_snapshot_fetcher_test
