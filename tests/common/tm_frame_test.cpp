// SPDX-License-Identifier: Apache-2.0
#include "common/crc.hpp"
#include "common/tm_frame.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/octets.hpp"

namespace common_tm_frame_test {

using namespace aeolis;

namespace {

TransferFrame any_frame(std::mt19937& random, const std::vector<std::uint8_t>& data) {
    TransferFrame frame;
    frame.virtual_channel = static_cast<std::uint8_t>(random() % 8);
    frame.spacecraft = static_cast<std::uint16_t>(random() % 256);
    frame.count = random() % 256;
    frame.first_header_pointer =
        static_cast<std::uint16_t>(random() % 4 == 0 ? no_packet_begins : random() % data.size());
    frame.data = data;
    if (random() % 2 == 0) frame.control_field = static_cast<std::uint32_t>(random());
    return frame;
}

void check_same(const TransferFrame& back, const TransferFrame& frame) {
    CHECK(back.spacecraft == frame.spacecraft);
    CHECK(back.virtual_channel == frame.virtual_channel);
    CHECK(back.count == frame.count);
    CHECK(back.first_header_pointer == frame.first_header_pointer);
    CHECK(back.control_field == frame.control_field);
    CHECK(test::copy_of(back.data) == test::copy_of(frame.data));
}

}  // namespace

TEST_CASE("a published AOS frame reads as published", "[common]") {
    const auto known =
        test::hex("6ac1000157000000ea00018d2145000188000040003f118cc3c0a86428c0a8c8287530753101740000888888888888887788"
                  "8888778888888888778888888877775544444444334433444455556655888888888888776677666677667766666655556666"
                  "667788888877888877777777776677777777778888888877887793fd");
    const auto frame = read_aos_frame(known, {});
    REQUIRE(frame);
    CHECK(frame->spacecraft == 171);
    CHECK(frame->virtual_channel == 1);
    CHECK(frame->count == 343);
    CHECK(frame->first_header_pointer == 0);
    std::vector<std::uint8_t> written(known.size());
    write_aos_frame(*frame, true, written);
    CHECK(written == known);
}

TEST_CASE("a published TM frame reads as published", "[common]") {
    auto known = test::hex("2f61000018000cd2c000001a10031916925e92");
    const auto put = [&](std::size_t zeros, const char* octets) {
        known.resize(known.size() + zeros);
        for (const std::uint8_t octet : test::hex(octets)) known.push_back(octet);
    };
    put(18, "89e407ffc0");
    put(1, "0427");
    put(1062, "c94801000000bbd6");
    REQUIRE(known.size() == 1115);
    const auto frame = read_tm_frame(known, {});
    REQUIRE(frame);
    CHECK(frame->spacecraft == 758);
    CHECK(frame->virtual_channel == 0);
    CHECK(frame->first_header_pointer == 0);
    CHECK(frame->control_field == 0x01000000);
    known[500] ^= 1;
    CHECK(read_tm_frame(known, {}).why() == Malformed::bad_checksum);
}

TEST_CASE("every TM and AOS frame reads back", "[common]") {
    std::mt19937 random{7};
    for (int round = 0; round < 2000; ++round) {
        const auto data = test::random_octets(random, 1 + random() % 600);
        const TransferFrame frame = any_frame(random, data);
        const bool crc = random() % 2 == 0;
        const std::size_t after = (crc ? 2 : 0) + (frame.control_field ? 4 : 0);
        std::vector<std::uint8_t> tm(6 + data.size() + after);
        if (tm.size() > 8) {
            write_tm_frame(frame, static_cast<std::uint8_t>(round), crc, tm);
            const auto back = read_tm_frame(tm, {.crc = crc});
            REQUIRE(back);
            check_same(*back, frame);
        }
        std::vector<std::uint8_t> aos(8 + data.size() + after);
        write_aos_frame(frame, crc, aos);
        const auto back = read_aos_frame(aos, {.crc = crc, .control_field = frame.control_field.has_value()});
        REQUIRE(back);
        check_same(*back, frame);
        CHECK(read_tm_frame(aos, {.crc = crc}).why() == Malformed::other_version);
        CHECK(read_aos_frame(tm.size() > 8 ? tm : std::vector<std::uint8_t>(20), {.crc = crc}).why() ==
              Malformed::other_version);
    }
}

TEST_CASE("a TM frame's secondary header and an AOS frame's insert zone are stepped over", "[common]") {
    // Flag of a secondary header; its first octet says that three more follow.
    const auto tm_octets = test::hex("2f60 0000 9800 03aabbcc 0102030405");
    const auto tm = read_tm_frame(tm_octets, {.crc = false});
    REQUIRE(tm);
    CHECK(test::copy_of(tm->data) == test::hex("0102030405"));
    const auto aos_octets = test::hex("6ac100015700 eeee 0001 01020304");
    const auto aos = read_aos_frame(aos_octets, {.crc = false, .insert_octets = 2});
    REQUIRE(aos);
    CHECK(aos->first_header_pointer == 1);
    CHECK(test::copy_of(aos->data) == test::hex("01020304"));
}

TEST_CASE("a TM frame whose synchronisation flag is set holds data that are not packets", "[common][frames]") {
    const auto octets = test::hex("2f60000058ff000000010203");  // its pointer says nothing
    const auto frame = read_tm_frame(octets, {.crc = false});
    REQUIRE(frame);
    CHECK_FALSE(frame->packets);
    CHECK(test::copy_of(frame->data) == test::hex("000000010203"));
    CHECK(read_tm_frame(test::hex("2f60000018000000010203"), {.crc = false})->packets);
}

TEST_CASE("an AOS frame's header is corrected by its error control before anything of it is believed",
          "[common][frames]") {
    auto octets = test::hex("6ac100015700 dd07 0001 01020304 0000");
    const std::uint16_t crc = crc16(std::span{octets}.first(octets.size() - 2));
    octets[octets.size() - 2] = static_cast<std::uint8_t>(crc >> 8);
    octets.back() = static_cast<std::uint8_t>(crc & 0xFF);
    const FrameAgreement agreed{.header_error_control = true};
    REQUIRE(read_aos_frame(octets, agreed));
    CHECK(read_aos_frame(octets, agreed)->corrected_symbols == 0);
    auto wrong = octets;
    wrong[1] ^= 0x06;  // virtual channel
    CHECK(read_aos_frame(wrong, {}).why() == Malformed::bad_checksum);
    const auto corrected = read_aos_frame(wrong, agreed);
    REQUIRE(corrected);
    CHECK(corrected->virtual_channel == 1);
    CHECK(corrected->spacecraft == 171);
    CHECK(corrected->corrected_symbols == 1);
    wrong[0] ^= 0x11;
    CHECK(read_aos_frame(wrong, agreed).why() == Malformed::bad_field);
}

TEST_CASE("a frame whose fields point outside it is refused with the reason", "[common]") {
    CHECK(read_tm_frame(test::hex("2f60000018"), {}).why() == Malformed::too_short);
    CHECK(read_tm_frame(test::hex("2f60000018ff010203"), {.crc = false}).why() == Malformed::bad_field);
    CHECK(read_tm_frame(test::hex("2f60000098003f010203"), {.crc = false}).why() == Malformed::bad_field);
    CHECK(read_tm_frame(test::hex("2f61000018000102 03"), {.crc = false}).why() == Malformed::too_short);
    CHECK(read_aos_frame(test::hex("6ac100015700 0004 01020304"), {.crc = false}).why() == Malformed::bad_field);
    CHECK(read_aos_frame(test::hex("6ac100015700 0004 01"), {.crc = false, .insert_octets = 9}).why() ==
          Malformed::too_short);
    CHECK(read_tm_frame(std::vector<std::uint8_t>(transfer_frame_octets_max + 1), {.crc = false}).why() ==
          Malformed::too_long);
}

}  // namespace common_tm_frame_test
