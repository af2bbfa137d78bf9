// SPDX-License-Identifier: Apache-2.0
#include "flight/file_delivery/recording_delivery.hpp"

#include "common/proximity_frame.hpp"
#include "common/space_packet.hpp"
#include "telemetry/station/recording_progress.hpp"
#include "telemetry/station/recording_receiver.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <algorithm>
#include <random>

namespace flight_recording_delivery_test {

using namespace aeolis;
using flight::RecordingDelivery;

namespace {

std::vector<std::uint8_t> recording_of(std::size_t packets) {
    std::vector<std::uint8_t> recording;
    std::mt19937 random{7};
    for (std::size_t i = 0; i < packets; ++i) {
        std::vector<std::uint8_t> packet(tm_overhead_octets + 20 + random() % 200);
        seal_tm_packet(packet, Apid{0x10}, static_cast<std::uint16_t>(i & 0x3FFF),
                       Sclk{1000.0 + static_cast<double>(i)}, 1);
        recording.insert(recording.end(), packet.begin(), packet.end());
    }
    return recording;
}

/// Rover and ground, with a link between them that loses frames.
struct Delivery {
    std::vector<std::uint8_t> recording = recording_of(6000);
    RecordingDelivery rover;
    telemetry::RecordingReceiver ground{0.0};
    std::vector<std::vector<std::uint8_t>> files;
    std::mt19937 random{11};
    double loss = 0.0, now_s = 0.0;
    bool closed = true;

    Ert now() const { return {static_cast<std::int64_t>(now_s * 1.0e6)}; }
    bool lost() { return std::uniform_real_distribution<>{}(random) < loss; }
    bool done() const { return rover.done({recording, closed}); }

    /// Some frames down, then what ground answers up.
    void second(int frames = 50) {
        now_s += 1.0;
        std::vector<std::uint8_t> pltu(pltu_octets_max);
        for (int i = 0; i < frames; ++i) {
            const std::size_t size = rover.next({recording, closed}, pltu);
            if (size == 0) break;
            const auto frame = read_pltu(std::span{pltu}.first(size));
            REQUIRE(frame);
            if (!lost())
                ground.receive(
                    frame->data.subspan(primary_header_octets), now(),
                    [&](std::span<const std::uint8_t> file) { files.emplace_back(file.begin(), file.end()); });
        }
        ground.pass(now(), true);
        for (const auto& up : ground.take_pltus())
            if (!lost()) rover.on(up);
        if (static_cast<int>(now_s) % 10 == 0) rover.repeat();
    }
    std::vector<std::uint8_t> received() const {
        std::vector<std::uint8_t> whole;
        for (const auto& file : files) whole.insert(whole.end(), file.begin(), file.end());
        return whole;
    }
};

}  // namespace

TEST_CASE("the recording arrives as files of whole packets, and both ends know it", "[file_delivery][R29]") {
    Delivery delivery;
    for (int i = 0; i < 100 && !delivery.done(); ++i) delivery.second();
    REQUIRE(delivery.done());
    CHECK(delivery.files.size() > 1);
    CHECK(delivery.received() == delivery.recording);
    CHECK(delivery.ground.received_octets() == delivery.recording.size());
    CHECK(delivery.ground.files_under_way() == 0);
}

TEST_CASE("how much of the recording is down is told by the size that the vehicle told, and whole is it by its last "
          "file alone",
          "[file_delivery][R29][R53]") {
    const auto& dictionary = tests::shipped_dictionary();
    const auto heard = [&](std::string_view event) {
        dictionary::Decoded decoded;
        decoded.packet = std::ranges::find(dictionary.events, event, &dictionary::Event::name)->packet;
        return decoded;
    };
    const auto telling = [&](std::string_view packet, std::string_view field, std::uint64_t octets) {
        dictionary::Decoded decoded;
        const auto found = std::ranges::find(dictionary.packets, packet, &dictionary::Packet::name);
        REQUIRE(found != dictionary.packets.end());
        decoded.packet = static_cast<std::size_t>(found - dictionary.packets.begin());
        decoded.raw.resize(found->fields.size());
        decoded.raw[dictionary::field_index(*found, field).value()] = octets;
        return decoded;
    };
    Delivery delivery;
    delivery.closed = false;
    telemetry::RecordingProgress progress{dictionary};
    const auto size = delivery.recording.size();
    for (int i = 0; i < 4; ++i) delivery.second();
    REQUIRE(delivery.ground.received_octets() > 0);
    CHECK(progress.fraction(delivery.ground) == 0.0);
    progress.note(telling("CommStatus", "nvm_used_octets", 1000));  // in cruise: far from what it will be
    CHECK(progress.fraction(delivery.ground) == 0.0);
    progress.note(heard("TOUCHDOWN"));
    progress.note(telling("CommStatus", "nvm_used_octets", 2 * size));
    progress.note(telling("CommStatus", "nvm_used_octets", size));
    CHECK(progress.fraction(delivery.ground) ==
          Approx(0.5 * static_cast<double>(delivery.ground.received_octets()) / static_cast<double>(size)));
    progress.note(telling("CommStatusB", "nvm_used_octets_b", size / 4));
    for (int i = 0; i < 100; ++i) delivery.second();
    CHECK(progress.fraction(delivery.ground) < 0.5);
    delivery.closed = true;
    while (!delivery.ground.whole()) {
        CHECK(progress.fraction(delivery.ground) < 1.0);
        delivery.second();
    }
    CHECK(progress.fraction(delivery.ground) == 1.0);
    for (int i = 0; i < 100 && !delivery.done(); ++i) delivery.second();
    REQUIRE(delivery.done());
    CHECK(delivery.received() == delivery.recording);
    for (const auto& file : delivery.files) CHECK(read_primary_header(file));
}

TEST_CASE("no file ends before the recording is closed, but whole ones go", "[file_delivery]") {
    Delivery delivery;
    delivery.closed = false;
    for (int i = 0; i < 100; ++i) delivery.second();
    CHECK_FALSE(delivery.done());
    const std::size_t before = delivery.files.size();
    CHECK(before == delivery.recording.size() / (RecordingDelivery::file_octets + 1));
    delivery.closed = true;
    for (int i = 0; i < 100 && !delivery.done(); ++i) delivery.second();
    CHECK(delivery.received() == delivery.recording);
}

TEST_CASE("a recording whose last whole file takes all that is left ends with an empty file, which is its last",
          "[file_delivery][R29]") {
    Delivery delivery;
    std::size_t end = 0;
    while (end < RecordingDelivery::file_octets)
        end += space_packet_octets(std::span{delivery.recording}.subspan(end)).value();
    delivery.recording.resize(end);
    delivery.closed = false;
    for (int i = 0; i < 50; ++i) delivery.second();
    CHECK(delivery.files.size() == 1);
    CHECK_FALSE(delivery.ground.whole());
    delivery.closed = true;
    for (int i = 0; i < 50 && !delivery.done(); ++i) delivery.second();
    REQUIRE(delivery.done());
    CHECK(delivery.ground.whole());
    CHECK(delivery.received() == delivery.recording);
}

TEST_CASE("the last file alone is not the whole recording", "[file_delivery][R29]") {
    Delivery delivery;
    telemetry::RecordingReceiver late{0.0};  // begins to listen when the first file has passed
    std::vector<std::uint8_t> pltu(pltu_octets_max);
    bool first_passed = false;
    for (int i = 0; i < 100'000; ++i) {
        const std::size_t size = delivery.rover.next({delivery.recording, true}, pltu);
        if (size == 0) break;
        const auto frame = read_pltu(std::span{pltu}.first(size));
        REQUIRE(frame);
        const auto octets = frame->data.subspan(primary_header_octets);
        const auto pdu = cfdp::read(octets);
        REQUIRE(pdu);
        first_passed |= pdu->header.sequence > 1;
        if (first_passed) late.receive(octets, Ert{}, [](auto) {});
    }
    REQUIRE(late.files_whole() >= 1);
    CHECK_FALSE(late.whole());
}

TEST_CASE("frames lost either way are sent again until all has arrived, each octet taken once", "[file_delivery]") {
    for (const unsigned seed : {1U, 2U, 3U, 4U, 5U}) {
        Delivery delivery;
        delivery.random.seed(seed);
        delivery.loss = 0.2;
        for (int i = 0; i < 2000 && !delivery.done(); ++i) delivery.second();
        REQUIRE(delivery.done());
        CHECK(delivery.ground.asked() > 0);
        auto received = delivery.files;
        std::size_t octets = 0;
        for (const auto& file : received) octets += file.size();
        CHECK(octets == delivery.recording.size());  // files may end in another order
    }
}

TEST_CASE("a rover that forgot what it was doing begins again, and ground gives no packet out twice",
          "[file_delivery]") {
    Delivery delivery;
    for (int i = 0; i < 9; ++i) delivery.second();
    delivery.rover = {};
    for (int i = 0; i < 200 && !delivery.done(); ++i) delivery.second();
    REQUIRE(delivery.done());
    CHECK(delivery.received() == delivery.recording);
}

TEST_CASE("PDUs that nobody of ours sent cost no file of the recording", "[file_delivery][station]") {
    const std::vector<std::uint8_t> octets(100, 0xAA);
    const auto forged = [](const cfdp::Header& header, const cfdp::Content& content) {
        const cfdp::Pdu pdu{header, content};
        std::vector<std::uint8_t> written(cfdp::octets_of(pdu));
        cfdp::write(pdu, written);
        return written;
    };
    const cfdp::Header first{.source = spacecraft_id, .sequence = 1, .destination = ground_entity};
    const std::vector<std::vector<std::uint8_t>> pdus{
        forged(first, cfdp::FileData{0, octets}),
        forged(first, cfdp::Eof{.condition = cfdp::Condition::cancel_received}),
        forged(first, cfdp::Metadata{.file_octets = 5}),
        forged({.source = spacecraft_id, .sequence = 1, .destination = 99}, cfdp::FileData{0, octets}),
        forged({.source = 5, .sequence = 1, .destination = ground_entity}, cfdp::FileData{0, octets}),
    };
    for (const auto& pdu : pdus) {
        Delivery delivery;
        delivery.ground.receive(pdu, Ert{0}, [](auto) { FAIL("no file came"); });
        for (int i = 0; i < 300 && !delivery.done(); ++i) delivery.second();
        REQUIRE(delivery.done());
        CHECK(delivery.ground.refused() > 0);
        CHECK(delivery.received().size() == delivery.recording.size());
        for (const auto& file : delivery.files)
            CHECK(std::search(delivery.recording.begin(), delivery.recording.end(), file.begin(), file.end()) !=
                  delivery.recording.end());
    }
}

TEST_CASE("octets from ground that are no answer change nothing", "[file_delivery]") {
    Delivery delivery;
    std::mt19937 random{3};
    for (int i = 0; i < 2000; ++i) {
        std::vector<std::uint8_t> octets(random() % 60);
        for (auto& octet : octets) octet = static_cast<std::uint8_t>(random());
        std::vector<std::uint8_t> pltu(pltu_octets_max);
        if (i % 2 && !octets.empty()) {
            pltu.resize(write_pltu({.spacecraft = spacecraft_id}, octets, pltu));
            octets = pltu;
        }
        delivery.rover.on(octets);
        delivery.ground.receive(octets, Ert{0}, [](auto) { FAIL("no file came"); });
    }
    for (int i = 0; i < 100 && !delivery.done(); ++i) delivery.second();
    CHECK(delivery.received() == delivery.recording);
}

TEST_CASE("ground sets no memory aside for files longer, or more, than the rover makes", "[file_delivery][station]") {
    telemetry::RecordingReceiver ground{0.0};
    const std::vector<std::uint8_t> octets(100, 1);
    const auto receive = [&](std::uint64_t sequence, const cfdp::Content& content) {
        const cfdp::Pdu pdu{{.source = spacecraft_id, .sequence = sequence, .destination = ground_entity}, content};
        std::vector<std::uint8_t> written(cfdp::octets_of(pdu));
        cfdp::write(pdu, written);
        ground.receive(written, Ert{0}, [](auto) { FAIL("no file is whole"); });
    };
    receive(1, cfdp::FileData{0x3FFFFF00, octets});
    receive(1, cfdp::Metadata{.file_octets = 0x40000000});
    receive(1, cfdp::Eof{.file_octets = 0x40000000});
    CHECK(ground.refused() == 3);
    CHECK(ground.files_under_way() == 0);
    for (std::uint64_t file = 1; file <= 1000; ++file) receive(file, cfdp::FileData{0, octets});
    CHECK(ground.files_under_way() == telemetry::RecordingReceiver::files_under_way_max);
    CHECK(ground.received_octets() == 100 * telemetry::RecordingReceiver::files_under_way_max);
}

}  // namespace flight_recording_delivery_test
