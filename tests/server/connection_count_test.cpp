// SPDX-License-Identifier: Apache-2.0
#include "server/net/connection_count.hpp"

#include "tests/support/catch.hpp"

#include <random>
#include <set>

namespace server_connection_count_test {

using aeolis::Result;
using aeolis::server::ConnectionCount;
using Place = std::shared_ptr<ConnectionCount::Place>;

namespace {

/// Connections that end as soon as they are closed.
struct Venue {
    ConnectionCount count;
    std::map<int, Place> open;
    int next = 0;

    explicit Venue(ConnectionCount::Limits limits) : count(limits) {}
    ~Venue() { open.clear(); }
    /// The number of the new connection; or the refusal.
    Result<int> enter(const std::string& network, bool shared = false) {
        const int number = next++;
        auto place = count.enter(network, shared, [this, number] { open.erase(number); });
        if (!place) return place.error();
        open.emplace(number, *place);
        return number;
    }
    Result<void> know(int number, const std::string& person) { return open.at(number)->know(person); }
};

}  // namespace

TEST_CASE("strangers of one network have their part of the places, and no more than that", "[http][bounds][R63]") {
    Venue venue{{.all = 20, .strangers = 10, .strangers_of_network = 3}};
    for (int i = 0; i < 3; ++i) CHECK(venue.enter("192.0.2.1"));
    CHECK(venue.enter("192.0.2.1"));  // 3, for 0
    CHECK_FALSE(venue.open.contains(0));
    CHECK(venue.enter("192.0.2.2"));
    REQUIRE(venue.know(1, "Ann"));  // who is known does not count among them
    CHECK(venue.enter("192.0.2.1"));
    CHECK(venue.open.size() == 5);
}

TEST_CASE("strangers give way to each other, the oldest of the largest group first, and never one who is known",
          "[http][bounds][R63]") {
    Venue venue{{.all = 8, .strangers = 4, .strangers_of_network = 3}};
    REQUIRE(venue.enter("192.0.2.9"));
    REQUIRE(venue.know(0, ""));
    for (int i = 0; i < 3; ++i) REQUIRE(venue.enter("192.0.2.1"));  // 1, 2, 3
    REQUIRE(venue.enter("192.0.2.2"));                              // 4
    REQUIRE(venue.enter("192.0.2.3"));                              // 5, for 1
    CHECK_FALSE(venue.open.contains(1));
    REQUIRE(venue.enter("192.0.2.4"));  // 6, for 2
    CHECK_FALSE(venue.open.contains(2));
    CHECK(venue.open.contains(0));
    CHECK(venue.open.contains(4));
    CHECK(venue.count.all() == 5);
}

TEST_CASE("this machine, and a proxy, have no part of their own, and their strangers give way as well",
          "[http][bounds][R63]") {
    Venue venue{{.all = 10, .strangers = 5, .strangers_of_network = 2}};
    for (int i = 0; i < 50; ++i) REQUIRE(venue.enter("127.0.0.1", true));
    CHECK(venue.open.size() == 5);
    CHECK(venue.open.contains(49));
}

TEST_CASE("nobody known has more places than are free, and one who comes then has one", "[http][bounds][R63]") {
    Venue venue{{.all = 10, .strangers = 4, .strangers_of_network = 4}};
    int known = 0;
    for (int i = 0; i < 12; ++i) {
        const auto number = venue.enter("192.0.2.1");
        REQUIRE(number);
        if (const auto done = venue.know(*number, "Greedy")) {
            ++known;
        } else {
            CHECK(done.error().message == "5 connections of Greedy are open already, no more than are free");
            venue.open.erase(*number);
        }
    }
    CHECK(known == 5);
    const auto other = venue.enter("192.0.2.2");
    REQUIRE(other);
    CHECK(venue.know(*other, "Ann"));
}

TEST_CASE("when all places are those of people who are known, the next connection is refused", "[http][bounds]") {
    Venue venue{{.all = 3, .strangers = 2, .strangers_of_network = 2}};
    for (int i = 0; i < 3; ++i) REQUIRE(venue.know(*venue.enter("192.0.2.1"), ""));
    CHECK(venue.enter("192.0.2.2").error().message == "3 connections are open already");
    venue.open.erase(1);
    CHECK(venue.enter("192.0.2.2"));
}

TEST_CASE("whatever comes and goes, the bounds hold and the counts return to nothing", "[http][bounds][property]") {
    for (unsigned seed = 0; seed < 50; ++seed) {
        std::mt19937 random{seed};
        Venue venue{{.all = 12, .strangers = 6, .strangers_of_network = 3}};
        const auto any_open = [&] {
            return std::next(venue.open.begin(), static_cast<std::ptrdiff_t>(random() % venue.open.size()))->first;
        };
        for (int step = 0; step < 400; ++step) {
            const auto what = random() % 4;
            if (what < 2)
                static_cast<void>(venue.enter("n" + std::to_string(random() % 6), random() % 5 == 0));
            else if (!venue.open.empty() && what == 2)
                static_cast<void>(venue.know(any_open(), "p" + std::to_string(random() % 3)));
            else if (!venue.open.empty())
                venue.open.erase(any_open());
            std::size_t strangers = 0;
            for (const auto& [number, place] : venue.open) strangers += place->known() ? 0 : 1;
            CHECK(strangers <= 6);
            CHECK(venue.open.size() <= 12);
            CHECK(venue.count.all() == venue.open.size());
        }
        venue.open.clear();
        CHECK(venue.count.all() == 0);
        for (int i = 0; i < 3; ++i) CHECK(venue.enter("n0"));  // no place was lost
    }
}

}  // namespace server_connection_count_test
