// SPDX-License-Identifier: Apache-2.0
#include "common/cfdp.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/octets.hpp"

#include <string>

namespace common_cfdp_test {

using namespace aeolis;
using namespace aeolis::cfdp;

namespace {

Content any_content(std::mt19937& random, const std::vector<std::uint8_t>& data, const std::string& name) {
    const auto word = [&] { return static_cast<std::uint32_t>(random()); };
    switch (random() % 8) {
    case 0: return FileData{word() % 0xFFFF0000, data};
    case 1: return Metadata{random() % 2 == 0, Checksum::modular, word(), name, name};
    case 2: return Eof{Condition::cancel_received, word(), word()};
    case 3:
        return Finished{Condition::file_checksum_failure, random() % 2 == 0, static_cast<std::uint8_t>(random() % 4)};
    case 4:
        return Ack{random() % 2 == 0 ? Directive::eof : Directive::finished, Condition::no_error,
                   static_cast<std::uint8_t>(random() % 4)};
    case 5: {
        Nak nak{{0, word()}, {}};
        for (std::size_t i = random() % (nak_requests_max + 1); i > 0; --i) {
            const std::uint32_t start = word() / 2;
            nak.requests.push_back({start, start + word() % 1000});
        }
        return nak;
    }
    case 6: return Prompt{random() % 2 == 0};
    default: return KeepAlive{word()};
    }
}

std::vector<std::uint8_t> written(const Pdu& pdu) {
    std::vector<std::uint8_t> octets(octets_of(pdu));
    REQUIRE(cfdp::write(pdu, octets) == octets.size());
    return octets;
}

}  // namespace

TEST_CASE("a published EOF reads as published", "[common]") {
    const auto pdu = cfdp::read(test::hex("00000A130018000000010015048000000000000065fc"));
    REQUIRE(pdu);
    CHECK(pdu->header == Header{.source = 24, .sequence = 1, .destination = 21});
    const auto* eof = std::get_if<Eof>(&pdu->content);
    REQUIRE(eof);
    CHECK(eof->condition == Condition::inactivity_detected);
    CHECK(eof->checksum == 0);
    CHECK(eof->file_octets == 26108);
}

TEST_CASE("published modular checksums, also of a part that begins inside a word", "[common]") {
    CHECK(modular_checksum(0, test::hex("000102030405060708090a0b0c0d0e")) == 0x181C2015);
    CHECK(modular_checksum(1, test::hex("0102030405060708090a0b0c0d0e")) == 0x181C2015);
}

TEST_CASE("the checksum of a file is that of its parts, however they were cut and in any order", "[common]") {
    std::mt19937 random{8};
    for (int round = 0; round < 200; ++round) {
        const auto file = test::random_octets(random, random() % 500);
        std::uint32_t sum = 0;
        for (std::size_t at = 0; at < file.size();) {
            const std::size_t now = std::min<std::size_t>(1 + random() % 40, file.size() - at);
            sum += modular_checksum(static_cast<std::uint32_t>(at), std::span{file}.subspan(at, now));
            at += now;
        }
        CHECK(sum == modular_checksum(0, file));
    }
}

TEST_CASE("every PDU reads back, octet for octet", "[common]") {
    std::mt19937 random{9};
    for (int round = 0; round < 5000; ++round) {
        const auto data = test::random_octets(random, random() % 900);
        const std::string name(random() % 256, 'n');
        const Pdu pdu{{random() % 2 == 0, random() % 2 == 0, random() % 2 == 0, random() % 65536, random() % 0xFFFFFFFF,
                       random() % 65536},
                      any_content(random, data, name)};
        const auto octets = written(pdu);
        const auto back = cfdp::read(octets);
        REQUIRE(back);
        REQUIRE(back->header == pdu.header);
        REQUIRE(back->content.index() == pdu.content.index());
        REQUIRE(written(*back) == octets);
    }
}

TEST_CASE("a PDU that is cut anywhere is refused as too short, one that goes on as too long", "[common]") {
    std::mt19937 random{10};
    const auto data = test::random_octets(random, 50);
    for (int round = 0; round < 300; ++round) {
        auto octets = written({{.crc = random() % 2 == 0}, any_content(random, data, "name")});
        for (std::size_t size = 0; size < octets.size(); ++size)
            REQUIRE(cfdp::read(std::span{octets}.first(size)).why() == Malformed::too_short);
        octets.push_back(0);
        REQUIRE(cfdp::read(octets).why() == Malformed::too_long);
    }
}

TEST_CASE("a PDU whose length field leaves too little for its directive is refused", "[common]") {
    std::mt19937 random{11};
    const Pdu pdu{{}, Eof{}};
    for (std::size_t left = 0; left < 10; ++left) {
        auto octets = written(pdu);
        octets.resize(written_header_octets + left);
        octets[2] = static_cast<std::uint8_t>(left);
        CHECK(cfdp::read(octets).why() == Malformed::too_short);
    }
}

TEST_CASE("what is not read is refused with the reason", "[common]") {
    CHECK(cfdp::read(test::hex("60000A130018000000010015048000000000000065fc")).why() == Malformed::other_version);
    CHECK(cfdp::read(test::hex("21000A130018000000010015048000000000000065fc")).why() ==
          Malformed::bad_field);  // large
    CHECK(cfdp::read(test::hex("20000A1B0018000000010015048000000000000065fc")).why() == Malformed::bad_field);
    CHECK(cfdp::read(test::hex("20000A1300180000000100150F8000000000000065fc")).why() == Malformed::bad_field);
    CHECK(cfdp::read(test::hex("20000A13001800000001001504C000000000000065fc")).why() == Malformed::bad_field);
    CHECK(cfdp::read(test::hex("2000 0313 0018 00000001 0015 067000")).why() ==
          Malformed::bad_field);  // ack of metadata
    CHECK(cfdp::read(test::hex("3000 0613 0018 00000001 0015 FFFFFFFF 0102")).why() == Malformed::bad_field);
    auto damaged = written({{.crc = true}, Eof{}});
    damaged.back() ^= 1;
    CHECK(cfdp::read(damaged).why() == Malformed::bad_checksum);
}

TEST_CASE("of a NAK with more requests than we keep the first are kept", "[common]") {
    Nak nak{{0, 1000}, {}};
    for (std::uint32_t i = 0; i < nak_requests_max; ++i) nak.requests.push_back({i, i + 1});
    auto octets = written({{}, nak});
    for (int i = 0; i < 8; ++i) octets.push_back(0);
    octets[2] = static_cast<std::uint8_t>(octets[2] + 8);
    if (octets[2] < 8) ++octets[1];
    const auto back = cfdp::read(octets);
    REQUIRE(back);
    CHECK(std::get<Nak>(back->content).requests.size() == nak_requests_max);
}

}  // namespace common_cfdp_test
