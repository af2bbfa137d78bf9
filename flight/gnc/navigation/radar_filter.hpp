// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"
#include "flight/gnc/navigation/dead_reckoning.hpp"
#include "flight/gnc/navigation/radar_batch.hpp"
#include "flight/gnc/quantities.hpp"
#include "flight/gnc/vector.hpp"

#include <array>
#include <cstdint>

// Corrects the navigated altitude and velocity by radar solutions.
//
//   residual = radar's average − average of the navigated history over the same span
//   Δh = k_h · residual_h,  Δv = k_v · residual_v ;  the history is shifted by the correction
//
// Frame    M; altitude along the local vertical     In   RadarSolution, 1 Hz     Out   RadarJudgement
// Memory   9 s of navigated history at 16 Hz
// Faults   a solution whose residual is beyond the gate is refused and counted; after five refusals in a row, the
//          next solution is taken whole
// Source   R25; the gains are our assumption: the first solution is taken whole. Of later ones a third of the velocity,
//          which halves its noise, and 0.8 of the altitude, whose error is a part of the range: corrected late, it
//          would be that of a greater height
namespace aeolis::flight::gnc {

struct RadarCorrection {
    double altitude_m = 0.0;            ///< to add along the local vertical
    Vector3 v_M_mps = Vector3::Zero();  ///< to add to the velocity
    double gain = 1.0;                  ///< fraction of the residual that is corrected
};

/// How a solution was judged. R38
struct RadarJudgement {
    enum class Verdict : std::uint8_t {
        uncovered,  ///< the history does not cover it
        refused,    ///< beyond the gate
        taken,
        believed,  ///< beyond the gate, and taken whole all the same
    };
    Verdict verdict{};
    RadarCorrection correction;  ///< of what is taken or believed
    Conditions conditions;       ///< both residuals by their gates, and the refusals before

    bool accepted() const { return verdict == Verdict::taken || verdict == Verdict::believed; }
};

class RadarFilter {
  public:
    /// Adds the navigated state to the history; call each cycle, every fourth is kept.
    void remember(Sclk now, double altitude_m, const Vector3& v_MB_M);

    /// Judges a solution. `belief` widens the gate; a solution beyond the narrow gate but within the wide one is
    /// believed.
    RadarJudgement on(const Parameters& parameters, const RadarSolution& solution, Sclk now, const Vector3& up_M,
                      const Belief& belief = {});

    bool locked() const { return accepted_ > 0; }
    std::uint32_t accepted() const { return accepted_; }
    std::uint32_t refused() const { return refused_; }

    /// State for another computer, without the history, which is complete again five seconds after a hand-over.
    template <typename Exchange>
    void carry(Exchange& exchange) {
        exchange(accepted_, refused_, refused_in_a_row_);
    }

  private:
    struct Past {
        Sclk time;
        double altitude_m = 0.0;
        Vector3 v_MB_M = Vector3::Zero();
    };
    static constexpr std::size_t past_max = 144;  // 9 s at 16 Hz
    std::array<Past, past_max> past_{};
    std::uint32_t next_ = 0;
    std::uint32_t count_ = 0;
    std::uint32_t accepted_ = 0;
    std::uint32_t refused_ = 0;
    std::uint32_t refused_in_a_row_ = 0;
};

}  // namespace aeolis::flight::gnc
