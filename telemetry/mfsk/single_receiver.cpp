// SPDX-License-Identifier: Apache-2.0
#include "telemetry/mfsk/single_receiver.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace aeolis::telemetry {
namespace {

constexpr double level_gain = 0.1;        // of each hop in the running mean of C/N0: 1.2 s; chosen
constexpr std::size_t tracks_max = 3;     // chosen
constexpr int missing_hops = 4;           // without the carrier, before another is taken; chosen
constexpr int taken_up_hops = 4;          // found, of a track that takes the carrier up again; chosen
constexpr int taken_up_within = 24;       // hops: later, the carrier may have come back by itself before; chosen
constexpr double taken_up_power = 0.25;   // of the carrier's; chosen
constexpr int wait_hops = 46;             // 5.7 s: the longest search and the tracker's delay
constexpr double kept_s = 6.0;            // of samples
constexpr double same_hz = 60.0;          // nearer than this it is the same carrier; chosen
constexpr double sideband_power = 0.25;   // of the carrier's: a stronger line is no sideband of it; chosen
constexpr double sideband_reach = 3.0;    // of the highest tone; chosen
constexpr int silent_hops = 320;          // 40 s without a tone: not the vehicle's; chosen
constexpr int silent_for_hops = 480;      // chosen
constexpr double silent_hz = 30.0;        // chosen
constexpr double convincing = 15.0;       // log likelihood ratio of a tone that makes a carrier the vehicle's; chosen
constexpr double seen_to_convince = 0.7;  // of that tone; chosen
constexpr int recent_hops = 360;          // 45 s
constexpr int noise_hops = 80;            // of the running mean of the tones' noise: 10 s; chosen
constexpr int noise_hops_least = 8;       // chosen
constexpr int tone_neighbours = 32;       // to either side; chosen
constexpr int tones_a_median = 8;         // tones that share a median; chosen
constexpr float noise_least = 1e-6F;
constexpr double carrier_n0_most_hz = 1e6;       // 60 dB-Hz: with less noise, its mean would not follow it; chosen
constexpr double apart_hz = 3.0;                 // of a line from the carrier: nearer, they are not told apart; chosen
constexpr double sideband_neighbours_hz = 64.0;  // to either side; chosen
constexpr float spilt = 1.5F;                    // of the spectrum's noise: above, it is not noise; chosen
constexpr int between_tones = 3;                 // looks at the clock between the tones: 0.4, 0.5, 0.6 of the spacing
constexpr int clock_aside = 6;                   // hypotheses to either side; chosen
constexpr double clock_step = 100e-6;            // chosen: an eighth of a cycle in 5 s, at the highest tone
constexpr int clock_hops = 40;                   // of each look at the clock: 5 s; chosen
constexpr double clock_energy = 8.0;             // E/N0 of a look, at least; chosen
constexpr double clock_shown = 15.0;             // log likelihood ratio of a look that shows a tone; chosen
constexpr double clock_share = 0.4;              // and of the energy: a look that is full of one tone; chosen
constexpr double clock_same = 50e-6;             // two looks that agree; chosen
constexpr double clock_other = 100e-6;           // a look that contradicts; chosen
constexpr double clock_rebuild = 60e-6;  // an error from which on symbols already seen are decided again; chosen
constexpr std::size_t clock_looks = 16;  // chosen
constexpr double no_clock = 1.0;         // an error that no clock has: the tone lies between the frequencies
constexpr double receiver_turn_rad = 2.0 * std::numbers::pi;

std::complex<float> unit(double cycles) {
    return static_cast<std::complex<float>>(std::polar(1.0, receiver_turn_rad * (cycles - std::floor(cycles))));
}

}  // namespace

Result<SingleReceiver> SingleReceiver::make(const MfskWaveform& waveform, double rate_hz, ReceiverInput input) {
    if (!(rate_hz >= rate_least_hz && rate_hz <= rate_greatest_hz))
        return Error{"a rate of " + std::to_string(rate_hz) + " Hz is outside " + std::to_string(rate_least_hz) +
                     " ... " + std::to_string(rate_greatest_hz) + " Hz"};
    if (2.5 * waveform.highest_tone_hz() > rate_hz)
        return Error{"a rate of " + std::to_string(rate_hz) + " Hz does not hold tones of up to " +
                     std::to_string(waveform.highest_tone_hz()) + " Hz to either side of the carrier"};
    for (const double hz : input.excluded_hz)
        if (!(std::abs(hz) <= 0.5 * rate_hz))
            return Error{"a line at " + std::to_string(hz) + " Hz is not within samples at " + std::to_string(rate_hz) +
                         " Hz"};
    return SingleReceiver{waveform, rate_hz, std::move(input)};
}

SingleReceiver::SingleReceiver(const MfskWaveform& waveform, double rate_hz, ReceiverInput input)
    : waveform_(waveform), layout_(rate_hz), input_(std::move(input)), conditioner_(rate_hz, input_.excluded_hz),
      carrier_search_(rate_hz), correlator_(waveform, layout_.thinned_rate_hz(), layout_.thinned_samples()),
      symbol_hops_(static_cast<int>(std::lround(waveform.symbol_s / layout_.hop_s()))), sequence_(new_sequence(0)) {
    if (!input_.expected_hz.empty()) remover_.emplace(input_.expected_hz, rate_hz, input_.start_s);
    const std::size_t hypotheses = 2 * clock_aside + 1 + between_tones;
    clock_.sums.resize(2 * hypotheses);
    clock_.turns.resize(hypotheses);
    clock_.steps.resize(hypotheses);
    for (std::size_t i = 0; i < hypotheses; ++i)
        for (int tone = 0; tone < MfskWaveform::tones; ++tone) {
            const bool between = i > 2 * clock_aside;
            const double shift_hz =
                between ? (static_cast<double>(i) - 2 * clock_aside + 3) / 10.0 * waveform.tone_spacing_hz
                        : (static_cast<double>(i) - clock_aside) * clock_step * waveform.tone_hz(tone);
            clock_.turns[i][static_cast<std::size_t>(tone)] = 1.0F;
            clock_.steps[i][static_cast<std::size_t>(tone)] = unit(-shift_hz * layout_.hop_s());
        }
}

/// @param first_hop  the hop that it will be given first
SymbolSequence SingleReceiver::new_sequence(std::int64_t first_hop) const {
    std::optional<SymbolSequence::Grid> grid;
    if (input_.symbols_from_s) {
        const double hop_s = layout_.hop_s();
        grid = {(*input_.symbols_from_s - input_.start_s) / hop_s - static_cast<double>(first_hop),
                waveform_.symbol_s / hop_s};
    }
    return SymbolSequence{symbol_hops_, layout_.hop_samples(), grid};
}

SingleReceiver::Track::Track(const HopLayout& layout, SymbolSequence symbols)
    : tracker(layout), own(std::move(symbols)) {
    for (auto* each : {&noise, &smooth, &sideband_ratios}) each->fill(1.0F);
}

void SingleReceiver::push(std::span<const std::complex<float>> samples) {
    const std::size_t before = samples_.size();
    status_.loudest = std::max(status_.loudest, conditioner_.push(samples, samples_));
    take_in(before);
    work(false);
}

/// Removes the expected Doppler from conditioned samples.
void SingleReceiver::take_in(std::size_t from) {
    if (remover_) remover_->remove(std::span{samples_}.subspan(from));
}

void SingleReceiver::finish() {
    const std::size_t before = samples_.size();
    conditioner_.finish(samples_);
    take_in(before);
    work(true);
    sequence_.finish(decided_);
    publish(decided_);
    // A weaker carrier may still have waited for the one that showed no tone.
    const auto waiting = std::ranges::find_if(tracks_, [](const Track& each) { return !each.shown.empty(); });
    if (last_tone_hop_ < 0 && waiting != tracks_.end()) publish(waiting->shown);
    publish_held(true);
}

void SingleReceiver::work(bool last) {
    const std::int64_t hop_samples = layout_.hop_samples();
    while (first_kept_ + std::ssize(samples_) >= (received_ + 1) * hop_samples) {
        const std::span hop = std::span{samples_}.subspan(
            static_cast<std::size_t>(received_ * hop_samples - first_kept_), static_cast<std::size_t>(hop_samples));
        ++received_;
        // With its tones, a carrier in lock is the vehicle's, and no other is looked for.
        found_.clear();
        carrier_search_.push(hop, found_, !is_content());
        for (const CarrierFound& found : found_) consider(found);
        for (Track& track : tracks_) follow(track);
        judge();
        feed(false);
        const auto spare = received_ * hop_samples - first_kept_ - static_cast<std::int64_t>(kept_s * layout_.rate_hz);
        if (spare > static_cast<std::int64_t>(kept_s * layout_.rate_hz)) {
            samples_.erase(samples_.begin(), samples_.begin() + spare);
            first_kept_ += spare;
        }
    }
    if (!last) return;
    for (Track& track : tracks_) {
        std::vector<CarrierHop> hops;
        if (!track.ended) track.tracker.finish(hops);
        track.ended = true;
        for (const CarrierHop& hop : hops) track.hops.push_back(evidence_of(track, hop));
    }
    feed(true);
}

bool SingleReceiver::shows_tones() const {
    return last_tone_hop_ >= 0 && fed_ - last_tone_hop_ < 3 * symbol_hops_;
}

bool SingleReceiver::is_known(double frequency_hz, std::int64_t hop, double n0_hz) const {
    for (const Track& track : tracks_) {
        if (track.ended || track.tracker.missed() >= missing_hops) continue;
        const double since_s = static_cast<double>(hop - track.frequency_hop) * layout_.hop_s();
        const double apart_hz = std::abs(track.frequency_hz + track.rate_hzps * since_s - frequency_hz);
        if (apart_hz < same_hz + 100.0 * std::abs(since_s)) return true;
        if (&track != (main_ ? &tracks_[*main_] : nullptr) || !shows_tones()) continue;
        const bool beside = apart_hz < sideband_reach * waveform_.highest_tone_hz();
        if (beside && n0_hz < sideband_power * track.carrier_n0_hz) return true;
    }
    return !tracks_.empty() && std::ranges::any_of(silent_, [&](const Silent& each) {
        return each.until_hop > received_ && std::abs(each.frequency_hz - frequency_hz) < silent_hz;
    });
}

bool SingleReceiver::is_content() const {
    return main_ && tracks_[*main_].tracker.missed() == 0 && shows_tones();
}

std::optional<double> SingleReceiver::carrier_hz() const {
    if (!main_ || tracks_[*main_].tracker.missed() > 0 || tracks_[*main_].frequency_hz == 0.0) return std::nullopt;
    const double now_s = input_.start_s + static_cast<double>(received_) * layout_.hop_s();
    return tracks_[*main_].frequency_hz + input_.expected_hz.at(now_s);
}

bool SingleReceiver::heard_apart_from(double line_hz) const {
    if (!shows_tones()) return false;
    const std::int64_t hop_samples = layout_.hop_samples();
    int heard = 0;
    for (const HopEvidence& hop : recent_) {
        const std::int64_t number = hop.first_sample / hop_samples;
        if (!hop.found || number < last_tone_hop_ - symbol_hops_ || number >= last_tone_hop_) continue;
        const double mid_s = input_.start_s + (static_cast<double>(number) + 0.5) * layout_.hop_s();
        if (std::abs(hop.frequency_hz + input_.expected_hz.at(mid_s) - line_hz) < apart_hz) return false;
        ++heard;
    }
    return heard >= seen_to_convince * symbol_hops_;
}

void SingleReceiver::consider(const CarrierFound& found) {
    const std::int64_t hop_samples = layout_.hop_samples();
    const double middle = 0.5 * static_cast<double>(found.first_sample + found.last_sample);
    const auto middle_hop = static_cast<std::int64_t>(middle / static_cast<double>(hop_samples));
    if (is_known(found.frequency_hz, middle_hop, found.carrier_n0_hz)) return;
    if (tracks_.size() == tracks_max) {
        const auto longest = std::ranges::find_if(tracks_, [&](const Track& each) {
            return &each != main() && each.shown.empty() && received_ - each.began_hop > 2 * symbol_hops_;
        });
        if (longest == tracks_.end()) return;
        drop(static_cast<std::size_t>(longest - tracks_.begin()));
    }
    const std::int64_t first_hop =
        std::max((std::max(found.first_sample, first_kept_) + hop_samples - 1) / hop_samples, fed_);
    Track track{layout_, new_sequence(first_hop)};
    track.began_hop = track.first_hop = track.next_hop = first_hop;
    const double since_s = (static_cast<double>(track.first_hop * hop_samples) - middle) / layout_.rate_hz;
    track.frequency_hz = found.frequency_hz + found.rate_hzps * since_s;
    track.rate_hzps = found.rate_hzps;
    track.frequency_hop = track.first_hop;
    track.lead_s = lead_s_ + lead_rate_ * static_cast<double>(track.first_hop - fed_) * layout_.hop_s();
    track.tracker.start(track.first_hop * hop_samples, track.frequency_hz, track.rate_hzps);
    tracks_.push_back(std::move(track));
    ++status_.acquisitions;
}

void SingleReceiver::follow(Track& track) {
    const std::int64_t hop_samples = layout_.hop_samples();
    std::vector<CarrierHop> hops;
    while (!track.ended && track.next_hop < received_) {
        const auto at = static_cast<std::size_t>(track.next_hop * hop_samples - first_kept_);
        track.tracker.push(std::span{samples_}.subspan(at, static_cast<std::size_t>(hop_samples)), hops);
        ++track.next_hop;
        track.ended = track.tracker.lost();
    }
    if (track.ended && !track.tracker.genuine()) {  // nothing that it brought is of a carrier
        track.hops.clear();
        track.shown.clear();
        return;
    }
    for (const CarrierHop& hop : hops) {
        track.hops.push_back(evidence_of(track, hop));
        if (&track == main()) continue;
        HopEvidence turned = track.hops.back();
        turn(turned, clock_.error * static_cast<double>(turned.first_sample) / layout_.rate_hz);
        track.own.push(turned, track.shown);
    }
    std::erase_if(track.shown, [](const DecidedSymbol& each) {
        return !each.tone || each.seen_fraction < seen_to_convince || each.evidence.log_likelihood_ratio < convincing;
    });
}

HopEvidence SingleReceiver::evidence_of(Track& track, const CarrierHop& hop) {
    const double begin_s = static_cast<double>(hop.first_sample) / layout_.rate_hz;
    HopEvidence evidence;
    evidence.first_sample = hop.first_sample;
    evidence.lock = hop.lock;
    evidence.gap = hop.gap;
    evidence.frequency_hz = hop.frequency_hz;
    evidence.frequency_deviation_hz = hop.frequency_deviation_hz;
    evidence.rate_hzps = hop.rate_hzps;
    evidence.doppler_hz = removed_hz(input_.start_s + begin_s + 0.5 * layout_.hop_s()) + hop.frequency_hz;
    evidence.lead_s = track.lead_s;
    if (hop.found) {
        correlator_.correlate(hop.quadrature, hop.in_phase, begin_s + track.lead_s, evidence.sums, evidence.in_phase);
        const double present = hop.seen * layout_.thinned_samples();
        for (auto* sums : {&evidence.sums, &evidence.in_phase})
            for (auto& sum : *sums) sum /= static_cast<float>(std::sqrt(present));
        learn_noise(track, hop, evidence.in_phase);
        const double carrier_n0_hz = std::min(hop.carrier_n0_hz / track.noise_ratio, carrier_n0_most_hz);
        const auto least = static_cast<float>(hop.carrier_n0_hz / carrier_n0_most_hz);
        track.carrier_n0_hz = track.carrier_n0_hz == 0.0
                                  ? carrier_n0_hz
                                  : track.carrier_n0_hz + level_gain * (carrier_n0_hz - track.carrier_n0_hz);
        track.carrier_power += level_gain * (hop.carrier_power - track.carrier_power);
        evidence.found = true;
        evidence.total_n0_hz = track.carrier_n0_hz / waveform_.carrier_fraction();
        evidence.fit_n0_hz = carrier_n0_hz / waveform_.carrier_fraction();
        evidence.energy = evidence.total_n0_hz * waveform_.tone_fraction() * layout_.hop_s() * hop.seen;
        const auto energy = static_cast<float>(evidence.energy);
        for (std::size_t tone = 0; tone < evidence.sums.size(); ++tone) {
            const float scale = std::sqrt(energy / std::max(track.smooth[tone], least));
            evidence.sums[tone] *= scale;
            evidence.in_phase[tone] *= scale;
            evidence.sideband_ratios[tone] = track.sideband_ratios[tone];
        }
        track.frequency_hz = hop.frequency_hz;
        track.rate_hzps = hop.rate_hzps;
        track.frequency_hop = hop.first_sample / layout_.hop_samples();
    }
    track.lead_s += evidence.doppler_hz / waveform_.carrier_hz * layout_.hop_s();
    return evidence;
}

/// In phase with the carrier a tone has nothing, so what is there is noise; a line is passed over by the median. What a
/// strong line spills over its neighbours within a hop, and not within a symbol, is seen by the spectrum, which spills
/// less.
void SingleReceiver::learn_noise(Track& track, const CarrierHop& hop, const ToneSums& in_phase) {
    ++track.noise_hops;
    const auto gain = static_cast<float>(1.0 / std::min(track.noise_hops, noise_hops));
    for (std::size_t tone = 0; tone < in_phase.size(); ++tone)
        track.noise[tone] += gain * (std::norm(in_phase[tone]) - track.noise[tone]);
    track.spectrum.resize(hop.spectrum.size());
    for (std::size_t i = 0; i < hop.spectrum.size(); ++i)
        track.spectrum[i] += gain * (hop.spectrum[i] - track.spectrum[i]);
    if (track.noise_hops < noise_hops_least || track.noise_hops % noise_hops_least != 0) return;
    const float median_of_mean = 1.0F - 1.0F / (3.0F * static_cast<float>(std::min(track.noise_hops, 2 * noise_hops)));
    std::vector<float> near;
    const auto middle = [&] {
        const auto at = near.begin() + std::ssize(near) / 2;
        std::ranges::nth_element(near, at);
        return std::max(*at / median_of_mean, noise_least);
    };
    const auto least = static_cast<float>(hop.carrier_n0_hz / carrier_n0_most_hz);
    const double bin_hz = layout_.thinned_rate_hz() / static_cast<double>(track.spectrum.size());
    const auto sideband = [&](double sign, double tone_hz) {
        near.clear();
        const auto bins = static_cast<int>(track.spectrum.size());
        const auto from = static_cast<int>((tone_hz - sideband_neighbours_hz) / bin_hz);
        const auto to = static_cast<int>((tone_hz + sideband_neighbours_hz) / bin_hz);
        for (int bin = std::max(from, 1); bin <= std::min(to, bins / 2 - 1); ++bin)
            near.push_back(track.spectrum[static_cast<std::size_t>(sign > 0.0 ? bin : bins - bin)]);
        return near.empty() ? 1.0F : std::max(middle(), least);
    };
    for (int tone = 0; tone < MfskWaveform::tones; tone += tones_a_median) {
        const int at = tone + tones_a_median / 2;
        near.assign(track.noise.begin() + std::max(at - tone_neighbours, 0),
                    track.noise.begin() + std::min(at + tone_neighbours, MfskWaveform::tones));
        const float noise = middle();
        const float upper = sideband(1.0, waveform_.tone_hz(at)), lower = sideband(-1.0, waveform_.tone_hz(at));
        const float both = 0.5F * (upper + lower);
        for (int i = tone; i < tone + tones_a_median; ++i) {
            track.smooth[static_cast<std::size_t>(i)] = noise > spilt * both ? both : noise;
            track.sideband_ratios[static_cast<std::size_t>(i)] = upper / lower;
        }
    }
    near.assign(track.smooth.begin(), track.smooth.end());
    const auto at = near.begin() + std::ssize(near) / 2;
    std::ranges::nth_element(near, at);
    track.noise_ratio = *at;
}

void SingleReceiver::drop(std::size_t track) {
    tracks_.erase(tracks_.begin() + static_cast<std::ptrdiff_t>(track));
    if (main_ && *main_ == track)
        main_.reset();
    else if (main_ && *main_ > track)
        --*main_;
}

/// Whether another carrier is the vehicle's, and which need not be followed any longer.
void SingleReceiver::judge() {
    for (std::size_t i = 0; i < tracks_.size(); ++i) {
        Track& track = tracks_[i];
        if (main_ == i || track.shown.empty()) continue;
        const DecidedSymbol& shown = track.shown.back();
        const std::int64_t began = shown.first_sample / layout_.hop_samples();
        if (track.ended || last_tone_hop_ > began - 2 * symbol_hops_) continue;
        // Lines of the vehicle's own signal may seem to show tones, too. A stronger carrier has time to show its own.
        const bool is_weak = main() != nullptr && main()->tracker.missed() == 0 &&
                             track.carrier_power < sideband_power * main()->carrier_power;
        const std::int64_t waited = fed_ - track.shown.front().first_sample / layout_.hop_samples();
        if (is_weak && waited < 3 * symbol_hops_) continue;
        // What it has shown since it is followed comes out, and the rest follows.
        main_ = i;
        sequence_ = std::move(track.own);
        track.own = new_sequence(fed_);
        recent_.clear();
        fed_ = track.first_hop + std::ssize(track.hops);
        clock_lead_s_ = clock_.error * static_cast<double>(fed_ * layout_.hop_samples()) / layout_.rate_hz;
        track.first_hop = fed_;
        track.hops.clear();
        publish(track.shown);
        break;
    }
    for (std::size_t i = tracks_.size(); i-- > 0;) {
        const Track& track = tracks_[i];
        if (main_ == i) continue;
        const bool silent = track.shown.empty() && received_ - track.began_hop > silent_hops && main() != nullptr &&
                            main()->tracker.missed() == 0;
        const bool is_over = track.ended && track.first_hop + std::ssize(track.hops) <= fed_;
        if (silent) silent_.push_back({track.frequency_hz, received_ + silent_for_hops});
        if (silent || is_over) drop(i);
    }
    std::erase_if(silent_, [&](const Silent& each) { return each.until_hop <= received_; });
}

void SingleReceiver::feed(bool last) {
    while (fed_ < received_) {
        for (Track& track : tracks_)
            while (!track.hops.empty() && track.first_hop < fed_) {
                track.hops.pop_front();
                ++track.first_hop;
            }
        if (!(main_ ? passes_main(last) : passes_without_main(last))) return;
    }
}

/// Passes the next hop of the main carrier on, or takes another; false: it waits.
bool SingleReceiver::passes_main(bool last) {
    Track& track = *main();
    if (fed_ < track.first_hop || track.hops.empty()) {
        if (track.ended) {
            drop(*main_);
            return true;
        }
        if (fed_ >= track.first_hop) return false;
        HopEvidence none;
        none.first_sample = fed_ * layout_.hop_samples();
        pass(none);
        return true;
    }
    const HopEvidence& hop = track.hops.front();
    const bool found_later = std::ranges::any_of(track.hops, &HopEvidence::found);
    if (!hop.found && !found_later) {
        if (track.ended || track.tracker.missed() >= missing_hops) {
            for (std::size_t i = 0; i < tracks_.size(); ++i)
                if (i != *main_ && !tracks_[i].hops.empty() && tracks_[i].hops.front().found &&
                    tracks_[i].first_hop <= fed_) {
                    const std::size_t before = *main_;
                    main_ = i;
                    drop(before);
                    return true;
                }
        }
        if (!last && received_ - fed_ < wait_hops && !is_taken_up(track)) return false;
    }
    HopEvidence copy = hop;
    track.hops.pop_front();
    ++track.first_hop;
    pass(copy);
    return true;
}

/// Whether another track has taken up the carrier that `missing` no longer finds, so that it need not be waited for.
bool SingleReceiver::is_taken_up(const Track& missing) const {
    if (!missing.ended && missing.tracker.missed() < missing_hops) return false;
    return std::ranges::any_of(tracks_, [&](const Track& other) {
        return &other != &missing && other.first_hop <= fed_ + taken_up_within &&
               other.carrier_n0_hz >= taken_up_power * missing.carrier_n0_hz &&
               std::ranges::count_if(other.hops, &HopEvidence::found) >= taken_up_hops;
    });
}

bool SingleReceiver::passes_without_main(bool last) {
    bool is_awaited = false;
    std::optional<std::size_t> best;
    for (std::size_t i = 0; i < tracks_.size(); ++i) {
        const Track& track = tracks_[i];
        if (track.first_hop > fed_) continue;
        is_awaited = is_awaited || (track.hops.empty() && !track.ended);
        if (track.hops.empty() || !track.hops.front().found) continue;
        if (!best || track.carrier_n0_hz > tracks_[*best].carrier_n0_hz) best = i;
    }
    if (best) {
        main_ = best;
        return true;
    }
    const bool begins_later = std::ranges::any_of(tracks_, [&](const Track& other) {
        return other.first_hop > fed_ && std::ranges::count_if(other.hops, &HopEvidence::found) >= taken_up_hops;
    });
    if (!last && (is_awaited || (received_ - fed_ < wait_hops && !begins_later))) return false;
    HopEvidence none;
    none.first_sample = fed_ * layout_.hop_samples();
    pass(none);
    return true;
}

void SingleReceiver::pass(HopEvidence hop) {
    const double begin_s = static_cast<double>(hop.first_sample) / layout_.rate_hz, hop_s = layout_.hop_s();
    const bool searching = hop.lock == CarrierLock::searching;
    if (searching) hop.doppler_hz = removed_hz(input_.start_s + begin_s + 0.5 * hop_s);
    if (!searching) lead_s_ = hop.lead_s;
    lead_rate_ = hop.doppler_hz / waveform_.carrier_hz;
    lead_s_ += lead_rate_ * hop_s;
    if (hop.found) status_.total_c_n0_dbhz = 10.0 * std::log10(std::max(hop.total_n0_hz, 1e-9));
    status_.lock = hop.lock;
    status_.doppler_hz = hop.doppler_hz;
    (hop.found ? status_.carrier_s : status_.without_s) += hop_s;
    if (hop.gap) status_.gap_s += hop_s;
    CarrierReport report{input_.start_s + begin_s + 0.5 * hop_s,
                         hop.lock,
                         hop.frequency_hz,
                         hop.frequency_deviation_hz,
                         hop.rate_hzps,
                         std::numeric_limits<double>::quiet_NaN(),
                         std::numeric_limits<double>::quiet_NaN()};
    if (hop.found) {
        report.total_c_n0_dbhz = status_.total_c_n0_dbhz;
        report.fit_c_n0_dbhz = 10.0 * std::log10(std::max(hop.fit_n0_hz, 1e-9));
    }
    reports_.push_back(report);
    recent_.push_back(hop);
    if (std::ssize(recent_) > recent_hops) recent_.pop_front();
    ++fed_;
    learn_clock(hop);
    if (hop.found) turn(hop, clock_lead_s_);
    clock_lead_s_ += clock_.error * hop_s;
    sequence_.push(hop, decided_);
    publish(decided_);
}

/// Turns a hop's sums to the tones' time, which leads by `lead_s`.
void SingleReceiver::turn(HopEvidence& hop, double lead_s) const {
    if (lead_s == 0.0 || !hop.found) return;
    for (int tone = 0; tone < MfskWaveform::tones; ++tone) {
        const std::complex<float> by = unit(-lead_s * waveform_.tone_hz(tone));
        hop.sums[static_cast<std::size_t>(tone)] *= by;
        hop.in_phase[static_cast<std::size_t>(tone)] *= by;
    }
}

/// Sums the tones under several errors of the clock, in looks of 5 s.
void SingleReceiver::learn_clock(const HopEvidence& hop) {
    const std::size_t hypotheses = clock_.turns.size();
    for (std::size_t i = 0; i < hypotheses; ++i)
        for (std::size_t tone = 0; tone < hop.sums.size(); ++tone) {
            const auto by = clock_.turns[i][tone], step = clock_.steps[i][tone];
            if (hop.found) {
                clock_.sums[i][tone] += by * hop.sums[tone];
                clock_.sums[hypotheses + i][tone] += by * hop.in_phase[tone];
            }
            clock_.turns[i][tone] = by * step;
        }
    clock_.energy += hop.energy;
    if (++clock_.hops < clock_hops) return;
    if (clock_.energy >= clock_energy) {
        std::vector<ToneEvidence> looks;
        looks.reserve(hypotheses);
        for (std::size_t i = 0; i < hypotheses; ++i)
            looks.push_back(
                tone_evidence_of(clock_.sums[i], clock_.sums[hypotheses + i], hop.sideband_ratios, clock_.energy));
        const auto best = static_cast<std::size_t>(
            std::ranges::max_element(looks, {}, &ToneEvidence::log_likelihood_ratio) - looks.begin());
        const std::uint8_t tone = looks[best].best[0].tone;
        if (looks[best].log_likelihood_ratio > std::max(clock_shown, clock_share * clock_.energy)) {
            const auto at = [&](std::size_t i) { return static_cast<double>(std::abs(clock_.sums[i][tone])); };
            const bool between = best > 2 * clock_aside, inside = best > 0 && best < 2 * clock_aside;
            const double steps = static_cast<double>(best) - clock_aside +
                                 (inside ? peak_offset(at(best - 1), at(best), at(best + 1)) : 0.0);
            clock_.looks.push_back({tone, between ? no_clock : steps * clock_step});
            if (clock_.looks.size() > clock_looks) clock_.looks.pop_front();
            if (!between) judge_clock();
        }
    }
    for (auto& sums : clock_.sums) sums = {};
    for (auto& turns : clock_.turns) turns.fill(1.0F);
    clock_.energy = 0.0;
    clock_.hops = 0;
}

/// An error of the clock is believed when tones agree on it: of a wrong rate each tone shows another.
void SingleReceiver::judge_clock() {
    const Clock::Look& newest = clock_.looks.back();
    if (std::abs(newest.error - clock_.error) < clock_rebuild) return;
    double sum = 0.0;
    int agreeing = 0;
    std::vector<std::uint8_t> tones;
    for (const Clock::Look& look : clock_.looks) {
        if (std::abs(look.error - newest.error) > clock_same) continue;
        sum += look.error;
        ++agreeing;
        if (std::ranges::find(tones, look.tone) == tones.end()) tones.push_back(look.tone);
    }
    const bool enough = tones.size() >= 3 || (tones.size() == 2 && agreeing >= 6);
    if (enough && 4 * agreeing >= 3 * std::ssize(clock_.looks)) set_clock(sum / agreeing);
}

/// Whether most looks show tones where the clock does not put them: the rate is wrong.
bool SingleReceiver::clock_contradicts() const {
    const auto other = std::ranges::count_if(
        clock_.looks, [&](const Clock::Look& look) { return std::abs(look.error - clock_.error) > clock_other; });
    return 2 * other > std::ssize(clock_.looks);
}

/// From now on, and for what was received lately, tones are sought at their frequencies by the clock.
void SingleReceiver::set_clock(double error) {
    clock_.error = error;
    clock_.weight = 1.0;
    held_.clear();
    status_.clock_error_ppm = -1e6 * error;
    sequence_ = new_sequence(recent_.front().first_sample / layout_.hop_samples());
    clock_lead_s_ = 0.0;
    // The newest hop goes to the sequence after this.
    for (std::size_t i = 0; i + 1 < recent_.size(); ++i) {
        HopEvidence hop = recent_[i];
        turn(hop, clock_lead_s_);
        clock_lead_s_ += error * layout_.hop_s();
        sequence_.push(hop, decided_);
    }
}

/// The phase from a symbol's first half to its second shows what is left of the clock's error.
void SingleReceiver::refine_clock(const DecidedSymbol& symbol) {
    if (!symbol.tone || symbol.seen_fraction < 0.9 || symbol.evidence.log_likelihood_ratio < convincing) return;
    std::array<std::complex<double>, 2> halves{};
    const std::int64_t hop_samples = layout_.hop_samples();
    const double tone_hz = waveform_.tone_hz(*symbol.tone);
    for (const HopEvidence& hop : recent_) {
        const std::int64_t within = (hop.first_sample - symbol.first_sample) / hop_samples;
        if (hop.first_sample < symbol.first_sample || within >= symbol_hops_ || !hop.found) continue;
        const double since_s = static_cast<double>(hop.first_sample - symbol.first_sample) / layout_.rate_hz;
        halves[2 * within < symbol_hops_ ? 0 : 1] +=
            std::complex<double>{hop.sums[*symbol.tone] * unit(-clock_.error * tone_hz * since_s)};
    }
    if (halves[0] == 0.0 || halves[1] == 0.0) return;
    const double cycles = std::arg(halves[1] * std::conj(halves[0])) / receiver_turn_rad;
    const double error = cycles / (0.5 * waveform_.symbol_s * tone_hz);
    clock_.weight = std::min(clock_.weight + 1.0, 10.0);
    clock_.error += error / clock_.weight;
    status_.clock_error_ppm = -1e6 * clock_.error;
}

/// What contradicts the clock waits until the clock is known, or too long ago to be decided again.
void SingleReceiver::publish(std::vector<DecidedSymbol>& decided) {
    for (const DecidedSymbol& symbol : decided) {
        if (symbol.first_sample < no_earlier_sample_) continue;
        if (clock_contradicts()) {
            held_.push_back(symbol);
            continue;
        }
        publish_held(true);
        come_out(symbol, false);
    }
    publish_held(false);
    decided.clear();
}

void SingleReceiver::publish_held(bool all) {
    const std::int64_t oldest = recent_.empty() ? 0 : recent_.front().first_sample;
    while (!held_.empty() && (all || held_.front().first_sample < oldest)) {
        if (held_.front().first_sample >= no_earlier_sample_) come_out(held_.front(), true);
        held_.pop_front();
    }
}

void SingleReceiver::come_out(const DecidedSymbol& symbol, bool contradicted) {
    const std::int64_t symbol_samples = symbol_hops_ * layout_.hop_samples();
    no_earlier_sample_ = symbol.first_sample + symbol_samples - symbol_samples / 10;
    if (symbol.tone && contradicted) ++status_.contradicted;
    if (!contradicted) refine_clock(symbol);
    receptions_.push_back({contradicted ? std::nullopt : symbol.tone,
                           input_.start_s + static_cast<double>(symbol.first_sample) / layout_.rate_hz,
                           symbol.total_c_n0_dbhz, symbol.doppler_hz, symbol.lock, symbol.seen_fraction,
                           symbol.evidence});
    if (symbol.tone && !contradicted) last_tone_hop_ = symbol.first_sample / layout_.hop_samples() + symbol_hops_;
}

std::vector<ToneReception> SingleReceiver::take() {
    return std::exchange(receptions_, {});
}

std::vector<CarrierReport> SingleReceiver::take_carrier() {
    return std::exchange(reports_, {});
}

}  // namespace aeolis::telemetry
