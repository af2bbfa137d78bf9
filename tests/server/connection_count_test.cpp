// SPDX-License-Identifier: Apache-2.0
#include "server/net/connection_count.hpp"

#include "tests/support/catch.hpp"

namespace server_connection_count_test {

using aeolis::server::ConnectionCount;

TEST_CASE("one address has its share of the connections, and no more than that", "[http][bounds]") {
    ConnectionCount count(10, 3);
    for (int i = 0; i < 3; ++i) CHECK(count.enter("192.0.2.1", false).empty());
    CHECK(count.enter("192.0.2.1", false) == "3 connections are open from 192.0.2.1 already");
    CHECK(count.enter("192.0.2.2", false).empty());
    count.leave("192.0.2.1");
    CHECK(count.enter("192.0.2.1", false).empty());
    CHECK(count.all() == 4);
}

TEST_CASE("this machine has no share of its own, only the limit of all", "[http][bounds]") {
    ConnectionCount count(10, 3);
    for (int i = 0; i < 10; ++i) CHECK(count.enter("127.0.0.1", true).empty());
    CHECK(count.enter("127.0.0.1", true) == "10 connections are open already");
    CHECK(count.enter("192.0.2.1", false) == "10 connections are open already");
}

}  // namespace server_connection_count_test
