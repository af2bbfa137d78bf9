// SPDX-License-Identifier: Apache-2.0
#include "commands/command_link.hpp"

#include "common/cltu.hpp"
#include "common/ids.hpp"
#include "flight/commands/farm.hpp"
#include "tests/support/catch.hpp"

#include <map>

namespace commands_command_link_test {

using namespace aeolis;
using namespace aeolis::commands;

namespace {

using Service = Fop::Service;

Ert at_s(double seconds) {
    return {static_cast<std::int64_t>(seconds * 1.0e6)};
}
std::vector<std::uint8_t> packet(std::uint8_t value) {
    return std::vector<std::uint8_t>(20, value);
}
Clcw report(std::uint8_t expected) {
    return {.expected = expected};
}

/// What the link sends now, as the frames in it.
std::vector<CommandLink::Radiated> radiated(CommandLink& link, double at) {
    std::vector<CommandLink::Radiated> all;
    while (auto unit = link.next(at_s(at))) all.push_back(std::move(*unit));
    return all;
}

}  // namespace

TEST_CASE("a packet leaves as a CLTU with a frame that has it", "[commands][R44]") {
    CommandLink link{0.0};
    REQUIRE(link.send(1, packet(7), Service::expedited));
    const auto units = radiated(link, 0.0);
    REQUIRE(units.size() == 1);
    std::vector<std::uint8_t> information(cltu_information_octets_max);
    const auto octets = read_cltu(units[0].cltu, information);
    REQUIRE(octets);
    const auto frame = read_tc_frame(std::span{information}.first(*octets));
    REQUIRE(frame);
    CHECK(frame->header.spacecraft == spacecraft_id);
    CHECK(std::vector<std::uint8_t>{frame->data.begin(), frame->data.end()} == packet(7));
}

TEST_CASE("the service is sequence controlled while reports come, and expedited when they do not", "[commands]") {
    CommandLink link{0.0};
    CHECK(link.suitable(at_s(0)) == Service::expedited);
    link.hear(report(0), at_s(1));
    CHECK(link.suitable(at_s(2)) == Service::sequence_controlled);
    CHECK(link.suitable(at_s(2 + CommandLink::report_s)) == Service::expedited);
}

TEST_CASE("without any report a frame is sent again after both light times, and given up after some", "[commands]") {
    CommandLink link{100.0};
    REQUIRE(link.send(9, packet(1), Service::sequence_controlled));
    unsigned transmissions = 0;
    for (double now = 0.0; now < 3000.0; now += 1.0) {
        link.pass(at_s(now));
        for (const auto& unit : radiated(link, now)) {
            transmissions += 1;
            CHECK(unit.transmission == transmissions);
            CHECK(now == Approx((transmissions - 1) * (200.0 + CommandLink::report_s)).margin(3.0));
        }
    }
    CHECK(transmissions == CommandLink::transmissions_max);
    const auto reports = link.take_reports();
    REQUIRE(reports.size() == 1);
    CHECK(reports[0] == Fop::Report{9, Fop::Fate::never_acknowledged, CommandLink::transmissions_max});
}

TEST_CASE("no command is carried out twice, nor said to be taken when it was not, over a restart of the computer",
          "[commands][R23]") {
    using flight::Farm;
    const Farm::Settings settings{
        .spacecraft = spacecraft_id, .virtual_channel = telecommand_channel, .window = 128, .locked_at_start = true};
    // Frames of any sequence, also about its wrap; `taken` of three were taken when the computer starts anew.
    for (unsigned before = 0; before < 300; before += 1) {
        for (std::size_t taken = 0; taken <= 3; ++taken) {
            CommandLink link{0.0};
            Farm farm{settings};
            std::map<std::uint64_t, unsigned> carried_out;
            std::uint64_t tag = 0;
            double now = 0.0;
            const auto arrive = [&](const CommandLink::Radiated& unit) {
                std::vector<std::uint8_t> information(cltu_information_octets_max);
                const auto octets = read_cltu(unit.cltu, information);
                REQUIRE(octets);
                const auto frame = read_tc_frame(std::span{information}.first(*octets));
                REQUIRE(frame);
                if (farm.take(*frame) == Farm::Verdict::accepted) ++carried_out[*unit.tag];
            };
            const auto exchange = [&] {
                now += 1.0;
                for (const auto& unit : radiated(link, now)) arrive(unit);
                link.hear(farm.clcw(), at_s(now));
            };
            exchange();
            exchange();
            REQUIRE(link.suitable(at_s(now)) == Service::sequence_controlled);
            for (unsigned i = 0; i < before; ++i) {
                REQUIRE(link.send(++tag, packet(1), Service::sequence_controlled));
                exchange();
            }
            std::map<std::uint64_t, Fop::Fate> fates;
            for (const auto& report : link.take_reports()) fates[report.tag] = report.fate;
            for (int i = 0; i < 3; ++i) REQUIRE(link.send(++tag, packet(1), Service::sequence_controlled));
            const auto units = radiated(link, now);
            REQUIRE(units.size() == 3);
            for (std::size_t i = 0; i < taken; ++i) arrive(units[i]);
            farm = Farm{settings};  // ground has heard nothing of them
            link.pass(at_s(now + 2.0 * CommandLink::report_s));
            for (int i = 0; i < 5; ++i) exchange();
            for (const auto& report : link.take_reports()) fates[report.tag] = report.fate;
            for (const auto& [which, times] : carried_out) REQUIRE(times == 1);
            for (const auto& [which, fate] : fates)
                if (fate == Fop::Fate::acknowledged) REQUIRE(carried_out.contains(which));
            REQUIRE(fates.size() == tag);
        }
    }
}

TEST_CASE("when the vehicle counts from 0 again it is told the sequence, and what follows gets there", "[commands]") {
    CommandLink link{0.0};
    link.hear(report(0), at_s(0));
    for (std::uint64_t tag = 0; tag < 5; ++tag) REQUIRE(link.send(tag, packet(1), Service::sequence_controlled));
    radiated(link, 0.0);
    link.hear(report(5), at_s(1));
    link.hear(report(0), at_s(10));  // its computer has started anew
    const auto controls = radiated(link, 10.0);
    REQUIRE(controls.size() == 2);
    CHECK_FALSE(controls[0].tag);
    link.hear(report(5), at_s(11));
    REQUIRE(link.send(6, packet(2), Service::sequence_controlled));
    const auto units = radiated(link, 12.0);
    REQUIRE(units.size() == 1);
    CHECK(units[0].sequence == 5);
}

}  // namespace commands_command_link_test
