// SPDX-License-Identifier: Apache-2.0
#include "telemetry/decoded_packet.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/small_dictionary.hpp"

namespace decoded_packet_test {

using namespace aeolis;
using namespace aeolis::telemetry;
using aeolis::tests::PacketFiller;

TEST_CASE("one decode gives a packet's values and its event in words, or why it was refused", "[decommutator][R48]") {
    const auto dictionary = tests::small_dictionary();
    const PacketDecoder decoder{dictionary};
    DecodedPacket packet;

    decoder.decode(PacketFiller{dictionary, "PARACHUTE_DEPLOY"}.real("speed_mps", 404.59).seal(), packet);
    REQUIRE(packet.event != nullptr);
    CHECK(packet.event->name == "PARACHUTE_DEPLOY");
    CHECK(packet.text == "Mortar at 404.6 m/s, {oddity}, undefined m");
    CHECK(packet.refusal.empty());

    decoder.decode(PacketFiller{dictionary, "Status"}.seal(), packet);
    CHECK(dictionary.packets[packet.content.packet].name == "Status");
    CHECK(packet.event == nullptr);  // nothing is left of the packet before
    CHECK(packet.text.empty());

    const std::vector<std::uint8_t> no_packet{1, 2, 3};
    decoder.decode(no_packet, packet);
    CHECK(packet.refusal == "not_a_packet");

    decoder.decode(PacketFiller{dictionary, "Status"}.seal(), packet);
    CHECK(packet.refusal.empty());
}

}  // namespace decoded_packet_test
