#include "flight/commands/command_dispatcher.hpp"

#include "common/space_packet.hpp"

#include <span>

namespace aeolis::flight {
namespace {

void refuse(Outbox& out, CommandTag tag, CommandRefusal reason) {
    out.event(evr::COMMAND_REFUSED{.opcode = tag.opcode.value, .count = tag.count, .reason = reason});
    out.send(ModuleId::mfsk, ToneRequest{tone::command_refused, out.now()});
}

/// Arguments to the owner, or the reason why not.
template <typename Command, typename Route>
void route(Outbox& out, CommandTag tag, std::span<const std::uint8_t> arguments, const Route& to_owner) {
    if (arguments.size() != Command::argument_octets) return refuse(out, tag, CommandRefusal::bad_length);
    const auto command = Command::decode(arguments);
    if (!command) return refuse(out, tag, CommandRefusal::bad_argument);
    to_owner(*command);
}

}  // namespace

// Both computers hear every command; each answers only those that are for it.
bool CommandDispatcher::is_for_this_computer(Opcode opcode) const {
    const bool for_the_backup = opcode == command::SECOND_CHANCE_ENABLE::opcode;
    return role_ == Role::prime ? !for_the_backup : for_the_backup || in_control_;
}

void CommandDispatcher::on(const Resume& resume, Outbox&) {
    in_control_ |= resume.reason == ResumeReason::take_over;
}

void CommandDispatcher::on(const UplinkReceived& uplink, Outbox& out) {
    const auto packet = uplink.size <= uplink_octets_max
                            ? read_tc_packet(std::span{uplink.octets}.first(uplink.size))
                            : std::optional<TcPacket>{};
    if (!packet && role_ == Role::second_chance && !in_control_) return;  // prime reports it
    if (!packet) {
        out.event(evr::UPLINK_UNREADABLE{.size_octets = uplink.size, .refused = ++refused_});
        return;
    }
    const CommandTag tag{packet->opcode, packet->primary.count};
    if (!is_for_this_computer(tag.opcode)) return;
    switch (packet->opcode.value) {
    case command::NO_OP::opcode.value:
        return route<command::NO_OP>(out, tag, packet->arguments, [&](const command::NO_OP&) {
            out.event(evr::NO_OP_EXECUTED{});
            on(CommandOutcome{tag, std::nullopt}, out);
        });
    case command::EDL_SET_PARAMETERS::opcode.value:
        return route<command::EDL_SET_PARAMETERS>(out, tag, packet->arguments, [&](const auto& command) {
            out.send(ModuleId::edl_bg, SetParametersCommand{tag, command});
        });
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
    case command::EDL_SELECT_UNITS::opcode.value:
        return route<command::EDL_SELECT_UNITS>(out, tag, packet->arguments, [&](const auto& command) {
            out.send(ModuleId::units, SelectUnitsCommand{tag, command});
        });
    default: return refuse(out, tag, CommandRefusal::unknown_opcode);
    }
}

void CommandDispatcher::on(const CommandOutcome& outcome, Outbox& out) {
    const CommandTag& tag = outcome.tag;
    if (outcome.refused) return refuse(out, tag, *outcome.refused);
    out.event(evr::COMMAND_ACCEPTED{.opcode = tag.opcode.value, .count = tag.count});
    out.event(evr::COMMAND_EXECUTED{.opcode = tag.opcode.value, .count = tag.count});
}

}  // namespace aeolis::flight
