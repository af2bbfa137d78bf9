// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "telemetry/link_counters.hpp"
#include "telemetry/proximity_packets.hpp"
#include "telemetry/station/doppler_watch.hpp"
#include "telemetry/station/link_ledger.hpp"
#include "telemetry/station/received.hpp"
#include "telemetry/station/recording_receiver.hpp"
#include "telemetry/station/silence_classifier.hpp"
#include "telemetry/station/tone_station.hpp"

#include <cstdint>
#include <optional>
#include <vector>

namespace aeolis::telemetry {

/// The ground station's decoding: UHF octets to frames and packets, the recording's files to packets, X-band samples to
/// tones.
///
/// Adds ground's reasons to silences.
/// In       the port's deliveries                    Out   packets, tones, states of links; PLTUs for the rover
/// Memory   some kilobytes a link for an incomplete frame; incomplete files of the recording
/// Faults   bad frames are counted, and the next good one is decoded. A damaged length delays the frames behind it by
///          at most quiet_s after the last octet, since a frame leaves the vehicle without a pause
/// A value, like the landing whose links it receives.
class GroundStation {
  public:
    static constexpr double quiet_s = 0.5;  ///< our assumption: at the link's rate an octet arrives each cycle

    explicit GroundStation(double light_time_s) : recording_(light_time_s) {}

    /// Sets the receiver of X-band samples.
    void listen_by(ToneStation tones) { tones_.emplace(std::move(tones)); }
    /// Sets what recognises features of the flight by the carrier's Doppler.
    void watch_by(DopplerWatch doppler) { doppler_.emplace(std::move(doppler)); }
    /// Sets the predictions that explain silences.
    void explain_by(SilenceClassifier silences) { silences_.emplace(std::move(silences)); }

    /// Processes a delivery. The result is valid until the next call, and until then the caller's to move from.
    Received& receive(const Downlink& downlink);
    /// Replaces the links' states in the last result by those with ground's reasons, if it has any.
    /// @param recording_progress  0 … 1, the fraction received
    void explain_silences(double recording_progress);
    const Received& received() const { return received_; }

    /// The receiver of one link.
    struct LinkReceiver {
        Link link;
        PltuReceiver pltus{};
        ProximityPackets packets{};
        RateMeter rate{};
        Ert heard_at{};      ///< time of its last octet
        bool waits = false;  ///< something arrived since the last search to the end
    };
    /// In the order of first reception.
    const std::vector<LinkReceiver>& links() const { return links_; }
    /// Totals of each link so far.
    std::vector<LinkTotals> link_totals(Ert now) const;
    const RecordingReceiver& recording() const { return recording_; }
    std::uint64_t unreadable_file_octets() const {
        return unreadable_file_octets_;
    }  ///< of whole files, behind the last packet

    /// Of the receiver of X-band samples; null before the first ones.
    const ReceiverStatus* tone_status() const { return tones_ && tones_->has_begun() ? &tones_->status() : nullptr; }

    /// PLTUs that the station is to send to the rover now.
    std::vector<std::vector<std::uint8_t>> take_forward() { return recording_.take_pltus(); }

  private:
    LinkReceiver& receiver_of(const Link& link);
    void receive(const ReceivedOctets& piece);
    void receive_frames(LinkReceiver& from, Ert ert);
    void note(const LinkState& state);
    void search_to_the_end(LinkReceiver& link, Ert ert);
    void take_file(std::span<const std::uint8_t> octets, Ert ert);

    std::vector<LinkReceiver> links_;
    RecordingReceiver recording_;
    bool relay_up_ = false;
    std::uint64_t unreadable_file_octets_ = 0;
    std::optional<ToneStation> tones_;
    std::optional<DopplerWatch> doppler_;
    std::optional<SilenceClassifier> silences_;
    Ert now_;
    bool out_ = false;
    Received received_;
};

}  // namespace aeolis::telemetry
