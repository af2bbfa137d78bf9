// SPDX-License-Identifier: Apache-2.0
#include "bench/list_readers.hpp"

#include "bench/loopback_request.hpp"
#include "bench/must.hpp"

#include <chrono>
#include <cstring>
#include <thread>
#include <unistd.h>
#include <utility>

namespace aeolis::bench {
ListReaders::ListReaders(std::vector<std::string> targets) {
    process_ = fork_clients();
    if (process_ != 0) return;
    while (counters_->port == 0) std::this_thread::sleep_for(std::chrono::milliseconds{1});
    std::vector<std::thread> threads;
    for (std::size_t reader = 0; reader < readers; ++reader)
        threads.emplace_back([this, reader, &targets] { read_lists(*counters_, reader, targets); });
    for (auto& thread : threads) thread.join();
    ::_exit(0);
}

ListReaders::~ListReaders() {
    kill_clients(process_);
}

void ListReaders::begin(std::uint16_t port, const std::vector<std::string>& tokens) {
    for (std::size_t reader = 0; reader < readers; ++reader) {
        const auto& token = tokens[reader % tokens.size()];
        must(token.size() < counters_->tokens[reader].size(), "a short token");
        std::memcpy(counters_->tokens[reader].data(), token.c_str(), token.size() + 1);
    }
    counters_->port = port;
}

void ListReaders::read_lists(SharedCounters& counters, std::size_t reader, const std::vector<std::string>& targets) {
    using Clock = std::chrono::steady_clock;
    for (std::size_t i = 0; i < targets.size(); ++i) {
        const auto& target = targets[(i + reader * targets.size() / readers) % targets.size()];
        const auto asked = Clock::now();
        const auto answered = answer_of(counters.port, request_text("GET", target, counters.tokens[reader].data()));
        const auto waited = std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - asked).count();
        ++counters.answers;
        counters.octets += answered.octets;
        if (answered.status != 200) ++counters.refused;
        for (auto longest = counters.longest_us.load(); std::cmp_less(longest, waited);)
            if (counters.longest_us.compare_exchange_weak(longest, static_cast<std::uint64_t>(waited))) break;
    }
    ++counters.over;
}

}  // namespace aeolis::bench
