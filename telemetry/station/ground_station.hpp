// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "telemetry/link_counters.hpp"
#include "telemetry/proximity_packets.hpp"
#include "telemetry/station/received.hpp"
#include "telemetry/station/recording_receiver.hpp"
#include "telemetry/station/silence_classifier.hpp"
#include "telemetry/station/tone_station.hpp"

#include <cstdint>
#include <optional>
#include <vector>

namespace aeolis::telemetry {

/// Where what comes down is decoded: octets of each UHF link into frames, those into packets, and the files of the
/// recording into the packets that are in it; samples of X-band into tones. Silences get ground's reasons.
///
/// In       what the port delivers                    Out   packets, tones, states of links; PLTUs for the rover
/// Memory   some kilobytes a link: a frame that is not whole yet; files of the recording that are not
/// Faults   what is no good frame is counted, and the next good one is decoded. A damaged length holds the frames
///          behind it back no longer than quiet_s after the last octet: a frame leaves the vehicle without a pause
/// A value, as the landing is whose links it hears.
class GroundStation {
  public:
    static constexpr double quiet_s = 0.5;  ///< ours: at the link's rate an octet comes each cycle

    explicit GroundStation(double light_time_s) : recording_(light_time_s) {}

    /// X-band comes as samples.
    void listen_by(ToneStation tones) { tones_.emplace(std::move(tones)); }
    /// Silences are explained by what is predicted.
    void explain_by(SilenceClassifier silences) { silences_.emplace(std::move(silences)); }

    /// Stands until the next call.
    const Received& receive(const Downlink& downlink);
    /// Replaces the states of links in what was received last by those with ground's reasons, if it has any.
    /// @param recording_progress  0 … 1 that has come down
    void explain_silences(double recording_progress);
    const Received& received() const { return received_; }

    /// What one link brought.
    struct LinkReceiver {
        Link link;
        PltuReceiver pltus{};
        ProximityPackets packets{};
        RateMeter rate{};
        Ert heard_at{};      ///< its last octet
        bool waits = false;  ///< something came since it was last searched to the end
    };
    /// In the order in which they were first heard.
    const std::vector<LinkReceiver>& links() const { return links_; }
    const RecordingReceiver& recording() const { return recording_; }
    std::uint64_t unreadable_file_octets() const {
        return unreadable_file_octets_;
    }  ///< of whole files, behind the last packet

    /// What the station is to send to the rover now.
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
    std::optional<SilenceClassifier> silences_;
    Ert now_;
    bool out_ = false;
    Received received_;
};

}  // namespace aeolis::telemetry
