// SPDX-License-Identifier: Apache-2.0
#include "server/tones/tone_bench.hpp"

#include "server/rehearsal/rehearsal.hpp"
#include "server/tones/flown_signal.hpp"
#include "simulation/links/x_band_channel.hpp"
#include "telemetry/mfsk/symbol_error.hpp"
#include "telemetry/mfsk/tone_receiver.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <fmt/format.h>
#include <functional>
#include <numbers>
#include <optional>

namespace aeolis::server {
namespace {

constexpr double block_s = 1.0;

double cpu_s() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

struct Heard {
    std::vector<telemetry::ToneReception> receptions;
    std::vector<telemetry::CarrierReport> carrier;
    double cpu_s = 0.0;  ///< of the receiver alone
};

/// Passes `length_s` of a channel through a receiver, one second at a time.
Heard hear(const MfskWaveform& waveform, const simulation::XBandPath& path,
           const std::vector<simulation::SentTone>& tones, double length_s, std::uint64_t seed,
           std::optional<double> symbols_from_s = {}) {
    simulation::XBandChannel channel{waveform, path, tones, seed, 2};
    auto receiver =
        telemetry::ToneReceiver::make(waveform, path.rate_hz, {path.predict_hz, path.start_s, {}, {}, symbols_from_s});
    AEOLIS_CHECK(receiver.ok());
    std::vector<std::complex<float>> block(static_cast<std::size_t>(path.rate_hz * block_s));
    Heard heard;
    for (double at_s = 0.0; at_s < length_s; at_s += block_s) {
        channel.next(block);
        const double before_s = cpu_s();
        receiver->push(block);
        for (auto& reception : receiver->take()) heard.receptions.push_back(reception);
        heard.cpu_s += cpu_s() - before_s;
        for (auto& report : receiver->take_carrier()) heard.carrier.push_back(report);
    }
    receiver->finish();
    for (auto& report : receiver->take_carrier()) heard.carrier.push_back(report);
    for (auto& reception : receiver->take()) heard.receptions.push_back(reception);
    return heard;
}

/// The decision for a sent tone: the nearest that began within half a symbol of it.
const telemetry::ToneReception* in_place_of(const simulation::SentTone& sent,
                                            const std::vector<telemetry::ToneReception>& all) {
    const auto apart_s = [&](const telemetry::ToneReception& each) { return std::abs(each.start_s - sent.start_s); };
    const auto nearest = std::ranges::min_element(all, {}, apart_s);
    return nearest == all.end() || apart_s(*nearest) > 5.0 ? nullptr : &*nearest;
}

std::string counted(const ErrorCount& count) {
    const RateInterval interval = interval_of(count);
    return fmt::format("{} of {}: {:.2e} [{:.2e}, {:.2e}]", count.errors, count.trials, count.rate(), interval.low,
                       interval.high);
}

struct SignalLanding {
    double flown_s = 0.0, real_time_factor = 0.0;
    ToneScore::Figures tones;
};

/// Flies a landing as `aeolis rehearse` does, with tones from samples. Measures the wall time.
SignalLanding signal_landing(simulation::Scenario scenario, const dictionary::Dictionary& dictionary) {
    using Clock = std::chrono::steady_clock;
    scenario.radio.tones_from_samples = true;
    const auto began = Clock::now();
    Rehearsal rehearsal{scenario, 1, 0, dictionary};
    while (!rehearsal.finished()) rehearsal.step();
    const double wall_s = std::chrono::duration<double>{Clock::now() - began}.count();
    const double flown_s = static_cast<double>(rehearsal.cycles()) * seconds_per_tick;
    return {flown_s, flown_s / wall_s, rehearsal.tones()};
}

double theory_dbhz(const MfskWaveform& waveform, double error) {
    return 10.0 * std::log10(telemetry::energy_for_symbol_error(error, MfskWaveform::tones) / waveform.symbol_s);
}

}  // namespace

std::string ToneFigure::text() const {
    return fmt::format("{:<40} {:9.4g}   goal {:<7.4g} {:<24} {}   {}", name, value, goal, unit,
                       met ? "met   " : "MISSED", evidence);
}

ErrorCount receiver_errors(const MfskWaveform& waveform, double total_c_n0_dbhz, std::uint64_t symbols,
                           std::uint64_t seed) {
    constexpr double acquired_s = 20.0, strong_dbhz = 26.0;
    simulation::Random random{seed, 2, simulation::Stream::x_band};
    std::vector<simulation::SentTone> tones;
    double at_s = acquired_s + 30.0;
    for (std::uint64_t i = 0; i < symbols; ++i) {
        tones.push_back({at_s, static_cast<std::uint8_t>(random.bits() & 0xff)});
        at_s += waveform.symbol_s + (i % 4 == 3 ? std::floor(random.uniform() * 640.0) / 64.0 : 0.0);
    }
    simulation::XBandPath path;
    path.rate_hz = 4096.0;
    path.total_c_n0_dbhz = total_c_n0_dbhz;
    path.doppler_hz = TimeTable::make({0.0, at_s}, {100.0, 100.0 + 0.02 * at_s}).value();
    path.gain_db = TimeTable::make({0.0, acquired_s, acquired_s + 20.0, at_s + 100.0},
                                   {strong_dbhz - total_c_n0_dbhz, strong_dbhz - total_c_n0_dbhz, 0.0, 0.0})
                       .value();
    const Heard heard = hear(waveform, path, tones, at_s + 20.0, seed);
    ErrorCount count;
    for (const simulation::SentTone& sent : tones) {
        const auto* reception = in_place_of(sent, heard.receptions);
        ++count.trials;
        if (reception == nullptr || reception->tone != sent.tone) ++count.errors;
    }
    return count;
}

SteadyCount steady_errors(const MfskWaveform& waveform, double total_c_n0_dbhz, std::uint64_t symbols,
                          std::uint64_t seed) {
    constexpr double acquired_s = 20.0, faded_s = 100.0, strong_dbhz = 26.0, first_s = 120.0;
    simulation::Random random{seed, 5, simulation::Stream::x_band};
    std::vector<simulation::SentTone> tones(symbols);
    for (std::uint64_t i = 0; i < symbols; ++i)
        tones[i] = {first_s + static_cast<double>(i) * waveform.symbol_s,
                    static_cast<std::uint8_t>(random.bits() & 0xff)};
    const double end_s = first_s + static_cast<double>(symbols) * waveform.symbol_s;
    simulation::XBandPath path;
    path.rate_hz = 4096.0;
    path.total_c_n0_dbhz = total_c_n0_dbhz;
    path.doppler_hz = TimeTable::make({0.0, end_s}, {100.0, 100.0}).value();
    const double more_db = std::max(strong_dbhz - total_c_n0_dbhz, 0.0);
    path.gain_db = TimeTable::make({0.0, acquired_s, faded_s, end_s}, {more_db, more_db, 0.0, 0.0}).value();
    const Heard heard = hear(waveform, path, tones, end_s + 5.0, seed, first_s);
    SteadyCount count;
    double found = 0.0;
    for (const simulation::SentTone& sent : tones) {
        const auto* reception = in_place_of(sent, heard.receptions);
        ++count.errors.trials;
        if (reception == nullptr || reception->evidence.best[0].tone != sent.tone) ++count.errors.errors;
        if (reception == nullptr) continue;
        found += 1.0;
        count.c_n0_dbhz += reception->total_c_n0_dbhz;
    }
    count.c_n0_dbhz /= std::max(found, 1.0);
    return count;
}

AcquisitionCount acquisitions(const MfskWaveform& waveform, double carrier_c_n0_dbhz, std::uint64_t windows,
                              std::uint64_t seed) {
    constexpr double rate_hz = 100e3, rate_max_hzps = 1200.0;
    simulation::Random random{seed, 3, simulation::Stream::x_band};
    std::vector<std::complex<float>> samples(static_cast<std::size_t>(rate_hz));
    AcquisitionCount count;
    double took_s = 0.0;
    for (; count.missed.trials < windows; ++count.missed.trials) {
        const double middle_hz = (random.uniform() - 0.5) * (rate_hz - 2.0 * rate_max_hzps);
        const double rate_hzps = (2.0 * random.uniform() - 1.0) * rate_max_hzps;
        simulation::XBandPath path;
        path.rate_hz = rate_hz;
        path.total_c_n0_dbhz = carrier_c_n0_dbhz;
        path.doppler_hz =
            TimeTable::make({0.0, 1.0}, {middle_hz - 0.5 * rate_hzps, middle_hz + 0.5 * rate_hzps}).value();
        simulation::XBandChannel channel{waveform, path, {}, seed, 1000 + count.missed.trials};
        channel.next(samples);
        telemetry::CarrierSearch search{rate_hz};
        const double before_s = cpu_s();
        std::vector<telemetry::CarrierFound> found;
        search.push(samples, found);
        took_s += cpu_s() - before_s;
        if (found.empty() || std::abs(found[0].frequency_hz - middle_hz) > 50.0) ++count.missed.errors;
    }
    count.cpu_ms_a_second = 1e3 * took_s / static_cast<double>(windows);
    return count;
}

ErrorCount false_alarms(std::uint64_t windows, std::uint64_t seed) {
    constexpr double rate_hz = 100e3;
    simulation::FastNormal noise{seed, 4, simulation::Stream::x_band_noise};
    std::vector<std::complex<float>> samples(static_cast<std::size_t>(rate_hz));
    telemetry::CarrierSearch search{rate_hz};
    ErrorCount count;
    for (; count.trials < windows; ++count.trials) {
        for (auto& sample : samples) sample = {noise(), noise()};
        std::vector<telemetry::CarrierFound> found;
        search.push(samples, found);
        if (!found.empty()) ++count.errors;
    }
    return count;
}

LandingTones landing_tones(const FlownSignal& nominal, const simulation::Scenario& dispersed,
                           const dictionary::Dictionary& dictionary, double total_c_n0_dbhz, double rate_hz,
                           std::uint64_t seed) {
    const FlownSignal flown = fly_signal(dispersed, seed, 1, dictionary);

    simulation::XBandPath path;
    path.rate_hz = rate_hz;
    path.start_s = nominal.doppler_hz.first_s() + 1.0;
    path.total_c_n0_dbhz = total_c_n0_dbhz;
    path.doppler_hz = flown.doppler_hz;
    path.predict_hz = nominal.doppler_hz;
    path.gain_db = flown.gain_db;
    path.set_s = flown.earth_set_s;
    const double length_s = flown.earth_set_s - path.start_s + 20.0;
    const Heard heard = hear(dictionary.mfsk, path, flown.tones, length_s, seed);

    LandingTones result;
    result.cpu_ms_a_second = 1e3 * heard.cpu_s / length_s;
    for (double t = path.start_s; t < flown.earth_set_s; t += 0.1)
        result.predict_error_hz =
            std::max(result.predict_error_hz, std::abs(flown.doppler_hz.at(t) - nominal.doppler_hz.at(t)));
    for (const simulation::SentTone& sent : flown.tones) {
        const double end_s = sent.start_s + dictionary.mfsk.symbol_s;
        if (sent.start_s < path.start_s + 2.0 || sent.start_s >= flown.earth_set_s) continue;
        const bool outage = std::ranges::any_of(flown.outages, [&](const FlownSignal::Outage& each) {
            return end_s > each.from_s && sent.start_s < each.to_s;
        });
        const auto* reception = in_place_of(sent, heard.receptions);
        const bool right = reception != nullptr && reception->tone == sent.tone;
        if (reception != nullptr && reception->tone && !right) ++result.wrong;
        if (outage) {
            ++result.in_outage;
            result.in_outage_decoded += right ? 1 : 0;
        } else {
            ++result.sent;
            right ? ++result.decoded : ++result.missed;
        }
    }
    // A tone decoded where none was sent is also wrong.
    for (const telemetry::ToneReception& each : heard.receptions)
        if (each.tone && std::ranges::none_of(flown.tones, [&](const simulation::SentTone& sent) {
                return std::abs(each.start_s - sent.start_s) <= 5.0;
            }))
            ++result.wrong;
    return result;
}

SwingCount swings(const MfskWaveform& waveform, double total_c_n0_dbhz, std::uint64_t runs, std::uint64_t seed) {
    constexpr double length_s = 90.0, step_s = 1.0 / 64.0, report_s = 0.125, turn = 2.0 * std::numbers::pi;
    SwingCount count;
    for (; count.runs < runs; ++count.runs) {
        simulation::Random random{seed, count.runs, simulation::Stream::x_band};
        const auto between = [&](double least, double most) { return least + (most - least) * random.uniform(); };
        const double step_hz = between(60.0, 250.0) * (random.uniform() < 0.5 ? -1.0 : 1.0),
                     swing_hz = between(5.0, 40.0), swings_a_second = between(0.5, 2.0),
                     rate_hzps = between(-20.0, 20.0), opens_s = between(28.0, 36.0), fades_s = between(10.0, 30.0);
        std::vector<double> time_s, doppler_hz;
        for (double t = 0.0; t <= length_s + 1.0; t += step_s) {
            const double since_s = std::max(t - opens_s, 0.0);
            time_s.push_back(t);
            doppler_hz.push_back(200.0 + 3.0 * std::min(t, opens_s) - step_hz * (1.0 - std::exp(-since_s / 0.5)) +
                                 rate_hzps * std::min(since_s, 20.0) +
                                 swing_hz * std::sin(turn * swings_a_second * since_s) * std::exp(-since_s / fades_s));
        }
        std::vector<simulation::SentTone> tones;
        for (double at_s = between(6.0, 7.0); at_s + waveform.symbol_s < length_s; at_s += waveform.symbol_s)
            tones.push_back({at_s, static_cast<std::uint8_t>(random.bits() & 0xff)});
        simulation::XBandPath path;
        path.rate_hz = 8192.0;
        path.total_c_n0_dbhz = total_c_n0_dbhz;
        path.doppler_hz = TimeTable::make(std::move(time_s), std::move(doppler_hz)).value();
        const Heard heard = hear(waveform, path, tones, length_s, seed + count.runs);
        count.sent += tones.size();
        for (const simulation::SentTone& sent : tones) {
            const auto* reception = in_place_of(sent, heard.receptions);
            if (reception == nullptr || !reception->tone) continue;
            ++(reception->tone == sent.tone ? count.decoded : count.wrong);
        }
        count.wrong += static_cast<std::uint64_t>(std::ranges::count_if(heard.receptions, [&](const auto& each) {
            return each.tone && std::ranges::none_of(tones, [&](const simulation::SentTone& sent) {
                       return std::abs(each.start_s - sent.start_s) <= 5.0;
                   });
        }));
        double blind_s = 0.0;
        bool found = false;
        for (const telemetry::CarrierReport& report : heard.carrier) {
            const bool follows = report.lock <= CarrierLock::fluctuating;
            found = found || follows;
            blind_s = follows || !found ? 0.0 : blind_s + report_s;
            count.blind_s = std::max(count.blind_s, blind_s);
        }
    }
    return count;
}

bool tell_tone_figures(const dictionary::Dictionary& dictionary, const simulation::Scenario& landing,
                       const simulation::Scenario& dispersed, bool full,
                       const std::function<void(const ToneFigure&)>& tell) {
    const MfskWaveform& mfsk = dictionary.mfsk;
    bool all_met = true;
    const auto add = [&](const ToneFigure& figure) {
        tell(figure);
        all_met = all_met && figure.met;
    };
    const auto add_loss = [&](const std::string& name, double tone_dbhz, double goal_db, const ErrorCount& count) {
        const double loss = loss_db(tone_dbhz, mfsk.symbol_s, count.rate());
        const RateInterval rates = interval_of(count);
        const double least = loss_db(tone_dbhz, mfsk.symbol_s, rates.low),
                     most = loss_db(tone_dbhz, mfsk.symbol_s, rates.high);
        add({name, loss, goal_db, "dB from theory", loss <= goal_db,
             fmt::format("at {:.2f} dB-Hz, {}; loss [{:.2f}, {:.2f}] dB", tone_dbhz, counted(count), least, most)});
    };

    add_loss("frequency known, 1e-2", theory_dbhz(mfsk, 1e-2), 0.1,
             baseband_errors(mfsk, theory_dbhz(mfsk, 1e-2), full ? 100'000 : 32'000, 1));
    if (full)
        add_loss("frequency known, 1e-3", theory_dbhz(mfsk, 1e-3), 0.1,
                 baseband_errors(mfsk, theory_dbhz(mfsk, 1e-3), 350'000, 2));
    add_loss("carrier-aided, carrier at 20.5 dB-Hz", theory_dbhz(mfsk, full ? 1e-2 : 3e-2), 0.3,
             carrier_aided_errors(mfsk, 20.5, theory_dbhz(mfsk, full ? 1e-2 : 3e-2), full ? 40'000 : 8'000, 5));

    const double tone_part_db = 10.0 * std::log10(mfsk.tone_fraction());
    double bias_db = 0.0;
    for (const double error : {1e-2, 1e-3}) {
        if (error < 1e-2 && !full) continue;
        constexpr double above_theory_db = 0.2;
        const double tone_dbhz = theory_dbhz(mfsk, error) + above_theory_db;
        const SteadyCount steady = steady_errors(mfsk, tone_dbhz - tone_part_db,
                                                 error < 1e-2 ? 20'000
                                                 : full       ? 6'000
                                                              : 1'000,
                                                 6);
        add_loss(fmt::format("the whole receiver, beginnings known, {:.0e}", error), tone_dbhz, 0.5, steady.errors);
        bias_db = std::max(bias_db, std::abs(steady.c_n0_dbhz - (tone_dbhz - tone_part_db)));
    }
    bias_db = std::max(bias_db, std::abs(steady_errors(mfsk, 22.0, full ? 1'000 : 100, 9).c_n0_dbhz - 22.0));
    add({"C/N0: bias, there and at 22 dB-Hz", bias_db, 0.1, "dB", bias_db <= 0.1, ""});
    for (const double total_dbhz : {10.3, 11.3}) {
        const ErrorCount count = receiver_errors(mfsk, total_dbhz, full ? 6'000 : 300, 6);
        const double loss = loss_db(total_dbhz + tone_part_db, mfsk.symbol_s, count.rate());
        add({fmt::format("the whole receiver at {} dB-Hz total", total_dbhz), loss, 0.0, "dB from theory, no goal",
             true, "erasures count: " + counted(count)});
    }

    const AcquisitionCount found = acquisitions(mfsk, 20.5, full ? 10'000 : 1'000, 7);
    add({"acquisition, carrier at 20.5 dB-Hz: Pd", 1.0 - found.missed.rate(), 0.99, "", found.missed.rate() <= 0.01,
         "missed " + counted(found.missed)});
    add({"acquisition over 100 kHz", found.cpu_ms_a_second, 10.0, "ms of CPU a second", found.cpu_ms_a_second <= 10.0,
         ""});
    const ErrorCount alarms = false_alarms(full ? 30'000 : 1'000, 8);
    add({"acquisition in noise: Pfa", alarms.rate(), telemetry::CarrierSearch::false_alarm, "a window",
         interval_of(alarms).low <= telemetry::CarrierSearch::false_alarm,
         counted(alarms) + ", a bound by construction"});

    constexpr double total_dbhz = 22.0, low_rate_hz = 16384.0, whole_band_hz = 100e3;
    const FlownSignal nominal = fly_signal(landing, 1, 0, dictionary);
    LandingTones sum;
    const std::uint64_t seeds = full ? 50 : 5;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
        const LandingTones one = landing_tones(nominal, dispersed, dictionary, total_dbhz, low_rate_hz, seed);
        sum.sent += one.sent;
        sum.decoded += one.decoded;
        sum.wrong += one.wrong;
        sum.in_outage += one.in_outage;
        sum.in_outage_decoded += one.in_outage_decoded;
        sum.cpu_ms_a_second += one.cpu_ms_a_second / static_cast<double>(seeds);
        sum.predict_error_hz = std::max(sum.predict_error_hz, one.predict_error_hz);
    }
    add({"OD137 at 22 dB-Hz total: decoded", static_cast<double>(sum.decoded), static_cast<double>(sum.sent), "tones",
         sum.sent > 0 && sum.decoded == sum.sent,
         fmt::format("{} landings; of {} in outages {}; the predict is wrong by up to {:.0f} Hz", seeds, sum.in_outage,
                     sum.in_outage_decoded, sum.predict_error_hz)});
    add({"OD137 at 22 dB-Hz total: wrong", static_cast<double>(sum.wrong), 0.0, "tones", sum.wrong == 0, ""});
    add({"receiver, samples at 16 kHz", sum.cpu_ms_a_second, 15.0, "ms of CPU a second", sum.cpu_ms_a_second <= 15.0,
         ""});
    const double wide_ms = landing_tones(nominal, dispersed, dictionary, total_dbhz, whole_band_hz, 1).cpu_ms_a_second;
    add({"receiver, samples at 100 kHz", wide_ms, 15.0, "ms of CPU a second", wide_ms <= 15.0, ""});
    const SwingCount swung = swings(mfsk, total_dbhz, full ? 200 : 20, 10);
    add({"step and swing at 22 dB-Hz: wrong", static_cast<double>(swung.wrong), 0.0, "tones", swung.wrong == 0,
         fmt::format("{} runs: {} tones sent, {} decoded", swung.runs, swung.sent, swung.decoded)});
    add({"step and swing at 22 dB-Hz: blind", swung.blind_s, 10.0, "s at most", swung.blind_s <= 10.0, ""});
    const SignalLanding whole = signal_landing(landing, dictionary);
    add({"a landing with its tones from samples", whole.real_time_factor, 20.0, "x real time",
         whole.real_time_factor >= 20.0,
         fmt::format("{:.0f} s flown; tones {} sent, {} decoded, {} wrong, {} missed", whole.flown_s, whole.tones.sent,
                     whole.tones.decoded, whole.tones.wrong, whole.tones.missed)});
    return all_met;
}

}  // namespace aeolis::server
