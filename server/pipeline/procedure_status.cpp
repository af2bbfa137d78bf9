// SPDX-License-Identifier: Apache-2.0
#include "server/pipeline/procedure_status.hpp"

#include "commands/number.hpp"
#include "server/procedures/condition.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace aeolis::pipeline {
namespace {

using namespace server::procedures;

v1::ProcedureStatus::Part wire(Part part) {
    return static_cast<v1::ProcedureStatus::Part>(part);
}
static_assert(static_cast<int>(Part::stopped) == v1::ProcedureStatus::stopped);

v1::ProcedureStep::State wire(StepState state) {
    return static_cast<v1::ProcedureStep::State>(state);
}
static_assert(static_cast<int>(StepState::not_taken) == v1::ProcedureStep::not_taken);

/// The schema's kinds begin with `begin`, which is no act on an execution.
v1::ProcedureAct::Kind wire(Act::Kind kind) {
    return static_cast<v1::ProcedureAct::Kind>(static_cast<int>(kind) + 1);
}
static_assert(static_cast<int>(Act::Kind::stop) + 1 == v1::ProcedureAct::stop);

v1::ProcedureCondition::Verdict wire(Verdict verdict) {
    switch (verdict) {
    case Verdict::holds: return v1::ProcedureCondition::holds;
    case Verdict::does_not_hold: return v1::ProcedureCondition::does_not_hold;
    case Verdict::not_known: break;
    }
    return v1::ProcedureCondition::not_known;
}

void write(v1::ProcedureSignature& written, const Signature& signature) {
    written.set_position(std::string(name_of(signature.position)));
    written.set_by(signature.person);
    written.set_at_us(signature.at.microseconds);
}

/// Writes procedures of one dictionary.
class Writer {
  public:
    Writer(const Procedure& procedure, const dictionary::Dictionary& dictionary)
        : procedure_(procedure), dictionary_(dictionary) {}

    /// @param states  by condition; empty: of a step that was not begun
    template <typename Conditions>
    void write(Conditions& written, const std::vector<Condition>& conditions,
               const std::vector<ConditionState>& states) const {
        for (std::size_t i = 0; i < conditions.size(); ++i) {
            auto& condition = *written.Add();
            condition.set_text(text_of(conditions[i], dictionary_));
            if (i >= states.size()) continue;
            condition.set_verdict(wire(states[i].verdict));
            condition.set_evidence(states[i].evidence);
        }
    }

    void write(v1::ProcedureStep& written, const Step& step, Part part) const {
        written.set_step(step.id);
        written.set_part(wire(part));
        written.set_who(std::string(name_of(step.who)));
        written.set_text(text_now(procedure_, step));
        if (step.hold) written.set_hold(std::string(name_of(*step.hold)));
        std::string limits;
        if (step.limit_s) limits = fmt::format("within {} s", commands::shortest_text(*step.limit_s));
        if (step.limit_e) limits += fmt::format("{}by {}", limits.empty() ? "" : ", ", text_of(*step.limit_e));
        written.set_limits(limits);
        for (const Choice& choice : step.choices) {
            auto& way = *written.add_choices();
            way.set_text(choice.words);
            way.set_go_to(name_of(choice.target));
        }
        for (const Position position : step.signatures)
            written.add_signatures_wanted(std::string(server::procedures::name_of(position)));
        if (step.command) write(*written.mutable_command(), *step.command);
        if (step.next) written.set_next(name_of(*step.next));
    }

    void write(v1::ProcedureStep& written, const Step& step, const StepStatus& status) const {
        written.set_state(wire(status.state));
        if (status.active_since) written.set_since_us(status.active_since->microseconds);
        if (status.late_since) written.set_limit_passed_us(status.late_since->microseconds);
        if (status.over_since) written.set_over_us(status.over_since->microseconds);
        write(*written.mutable_conditions(), step.conditions, status.conditions);
        const bool open = status.active_since && !is_over(status.state);
        const bool against = open && !all_hold(status.conditions);
        written.set_reason_wanted(against);
        for (std::size_t i = 0; i < step.choices.size(); ++i) {
            auto& way = *written.mutable_choices(static_cast<int>(i));
            const auto states = i < status.choices.size() ? status.choices[i] : std::vector<ConditionState>{};
            write(*way.mutable_conditions(), step.choices[i].conditions, states);
            way.set_reason_wanted(open && (against || !all_hold(states)));
        }
        if (status.chosen) written.set_chosen(static_cast<std::uint32_t>(*status.chosen));
        for (const Signature& signature : status.signatures) pipeline::write(*written.add_signatures(), signature);
        written.set_by(status.by);
        written.set_reason(status.reason);
        if (!step.command) return;
        written.mutable_command()->set_command(status.command.value_or(0));
        written.mutable_command()->set_evidence(status.command_evidence);
    }

    void write(v1::ProcedureWatchdog& written, const Watchdog& watchdog, const WatchdogStatus& status) const {
        written.set_watchdog(watchdog.id);
        written.set_who(std::string(name_of(watchdog.who)));
        written.set_text(watchdog.text);
        write(*written.mutable_conditions(), watchdog.conditions, status.conditions);
        if (status.tripped) written.set_tripped_us(status.tripped->microseconds);
        if (status.acknowledged) pipeline::write(*written.mutable_acknowledged(), *status.acknowledged);
        written.set_begin(watchdog.begin);
        written.set_hold(watchdog.hold);
    }

  private:
    static std::string name_of(Position position) { return std::string(server::procedures::name_of(position)); }
    std::string name_of(const Target& target) const {
        switch (target.kind) {
        case Target::Kind::step: return procedure_.body[target.step].id;
        case Target::Kind::confirmation: return "confirmation";
        case Target::Kind::end: break;
        }
        return "end";
    }
    void write(v1::ProcedureCommand& written, const PreparedCommand& prepared) const {
        written.set_name(prepared.name);
        const auto* command = dictionary_.command(prepared.name);
        for (const auto& [name, value] : prepared.arguments) {
            auto& argument = *written.add_arguments();
            argument.set_name(name);
            argument.set_value(value);
            argument.set_text(commands::shortest_text(value));
            if (command == nullptr) continue;
            const auto known = std::ranges::find(command->arguments, name, &dictionary::Argument::name);
            if (known == command->arguments.end()) continue;
            for (const auto& label : known->type.enumeration)
                if (label.holds(value)) {
                    argument.set_text(label.label);
                    break;
                }
        }
        for (const std::string& name : prepared.to_fill) written.add_to_fill(name);
        written.set_from_solution(prepared.from_solution);
        written.set_until(commands::name_of(prepared.until));
    }

    const Procedure& procedure_;
    const dictionary::Dictionary& dictionary_;
};

template <typename Message>
void write_head(Message& written, const Procedure& procedure) {
    written.set_procedure(procedure.id);
    written.set_title(procedure.title);
    written.set_revision(procedure.revision);
    for (const Approval& approval : procedure.approvals) {
        auto& given = *written.add_approvals();
        given.set_position(std::string(name_of(approval.position)));
        given.set_name(approval.name);
        given.set_on(approval.on);
    }
}

/// Calls visit(step, its part) in the order of the procedure.
template <typename Visit>
void each_step(const Procedure& procedure, Visit visit) {
    for (const Step& step : procedure.preconditions) visit(step, Part::preconditions);
    for (const Step& step : procedure.body) visit(step, Part::body);
    for (const Step& step : procedure.confirmation) visit(step, Part::confirmation);
}

}  // namespace

v1::ProcedureStatus status_of(const Execution& execution, const dictionary::Dictionary& dictionary) {
    const Procedure& procedure = execution.procedure();
    const Writer writer{procedure, dictionary};
    v1::ProcedureStatus status;
    write_head(status, procedure);
    status.set_part(wire(execution.part()));
    status.set_over(execution.over());
    status.set_held(execution.held());
    status.set_begun_us(execution.begun().microseconds);
    std::size_t index = 0;
    each_step(procedure, [&](const Step& step, Part part) {
        auto& written = *status.add_steps();
        writer.write(written, step, part);
        writer.write(written, step, execution.steps()[index]);
        for (const Act::Kind kind : execution.acts_of_step(index)) written.add_acts(wire(kind));
        if (const auto limit = execution.limit(index)) written.set_limit_us(limit->microseconds);
        ++index;
    });
    for (std::size_t i = 0; i < procedure.watchdogs.size(); ++i) {
        auto& written = *status.add_watchdogs();
        writer.write(written, procedure.watchdogs[i], execution.watchdogs()[i]);
        for (const Act::Kind kind : execution.acts_of_watchdog(i)) written.add_acts(wire(kind));
    }
    for (const Act::Kind kind : execution.acts()) status.add_acts(wire(kind));
    return status;
}

v1::ProcedureForm form_of(const Procedure& procedure, const dictionary::Dictionary& dictionary) {
    const Writer writer{procedure, dictionary};
    v1::ProcedureForm form;
    auto& entry = *form.mutable_entry();
    write_head(entry, procedure);
    entry.set_purpose(procedure.purpose);
    entry.set_begin_when(procedure.begin_when);
    form.set_source(procedure.source);
    each_step(procedure, [&](const Step& step, Part part) {
        auto& written = *form.add_steps();
        writer.write(written, step, part);
        writer.write(written, step, StepStatus{});
    });
    for (const Watchdog& watchdog : procedure.watchdogs)
        writer.write(*form.add_watchdogs(), watchdog, WatchdogStatus{});
    for (const Redline& redline : procedure.redlines) {
        auto& written = *form.add_redlines();
        written.set_step(redline.step);
        written.set_text(redline.text);
        written.set_reason(redline.reason);
        written.set_by(redline.by);
        written.set_on(redline.on);
        written.set_approved_by(redline.approved_by);
    }
    return form;
}

}  // namespace aeolis::pipeline
