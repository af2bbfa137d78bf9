// SPDX-License-Identifier: Apache-2.0
#include "server/archive/reader.hpp"
#include "server/pipeline/pipeline.hpp"
#include "tests/server/small_mission.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/octets.hpp"

#include <algorithm>

namespace archive_raw_octets_test {

using namespace aeolis;
using namespace aeolis::test;
using archive::Archive;
using archive::RawPiece;
using archive::Reader;
using archive::RunId;

namespace {

using Octets = std::vector<std::uint8_t>;

struct Ground {
    TemporaryFolder folder;
    dictionary::Dictionary dictionary = small_dictionary();
    std::optional<Archive> archive = std::move(Archive::open(folder / "a.db")).value();
    pipeline::Pipeline pipeline{*archive, dictionary};

    void take(const char* link, std::int64_t ert_us, const Octets& octets, bool datagram = false) {
        REQUIRE(pipeline.accept(telemetry::ReceivedOctets{{link, false}, Ert{ert_us}, octets, datagram}).ok());
    }
    std::vector<RawPiece> pieces(const archive::RawQuery& query = {}) {
        auto reader = std::move(Reader::open(folder / "a.db", dictionary)).value();
        std::vector<RawPiece> all;
        std::optional<RawPiece> after;
        for (bool last = false; !last;) {
            const auto page = reader.raw(RunId{1}, query, after);
            REQUIRE(page);
            last = page->last;
            all.insert(all.end(), page->pieces.begin(), page->pieces.end());
            if (!all.empty()) after = all.back();
        }
        return all;
    }
    Octets octets(const archive::RawQuery& query = {}) {
        Octets all;
        for (const auto& piece : pieces(query)) all.insert(all.end(), piece.octets.begin(), piece.octets.end());
        return all;
    }
};

Octets operator+(Octets a, const Octets& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

}  // namespace

TEST_CASE("what links brought is kept as it came, by link, with its times, and datagrams each for itself",
          "[archive][R55]") {
    Ground ground;
    REQUIRE(ground.pipeline.begin({}).ok());
    std::mt19937 random{1};
    Octets one, two;
    for (std::int64_t i = 0; i < 500; ++i) {
        const auto a = random_octets(random, 1 + random() % 300), b = random_octets(random, 1 + random() % 300);
        ground.take("uhf_live", i * 100'000, a);
        ground.take("downlink", i * 100'000, b, true);
        one = one + a;
        two = two + b;
        if (i % 7 == 0) REQUIRE(ground.pipeline.commit().ok());
    }
    REQUIRE(ground.pipeline.finish({archive::Outcome::stopped, "", "", ""}).ok());
    CHECK(ground.octets({.link = "uhf_live"}) == one);
    CHECK(ground.octets({.link = "downlink"}) == two);
    CHECK(ground.pieces({.link = "downlink"}).size() == 500);
    CHECK(ground.pieces({.link = "uhf_live"}).size() < 300);  // pieces of a quarter of a second are one
    const auto range = ground.pieces({.link = "downlink", .from = Ert{1'000'000}, .to = Ert{2'000'000}});
    REQUIRE(range.size() == 11);
    CHECK(range.front().ert == Ert{1'000'000});
    CHECK(range.back().ert == Ert{2'000'000});
    auto reader = std::move(Reader::open(ground.folder / "a.db", ground.dictionary)).value();
    const auto links = reader.raw_links(RunId{1});
    REQUIRE(links);
    REQUIRE(links->size() == 2);
    CHECK(links->at(0).octets == two.size());
    CHECK_FALSE(links->at(0).stream);
    CHECK(links->at(1).stream);
    CHECK(links->at(1).first == 0);
}

TEST_CASE("of more octets than are to be kept of a link the newest are kept, and how many are gone is known",
          "[archive][R55]") {
    Ground ground;
    ground.pipeline.keep_raw(5000);
    REQUIRE(ground.pipeline.begin({}).ok());
    std::mt19937 random{2};
    Octets all;
    for (std::int64_t i = 0; i < 100; ++i) {
        const auto octets = random_octets(random, 200);
        ground.take("downlink", i, octets, true);
        all = all + octets;
        REQUIRE(ground.pipeline.commit().ok());
    }
    ground.take("x_band", 0, {1, 2, 3});
    REQUIRE(ground.pipeline.commit().ok());
    const auto kept = ground.octets({.link = "downlink"});
    CHECK(kept.size() == 5000);
    CHECK(std::equal(kept.rbegin(), kept.rend(), all.rbegin()));
    CHECK(ground.octets({.link = "x_band"}) == Octets{1, 2, 3});
    auto reader = std::move(Reader::open(ground.folder / "a.db", ground.dictionary)).value();
    CHECK(reader.raw_links(RunId{1})->at(0).first == all.size() - 5000);
    ground.pipeline.keep_raw(0);
    ground.take("x_band", 0, {4});
    REQUIRE(ground.pipeline.commit().ok());
    CHECK(ground.octets({.link = "x_band"}) == Octets{1, 2, 3});
}

TEST_CASE("a piece of octets goes only when all of it ends before those that are to be kept", "[archive][R55]") {
    Ground ground;
    ground.pipeline.keep_raw(1000);
    REQUIRE(ground.pipeline.begin({}).ok());
    for (std::int64_t i = 0; i < 10; ++i) {
        ground.take("downlink", i, Octets(300, static_cast<std::uint8_t>(i)), true);
        REQUIRE(ground.pipeline.commit().ok());
    }
    CHECK(ground.octets({.link = "downlink"}).size() == 1200);  // 900 are fewer than 1000
}

TEST_CASE("a run that is flown again from its beginning keeps each octet once, wherever it was cut off",
          "[archive][R55]") {
    std::mt19937 random{3};
    for (const int cut_after : {1, 20, 39}) {
        Ground ground;
        Octets all;
        std::vector<Octets> sent;
        for (int i = 0; i < 40; ++i) {
            sent.push_back(random_octets(random, 50));
            all = all + sent.back();
        }
        const auto fly = [&](pipeline::Pipeline& pipeline, int first, int cycles, int every) {
            for (int i = first; i < cycles; ++i) {
                REQUIRE(pipeline
                            .accept(telemetry::ReceivedOctets{
                                {"uhf_live", false}, Ert{i * 15'625}, sent[static_cast<std::size_t>(i)]})
                            .ok());
                REQUIRE(pipeline.accept(live(navigation_packet(static_cast<std::uint16_t>(i), 1000.0 + i, 1.0F, 3.0F)))
                            .ok());
                if (i % every == 0) REQUIRE(pipeline.commit().ok());
            }
        };
        REQUIRE(ground.pipeline.begin({}).ok());
        fly(ground.pipeline, 0, cut_after, 3);
        REQUIRE(ground.pipeline.commit().ok());
        const auto durable = ground.pipeline.last_durable();
        ground.pipeline.abandon();
        ground.archive.reset();  // opened again, the run counts as interrupted
        ground.archive.emplace(std::move(Archive::open(ground.folder / "a.db")).value());
        pipeline::Pipeline again{*ground.archive, ground.dictionary};
        REQUIRE(again.resume(RunId{1}, {}, durable, [](const auto&) { return Result<void>{}; }).ok());
        fly(again, 0, cut_after, 5);
        REQUIRE(again.commit().ok());
        REQUIRE(again.caught_up());
        fly(again, cut_after, 40, 5);
        REQUIRE(again.commit().ok());
        CHECK(ground.octets() == all);
    }
}

TEST_CASE("a run that is removed leaves none of its octets", "[archive][R55]") {
    Ground ground;
    for (int run = 0; run < 2; ++run) {
        REQUIRE(ground.pipeline.begin({}).ok());
        for (std::int64_t i = 0; i < 100; ++i) ground.take("downlink", i, Octets(100, 7), true);
        REQUIRE(ground.pipeline.finish({archive::Outcome::stopped, "", "", ""}).ok());
    }
    REQUIRE(ground.archive->prune(RunId{1}, {}).ok());
    int steps = 0;
    for (auto more = ground.archive->remove_pruned(); more && *more; more = ground.archive->remove_pruned()) ++steps;
    CHECK(steps > 100 / 16);  // a piece at a time
    CHECK(ground.octets().empty());
    auto reader = std::move(Reader::open(ground.folder / "a.db", ground.dictionary)).value();
    CHECK(reader.raw_links(RunId{2})->at(0).octets == 10'000);
}

}  // namespace archive_raw_octets_test
