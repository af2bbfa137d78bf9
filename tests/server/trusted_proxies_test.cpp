// SPDX-License-Identifier: Apache-2.0
#include "server/net/trusted_proxies.hpp"

#include "tests/support/catch.hpp"

namespace server_trusted_proxies_test {

using aeolis::server::net::TrustedProxies;

TEST_CASE("a client behind trusted proxies is the last address that is none of them", "[http][R63]") {
    const auto proxies = TrustedProxies::parse({"127.0.0.1", "10.0.0.0/8", "fd00::/8"}).value();
    struct Case {
        const char *peer, *forwarded, *client;
    };
    for (const auto& [peer, forwarded, client] : {
             Case{"10.1.2.3", "192.0.2.7", "192.0.2.7"},
             Case{"10.1.2.3", "6.6.6.6, 192.0.2.7", "192.0.2.7"},  // what the client itself says is not believed
             Case{"10.1.2.3", "6.6.6.6, 192.0.2.7, 10.9.9.9", "192.0.2.7"},  // two proxies
             Case{"10.1.2.3", " 192.0.2.7:4711 ", "192.0.2.7"},
             Case{"10.1.2.3", "[2001:db8::1]:4711", "2001:db8::1"},
             Case{"fd12::1", "2001:db8::1", "2001:db8::1"},
             Case{"::ffff:10.1.2.3", "192.0.2.7", "192.0.2.7"},
             Case{"10.1.2.3", "", "10.1.2.3"},
             Case{"10.1.2.3", "unknown", "10.1.2.3"},
             Case{"10.1.2.3", "192.0.2.7, , 10.9.9.9", "10.9.9.9"},
             Case{"10.1.2.3", "10.9.9.9", "10.9.9.9"},
             Case{"192.0.2.1", "6.6.6.6", "192.0.2.1"},  // no proxy: its word counts for nothing
             Case{"127.0.0.2", "6.6.6.6", "127.0.0.2"},
             Case{"unknown", "6.6.6.6", "unknown"},
         }) {
        CAPTURE(peer, forwarded);
        CHECK(proxies.client(peer, forwarded) == client);
    }
    CHECK(TrustedProxies{}.client("127.0.0.1", "192.0.2.7") == "127.0.0.1");
}

TEST_CASE("what is neither address nor network is refused by name", "[http]") {
    for (const char* text : {"", "proxy.example", "10.0.0.0/33", "10.0.0/8", "fd00::/129", "*"}) {
        CAPTURE(text);
        const auto proxies = TrustedProxies::parse({"127.0.0.1", text});
        REQUIRE_FALSE(proxies);
        CHECK_THAT(proxies.error().message, Catch::StartsWith("--trusted-proxies: '" + std::string{text} + "' is no"));
    }
}

}  // namespace server_trusted_proxies_test
