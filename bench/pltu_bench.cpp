// SPDX-License-Identifier: Apache-2.0
// Octets of a UHF stream searched for frames a second on one core.
//
// They are measured against the goal of 200 MB/s, and against memcpy and memchr over the same octets in the same run,
// the least work of any receiver that looks for a marker.
#include "common/proximity_frame.hpp"
#include "telemetry/pltu_receiver.hpp"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <vector>

namespace {

using namespace aeolis;

constexpr double goal_mb_per_s = 200.0;
constexpr std::size_t stream_octets = std::size_t{32} << 20U;
constexpr std::size_t piece_octets = 65536;  // as read from a socket

std::uint32_t noise() {
    static std::uint32_t state = 1;
    return (state = state * 1664525U + 1013904223U) >> 24;
}

struct Load {
    const char* name;
    std::size_t data_octets;  ///< of a frame; 0: no frames, noise only
    std::size_t between_octets;
};

std::vector<std::uint8_t> stream_of(const Load& load, std::uint64_t& frames) {
    std::vector<std::uint8_t> stream, data(load.data_octets), pltu(pltu_octets_max);
    stream.reserve(stream_octets + pltu_octets_max);
    frames = 0;
    while (stream.size() < stream_octets) {
        for (std::size_t i = 0; i < load.between_octets; ++i) stream.push_back(static_cast<std::uint8_t>(noise()));
        if (data.empty()) continue;
        for (auto& octet : data) octet = static_cast<std::uint8_t>(noise());
        const ProximityHeader header{.spacecraft = 76, .sequence = static_cast<std::uint8_t>(frames++)};
        const std::size_t size = write_pltu(header, data, pltu);
        stream.insert(stream.end(), pltu.begin(), pltu.begin() + static_cast<std::ptrdiff_t>(size));
    }
    return stream;
}

/// The best of five, by processor time of this process.
template <typename Pass>
double mb_per_s(std::size_t octets, Pass pass) {
    double best = 0.0;
    for (int part = 0; part < 5; ++part) {
        const std::clock_t start = std::clock();
        pass();
        const double took_s = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
        best = std::max(best, static_cast<double>(octets) / took_s / 1.0e6);
    }
    return best;
}

}  // namespace

int main() {
    bool met = true;
    for (const Load& load : {Load{"frames of 1000 octets", 1000, 0}, Load{"frames of 100 octets", 100, 0},
                             Load{"frames between noise", 300, 300}, Load{"noise only", 0, 4096}}) {
        std::uint64_t frames = 0;
        const auto stream = stream_of(load, frames);
        std::vector<std::uint8_t> copy(stream.size());
        std::uint64_t seen = 0;
        const double limit = mb_per_s(stream.size(), [&] {
            for (std::size_t at = 0; at < stream.size(); at += piece_octets) {
                const std::size_t now = std::min(piece_octets, stream.size() - at);
                std::memcpy(copy.data() + at, stream.data() + at, now);
                const std::uint8_t* next = copy.data() + at;
                const std::uint8_t* end = next + now;
                while (const void* found = std::memchr(next, 0xFA, static_cast<std::size_t>(end - next))) {
                    ++seen;
                    next = static_cast<const std::uint8_t*>(found) + 1;
                }
            }
        });
        std::uint64_t received = 0;
        const double rate = mb_per_s(stream.size(), [&] {
            telemetry::PltuReceiver receiver;
            for (std::size_t at = 0; at < stream.size(); at += piece_octets) {
                receiver.receive(std::span{stream}.subspan(at, std::min(piece_octets, stream.size() - at)));
                while (receiver.next()) ++received;
            }
        });
        const bool all = received == 5 * frames;
        std::printf("%-22s %7.0f MB/s   goal %.0f   ratio %5.2f   memcpy and memchr %7.0f MB/s, of which %.2f%s\n",
                    load.name, rate, goal_mb_per_s, rate / goal_mb_per_s, limit, rate / limit,
                    all && seen > 0 ? "" : "   FRAMES WERE LOST");
        met = met && all && rate >= goal_mb_per_s;
    }
    return met ? 0 : 1;
}
