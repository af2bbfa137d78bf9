// SPDX-License-Identifier: Apache-2.0
#include "server/tones/tone_bench.hpp"

#include "simulation/links/x_band_channel.hpp"
#include "telemetry/mfsk/symbol_error.hpp"
#include "telemetry/mfsk/tone_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace aeolis::server {
namespace {

using telemetry::ToneSums;

constexpr int baseband_hops = 80;
constexpr double baseband_rate_hz = 1200.0;  // chosen: just above twice the highest tone
constexpr double full_turn_rad = 2.0 * std::numbers::pi;

double power_ratio(double db) {
    return std::pow(10.0, 0.1 * db);
}

/// The tone with the greatest sum over the hops.
std::ptrdiff_t likeliest(const std::vector<ToneSums>& hops) {
    ToneSums total{};
    for (const ToneSums& hop : hops)
        for (std::size_t tone = 0; tone < total.size(); ++tone) total[tone] += hop[tone];
    return std::ranges::max_element(total, {}, [](const auto& sum) { return std::norm(sum); }) - total.begin();
}

}  // namespace

RateInterval interval_of(const ErrorCount& count) {
    if (count.trials == 0) return {};
    constexpr double z = 1.959964;
    const auto n = static_cast<double>(count.trials);
    const double middle = (count.rate() + 0.5 * z * z / n) / (1.0 + z * z / n);
    const double aside =
        z / (1.0 + z * z / n) * std::sqrt(count.rate() * (1.0 - count.rate()) / n + 0.25 * z * z / (n * n));
    return {std::max(middle - aside, 0.0), std::min(middle + aside, 1.0)};
}

double loss_db(double tone_c_n0_dbhz, double symbol_s, double error_rate) {
    const double energy = telemetry::energy_for_symbol_error(std::clamp(error_rate, 1e-9, 0.99), MfskWaveform::tones);
    return tone_c_n0_dbhz - 10.0 * std::log10(energy / symbol_s);
}

ErrorCount baseband_errors(const MfskWaveform& waveform, double tone_c_n0_dbhz, std::uint64_t symbols,
                           std::uint64_t seed) {
    const int samples = static_cast<int>(baseband_rate_hz * waveform.symbol_s) / baseband_hops;
    const double hop_s = samples / baseband_rate_hz;
    const telemetry::ToneCorrelator correlator{waveform, baseband_rate_hz, samples};
    simulation::Random random{seed, 0, simulation::Stream::x_band};
    simulation::FastNormal noise{seed, 0, simulation::Stream::x_band_noise};
    // Noise of deviation 1 per sample has density 2/rate.
    const double amplitude = std::sqrt(2.0 * power_ratio(tone_c_n0_dbhz) * 2.0 / baseband_rate_hz);
    std::vector<ToneSums> hops(baseband_hops);
    std::vector<float> hop(static_cast<std::size_t>(samples));
    ErrorCount count;
    for (; count.trials < symbols; ++count.trials) {
        const int sent = static_cast<int>(random.uniform() * MfskWaveform::tones);
        const double phase_rad = full_turn_rad * random.uniform();
        for (int h = 0; h < baseband_hops; ++h) {
            const double begin_s = h * hop_s;
            const double begin_rad = phase_rad + full_turn_rad * waveform.tone_hz(sent) * begin_s;
            const double step_rad = full_turn_rad * waveform.tone_hz(sent) / baseband_rate_hz;
            std::complex<double> phasor = std::polar(amplitude, begin_rad + 0.5 * step_rad);
            const std::complex<double> step = std::polar(1.0, step_rad);
            for (float& sample : hop) {
                sample = static_cast<float>(phasor.imag()) + noise();
                phasor = {phasor.real() * step.real() - phasor.imag() * step.imag(),
                          phasor.real() * step.imag() + phasor.imag() * step.real()};
            }
            correlator.correlate(hop, begin_s, hops[static_cast<std::size_t>(h)]);
        }
        if (likeliest(hops) != sent) ++count.errors;
    }
    return count;
}

ErrorCount carrier_aided_errors(const MfskWaveform& waveform, double carrier_c_n0_dbhz, double tone_c_n0_dbhz,
                                std::uint64_t symbols, std::uint64_t seed) {
    // The modulation index that gives both powers as requested.
    MfskWaveform split = waveform;
    constexpr double first_sidebands = 8.0 / (std::numbers::pi * std::numbers::pi);
    split.modulation_index_rad =
        std::atan(std::sqrt(power_ratio(tone_c_n0_dbhz - carrier_c_n0_dbhz) / first_sidebands));

    const telemetry::HopLayout layout{4096.0};
    const auto symbol_hops = static_cast<std::uint64_t>(std::lround(waveform.symbol_s / layout.hop_s()));
    simulation::Random random{seed, 1, simulation::Stream::x_band};
    std::vector<simulation::SentTone> tones(symbols);
    for (std::uint64_t i = 0; i < symbols; ++i)
        tones[i] = {static_cast<double>(i) * waveform.symbol_s, static_cast<std::uint8_t>(random.bits() & 0xff)};
    simulation::XBandPath path;
    path.rate_hz = layout.rate_hz;
    path.total_c_n0_dbhz = carrier_c_n0_dbhz - 10.0 * std::log10(split.carrier_fraction());
    // A slow swing of a few hertz: the frequency is unknown and varies.
    std::vector<double> time_s, doppler_hz;
    for (double t = 0.0; t <= static_cast<double>(symbols) * waveform.symbol_s + 10.0; t += 0.5) {
        time_s.push_back(t);
        doppler_hz.push_back(5.0 * std::sin(0.5 * t));
    }
    path.doppler_hz = TimeTable::make(std::move(time_s), std::move(doppler_hz)).value();
    simulation::XBandChannel channel{split, path, tones, seed, 1};
    telemetry::CarrierTracker tracker{layout};
    tracker.start(0, 0.0, 0.0);
    const telemetry::ToneCorrelator correlator{waveform, layout.thinned_rate_hz(), layout.thinned_samples()};

    std::vector<std::complex<float>> samples(static_cast<std::size_t>(layout.hop_samples()));
    std::vector<telemetry::CarrierHop> hops;
    ToneSums total{}, sums{};
    std::uint64_t gathered = 0;
    ErrorCount count;
    while (count.trials < symbols) {
        channel.next(samples);
        hops.clear();
        tracker.push(samples, hops);
        for (const telemetry::CarrierHop& hop : hops) {
            if (hop.found) {
                correlator.correlate(hop.quadrature, static_cast<double>(hop.first_sample) / layout.rate_hz, sums);
                for (std::size_t tone = 0; tone < total.size(); ++tone) total[tone] += sums[tone];
            }
            if (++gathered < symbol_hops || count.trials == symbols) continue;
            const auto most = std::ranges::max_element(total, {}, [](const auto& sum) { return std::norm(sum); });
            if (most - total.begin() != tones[count.trials].tone) ++count.errors;
            ++count.trials;
            total = {};
            gathered = 0;
        }
        if (tracker.lost()) tracker.start(tracker.next_sample(), 0.0, 0.0);
    }
    return count;
}

}  // namespace aeolis::server
