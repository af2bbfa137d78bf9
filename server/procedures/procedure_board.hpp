// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "server/procedures/execution.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace aeolis::server::procedures {

inline constexpr std::size_t under_way_max = 16;  ///< at once; chosen: two for each position
inline constexpr std::size_t begun_max = 500;     ///< in a run; chosen: bounds what is kept of those that are over

/// All procedures of a run: several under way at once, and those that are over as they ended.
///
/// In      as Execution; each fact goes to every procedure under way, and is known to those begun later
/// Out     executions, by the number that each gets when it begins, from 1
/// Memory  by the limits above
class ProcedureBoard {
  public:
    /// The dictionary must outlive this object.
    explicit ProcedureBoard(const dictionary::Dictionary& dictionary) : dictionary_(&dictionary) {}

    /// Takes what the run has received so far, for the procedures begun from here on.
    void know(ReceivedFacts facts) { facts_ = std::move(facts); }
    /// Begins a procedure; the same may be under way more than once. @return its number
    Result<std::uint32_t> begin(std::shared_ptr<const Procedure> procedure, Ert at);
    Result<void> on(std::uint32_t number, const Act& act);

    void on(const ChannelSample& sample);
    void on(const EventReceived& event);
    void on(const CommandFate& fate);
    void predict(const EntryPrediction& prediction);
    void pass(Ert now);

    /// By number less one.
    const std::vector<Execution>& executions() const { return executions_; }

  private:
    template <typename Call>
    void each_under_way(Call call) {
        for (Execution& execution : executions_)
            if (!execution.over()) call(execution);
    }

    const dictionary::Dictionary* dictionary_;
    ReceivedFacts facts_;
    std::vector<Execution> executions_;
};

}  // namespace aeolis::server::procedures
