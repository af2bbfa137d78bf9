// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "telemetry/mfsk/tone_evidence.hpp"

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

namespace aeolis::telemetry {

/// A hop as the decision sees it.
struct HopEvidence {
    std::int64_t first_sample = 0;
    CarrierLock lock = CarrierLock::searching;
    bool found = false;   ///< else all else is zero
    double energy = 0.0;  ///< of a tone in this hop over the noise density, from the carrier
    ToneSums sums{};      ///< scaled: noise has E|G|² = energy, a tone adds |G| = energy
    double total_n0_hz = 0.0;
    double doppler_hz = 0.0;  ///< predict and tracked
};

/// A symbol that was decided.
struct DecidedSymbol {
    std::int64_t first_sample =
        0;  ///< on the grid of hops; before the first sample when its beginning was not received
    std::optional<std::uint8_t> tone;  ///< none: erased
    ToneEvidence evidence;
    double seen_fraction = 0.0;                 ///< of the symbol, with a carrier
    double total_c_n0_dbhz = 0.0;               ///< total power to noise density, the mean where seen
    double doppler_hz = 0.0;                    ///< where seen, in the mean
    CarrierLock lock = CarrierLock::searching;  ///< the worst during the symbol
};

/// Finds where symbols begin and which they are: the likeliest sequence of symbols and pauses, by dynamic programming.
///
/// A symbol may begin at any hop; it then lasts `symbol_hops`, and no two overlap. A beginning costs ln(symbol_hops),
/// as an event that is expected once a symbol does, and gains the symbol's log likelihood ratio. A symbol comes out
/// when the likeliest way to here, the part of a symbol that is still coming in included, leads over every way without
/// that symbol (same tone, the same beginning to a tenth of a symbol) by `decided_lead`; at the latest two symbols
/// after its end. Erased: a symbol whose likeliest tone has less than `least_likelihood`, or of which less than a
/// quarter was seen. Source: [forney-1973] for the search over survivors; the early decision is ours.
class SymbolSequence {
  public:
    static constexpr double least_likelihood = 0.9;  ///< ours, as in the statistical model
    static constexpr double least_seen_fraction =
        0.25;                                     ///< ours: what little is seen is seen while the carrier swerves
    static constexpr double decided_lead = 20.0;  ///< e^20 times likelier; ours

    explicit SymbolSequence(int symbol_hops, std::int64_t hop_samples);

    void push(const HopEvidence& hop, std::vector<DecidedSymbol>& out);
    /// The rest, taking it that nothing more comes.
    void finish(std::vector<DecidedSymbol>& out);

  private:
    struct State {  ///< after so many hops
        double score = 0.0;
        std::int64_t last_end = -1;           ///< of the latest symbol on the way here, in hops; −1: none
        std::optional<DecidedSymbol> symbol;  ///< the one that ends here
    };
    DecidedSymbol decide() const;
    double begin_cost() const;
    const State& state(std::int64_t hops) const { return states_[static_cast<std::size_t>(hops - first_state_)]; }
    std::int64_t before(std::int64_t end) const { return std::max(end - symbol_hops_, first_state_); }
    /// End of the first symbol after what came out, on the way to `hops`; −1: none.
    std::int64_t first_on_way(std::int64_t hops) const;
    bool is_same(std::int64_t end, std::int64_t other_end) const;
    void settle(std::vector<DecidedSymbol>& out);
    void come_out(std::int64_t first, std::vector<DecidedSymbol>& out);

    int symbol_hops_;
    std::int64_t hop_samples_;
    std::deque<HopEvidence> hops_;  ///< the newest symbol_hops
    std::deque<State> states_;
    std::int64_t first_state_ = 0, hops_seen_ = 0, came_out_ = 0;  ///< all up to here came out
};

}  // namespace aeolis::telemetry
