// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/archive/packet_columns.hpp"
#include "server/pipeline/pipeline.hpp"
#include "server/pipeline/segment_builder.hpp"
#include "telemetry/alarms.hpp"
#include "telemetry/decommutator.hpp"
#include "telemetry/other_mission.hpp"
#include "telemetry/unit_identity.hpp"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace aeolis::pipeline {

/// Hands out sequence numbers, and notes them in the batch that will make them durable.
class Numbering {
  public:
    /// @param taken  numbers, ascending, of items that are stored already and do not come again
    explicit Numbering(Sequence first = 1, std::vector<Sequence> taken = {}) : next_(first), taken_(std::move(taken)) {
        pass_taken();
    }

    Sequence next(archive::Batch& batch) {
        batch.last_seq = next_++;
        if (batch.first_seq == 0) batch.first_seq = batch.last_seq;
        pass_taken();
        return batch.last_seq;
    }
    Sequence last() const { return next_ - 1; }

  private:
    void pass_taken() {
        for (; passed_ < taken_.size() && taken_[passed_] == next_; ++passed_) ++next_;
    }
    Sequence next_;
    std::vector<Sequence> taken_;
    std::size_t passed_ = 0;
};

/// One run's packets as they come, on either path: what each is, whether it was seen before, and all that it says.
///
/// In       packets in the order of receipt               Out   records, appended to a batch
/// Rules    a unit that came before on the other path is kept (it is the proof) and marked, but its samples are not
///          added again; one that came before on the same path says nothing new at all. Alarms are judged in real
///          time only: the recording tells what was, not what is. Another mission's packets come in real time, each
///          for itself: nothing in them names a unit of ours.
/// Memory   the register of units (telemetry/unit_identity.hpp) and the open segments
class PacketIntake {
  public:
    PacketIntake(const dictionary::Dictionary& dictionary, const archive::PacketColumns& columns,
                 const telemetry::OtherMission* other);

    void take(const telemetry::ReceivedPacket& packet, Numbering& numbering, archive::Batch& batch,
              const Observer& observer);
    void seal(archive::Batch& batch) { segments_.seal(batch); }

    archive::RecordingTotals totals() const;
    const std::vector<std::optional<LatestValue>>& latest() const { return latest_; }
    /// The label of the vehicle's phase, as it was last told in real time by the channel of the phase or by the event
    /// of its change, whichever is the newer on board: the channel comes every two seconds, when none is lost. Empty:
    /// not told.
    const std::string& phase() const { return phase_; }

  private:
    /// Of the packet "TimepointFired", by which ground knows that a timepoint fired.
    struct FiringFields {
        std::size_t packet = 0, timepoint = 0, triggered = 0, fired = 0, verdict = 0;
    };
    static std::optional<FiringFields> find_firing_fields(const dictionary::Dictionary& dictionary);

    /// Into decoded_; why not, or nothing.
    std::optional<std::string> decode(std::span<const std::uint8_t> packet);
    void sample(const archive::UnitRecord& unit, Numbering& numbering, archive::Batch& batch);
    void interpret(const archive::UnitRecord& unit, Numbering& numbering, archive::Batch& batch) const;
    void judge(const archive::UnitRecord& unit, std::span<const double> values, Numbering& numbering,
               archive::Batch& batch);

    void note_phase(const archive::UnitRecord& unit);

    const dictionary::Dictionary& dictionary_;
    const archive::PacketColumns& columns_;
    std::optional<FiringFields> firing_;
    std::vector<std::optional<std::size_t>> phase_field_;  ///< by packet
    std::string phase_;
    Sclk phase_sclk_{};
    const telemetry::OtherMission* other_;  ///< none: our own
    std::optional<telemetry::Decommutator> decommutator_;
    telemetry::Decoded decoded_;
    telemetry::UnitRegister register_;
    telemetry::AlarmMonitor alarms_;
    std::vector<telemetry::AlarmChange> changes_;
    SegmentBuilder segments_;
    std::vector<std::optional<LatestValue>> latest_;
    std::uint64_t recorded_octets_ = 0;
    std::uint64_t not_decoded_ = 0;
    std::uint64_t of_others_ = 0;  ///< packets of another mission
};

}  // namespace aeolis::pipeline
