#include "flight/edl_comm/proximity_framer.hpp"
#include "telemetry/proximity_packets.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/octets.hpp"

#include <type_traits>

using namespace aeolis;
using namespace aeolis::flight;

namespace {

using Octets = std::vector<std::uint8_t>;

Octets packet_of(std::size_t octets, std::uint16_t count) {
    Octets packet(octets, 0x33);
    seal_tm_packet(packet, Apid{0x20}, count, Sclk{1.0}, 1);
    return packet;
}

} // namespace

static_assert(std::is_trivially_copyable_v<ProximityFramer>); // part of a computer, which is copied as a value

TEST_CASE("what is framed on board comes out on ground packet by packet, without a gap", "[flight]") {
    std::mt19937 random{1};
    ProximityFramer framer{76};
    telemetry::PltuReceiver receiver;
    telemetry::ProximityPackets packets;
    std::vector<Octets> sent, received;
    for (std::uint16_t cycle = 0; cycle < 1000; ++cycle) {
        Octets together;
        const std::size_t count = random() % 8;
        for (std::size_t i = 0; i < count; ++i) {
            sent.push_back(packet_of(tm_overhead_octets + random() % (packet_octets_max - tm_overhead_octets), cycle));
            together.insert(together.end(), sent.back().begin(), sent.back().end());
        }
        Octets framed(ProximityFramer::framed_octets_max(together.size(), count));
        framed.resize(framer.frame(together, framed));
        receiver.receive(framed);
        while (const auto frame = receiver.next()) {
            packets.add(*frame);
            while (const auto packet = packets.next()) received.push_back(test::copy_of(*packet));
        }
    }
    CHECK(received == sent);
    CHECK(receiver.counters().gaps == 0);
    CHECK(receiver.counters().skipped_octets == 0);
    CHECK(packets.counters().unreadable_octets == 0);
}

TEST_CASE("small packets share a frame, and nothing makes no frame", "[flight]") {
    ProximityFramer framer{76};
    Octets together;
    for (std::uint16_t i = 0; i < 10; ++i) {
        const Octets packet = packet_of(100, i);
        together.insert(together.end(), packet.begin(), packet.end());
    }
    Octets framed(2000);
    CHECK(framer.frame(together, framed) == 1000 + pltu_overhead_octets);
    CHECK(framer.frame({}, framed) == 0);
}

TEST_CASE("what is no packet is a bug, found before it is sent", "[flight]") {
    ProximityFramer framer{76};
    Octets framed(2000);
    CHECK_THROWS_AS(framer.frame(Octets(20, 0xFF), framed), CheckFailed);
    const Octets packet = packet_of(100, 1);
    CHECK_THROWS_AS(framer.frame(std::span{packet}.first(50), framed), CheckFailed);
}
