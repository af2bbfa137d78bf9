// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/tone_evidence.hpp"
#include "telemetry/mfsk/carrier_fit.hpp"
#include "telemetry/mfsk/spectrum.hpp"

#include <array>
#include <complex>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

namespace aeolis::telemetry {

/// An eighth of a second of signal with its carrier removed.
struct CarrierHop {
    std::int64_t first_sample = 0;  ///< counted from the first sample ever pushed to the tracker
    CarrierLock lock = CarrierLock::searching;
    bool found = false;                          ///< false: `quadrature` is empty
    bool gap = false;                            ///< too few samples to tell
    double frequency_hz = 0.0, rate_hzps = 0.0;  ///< of the carrier in the samples, at the hop's middle
    double frequency_deviation_hz = 0.0;         ///< standard deviation of the frequency; 0 unless found
    double carrier_n0_hz = 0.0;                  ///< carrier power to noise density, of the window that was fitted
    double carrier_power = 0.0;                  ///< in the units of the samples
    double seen = 0.0;                           ///< fraction of the hop that is not a gap
    /// The component in quadrature to the carrier, which holds the tone, if any, and the component in phase with it,
    /// less the carrier. Both are scaled by the hop's own noise to a noise deviation of about 1 a sample. Gaps are 0.
    std::vector<float> quadrature, in_phase;
    /// Powers around `spectrum_hz` in the samples, near the carrier, as Spectrum gives them. In the hop's noise each
    /// has a mean of 1.
    std::vector<float> spectrum;
    double spectrum_hz = 0.0;
};

/// The division of samples into hops, for the tracker and the tone correlator.
struct HopLayout {
    /// For samples at `rate_hz`: hops of about 1/8 s in 32 parts, decimated to 6 kHz or more where possible.
    explicit HopLayout(double rate_hz);

    double rate_hz;
    int thinning;      ///< samples summed into one
    int part_samples;  ///< decimated samples in a part
    static constexpr int parts = 32;
    int hop_samples() const { return thinning * thinned_samples(); }
    int thinned_samples() const { return parts * part_samples; }
    double thinned_rate_hz() const { return rate_hz / thinning; }
    double hop_s() const { return hop_samples() / rate_hz; }
};

/// Tracks a carrier of known initial frequency.
///
/// Each hop is fitted in the middle of a window of hops. Frequency and rate of the newest fit predict where the next
/// one is sought.
/// In      hops of samples, contiguous; a sample of exactly 0 is a gap
/// Out     each hop once, in order, up to half a window later
/// Noise   of each hop by itself: the median of its spectrum around the carrier. All else is relative to it, so that a
///         change of gain changes nothing. Parts of 4 ms with four times a hop's usual power are gaps
/// Effort  a narrow fit over 0.6 s, a wide one when that fails or has too little energy, then over 0.4 and 0.1 s for a
///         carrier that swings, and over 0.4 s along lines that bend for one that swerves, as when a parachute opens:
///         there the waiting hops are turned to each new fit; windows of 1.4, 2.6 and 5.1 s for a weak one
/// Memory  the longest window
/// Faults  a line beyond the parts' band, which the fit sees at another frequency, is not in the samples there: it is
///         lost at once. The carrier is lost after 1.5 s, or three quarters of a window, without it (20 s when it has
///         long been too weak to be acquired again), gaps not counted, or after a gap of 10 s: hops in memory are then
///         reported as not found
class CarrierTracker {
  public:
    explicit CarrierTracker(const HopLayout& layout);

    /// Starts tracking with the hop that begins at `first_sample`.
    void start(std::int64_t first_sample, double frequency_hz, double rate_hzps);

    /// Takes one hop of samples; appends the hops that are now decided to `out`.
    void push(std::span<const std::complex<float>> hop, std::vector<CarrierHop>& out);
    /// Fits the waiting hops as far as possible; afterwards the tracker is as before start().
    void finish(std::vector<CarrierHop>& out);

    bool lost() const { return lost_; }
    /// False once the line that was followed proved to be elsewhere.
    bool genuine() const { return genuine_ >= genuine_least; }
    /// Hops since the last that was found, gaps not counted.
    int missed() const { return missed_; }
    std::int64_t next_sample() const { return next_sample_; }  ///< start of the next hop

  private:
    static constexpr double genuine_least = 0.4;  ///< chosen
    struct Wiped {                                ///< a hop with the predicted phase removed
        std::int64_t first_sample = 0;
        double phase_cycles = 0.0, frequency_hz = 0.0, rate_hzps = 0.0;  ///< of the prediction, at the hop's start
        std::vector<std::complex<float>> thinned;
        std::array<std::complex<float>, HopLayout::parts> parts{};
        double seen = 0.0;     ///< fraction that is not a gap
        double density = 0.0;  ///< of the noise before it was scaled to 1
        std::vector<float> spectrum;
        double spectrum_hz = 0.0;
        double cycles_at(double from_begin_s) const {
            return phase_cycles + frequency_hz * from_begin_s + 0.5 * rate_hzps * from_begin_s * from_begin_s;
        }
    };
    struct Window {
        int hops;  ///< odd
        double length_s;
        CarrierFit fit;
        FitSpan narrow, wide;
        double least_energy(bool with_wide) const;
    };
    struct Fitted {
        CarrierLine line;  ///< with noise of density 1
        double length_s = 0.0, seen = 0.0;
        bool found = false, wide = false;
        bool swerves = false;  ///< its rate changes
        /// Energy a second, less that of noise; 0 unless found.
        double gathered() const;
    };

    Wiped wipe(std::span<const std::complex<float>> hop);
    void leave_out_bursts(Wiped& wiped) const;
    void normalize(Wiped& wiped);
    void sum_parts(Wiped& wiped) const;
    void align(std::size_t middle, int hops, Fitted& fitted);
    void turn_waiting();
    void fit_waiting(std::vector<CarrierHop>& out);
    Fitted fit_around(std::size_t middle, Window& window, bool wide);
    Fitted fit_swinging(std::size_t middle, const Fitted& usual);
    Fitted fit_swerving(std::size_t middle);
    Fitted may_swerve(std::size_t middle, const Fitted& straight);
    CarrierHop demodulated(const Wiped& hop, const CarrierLine& line, const Fitted& fitted);
    void follow(const Wiped& hop, const Fitted& fitted);
    void choose_window(double energy);
    void shorten();

    HopLayout layout_;
    std::vector<Window> windows_, swinging_;
    std::size_t window_ = 0;
    Spectrum spectrum_;  ///< of a hop
    std::vector<std::complex<float>> aligned_, bent_;

    std::deque<Wiped> hops_;
    std::size_t waiting_ = 0;  ///< index in hops_ of the first not yet fitted
    std::int64_t next_sample_ = 0;
    double phase_cycles_ = 0.0;
    double frequency_hz_ = 0.0, rate_hzps_ = 0.0;  ///< of the newest fit
    std::int64_t frequency_sample_ = 0;            ///< the sample at which that holds
    double noise_density_ = 0.0;
    double level_hz_ = 0.0;  ///< carrier to noise density, a long average
    double genuine_ = 1.0;   ///< fraction of the fitted amplitude that the samples have at its frequency; running mean
    int missed_ = 0, gap_hops_ = 0;
    int short_in_row_ = 0;  ///< hops found by a shorter window alone
    bool lost_ = true, settled_ = false;
    double energy_before_longer_ = 0.0;  ///< positive while a longer window is on trial
    int short_for_ = 0;                  ///< hops for which no longer window is tried
};

}  // namespace aeolis::telemetry
