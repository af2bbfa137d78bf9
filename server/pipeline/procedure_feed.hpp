// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"
#include "server/archive/packet_columns.hpp"
#include "server/archive/records.hpp"
#include "server/pipeline/pipeline.hpp"
#include "server/procedures/procedure_board.hpp"

#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

namespace aeolis::pipeline {

/// Carries out the procedures of a run: what is received and what people do goes in, the statuses that change come out.
///
/// In       the batch after each entry, as SituationFeed; acts; the time on Earth, once a second of the run
/// Out      a status behind each act, and at most one a second of each procedure: when a state or verdict changed, or
///          every evidence_every_s when only evidence did
/// Rule     All follows from the run's items and acts, and the acts' places among them: a run flown again with the same
///          acts has the same statuses
/// Cost     before a procedure is begun, and when all are over, only events are noted
class ProcedureFeed {
  public:
    static constexpr std::size_t acts_max = 10'000;   ///< in a run; chosen: twenty for each procedure that there may be
    static constexpr double evidence_every_s = 10.0;  ///< chosen: a landing has some 200 statuses of a procedure then

    /// Dictionary and columns must outlive this object.
    ProcedureFeed(const dictionary::Dictionary& dictionary, const archive::PacketColumns& columns,
                  const archive::RunStart& start);

    /// Takes the records that were added to the batch since the last call, of one packet at most. What is older than
    /// `latest`, the newest value of its channel, came late and counts for nothing.
    void follow(const archive::Batch& batch, const std::vector<std::optional<LatestValue>>& latest);
    /// @return the statuses that are to be told at `now`
    std::vector<archive::ProcedureStatusRecord> pass(Ert now);
    /// The same for the last time that was given: at the end of a run.
    std::vector<archive::ProcedureStatusRecord> pass();

    /// The time of an act, moved to within a second of the run's newest, which its clock may have left behind.
    Ert moved(Ert at) const;
    struct Acted {
        archive::ProcedureActRecord act;  ///< with its procedure's id; of `begin` with its number
        archive::ProcedureStatusRecord status;
    };
    /// Takes an act, at its time as moved().
    /// @param latest  the newest value of each channel; for a procedure that begins
    /// The Error: the act has no place now, in a sentence; nothing has changed.
    Result<Acted> act(archive::ProcedureActRecord act, const std::vector<std::optional<LatestValue>>& latest);
    /// Takes an act again, as it was kept.
    Result<archive::ProcedureStatusRecord> repeat(const archive::ProcedureActRecord& act,
                                                  const std::vector<std::optional<LatestValue>>& latest);

  private:
    /// What was told last of a procedure.
    struct Told {
        std::string procedure, begun_by;
        std::vector<server::procedures::StepStatus> steps;
        std::vector<server::procedures::WatchdogStatus> watchdogs;
        std::string held;
        server::procedures::Part part{};
        Ert at;
        bool over = false;
    };
    Result<std::uint32_t> begin(const archive::ProcedureActRecord& act,
                                const std::vector<std::optional<LatestValue>>& latest);
    Result<void> take(const archive::ProcedureActRecord& act);
    bool is_due(const server::procedures::Execution& execution, const Told& told, Ert now) const;
    archive::ProcedureStatusRecord tell(std::uint32_t number, Ert now);

    const dictionary::Dictionary& dictionary_;
    const archive::PacketColumns& columns_;
    server::procedures::ProcedureBoard board_;
    std::optional<server::procedures::EntryPrediction> prediction_;
    std::unordered_map<EvrId, Ert> events_;  ///< by event: its last receipt
    std::vector<Told> told_;                 ///< by number less one
    std::size_t acts_ = 0;
    std::size_t under_way_ = 0;  ///< procedures whose end was not told
    archive::Sequence followed_ = 0;
    std::optional<Ert> now_;     ///< the time on Earth that was given last
    std::optional<Ert> newest_;  ///< or of a packet since
};

}  // namespace aeolis::pipeline
