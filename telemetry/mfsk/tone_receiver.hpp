// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "telemetry/mfsk/single_receiver.hpp"
#include "telemetry/mfsk/standing_lines.hpp"

#include <list>
#include <optional>
#include <span>
#include <vector>

namespace aeolis::telemetry {

/// Ground's receiver of X-band tones: complex samples in, decisions out.
///
/// In      blocks of samples of any length, at a fixed rate; the predict that was removed before sampling
/// Out     one reception a symbol by take(), 1 to 20 s after the symbol's end
/// Lines   that stand still near the carrier may not be the vehicle's. While no tone is heard, up to three receivers
///         listen beside: without the strongest line, without the second, without both. The first that hears a tone
///         takes over. Once tones are heard, lines beside their carrier are taken out
/// Faults  as of SingleReceiver. A line at the carrier's own frequency, to some 3 Hz, cannot be told from it
class ToneReceiver {
  public:
    static constexpr double rate_least_hz = SingleReceiver::rate_least_hz;
    static constexpr double rate_greatest_hz = SingleReceiver::rate_greatest_hz;

    /// Fails for a rate out of range or too low for the tones.
    static Result<ToneReceiver> make(const MfskWaveform& waveform, double rate_hz, ReceiverInput input = {});

    void push(std::span<const std::complex<float>> samples);
    /// Decides everything that still waits, as if no more samples came.
    void finish();
    /// Receptions since the last call, in the order of time.
    std::vector<ToneReception> take();
    /// The carrier since the last call, hop by hop.
    std::vector<CarrierReport> take_carrier();

    const ReceiverStatus& status() const { return status_; }

  private:
    static constexpr double never_s = -1e18;

    /// A receiver that takes some lines for none of the vehicle's.
    struct Beside {
        SingleReceiver receiver;
        std::vector<double> left_out_hz;
        std::int64_t begun = 0;  ///< samples received before it
        std::vector<ToneReception> receptions;
        std::vector<CarrierReport> reports;
    };

    ToneReceiver(const MfskWaveform& waveform, double rate_hz, ReceiverInput input, SingleReceiver receiver)
        : waveform_(waveform), rate_hz_(rate_hz), input_(std::move(input)), receiver_(std::move(receiver)) {}

    void take_from_all();
    void judge_lines();
    void listen_without(const std::vector<double>& lines_hz);
    bool is_left_out(double line_hz) const;
    bool takes_over(const Beside& beside) const;
    void take_over(Beside& beside);
    void tell_status();

    MfskWaveform waveform_;
    double rate_hz_;
    ReceiverInput input_;
    std::optional<SingleReceiver> receiver_;  ///< always one
    std::list<Beside> besides_;
    std::optional<StandingLines> lines_;
    std::int64_t looks_judged_ = 0;
    std::int64_t received_ = 0;  ///< samples
    bool ended_ = false;
    std::vector<double> left_out_hz_;
    std::vector<ToneReception> receptions_;
    std::vector<CarrierReport> reports_;
    double last_begin_s_ = never_s, last_tone_s_ = never_s, last_report_s_ = never_s;  ///< of what was told
    ReceiverStatus before_;  ///< counts of receivers that another took over from
    ReceiverStatus status_;
};

}  // namespace aeolis::telemetry
