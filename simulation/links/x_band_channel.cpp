#include "simulation/links/x_band_channel.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace aeolis::simulation {
namespace {

constexpr double channel_step_s = 1.0 / 128.0; // ours: Doppler bends by 1e-4 cycles of the carrier within, at 1000 Hz/s²

} // namespace

XBandChannel::XBandChannel(const MfskWaveform& waveform, XBandPath path, std::vector<SentTone> tones, std::uint64_t seed,
                           std::uint64_t case_number)
    : waveform_(waveform), path_(std::move(path)), tones_(std::move(tones)),
      noise_(seed, case_number, Stream::x_band_noise),
      step_samples_(std::max(1, static_cast<int>(path_.rate_hz * channel_step_s))),
      step_end_residual_hz_(path_.doppler_hz.at(path_.start_s) - path_.predict_hz.at(path_.start_s)),
      step_end_doppler_hz_(path_.doppler_hz.at(path_.start_s)) {}

void XBandChannel::begin_step() {
    const double end_s = path_.start_s + static_cast<double>(sample_ + step_samples_) / path_.rate_hz;
    const double from_hz = step_end_residual_hz_;
    step_end_residual_hz_ = path_.doppler_hz.at(end_s) - path_.predict_hz.at(end_s);
    const double turn_rad = 2.0 * std::numbers::pi / path_.rate_hz;
    const double bend_rad = turn_rad * (step_end_residual_hz_ - from_hz) / step_samples_;
    turn_ = std::polar(1.0, turn_rad * from_hz + 0.5 * bend_rad);
    turn_of_turn_ = std::polar(1.0, bend_rad);
    carrier_ /= std::abs(carrier_);

    const double doppler_from_hz = step_end_doppler_hz_;
    step_end_doppler_hz_ = path_.doppler_hz.at(end_s);
    lead_rate_ = 0.5 * (doppler_from_hz + step_end_doppler_hz_) / waveform_.carrier_hz;

    const bool set = path_.set_s && end_s > *path_.set_s;
    const double c_n0_dbhz = path_.total_c_n0_dbhz + path_.gain_db.at(end_s);
    amplitude_ = set ? 0.0F : static_cast<float>(std::sqrt(std::pow(10.0, 0.1 * c_n0_dbhz) / path_.rate_hz));
    step_left_ = step_samples_;
}

bool XBandChannel::sending(double time_s) {
    while (tone_ < tones_.size() && time_s >= tones_[tone_].start_s + waveform_.symbol_s)
        ++tone_;
    if (tone_ == tones_.size() || time_s < tones_[tone_].start_s) return false;
    if (modulated_for_ != tone_) {
        modulated_.emplace(waveform_, tones_[tone_].tone, path_.rate_hz);
        modulated_for_ = tone_;
    }
    return true;
}

void XBandChannel::next(std::span<std::complex<float>> samples) {
    const double sample_s = 1.0 / path_.rate_hz;
    constexpr float deviation = std::numbers::sqrt2_v<float> / 2.0F; // of each of two parts: power 1
    for (auto& sample : samples) {
        if (step_left_ == 0) begin_step();
        const double time_s = path_.start_s + static_cast<double>(sample_) * sample_s;
        std::complex<float> value{amplitude_, 0.0F};
        if (sending(time_s)) {
            const double subcarrier_s = time_s - tones_[tone_].start_s + lead_s_;
            value = amplitude_ * modulated_->at(waveform_.tone_hz(tones_[tone_].tone) * subcarrier_s);
        }
        const auto carrier = static_cast<std::complex<float>>(carrier_);
        const float in_phase = value.real() * carrier.real() - value.imag() * carrier.imag();
        const float quadrature = value.real() * carrier.imag() + value.imag() * carrier.real();
        const float noise_in_phase = noise_(), noise_quadrature = noise_();
        sample = {in_phase + deviation * noise_in_phase, quadrature + deviation * noise_quadrature};
        carrier_ = {carrier_.real() * turn_.real() - carrier_.imag() * turn_.imag(),
                    carrier_.real() * turn_.imag() + carrier_.imag() * turn_.real()};
        turn_ = {turn_.real() * turn_of_turn_.real() - turn_.imag() * turn_of_turn_.imag(),
                 turn_.real() * turn_of_turn_.imag() + turn_.imag() * turn_of_turn_.real()};
        lead_s_ += lead_rate_ * sample_s;
        ++sample_;
        --step_left_;
    }
}

} // namespace aeolis::simulation
