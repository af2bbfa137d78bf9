// SPDX-License-Identifier: Apache-2.0
#include "telemetry/mfsk/thinned_spectrum.hpp"

#include "common/tone_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace aeolis::telemetry {

ThinnedSpectrum::ThinnedSpectrum(double rate_hz, double start_s)
    : rate_hz_(rate_hz), start_s_(start_s), spectrum_(static_cast<int>(thinned_bins)),
      transforms_a_row_(static_cast<std::size_t>(
          std::max<std::int64_t>(1, std::llround(rate_hz / static_cast<double>(thinned_bins))))) {}

void ThinnedSpectrum::push(std::span<const std::complex<float>> samples) {
    while (!samples.empty()) {
        const auto part = samples.first(std::min(samples.size(), thinned_bins - waiting_.size()));
        waiting_.insert(waiting_.end(), part.begin(), part.end());
        samples = samples.subspan(part.size());
        if (waiting_.size() == thinned_bins) transform();
    }
}

std::vector<ThinnedRow> ThinnedSpectrum::take() {
    return std::exchange(done_, {});
}

void ThinnedSpectrum::transform() {
    const bool usable = std::ranges::all_of(waiting_, [](const std::complex<float>& sample) {
        return std::isfinite(sample.real()) && std::isfinite(sample.imag());
    });
    const bool gap = std::ranges::all_of(
        waiting_, [](const std::complex<float>& sample) { return sample == std::complex<float>{}; });
    if (usable && !gap) {
        const auto& powers = spectrum_.powers(waiting_);
        for (std::size_t i = 0; i < thinned_bins; ++i)  // frequency 0 comes first there, the negative ones last
            powers_[(i + thinned_bins / 2) % thinned_bins] += static_cast<double>(powers[i]);
        ++without_gap_;
    }
    waiting_.clear();
    if (++transforms_ == transforms_a_row_) end_row();
}

void ThinnedSpectrum::end_row() {
    auto sorted = powers_;
    const auto middle = sorted.begin() + thinned_bins / 2;
    std::nth_element(sorted.begin(), middle, sorted.end());
    if (without_gap_ > 0 && *middle > 0.0) {
        ThinnedRow row;
        const double row_s = static_cast<double>(transforms_a_row_ * thinned_bins) / rate_hz_;
        row.time_s = start_s_ + (static_cast<double>(rows_) + 0.5) * row_s;
        row.bin_hz = rate_hz_ / static_cast<double>(thinned_bins);
        row.first_hz = -0.5 * rate_hz_;
        for (const double power : powers_)
            row.levels.push_back(spectrum_octet(10.0 * std::log10(std::max(power / *middle, 1e-9))));
        done_.push_back(std::move(row));
    }
    powers_ = {};
    transforms_ = without_gap_ = 0;
    ++rows_;
}

}  // namespace aeolis::telemetry
