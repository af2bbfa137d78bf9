// SPDX-License-Identifier: Apache-2.0
#include "telemetry/decommutator.hpp"

#include "common/crc.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"
#include "tests/support/small_dictionary.hpp"

#include <limits>
#include <random>

namespace telemetry_decommutator_test {

using namespace aeolis;
using namespace aeolis::telemetry;
using aeolis::tests::PacketFiller;
using aeolis::tests::small_dictionary;

namespace {

std::optional<double> value(const dictionary::Dictionary& dictionary, const Decoded& decoded, std::string_view name) {
    return decoded.value.at(*field_index(dictionary.packets[decoded.packet], name));
}

void renew_crc(std::vector<std::uint8_t>& packet) {
    const auto crc = crc16(std::span{packet}.first(packet.size() - 2));
    packet[packet.size() - 2] = static_cast<std::uint8_t>(crc >> 8);
    packet[packet.size() - 1] = static_cast<std::uint8_t>(crc & 0xFF);
}

}  // namespace

TEST_CASE("each field of a packet comes out as its type says", "[decommutator][R48]") {
    const auto dictionary = small_dictionary();
    const Decommutator decommutator{dictionary};
    const auto packet = PacketFiller{dictionary, "Status"}
                            .real("speed_mps", 404.5)
                            .real("altitude_m", 10123.25)
                            .raw("late_cruise", 1)
                            .raw("edl_phase", 1)
                            .raw("temperature_K", 0xFFE)
                            .seal(77, Sclk{397'500'001.015625});

    Decoded decoded;
    REQUIRE_FALSE(decommutator.decode(packet, decoded));
    CHECK(dictionary.packets[decoded.packet].name == "Status");
    CHECK(decoded.header.primary.count == 77);
    CHECK(decoded.header.time == Sclk{397'500'001.015625});
    CHECK(value(dictionary, decoded, "speed_mps") == 404.5);
    CHECK(value(dictionary, decoded, "altitude_m") == 10123.25);
    CHECK(value(dictionary, decoded, "parameters_received") == 0.0);
    CHECK(value(dictionary, decoded, "late_cruise") == 1.0);
    CHECK(value(dictionary, decoded, "edl_phase") == 1.0);
    CHECK(decoded.raw.at(*field_index(dictionary.packets[decoded.packet], "temperature_K")) == 0xFFE);
    CHECK(value(dictionary, decoded, "temperature_K") == 250.0 + 0.5 * -2.0 + 0.25 * 4.0);
}

TEST_CASE("a field is undefined when its validity bit is zero, never NaN or 0", "[decommutator]") {
    const auto dictionary = small_dictionary();
    const Decommutator decommutator{dictionary};
    Decoded decoded;
    REQUIRE_FALSE(decommutator.decode(PacketFiller{dictionary, "Status"}.seal(), decoded));
    CHECK_FALSE(value(dictionary, decoded, "altitude_m"));

    const double nan = std::numeric_limits<double>::quiet_NaN();
    REQUIRE_FALSE(decommutator.decode(
        PacketFiller{dictionary, "Status"}.real("altitude_m", nan).real("speed_mps", nan).seal(), decoded));
    CHECK_FALSE(value(dictionary, decoded, "altitude_m"));
    CHECK_FALSE(value(dictionary, decoded, "speed_mps"));
}

TEST_CASE("packets of one APID are told apart by their event id", "[decommutator]") {
    const auto dictionary = small_dictionary();
    const Decommutator decommutator{dictionary};
    Decoded decoded;
    for (const char* name : {"COMMAND_ACCEPTED", "COMMAND_REFUSED", "COMMAND_EXECUTED", "PARACHUTE_DEPLOY"}) {
        REQUIRE_FALSE(decommutator.decode(PacketFiller{dictionary, name}.seal(), decoded));
        CHECK(dictionary.packets[decoded.packet].name == name);
    }
}

TEST_CASE("a packet that cannot be decoded says why", "[decommutator]") {
    auto dictionary = small_dictionary();
    const Decommutator decommutator{dictionary};
    Decoded decoded;
    const auto good = PacketFiller{dictionary, "Status"}.seal();

    CHECK(decommutator.decode({}, decoded) == Refusal::not_a_packet);
    CHECK(decommutator.decode(std::span{good}.first(good.size() - 1), decoded) == Refusal::not_a_packet);

    auto telecommand = good;
    telecommand[0] |= 0x10;
    renew_crc(telecommand);
    CHECK(decommutator.decode(telecommand, decoded) == Refusal::not_a_packet);

    auto unknown = good;
    unknown[1] ^= 0x40;
    renew_crc(unknown);
    CHECK(decommutator.decode(unknown, decoded) == Refusal::unknown_apid);

    auto event = PacketFiller{dictionary, "COMMAND_ACCEPTED"}.seal();
    event[tm_data_offset_octets] = 0x77;
    renew_crc(event);
    CHECK(decommutator.decode(event, decoded) == Refusal::unknown_event);

    std::vector<std::uint8_t> empty_event(tm_overhead_octets);
    seal_tm_packet(empty_event, tests::event_apid, 0, {}, dictionary.id);
    CHECK(decommutator.decode(empty_event, decoded) == Refusal::wrong_length);

    std::vector<std::uint8_t> longer(good.size() + 1);
    seal_tm_packet(longer, tests::status_apid, 0, {}, dictionary.id);
    CHECK(decommutator.decode(longer, decoded) == Refusal::wrong_length);

    dictionary.id = 0x1235;
    CHECK(decommutator.decode(PacketFiller{dictionary, "Status"}.seal(), decoded) == Refusal::other_dictionary);
}

TEST_CASE("every change of one or two bits of a packet is found", "[decommutator][property]") {
    const auto dictionary = small_dictionary();
    const Decommutator decommutator{dictionary};
    auto packet = PacketFiller{dictionary, "Status"}.real("speed_mps", 404.5).seal(5);
    Decoded decoded;
    const std::size_t bits = packet.size() * 8;
    const auto flip = [&](std::size_t bit) { packet[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8); };
    std::size_t missed = 0;
    for (std::size_t first = 0; first < bits; ++first) {
        flip(first);
        if (!decommutator.decode(packet, decoded)) ++missed;
        for (std::size_t second = first + 1; second < bits; ++second) {
            flip(second);
            if (!decommutator.decode(packet, decoded)) ++missed;
            flip(second);
        }
        flip(first);
    }
    CHECK(missed == 0);
    CHECK_FALSE(decommutator.decode(packet, decoded));
}

TEST_CASE("whatever the octets are, each packet is decoded or refused", "[decommutator][property]") {
    const auto dictionary = small_dictionary();
    const Decommutator decommutator{dictionary};
    std::mt19937 random{20120806};
    Decoded decoded;
    std::size_t refused = 0, accepted = 0;
    for (int round = 0; round < 50'000; ++round) {
        std::vector<std::uint8_t> octets(random() % 120);
        for (auto& octet : octets) octet = static_cast<std::uint8_t>(random());
        // Half of them are sealed as packets of ours with random contents, so that every field sees every bit pattern.
        if (round % 2 == 0 && octets.size() >= tm_overhead_octets) {
            const auto& wanted = dictionary.packets[random() % dictionary.packets.size()];
            if (random() % 4 != 0) octets.resize(wanted.octets, static_cast<std::uint8_t>(random()));
            if (wanted.event && octets.size() >= tm_overhead_octets + 2) {
                octets[tm_data_offset_octets] = 0;
                octets[tm_data_offset_octets + 1] = static_cast<std::uint8_t>(wanted.event->value);
            }
            seal_tm_packet(octets, wanted.apid, 0, {}, dictionary.id);
        }
        ++(decommutator.decode(octets, decoded) ? refused : accepted);
    }
    CHECK(refused + accepted == 50'000);
    CHECK(refused > 10'000);
    CHECK(accepted > 10'000);
}

TEST_CASE("decoding again needs no more memory", "[decommutator]") {
    const auto dictionary = small_dictionary();
    const Decommutator decommutator{dictionary};
    Decoded decoded;
    REQUIRE_FALSE(decommutator.decode(PacketFiller{dictionary, "Explanation"}.seal(), decoded));
    const auto* raw = decoded.raw.data();
    const auto* values = decoded.value.data();
    for (const auto& packet : dictionary.packets)
        REQUIRE_FALSE(decommutator.decode(PacketFiller{dictionary, packet.name}.seal(), decoded));
    CHECK(decoded.raw.data() == raw);
    CHECK(decoded.value.data() == values);
}

TEST_CASE("every packet of the shipped dictionary is decoded, whatever its fields hold", "[decommutator][R48]") {
    const auto& dictionary = tests::shipped_dictionary();
    const Decommutator decommutator{dictionary};
    std::mt19937 random{137};
    Decoded decoded;
    for (std::size_t index = 0; index < dictionary.packets.size(); ++index) {
        const auto& packet = dictionary.packets[index];
        for (int round = 0; round < 100; ++round) {
            std::vector<std::uint8_t> octets(packet.octets);
            for (auto& octet : octets) octet = static_cast<std::uint8_t>(random());
            if (packet.event) {
                octets[tm_data_offset_octets] = static_cast<std::uint8_t>(packet.event->value >> 8);
                octets[tm_data_offset_octets + 1] = static_cast<std::uint8_t>(packet.event->value & 0xFF);
            }
            seal_tm_packet(octets, packet.apid, 0, {}, dictionary.id);
            INFO(packet.name);
            REQUIRE_FALSE(decommutator.decode(octets, decoded));
            REQUIRE(decoded.packet == index);
            for (std::size_t i = 0; i < packet.fields.size(); ++i)
                REQUIRE(decoded.raw[i] ==
                        read_bits(octets, packet.fields[i].position_bits, packet.fields[i].type.bits));
        }
    }
}

}  // namespace telemetry_decommutator_test
