// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/archive/packet_columns.hpp"
#include "server/pipeline/pipeline.hpp"
#include "server/pipeline/segment_builder.hpp"
#include "telemetry/alarms.hpp"
#include "telemetry/decoded_packet.hpp"
#include "telemetry/other_mission.hpp"
#include "telemetry/packet_clocks.hpp"
#include "telemetry/packet_identity.hpp"

#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace aeolis::pipeline {

/// Assigns sequence numbers and notes them in the batch that will make them durable.
class Numbering {
  public:
    /// Which number comes last: that of the last item given out, or of items behind it that are stored already.
    enum class Last : std::uint8_t { given, stored };
    /// @param taken  numbers, ascending, of stored items that are not produced again
    explicit Numbering(Sequence first = 1, std::vector<Sequence> taken = {}, Last last = Last::stored)
        : next_(first), taken_(std::move(taken)), last_(last) {
        if (last_ == Last::stored) pass_taken();
    }

    Sequence next(archive::Batch& batch) {
        pass_taken();
        batch.last_seq = next_++;
        if (batch.first_seq == 0) batch.first_seq = batch.last_seq;
        if (last_ == Last::stored) pass_taken();
        return batch.last_seq;
    }
    Sequence last() const { return next_ - 1; }
    /// Whether all numbers before this one were given out, or are those of stored items.
    bool has_come_to(Sequence seq) const {
        Sequence next = next_;
        for (std::size_t i = passed_; i < taken_.size() && taken_[i] == next; ++i) ++next;
        return seq < next;
    }
    /// Passes the numbers of stored items up to this one, to which it must have come.
    void pass(Sequence seq) {
        for (; next_ <= seq && passed_ < taken_.size() && taken_[passed_] == next_; ++passed_) ++next_;
    }
    /// From here on all numbers are free.
    void forget_taken() { taken_.clear(), passed_ = 0; }

  private:
    void pass_taken() {
        for (; passed_ < taken_.size() && taken_[passed_] == next_; ++passed_) ++next_;
    }
    Sequence next_;
    std::vector<Sequence> taken_;
    std::size_t passed_ = 0;
    Last last_;
};

/// Takes one run's packets, on either path: identifies each, whether it was seen before, and derives everything from
/// it. Decodes those that nobody has decoded before.
///
/// In       packets in the order of receipt               Out   records, appended to a batch
/// Time     another mission's packet without a time of its own stands at its reception (telemetry/packet_clocks.hpp)
/// Partly   another mission's packet that is not decoded to its end is sampled as far as it is. It counts as not
///          decoded, with the reason, and the first of each kind is reported
/// Newest   of real time: ours by its clock, which never goes back; another mission's by reception, because its clocks
///          may restart and stand still
/// Rules    a packet seen before on the other path is stored (it is the proof) and marked, but its samples are not
///          added again. A packet seen before on the same path yields nothing new. Alarms are judged in real time only:
///          the recording tells the past. Another mission's packets count as real time and are never compared: nothing
///          in them identifies a packet of ours. The station's own packets are not compared either
/// Memory   the register of packets (telemetry/packet_identity.hpp) and the open segments
class PacketIntake {
  public:
    PacketIntake(const dictionary::Dictionary& dictionary, const archive::PacketColumns& columns,
                 const telemetry::OtherMission* other);

    void take(const telemetry::ReceivedPacket& packet, Numbering& numbering, archive::Batch& batch);
    void seal(archive::Batch& batch) { segments_.seal(batch); }

    archive::RecordingTotals totals() const;
    /// The newest value of each channel in real time.
    const std::vector<std::optional<LatestValue>>& latest() const { return latest_; }
    /// Message about the last packet's clock or decoding; empty: none.
    const std::string& remark() const { return remark_; }
    /// The label of the vehicle's phase as last reported in real time; empty: not reported. Reported by the phase
    /// channel or by the event of its change, whichever is newer on board: the channel is sent every two seconds and
    /// may be lost.
    const std::string& phase() const { return phase_; }

  private:
    /// Fields of the packet "TimepointFired", which reports to ground that a timepoint fired.
    struct FiringFields {
        std::size_t packet = 0, timepoint = 0, triggered = 0, fired = 0, verdict = 0;
    };
    static std::optional<FiringFields> find_firing_fields(const dictionary::Dictionary& dictionary);

    /// The packet's content, decoded here unless it was before. Valid until the next call.
    const telemetry::DecodedPacket& decoded(const telemetry::ReceivedPacket& packet);
    void sample(const archive::PacketRecord& record, const telemetry::Decoded& content, Numbering& numbering,
                archive::Batch& batch);
    void interpret(const archive::PacketRecord& record, const telemetry::DecodedPacket& decoded, Numbering& numbering,
                   archive::Batch& batch) const;
    void judge(const archive::PacketRecord& record, std::span<const double> values, Numbering& numbering,
               archive::Batch& batch);

    void note_phase(const archive::PacketRecord& record, const telemetry::Decoded& content);
    void tell_once(const std::string& words);

    const dictionary::Dictionary& dictionary_;
    const archive::PacketColumns& columns_;
    std::optional<FiringFields> firing_;
    std::vector<std::optional<std::size_t>> phase_field_;  ///< by packet
    std::string phase_;
    Sclk phase_sclk_{};
    const telemetry::OtherMission* other_;  ///< null: our own mission
    telemetry::PacketDecoder decoder_;
    telemetry::DecodedPacket decoded_;  ///< of the packet decoded here last
    telemetry::PacketRegister register_;
    telemetry::AlarmMonitor alarms_;
    std::vector<telemetry::AlarmChange> changes_;
    SegmentBuilder segments_;
    std::vector<std::optional<LatestValue>> latest_;
    telemetry::PacketClocks clocks_;  ///< of another mission's packets
    std::string remark_;
    static constexpr std::size_t told_max = 20;  ///< chosen: kinds that are reported; all are counted
    std::set<std::string> told_;                 ///< kinds of packets that were not decoded whole
    std::uint64_t recorded_octets_ = 0;
    std::uint64_t not_decoded_ = 0;
    std::uint64_t of_others_ = 0;  ///< packets of another mission
};

}  // namespace aeolis::pipeline
