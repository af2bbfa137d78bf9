// SPDX-License-Identifier: Apache-2.0
#include "bench/greedy_clients.hpp"

#include "bench/loopback_request.hpp"
#include "bench/must.hpp"

#include <chrono>
#include <cstring>
#include <thread>
#include <unistd.h>
#include <vector>

namespace aeolis::bench {
namespace {

constexpr std::size_t command_threads = 8;  ///< each waits for its answers

}  // namespace

GreedyClients::GreedyClients() {
    process_ = fork_clients();
    if (process_ != 0) return;
    while (counters_->port == 0) std::this_thread::sleep_for(std::chrono::milliseconds{1});
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < questions_at_once; ++i) threads.emplace_back([this] { ask(*counters_); });
    for (std::size_t i = 0; i < command_threads; ++i) threads.emplace_back([this] { command(*counters_); });
    for (auto& thread : threads) thread.join();  // until it is killed
}

GreedyClients::~GreedyClients() {
    kill_clients(process_);
}

void GreedyClients::begin(std::uint16_t port, const Targets& targets) {
    const auto put = [](Text& to, const std::string& from) {
        must(from.size() < to.size(), "a short text");
        std::memcpy(to.data(), from.c_str(), from.size() + 1);
    };
    put(counters_->question, targets.question);
    put(counters_->asker, targets.asker);
    put(counters_->target, targets.commands);
    put(counters_->commander, targets.commander);
    counters_->port = port;
}

void GreedyClients::ask(SharedCounters& counters) {
    const auto request = request_text("GET", counters.question.data(), counters.asker.data());
    while (true) {
        if (answer_of(counters.port, request).status == 200) {
            ++counters.answers;
            continue;
        }
        ++counters.refused;
        std::this_thread::sleep_for(std::chrono::milliseconds{20});
    }
}

void GreedyClients::command(SharedCounters& counters) {
    const auto request =
        request_text("POST", counters.target.data(), counters.commander.data(), R"({"command":"NO_OP"})");
    constexpr std::chrono::microseconds pause{1'000'000 * command_threads / commands_per_s};
    for (auto next = std::chrono::steady_clock::now(); true; next += pause) {
        std::this_thread::sleep_until(next);
        if (answer_of(counters.port, request).status == 429) ++counters.limited;
        ++counters.commands;
    }
}

}  // namespace aeolis::bench
