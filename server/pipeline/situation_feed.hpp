// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"
#include "server/archive/records.hpp"
#include "telemetry/decommutator.hpp"
#include "telemetry/situation_monitor.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

namespace aeolis::pipeline {

/// Gives a run's records to the situation monitor, before they are committed, and returns each new situation.
///
/// In       the batch after each entry, in the order of the items; the time on Earth, once a second of the run
/// Rule     Items that people add are left out: a run flown again has the same situations without them
class SituationFeed {
  public:
    SituationFeed(const dictionary::Dictionary& dictionary, const archive::RunStart& start);

    /// Takes the records that were added to the batch since the last call.
    void follow(const archive::Batch& batch);
    /// The situation at `now`; none while it is the one returned last.
    std::optional<archive::SituationRecord> changed(Ert now);
    /// The same for the last time that was given: at the end of a run. None before the first.
    std::optional<archive::SituationRecord> changed() { return now_ ? changed(*now_) : std::nullopt; }

  private:
    /// Columns of a packet whose channels tell of the touchdown.
    struct TouchdownColumns {
        std::optional<std::size_t> flag, rover_rate, rover_force, live;
    };
    void give_expected(const archive::Batch& batch, const archive::PacketRecord& packet);
    void give_touchdown(const archive::Batch& batch, const archive::SampleRecord& sample);

    telemetry::SituationMonitor monitor_;
    const dictionary::Packet* expects_;  ///< in which ground's own flight expects a timepoint; null: there is none
    std::optional<telemetry::Decommutator> decommutator_;  ///< where there is
    telemetry::Decoded decoded_;
    std::map<std::uint16_t, TouchdownColumns> touchdown_columns_;  ///< by packet; of others there is nothing to tell
    archive::Sequence followed_ = 0;
    std::optional<Ert> now_;
    std::vector<telemetry::SituationEntry> told_;
};

}  // namespace aeolis::pipeline
