// SPDX-License-Identifier: Apache-2.0
#include "telemetry/mfsk/symbol_sequence.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace aeolis::telemetry {
namespace {

constexpr double energy_of_use = 2.0;  // E/N0 below which no tone can be told; chosen
constexpr int settle_hops = 8;         // chosen: decisions are sought once a second

/// Sum of the hops' evidence, the newest hop first.
struct Gathered {
    ToneSums sums{}, in_phase{};
    SidebandRatios sideband_ratios = equal_sidebands();
    double energy = 0.0;
    void add(const HopEvidence& hop) {
        if (!hop.found) return;
        sideband_ratios = hop.sideband_ratios;
        energy += hop.energy;
        for (std::size_t tone = 0; tone < sums.size(); ++tone) {
            sums[tone] += hop.sums[tone];
            in_phase[tone] += hop.in_phase[tone];
        }
    }
    ToneEvidence evidence() const { return tone_evidence_of(sums, in_phase, sideband_ratios, energy); }
};

}  // namespace

SymbolSequence::SymbolSequence(int symbol_hops, std::int64_t hop_samples, std::optional<Grid> grid)
    : symbol_hops_(symbol_hops), hop_samples_(hop_samples), grid_(grid), states_(1) {}

bool SymbolSequence::ends_by_grid() const {
    const auto symbol = [&](std::int64_t hops) {
        return std::floor((static_cast<double>(hops) - grid_->first_hop + 0.5) / grid_->symbol_hops);
    };
    return symbol(hops_seen_) > symbol(hops_seen_ - 1);
}

double SymbolSequence::begin_cost() const {
    return std::log(static_cast<double>(symbol_hops_));
}

DecidedSymbol SymbolSequence::decide() const {
    Gathered gathered;
    DecidedSymbol symbol;
    double total = 0.0;
    int seen = 0;
    symbol.lock = hops_.front().lock;
    for (const HopEvidence& hop : hops_) {
        symbol.lock = std::max(symbol.lock, hop.lock);
        gathered.add(hop);
        if (!hop.found) continue;
        ++seen;
        total += hop.total_n0_hz;
        symbol.doppler_hz += hop.doppler_hz;
    }
    symbol.evidence = gathered.evidence();
    if (gathered.energy < energy_of_use)
        symbol.evidence.log_likelihood_ratio = -std::numeric_limits<double>::infinity();
    if (seen > 0) {
        symbol.seen_fraction = static_cast<double>(seen) / symbol_hops_;
        symbol.total_c_n0_dbhz = 10.0 * std::log10(std::max(total / seen, 1e-9));
        symbol.doppler_hz /= seen;
    }
    symbol.first_sample = hops_.back().first_sample - (symbol_hops_ - 1) * hop_samples_;
    if (symbol.evidence.best[0].likelihood >= least_likelihood && symbol.seen_fraction >= least_seen_fraction)
        symbol.tone = symbol.evidence.best[0].tone;
    return symbol;
}

void SymbolSequence::push(const HopEvidence& hop, std::vector<DecidedSymbol>& out) {
    hops_.push_back(hop);
    if (std::ssize(hops_) > symbol_hops_) hops_.pop_front();
    ++hops_seen_;
    if (grid_) {
        if (!ends_by_grid()) return;
        if (const DecidedSymbol ending = decide(); std::isfinite(ending.evidence.log_likelihood_ratio))
            out.push_back(ending);
        return;
    }
    State next{states_.back().score, states_.back().last_end, std::nullopt};
    if (const auto from = std::max<std::int64_t>(hops_seen_ - symbol_hops_, 0); from >= first_state_) {
        const DecidedSymbol ending = decide();
        const double score = state(from).score + ending.evidence.log_likelihood_ratio - begin_cost();
        if (score > next.score) next = {score, hops_seen_, ending};
    }
    states_.push_back(next);
    if (hops_seen_ % settle_hops == 0) settle(out);
}

std::int64_t SymbolSequence::first_on_way(std::int64_t hops) const {
    std::int64_t first = -1;
    for (std::int64_t end = state(hops).last_end; end > came_out_; end = state(before(end)).last_end) first = end;
    return first;
}

bool SymbolSequence::is_same(std::int64_t end, std::int64_t other_end) const {
    if (end < 0 || other_end < 0) return end == other_end;
    return state(end).symbol->evidence.best[0].tone == state(other_end).symbol->evidence.best[0].tone &&
           10 * std::abs(end - other_end) <= symbol_hops_;
}

void SymbolSequence::settle(std::vector<DecidedSymbol>& out) {
    if (hops_.empty() || grid_) return;
    // Every later path leads through one of the last symbol's worth of states, with the part of a symbol seen since.
    struct Survivor {
        double score;
        std::int64_t hops;
    };
    std::vector<Survivor> survivors;
    Gathered since;
    const std::int64_t oldest_survivor = std::max({hops_seen_ - std::ssize(hops_) + 1, first_state_, came_out_});
    for (std::int64_t hops = hops_seen_; hops >= oldest_survivor; --hops) {
        if (hops < hops_seen_) since.add(hops_[hops_.size() - static_cast<std::size_t>(hops_seen_ - hops)]);
        const double partial =
            since.energy < energy_of_use ? 0.0 : since.evidence().log_likelihood_ratio - begin_cost();
        survivors.push_back({state(hops).score + std::max(partial, 0.0), hops});
    }
    for (;;) {
        const Survivor best = *std::ranges::max_element(survivors, {}, &Survivor::score);
        const std::int64_t first = first_on_way(best.hops);
        if (first < 0) break;
        const bool leads = std::ranges::all_of(survivors, [&](const Survivor& other) {
            return other.score < best.score - decided_lead || is_same(first_on_way(other.hops), first);
        });
        if (!leads && hops_seen_ - first < 2 * symbol_hops_) break;
        come_out(first, out);
        std::erase_if(survivors, [&](const Survivor& other) { return other.hops < first; });
    }
    const std::int64_t oldest = std::max(came_out_, hops_seen_ - 4 * symbol_hops_);
    while (first_state_ < oldest) {
        states_.pop_front();
        ++first_state_;
    }
}

void SymbolSequence::come_out(std::int64_t first, std::vector<DecidedSymbol>& out) {
    out.push_back(*state(first).symbol);
    // A decided symbol stays: states that were reached without it are reached through it instead.
    while (first_state_ < first) {
        states_.pop_front();
        ++first_state_;
    }
    came_out_ = first;
    for (std::int64_t hops = first + 1; hops <= hops_seen_; ++hops) {
        State& each = states_[static_cast<std::size_t>(hops - first_state_)];
        State anew{state(hops - 1).score, state(hops - 1).last_end, std::nullopt};
        if (each.symbol && hops - symbol_hops_ >= first) {
            const double score =
                state(hops - symbol_hops_).score + each.symbol->evidence.log_likelihood_ratio - begin_cost();
            if (score > anew.score) anew = {score, hops, each.symbol};
        }
        each = anew;
    }
}

void SymbolSequence::finish(std::vector<DecidedSymbol>& out) {
    for (int i = 0; i < 2 * symbol_hops_ && hops_seen_ > 0; ++i) {
        HopEvidence nothing;
        nothing.first_sample = hops_.back().first_sample + hop_samples_;
        push(nothing, out);
    }
    settle(out);
}

}  // namespace aeolis::telemetry
