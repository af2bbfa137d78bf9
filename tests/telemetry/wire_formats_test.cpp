// SPDX-License-Identifier: Apache-2.0
// Our packets as a program of others reads them: tshark, from a capture, where it is installed.
#include "common/proximity_frame.hpp"
#include "common/space_packet.hpp"
#include "flight/file_delivery/recording_delivery.hpp"
#include "telemetry/station/recording_receiver.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>
#include <vector>

namespace telemetry_wire_formats_test {

using namespace aeolis;

namespace {

using Octets = std::vector<std::uint8_t>;

void add_number(Octets& to, std::uint32_t number, int octets, bool least_first) {
    for (int i = 0; i < octets; ++i)
        to.push_back(static_cast<std::uint8_t>(number >> 8 * (least_first ? i : octets - 1 - i)));
}

/// A capture of one UDP datagram to `port` for each of `payloads`: pcap, raw IPv4.
Octets capture(const std::vector<Octets>& payloads, std::uint16_t port) {
    Octets file;
    for (const std::uint32_t number : {0xA1B2C3D4U, 0x00040002U, 0U, 0U, 65535U, 101U})
        add_number(file, number, 4, true);
    for (const Octets& payload : payloads) {
        const auto octets = static_cast<std::uint32_t>(payload.size() + 28);
        for (const std::uint32_t number : {1U, 0U, octets, octets}) add_number(file, number, 4, true);
        add_number(file, 0x4500U, 2, false);
        add_number(file, octets, 2, false);
        for (const std::uint32_t number : {0U, 0x40110000U, 0x7F000001U, 0x7F000001U})
            add_number(file, number, 4, false);
        for (const std::uint32_t number : {40000U, std::uint32_t{port}, octets - 20, 0U})
            add_number(file, number, 2, false);
        file.insert(file.end(), payload.begin(), payload.end());
    }
    return file;
}

/// A line a packet with those fields, as tshark reads each of `packets` from a capture.
std::string fields_of(const std::vector<Octets>& packets, const std::string& fields) {
    const auto file = std::filesystem::temp_directory_path() / ("aeolis-" + std::to_string(::getpid()) + ".pcap");
    const auto octets = capture(packets, 50000);
    std::ofstream{file, std::ios::binary}.write(reinterpret_cast<const char*>(octets.data()),
                                                static_cast<std::streamsize>(octets.size()));
    std::FILE* pipe =
        popen(("tshark -r '" + file.string() + "' -d udp.port==50000,ccsds -T fields -E separator=, -E occurrence=f " +
               fields + " 2>/dev/null")
                  .c_str(),
              "r");
    REQUIRE(pipe != nullptr);
    std::string read;
    std::array<char, 256> piece{};
    while (std::fgets(piece.data(), static_cast<int>(piece.size()), pipe) != nullptr) read += piece.data();
    CHECK(pclose(pipe) == 0);
    std::filesystem::remove(file);
    return read;
}

bool tshark_is_here() {
    const bool here = std::system("command -v tshark >/dev/null 2>&1") == 0;
    if (!here) std::printf("SKIPPED: tshark is not installed\n");
    return here;
}

}  // namespace

TEST_CASE("tshark reads the primary headers of our packets as we wrote them", "[telemetry][wire]") {
    if (!tshark_is_here()) return;
    const auto& ours = tests::shipped_dictionary();
    std::vector<Octets> packets;
    std::string expected;
    for (const char* name : {"EdlStatus", "TimelineStatus", "GncNavigation"}) {
        const auto* kind = ours.packet(name);
        REQUIRE(kind != nullptr);
        Octets packet(kind->octets);
        const auto count = static_cast<std::uint16_t>(1000 + packets.size());
        seal_tm_packet(packet, kind->apid, count, Sclk{5.0}, ours.id);
        expected += std::to_string(kind->apid.value) + "," + std::to_string(count) + "," +
                    std::to_string(packet.size() - 7) + "\n";
        packets.push_back(std::move(packet));
    }
    CHECK(fields_of(packets, "-e ccsds.apid -e ccsds.seqnum -e ccsds.length") == expected);
}

TEST_CASE("tshark reads the files in which the recording comes down, and what ground asks for, as we wrote them",
          "[telemetry][wire][file_delivery]") {
    if (!tshark_is_here()) return;
    Octets recording(2000);
    seal_tm_packet(std::span{recording}.first(1000), Apid{0x10}, 0, Sclk{5.0}, 1);
    seal_tm_packet(std::span{recording}.subspan(1000), Apid{0x10}, 1, Sclk{5.0}, 1);
    flight::RecordingDelivery rover;
    telemetry::RecordingReceiver ground{0.0};
    std::vector<Octets> packets;
    const auto packet_of = [](std::span<const std::uint8_t> pltu) {
        const auto frame = read_pltu(pltu);
        REQUIRE(frame);
        return Octets{frame->data.begin(), frame->data.end()};
    };
    Octets pltu(pltu_octets_max);
    while (const std::size_t size = rover.next({recording, true}, pltu)) {
        packets.push_back(packet_of(std::span{pltu}.first(size)));
        if (packets.size() == 3) continue;  // lost: octets 900 to 1800
        ground.receive(std::span{packets.back()}.subspan(primary_header_octets), Ert{0}, [](auto) {});
    }
    const auto answers = ground.take_pltus();
    for (const auto& up : answers) packets.push_back(packet_of(up));
    // Metadata, three pieces of the file, its end; then ground's acknowledgement and what it asks for.
    const std::string expected = "2045,76,1,1,0,0,7,,2000,,\n"
                                 "2045,76,1,1,1,0,,0,,,\n"
                                 "2045,76,1,1,1,0,,900,,,\n"
                                 "2045,76,1,1,1,0,,1800,,,\n"
                                 "2045,76,1,1,0,0,4,,2000,,\n"
                                 "2045,76,1,1,0,1,6,,,,\n"
                                 "2045,76,1,1,0,1,8,,,900,1800\n";
    CHECK(fields_of(packets, "-e ccsds.apid -e cfdp.srcid -e cfdp.transeqnum -e cfdp.dstid -e cfdp.pdu_type -e "
                             "cfdp.direction -e cfdp.fdtype "
                             "-e cfdp.offset -e cfdp.file_size -e cfdp.nak_st_scope -e cfdp.nak_sp_scope") == expected);
}

}  // namespace telemetry_wire_formats_test
