// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/tone_evidence.hpp"
#include "telemetry/mfsk/carrier_fit.hpp"

#include <array>
#include <complex>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

namespace aeolis::telemetry {

/// An eighth of a second of signal with its carrier removed.
struct CarrierHop {
    std::int64_t first_sample = 0;  ///< of the samples pushed to the tracker since the beginning of everything
    CarrierLock lock = CarrierLock::searching;
    bool found = false;                          ///< else `quadrature` is empty
    double frequency_hz = 0.0, rate_hzps = 0.0;  ///< of the carrier among the samples, in the hop's middle
    double carrier_n0_hz = 0.0;                  ///< carrier power to noise density
    /// What stands at right angles to the carrier, with noise of deviation 1 a sample: the tone, if any.
    std::vector<float> quadrature;
};

/// How samples are cut for the tracker and the tone correlator.
struct HopLayout {
    /// For samples at `rate_hz`: hops of about 1/8 s of 32 parts, thinned to not below 6 kHz or not at all.
    explicit HopLayout(double rate_hz);

    double rate_hz;
    int thinning;      ///< samples summed to one
    int part_samples;  ///< thinned samples in a part
    static constexpr int parts = 32;
    int hop_samples() const { return thinning * thinned_samples(); }
    int thinned_samples() const { return parts * part_samples; }
    double thinned_rate_hz() const { return rate_hz / thinning; }
    double hop_s() const { return hop_samples() / rate_hz; }
};

/// Follows a carrier whose frequency was found: each hop is fitted in the middle of a window of hops, and frequency and
/// rate of the newest fit predict where the next is looked for.
///
/// In      hops of samples, one after the other     Out   each hop once, in order, up to half a window later
/// Effort  a narrow look at 0.6 s; where that finds nothing a wide one; windows of 1.4, 2.6 and 5.1 s when the carrier
///         is weak
/// Memory  the longest window
/// Faults  after 1.5 s, or three quarters of a window, without a carrier (20 s when it has long been too weak to be
///         found anew) it is lost: the hops in memory come out as not found
class CarrierTracker {
  public:
    explicit CarrierTracker(const HopLayout& layout, double carrier_fraction);

    /// Begins with the hop that begins at `first_sample`.
    void start(std::int64_t first_sample, double frequency_hz, double rate_hzps);

    /// One hop of samples; what became of this and earlier hops is added to `out`.
    void push(std::span<const std::complex<float>> hop, std::vector<CarrierHop>& out);
    /// The hops that wait for later ones, as far as they can be fitted; then it is as before a start.
    void finish(std::vector<CarrierHop>& out);

    bool lost() const { return lost_; }
    std::int64_t next_sample() const { return next_sample_; }  ///< where the next hop begins

  private:
    struct Wiped {  ///< a hop turned back by the predicted phase
        std::int64_t first_sample = 0;
        double phase_cycles = 0.0, frequency_hz = 0.0, rate_hzps = 0.0;  ///< of the prediction, at the hop's beginning
        std::vector<std::complex<float>> thinned;
        std::array<std::complex<float>, HopLayout::parts> parts{};
        double noise = 0.0;  ///< power to density N0 of the time, per hertz
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

    Wiped wipe(std::span<const std::complex<float>> hop);
    void fit_waiting(std::vector<CarrierHop>& out);
    CarrierLine fit_around(std::size_t middle, Window& window, bool wide);
    CarrierHop demodulated(const Wiped& hop, const CarrierLine& line) const;
    void follow(const Wiped& hop, const CarrierLine& line);
    void choose_window(double energy);
    void shorten();

    HopLayout layout_;
    double carrier_fraction_;
    std::vector<Window> windows_;
    std::size_t window_ = 0;
    std::vector<std::complex<float>> aligned_;

    std::deque<Wiped> hops_;
    std::size_t waiting_ = 0;  ///< in hops_: the first not yet fitted
    std::int64_t next_sample_ = 0;
    double phase_cycles_ = 0.0;
    double frequency_hz_ = 0.0, rate_hzps_ = 0.0;  ///< of the newest fit
    std::int64_t frequency_sample_ = 0;            ///< where that holds
    double noise_density_ = 0.0, carrier_power_ = 0.0;
    double level_hz_ = 0.0;  ///< carrier to noise density, over a longer time
    int missed_ = 0;
    bool lost_ = true, settled_ = false;
    double energy_before_longer_ = 0.0;  ///< above 0: the window has just been lengthened
    int short_for_ = 0;                  ///< no longer window for so many hops
};

}  // namespace aeolis::telemetry
