// SPDX-License-Identifier: Apache-2.0
#include "flight/file_delivery/cfdp_source.hpp"
#include "telemetry/cfdp_receiver.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/octets.hpp"

#include <algorithm>
#include <deque>

namespace telemetry_cfdp_receiver_test {

using namespace aeolis;
using namespace aeolis::telemetry;

namespace {

using Octets = std::vector<std::uint8_t>;
using Outcome = Reception::Outcome;

Reception transaction() {
    Reception reception;
    reception.source = 76;
    reception.sequence = 9;
    reception.destination = 1;
    return reception;
}

cfdp::Pdu from_sender(const cfdp::Content& content) {
    return {{.source = 76, .sequence = 9, .destination = 1}, content};
}

/// A file that is written where the receiver says, and complains about what is written twice.
struct Disk {
    Octets octets;
    std::vector<bool> written;
    void write(const std::vector<CfdpReceiver::Write>& writes) {
        for (const auto& part : writes) {
            if (octets.size() < part.offset + part.octets.size()) {
                octets.resize(part.offset + part.octets.size());
                written.resize(octets.size());
            }
            for (std::size_t i = 0; i < part.octets.size(); ++i) {
                REQUIRE_FALSE(written[part.offset + i]);
                written[part.offset + i] = true;
                octets[part.offset + i] = part.octets[i];
            }
        }
    }
};

/// Loses in bursts: a good state and a bad one.
struct Bursts {
    std::mt19937& random;
    double into_burst, out_of_burst;
    bool bad = false;
    bool lose() {
        bad = std::uniform_real_distribution{}(random) < (bad ? 1.0 - out_of_burst : into_burst);
        return bad;
    }
};

std::vector<cfdp::Content> answers(CfdpReceiver& receiver, std::deque<Octets>& kept) {
    std::vector<cfdp::Content> all;
    while (auto pdu = receiver.next()) {
        kept.push_back(std::move(*pdu));
        all.push_back(cfdp::read(kept.back())->content);
    }
    return all;
}

}  // namespace

TEST_CASE("the file arrives identical over bursts, breaks between passes and restarts of either end", "[telemetry]") {
    for (unsigned seed = 0; seed < 60; ++seed) {
        std::mt19937 random{seed};
        const Octets file = test::random_octets(random, random() % 60000);
        const flight::CfdpSource::File description{76, 1, 9, static_cast<std::uint32_t>(file.size()),
                                                   static_cast<std::uint16_t>(1 + random() % 900)};
        flight::CfdpSource source{description, "recording"};
        flight::CfdpSource older = source;
        CfdpReceiver receiver{transaction()};
        Disk disk;
        Bursts down{random, 0.02, 0.2}, up{random, 0.05, 0.3};
        Octets pdu(source.pdu_octets_max());
        int passes = 0;
        for (; passes < 400 && !(source.done() && receiver.state().outcome_acknowledged); ++passes) {
            if (random() % 4 == 0) source = random() % 2 == 0 ? older : flight::CfdpSource{description, "recording"};
            if (random() % 4 == 0) receiver = CfdpReceiver{receiver.state()};  // what it wanted to say is forgotten
            if (random() % 3 == 0) older = source;
            receiver.ask();
            source.repeat();
            for (int step = 0; step < 2000; ++step) {
                if (random() % 500 == 0) source.repeat();
                if (random() % 500 == 0) receiver.ask();
                const std::size_t size = source.next(file, pdu);
                if (size > 0 && !down.lose()) disk.write(receiver.on(*cfdp::read(std::span{pdu}.first(size))));
                const auto answer = receiver.next();
                if (answer && !up.lose()) source.on(*cfdp::read(*answer));
            }
        }
        INFO("seed " << seed);
        REQUIRE(receiver.state().outcome == Outcome::complete);
        REQUIRE(disk.octets == file);
        REQUIRE(source.delivered());
        REQUIRE(receiver.state().destination_name == "recording");
    }
}

TEST_CASE("pieces in any order, overlapping and repeated, are written once each and summed once", "[telemetry]") {
    std::mt19937 random{5};
    for (int round = 0; round < 100; ++round) {
        const Octets file = test::random_octets(random, 1 + random() % 3000);
        const auto size = static_cast<std::uint32_t>(file.size());
        CfdpReceiver receiver{transaction()};
        Disk disk;
        while (received_octets(receiver.state()) < size) {
            const std::size_t start = random() % file.size();
            const std::size_t count = 1 + random() % std::min<std::size_t>(300, file.size() - start);
            disk.write(receiver.on(
                from_sender(cfdp::FileData{static_cast<std::uint32_t>(start), std::span{file}.subspan(start, count)})));
            const auto& ranges = receiver.state().received;
            for (std::size_t i = 1; i < ranges.size(); ++i) REQUIRE(ranges[i - 1].end < ranges[i].start);
        }
        CHECK(receiver.state().checksum == cfdp::modular_checksum(0, file));
        receiver.on(from_sender(cfdp::Eof{.checksum = cfdp::modular_checksum(0, file), .file_octets = size}));
        CHECK(receiver.state().outcome == Outcome::under_way);  // its name is not known yet
        receiver.on(from_sender(cfdp::Metadata{.file_octets = size}));
        CHECK(receiver.state().outcome == Outcome::complete);
        CHECK(disk.octets == file);
    }
}

TEST_CASE("at the end of the file it asks for exactly what is missing, the metadata too", "[telemetry]") {
    CfdpReceiver receiver{transaction()};
    std::deque<Octets> kept;
    const Octets data(100);
    receiver.on(from_sender(cfdp::FileData{100, data}));
    receiver.on(from_sender(cfdp::FileData{300, data}));
    CHECK(answers(receiver, kept).empty());
    receiver.on(from_sender(cfdp::Eof{.file_octets = 1000}));
    const auto said = answers(receiver, kept);
    REQUIRE(said.size() == 2);
    CHECK(std::get<cfdp::Ack>(said[0]).of == cfdp::Directive::eof);
    const auto& nak = std::get<cfdp::Nak>(said[1]);
    CHECK(nak.scope == cfdp::Range{0, 1000});
    CHECK(std::vector<cfdp::Range>{nak.requests.begin(), nak.requests.end()} ==
          std::vector<cfdp::Range>{{0, 0}, {0, 100}, {200, 300}, {400, 1000}});
}

TEST_CASE("before the end is known it may ask for what is missing so far", "[telemetry]") {
    CfdpReceiver receiver{transaction()};
    std::deque<Octets> kept;
    const Octets data(100);
    receiver.on(from_sender(cfdp::Metadata{.file_octets = 1000}));
    receiver.on(from_sender(cfdp::FileData{300, data}));
    receiver.ask();
    const auto said = answers(receiver, kept);
    REQUIRE(said.size() == 1);
    CHECK(std::get<cfdp::Nak>(said[0]).requests.span()[0] == cfdp::Range{0, 300});
}

TEST_CASE("a wrong checksum, a wrong size and a cancelled file end so, and are said so", "[telemetry]") {
    const Octets data(100, 7);
    const auto ended = [&](const cfdp::Eof& eof) {
        CfdpReceiver receiver{transaction()};
        receiver.on(from_sender(cfdp::Metadata{.file_octets = 100}));
        receiver.on(from_sender(cfdp::FileData{0, data}));
        receiver.on(from_sender(eof));
        std::deque<Octets> kept;
        const auto said = answers(receiver, kept);
        REQUIRE(said.size() == 2);
        return std::pair{receiver.state().outcome, std::get<cfdp::Finished>(said[1]).condition};
    };
    using cfdp::Condition;
    const std::uint32_t good = cfdp::modular_checksum(0, data);
    CHECK(ended({Condition::no_error, good, 100}) == std::pair{Outcome::complete, Condition::no_error});
    CHECK(ended({Condition::no_error, good + 1, 100}) ==
          std::pair{Outcome::wrong_checksum, Condition::file_checksum_failure});
    CHECK(ended({Condition::no_error, good, 99}) == std::pair{Outcome::wrong_size, Condition::file_size_error});
    CHECK(ended({Condition::cancel_received, good, 100}) == std::pair{Outcome::cancelled, Condition::cancel_received});
}

TEST_CASE("what contradicts what is known, or asks for gigabytes, is counted and changes nothing", "[telemetry]") {
    CfdpReceiver receiver{transaction()};
    const Octets data(100);
    receiver.on(from_sender(cfdp::FileData{4000000000, data}));
    receiver.on(from_sender(cfdp::Metadata{.file_octets = 4000000000}));
    receiver.on(from_sender(cfdp::Metadata{.file_octets = 500}));
    receiver.on(from_sender(cfdp::Metadata{.file_octets = 600}));
    receiver.on(from_sender(cfdp::FileData{450, data}));
    cfdp::Pdu other = from_sender(cfdp::Eof{});
    other.header.sequence = 8;
    receiver.on(other);
    CHECK(receiver.refused() == 5);
    CHECK(receiver.state().received.empty());
    CHECK(receiver.state().file_octets == 500U);
}

TEST_CASE("a transaction begins with a PDU from a sender of class 2 whose ids we can write", "[telemetry]") {
    CHECK(reception_of({.source = 76, .sequence = 9, .destination = 1}));
    CHECK_FALSE(reception_of({.toward_sender = true, .source = 76}));
    CHECK_FALSE(reception_of({.unacknowledged = true, .source = 76}));
    CHECK_FALSE(reception_of({.source = 0x10000}));
}

}  // namespace telemetry_cfdp_receiver_test
