// SPDX-License-Identifier: Apache-2.0
#include "common/fixed_queue.hpp"
#include "tests/support/catch.hpp"

namespace common_fixed_queue_test {

using namespace aeolis;

TEST_CASE("a fixed queue is first in, first out, round and round", "[common][R7]") {
    FixedQueue<int, 3> queue;
    for (int i = 0; i < 100; ++i) {
        REQUIRE(queue.try_push(i));
        REQUIRE(queue.try_push(i + 1000));
        CHECK(queue.front() == i);
        queue.pop();
        CHECK(queue.front() == i + 1000);
        queue.pop();
    }
    CHECK(queue.empty());
    CHECK_THROWS_AS(queue.front(), CheckFailed);
}

TEST_CASE("a fixed queue that is never empty goes round all the same", "[common][R7]") {
    FixedQueue<int, 3> queue;
    REQUIRE(queue.try_push(0));
    for (int i = 1; i < 100; ++i) {
        REQUIRE(queue.try_push(i));
        CHECK(queue.front() == i - 1);
        queue.pop();
        CHECK(queue.size() == 1);
    }
}

TEST_CASE("a full fixed queue refuses and keeps what it has", "[common][R7]") {
    FixedQueue<int, 2> queue;
    CHECK(queue.try_push(1));
    CHECK(queue.try_push(2));
    CHECK_FALSE(queue.try_push(3));
    CHECK(queue.front() == 1);
    CHECK(queue.size() == 2);
}

TEST_CASE("a queue that grows gives the place to fill, in order, until it is full", "[common]") {
    FixedQueue<int, 2> queue;
    *queue.try_grow() = 1;
    *queue.try_grow() = 2;
    CHECK(queue.try_grow() == nullptr);
    CHECK(queue.front() == 1);
    queue.pop();
    *queue.try_grow() = 3;
    CHECK(queue.front() == 2);
}

}  // namespace common_fixed_queue_test
