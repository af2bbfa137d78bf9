// SPDX-License-Identifier: Apache-2.0
#include "server/api/hub_feed.hpp"

#include "tests/support/catch.hpp"

#include <deque>
#include <random>

namespace server_hub_feed_test {

using namespace aeolis;
using namespace aeolis::server;

namespace {

HubFeed::Batch batch_of(archive::Sequence first, std::size_t items) {
    auto batch = std::make_shared<pipeline::PublishedBatch>();
    batch->run = archive::RunId{3};
    batch->first_seq = first;
    batch->last_seq = first + items - 1;
    batch->items.resize(items);
    return batch;
}

}  // namespace

TEST_CASE("a network thread that comes late holds a bounded number of items, and every number reaches it in order",
          "[stream][bounds][property][R42]") {
    constexpr std::size_t items_max = 100;
    std::mt19937 random{5};
    HubFeed feed{items_max};
    std::deque<HubFeed::Batch> posted;
    archive::Sequence last = 0, seen = 0;
    std::size_t without_items = 0;
    for (int step = 0; step < 10'000; ++step) {
        if (random() % 3 != 0) {
            const auto items = 1 + random() % 30;
            posted.push_back(feed.departs(batch_of(last + 1, items)));
            last += items;
            CHECK(feed.items_waiting() <= items_max);
        }
        const bool late = step / 100 % 2 == 0;  // for a hundred turns it takes nothing
        while (!late && !posted.empty()) {
            const auto& batch = *posted.front();
            CHECK(batch.run.value == 3);
            CHECK(batch.first_seq == seen + 1);
            seen = batch.last_seq;
            CHECK(batch.items.size() == (batch.built ? batch.last_seq - batch.first_seq + 1 : 0));
            without_items += batch.built ? 0 : 1;
            feed.arrived(batch);
            posted.pop_front();
        }
        if (!late) CHECK(feed.items_waiting() == 0);
    }
    CHECK(without_items > 100);
    CHECK(seen == last);
}

TEST_CASE("a batch that is larger than all that may wait travels whole when nothing else does", "[stream][bounds]") {
    HubFeed feed{10};
    CHECK(feed.departs(batch_of(1, 50))->built);
    CHECK_FALSE(feed.departs(batch_of(51, 1))->built);
}

}  // namespace server_hub_feed_test
