// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/chosen_runs.hpp"
#include "tests/server/cluster/followed.hpp"
#include "tests/support/catch.hpp"

namespace server_cluster_chosen_runs_test {

using namespace aeolis;
using namespace aeolis::tests;
using cluster::ChosenRuns;

TEST_CASE("runs are chosen by numbers and ranges, and anything else is refused", "[cluster][R61]") {
    CHECK(ChosenRuns{}.has(RunId{7}));
    const auto chosen = ChosenRuns::parse("3,5-8,12-");
    REQUIRE(chosen);
    for (const std::uint32_t run : {3U, 5U, 6U, 8U, 12U, 13U, 4'000'000'000U}) CHECK(chosen->has(RunId{run}));
    for (const std::uint32_t run : {1U, 2U, 4U, 9U, 11U}) CHECK_FALSE(chosen->has(RunId{run}));
    for (const char* wrong : {"", ",", "0", "-", "-3", "8-5", "3,,5", "three", "3 ,5", "5-x", "5000000000"}) {
        INFO(wrong);
        CHECK_FALSE(ChosenRuns::parse(wrong));
    }
}

TEST_CASE("a follower of chosen runs has these, and others once they are chosen too", "[cluster][R61]") {
    if (!NatsServer::present()) return;
    test::TemporaryFolder folder;
    const NatsServer server;
    Origin origin{folder / "origin.db", server.url()};
    for (int run = 0; run < 3; ++run) test::record_run(origin.archive, followed_dictionary, 200);
    const auto held = [&](Copy& copy) {
        std::vector<std::uint32_t> numbers;
        auto reader = archive::RunRowsReader::open(copy.file());
        REQUIRE(reader);
        const auto runs = reader->runs();
        REQUIRE(runs);
        for (const auto& run : *runs)
            if (run.state == "finished") numbers.push_back(run.run.value);
        return numbers;
    };
    {
        Copy copy{folder / "copy.db", server.url(), {}, followed_dictionary.id, *ChosenRuns::parse("2")};
        CHECK(comes([&] { return held(copy) == std::vector{2U}; }));
        CHECK(comes([&] { return copy.follower->status().behind_items == 0; }));
        CHECK(copy.follower->status().left_out.empty());
    }
    Copy copy{folder / "copy.db", server.url()};
    CHECK(comes([&] { return same(origin.file(), copy.file()); }));
}

}  // namespace server_cluster_chosen_runs_test
