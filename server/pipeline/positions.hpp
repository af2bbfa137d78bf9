// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/positions.pb.h"
#include "common/result.hpp"
#include "server/archive/records.hpp"
#include "server/procedures/position_board.hpp"

#include <mutex>
#include <optional>
#include <span>
#include <string_view>

namespace aeolis::pipeline {

/// The positions of the run that goes on, for whoever asks whether a person may act now.
///
/// In       acts, by the thread that writes the archive
/// Out      records to be stored; answers to any thread, by the acts taken so far. Without a run everything is allowed
/// Memory   acts_max acts of a run are taken, and after them the flight director's
class Positions {
  public:
    static constexpr std::size_t acts_max = 10'000;  ///< in a run; chosen: as of procedures

    /// A run begins with all positions vacant, or ends.
    void begin();
    void end();
    /// Takes acts again as they were kept. The Error names the first that is refused now.
    Result<void> repeat(std::span<const archive::PositionActRecord> acts);
    /// Takes an act. @return the record with the board behind it. The Error: it has no place now, in a sentence.
    Result<archive::PositionActRecord> act(archive::PositionActRecord act);

    /// As PositionBoard's.
    Result<void> may_act(std::string_view position, std::string_view person) const;
    Result<void> may_send(std::string_view person) const;
    Result<void> may_approve(std::string_view person) const;
    Result<void> may_stop(std::string_view person) const;

  private:
    Result<void> take(const archive::PositionActRecord& record);

    mutable std::mutex mutex_;
    std::optional<server::procedures::PositionBoard> board_;  ///< none: no run goes on
    std::size_t acts_ = 0;
};

/// The board as the schema has it.
v1::PositionBoard board_of(const server::procedures::PositionBoard& board);

}  // namespace aeolis::pipeline
