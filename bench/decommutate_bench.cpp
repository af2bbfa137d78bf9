// SPDX-License-Identifier: Apache-2.0
// Measures decommutated packets a second on one core against the goal of a million.
//
// The reference is the packet's CRC alone: the one pass over the octets that every decommutator needs.
#include "common/crc.hpp"
#include "telemetry/decommutator.hpp"
#include "telemetry/packet_identity.hpp"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <vector>

namespace {

using namespace aeolis;

constexpr double goal_per_s = 1.0e6;
constexpr std::size_t packets = 4096;
constexpr int rounds = 300;

std::vector<std::vector<std::uint8_t>> packets_of(const dictionary::Dictionary& dictionary,
                                                  const dictionary::Packet& wanted) {
    std::vector<std::vector<std::uint8_t>> made;
    std::uint32_t noise = 1;
    for (std::size_t i = 0; i < packets; ++i) {
        std::vector<std::uint8_t> octets(wanted.octets);
        for (auto& octet : octets) octet = static_cast<std::uint8_t>((noise = noise * 1664525U + 1013904223U) >> 24);
        seal_tm_packet(octets, wanted.apid, static_cast<std::uint16_t>(i),
                       Sclk::from_ticks(static_cast<std::int64_t>(i)), dictionary.id);
        made.push_back(std::move(octets));
    }
    return made;
}

/// Calls `each` on every packet repeatedly; returns the best rate of five parts, by processor time of this process.
template <typename Each>
double rate_per_s(const std::vector<std::vector<std::uint8_t>>& octets, Each each) {
    double best = 0.0;
    for (int part = 0; part < 5; ++part) {
        const std::clock_t start = std::clock();
        for (int round = 0; round < rounds / 5; ++round)
            for (const auto& packet : octets) each(packet);
        const double took_s = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
        best = std::max(best, static_cast<double>(rounds / 5) * static_cast<double>(octets.size()) / took_s);
    }
    return best;
}

}  // namespace

int main() {
    const auto loaded = dictionary::load(AEOLIS_SOURCE_DIR "/dictionaries/msl");
    if (!loaded.dictionary) {
        std::fprintf(stderr, "dictionaries/msl breaks a rule: see aeolis dictionary check\n");
        return 1;
    }
    const auto& dictionary = *loaded.dictionary;
    const auto* wanted = dictionary.packet("GncNavigation");
    if (wanted == nullptr) return 1;
    const auto octets = packets_of(dictionary, *wanted);

    std::uint64_t sum = 0;
    const double limit = rate_per_s(octets, [&](const auto& packet) { sum += crc16(packet); });

    // Cost of copying the same octets: a lower bound for anything that reads each of them.
    std::vector<std::uint8_t> copy(wanted->octets);
    const double copied = rate_per_s(octets, [&](const auto& packet) {
        std::memcpy(copy.data(), packet.data(), packet.size());
        sum += copy[packet.size() - 1];
    });

    const telemetry::Decommutator decommutator{dictionary};
    telemetry::Decoded decoded;
    std::uint64_t refused = 0;
    const double rate = rate_per_s(octets, [&](const auto& packet) {
        if (decommutator.decode(packet, decoded)) ++refused;
        sum += decoded.raw[0];
    });
    telemetry::PacketRegister packets;
    const double registered =
        rate_per_s(octets, [&](const auto& packet) { packets.add(packet, telemetry::Path::recorded); });

    std::printf("GncNavigation, %u octets, %zu fields (%llu)\n", wanted->octets, wanted->fields.size(),
                static_cast<unsigned long long>(sum & 1U));
    std::printf("decommutated     %10.0f /s   goal %.0f /s   ratio %.2f\n", rate, goal_per_s, rate / goal_per_s);
    std::printf("CRC-16 alone     %10.0f /s   decommutation reaches %.2f of it\n", limit, rate / limit);
    std::printf("memcpy alone     %10.0f /s   decommutation reaches %.3f of it\n", copied, rate / copied);
    std::printf("packet register  %10.0f /s\n", registered);
    if (refused > 0) std::printf("%llu packets were refused\n", static_cast<unsigned long long>(refused));
    return rate >= goal_per_s && refused == 0 ? 0 : 1;
}
