// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "common/time_table.hpp"
#include "telemetry/mfsk/carrier_report.hpp"
#include "telemetry/mfsk/carrier_search.hpp"
#include "telemetry/mfsk/doppler_remover.hpp"
#include "telemetry/mfsk/sample_conditioner.hpp"
#include "telemetry/mfsk/symbol_sequence.hpp"
#include "telemetry/mfsk/tone_reception.hpp"

#include <array>
#include <complex>
#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace aeolis::telemetry {

/// A receiver of X-band tones that takes every line in the samples but the excluded ones for a carrier: complex samples
/// in, decisions out.
///
/// In       blocks of samples of any length, at a fixed rate; the predict that was removed before sampling
/// Out      one reception a symbol by take(), 1 to 20 s after the symbol's end
/// Carriers three are followed at a time at most. Of those the one with tones is the vehicle's: another takes its place
///          when it is lost, or when the other shows a tone and it has shown none for two symbols
/// Noise    of tones: what is in phase with the carrier at their frequencies, the median over their neighbours
/// Clock    an error of the samples' clock to 600 ppm shifts the tones. It is found when tones agree on it, and those
///          of the last 45 s are then decided. Where most of them contradict the clock, tones are erased
/// Memory   6 s of samples, and the sums of 45 s
/// Faults   silence, noise, gaps and values that are not numbers give no reception; a pulse far above the rest is
///          blanked; a lost carrier is searched for again
class SingleReceiver {
  public:
    static constexpr double rate_least_hz = 3000.0, rate_greatest_hz = 1.0e6;  ///< chosen

    /// Fails for a rate out of range or too low for the tones.
    static Result<SingleReceiver> make(const MfskWaveform& waveform, double rate_hz, ReceiverInput input = {});

    void push(std::span<const std::complex<float>> samples);
    /// Decides everything that still waits, as if no more samples came.
    void finish();
    /// Receptions since the last call, in the order of time.
    std::vector<ToneReception> take();
    /// The carrier since the last call, hop by hop.
    std::vector<CarrierReport> take_carrier();

    const ReceiverStatus& status() const { return status_; }
    /// Frequency of the followed carrier in the samples, with the expected Doppler; none while it is missed.
    std::optional<double> carrier_hz() const;
    /// Whether the followed carrier is there, and has shown a tone within the last three symbols.
    bool is_content() const;
    /// Whether the newest tone was heard on a carrier that was at no time within 3 Hz of `line_hz` in the samples.
    bool heard_apart_from(double line_hz) const;
    /// Takes a line out of the samples from now on.
    void exclude(double line_hz) { conditioner_.exclude(line_hz); }

  private:
    /// A carrier that is followed, and what it brought.
    struct Track {
        Track(const HopLayout& layout, SymbolSequence symbols);
        CarrierTracker tracker;
        std::int64_t first_hop = 0, next_hop = 0;  ///< numbers of hops
        std::deque<HopEvidence> hops;              ///< that have not gone on, from first_hop
        SymbolSequence own;                        ///< on probation
        std::vector<DecidedSymbol> shown;
        std::int64_t began_hop = 0;
        double frequency_hz = 0.0, rate_hzps = 0.0, carrier_n0_hz = 0.0;
        double carrier_power = 0.0;  ///< in the units of the samples
        std::int64_t frequency_hop = 0;
        double lead_s = 0.0;
        double noise_ratio = 1.0;                       ///< of the density beside the carrier to the hops' own
        std::array<float, MfskWaveform::tones> noise;   ///< of each tone, running means
        std::array<float, MfskWaveform::tones> smooth;  ///< medians over the neighbours
        std::vector<float> spectrum;                    ///< around the carrier, running means
        SidebandRatios sideband_ratios;
        int noise_hops = 0;
        bool ended = false;
    };

    SingleReceiver(const MfskWaveform& waveform, double rate_hz, ReceiverInput input);

    SymbolSequence new_sequence(std::int64_t first_hop) const;
    void take_in(std::size_t from);
    double removed_hz(double time_s) const { return input_.predict_hz.at(time_s) + input_.expected_hz.at(time_s); }
    void work(bool last);
    void consider(const CarrierFound& found);
    bool is_known(double frequency_hz, std::int64_t hop, double n0_hz) const;
    void follow(Track& track);
    HopEvidence evidence_of(Track& track, const CarrierHop& hop);
    void learn_noise(Track& track, const CarrierHop& hop, const ToneSums& in_phase);
    void judge();
    void feed(bool last);
    void pass(HopEvidence hop);
    bool passes_main(bool last);
    bool is_taken_up(const Track& missing) const;
    bool passes_without_main(bool last);
    void learn_clock(const HopEvidence& hop);
    void judge_clock();
    void set_clock(double error);
    bool clock_contradicts() const;
    void refine_clock(const DecidedSymbol& symbol);
    void turn(HopEvidence& hop, double lead_s) const;
    void publish(std::vector<DecidedSymbol>& decided);
    void publish_held(bool all);
    void come_out(const DecidedSymbol& symbol, bool contradicted);
    Track* main() { return main_ ? &tracks_[*main_] : nullptr; }
    void drop(std::size_t track);
    bool shows_tones() const;

    MfskWaveform waveform_;
    HopLayout layout_;
    ReceiverInput input_;
    SampleConditioner conditioner_;
    std::optional<DopplerRemover> remover_;
    CarrierSearch carrier_search_;
    ToneCorrelator correlator_;
    int symbol_hops_;
    SymbolSequence sequence_;

    std::vector<std::complex<float>> samples_;  ///< the last seconds
    std::int64_t first_kept_ = 0;               ///< number of the first of them
    std::vector<CarrierFound> found_;
    std::vector<Track> tracks_;
    std::optional<std::size_t> main_;  ///< of tracks_
    std::int64_t fed_ = 0;             ///< hops given to the sequence
    std::int64_t last_tone_hop_ = -1;  ///< the end of the newest tone
    std::int64_t no_earlier_sample_ = std::numeric_limits<std::int64_t>::min();
    struct Silent {
        double frequency_hz;
        std::int64_t until_hop;
    };
    std::vector<Silent> silent_;  ///< carriers without tones, not followed for a while

    double lead_s_ = 0.0, lead_rate_ = 0.0;  ///< of the subcarriers' time at the hop fed_, by Doppler
    double clock_lead_s_ = 0.0;              ///< the same by the clock's error
    std::deque<HopEvidence> recent_;         ///< given to the sequence, for a clock that is found late
    std::int64_t received_ = 0;              ///< hops received
    struct Clock {
        std::vector<ToneSums> sums, turns, steps;  ///< by hypothesis
        double energy = 0.0;
        int hops = 0;
        double error = 0.0, weight = 0.0;
        struct Look {
            std::uint8_t tone;
            double error;
        };
        std::deque<Look> looks;  ///< the newest that showed a tone
    } clock_;
    std::vector<DecidedSymbol> decided_;
    std::deque<DecidedSymbol> held_;  ///< that contradict the clock, which may yet turn out to be wrong
    std::vector<ToneReception> receptions_;
    std::vector<CarrierReport> reports_;
    ReceiverStatus status_;
};

}  // namespace aeolis::telemetry
