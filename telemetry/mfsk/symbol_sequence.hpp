// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "telemetry/mfsk/tone_evidence.hpp"

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

namespace aeolis::telemetry {

/// A hop's input to the symbol decision.
struct HopEvidence {
    std::int64_t first_sample = 0;
    CarrierLock lock = CarrierLock::searching;
    bool found = false;   ///< false: the following fields are zero
    double energy = 0.0;  ///< expected energy of a tone in this hop over the noise density, from the carrier
    ToneSums sums{};      ///< scaled: noise has E|G|² = energy, a tone adds |G| = energy
    ToneSums in_phase{};  ///< the same of the component in phase with the carrier, where a tone adds nothing
    SidebandRatios sideband_ratios = equal_sidebands();                        ///< of the noise
    double total_n0_hz = 0.0;                                                  ///< running mean
    double fit_n0_hz = 0.0;                                                    ///< the same of this hop's window alone
    double doppler_hz = 0.0;                                                   ///< predicted plus tracked
    double frequency_hz = 0.0, frequency_deviation_hz = 0.0, rate_hzps = 0.0;  ///< tracked
    double lead_s = 0.0;                                                       ///< of the subcarriers' time, by Doppler
    bool gap = false;                                                          ///< too few samples to tell
};

/// A decided symbol.
struct DecidedSymbol {
    std::int64_t first_sample = 0;     ///< on the grid of hops; before the first sample when its start was not received
    std::optional<std::uint8_t> tone;  ///< none: erased
    ToneEvidence evidence;
    double seen_fraction = 0.0;                 ///< fraction of the symbol with a carrier
    double total_c_n0_dbhz = 0.0;               ///< total power to noise density, mean over that fraction
    double doppler_hz = 0.0;                    ///< mean over that fraction
    CarrierLock lock = CarrierLock::searching;  ///< the worst during the symbol
};

/// Finds symbols and their starts: the most likely sequence of symbols and pauses, by dynamic programming.
///
/// A symbol may start at any hop; it lasts `symbol_hops`, and symbols do not overlap. A start costs ln(symbol_hops), as
/// one start is expected in that many hops, and gains the symbol's log likelihood ratio. A symbol is decided when the
/// most likely path, including the symbol now being received, leads every path without that symbol (the same tone, the
/// same start to a tenth of a symbol) by `decided_lead`; at the latest two symbols after its end. A symbol is erased
/// when its best tone has less than `least_likelihood`, or when less than a quarter of it was seen. Source:
/// [forney-1973]
/// for the search over survivors; the early decision is our design. With a grid each symbol is decided at its end.
class SymbolSequence {
  public:
    static constexpr double least_likelihood = 0.9;  ///< chosen, as in the statistical model
    static constexpr double least_seen_fraction =
        0.25;                                     ///< chosen: a smaller part is seen only while the carrier swerves
    static constexpr double decided_lead = 20.0;  ///< e^20 times likelier; chosen

    /// When symbols begin, if that is known; in hops, not necessarily whole ones.
    struct Grid {
        double first_hop = 0.0, symbol_hops = 0.0;
    };
    explicit SymbolSequence(int symbol_hops, std::int64_t hop_samples, std::optional<Grid> grid = {});

    void push(const HopEvidence& hop, std::vector<DecidedSymbol>& out);
    /// Decides the remaining symbols as if no more signal came.
    void finish(std::vector<DecidedSymbol>& out);

  private:
    struct State {  ///< after a number of hops
        double score = 0.0;
        std::int64_t last_end = -1;           ///< of the latest symbol on this path, in hops; −1: none
        std::optional<DecidedSymbol> symbol;  ///< the symbol that ends here
    };
    DecidedSymbol decide() const;
    double begin_cost() const;
    bool ends_by_grid() const;
    const State& state(std::int64_t hops) const { return states_[static_cast<std::size_t>(hops - first_state_)]; }
    std::int64_t before(std::int64_t end) const { return std::max(end - symbol_hops_, first_state_); }
    /// End of the first undecided symbol on the path to `hops`; −1: none.
    std::int64_t first_on_way(std::int64_t hops) const;
    bool is_same(std::int64_t end, std::int64_t other_end) const;
    void settle(std::vector<DecidedSymbol>& out);
    void come_out(std::int64_t first, std::vector<DecidedSymbol>& out);

    int symbol_hops_;
    std::int64_t hop_samples_;
    std::optional<Grid> grid_;
    std::deque<HopEvidence> hops_;  ///< the newest symbol_hops
    std::deque<State> states_;
    std::int64_t first_state_ = 0, hops_seen_ = 0, came_out_ = 0;  ///< came_out_: everything up to here is decided
};

}  // namespace aeolis::telemetry
