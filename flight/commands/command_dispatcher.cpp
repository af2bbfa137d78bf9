// SPDX-License-Identifier: Apache-2.0
#include "flight/commands/command_dispatcher.hpp"

#include "common/cltu.hpp"
#include "common/space_packet.hpp"
#include "flight/explanation/explanation.hpp"

#include <array>
#include <span>

namespace aeolis::flight {
namespace {

void explain(Outbox& out, const CommandTag& tag, ExplanationVerdict verdict,
             std::span<const gnc::Condition> conditions) {
    out.record(explanation(Decision::command, verdict, tag.opcode.value, conditions));
}

void refuse(Outbox& out, CommandTag tag, CommandRefusal reason, std::span<const gnc::Condition> conditions) {
    explain(out, tag, ExplanationVerdict::refused, conditions);
    out.event(evr::COMMAND_REFUSED{.opcode = tag.opcode.value, .count = tag.count, .reason = reason});
    out.send(ModuleId::mfsk, ToneRequest{tone::command_refused, out.now()});
}

/// Sends the decoded arguments to the owner, or refuses the command with the reason.
template <typename Command, typename Route>
void route(Outbox& out, CommandTag tag, std::span<const std::uint8_t> arguments, const Route& to_owner) {
    if (arguments.size() != Command::argument_octets) {
        const auto octets = static_cast<double>(arguments.size());
        const gnc::Condition length = arguments.size() > Command::argument_octets
                                          ? at_most(Quantity::argument_octets, octets, Command::argument_octets)
                                          : at_least(Quantity::argument_octets, octets, Command::argument_octets);
        return refuse(out, tag, CommandRefusal::bad_length, {&length, 1});
    }
    const auto command = Command::decode(arguments);
    if (!command) {
        const gnc::Condition in_range = is(Quantity::arguments_in_range, false);
        return refuse(out, tag, CommandRefusal::bad_argument, {&in_range, 1});
    }
    to_owner(*command);
}

}  // namespace

// Both computers receive every command; each answers only those addressed to it.
bool CommandDispatcher::is_for_this_computer(Opcode opcode) const {
    const bool for_the_backup = opcode == command::SECOND_CHANCE_ENABLE::opcode;
    return role_ == Role::prime ? !for_the_backup : for_the_backup || in_control_;
}

void CommandDispatcher::on(const Resume& resume, Outbox&) {
    in_control_ |= resume.reason == ResumeReason::take_over;
}

void CommandDispatcher::unreadable(std::size_t octets, Outbox& out) {
    if (is_deaf()) return;  // prime reports it
    out.event(evr::UPLINK_UNREADABLE{.size_octets = static_cast<std::uint16_t>(octets), .refused = ++refused_});
}

void CommandDispatcher::on(const UplinkReceived& uplink, Outbox& out) {
    if (uplink.size > uplink_octets_max) return unreadable(uplink.size, out);
    std::array<std::uint8_t, uplink_octets_max> information{};
    const auto octets = read_cltu(std::span{uplink.octets}.first(uplink.size), information);
    if (!octets) return unreadable(uplink.size, out);
    const auto frame = read_tc_frame(std::span{information}.first(*octets));
    if (!frame) return unreadable(uplink.size, out);
    take_frame(*frame, out);
    out.send(ModuleId::edl_comm, UplinkStatus{word_of(farm_.clcw())});
}

void CommandDispatcher::take_frame(const TcFrame& frame, Outbox& out) {
    const auto refused = [&](FrameRefusal why) {
        if (!is_deaf())
            out.event(evr::UPLINK_FRAME_REFUSED{
                .frame = frame.header.sequence, .frame_refusal = why, .expected_frame = farm_.clcw().expected});
    };
    switch (farm_.take(frame)) {
    case Farm::Verdict::accepted: return take_packet(frame.data, out);
    case Farm::Verdict::executed: return;
    case Farm::Verdict::repeated: return refused(FrameRefusal::repeated);
    case Farm::Verdict::out_of_sequence: return refused(FrameRefusal::out_of_sequence);
    case Farm::Verdict::locked_out: return refused(FrameRefusal::locked_out);
    case Farm::Verdict::not_for_this_channel: return refused(FrameRefusal::other_channel);
    case Farm::Verdict::no_such_control: return refused(FrameRefusal::no_such_control);
    }
}

void CommandDispatcher::take_packet(std::span<const std::uint8_t> octets, Outbox& out) {
    const auto packet = read_tc_packet(octets);
    if (!packet) return unreadable(octets.size(), out);
    const CommandTag tag{packet->opcode, packet->primary.count};
    if (!is_for_this_computer(tag.opcode)) return;
    switch (packet->opcode.value) {
    case command::NO_OP::opcode.value:
        return route<command::NO_OP>(out, tag, packet->arguments, [&](const command::NO_OP&) {
            out.event(evr::NO_OP_EXECUTED{});
            on(CommandOutcome{.tag = tag}, out);
        });
    case command::EDL_SET_PARAMETERS::opcode.value:
        return route<command::EDL_SET_PARAMETERS>(out, tag, packet->arguments, [&](const auto& command) {
            out.send(ModuleId::edl_bg, SetParametersCommand{tag, command});
        });
    case command::EDL_STAGE_PARAMETER::opcode.value:
        return route<command::EDL_STAGE_PARAMETER>(out, tag, packet->arguments, [&](const auto& command) {
            out.send(ModuleId::edl_bg, StageParameterCommand{tag, command});
        });
    case command::EDL_ACTIVATE_PARAMETERS::opcode.value:
        return route<command::EDL_ACTIVATE_PARAMETERS>(out, tag, packet->arguments, [&](const auto& command) {
            out.send(ModuleId::edl_bg, ActivateParametersCommand{tag, command});
        });
    case command::EDL_DISCARD_PARAMETERS::opcode.value:
        return route<command::EDL_DISCARD_PARAMETERS>(out, tag, packet->arguments, [&](const auto&) {
            out.send(ModuleId::edl_bg, DiscardParametersCommand{tag});
        });
    case command::EDL_DUMP_PARAMETERS::opcode.value:
        return route<command::EDL_DUMP_PARAMETERS>(
            out, tag, packet->arguments, [&](const auto&) { out.send(ModuleId::edl_bg, DumpParametersCommand{tag}); });
    case command::EDL_DO_EDL::opcode.value:
        return route<command::EDL_DO_EDL>(out, tag, packet->arguments,
                                          [&](const auto&) { out.send(ModuleId::edl, DoEdlCommand{tag}); });
    case command::EDL_SET_TIMEPOINT_OFFSET::opcode.value:
        return route<command::EDL_SET_TIMEPOINT_OFFSET>(out, tag, packet->arguments, [&](const auto& command) {
            out.send(ModuleId::edl, SetTimepointOffsetCommand{tag, command});
        });
    case command::EDL_SET_ANCHOR_OFFSET::opcode.value:
        return route<command::EDL_SET_ANCHOR_OFFSET>(out, tag, packet->arguments, [&](const auto& command) {
            out.send(ModuleId::edl, SetAnchorOffsetCommand{tag, command});
        });
    case command::SECOND_CHANCE_ENABLE::opcode.value:
        return route<command::SECOND_CHANCE_ENABLE>(out, tag, packet->arguments, [&](const auto& command) {
            out.send(ModuleId::cross_string, EnableSecondChanceCommand{tag, command.enabled == Permission::yes});
        });
    case command::SELECT_PRIME::opcode.value:
        return route<command::SELECT_PRIME>(out, tag, packet->arguments, [&](const auto& command) {
            out.send(ModuleId::edl, SelectPrimeCommand{tag, command.computer == ComputerString::b});
        });
    case command::PRIME_RESUME::opcode.value:
        return route<command::PRIME_RESUME>(out, tag, packet->arguments, [&](const auto&) {
            out.send(ModuleId::cross_string, ResumePrimeCommand{tag});
        });
    case command::EDL_SELECT_UNITS::opcode.value:
        return route<command::EDL_SELECT_UNITS>(out, tag, packet->arguments, [&](const auto& command) {
            out.send(ModuleId::units, SelectUnitsCommand{tag, command});
        });
    default: {
        const gnc::Condition known = is(Quantity::command_known, false);
        return refuse(out, tag, CommandRefusal::unknown_opcode, {&known, 1});
    }
    }
}

void CommandDispatcher::on(const CommandOutcome& outcome, Outbox& out) {
    const CommandTag& tag = outcome.tag;
    if (outcome.refused) return refuse(out, tag, *outcome.refused, outcome.conditions);
    explain(out, tag, ExplanationVerdict::accepted, outcome.conditions);
    out.event(evr::COMMAND_ACCEPTED{.opcode = tag.opcode.value, .count = tag.count});
    out.event(evr::COMMAND_EXECUTED{.opcode = tag.opcode.value, .count = tag.count});
}

}  // namespace aeolis::flight
