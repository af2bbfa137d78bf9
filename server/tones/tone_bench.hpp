// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"
#include "server/tones/flown_signal.hpp"
#include "simulation/scenario.hpp"

#include <cstdint>
#include <functional>
#include <string>

namespace aeolis::server {

/// A measured figure of the tone receiver, with its goal.
struct ToneFigure {
    std::string name;
    double value = 0.0, goal = 0.0;
    std::string unit;
    bool met = true;
    std::string evidence;      ///< the counts, with their 95 % interval
    std::string text() const;  ///< one line
};

/// The errors counted in a number of trials.
struct ErrorCount {
    std::uint64_t errors = 0, trials = 0;
    double rate() const { return trials == 0 ? 0.0 : static_cast<double>(errors) / static_cast<double>(trials); }
};
/// The 95 % confidence interval of a rate. Source: [wilson-1927].
struct RateInterval {
    double low = 0.0, high = 1.0;
};
RateInterval interval_of(const ErrorCount& count);

/// The C/N0 in excess of what exact theory needs for the error rate counted [dB].
/// @param tone_c_n0_dbhz  tone power to noise density, for a symbol of `symbol_s` with 256 tones
double loss_db(double tone_c_n0_dbhz, double symbol_s, double error_rate);

/// Symbol errors of correlator and statistic at baseband, with frequency and beginnings known.
ErrorCount baseband_errors(const MfskWaveform& waveform, double tone_c_n0_dbhz, std::uint64_t symbols,
                           std::uint64_t seed);

/// Symbol errors with the carrier's phase from the tracker, at `carrier_c_n0_dbhz`; the symbols' starts are known.
ErrorCount carrier_aided_errors(const MfskWaveform& waveform, double carrier_c_n0_dbhz, double tone_c_n0_dbhz,
                                std::uint64_t symbols, std::uint64_t seed);

/// Symbol errors, with erasures, of the whole receiver at `total_c_n0_dbhz`; symbols begin at any time. It acquires at
/// 26 dB-Hz.
ErrorCount receiver_errors(const MfskWaveform& waveform, double total_c_n0_dbhz, std::uint64_t symbols,
                           std::uint64_t seed);

/// Symbol errors of the receiver when it knows when symbols begin, one directly after the other on a steady carrier. An
/// error is a symbol whose likeliest tone, erased or not, is another one, or that has none.
struct SteadyCount {
    ErrorCount errors;
    double c_n0_dbhz = 0.0;  ///< as the receiver measured it, mean
};
SteadyCount steady_errors(const MfskWaveform& waveform, double total_c_n0_dbhz, std::uint64_t symbols,
                          std::uint64_t seed);

/// Acquisition in windows of 1 s over 100 kHz and ±1200 Hz/s; an error is a carrier not found within 50 Hz.
struct AcquisitionCount {
    ErrorCount missed;
    double cpu_ms_a_second = 0.0;  ///< per second of signal
};
AcquisitionCount acquisitions(const MfskWaveform& waveform, double carrier_c_n0_dbhz, std::uint64_t windows,
                              std::uint64_t seed);

/// Windows of 1 s of noise over 100 kHz; an error is a carrier found.
ErrorCount false_alarms(std::uint64_t windows, std::uint64_t seed);

/// A dispersed landing's tones through waveform, channel and receiver; the undispersed flight's Doppler is the predict.
struct LandingTones {
    std::uint64_t sent = 0, decoded = 0, wrong = 0, missed = 0, in_outage = 0, in_outage_decoded = 0;
    double cpu_ms_a_second = 0.0, predict_error_hz = 0.0;
};
/// @param nominal  the undispersed flight, from fly_signal()
LandingTones landing_tones(const FlownSignal& nominal, const simulation::Scenario& dispersed,
                           const dictionary::Dictionary& dictionary, double total_c_n0_dbhz, double rate_hz,
                           std::uint64_t seed);

/// Runs of 90 s in which the carrier steps by 60 to 250 Hz, as when a parachute opens, and then swings by 5 to 40 Hz,
/// 0.5 to 2 times a second, fading over 10 to 30 s. Ranges and goal are required ones.
struct SwingCount {
    std::uint64_t runs = 0, sent = 0, decoded = 0;
    std::uint64_t wrong = 0;  ///< another tone than was sent, or one where none was
    double blind_s = 0.0;     ///< the longest time without the carrier once it was found
};
SwingCount swings(const MfskWaveform& waveform, double total_c_n0_dbhz, std::uint64_t runs, std::uint64_t seed);

/// Measures all figures and reports each once known. True when every goal is met.
/// @param landing    the published geometry
/// @param dispersed  the same landing with its errors drawn, one case per seed
/// @param full       includes the figures that take long
bool tell_tone_figures(const dictionary::Dictionary& dictionary, const simulation::Scenario& landing,
                       const simulation::Scenario& dispersed, bool full,
                       const std::function<void(const ToneFigure&)>& tell);

}  // namespace aeolis::server
