// SPDX-License-Identifier: Apache-2.0
#include "telemetry/mfsk/carrier_search.hpp"

#include "telemetry/mfsk/spectrum.hpp"

#include <Eigen/Core>
#include <unsupported/Eigen/FFT>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

namespace aeolis::telemetry {
namespace {

constexpr double segment_s = 0.02;     // chosen: 1200 Hz/s bends the phase by at most 0.4 rad
constexpr int segments_a_window = 50;  // 1 s
constexpr int windows_a_long_one = 4;  // 4 s
constexpr int lines_aside = 24;        // to either side of rate 0
constexpr int rate_lines = 2 * lines_aside + 1;
constexpr double rate_max_hzps = 1200.0;  // our assumption: the largest residual of a predict
constexpr int noise_bins = 24;            // 600 Hz to either side; chosen
constexpr int noise_gap = 4;              // between a bin and its noise; chosen
constexpr int noise_step = 4;             // chosen: from each median to the next
constexpr float uneven = 1.3F;            // of one estimate of the noise to another: chosen
constexpr int hump_gap = 3;               // of a bin from the noise of a narrow hump; chosen
constexpr int hump_bins = 6;              // to either side; chosen
constexpr double kept_rate_hz = 200e3;    // to this rate powers are kept though nobody looks; chosen, for the effort
constexpr int own_bins = 8;               // 200 Hz to either side of a carrier are its own; chosen
constexpr float weaker_seen = 0.002F;     // of the strongest carrier's sum: its leakage; chosen
constexpr std::size_t blocks = 12;        // of a segment, for bursts; chosen
constexpr double burst_ratio = 6.0;       // chosen

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
          powers(bins + 2 * guard, segments_a_window * windows_a_long_one), seen(powers.cols(), 0.0F),
          padded(static_cast<std::size_t>(bins)), transformed(static_cast<std::size_t>(bins)), highest(bins),
          highest_line(static_cast<std::size_t>(bins)), mean(bins), noise(bins + 2 * guard) {}

    double threshold(int count) {
        if (const auto known = thresholds.find(count); known != thresholds.end()) return known->second;
        const double cell = false_alarm / (static_cast<double>(bins) * rate_lines);
        double low = count, high = 20.0 * count + 100.0;
        while (high - low > 1e-6 * low) {
            const double middle = 0.5 * (low + high);
            (exceeded_by_noise(count, middle) > cell ? low : high) = middle;
        }
        return thresholds[count] = high;
    }

    /// Blocks far above the segment's usual power become gaps.
    void leave_out_bursts() {
        const int block = segment / blocks;
        std::array<double, blocks> powers_of{}, sorted{};
        std::size_t present = 0;
        for (std::size_t b = 0; b < blocks; ++b) {
            for (int i = 0; i < block; ++i)
                powers_of[b] += std::norm(
                    std::complex<double>{padded[b * static_cast<std::size_t>(block) + static_cast<std::size_t>(i)]});
            if (powers_of[b] > 0.0) sorted[present++] = powers_of[b];
        }
        const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(present / 2);
        std::nth_element(sorted.begin(), middle, sorted.begin() + static_cast<std::ptrdiff_t>(present));
        for (std::size_t b = 0; b < blocks; ++b)
            if (powers_of[b] > burst_ratio * *middle)
                std::fill_n(padded.begin() + static_cast<std::ptrdiff_t>(b) * block, block, std::complex<float>{});
    }

    /// Powers of the segment with mean 1 over the band, which takes out changes of level; a gap has none.
    void add_segment(bool looks) {
        std::fill(padded.begin() + segment, padded.end(), std::complex<float>{});
        const auto column = segments_seen % powers.cols();
        if (looks) leave_out_bursts();
        const auto present = std::count_if(padded.begin(), padded.begin() + segment,
                                           [](const auto& sample) { return sample != std::complex<float>{}; });
        ++segments_seen;
        filled = 0;
        seen[static_cast<std::size_t>(column)] = 0.0F;
        powers.col(column).setZero();
        if (!looks || 2 * present < segment) return;
        double power = 0.0;
        for (int i = 0; i < segment; ++i) power += std::norm(std::complex<double>{padded[static_cast<std::size_t>(i)]});
        if (!(power > 0.0 && power < std::numeric_limits<float>::max())) return;
        const auto root = static_cast<float>(std::sqrt(1.0 / power));
        for (int i = 0; i < segment; ++i) padded[static_cast<std::size_t>(i)] *= root;
        fft.fwd(transformed, padded);
        // Frequency 0 is in the middle; the spectrum wraps around at the band's ends.
        for (int i = 0; i < powers.rows(); ++i) {
            const int bin = ((i - guard + bins / 2) % bins + bins) % bins;
            powers(i, column) = std::norm(transformed[static_cast<std::size_t>(bin)]);
        }
        seen[static_cast<std::size_t>(column)] = 1.0F;
    }

    /// Sums powers along the line of `rate` through each bin at the middle of the last `count` segments.
    void sum_line(int count, double rate_hzps) {
        line.setZero(bins);
        for (int i = 0; i < count; ++i) {
            const auto column = (segments_seen - count + i) % powers.cols();
            if (seen[static_cast<std::size_t>(column)] == 0.0F) continue;
            const double from_middle_s = (i - 0.5 * (count - 1)) * segment_length_s;
            const int shift = static_cast<int>(std::lround(rate_hzps * from_middle_s / bin_hz));
            line += powers.col(column).segment(guard + shift, bins);
        }
    }

    int present_in(int count) const {
        int present = 0;
        for (int i = 0; i < count; ++i)
            present += seen[static_cast<std::size_t>((segments_seen - 1 - i) % powers.cols())] > 0.0F ? 1 : 0;
        return present;
    }

    /// Divides the powers of the last second by their noise: of the medians of the means to either side, the greatest.
    void normalize() {
        const int count = segments_a_window, present = present_in(count);
        if (present == 0) return;
        mean.setZero(bins);
        for (int i = 0; i < count; ++i)
            mean += powers.col((segments_seen - 1 - i) % powers.cols()).segment(guard, bins);
        mean /= static_cast<float>(present);
        const int aside = std::min(noise_bins, bins / 4);
        medians.resize(static_cast<std::size_t>(bins));
        // medians[i]: of the bins i … i + aside − 1, for every noise_step-th i; those between repeat the one before.
        for (int i = 0; i < bins; ++i) {
            if (i % noise_step != 0) {
                medians[static_cast<std::size_t>(i)] = medians[static_cast<std::size_t>(i - 1)];
                continue;
            }
            near.clear();
            for (int k = 0; k < aside; ++k) near.push_back(mean[(i + k) % bins]);
            const auto middle = near.begin() + aside / 2;
            std::ranges::nth_element(near, middle);
            medians[static_cast<std::size_t>(i)] = *middle;
        }
        for (int i = 0; i < bins; ++i) {
            const int after = (i + noise_gap) % bins;
            const int before = ((i - noise_gap - aside) % bins + bins) % bins;
            near.clear();
            for (int k = hump_gap; k < hump_gap + hump_bins; ++k) {
                near.push_back(mean[(i + k) % bins]);
                near.push_back(mean[(i - k + bins) % bins]);
            }
            std::ranges::nth_element(near, near.begin() + hump_bins);
            const float left = medians[static_cast<std::size_t>(before)];
            const float right = medians[static_cast<std::size_t>(after)];
            const float most = std::max(left, right);
            // In even noise the greatest of several estimates would be above it.
            const float beside = most < uneven * std::min(left, right) ? 0.5F * (left + right) : most;
            noise[guard + i] = near[hump_bins] > uneven * beside ? near[hump_bins] : beside;
        }
        // A band without noise, cut off by a filter, hides nothing: it counts as 40 dB below the strongest.
        const float least = 1e-4F * noise.segment(guard, bins).maxCoeff();
        noise.segment(guard, bins) = noise.segment(guard, bins).max(std::max(least, 1e-30F));
        for (int i = 0; i < guard; ++i) {
            noise[i] = noise[i + bins];
            noise[guard + bins + i] = noise[guard + i];
        }
        for (int i = 0; i < count; ++i) powers.col((segments_seen - 1 - i) % powers.cols()) /= noise;
    }

    void search(int windows, std::vector<CarrierFound>& out) {
        const int count = windows * segments_a_window;
        const int present = present_in(count);
        if (2 * present < count) return;
        const double step_hzps = rate_max_hzps / lines_aside / windows;
        const double limit = threshold(present);
        float strongest = 0.0F;
        for (std::size_t n = 0; n < found_max; ++n) {
            sum_lines(count, step_hzps);
            Eigen::Index best_bin = 0;
            const float most = highest.maxCoeff(&best_bin);
            if (most < limit || most < weaker_seen * strongest) return;
            strongest = std::max(strongest, most);
            out.push_back(refined(count, step_hzps, best_bin, most, limit));
            out.back().carrier_n0_hz = std::max(static_cast<double>(most) / present - 1.0, 0.0) / segment_length_s;
            if (n + 1 < found_max) take_out(count, step_hzps, best_bin);
        }
    }

    /// The highest sum of each bin's lines.
    void sum_lines(int count, double step_hzps) {
        highest.setConstant(bins, -1.0F);
        for (int l = 0; l < rate_lines; ++l) {
            sum_line(count, (l - lines_aside) * step_hzps);
            for (int i = 0; i < bins; ++i)
                if (line[i] > highest[i]) {
                    highest[i] = line[i];
                    highest_line[static_cast<std::size_t>(i)] = static_cast<std::int16_t>(l - lines_aside);
                }
        }
    }

    /// Puts noise in the place of a carrier that was found, so that a weaker one is seen beside it.
    void take_out(int count, double step_hzps, Eigen::Index best_bin) {
        const double rate_hzps = highest_line[static_cast<std::size_t>(best_bin)] * step_hzps;
        for (int i = 0; i < count; ++i) {
            const auto column = (segments_seen - count + i) % powers.cols();
            const double from_middle_s = (i - 0.5 * (count - 1)) * segment_length_s;
            const auto middle = best_bin + static_cast<Eigen::Index>(std::lround(rate_hzps * from_middle_s / bin_hz));
            for (Eigen::Index k = -own_bins; k <= own_bins; ++k) {
                const Eigen::Index bin = ((middle + k) % bins + bins) % bins;
                const float level = seen[static_cast<std::size_t>(column)];
                // The spectrum wraps around: a bin near an end is there twice.
                for (Eigen::Index row = guard + bin - bins; row < powers.rows(); row += bins)
                    if (row >= 0) powers(row, column) = level;
            }
        }
    }

    CarrierFound refined(int count, double step_hzps, Eigen::Index best_bin, float most, double limit) {
        const int best_line = highest_line[static_cast<std::size_t>(best_bin)];
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
        found.statistic = most;
        found.threshold = limit;
        return found;
    }

    double rate_hz;
    int segment, bins;
    double bin_hz, segment_length_s;
    int guard;  ///< bins to either side that the steepest lines reach
    Eigen::ArrayXXf powers;
    std::vector<float> seen;  ///< of each column: 1, or 0 for a gap
    std::vector<std::complex<float>> padded, transformed;
    std::map<int, double> thresholds;  ///< by the number of segments
    Eigen::FFT<float> fft;
    Eigen::ArrayXf line, highest;
    std::vector<std::int16_t> highest_line;
    Eigen::ArrayXf mean, noise;
    std::vector<float> medians, near;
    std::int64_t segments_seen = 0;
    int filled = 0;
    bool found_lately = false;  ///< in one of the last windows of a long one
};

CarrierSearch::CarrierSearch(double rate_hz) : state_(std::make_unique<State>(rate_hz)) {}
CarrierSearch::~CarrierSearch() = default;
CarrierSearch::CarrierSearch(const CarrierSearch& other) : state_(std::make_unique<State>(*other.state_)) {}
CarrierSearch::CarrierSearch(CarrierSearch&&) noexcept = default;
CarrierSearch& CarrierSearch::operator=(CarrierSearch&&) noexcept = default;

std::int64_t CarrierSearch::longest_window_samples() const {
    return static_cast<std::int64_t>(state_->segment) * segments_a_window * windows_a_long_one;
}

void CarrierSearch::push(std::span<const std::complex<float>> samples, std::vector<CarrierFound>& out, bool looks) {
    State& s = *state_;
    while (!samples.empty()) {
        const auto taken = std::min(samples.size(), static_cast<std::size_t>(s.segment - s.filled));
        std::ranges::copy(samples.first(taken), s.padded.begin() + s.filled);
        samples = samples.subspan(taken);
        s.filled += static_cast<int>(taken);
        if (s.filled < s.segment) break;
        s.add_segment(looks || s.rate_hz <= kept_rate_hz);
        if (s.segments_seen % segments_a_window != 0) continue;
        s.normalize();
        const std::size_t before = out.size();
        if (looks) s.search(1, out);
        s.found_lately = s.found_lately || !looks || out.size() > before;
        if (s.segments_seen % s.powers.cols() != 0) continue;
        if (!s.found_lately) s.search(windows_a_long_one, out);
        s.found_lately = false;
    }
}

}  // namespace aeolis::telemetry
