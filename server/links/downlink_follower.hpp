// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/run.pb.h"
#include "server/base/clock_watch.hpp"
#include "server/links/downlink_socket.hpp"
#include "server/links/frame_format.hpp"
#include "server/pipeline/pipeline_thread.hpp"
#include "telemetry/link_rhythm.hpp"
#include "telemetry/station/foreign_station.hpp"
#include "telemetry/station/silence_classifier.hpp"

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

namespace aeolis::server {

/// Follows another mission in its own thread: receives octets, has a station find the packets in them, hands both to
/// the archive as one run.
///
/// In       octets of a TCP connection or of datagrams       Out   deliveries to the pipeline, the octets as they came
///          among them; run states on change
/// TCP      connects, and reconnects after every end: first after `retry_first`, then doubling up to `retry_max`
/// UDP      bare packets, and frames without markers: each datagram holds whole ones. CADUs and PLTUs: datagrams are
///          pieces of one stream
/// Counts   totals of the link and of its sequences once a second, over all connections; what went wrong is logged at
///          most every ten seconds, as numbers by kind
/// Faults   octets that are not packets are counted and skipped. When bare packets cannot be found any more, it
///          reconnects. Each change is logged and is an item of the run
/// Silence  the link is up once packets come. It is lost when the connection breaks, and when packets stay out longer
///          than it has learnt that they do (telemetry/link_rhythm.hpp)
/// Times    Earth received times go on with the monotonic clock when the system's clock jumps (EarthClock)
/// Memory   a piece of `piece_octets`, and the station's. A slow disk blocks the thread and so the TCP sender;
///          datagrams that arrive meanwhile may be lost, as UDP permits
class DownlinkFollower {
  public:
    static constexpr std::size_t piece_octets = 65536;  ///< the largest datagram

    struct Settings {
        DownlinkAddress address;
        PacketStreamFormat format;
        std::string xtce;  ///< name of the XTCE file
        std::chrono::milliseconds retry_first{250}, retry_max{30'000};
        ReadClocks clocks = read_clocks;
    };
    using OnState = std::function<void(v1::RunState)>;  ///< called on the follower's thread
    using OnClock = std::function<void(v1::Clocks)>;    ///< likewise, about once a second: the time on Earth

    /// Begins the run. Fails on an unknown format, when the datagrams' address cannot be bound, or when the archive
    /// refuses. The pipeline, which reads that mission's packets, must outlive this.
    static Result<std::unique_ptr<DownlinkFollower>> start(Settings settings, PipelineThread& pipeline,
                                                           OnState on_state, OnClock on_clock);
    ~DownlinkFollower();  ///< ends the run

    std::uint16_t port() const { return port_; }  ///< of the bound UDP socket
    archive::RunId run() const { return run_; }
    Ert now() const { return clock_.now(); }  ///< the time on Earth of its run; from any thread

  private:
    DownlinkFollower(Settings settings, PipelineThread& pipeline, OnState on_state, OnClock on_clock);
    void follow();
    bool connect_again();
    void receive_until_end();
    void take(std::span<const std::uint8_t> octets);
    void end_of_stream();
    void pass();
    void tell_totals(Ert now, bool last);
    void tell_layout();
    void deliver(telemetry::Received& received, Ert ert);
    void say(telemetry::LinkState state);
    void waits(const std::string& how);
    void lost(telemetry::SilenceClass silence, const std::string& why);
    v1::RunState state(v1::RunState::State phase) const;

    Settings settings_;
    PipelineThread& pipeline_;
    OnState on_state_;
    OnClock on_clock_;
    EarthClock clock_;
    DownlinkSocket socket_;
    std::uint16_t port_ = 0;
    archive::RunId run_;
    archive::RunStart start_;
    telemetry::ForeignStation station_;
    std::optional<Ert> faults_logged_;
    std::string said_;  ///< the last message, so that a lasting fault is reported once
    std::uint64_t packets_ = 0;
    telemetry::LinkRhythm rhythm_;
    bool up_ = false;                 ///< packets come
    Ert passed_;                      ///< the time on Earth delivered last
    std::chrono::milliseconds wait_;  ///< before the next attempt to connect; reset once packets arrive
    bool stop_ = false, out_of_step_ = false;
    std::thread thread_;
};

}  // namespace aeolis::server
