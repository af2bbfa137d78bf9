// SPDX-License-Identifier: Apache-2.0
#include "bench/list_readers.hpp"

#include "bench/loopback_request.hpp"
#include "bench/must.hpp"

#include <chrono>
#include <csignal>
#include <cstring>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <utility>

namespace aeolis::bench {
ListReaders::ListReaders(std::vector<std::string> targets) {
    void* const shared =
        ::mmap(nullptr, sizeof(SharedCounters), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    must(shared != MAP_FAILED, "mmap");
    counters_ = new (shared) SharedCounters;
    process_ = ::fork();
    must(process_ >= 0, "fork");
    if (process_ != 0) return;
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    while (counters_->port == 0) std::this_thread::sleep_for(std::chrono::milliseconds{1});
    std::vector<std::thread> threads;
    for (std::size_t reader = 0; reader < readers; ++reader)
        threads.emplace_back([this, reader, &targets] { read_lists(*counters_, reader, targets); });
    for (auto& thread : threads) thread.join();
    ::_exit(0);
}

ListReaders::~ListReaders() {
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
    ::munmap(counters_, sizeof(SharedCounters));
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
