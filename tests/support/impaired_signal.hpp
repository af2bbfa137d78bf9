// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <complex>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

// A transmitter and a channel with faults, for tests of the tone receiver. They follow docs/tones.md, and share no code
// with the receiver or the simulator.
namespace aeolis::tests::impaired {

using Samples = std::vector<std::complex<float>>;

struct Tone {
    double start_s;
    int tone;
};

struct Signal {
    double rate_hz = 8192.0;  ///< stated
    double length_s = 60.0;
    double c_n0_dbhz = 22.0;  ///< of total power
    std::vector<Tone> tones;
    std::function<double(double)> frequency_hz = [](double) { return 350.0; };
    std::function<double(double)> gain_db = [](double) { return 0.0; };  ///< of the signal, not of the noise
    double clock_error = 0.0;     ///< samples come by this share faster than stated
    double phase_walk_rad = 0.0;  ///< of the carrier in a second
    std::uint64_t seed = 1;
};

/// Tones back to back and after pauses, from 6 s on.
inline std::vector<Tone> tones_until(double length_s, std::uint64_t seed) {
    std::mt19937_64 random{seed * 77 + 5};
    std::vector<Tone> tones;
    double at_s = 6.0 + static_cast<double>(random() % 64) / 64.0;
    while (at_s + 10.5 < length_s) {
        tones.push_back({at_s, static_cast<int>(random() % 256)});
        at_s += 10.0 + (random() % 3 == 0 ? static_cast<double>(random() % 320) / 64.0 : 0.0);
    }
    return tones;
}

/// The signal with white noise of power 1 a sample.
inline Samples transmitted(const Signal& signal) {
    constexpr double turn = 2.0 * std::numbers::pi, index = 32.0 * std::numbers::pi / 180.0;
    std::mt19937_64 random{signal.seed};
    std::normal_distribution<float> normal{0.0F, std::sqrt(0.5F)};
    std::normal_distribution<double> walk;
    const double walk_rad = signal.phase_walk_rad / std::sqrt(signal.rate_hz);  // a sample
    const double true_rate_hz = signal.rate_hz * (1.0 + signal.clock_error);
    const double amplitude = std::sqrt(std::pow(10.0, 0.1 * signal.c_n0_dbhz) / true_rate_hz);
    Samples samples(static_cast<std::size_t>(signal.length_s * signal.rate_hz));
    double cycles = 0.3;
    std::size_t next = 0;
    double frequency = 0.0, gain = 1.0, wander = 0.0;
    for (std::size_t n = 0; n < samples.size(); ++n) {
        const double t = static_cast<double>(n) / true_rate_hz;
        if (n % 8 == 0) {
            frequency = signal.frequency_hz(t);
            gain = std::pow(10.0, 0.05 * signal.gain_db(t));
        }
        cycles += frequency / true_rate_hz;
        cycles -= std::floor(cycles);
        if (signal.phase_walk_rad > 0.0) wander += walk_rad * walk(random);
        while (next < signal.tones.size() && t >= signal.tones[next].start_s + 10.0) ++next;
        double phase = 0.0;
        if (next < signal.tones.size() && t >= signal.tones[next].start_s) {
            const double tone_hz = 300.0 + signal.tones[next].tone;
            const double angle = turn * tone_hz * (t - signal.tones[next].start_s);
            double square = 0.0;  // the harmonics that the samples hold
            for (int h = 1; h * tone_hz < 0.4 * true_rate_hz; h += 2) square += std::sin(h * angle) / h;
            phase = square * 4.0 / std::numbers::pi;
        }
        const std::complex<double> modulated{std::cos(index), std::sin(index) * phase};
        const auto value = amplitude * gain * modulated * std::polar(1.0, turn * cycles + wander);
        samples[n] = std::complex<float>{value} + std::complex<float>{normal(random), normal(random)};
    }
    return samples;
}

/// A Butterworth low pass of order 4, by two biquads of the bilinear transform; `shift_hz` moves its middle.
inline void low_pass(Samples& samples, double rate_hz, double edge_hz, double shift_hz = 0.0) {
    const double k = std::tan(std::numbers::pi * edge_hz / rate_hz);
    const auto turned = [&](std::complex<double> z, std::size_t n, double sign) {
        return shift_hz == 0.0
                   ? z
                   : z * std::polar(1.0, sign * 2.0 * std::numbers::pi * shift_hz * static_cast<double>(n) / rate_hz);
    };
    for (const double q : {0.54119610, 1.3065630}) {
        const double norm = 1.0 / (1.0 + k / q + k * k);
        const double b0 = k * k * norm, a1 = 2.0 * (k * k - 1.0) * norm, a2 = (1.0 - k / q + k * k) * norm;
        std::complex<double> z1{}, z2{};
        for (std::size_t n = 0; n < samples.size(); ++n) {
            const std::complex<double> x = turned(std::complex<double>{samples[n]}, n, -1.0);
            const std::complex<double> y = b0 * x + z1;
            z1 = 2.0 * b0 * x - a1 * y + z2;
            z2 = b0 * x - a2 * y;
            samples[n] = std::complex<float>{turned(y, n, 1.0)};
        }
    }
}

/// A single pole at `edge_hz`: a slope of 6 dB an octave above it.
inline void slope(Samples& samples, double rate_hz, double edge_hz) {
    const auto gain = static_cast<float>(1.0 - std::exp(-2.0 * std::numbers::pi * edge_hz / rate_hz));
    std::complex<float> state{};
    for (auto& sample : samples) sample = state += gain * (sample - state);
}

/// A line of constant amplitude, `level_db` over a signal of `c_n0_dbhz` in noise of power 1 a sample.
inline void add_line(Samples& samples, double rate_hz, double c_n0_dbhz, double level_db,
                     const std::function<double(double)>& frequency_hz) {
    const double amplitude = std::sqrt(std::pow(10.0, 0.1 * (c_n0_dbhz + level_db)) / rate_hz);
    double cycles = 0.1;
    for (std::size_t n = 0; n < samples.size(); ++n) {
        cycles += frequency_hz(static_cast<double>(n) / rate_hz) / rate_hz;
        cycles -= std::floor(cycles);
        samples[n] += std::complex<float>{std::polar(amplitude, 2.0 * std::numbers::pi * cycles)};
    }
}

/// Applies `change` to the samples of `length_s` at each multiple of `every_s`, from `from_s` on.
inline void each(Samples& samples, double rate_hz, double from_s, double every_s, double length_s,
                 const std::function<void(std::complex<float>&)>& change) {
    for (double at_s = from_s; at_s * rate_hz < static_cast<double>(samples.size()); at_s += every_s)
        for (auto n = static_cast<std::size_t>(at_s * rate_hz);
             n < samples.size() && static_cast<double>(n) < (at_s + length_s) * rate_hz; ++n)
            change(samples[n]);
}

/// One case of the suite: a signal, and what happens to its samples.
struct Case {
    std::string kind, level;
    std::function<void(Signal&)> sent = [](Signal&) {};
    std::function<void(Samples&, const Signal&)> spoiled = [](Samples&, const Signal&) {};
    bool is_noise_only = false;
    double usable = 1.0;   ///< share of the tones that must be heard
    bool is_short = true;  ///< part of the short suite
};

inline std::vector<Case> cases() {
    using std::to_string;
    constexpr float none = std::numeric_limits<float>::quiet_NaN();
    constexpr double turn = 2.0 * std::numbers::pi;
    std::vector<Case> all;
    const auto text = [](double value) {
        std::string digits = to_string(value);
        digits.erase(digits.find_last_not_of('0') + 1);
        if (digits.back() == '.') digits.pop_back();
        return digits;
    };
    bool is_first = true;
    const auto add = [&](std::string kind, std::string level, std::function<void(Signal&)> sent,
                         std::function<void(Samples&, const Signal&)> spoiled, double usable = 1.0) {
        if (!all.empty()) is_first = all.back().kind != kind;
        if (!sent) sent = [](Signal&) {};
        if (!spoiled) spoiled = [](Samples&, const Signal&) {};
        all.push_back(
            {std::move(kind), std::move(level), std::move(sent), std::move(spoiled), false, usable, is_first});
    };
    for (const double level : {22.0, 18.0, 16.0, 30.0, 45.0, 80.0, 120.0})
        add("clean", text(level) + " dB-Hz", [=](Signal& s) { s.c_n0_dbhz = level; }, {});
    for (const double edge : {1500.0, 1200.0, 2500.0})
        add("narrow passband", text(edge) + " Hz", {},
            [=](Samples& x, const Signal& s) { low_pass(x, s.rate_hz, edge); });
    for (const double shift : {400.0, -700.0, 1000.0})
        add("passband aside", text(shift) + " Hz", {},
            [=](Samples& x, const Signal& s) { low_pass(x, s.rate_hz, 1600.0, shift); });
    for (const double edge : {1000.0, 300.0, 100.0})
        add(
            "slope", text(edge) + " Hz", {}, [=](Samples& x, const Signal& s) { slope(x, s.rate_hz, edge); },
            edge < 200.0 ? 0.0 : 1.0);
    for (const double level : {0.0, 10.0, 20.0, 30.0})
        add("spur", text(level) + " dB", {}, [=](Samples& x, const Signal& s) {
            add_line(x, s.rate_hz, s.c_n0_dbhz, level, [](double) { return -1500.0; });
        });
    for (const double level : {-8.0, -3.0, 0.0, 10.0})
        add("spur among the tones", text(level) + " dB", {}, [=](Samples& x, const Signal& s) {
            add_line(x, s.rate_hz, s.c_n0_dbhz, level, [](double) { return 350.0 + 428.0; });
        });
    for (const double level : {0.0, 6.0})
        add("two spurs", text(level) + " dB", {}, [=](Samples& x, const Signal& s) {
            add_line(x, s.rate_hz, s.c_n0_dbhz, level, [](double) { return -2100.0; });
            add_line(x, s.rate_hz, s.c_n0_dbhz, level - 2.0, [](double) { return 1900.0; });
        });
    for (const double rate : {30.0, 100.0})
        add(
            "spur that sweeps", text(rate) + " Hz/s", {},
            [=](Samples& x, const Signal& s) {
                add_line(x, s.rate_hz, s.c_n0_dbhz, 3.0, [=](double t) { return -3000.0 + rate * t; });
            },
            0.8);
    for (const double level : {0.0, 20.0, 40.0})
        add(
            "DC", text(level) + " dB", {},
            [=](Samples& x, const Signal& s) {
                add_line(x, s.rate_hz, s.c_n0_dbhz, level, [](double) { return 0.0; });
            },
            level > 0.0 ? 0.0 : 1.0);  // a stronger one is to be excluded
    // A line beside the carrier is known after 12 to 16 s, and tones are heard from then on.
    for (const double aside : {40.0, -40.0, 80.0, -80.0, 150.0})
        add(
            "line beside the carrier", text(aside) + " Hz", [](Signal& s) { s.c_n0_dbhz = 24.0; },
            [=](Samples& x, const Signal& s) {
                add_line(x, s.rate_hz, s.c_n0_dbhz, 0.0, [=](double) { return 350.0 + aside; });
            },
            0.6);
    for (const double level : {0.0, 3.0, -3.0})
        add(
            "line that the carrier passes", text(level) + " dB",
            [](Signal& s) {
                s.c_n0_dbhz = 24.0;
                s.frequency_hz = [](double t) { return -80.0 + 2.0 * t; };
            },
            [=](Samples& x, const Signal& s) {
                add_line(x, s.rate_hz, s.c_n0_dbhz, level, [](double) { return 0.0; });
            },
            0.6);
    for (const double hz : {10.0, 30.0, 60.0})
        add(
            "DC under the carrier", text(hz) + " Hz",
            [=](Signal& s) {
                s.c_n0_dbhz = 24.0;
                s.frequency_hz = [=](double) { return hz; };
            },
            [=](Samples& x, const Signal& s) { add_line(x, s.rate_hz, s.c_n0_dbhz, 0.0, [](double) { return 0.0; }); },
            0.6);
    add(
        "line at the carrier", "0 dB", [](Signal& s) { s.c_n0_dbhz = 24.0; },
        [=](Samples& x, const Signal& s) { add_line(x, s.rate_hz, s.c_n0_dbhz, 0.0, [](double) { return 350.0; }); },
        0.0);
    for (const double level : {10.0, 20.0, 30.0})
        add("bursts of noise", text(level) + " dB", {}, [=](Samples& x, const Signal& s) {
            std::mt19937_64 random{s.seed + 9};
            std::normal_distribution<float> normal{0.0F, static_cast<float>(std::pow(10.0, 0.05 * level))};
            each(x, s.rate_hz, 2.0, 2.7, 0.4,
                 [&](auto& z) { z += std::complex<float>{normal(random), normal(random)}; });
        });
    for (const double level : {20.0, 30.0, 60.0})
        add("pulses", text(level) + " dB", {}, [=](Samples& x, const Signal& s) {
            const auto amplitude = static_cast<float>(std::pow(10.0, 0.05 * level));
            each(x, s.rate_hz, 0.03, 0.09, 0.001, [&](auto& z) { z += amplitude; });
        });
    for (const double length : {0.2, 0.01, 1.0})
        add("gaps of zeros", text(length) + " s", {}, [=](Samples& x, const Signal& s) {
            each(x, s.rate_hz, 3.0, 10.0 * length + 0.31, length, [](auto& z) { z = 0.0F; });
        });
    for (const double length : {2.4, 9.0})
        add(
            "one gap of zeros", text(length) + " s", {},
            [=](Samples& x, const Signal& s) { each(x, s.rate_hz, 28.0, 1e9, length, [](auto& z) { z = 0.0F; }); },
            0.5);
    for (const double length : {2.4, 9.0})
        add(
            "one gap of NaN", text(length) + " s", {},
            [=](Samples& x, const Signal& s) {
                each(x, s.rate_hz, 28.0, 1e9, length, [](auto& z) { z = {none, none}; });
            },
            0.5);
    for (const double length : {2.4, 9.0})
        add(
            "a stuck converter", text(length) + " s", {},
            [=](Samples& x, const Signal& s) {
                each(x, s.rate_hz, 28.0, 1e9, length, [](auto& z) { z = {7.0F, -3.0F}; });
            },
            0.5);
    for (const double step : {6.0, 20.0, -20.0})
        add("gain steps", text(step) + " dB", {}, [=](Samples& x, const Signal& s) {
            const auto gain = static_cast<float>(std::pow(10.0, 0.05 * step));
            each(x, s.rate_hz, 4.0, 14.0, 7.0, [&](auto& z) { z *= gain; });
        });
    for (const double hz : {0.3, 3.0})
        add("gain that pumps", text(hz) + " Hz", {}, [=](Samples& x, const Signal& s) {
            for (std::size_t n = 0; n < x.size(); ++n)
                x[n] *=
                    static_cast<float>(std::pow(10.0, 0.25 * std::sin(turn * hz * static_cast<double>(n) / s.rate_hz)));
        });
    for (const double ppm : {500.0, -500.0, 200.0, -70.0, 20.0})
        add("clock error", text(ppm) + " ppm", [=](Signal& s) { s.clock_error = 1e-6 * ppm; }, {}, 0.75);
    add("I/Q inverted", "", {}, [](Samples& x, const Signal&) {
        for (auto& z : x) z = std::conj(z);
    });
    for (const double phase : {5.0, 15.0})
        add("I/Q unbalanced", text(phase) + " deg", {}, [=](Samples& x, const Signal&) {
            const auto image = std::polar(static_cast<float>(phase / 100.0), 0.4F);
            for (auto& z : x) z += image * std::conj(z);
        });
    for (const double limit : {0.7, 0.2})
        add("clipping", text(limit) + " deviations", {}, [=](Samples& x, const Signal&) {
            const auto most = static_cast<float>(limit);
            for (auto& z : x) z = {std::clamp(z.real(), -most, most), std::clamp(z.imag(), -most, most)};
        });
    for (const double step : {1.0, 2.0, 0.25})
        add("quantisation", text(step) + " deviations", {}, [=](Samples& x, const Signal&) {
            const auto by = static_cast<float>(step);
            for (auto& z : x) z = {by * std::round(z.real() / by), by * std::round(z.imag() / by)};
        });
    for (const double rate : {60.0, -300.0, 900.0})
        add(
            "drift", text(rate) + " Hz/s",
            [=](Signal& s) {
                const double band = 3000.0;
                s.frequency_hz = [=](double t) {
                    const double path = std::fmod(std::abs(rate) * t, 2.0 * band);
                    return (rate > 0.0 ? 1.0 : -1.0) * ((path < band ? path : 2.0 * band - path) - 0.5 * band);
                };
            },
            {}, 0.7);
    for (const double step : {60.0, -150.0, 250.0, 1500.0})
        add(
            "steps of Doppler", text(step) + " Hz",
            [=](Signal& s) {
                s.frequency_hz = [=](double t) { return std::fmod(t, 34.0) < 19.3 ? 200.0 : 200.0 + step; };
            },
            {}, 0.7);
    for (const auto& [hz, rate] :
         {std::pair{10.0, 1.0}, std::pair{5.0, 2.0}, std::pair{40.0, 0.5}, std::pair{40.0, 2.0}})
        add(
            "swing", text(hz) + " Hz at " + text(rate) + " Hz",
            [=](Signal& s) {
                s.frequency_hz = [=](double t) {
                    return 200.0 + (t > 25.0 ? hz * std::sin(turn * rate * t) * std::exp(-(t - 25.0) / 30.0) : 0.0);
                };
            },
            {}, hz > 20.0 && rate > 1.0 ? 0.4 : 0.7);
    for (const auto& [step, hz] : {std::pair{250.0, 20.0}, std::pair{60.0, 40.0}, std::pair{120.0, 10.0}})
        add(
            "parachute", text(step) + " Hz, then " + text(hz) + " Hz",
            [=](Signal& s) {
                s.frequency_hz = [=](double t) {
                    const double since = t - 30.0;
                    return since < 0.0 ? 200.0 + 3.0 * t
                                       : 290.0 - step * (1.0 - std::exp(-since / 0.5)) - 20.0 * since +
                                             hz * std::sin(turn * 0.8 * since) * std::exp(-since / 15.0);
                };
            },
            {}, 0.6);
    for (const double share : {1.05, 0.95, 1.012})
        add("rate wrong", text(share), [=](Signal& s) { s.clock_error = share - 1.0; }, {}, 0.0);
    for (const double depth : {6.0, 15.0})
        add(
            "fading", text(depth) + " dB",
            [=](Signal& s) { s.gain_db = [=](double t) { return -0.5 * depth * (1.0 - std::cos(turn * 0.2 * t)); }; },
            {}, 0.5);
    for (const double walk : {0.5, 1.5})
        add("phase noise", text(walk) + " rad in 1 s", [=](Signal& s) { s.phase_walk_rad = walk; }, {}, 0.7);
    for (const int lost : {100, 3000})
        add(
            "lost samples", to_string(lost), {},
            [=](Samples& x, const Signal& s) {
                for (std::size_t at = x.size() / 2; at > static_cast<std::size_t>(12.0 * s.rate_hz);
                     at -= static_cast<std::size_t>(7.0 * s.rate_hz))
                    x.erase(x.begin() + static_cast<std::ptrdiff_t>(at),
                            x.begin() + static_cast<std::ptrdiff_t>(at) + lost);
            },
            0.4);
    for (const double hum : {50.0, 100.0})
        add("hum on the level", text(hum) + " Hz", {}, [=](Samples& x, const Signal& s) {
            for (std::size_t n = 0; n < x.size(); ++n)
                x[n] *= static_cast<float>(1.0 + 0.5 * std::sin(turn * hum * static_cast<double>(n) / s.rate_hz));
        });
    for (const double edge : {2000.0, 900.0})
        add(
            "too much of it at once", text(edge) + " Hz", [](Signal& s) { s.clock_error = 40e-6; },
            [=](Samples& x, const Signal& s) {
                add_line(x, s.rate_hz, s.c_n0_dbhz, 6.0, [](double) { return -1100.0; });
                low_pass(x, s.rate_hz, edge, 200.0);
                each(x, s.rate_hz, 20.0, 11.0, 0.7, [](auto& z) { z = 0.0F; });
                each(x, s.rate_hz, 4.0, 14.0, 7.0, [](auto& z) { z *= 3.0F; });
            },
            0.6);
    return all;
}

}  // namespace aeolis::tests::impaired
