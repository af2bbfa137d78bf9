// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/autocoder/flight_header.hpp"

#include "common/bytes.hpp"
#include "common/space_packet.hpp"
#include "generated/dictionary_flight.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/mission_copy.hpp"

#include <limits>
#include <vector>

namespace dictionaries_flight_header_test {

// The encoders that flight was built with against the layout that the ground loads.
using namespace aeolis;
namespace packet = aeolis::flight::packet;
namespace evr = aeolis::flight::evr;
namespace command = aeolis::flight::command;

namespace {

const dictionary::Dictionary& msl() {
    static const dictionary::Loaded loaded = dictionary::load(tests::shipped_mission);
    REQUIRE(loaded.dictionary);
    return *loaded.dictionary;
}

const dictionary::Field& field(const dictionary::Packet& packet, std::string_view name) {
    for (const auto& one : packet.fields)
        if (one.name == name) return one;
    FAIL(std::string{name} + " is no field of " + packet.name);
    return packet.fields.front();
}

/// A whole packet as flight encodes it, and fields of it as the ground finds them.
template <typename P>
class Encoded {
  public:
    Encoded(const P& value, std::string_view name) : layout_(*msl().packet(name)), octets_(P::octets, 0) {
        CHECK(layout_.octets == P::octets);
        CHECK(layout_.apid == P::apid);
        BitWriter out{std::span{octets_}.subspan(tm_data_offset_octets, P::octets - tm_overhead_octets)};
        value.encode(out);
        CHECK(out.position_bits() == (P::octets - tm_overhead_octets) * 8);
    }

    std::uint64_t raw(std::string_view name) const {
        const auto& f = field(layout_, name);
        return read_bits(octets_, f.position_bits, f.type.bits);
    }
    double real(std::string_view name) const {
        const auto& f = field(layout_, name);
        CHECK(f.type.encoding == dictionary::Encoding::ieee754);
        return f.type.bits == 32 ? double{std::bit_cast<float>(static_cast<std::uint32_t>(raw(name)))}
                                 : std::bit_cast<double>(raw(name));
    }
    bool defined(std::string_view name) const {
        const auto& f = field(layout_, name);
        REQUIRE(f.validity_bit);
        return read_bits(octets_, *f.validity_bit, 1) == 1;
    }
    const std::vector<std::uint8_t>& octets() const { return octets_; }

  private:
    const dictionary::Packet& layout_;
    std::vector<std::uint8_t> octets_;
};

}  // namespace

TEST_CASE("flight was built from the dictionary that the ground loads", "[dictionary][autocoder][R48]") {
    CHECK(flight::dictionary_id == msl().id);
    CHECK(flight::timeline_version == msl().timeline_version);
    CHECK(flight::timepoint_count == msl().timeline.size());
    CHECK(flight::anchor_count == msl().anchors.size());
    CHECK(msl().anchors[flight::anchor::touchdown.value].name == "touchdown");
    CHECK(msl().timeline[flight::timepoint::parachute_deploy.value].name == "parachute_deploy");
    CHECK(msl().tones[flight::tone::touchdown.value].name == "touchdown");
    CHECK(tests::text_of(std::filesystem::path{AEOLIS_BINARY_DIR} / "generated" / "dictionary_flight.hpp") ==
          dictionary::autocoder::flight_header(msl()));
}

TEST_CASE("an encoded packet holds each field where the ground looks for it", "[dictionary][autocoder][R48]") {
    packet::EdlStatus status;
    status.edl_phase = flight::EdlPhase::sky_crane;
    status.parameters_received = true;
    status.seconds_to_entry_s = -407.25;
    status.edl_cycle_count = 0xDEADBEEF;
    status.reset_count = 3;
    status.fault_inhibit = true;
    status.computer_role = flight::ComputerRole::second_chance;
    const Encoded encoded{status, "EdlStatus"};
    CHECK(encoded.raw("edl_phase") == 12);
    CHECK(encoded.raw("edl_enabled") == 0);
    CHECK(encoded.raw("parameters_received") == 1);
    CHECK(encoded.raw("late_cruise") == 0);
    CHECK(encoded.defined("seconds_to_entry_s"));
    CHECK(encoded.real("seconds_to_entry_s") == -407.25);
    CHECK(encoded.raw("edl_cycle_count") == 0xDEADBEEF);
    CHECK(encoded.raw("reset_count") == 3);
    CHECK(encoded.raw("fault_inhibit") == 1);
    CHECK(encoded.raw("computer_role") == 1);

    packet::GncNavigation navigation;
    navigation.nav_position_z_m = -272000.125;
    navigation.angle_of_attack_deg = -16.5F;
    const Encoded navigated{navigation, "GncNavigation"};
    CHECK(navigated.real("nav_position_z_m") == -272000.125);
    CHECK(navigated.real("angle_of_attack_deg") == -16.5);
    CHECK(navigated.real("altitude_m") == 0.0);

    packet::Explanation explanation;
    explanation.decision = flight::Decision::tone;
    explanation.verdict = flight::ExplanationVerdict::dropped;
    explanation.condition_count = 4;
    explanation.condition_4 = flight::Quantity::altitude_m;
    explanation.bound_4 = 1660.0;
    explanation.comparison_4 = flight::Comparison::gt;
    explanation.holds_4 = true;
    const Encoded explained{explanation, "Explanation"};
    CHECK(explained.raw("verdict") == 5);
    CHECK(explained.real("bound_4") == 1660.0);
    CHECK(explained.raw("comparison_4") == 4);
    CHECK(explained.raw("holds_4") == 1);
    CHECK(explained.raw("holds_3") == 0);
}

TEST_CASE("binary data of a packet are octets in their place, and no field", "[dictionary][autocoder][R30][R48]") {
    packet::DataProduct product;
    product.product_crc = 0xBEEF;
    product.content.front() = 0x12;
    product.content.back() = 0x34;
    const Encoded encoded{product, "DataProduct"};
    const dictionary::Packet& layout = *msl().packet("DataProduct");
    REQUIRE(layout.content);
    CHECK(layout.content->name == "content");
    CHECK(layout.content->octets == product.content.size());
    CHECK(encoded.raw("product_crc") == 0xBEEF);
    CHECK(encoded.octets()[layout.content->offset_octets] == 0x12);
    CHECK(encoded.octets()[layout.content->offset_octets + layout.content->octets - 1] == 0x34);
    for (const auto& one : layout.fields) CHECK(one.name != "content");
}

TEST_CASE("an undefined value is a validity bit, never a number", "[dictionary][autocoder][R13]") {
    packet::TimelineStatus status;
    status.next_minimum_sclk = 1.0;
    const Encoded encoded{status, "TimelineStatus"};
    CHECK_FALSE(encoded.defined("next_desired_sclk"));
    CHECK(encoded.defined("next_minimum_sclk"));
    CHECK_FALSE(encoded.defined("touchdown_anchor_sclk"));
    CHECK(encoded.real("next_minimum_sclk") == 1.0);
}

TEST_CASE("an encoded event begins with its id", "[dictionary][autocoder]") {
    const Encoded refused{evr::COMMAND_REFUSED{0x0103, 7, flight::CommandRefusal::too_late}, "COMMAND_REFUSED"};
    CHECK(refused.raw("event_id") == evr::COMMAND_REFUSED::id.value);
    CHECK(refused.raw("event_id") == msl().event("COMMAND_REFUSED")->id.value);
    CHECK(refused.raw("opcode") == 0x0103);
    CHECK(refused.raw("count") == 7);
    CHECK(refused.raw("reason") == 6);
    CHECK(evr::COMMAND_REFUSED::level == flight::EventLevel::warning_hi);
    CHECK(Encoded{evr::FLYAWAY_END{}, "FLYAWAY_END"}.raw("event_id") == msl().event("FLYAWAY_END")->id.value);
}

TEST_CASE("a command decodes as the ground lays it out, or not at all", "[dictionary][autocoder][R44][R48]") {
    const dictionary::Command& layout = *msl().command("EDL_SET_TIMEPOINT_OFFSET");
    using Decoder = command::EDL_SET_TIMEPOINT_OFFSET;
    REQUIRE(layout.argument_octets == Decoder::argument_octets);
    CHECK(layout.opcode == Decoder::opcode);
    const auto encode = [&](std::uint16_t timepoint, double desired_s, double minimum_s) {
        std::vector<std::uint8_t> octets(layout.argument_octets, 0);
        BitWriter out{octets};
        out.put(timepoint, 16);
        out.put_double(desired_s);
        out.put_double(minimum_s);
        return octets;
    };
    CHECK(layout.arguments[1].position_bits == 16);
    CHECK(layout.arguments[2].position_bits == 80);
    CHECK(Decoder::decode(encode(5, -2.5, 0.0)) == Decoder{5, -2.5, 0.0});
    CHECK(Decoder::decode(encode(999, 1.0e6, 0.0)));
    CHECK_FALSE(Decoder::decode(encode(1000, 0.0, 0.0)));
    CHECK_FALSE(Decoder::decode(encode(5, 1.0e6 + 0.015625, 0.0)));
    CHECK_FALSE(Decoder::decode(encode(5, std::numeric_limits<double>::quiet_NaN(), 0.0)));
    CHECK_FALSE(Decoder::decode(encode(5, 0.0, -std::numeric_limits<double>::infinity())));
    auto shorter = encode(5, 0.0, 0.0);
    shorter.pop_back();
    CHECK_FALSE(Decoder::decode(shorter));
    CHECK(command::NO_OP::decode({}));
    CHECK_FALSE(command::NO_OP::decode(std::vector<std::uint8_t>{0}));
}

}  // namespace dictionaries_flight_header_test
