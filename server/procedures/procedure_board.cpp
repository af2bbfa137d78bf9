// SPDX-License-Identifier: Apache-2.0
#include "server/procedures/procedure_board.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace aeolis::server::procedures {

Result<std::uint32_t> ProcedureBoard::begin(std::shared_ptr<const Procedure> procedure, Ert at) {
    const auto under_way = std::ranges::count_if(executions_, [](const Execution& one) { return !one.over(); });
    if (static_cast<std::size_t>(under_way) >= under_way_max)
        return Error{fmt::format("{} procedures are under way, which is as many as there may be", under_way)};
    if (executions_.size() >= begun_max)
        return Error{fmt::format("{} procedures were begun in this run, which is as many as there may be", begun_max)};
    executions_.emplace_back(std::move(procedure), *dictionary_, at, facts_);
    return static_cast<std::uint32_t>(executions_.size());
}

Result<void> ProcedureBoard::on(std::uint32_t number, const Act& act) {
    if (number == 0 || number > executions_.size())
        return Error{fmt::format("there is no procedure of the number {} in this run", number)};
    if (act.kind == Act::Kind::sent)
        for (std::size_t i = 0; i < executions_.size(); ++i)
            if (std::ranges::find(executions_[i].steps(), std::optional{act.command}, &StepStatus::command) !=
                executions_[i].steps().end())
                return Error{fmt::format("command {} is already that of a step of procedure {}", act.command, i + 1)};
    return executions_[number - 1].on(act);
}

void ProcedureBoard::on(const ChannelSample& sample) {
    facts_.on(sample);
    each_under_way([&](Execution& execution) { execution.on(sample); });
}

void ProcedureBoard::on(const EventReceived& event) {
    facts_.on(event);
    each_under_way([&](Execution& execution) { execution.on(event); });
}

void ProcedureBoard::on(const CommandFate& fate) {
    each_under_way([&](Execution& execution) { execution.on(fate); });
}

void ProcedureBoard::predict(const EntryPrediction& prediction) {
    facts_.predict(prediction);
    each_under_way([&](Execution& execution) { execution.predict(prediction); });
}

void ProcedureBoard::pass(Ert now) {
    each_under_way([&](Execution& execution) { execution.pass(now); });
}

}  // namespace aeolis::server::procedures
