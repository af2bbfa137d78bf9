// SPDX-License-Identifier: Apache-2.0
#include "server/base/pcap.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/octets.hpp"

namespace server_pcap_test {

using namespace aeolis;
using namespace aeolis::server;

namespace {

std::vector<std::uint8_t> octets_of(const std::string& text) {
    return {text.begin(), text.end()};
}

}  // namespace

TEST_CASE("a pcap file gives back the datagrams that were written, with their times and ports", "[server][R55]") {
    std::mt19937 random{1};
    std::string written = pcap::head();
    const auto small = test::random_octets(random, 33), large = test::random_octets(random, 65536);
    pcap::append(written, Ert{397'501'174'123'456}, 4200, small);
    pcap::append(written, Ert{-1'500'000}, 4201, large);  // more than a datagram holds
    const auto file = octets_of(written);
    REQUIRE(pcap::File::is(file));
    auto read = pcap::File::open(file);
    REQUIRE(read);
    const auto first = read->next();
    REQUIRE(first);
    CHECK(first->ert == Ert{397'501'174'123'456});
    CHECK(first->port == 4200);
    CHECK(test::copy_of(first->octets) == small);
    auto second = read->next();
    REQUIRE(second);
    auto both = test::copy_of(second->octets);
    const auto third = read->next();
    REQUIRE(third);
    CHECK(third->ert == Ert{-1'500'000});
    CHECK(third->port == 4201);
    both.insert(both.end(), third->octets.begin(), third->octets.end());
    CHECK(both == large);
    CHECK_FALSE(read->next());
    CHECK_FALSE(read->cut());
    // The header checksum of the first datagram: the sum of its words is all ones.
    unsigned sum = 0;
    for (std::size_t i = 40; i < 60; i += 2) sum += static_cast<unsigned>(file[i]) << 8U | file[i + 1];
    CHECK(((sum & 0xFFFFU) + (sum >> 16U)) == 0xFFFFU);
}

TEST_CASE("captures of Ethernet with a VLAN, in the other order of octets and in nanoseconds, are read; what is no "
          "whole UDP is counted",
          "[server][R55]") {
    const std::string ip = "4500001e0000000040110000c0000201c0000202 1068106800"
                           "0a0000"
                           "abcd";
    const std::string ethernet = "0102030405060708090a0b0c 81000005 0800" + ip;
    const auto head = test::hex("a1b23c4d 0002 0004 00000000 00000000 00040000 00000001");
    const auto record = [](const std::string& packet) {
        const auto octets = test::hex(packet);
        auto whole = test::hex("386d4380 00001388");  // 2000-01-01T00:00:00 and 5000 ns
        for (int i = 0; i < 2; ++i)
            for (const unsigned part : {0U, 0U, 0U, static_cast<unsigned>(octets.size())})
                whole.push_back(static_cast<std::uint8_t>(part));
        whole.insert(whole.end(), octets.begin(), octets.end());
        return whole;
    };
    std::string tcp = ethernet, fragment = ethernet, cut = ethernet;
    tcp.replace(tcp.find("4011"), 4, "4006");
    fragment.replace(fragment.find("00000000401100"), 8, "00002000");
    cut.resize(cut.size() - 2);
    auto file = head;
    for (const auto& each : {tcp, ethernet, fragment, cut, std::string{"00"}}) {
        const auto octets = record(each);
        file.insert(file.end(), octets.begin(), octets.end());
    }
    file.push_back(0);
    auto read = pcap::File::open(file);
    REQUIRE(read);
    const auto only = read->next();
    REQUIRE(only);
    CHECK(only->ert == Ert{-43'200'000'000 + 5});
    CHECK(only->port == 0x1068);
    CHECK(test::copy_of(only->octets) == test::hex("abcd"));
    CHECK_FALSE(read->next());
    CHECK(read->others() == 4);
    CHECK(read->cut());
}

TEST_CASE("what is no pcap file, or one of another kind, is told", "[server][R55]") {
    CHECK_FALSE(pcap::File::is(test::hex("1acffc1d00")));
    CHECK_FALSE(pcap::File::open(test::hex("1acffc1d00")));
    const auto newer = pcap::File::open(test::hex("0a0d0d0a1c000000"));
    REQUIRE_FALSE(newer);
    CHECK_THAT(newer.error().message, Catch::Contains("editcap"));
    CHECK_FALSE(pcap::File::open(test::hex("d4c3b2a10200")));
    const auto bus = pcap::File::open(test::hex("d4c3b2a1 0200 0400 00000000 00000000 00000400 e3000000"));
    REQUIRE_FALSE(bus);
    CHECK_THAT(bus.error().message, Catch::Contains("link type 227"));
}

}  // namespace server_pcap_test
