// SPDX-License-Identifier: Apache-2.0
#include "server/access/secrets.hpp"
#include "server/cluster/signed_request.hpp"
#include "tests/server/small_mission.hpp"
#include "tests/support/catch.hpp"

namespace server_cluster_signed_request_test {

using namespace aeolis;
using namespace aeolis::server;
using namespace std::chrono_literals;
using cluster::RequestCheck;

namespace {

struct Origin {
    std::string seed = new_signing_seed();
    bool listed = true;
    std::uint64_t told = 100;  ///< newest count; those of the last 30 count
    RequestCheck check{
        {"origin",
         [this](const std::string& key) -> std::optional<std::string> {
             if (!listed || key != hexadecimal(public_key_of(seed))) return std::nullopt;
             return "site_b";
         },
         [this](const std::string& publisher, std::uint64_t count) -> std::optional<std::chrono::milliseconds> {
             if (publisher != "this process" || count > told || count + 30 < told) return std::nullopt;
             return 0ms;
         }}};

    v1::FollowerRequest request() const {
        v1::FollowerRequest request;
        request.set_origin("origin");
        request.set_publisher("this process");
        request.set_heard(told);
        request.set_number(drawn_octets(cluster::request_number_octets));
        request.set_user("nina");
        return request;
    }
    std::string why(const std::string& octets, RequestCheck::Clock::time_point now = {}) {
        const auto taken = check.take(octets, now);
        return taken ? "taken" : taken.error().message;
    }
};

}  // namespace

TEST_CASE("a request is taken once, if a listed key has signed it for this process a short time ago",
          "[cluster][access][R61]") {
    Origin origin;
    const auto request = origin.request();
    const auto octets = cluster::signed_message(request, origin.seed);
    const auto taken = origin.check.take(octets, {});
    REQUIRE(taken);
    CHECK(taken->follower == "site_b");
    CHECK(taken->request.user() == "nina");
    CHECK_THAT(origin.why(octets), Catch::Contains("follower site_b: ") && Catch::Contains("taken before"));

    const auto changed = [&](auto change) {
        auto other = origin.request();
        change(other);
        return origin.why(cluster::signed_message(other, origin.seed));
    };
    CHECK(changed([](auto&) {}) == "taken");
    CHECK_THAT(changed([](auto& other) { other.set_origin("another"); }), Catch::Contains("another archive"));
    CHECK_THAT(changed([](auto& other) { other.set_publisher("before"); }),
               Catch::Contains("before this server started"));
    CHECK_THAT(changed([](auto& other) { other.set_heard(69); }), Catch::Contains("too long ago"));
    CHECK_THAT(changed([](auto& other) { other.set_heard(101); }), Catch::Contains("has not heard"));
    CHECK_THAT(changed([](auto& other) { other.set_number("short"); }), Catch::Contains("not a request"));
    CHECK_THAT(origin.why(cluster::signed_message(origin.request(), new_signing_seed())),
               Catch::Contains("none of this server's followers"));
    CHECK_THAT(origin.why("no request"),
               Catch::Contains("none of this server's followers") || Catch::Contains("not a request of a follower"));
    origin.listed = false;
    CHECK_THAT(changed([](auto&) {}), Catch::Contains("none of this server's followers"));
}

TEST_CASE("a change of any bit of a signed request is refused", "[cluster][access][R61]") {
    Origin origin;
    const auto octets = cluster::signed_message(origin.request(), origin.seed);
    for (std::size_t at = 0; at < octets.size(); ++at)
        for (unsigned bit = 0; bit < 8; ++bit) {
            auto forged = octets;
            forged[at] = static_cast<char>(forged[at] ^ (1U << bit));
            if (origin.check.take(forged, {})) FAIL("octet " << at << ", bit " << bit);
        }
    CHECK(origin.why(octets) == "taken");
}

TEST_CASE("the numbers of requests are kept longer than a request counts, and are bounded", "[cluster][access][R61]") {
    Origin origin;
    auto now = RequestCheck::Clock::time_point{};
    const auto octets = cluster::signed_message(origin.request(), origin.seed);
    CHECK(origin.why(octets, now) == "taken");
    for (int second = 0; second <= 59; ++second)
        CHECK(origin.why(octets, now + std::chrono::seconds{second}) != "taken");
    origin.told += 61;  // told each second: by then it is too old by what it has heard
    CHECK_THAT(origin.why(octets, now + 61s), Catch::Contains("too long ago"));
    now += 200s;
    for (std::size_t count = 0; count < RequestCheck::kept_max; ++count)
        if (!origin.check.take(cluster::signed_message(origin.request(), origin.seed), now)) FAIL(count);
    CHECK_THAT(origin.why(cluster::signed_message(origin.request(), origin.seed), now),
               Catch::Contains("too many requests"));
    CHECK(origin.why(cluster::signed_message(origin.request(), origin.seed), now + 61s) == "taken");
}

TEST_CASE("a follower's key is its owner's alone, and a file that is none is named", "[cluster][access][R61]") {
    test::TemporaryFolder folder;
    const auto file = folder / "key";
    const auto key = cluster::make_key(file);
    REQUIRE(key);
    const auto seed = cluster::read_seed(file);
    REQUIRE(seed);
    CHECK(hexadecimal(public_key_of(*seed)) == *key);
    CHECK_FALSE(cluster::make_key(file));  // nothing is overwritten
    std::filesystem::permissions(file, std::filesystem::perms::group_read, std::filesystem::perm_options::add);
    const auto open = cluster::read_seed(file);
    REQUIRE_FALSE(open);
    CHECK_THAT(open.error().message, Catch::Contains(file.string()) && Catch::Contains("others may read"));
    CHECK_FALSE(cluster::read_seed(folder / "none"));
}

}  // namespace server_cluster_signed_request_test
