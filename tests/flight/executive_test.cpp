// SPDX-License-Identifier: Apache-2.0
#include "flight/kernel/executive.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/flown_computers.hpp"
#include "tests/support/random_message.hpp"

#include <cstddef>
#include <cstring>
#include <memory>
#include <random>
#include <vector>

namespace flight_executive_test {

using namespace aeolis;
using namespace aeolis::flight;

namespace {

struct Fixture {
    std::unique_ptr<ComputerState> state = std::make_unique<ComputerState>(Load{}, Sclk{1000.0});
    std::unique_ptr<DeviceOutputs> out = std::make_unique<DeviceOutputs>();
    DeviceInputs in;
    std::int64_t ticks = 64000;

    Fixture() { in.nvm_capacity_octets = 1U << 30; }
    void cycle() {
        in.now = Sclk::from_ticks(++ticks);
        Executive{*state}.cycle(in, *out);
        in.uplink.clear();
    }
};

/// A computer whose EDL has begun, in pre-EDL of the nominal landing.
Fixture begun() {
    test::FlownComputers flown;
    Fixture f;
    *f.state = flown.prime().state();
    f.ticks = f.state->now.ticks();
    return f;
}

}  // namespace

TEST_CASE("all mail is handled by the end of a cycle", "[executive][R3]") {
    Fixture f;
    for (int i = 0; i < 640; ++i) f.cycle();
    for (const auto& mailbox : f.state->mailboxes) CHECK(mailbox.empty());
    CHECK(f.state->sync.cycles() == 640);
}

TEST_CASE("every module handles every message, whatever is in it, whether it expects it or not, before EDL and in it",
          "[executive][R4]") {
    std::mt19937 random{7};
    const Fixture fresh, in_edl = begun();
    for (const Fixture* start : {&fresh, &in_edl})
        for (std::size_t module = 0; module < module_count; ++module)
            for (std::size_t type = 0; type < std::variant_size_v<Message>; ++type) {
                Fixture f;
                *f.state = *start->state;
                f.ticks = start->ticks;
                f.cycle();
                for (int i = 0; i < 3; ++i) {
                    const auto id = static_cast<ModuleId>(module);
                    const Message message = test::random_message_of(type, random);
                    REQUIRE(f.state->mailboxes[module].try_push(message));
                    if (wakes(id, message)) f.state->ready |= bit_of(id);
                    INFO("module " << module << ", message " << type);
                    REQUIRE_NOTHROW(f.cycle());
                    REQUIRE_NOTHROW(f.cycle());
                }
            }
}

TEST_CASE("an unexpected message is counted and reported", "[executive][R4]") {
    Fixture f;
    REQUIRE(f.state->mailboxes[static_cast<std::size_t>(ModuleId::imu)].try_push(DoEdlCommand{}));
    f.cycle();
    CHECK(f.state->unexpected_messages == 1);
    f.cycle();
    CHECK(f.state->unexpected_messages == 1);
}

TEST_CASE("a full mailbox is counted, and the computer goes on", "[executive][R6]") {
    Fixture f;
    for (int i = 0; i < 100; ++i) f.state->next_cycle.push_back({ModuleId::mfsk, ModuleId::edl_bg, ClockTick{}});
    f.cycle();
    CHECK(f.state->mailbox_overflows > 0);
    const auto before = f.state->mailbox_overflows;
    f.cycle();
    CHECK(f.state->mailbox_overflows == before);
}

TEST_CASE("an interrupt and the tick of the clock are messages at once: handled in the cycle in which they came",
          "[executive][R10]") {
    // Answers of modules outside the rate group wait for the next cycle: they show that the module had its message.
    const auto answered = [](const Fixture& f, ModuleId from, auto is_it) {
        return std::any_of(f.state->next_cycle.begin(), f.state->next_cycle.end(),
                           [&](const Envelope& e) { return e.from == from && is_it(e.message); });
    };
    Fixture f;
    f.cycle();
    CHECK(f.state->sync.cycles() == 1);  // the clock's tick, and every turn and confirmation after it

    f.in.system_fault = SystemFaultReport{true};
    f.in.uplink.push_back({});
    f.in.switch_replies.push_back({SwitchId::radar, true});
    f.in.switch_replies.push_back({SwitchId::uhf, true});
    f.cycle();
    CHECK(answered(f, ModuleId::system_fault_protection,
                   [](const Message& m) { return std::holds_alternative<InhibitEdl>(m); }));
    CHECK(
        answered(f, ModuleId::command_dispatcher, [](const Message& m) { return std::holds_alternative<Record>(m); }));
    // Nobody had commanded these switches: that is reported.
    for (const ModuleId manager : {ModuleId::power, ModuleId::telecom})
        CHECK(answered(f, manager, [](const Message& m) { return std::holds_alternative<Record>(m); }));
    for (const auto& mailbox : f.state->mailboxes) CHECK(mailbox.empty());
    CHECK(f.state->unexpected_messages == 0);
}

TEST_CASE("what a module outside the rate group sends is delivered at the start of the next cycle",
          "[executive][R18]") {
    Fixture f;
    REQUIRE(
        f.state->mailboxes[static_cast<std::size_t>(ModuleId::mfsk)].try_push(ToneRequest{ToneId{61}, Sclk{1000.0}}));
    f.cycle();
    const auto is_record = [](const Envelope& e) { return std::holds_alternative<Record>(e.message); };
    CHECK(std::count_if(f.state->next_cycle.begin(), f.state->next_cycle.end(), is_record) > 0);
    CHECK(f.out->tone == ToneId{61});
}

// Only in the build that is shipped: with sanitizers the padding behind a member of one octet (AttitudeCommand::mode)
// keeps what the stack had there, and together they can look like an address.
TEST_CASE("a computer is one value of fixed size with nothing that points into it",
          "[executive][R7][invariant2][release]") {
    CHECK(sizeof(ComputerState) <= 4U * 1024 * 1024);
    // In clean memory, so that what lies between two members is not left over from whoever had it before.
    std::vector<std::max_align_t> room(sizeof(ComputerState) / sizeof(std::max_align_t) + 1), room_of_copy(room.size());
    // max_align_t has octets of its own between its members, which a vector leaves as they are.
    std::memset(room.data(), 0, room.size() * sizeof room[0]);
    std::memset(room_of_copy.data(), 0, room_of_copy.size() * sizeof room_of_copy[0]);
    auto* original = std::construct_at(reinterpret_cast<ComputerState*>(room.data()), Load{}, Sclk{1000.0});
    const auto out = std::make_unique<DeviceOutputs>();
    DeviceInputs in;
    in.nvm_capacity_octets = 1U << 30;
    for (int i = 1; i <= 64; ++i) {
        in.now = Sclk::from_ticks(64000 + i);
        Executive{*original}.cycle(in, *out);
    }
    const auto* copy = std::construct_at(reinterpret_cast<ComputerState*>(room_of_copy.data()), *original);
    // No aligned word of the modules may be an address inside the original. (Mailboxes hold messages, which are refused
    // pointers when they are compiled; what lies beside a short message in its slot is whatever was there before.)
    const auto first = reinterpret_cast<std::uintptr_t>(original);
    const auto last = first + sizeof(ComputerState);
    const auto* octets = reinterpret_cast<const unsigned char*>(copy);
    for (std::size_t at = 0; at + sizeof(std::uintptr_t) <= offsetof(ComputerState, mailboxes);
         at += sizeof(std::uintptr_t)) {
        std::uintptr_t word = 0;
        std::memcpy(&word, octets + at, sizeof word);
        const bool points_inside = word >= first && word < last;
        INFO("at octet " << at << ", pointing at octet " << word - first);
        REQUIRE_FALSE(points_inside);
    }
}

TEST_CASE("random messages to random modules never end the computer, only count, before EDL and in it",
          "[executive][R4]") {
    std::mt19937 random{5};
    Fixture both[] = {Fixture{}, begun()};
    for (Fixture& f : both) {
        for (int round = 0; round < 20000; ++round) {
            if (random() % 4 == 0) REQUIRE_NOTHROW(f.cycle());
            const auto to = static_cast<ModuleId>(random() % module_count);
            const Message message = test::random_message(random);
            if (f.state->mailboxes[static_cast<std::size_t>(to)].try_push(message) && wakes(to, message))
                f.state->ready |= bit_of(to);
        }
        REQUIRE_NOTHROW(f.cycle());
        CHECK(f.state->unexpected_messages > 1000);
    }
}

}  // namespace flight_executive_test
