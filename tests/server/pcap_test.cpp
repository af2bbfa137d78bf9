// SPDX-License-Identifier: Apache-2.0
#include "server/base/pcap.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/octets.hpp"

#include <random>
#include <span>
#include <utility>

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

TEST_CASE("a piece of a stream is told from a datagram by the port and address that it is from", "[server][R55]") {
    const std::vector<std::uint8_t> octets{1, 2, 3};
    std::string written = pcap::head();
    pcap::append(written, Ert{0}, 4200, octets, true);
    pcap::append(written, Ert{0}, 4200, octets);
    std::string elsewhere = written;
    elsewhere[24 + 16 + 12] = '\x0A';  // 10.0.2.1: somebody's own port 4199
    const auto streams = [](const std::string& text) {
        const auto file = octets_of(text);
        auto read = pcap::File::open(file);
        REQUIRE(read);
        std::vector<bool> found;
        while (const auto datagram = read->next()) {
            CHECK(datagram->port == 4200);
            CHECK(test::copy_of(datagram->octets) == std::vector<std::uint8_t>{1, 2, 3});
            found.push_back(datagram->stream);
        }
        return found;
    };
    CHECK(streams(written) == std::vector{true, false});
    CHECK(streams(elsewhere) == std::vector{false, false});
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

namespace {

/// A block of pcapng, its numbers with the most significant octet first or last.
class Blocks {
  public:
    explicit Blocks(bool big) : big_(big) {}
    void section() {
        std::vector<std::uint8_t> body;
        put(body, 0x1A2B3C4D, 4);
        put(body, 1, 2);
        put(body, 0, 2);
        put(body, ~std::uint64_t{0}, 8);
        add(0x0A0D0D0A, body);
    }
    void interface(std::uint64_t link_type,
                   const std::vector<std::pair<unsigned, std::vector<std::uint8_t>>>& options) {
        std::vector<std::uint8_t> body;
        put(body, link_type, 2);
        put(body, 0, 2);
        put(body, 262144, 4);
        for (const auto& [code, value] : options) {
            put(body, code, 2);
            put(body, value.size(), 2);
            body.insert(body.end(), value.begin(), value.end());
            body.resize((body.size() + 3) / 4 * 4);
        }
        add(1, body);
    }
    void packet(std::uint64_t interface, std::uint64_t units, const std::vector<std::uint8_t>& octets) {
        std::vector<std::uint8_t> body;
        put(body, interface, 4);
        put(body, units >> 32U, 4);
        put(body, units & 0xFFFFFFFFU, 4);
        put(body, octets.size(), 4);
        put(body, octets.size(), 4);
        body.insert(body.end(), octets.begin(), octets.end());
        body.resize((body.size() + 3) / 4 * 4);
        add(6, body);
    }
    void add(std::uint64_t type, const std::vector<std::uint8_t>& body) {
        put(file, type, 4);
        put(file, body.size() + 12, 4);
        file.insert(file.end(), body.begin(), body.end());
        put(file, body.size() + 12, 4);
    }
    std::vector<std::uint8_t> file;

  private:
    void put(std::vector<std::uint8_t>& to, std::uint64_t value, unsigned octets) const {
        for (unsigned i = 0; i < octets; ++i)
            to.push_back(static_cast<std::uint8_t>(value >> (8 * (big_ ? octets - 1 - i : i))));
    }
    bool big_;
};

const std::string ip_head = "4500001e 00000000 40110000 c0000201c0000202 1068 1069 000a 0000";

}  // namespace

TEST_CASE("captures of pcapng are read: sections in either order, interfaces of any resolution, blocks that are not "
          "known",
          "[server][R55]") {
    const auto datagram = [](const std::string& data) { return test::hex(ip_head + data); };
    Blocks big{true}, little{false};
    constexpr std::uint64_t s_2000 = 946728000;  // 2000-01-01T12:00:00
    big.section();
    big.interface(101, {{2, {'l', 'o'}}, {9, {9}}});                      // nanoseconds
    big.interface(276, {{9, {0x8A}}, {14, {0, 0, 0, 0, 0, 0, 0, 100}}});  // 1/1024 s, 100 s later
    big.interface(147, {});                                               // of somebody's own
    big.add(5, {0, 0, 0, 0});                                             // statistics
    big.packet(0, s_2000 * 1'000'000'000 + 2'999, datagram("0001"));
    auto cooked = test::hex("0800 0000 00000001 0001 00 06 0000000000000000");
    const auto inside = datagram("0002");
    cooked.insert(cooked.end(), inside.begin(), inside.end());
    big.packet(1, s_2000 * 1024 + 512, cooked);
    big.packet(2, 0, datagram("0003"));
    big.packet(7, 0, datagram("0004"));                         // there is no such interface
    big.add(3, test::hex("0000001e" + ip_head + "0005 0000"));  // has no time
    little.section();
    little.interface(12, {});
    little.packet(0, (s_2000 - 1) * 1'000'000 + 250'000, datagram("0006"));
    auto file = big.file;
    file.insert(file.end(), little.file.begin(), little.file.end());
    REQUIRE(pcap::File::is(file));
    auto read = pcap::File::open(file);
    REQUIRE(read);
    for (const auto& [us, data] : {std::pair{2, "0001"}, {100'500'000, "0002"}, {-750'000, "0006"}}) {
        const auto found = read->next();
        REQUIRE(found);
        CHECK(found->ert == Ert{us});
        CHECK(found->port == 0x1069);
        CHECK(test::copy_of(found->octets) == test::hex(data));
    }
    CHECK_FALSE(read->next());
    CHECK(read->others() == 3);
    CHECK_FALSE(read->cut());

    // Wherever it ends, and whatever stands in it.
    std::mt19937 random{1};
    for (std::size_t size = 4; size < file.size(); ++size) {
        auto cut = pcap::File::open(std::span{file}.first(size));
        REQUIRE(cut.ok() == (size >= 12));
        while (cut && cut->next()) {
        }
        auto spoiled = file;
        for (int i = 0; i < 4; ++i) spoiled[random() % spoiled.size()] = static_cast<std::uint8_t>(random());
        if (auto damaged = pcap::File::open(spoiled))
            while (damaged->next()) {
            }
    }
    auto damaged = file;
    damaged[big.file.size() - 1] ^= 1U;  // the two lengths of a block disagree
    auto whole = pcap::File::open(damaged);
    REQUIRE(whole);
    while (whole->next()) {
    }
    CHECK(whole->cut());
}

TEST_CASE("what is no pcap file, or one of another kind, is told", "[server][R55]") {
    CHECK_FALSE(pcap::File::is(test::hex("1acffc1d00")));
    CHECK_FALSE(pcap::File::open(test::hex("1acffc1d00")));
    const auto damaged = pcap::File::open(test::hex("0a0d0d0a 1c000000 4d3c2b1b"));
    REQUIRE_FALSE(damaged);
    CHECK_THAT(damaged.error().message, Catch::Contains("first block of the pcapng file"));
    CHECK_FALSE(pcap::File::open(test::hex("d4c3b2a10200")));
    const auto bus = pcap::File::open(test::hex("d4c3b2a1 0200 0400 00000000 00000000 00000400 e3000000"));
    REQUIRE_FALSE(bus);
    CHECK_THAT(bus.error().message, Catch::Contains("link type 227"));
}

}  // namespace server_pcap_test
