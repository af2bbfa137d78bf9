// SPDX-License-Identifier: Apache-2.0
#include "common/deviation.hpp"
#include "flight/edl/edl_main.hpp"
#include "flight/explanation/explanation.hpp"
#include "flight/kernel/parameter_parts.hpp"

#include <array>

// EdlMain holds the table of parameters, which ground changes by staging and activating. R25, R48
namespace aeolis::flight {

bool EdlMain::may_change_table(const CommandTag& tag, Outbox& out) const {
    if (!configuration_.enabled) return true;
    CommandOutcome outcome{tag, CommandRefusal::wrong_phase, {}};
    outcome.conditions.push_back(is(Quantity::gnc_enabled, true, false));
    out.send(ModuleId::command_dispatcher, outcome);
    return false;
}

void EdlMain::table_changed(Outbox& out) {
    ++revision_;
    out.record(table_.report());
}

void EdlMain::tell_not_activated(Outbox& out) const {
    const auto staged = static_cast<std::uint16_t>(table_.staged());
    if (staged > 0) out.event(evr::PARAMETERS_NOT_ACTIVATED{.parameters_staged = staged});
}

void EdlMain::fly_by_table(Outbox& out) {
    gnc_.set_parameters(table_.values());
    for (const ModuleId module : {ModuleId::edl_bg, ModuleId::mfsk})
        parameter_parts(table_.values(), [&](const ParameterPart& part) { out.send(module, part); });
    out.record(table_.report());
}

void EdlMain::on(const StageParameterCommand& command, Outbox& out) {
    if (!may_change_table(command.tag, out)) return;
    const auto& change = command.arguments;
    CommandOutcome outcome{command.tag, std::nullopt, conditions_of(change)};
    if (!all_hold(outcome.conditions)) {
        outcome.refused = refusal_of(outcome.conditions);
    } else if (!table_.has_room(ParameterId{change.parameter})) {
        outcome.refused = CommandRefusal::staging_full;
        outcome.conditions.clear();
        outcome.conditions.push_back(
            below(Quantity::staged_changes, static_cast<double>(table_.staged()), double{staged_changes_max}));
    }
    if (!outcome.refused) {
        table_.stage(ParameterId{change.parameter}, change.value);
        out.event(evr::PARAMETER_STAGED{.parameter = change.parameter, .value = change.value});
        table_changed(out);
    }
    out.send(ModuleId::command_dispatcher, outcome);
}

void EdlMain::on(const ActivateParametersCommand& command, Outbox& out) {
    if (!may_change_table(command.tag, out)) return;
    const auto& arguments = command.arguments;
    const auto staged = static_cast<double>(table_.staged());
    CommandOutcome outcome{.tag = command.tag};
    outcome.conditions.push_back(staged < arguments.parameter_changes
                                     ? at_least(Quantity::staged_changes, staged, arguments.parameter_changes)
                                     : at_most(Quantity::staged_changes, staged, arguments.parameter_changes));
    outcome.conditions.push_back(is(Quantity::parameter_version_new, arguments.parameter_version != table_.version()));
    outcome.conditions.push_back(
        is(Quantity::parameter_crc_as_sent, arguments.parameter_crc == table_.crc_with_staged()));
    outcome.conditions.push_back(
        at_most(Quantity::table_deviation, table_.deviation_with_staged(), table_deviation_max));
    if (!all_hold(outcome.conditions)) outcome.refused = CommandRefusal::bad_argument;
    if (!outcome.refused) {
        table_.activate(arguments.parameter_version);
        ++revision_;
        fly_by_table(out);
        out.event(evr::PARAMETERS_ACTIVATED{.parameter_version = arguments.parameter_version,
                                            .parameter_changes = arguments.parameter_changes});
        out.send(ModuleId::mfsk, ToneRequest{tone::parameters_accepted, out.now()});
    }
    out.send(ModuleId::command_dispatcher, outcome);
}

void EdlMain::on(const DiscardParametersCommand& command, Outbox& out) {
    if (!may_change_table(command.tag, out)) return;
    const auto staged = static_cast<std::uint16_t>(table_.staged());
    table_.discard();
    out.event(evr::PARAMETERS_DISCARDED{.parameter_changes = staged});
    table_changed(out);
    CommandOutcome outcome{.tag = command.tag};
    outcome.conditions.push_back(is(Quantity::gnc_enabled, false, false));
    out.send(ModuleId::command_dispatcher, outcome);
}

// Reading changes nothing: it is possible at any time.
void EdlMain::on(const DumpParametersCommand& command, Outbox& out) {
    parameter_parts(table_.values(), [&](const ParameterPart& part) { out.send(ModuleId::edl_comm, part); });
    out.send(ModuleId::command_dispatcher, CommandOutcome{.tag = command.tag});
}

}  // namespace aeolis::flight
