// SPDX-License-Identifier: Apache-2.0
// Measures the deterministic executive's overhead over the modules' own work, and the cost of a computer's snapshot.
//
//   dispatch   a cycle of an idle computer (before EDL): every module has its turn or its tick; goal 300 ns beyond the
//              modules' own work, measured by calling the same handlers directly
//   copy       a copy of a computer's whole state; goal 1 ms, and at most 4 MB
#include "flight/computer.hpp"
#include "flight/computer_state.hpp"
#include "flight/kernel/dispatch.hpp"
#include "flight/kernel/executive.hpp"
#include "flight/kernel/interrupts.hpp"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <limits>
#include <memory>
#include <vector>

namespace {

using namespace aeolis;
using namespace aeolis::flight;

constexpr int cycles = 64 * 600;
constexpr int rounds = 9;

double thread_cpu_ns() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) * 1.0e9 + static_cast<double>(time.tv_nsec);
}

/// Processor time of the fastest round, because other processes only add to it.
double ns_a_cycle(const auto& run) {
    double least_ns = std::numeric_limits<double>::max();
    for (int round = 0; round < rounds; ++round) {
        const double began_ns = thread_cpu_ns();
        run();
        least_ns = std::min(least_ns, thread_cpu_ns() - began_ns);
    }
    return least_ns / cycles;
}

/// The same handlers with the same messages in the same order, but without mailboxes.
struct Tapped final : MessageTap {
    std::vector<std::pair<ModuleId, Message>> messages;
    void sent(ModuleId, ModuleId to, const Message& message) override { messages.emplace_back(to, message); }
};

}  // namespace

int main() {
    const auto state = std::make_unique<ComputerState>(Load{}, Sclk{1000.0});
    const auto out = std::make_unique<DeviceOutputs>();
    DeviceInputs in;
    in.nvm_capacity_octets = 1U << 30;
    std::int64_t ticks = 64000;
    // A tick between whole seconds has no status packets, so that only the dispatch is measured.
    const auto next_tick = [&] {
        if (++ticks % 64 == 0) ++ticks;
        in.now = Sclk::from_ticks(ticks);
    };
    const double with_executive_ns = ns_a_cycle([&] {
        for (int i = 0; i < cycles; ++i) {
            next_tick();
            Executive{*state}.cycle(in, *out);
        }
    });
    Tapped tap;
    next_tick();
    Executive{*state, &tap}.cycle(in, *out);
    post_interrupts(in, [&](ModuleId to, const Message& message) { tap.messages.emplace_back(to, message); });
    const double modules_alone_ns = ns_a_cycle([&] {
        for (int i = 0; i < cycles; ++i)
            for (const auto& [to, message] : tap.messages)
                with_module(*state, to, [&, id = to](auto& module) {
                    state->outbox.begin(id, in.now, *out);
                    (void)handle(module, message, state->outbox);
                });
    });
    const double dispatch_ns = with_executive_ns - modules_alone_ns;
    std::printf("a cycle of %zu messages: %.0f ns, the handlers alone %.0f ns\n", tap.messages.size(),
                with_executive_ns, modules_alone_ns);
    std::printf("dispatch a cycle: %.0f ns, goal 300 ns, ratio %.2f\n", dispatch_ns, dispatch_ns / 300.0);

    const auto other = std::make_unique<ComputerState>(*state);
    const double copy_ns = ns_a_cycle([&] {
                               for (int i = 0; i < 100; ++i) *other = *state;
                           }) *
                           cycles / 100.0;
    std::vector<unsigned char> from(sizeof(ComputerState), 1), to(sizeof(ComputerState));
    const double memcpy_ns = ns_a_cycle([&] {
                                 for (int i = 0; i < 100; ++i) {
                                     std::memcpy(to.data(), from.data(), from.size());
                                     from[static_cast<std::size_t>(i)] = to[to.size() / 2];
                                 }
                             }) *
                             cycles / 100.0;
    std::printf("state of a computer: %.2f MB, goal 4 MB, ratio %.2f\n", sizeof(ComputerState) / 1.0e6,
                sizeof(ComputerState) / 4.0e6);
    std::printf("copy of it: %.3f ms, goal 1 ms, ratio %.2f; memcpy of as many octets %.3f ms\n", copy_ns * 1.0e-6,
                copy_ns * 1.0e-6, memcpy_ns * 1.0e-6);
    return dispatch_ns <= 300.0 && copy_ns <= 1.0e6 && sizeof(ComputerState) <= 4'000'000 ? 0 : 1;
}
