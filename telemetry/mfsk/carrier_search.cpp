// SPDX-License-Identifier: Apache-2.0
#include "telemetry/mfsk/carrier_search.hpp"

#include "telemetry/mfsk/spectrum.hpp"

#include <Eigen/Core>
#include <unsupported/Eigen/FFT>

#include <algorithm>
#include <cmath>

namespace aeolis::telemetry {
namespace {

constexpr double segment_s = 0.02;     // chosen: 1200 Hz/s bends the phase by at most 0.4 rad
constexpr int segments_a_window = 50;  // 1 s
constexpr int windows_a_long_one = 4;  // 4 s
constexpr int lines_aside = 24;        // to either side of rate 0
constexpr int rate_lines = 2 * lines_aside + 1;
constexpr double rate_max_hzps = 1200.0;  // our assumption: the largest residual of a predict

}  // namespace

double exceeded_by_noise(int count, double x) {
    double log_term = -x, sum = 0.0;
    for (int i = 0; i < count; ++i) {
        sum += std::exp(log_term);
        log_term += std::log(x / (i + 1));
    }
    return std::min(sum, 1.0);
}

struct CarrierSearch::State {
    explicit State(double rate)
        : rate_hz(rate), segment(smooth_length(static_cast<int>(std::ceil(segment_s * rate)))), bins(2 * segment),
          bin_hz(rate / bins), segment_length_s(segment / rate),
          guard(static_cast<int>(std::ceil(0.5 * segments_a_window * segment_length_s * rate_max_hzps / bin_hz)) + 2),
          powers(bins + 2 * guard, segments_a_window * windows_a_long_one), padded(static_cast<std::size_t>(bins)),
          transformed(static_cast<std::size_t>(bins)) {
        for (const int count : {segments_a_window, segments_a_window * windows_a_long_one})
            thresholds.push_back(threshold(count));
    }

    double threshold(int count) const {
        const double cell = false_alarm / (static_cast<double>(bins) * rate_lines);
        double low = count, high = 20.0 * count + 100.0;
        while (high - low > 1e-6 * low) {
            const double middle = 0.5 * (low + high);
            (exceeded_by_noise(count, middle) > cell ? low : high) = middle;
        }
        return high;
    }

    void add_segment() {
        std::fill(padded.begin() + segment, padded.end(), std::complex<float>{});
        fft.fwd(transformed, padded);
        const int column = static_cast<int>(segments_seen % powers.cols());
        const float scale = 1.0F / static_cast<float>(segment);
        // Frequency 0 is in the middle; the spectrum wraps around at the band's ends.
        for (int i = 0; i < powers.rows(); ++i) {
            const int bin = ((i - guard + bins / 2) % bins + bins) % bins;
            powers(i, column) = scale * std::norm(transformed[static_cast<std::size_t>(bin)]);
        }
        ++segments_seen;
        filled = 0;
    }

    /// Sums powers along the line of `rate` through each bin at the middle of the last `count` segments.
    void sum_line(int count, double rate_hzps) {
        line.setZero(bins);
        for (int i = 0; i < count; ++i) {
            const double from_middle_s = (i - 0.5 * (count - 1)) * segment_length_s;
            const int shift = static_cast<int>(std::lround(rate_hzps * from_middle_s / bin_hz));
            const auto column = (segments_seen - count + i) % powers.cols();
            line += powers.col(column).segment(guard + shift, bins);
        }
    }

    std::optional<CarrierFound> search(int windows) {
        const int count = windows * segments_a_window;
        const double step_hzps = rate_max_hzps / lines_aside / windows;
        double mean = 0.0;
        for (int i = 0; i < count; ++i)
            mean += powers.col((segments_seen - 1 - i) % powers.cols()).segment(guard, bins).mean() / count;
        if (!(mean > 0.0)) return std::nullopt;

        float most = -1.0F;
        int best_line = 0;
        Eigen::Index best_bin = 0;
        for (int l = 0; l < rate_lines; ++l) {
            sum_line(count, (l - lines_aside) * step_hzps);
            Eigen::Index bin = 0;
            const float highest = line.maxCoeff(&bin);
            if (highest > most) {
                most = highest;
                best_line = l - lines_aside;
                best_bin = bin;
            }
        }
        const double limit = thresholds[windows == 1 ? 0 : 1];
        if (most / mean < limit) return std::nullopt;

        const auto around = [&](int line_offset, Eigen::Index bin_offset) {
            sum_line(count, (best_line + line_offset) * step_hzps);
            return static_cast<double>(line[(best_bin + bin_offset + bins) % bins]);
        };
        const Eigen::Index from_middle = best_bin - bins / 2;
        CarrierFound found;
        found.last_sample = segments_seen * segment;
        found.first_sample = found.last_sample - static_cast<std::int64_t>(count) * segment;
        found.frequency_hz =
            (static_cast<double>(from_middle) + peak_offset(around(0, -1), around(0, 0), around(0, 1))) * bin_hz;
        found.rate_hzps = (best_line + peak_offset(around(-1, 0), around(0, 0), around(1, 0))) * step_hzps;
        found.statistic = most / mean;
        found.threshold = limit;
        return found;
    }

    double rate_hz;
    int segment, bins;
    double bin_hz, segment_length_s;
    int guard;  ///< bins to either side that the steepest lines reach
    Eigen::ArrayXXf powers;
    std::vector<std::complex<float>> padded, transformed;
    std::vector<double> thresholds;  ///< of the short and the long window
    Eigen::FFT<float> fft;
    Eigen::ArrayXf line;
    std::int64_t segments_seen = 0;
    int filled = 0;
};

CarrierSearch::CarrierSearch(double rate_hz) : state_(std::make_unique<State>(rate_hz)) {}
CarrierSearch::~CarrierSearch() = default;
CarrierSearch::CarrierSearch(const CarrierSearch& other) : state_(std::make_unique<State>(*other.state_)) {}
CarrierSearch::CarrierSearch(CarrierSearch&&) noexcept = default;
CarrierSearch& CarrierSearch::operator=(CarrierSearch&&) noexcept = default;

std::int64_t CarrierSearch::longest_window_samples() const {
    return static_cast<std::int64_t>(state_->segment) * segments_a_window * windows_a_long_one;
}

std::optional<CarrierFound> CarrierSearch::push(std::span<const std::complex<float>> samples) {
    State& s = *state_;
    while (!samples.empty()) {
        const auto taken = std::min(samples.size(), static_cast<std::size_t>(s.segment - s.filled));
        std::ranges::copy(samples.first(taken), s.padded.begin() + s.filled);
        samples = samples.subspan(taken);
        s.filled += static_cast<int>(taken);
        if (s.filled < s.segment) break;
        s.add_segment();
        if (s.segments_seen % segments_a_window != 0) continue;
        if (auto found = s.search(1)) return found;
        if (s.segments_seen % s.powers.cols() == 0)
            if (auto found = s.search(windows_a_long_one)) return found;
    }
    return std::nullopt;
}

}  // namespace aeolis::telemetry
