// SPDX-License-Identifier: Apache-2.0
#include "telemetry/mfsk/carrier_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace aeolis::telemetry {
namespace {

constexpr double turn_rad = 2.0 * std::numbers::pi;
constexpr double thinned_rate_least_hz = 6000.0;  // the sum attenuates the highest tone by 0.12 dB; chosen
constexpr double parts_hz = 256.0;                // chosen: a prediction wrong by 100 Hz is still seen
constexpr double false_find = 0.005;              // probability in noise, a fit; chosen
constexpr double longer_gain = 1.2;               // a longer window must gather this factor more; chosen
constexpr int short_for_hops = 16;                // after a failure, for which no longer window is tried; chosen
constexpr double energy_weak = 22.0;              // below this a longer window is tried; chosen
constexpr double energy_strong = 60.0;            // above this a shorter one; chosen
constexpr double lost_after_s = 1.5;              // at least; chosen
constexpr double weak_lost_after_s = 20.0;        // chosen
constexpr double weak_level_hz = 25.0;            // 14 dB-Hz: the search over 4 s needs more; chosen
constexpr double level_of_old = 0.99;             // of each hop in the running mean of C/N0: 12 s; chosen
constexpr double noise_gain = 0.08;               // of each hop in the running mean of the noise: 1.5 s; chosen

}  // namespace

HopLayout::HopLayout(double rate)
    : rate_hz(rate), thinning(std::max(1, static_cast<int>(rate / thinned_rate_least_hz))),
      part_samples(std::max(1, static_cast<int>(std::lround(rate / thinning / parts_hz)))) {}

CarrierTracker::CarrierTracker(const HopLayout& layout, double carrier_fraction)
    : layout_(layout), carrier_fraction_(carrier_fraction) {
    const double part_s = layout.part_samples / layout.thinned_rate_hz();
    for (const int hops : {5, 11, 21, 41}) {
        windows_.push_back({hops, hops * layout.hop_s(), CarrierFit{hops * HopLayout::parts, part_s},
                            FitSpan{200.0 / hops, 4}, FitSpan{500.0 / hops, CarrierFit::rate_lines_max}});
    }
}

void CarrierTracker::start(std::int64_t first_sample, double frequency_hz, double rate_hzps) {
    hops_.clear();
    waiting_ = 0;
    window_ = 0;
    next_sample_ = frequency_sample_ = first_sample;
    frequency_hz_ = frequency_hz;
    rate_hzps_ = rate_hzps;
    noise_density_ = carrier_power_ = level_hz_ = 0.0;
    missed_ = 0;
    energy_before_longer_ = 0.0;
    short_for_ = 0;
    lost_ = settled_ = false;
}

CarrierTracker::Wiped CarrierTracker::wipe(std::span<const std::complex<float>> hop) {
    Wiped wiped;
    wiped.first_sample = next_sample_;
    const double since_s = static_cast<double>(next_sample_ - frequency_sample_) / layout_.rate_hz;
    wiped.frequency_hz = frequency_hz_ + rate_hzps_ * since_s;
    wiped.rate_hzps = rate_hzps_;
    wiped.phase_cycles = phase_cycles_;
    wiped.thinned.reserve(static_cast<std::size_t>(layout_.thinned_samples()));

    const double sample_s = 1.0 / layout_.rate_hz;
    std::complex<double> phasor = std::polar(1.0, -turn_rad * phase_cycles_);
    std::complex<double> step =
        std::polar(1.0, -turn_rad * (wiped.frequency_hz * sample_s + 0.5 * wiped.rate_hzps * sample_s * sample_s));
    const std::complex<double> bend = std::polar(1.0, -turn_rad * wiped.rate_hzps * sample_s * sample_s);
    const float scale = 1.0F / static_cast<float>(layout_.thinning);
    double power = 0.0;
    for (std::size_t i = 0; i < hop.size();) {
        float in_phase = 0.0F, quadrature = 0.0F;
        for (int k = 0; k < layout_.thinning; ++k, ++i) {
            const auto p = static_cast<std::complex<float>>(phasor);
            in_phase += hop[i].real() * p.real() - hop[i].imag() * p.imag();
            quadrature += hop[i].real() * p.imag() + hop[i].imag() * p.real();
            phasor = {phasor.real() * step.real() - phasor.imag() * step.imag(),
                      phasor.real() * step.imag() + phasor.imag() * step.real()};
            step = {step.real() * bend.real() - step.imag() * bend.imag(),
                    step.real() * bend.imag() + step.imag() * bend.real()};
        }
        wiped.thinned.emplace_back(scale * in_phase, scale * quadrature);
        power += std::norm(wiped.thinned.back());
    }
    for (int part = 0; part < HopLayout::parts; ++part) {
        std::complex<float> sum{};
        for (int i = 0; i < layout_.part_samples; ++i)
            sum += wiped.thinned[static_cast<std::size_t>(part * layout_.part_samples + i)];
        wiped.parts[static_cast<std::size_t>(part)] = sum / static_cast<float>(layout_.part_samples);
    }
    phase_cycles_ = std::fmod(wiped.cycles_at(layout_.hop_s()), 1.0);
    next_sample_ += layout_.hop_samples();

    // Noise is the power that is not signal; for a signal without noise, a millionth of it.
    const double total = power / layout_.thinned_samples();
    const double density =
        std::max(total - carrier_power_ / carrier_fraction_, 1e-6 * total) / layout_.thinned_rate_hz();
    noise_density_ = noise_density_ == 0.0 ? density : noise_density_ + noise_gain * (density - noise_density_);
    wiped.noise = noise_density_;
    return wiped;
}

CarrierLine CarrierTracker::fit_around(std::size_t middle, Window& window, bool wide) {
    const auto aside = static_cast<std::size_t>(window.hops / 2);
    const Wiped& reference = hops_[middle];
    const double part_s = layout_.hop_s() / HopLayout::parts;
    aligned_.clear();
    for (std::size_t i = middle - aside; i <= middle + aside; ++i) {
        const Wiped& hop = hops_[i];
        const double begin_s = static_cast<double>(hop.first_sample - reference.first_sample) / layout_.rate_hz;
        // Rotates from the hop's own prediction to that of the window's middle.
        for (int part = 0; part < HopLayout::parts; ++part) {
            const double at_s = (part + 0.5) * part_s;
            const double cycles = hop.cycles_at(at_s) - reference.cycles_at(begin_s + at_s);
            const auto& sum = hop.parts[static_cast<std::size_t>(part)];
            aligned_.push_back(
                i == middle ? sum : sum * static_cast<std::complex<float>>(std::polar(1.0, turn_rad * cycles)));
        }
    }
    const double noise = std::max(reference.noise / part_s, 1e-30);
    return window.fit.fit(aligned_, noise, wide ? window.wide : window.narrow);
}

CarrierHop CarrierTracker::demodulated(const Wiped& hop, const CarrierLine& line) const {
    CarrierHop out;
    out.first_sample = hop.first_sample;
    out.found = true;
    out.frequency_hz = hop.frequency_hz + 0.5 * hop.rate_hzps * layout_.hop_s() + line.frequency_hz;
    out.rate_hzps = hop.rate_hzps + line.rate_hzps;
    const double noise_power = hop.noise * layout_.thinned_rate_hz();
    out.carrier_n0_hz = line.amplitude * line.amplitude / hop.noise;
    const double sample_s = 1.0 / layout_.thinned_rate_hz();
    const double begin_s = -0.5 * layout_.hop_s() + 0.5 * sample_s;
    std::complex<double> phasor = std::polar(
        1.0, -line.phase_rad - turn_rad * (line.frequency_hz * begin_s + 0.5 * line.rate_hzps * begin_s * begin_s));
    std::complex<double> step = std::polar(
        1.0, -turn_rad * (line.frequency_hz * sample_s + line.rate_hzps * sample_s * (begin_s + 0.5 * sample_s)));
    const std::complex<double> bend = std::polar(1.0, -turn_rad * line.rate_hzps * sample_s * sample_s);
    const auto scale = static_cast<float>(1.0 / std::sqrt(0.5 * noise_power));
    out.quadrature.reserve(hop.thinned.size());
    for (const auto& sample : hop.thinned) {
        const auto p = static_cast<std::complex<float>>(phasor);
        out.quadrature.push_back(scale * (sample.real() * p.imag() + sample.imag() * p.real()));
        phasor *= step;
        step *= bend;
    }
    return out;
}

void CarrierTracker::follow(const Wiped& hop, const CarrierLine& line) {
    frequency_hz_ = hop.frequency_hz + 0.5 * hop.rate_hzps * layout_.hop_s() + line.frequency_hz;
    rate_hzps_ = hop.rate_hzps + line.rate_hzps;
    frequency_sample_ = hop.first_sample + layout_.hop_samples() / 2;
    const double power = line.amplitude * line.amplitude;
    const double level_hz = power / hop.noise;
    level_hz_ = level_hz_ == 0.0 ? level_hz : level_of_old * level_hz_ + (1.0 - level_of_old) * level_hz;
    carrier_power_ = carrier_power_ == 0.0 ? power : carrier_power_ + 2.0 * noise_gain * (power - carrier_power_);
}

double CarrierTracker::Window::least_energy(bool with_wide) const {
    const FitSpan& span = with_wide ? wide : narrow;
    return std::log(2.0 * span.frequency_hz * length_s * (2 * span.rate_lines + 1) / false_find);
}

void CarrierTracker::choose_window(double energy) {
    short_for_ = std::max(short_for_ - 1, 0);
    if (energy > energy_strong && window_ > 0) {
        --window_;
    } else if (energy < energy_weak && window_ + 1 < windows_.size() && short_for_ == 0) {
        energy_before_longer_ = energy;
        ++window_;
    }
}

// A longer window gathers more of a weak carrier, and less of a swerving one.
void CarrierTracker::shorten() {
    --window_;
    energy_before_longer_ = 0.0;
    short_for_ = short_for_hops;
}

void CarrierTracker::fit_waiting(std::vector<CarrierHop>& out) {
    while (waiting_ + static_cast<std::size_t>(windows_[window_].hops / 2) < hops_.size()) {
        const auto aside = static_cast<std::size_t>(windows_[window_].hops / 2);
        const Wiped& hop = hops_[waiting_];
        if (waiting_ < aside && window_ > 0) {  // the first hops have no half window before them
            shorten();
            continue;
        }
        CarrierHop done;
        done.first_sample = hop.first_sample;
        const std::size_t middle = std::max(waiting_, aside);
        if (middle + aside >= hops_.size()) break;
        Window& window = windows_[window_];
        bool wide = !settled_ || missed_ > 0;
        CarrierLine line = fit_around(middle, window, wide);
        if (line.energy < window.least_energy(false) && !wide) {
            wide = true;
            line = fit_around(middle, window, wide);
        }
        const bool found = line.energy >= window.least_energy(wide);
        if (found && line.energy < longer_gain * energy_before_longer_) {
            shorten();
            continue;
        }
        if (found) {
            energy_before_longer_ = 0.0;
            if (middle == waiting_) {
                done = demodulated(hop, line);
            } else {  // extrapolated from the window's middle to this earlier hop
                const Wiped& reference = hops_[middle];
                const double back_s = static_cast<double>(hop.first_sample - reference.first_sample) / layout_.rate_hz;
                const double mid_s = 0.5 * layout_.hop_s();
                CarrierLine moved = line;
                moved.phase_rad += turn_rad * (line.frequency_hz * back_s + 0.5 * line.rate_hzps * back_s * back_s +
                                               reference.cycles_at(back_s + mid_s) - hop.cycles_at(mid_s));
                moved.rate_hzps += reference.rate_hzps - hop.rate_hzps;
                moved.frequency_hz += line.rate_hzps * back_s + reference.frequency_hz +
                                      reference.rate_hzps * (back_s + mid_s) - hop.frequency_hz - hop.rate_hzps * mid_s;
                done = demodulated(hop, moved);
            }
            follow(hops_[middle], line);
            done.lock = settled_ && !wide && window_ == 0 ? CarrierLock::locked : CarrierLock::fluctuating;
            settled_ = true;
            missed_ = 0;
            choose_window(line.energy);
        } else if (energy_before_longer_ > 0.0) {
            shorten();
            continue;
        } else {
            done.lock = CarrierLock::coasting;
            done.frequency_hz = hop.frequency_hz + 0.5 * hop.rate_hzps * layout_.hop_s();
            done.rate_hzps = hop.rate_hzps;
            ++missed_;
        }
        out.push_back(std::move(done));
        ++waiting_;
    }
    const std::size_t kept = static_cast<std::size_t>(windows_.back().hops / 2);
    while (waiting_ > kept) {
        hops_.pop_front();
        --waiting_;
    }
}

void CarrierTracker::push(std::span<const std::complex<float>> hop, std::vector<CarrierHop>& out) {
    hops_.push_back(wipe(hop));
    fit_waiting(out);
    // A carrier too weak for a new search is waited for.
    const bool is_weak = level_hz_ < weak_level_hz;
    const double patience_s = is_weak ? weak_lost_after_s : std::max(lost_after_s, 0.75 * windows_[window_].length_s);
    if (missed_ * layout_.hop_s() > patience_s) finish(out);
}

void CarrierTracker::finish(std::vector<CarrierHop>& out) {
    // A shorter window still covers some of the waiting hops.
    if (missed_ == 0 && window_ > 0) {
        window_ = 0;
        fit_waiting(out);
    }
    for (; waiting_ < hops_.size(); ++waiting_) {
        CarrierHop left;
        left.first_sample = hops_[waiting_].first_sample;
        left.lock = CarrierLock::coasting;
        left.frequency_hz = hops_[waiting_].frequency_hz;
        left.rate_hzps = hops_[waiting_].rate_hzps;
        out.push_back(std::move(left));
    }
    hops_.clear();
    waiting_ = 0;
    lost_ = true;
}

}  // namespace aeolis::telemetry
