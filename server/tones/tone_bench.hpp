// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"
#include "server/tones/flown_signal.hpp"
#include "simulation/scenario.hpp"

#include <cstdint>
#include <functional>
#include <string>

namespace aeolis::server {

/// One figure of the tone receiver, beside its goal.
struct ToneFigure {
    std::string name;
    double value = 0.0, goal = 0.0;
    std::string unit;
    bool met = true;
    std::string evidence;      ///< what was counted, with its 95 % interval
    std::string text() const;  ///< a line
};

/// Counted errors of a number of trials.
struct ErrorCount {
    std::uint64_t errors = 0, trials = 0;
    double rate() const { return trials == 0 ? 0.0 : static_cast<double>(errors) / static_cast<double>(trials); }
};
/// 95 % interval of a rate. Source: [wilson-1927].
struct RateInterval {
    double low = 0.0, high = 1.0;
};
RateInterval interval_of(const ErrorCount& count);

/// How much more C/N0 was there than exact theory needs for the error counted. [dB]
/// `tone_c_n0_dbhz`: tone power to noise density; a symbol of `symbol_s`, 256 tones.
double loss_db(double tone_c_n0_dbhz, double symbol_s, double error_rate);

/// Symbol error of the receiver's correlator and statistic at baseband; what is not known of the tone is searched.
struct BasebandTrial {
    double tone_c_n0_dbhz = 0.0;
    double frequency_offset_hz = 0.0;  ///< the tone is off by up to this, uniformly, to either side
    double rate_offset_hzps = 0.0;     ///< and drifts by up to this
};
ErrorCount baseband_errors(const MfskWaveform& waveform, const BasebandTrial& trial, std::uint64_t symbols,
                           std::uint64_t seed);

/// The same with the carrier's phase from the tracker: carrier at `carrier_c_n0_dbhz`, symbols' beginnings known.
ErrorCount carrier_aided_errors(const MfskWaveform& waveform, double carrier_c_n0_dbhz, double tone_c_n0_dbhz,
                                std::uint64_t symbols, std::uint64_t seed);

/// The whole receiver, acquired at 26 dB-Hz, then at `total_c_n0_dbhz`: what is not decoded rightly, erasures included.
ErrorCount receiver_errors(const MfskWaveform& waveform, double total_c_n0_dbhz, std::uint64_t symbols,
                           std::uint64_t seed);

/// Windows of 1 s over 100 kHz and ±1200 Hz/s; an error is a carrier not found within 50 Hz.
struct AcquisitionCount {
    ErrorCount missed;
    double cpu_ms_a_second = 0.0;  ///< of signal
};
AcquisitionCount acquisitions(const MfskWaveform& waveform, double carrier_c_n0_dbhz, std::uint64_t windows,
                              std::uint64_t seed);

/// Windows of 1 s of noise over 100 kHz; an error is a carrier found.
ErrorCount false_alarms(std::uint64_t windows, std::uint64_t seed);

/// A dispersed landing's tones through waveform, channel and receiver, the undispersed flight's Doppler being the
/// predict.
struct LandingTones {
    std::uint64_t sent = 0, decoded = 0, wrong = 0, missed = 0, in_outage = 0, in_outage_decoded = 0;
    double cpu_ms_a_second = 0.0, predict_error_hz = 0.0;
};
/// `nominal`: the undispersed flight, as fly_signal made it.
LandingTones landing_tones(const FlownSignal& nominal, const simulation::Scenario& dispersed,
                           const dictionary::Dictionary& dictionary, double total_c_n0_dbhz, double rate_hz,
                           std::uint64_t seed);

/// All figures, each told when it is there; `full`: the points that take long. True when every goal is met.
/// `landing`: the published geometry; `dispersed`: the same landing with its errors drawn, a case a seed.
bool tell_tone_figures(const dictionary::Dictionary& dictionary, const simulation::Scenario& landing,
                       const simulation::Scenario& dispersed, bool full,
                       const std::function<void(const ToneFigure&)>& tell);

}  // namespace aeolis::server
