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
constexpr double lost_in_gap_s = 10.0;            // chosen
constexpr double level_of_old = 0.99;             // of each hop in the running mean of C/N0: 12 s; chosen
constexpr double longer_level_hz = 60.0;          // 18 dB-Hz: a stronger carrier that is missed swerves; chosen
constexpr int longer_after_hops = 4;              // chosen
constexpr double noise_gain = 0.08;               // of each hop in the running mean of the noise: 1.5 s; chosen
constexpr double noise_change = 1.58;             // 2 dB: the noise has changed, and its mean begins anew; chosen
constexpr double noise_near_hz = 40.0;            // the carrier's own; chosen
constexpr double noise_far_hz = 600.0;            // the reach of the tones; chosen
constexpr double part_burst_ratio = 4.0;          // of a part's power to the median of a hop's; chosen
constexpr double seen_least = 0.25;               // of a hop or window; with less it is a gap; chosen
constexpr double swing_energy = 0.6;              // of the energy expected: below, the carrier swings; chosen
constexpr double swerve_level_hz = 40.0;          // 16 dB-Hz: a weaker carrier is not found in 0.4 s; chosen
constexpr double swerve_hz = 60.0;                // to either side; chosen
constexpr double swerve_step_hzps2 = 800.0;       // of the rate's change: half of it costs 0.5 dB in 0.4 s; chosen
constexpr int swerve_steps = 3;                   // to either side: a parachute's snatch is 2000 Hz/s²; chosen
constexpr double swerve_sigma_hz = 1.5;           // of the frequency, by a change of rate between the steps
constexpr double swerve_seen = 0.9;               // of a window: with less many lines fit equally; chosen
constexpr double turned_hz = 10.0;                // from the prediction: more than the noise of a short fit; chosen
constexpr double false_swerve = 0.001;            // probability in noise; chosen
constexpr double genuine_energy = 8.0;            // of a hop: with less its gain is smaller; chosen
constexpr double genuine_gain = 0.1;              // of each hop: 1.2 s; chosen
constexpr double fitted_bias = 2.0;               // of the four fitted numbers, in units of noise energy

}  // namespace

HopLayout::HopLayout(double rate)
    : rate_hz(rate), thinning(std::max(1, static_cast<int>(rate / thinned_rate_least_hz))),
      part_samples(std::max(1, static_cast<int>(std::lround(rate / thinning / parts_hz)))) {}

CarrierTracker::CarrierTracker(const HopLayout& layout) : layout_(layout), spectrum_(layout.thinned_samples()) {
    const double part_s = layout.part_samples / layout.thinned_rate_hz();
    for (const int hops : {5, 11, 21, 41})
        windows_.push_back({hops, hops * layout.hop_s(), CarrierFit{hops * HopLayout::parts, part_s},
                            FitSpan{200.0 / hops, 4}, FitSpan{500.0 / hops, CarrierFit::rate_lines_max}});
    for (const int hops : {3, 1}) {
        const FitSpan span{100.0, hops == 1 ? 6 : CarrierFit::rate_lines_max};
        swinging_.push_back({hops, hops * layout.hop_s(), CarrierFit{hops * HopLayout::parts, part_s}, span, span});
    }
}

double CarrierTracker::Fitted::gathered() const {
    return found ? (line.energy - fitted_bias) / (seen * length_s) : 0.0;
}

void CarrierTracker::start(std::int64_t first_sample, double frequency_hz, double rate_hzps) {
    hops_.clear();
    waiting_ = 0;
    window_ = 0;
    next_sample_ = frequency_sample_ = first_sample;
    frequency_hz_ = frequency_hz;
    rate_hzps_ = rate_hzps;
    noise_density_ = level_hz_ = 0.0;
    missed_ = gap_hops_ = short_in_row_ = 0;
    genuine_ = 1.0;
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
    for (std::size_t i = 0; i < hop.size();) {
        float in_phase = 0.0F, quadrature = 0.0F;
        int present = 0;
        for (int k = 0; k < layout_.thinning; ++k, ++i) {
            const auto p = static_cast<std::complex<float>>(phasor);
            in_phase += hop[i].real() * p.real() - hop[i].imag() * p.imag();
            quadrature += hop[i].real() * p.imag() + hop[i].imag() * p.real();
            present += hop[i] != std::complex<float>{} ? 1 : 0;
            phasor = {phasor.real() * step.real() - phasor.imag() * step.imag(),
                      phasor.real() * step.imag() + phasor.imag() * step.real()};
            step = {step.real() * bend.real() - step.imag() * bend.imag(),
                    step.real() * bend.imag() + step.imag() * bend.real()};
        }
        const float share = present == layout_.thinning ? scale : 1.0F / static_cast<float>(std::max(present, 1));
        if (2 * present < layout_.thinning) in_phase = quadrature = 0.0F;
        wiped.thinned.emplace_back(share * in_phase, share * quadrature);
    }
    phase_cycles_ = std::fmod(wiped.cycles_at(layout_.hop_s()), 1.0);
    next_sample_ += layout_.hop_samples();
    leave_out_bursts(wiped);
    normalize(wiped);
    return wiped;
}

/// Parts far above the hop's usual power become gaps.
void CarrierTracker::leave_out_bursts(Wiped& wiped) const {
    const auto part_samples = static_cast<std::size_t>(layout_.part_samples);
    std::array<double, HopLayout::parts> powers{}, sorted{};
    std::size_t present = 0;
    for (std::size_t part = 0; part < powers.size(); ++part) {
        for (std::size_t i = 0; i < part_samples; ++i) {
            const auto& sample = wiped.thinned[part * part_samples + i];
            powers[part] += std::norm(std::complex<double>{sample});
        }
        if (powers[part] > 0.0) sorted[present++] = powers[part];
    }
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(present / 2);
    std::nth_element(sorted.begin(), middle, sorted.begin() + static_cast<std::ptrdiff_t>(present));
    for (std::size_t part = 0; part < powers.size(); ++part)
        if (powers[part] > part_burst_ratio * *middle)
            std::fill_n(wiped.thinned.begin() + static_cast<std::ptrdiff_t>(part * part_samples), part_samples,
                        std::complex<float>{});
    const auto seen = std::ranges::count_if(wiped.thinned, [](const auto& s) { return s != std::complex<float>{}; });
    wiped.seen = static_cast<double>(seen) / static_cast<double>(wiped.thinned.size());
}

/// Scales the hop so that its noise has density 1, and sums its parts.
void CarrierTracker::normalize(Wiped& wiped) {
    if (wiped.seen < seen_least) {
        std::ranges::fill(wiped.thinned, std::complex<float>{});
        wiped.seen = 0.0;
        return;
    }
    const std::vector<float>& powers = spectrum_.powers(wiped.thinned);
    const double bin_hz = layout_.thinned_rate_hz() / static_cast<double>(powers.size());
    const auto near = static_cast<std::size_t>(std::ceil(noise_near_hz / bin_hz));
    const auto far = std::min(static_cast<std::size_t>(noise_far_hz / bin_hz), powers.size() / 2 - 1);
    std::vector<float> around;
    double total = 0.0;
    for (const auto& sample : wiped.thinned) total += std::norm(std::complex<double>{sample});
    total /= wiped.seen * layout_.thinned_samples();
    for (std::size_t i = near; i <= far; ++i) {
        around.push_back(powers[i]);
        around.push_back(powers[powers.size() - i]);
    }
    const auto middle = around.begin() + static_cast<std::ptrdiff_t>(around.size() / 2);
    std::ranges::nth_element(around, middle);
    // For a signal without noise, a millionth of it.
    const double density = std::max(*middle / std::numbers::ln2, 1e-6 * total) / layout_.thinned_rate_hz();
    const bool changed =
        noise_density_ <= 0.0 || density > noise_change * noise_density_ || noise_change * density < noise_density_;
    noise_density_ = changed ? density : noise_density_ + noise_gain * (density - noise_density_);
    const auto scale = static_cast<float>(1.0 / std::sqrt(std::max(noise_density_, 1e-60)));
    for (auto& sample : wiped.thinned) sample *= scale;
    wiped.density = noise_density_;
    wiped.spectrum = powers;
    wiped.spectrum_hz = wiped.frequency_hz + 0.5 * wiped.rate_hzps * layout_.hop_s();
    const auto one = static_cast<float>(1.0 / (std::max(noise_density_, 1e-60) * layout_.thinned_rate_hz()));
    for (auto& power : wiped.spectrum) power *= one;
    sum_parts(wiped);
}

void CarrierTracker::sum_parts(Wiped& wiped) const {
    for (int part = 0; part < HopLayout::parts; ++part) {
        std::complex<float> sum{};
        for (int i = 0; i < layout_.part_samples; ++i)
            sum += wiped.thinned[static_cast<std::size_t>(part * layout_.part_samples + i)];
        wiped.parts[static_cast<std::size_t>(part)] = sum / static_cast<float>(layout_.part_samples);
    }
}

/// Turns the waiting hops to the newest fit. Of a carrier that swerves their prediction is soon too far off to be
/// summed.
void CarrierTracker::turn_waiting() {
    for (std::size_t i = waiting_ + 1; i < hops_.size(); ++i) {
        Wiped& hop = hops_[i];
        Wiped turned;
        const double since_s = static_cast<double>(hop.first_sample - frequency_sample_) / layout_.rate_hz;
        turned.frequency_hz = frequency_hz_ + rate_hzps_ * since_s;
        turned.rate_hzps = rate_hzps_;
        turned.phase_cycles = hop.phase_cycles;
        for (std::size_t k = 0; k < hop.thinned.size(); ++k) {
            const double at_s = (static_cast<double>(k) + 0.5) / layout_.thinned_rate_hz();
            const double cycles = hop.cycles_at(at_s) - turned.cycles_at(at_s);
            hop.thinned[k] *= static_cast<std::complex<float>>(std::polar(1.0, turn_rad * cycles));
        }
        hop.frequency_hz = turned.frequency_hz;
        hop.rate_hzps = turned.rate_hzps;
        sum_parts(hop);
    }
}

/// Makes `aligned_` the parts of a window, turned to the prediction of its middle hop.
void CarrierTracker::align(std::size_t middle, int hops, Fitted& fitted) {
    const auto aside = static_cast<std::size_t>(hops / 2);
    const Wiped& reference = hops_[middle];
    const double part_s = layout_.hop_s() / HopLayout::parts;
    aligned_.clear();
    for (std::size_t i = middle - aside; i <= middle + aside; ++i) {
        const Wiped& hop = hops_[i];
        fitted.seen += hop.seen / hops;
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
}

CarrierTracker::Fitted CarrierTracker::fit_around(std::size_t middle, Window& window, bool wide) {
    const double part_s = layout_.hop_s() / HopLayout::parts;
    Fitted fitted;
    align(middle, window.hops, fitted);
    fitted.length_s = window.length_s;
    fitted.wide = wide;
    if (fitted.seen < seen_least) return fitted;
    fitted.line = window.fit.fit(aligned_, 1.0 / part_s, wide ? window.wide : window.narrow);
    fitted.line.amplitude /= fitted.seen;
    fitted.line.energy /= fitted.seen;
    fitted.found = fitted.line.energy >= window.least_energy(wide);
    return fitted;
}

/// A carrier that swings bends within the usual window: of the shorter ones, the one that gathers what is expected.
CarrierTracker::Fitted CarrierTracker::fit_swinging(std::size_t middle, const Fitted& usual) {
    Fitted best = usual;
    for (Window& window : swinging_) {
        if (best.gathered() >= swing_energy * level_hz_ && best.found) break;
        const auto aside = static_cast<std::size_t>(window.hops / 2);
        if (middle < aside || middle + aside >= hops_.size()) continue;
        const Fitted shorter = fit_around(middle, window, true);
        if (shorter.found && shorter.gathered() > longer_gain * best.gathered()) best = shorter;
    }
    return best;
}

/// A carrier whose rate changes since the newest fit: the line that gathers most, of those along which it does so
/// evenly.
CarrierTracker::Fitted CarrierTracker::fit_swerving(std::size_t middle) {
    Window& window = swinging_.front();
    const auto aside = static_cast<std::size_t>(window.hops / 2);
    Fitted best;
    if (middle < aside || middle + aside >= hops_.size()) return best;
    align(middle, window.hops, best);
    best.length_s = window.length_s;
    best.wide = best.swerves = true;
    if (best.seen < swerve_seen) return best;
    const Wiped& hop = hops_[middle];
    const double part_s = layout_.hop_s() / HopLayout::parts;
    const auto mid_sample = hop.first_sample + layout_.hop_samples() / 2;
    const double since_s = static_cast<double>(mid_sample - frequency_sample_) / layout_.rate_hz;
    for (int step = -swerve_steps; step <= swerve_steps; ++step) {
        const double bend = step * swerve_step_hzps2;
        const double hz = frequency_hz_ + rate_hzps_ * since_s + 0.5 * bend * since_s * since_s - hop.frequency_hz -
                          0.5 * hop.rate_hzps * layout_.hop_s();
        const double hzps = rate_hzps_ + bend * since_s - hop.rate_hzps;
        bent_.clear();
        for (std::size_t i = 0; i < aligned_.size(); ++i) {
            const double at_s = (static_cast<double>(i) - 0.5 * static_cast<double>(aligned_.size() - 1)) * part_s;
            const double cycles = ((bend / 6.0 * at_s + 0.5 * hzps) * at_s + hz) * at_s;
            bent_.push_back(aligned_[i] * static_cast<std::complex<float>>(std::polar(1.0, -turn_rad * cycles)));
        }
        CarrierLine line = window.fit.fit(bent_, 1.0 / part_s, {swerve_hz, CarrierFit::rate_lines_max});
        if (line.energy <= best.line.energy) continue;
        line.frequency_hz += hz;
        line.rate_hzps += hzps;
        best.line = line;
    }
    best.line.amplitude /= best.seen;
    best.line.energy /= best.seen;
    constexpr int lines = (2 * CarrierFit::rate_lines_max + 1) * (2 * swerve_steps + 1);
    best.found = best.line.energy >= std::log(2.0 * swerve_hz * best.length_s * lines / false_swerve);
    return best;
}

/// Where the usual window finds nothing or too little: a line that bends, if it gathers more than a straight one over
/// as long, or nearly as much as one over a single hop, which is chosen for its noise, too.
CarrierTracker::Fitted CarrierTracker::may_swerve(std::size_t middle, const Fitted& straight) {
    const bool is_short = straight.length_s < windows_[window_].length_s;
    if (level_hz_ <= swerve_level_hz || (straight.found && !is_short)) return straight;
    const Fitted bent = fit_swerving(middle);
    const double needed = straight.length_s < bent.length_s ? 1.0 / longer_gain : longer_gain;
    return bent.found && bent.gathered() > needed * straight.gathered() ? bent : straight;
}

CarrierHop CarrierTracker::demodulated(const Wiped& hop, const CarrierLine& line, const Fitted& fitted) {
    CarrierHop out;
    out.first_sample = hop.first_sample;
    out.found = true;
    out.seen = hop.seen;
    out.spectrum = hop.spectrum;
    out.spectrum_hz = hop.spectrum_hz;
    out.frequency_hz = hop.frequency_hz + 0.5 * hop.rate_hzps * layout_.hop_s() + line.frequency_hz;
    out.rate_hzps = hop.rate_hzps + line.rate_hzps;
    const double energy = std::max(line.energy - fitted_bias, 1.0), seen_s = fitted.seen * fitted.length_s;
    out.carrier_n0_hz = energy / seen_s;
    out.carrier_power = out.carrier_n0_hz * hop.density;
    out.frequency_deviation_hz =
        std::hypot(std::sqrt(6.0 / energy) / (turn_rad * seen_s), fitted.swerves ? swerve_sigma_hz : 0.0);
    const double sample_s = 1.0 / layout_.thinned_rate_hz();
    const double begin_s = -0.5 * layout_.hop_s() + 0.5 * sample_s;
    std::complex<double> phasor = std::polar(
        1.0, -line.phase_rad - turn_rad * (line.frequency_hz * begin_s + 0.5 * line.rate_hzps * begin_s * begin_s));
    std::complex<double> step = std::polar(
        1.0, -turn_rad * (line.frequency_hz * sample_s + line.rate_hzps * sample_s * (begin_s + 0.5 * sample_s)));
    const std::complex<double> bend = std::polar(1.0, -turn_rad * line.rate_hzps * sample_s * sample_s);
    const auto scale = static_cast<float>(1.0 / std::sqrt(0.5 * layout_.thinned_rate_hz()));
    const auto carrier = static_cast<float>(line.amplitude);
    out.quadrature.reserve(hop.thinned.size());
    out.in_phase.reserve(hop.thinned.size());
    double along = 0.0;
    for (const auto& sample : hop.thinned) {
        const auto p = static_cast<std::complex<float>>(phasor);
        const bool seen = sample != std::complex<float>{};
        out.quadrature.push_back(scale * (sample.real() * p.imag() + sample.imag() * p.real()));
        const float in_phase = sample.real() * p.real() - sample.imag() * p.imag();
        along += in_phase;
        out.in_phase.push_back(seen ? scale * (in_phase - carrier) : 0.0F);
        phasor *= step;
        step *= bend;
    }
    if (hop.seen > 0.0) {
        const double hop_energy = out.carrier_n0_hz * layout_.hop_s() * hop.seen;
        const double there = along / (hop.seen * static_cast<double>(hop.thinned.size()) * line.amplitude);
        genuine_ += genuine_gain * std::min(1.0, hop_energy / genuine_energy) * (there - genuine_);
    }
    return out;
}

void CarrierTracker::follow(const Wiped& hop, const Fitted& fitted) {
    frequency_hz_ = hop.frequency_hz + 0.5 * hop.rate_hzps * layout_.hop_s() + fitted.line.frequency_hz;
    rate_hzps_ = hop.rate_hzps + fitted.line.rate_hzps;
    frequency_sample_ = hop.first_sample + layout_.hop_samples() / 2;
    const double level_hz = fitted.gathered();
    level_hz_ = level_hz_ == 0.0 ? level_hz : level_of_old * level_hz_ + (1.0 - level_of_old) * level_hz;
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
        Fitted fitted = fit_around(middle, window, !settled_ || missed_ > 0);
        done.gap = hop.seen == 0.0 || fitted.seen < seen_least;
        if (!fitted.found && !fitted.wide && !done.gap) fitted = fit_around(middle, window, true);
        const bool usual = fitted.found && !fitted.wide && window_ == 0;
        const bool may_swing = settled_ && window_ == 0 && middle == waiting_ && !done.gap;
        if (may_swing) fitted = may_swerve(middle, fit_swinging(middle, fitted));
        const CarrierLine& line = fitted.line;
        if (fitted.found && line.energy < longer_gain * energy_before_longer_) {
            shorten();
            continue;
        }
        if (fitted.found) {
            energy_before_longer_ = 0.0;
            if (middle == waiting_) {
                done = demodulated(hop, line, fitted);
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
                done = demodulated(hop, moved, fitted);
            }
            if (hop.seen == 0.0) {  // the carrier goes on through a short gap, and brings nothing
                done.gap = true;
                done.found = false;
                done.quadrature.clear();
                done.in_phase.clear();
            }
            follow(hops_[middle], fitted);
            const bool is_short = fitted.length_s < window.length_s && fitted.seen >= swerve_seen;
            if (may_swing && (fitted.swerves || (is_short && std::abs(line.frequency_hz) > turned_hz))) turn_waiting();
            done.lock = settled_ && usual && fitted.length_s == window.length_s && !done.gap ? CarrierLock::locked
                                                                                             : CarrierLock::fluctuating;
            if (done.gap) done.lock = CarrierLock::coasting;
            settled_ = true;
            // Noise passes for a carrier that swings once in a hundred hops, seldom twice in a row.
            short_in_row_ = fitted.length_s < window.length_s ? short_in_row_ + 1 : 0;
            if (short_in_row_ != 1) missed_ = 0;
            gap_hops_ = 0;
            if (fitted.length_s == window.length_s) choose_window(line.energy);
        } else if (energy_before_longer_ > 0.0) {
            shorten();
            continue;
        } else {
            done.lock = CarrierLock::coasting;
            done.frequency_hz = hop.frequency_hz + 0.5 * hop.rate_hzps * layout_.hop_s();
            done.rate_hzps = hop.rate_hzps;
            short_in_row_ = 0;
            ++(done.gap ? gap_hops_ : missed_);
            const bool is_faint = settled_ && level_hz_ < longer_level_hz;
            if (!done.gap && is_faint && missed_ % longer_after_hops == 0 && window_ + 1 < windows_.size()) ++window_;
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
    if (missed_ * layout_.hop_s() > patience_s || gap_hops_ * layout_.hop_s() > lost_in_gap_s || !genuine())
        finish(out);
}

void CarrierTracker::finish(std::vector<CarrierHop>& out) {
    // A shorter window still covers some of the waiting hops.
    if (missed_ == 0 && window_ > 0) {
        window_ = 0;
        energy_before_longer_ = 0.0;
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
