// SPDX-License-Identifier: Apache-2.0
#include "commands/fop.hpp"
#include "flight/commands/farm.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/octets.hpp"

#include <deque>
#include <map>
#include <random>
#include <set>

namespace commands_fop_test {

using namespace aeolis;
using namespace aeolis::commands;

namespace {

using Service = Fop::Service;
using Fate = Fop::Fate;

std::vector<std::uint8_t> data_of(std::uint64_t tag) {
    return {static_cast<std::uint8_t>(tag >> 8), static_cast<std::uint8_t>(tag)};
}
std::uint64_t tag_of(std::span<const std::uint8_t> data) {
    return data[0] * 256U + data[1];
}

/// A vehicle and the way to it and back, a number of steps long each, that loses what the test says.
struct Channel {
    explicit Channel(unsigned seed, std::size_t delay_steps) : random(seed), delay(delay_steps) {}

    /// One step: a frame goes out, what was sent `delay` steps ago arrives, a CLCW comes back.
    void step(Fop& fop, double loss) {
        std::optional<std::vector<std::uint8_t>> sent;
        if (auto out = fop.next()) sent = std::move(out->frame);
        uplink.push_back(lost(loss) ? std::nullopt : std::move(sent));
        if (uplink.size() > delay) {
            if (uplink.front()) arrive(*uplink.front());
            uplink.pop_front();
        }
        downlink.push_back(lost(loss) ? std::nullopt : std::optional{farm.clcw()});
        if (downlink.size() > delay) {
            if (downlink.front()) fop.on(*downlink.front());
            downlink.pop_front();
        }
        for (const auto& report : fop.take_reports()) reports[report.tag].push_back(report.fate);
    }
    void arrive(std::span<const std::uint8_t> octets) {
        const auto frame = read_tc_frame(octets);
        REQUIRE(frame);
        if (farm.take(*frame) == flight::Farm::Verdict::accepted)
            (frame->header.bypass ? taken_by_bypass : taken).push_back(tag_of(frame->data));
    }
    bool lost(double fraction) { return std::uniform_real_distribution{}(random) < fraction; }

    std::mt19937 random;
    std::size_t delay;
    flight::Farm farm{{76, 1, 128}};
    std::deque<std::optional<std::vector<std::uint8_t>>> uplink;
    std::deque<std::optional<Clcw>> downlink;
    std::vector<std::uint64_t> taken, taken_by_bypass;
    std::map<std::uint64_t, std::vector<Fate>> reports;
};

Fop::Settings settings(unsigned transmissions_max) {
    return {76, 1, 20, transmissions_max};
}

}  // namespace

TEST_CASE("no frame is taken twice or out of order, and each is acknowledged or reported, whatever is lost",
          "[commands]") {
    for (unsigned seed = 0; seed < 300; ++seed) {
        std::mt19937 random{seed};
        Channel channel{seed, random() % 30};
        Fop fop{settings(1 + random() % 6)};
        const double loss = static_cast<double>(random() % 50) / 100.0;
        std::set<std::uint64_t> in_sequence, expedited;
        std::uint64_t tag = 0;
        std::size_t quiet = 0;
        for (int step = 0; step < 1500; ++step) {
            if (step < 600 && random() % 3 == 0) {
                const auto service = random() % 5 == 0 ? Service::expedited : Service::sequence_controlled;
                (service == Service::expedited ? expedited : in_sequence).insert(tag);
                REQUIRE(fop.send(tag, data_of(tag), service));
                ++tag;
            }
            const std::size_t before = fop.outstanding();
            channel.step(fop, loss);
            quiet = fop.outstanding() == before ? quiet + 1 : 0;
            if (quiet > 2 * channel.delay + 5) {
                if (fop.state() == Fop::State::halted)
                    fop.restart();
                else
                    fop.repeat();
                quiet = 0;
            }
        }
        INFO("seed " << seed);
        // In order, without repetition.
        for (std::size_t i = 1; i < channel.taken.size(); ++i) REQUIRE(channel.taken[i - 1] < channel.taken[i]);
        const std::set<std::uint64_t> taken{channel.taken.begin(), channel.taken.end()};
        std::size_t reported = 0;
        for (const auto& [which, fates] : channel.reports) {
            REQUIRE(fates.size() == 1);
            REQUIRE((fates[0] == Fate::radiated) == expedited.contains(which));
            if (fates[0] == Fate::acknowledged) REQUIRE(taken.contains(which));
            ++reported;
        }
        REQUIRE(reported + fop.outstanding() + fop.waiting() == tag);
        for (const std::uint64_t which : taken) REQUIRE(in_sequence.contains(which));
    }
}

TEST_CASE("over a channel that loses a third, everything arrives when there are transmissions enough", "[commands]") {
    Channel channel{7, 12};
    Fop fop{settings(1000)};
    for (std::uint64_t tag = 0; tag < 500; ++tag) REQUIRE(fop.send(tag, data_of(tag), Service::sequence_controlled));
    int steps = 0;
    for (; fop.outstanding() + fop.waiting() > 0 && steps < 100000; ++steps) {
        channel.step(fop, 0.33);
        if (steps % 30 == 29) fop.repeat();
    }
    REQUIRE(channel.taken.size() == 500);
    for (const auto& [tag, fates] : channel.reports) CHECK(fates == std::vector{Fate::acknowledged});
}

TEST_CASE("a channel that loses nothing carries each frame once, light time or none", "[commands]") {
    for (const std::size_t delay : {0U, 1U, 10U, 100U}) {
        Channel channel{1, delay};
        Fop fop{settings(1)};
        for (std::uint64_t tag = 0; tag < 300; ++tag)
            REQUIRE(fop.send(tag, data_of(tag), Service::sequence_controlled));
        for (int step = 0; step < 5000; ++step) channel.step(fop, 0.0);
        CHECK(channel.taken.size() == 300);
        CHECK(fop.state() == Fop::State::active);
        CHECK(channel.reports.size() == 300);
    }
}

TEST_CASE("a request to send again is followed once, though CLCWs under way repeat it", "[commands]") {
    Fop fop{settings(5)};
    for (std::uint64_t tag = 0; tag < 3; ++tag) REQUIRE(fop.send(tag, data_of(tag), Service::sequence_controlled));
    for (int i = 0; i < 3; ++i) REQUIRE(fop.next());
    CHECK_FALSE(fop.next());
    const Clcw asks{.virtual_channel = 1, .retransmit = true, .expected = 1};
    fop.on(asks);
    CHECK(fop.take_reports() == std::vector<Fop::Report>{{0, Fate::acknowledged, 1}});
    CHECK(fop.next()->transmission == 2);
    CHECK(fop.next()->tag == 2U);
    CHECK_FALSE(fop.next());
    for (int i = 0; i < 10; ++i) fop.on(asks);
    CHECK_FALSE(fop.next());
    fop.repeat();
    CHECK(fop.next()->transmission == 3);
}

TEST_CASE("frames that are sent again hold up no expedited one", "[commands][R63]") {
    Fop fop{settings(5)};
    for (std::uint64_t tag = 0; tag < 3; ++tag) REQUIRE(fop.send(tag, data_of(tag), Service::sequence_controlled));
    for (int i = 0; i < 3; ++i) REQUIRE(fop.next());
    fop.repeat();
    REQUIRE(fop.send(3, data_of(3), Service::expedited));
    std::vector<std::uint64_t> tags;
    while (const auto out = fop.next()) tags.push_back(out->tag.value());
    CHECK(tags == std::vector<std::uint64_t>{3, 0, 1, 2});
}

TEST_CASE("what was never acknowledged is reported, and a restart goes on with what was never radiated", "[commands]") {
    Fop fop{{76, 1, 2, 2}};
    flight::Farm farm{{76, 1, 16}};
    for (std::uint64_t tag = 0; tag < 4; ++tag) REQUIRE(fop.send(tag, data_of(tag), Service::sequence_controlled));
    for (int i = 0; i < 3; ++i) {
        while (fop.next()) {
        }  // into the void
        fop.repeat();
    }
    CHECK(fop.state() == Fop::State::halted);
    CHECK(fop.why_halted() == Fop::Halt::too_many_transmissions);
    CHECK(fop.take_reports() ==
          std::vector<Fop::Report>{{0, Fate::never_acknowledged, 2}, {1, Fate::never_acknowledged, 2}});
    CHECK_FALSE(fop.next());
    fop.restart();
    for (int i = 0; i < 2; ++i) CHECK(farm.take(*read_tc_frame(fop.next()->frame)) == flight::Farm::Verdict::executed);
    CHECK_FALSE(fop.next());  // until the vehicle says that it knows
    fop.on(farm.clcw());
    const auto third = fop.next();
    REQUIRE(third);
    CHECK(third->tag == 2U);
    CHECK(farm.take(*read_tc_frame(third->frame)) == flight::Farm::Verdict::accepted);
}

TEST_CASE("lockout halts, a restart unlocks; a report of frames never sent halts too", "[commands]") {
    Fop fop{settings(5)};
    flight::Farm farm{{76, 1, 16}};
    (void)farm.take({{.spacecraft = 76, .virtual_channel = 1, .sequence = 100}, {}});
    fop.on(farm.clcw());
    CHECK(fop.why_halted() == Fop::Halt::lockout);
    fop.restart();
    while (const auto out = fop.next()) (void)farm.take(*read_tc_frame(out->frame));
    fop.on(farm.clcw());
    CHECK(fop.state() == Fop::State::active);
    fop.on({.virtual_channel = 1, .expected = 9});
    CHECK(fop.why_halted() == Fop::Halt::contradiction);
}

TEST_CASE("wait holds what is in sequence, not what is expedited; reports of other channels are nothing",
          "[commands]") {
    Fop fop{settings(5)};
    fop.on({.virtual_channel = 1, .wait = true});
    REQUIRE(fop.send(1, data_of(1), Service::sequence_controlled));
    REQUIRE(fop.send(2, data_of(2), Service::expedited));
    CHECK(fop.next()->tag == 2U);
    CHECK_FALSE(fop.next());
    fop.on({.virtual_channel = 2});
    fop.on({.cop = 0, .virtual_channel = 1});
    CHECK_FALSE(fop.next());
    fop.on({.virtual_channel = 1});
    CHECK(fop.next()->tag == 1U);
}

TEST_CASE("of both services what was sent first leaves first, so that neither starves the other", "[commands][R63]") {
    Fop fop{settings(5)};
    REQUIRE(fop.send(1, data_of(1), Service::expedited));
    REQUIRE(fop.send(2, data_of(2), Service::sequence_controlled));
    for (std::uint64_t tag = 3; tag < 6; ++tag) REQUIRE(fop.send(tag, data_of(tag), Service::expedited));
    std::vector<std::uint64_t> left;
    while (const auto frame = fop.next()) left.push_back(frame->tag.value());
    CHECK(left == std::vector<std::uint64_t>{1, 2, 3, 4, 5});
}

TEST_CASE("what does not fit a frame, or is one too many, is refused in words", "[commands]") {
    Fop fop{settings(5)};
    CHECK_FALSE(fop.send(1, {}, Service::expedited));
    CHECK_FALSE(fop.send(1, std::vector<std::uint8_t>(tc_frame_data_octets_max + 1), Service::expedited));
    for (std::size_t i = 0; i < Fop::frames_max; ++i) REQUIRE(fop.send(i, data_of(i), Service::sequence_controlled));
    CHECK_FALSE(fop.send(1, data_of(1), Service::sequence_controlled));
}

TEST_CASE("what was never radiated can be taken back; what was stays until it is acknowledged or given up",
          "[commands]") {
    Fop fop{{76, 1, 1, 2}};
    for (std::uint64_t tag = 0; tag < 3; ++tag) REQUIRE(fop.send(tag, data_of(tag), Service::sequence_controlled));
    CHECK(fop.next()->tag == 0U);
    CHECK_FALSE(fop.next());  // the window is full
    REQUIRE(fop.send(3, data_of(3), Service::expedited));
    CHECK(fop.take_back() == std::vector<std::uint64_t>{3, 1, 2});
    CHECK(fop.waiting() == 0);
    CHECK(fop.unacknowledged() == std::vector<std::uint64_t>{0});
    fop.on({.virtual_channel = 1, .expected = 1});
    CHECK(fop.unacknowledged().empty());
    CHECK_FALSE(fop.next());
}

}  // namespace commands_fop_test
