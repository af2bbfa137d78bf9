// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/bytes.hpp"
#include "common/cltu.hpp"
#include "common/ids.hpp"
#include "common/space_packet.hpp"
#include "common/tc_frame.hpp"
#include "generated/dictionary_flight.hpp"
#include "simulation/landing.hpp"

#include <span>
#include <vector>

// The telecommands of a landing as CLTUs, each packet in an expedited frame. They are packed field by field here,
// independently of the encoder in commands/.
namespace aeolis::test {

inline std::vector<std::uint8_t> cltu_of(std::span<const std::uint8_t> packet, const TcFrameHeader& header) {
    std::vector<std::uint8_t> frame(packet.size() + tc_frame_overhead_octets);
    write_tc_frame(header, packet, frame);
    std::vector<std::uint8_t> cltu(cltu_octets(frame.size()));
    write_cltu(frame, cltu);
    return cltu;
}
inline std::vector<std::uint8_t> cltu_of(std::span<const std::uint8_t> packet) {
    return cltu_of(packet, {true, false, spacecraft_id, telecommand_channel, 0});
}

inline std::vector<std::uint8_t> set_parameters(const simulation::NavigationSolution& solution) {
    std::vector<std::uint8_t> packet(tc_overhead_octets + flight::command::EDL_SET_PARAMETERS::argument_octets);
    BitWriter arguments{std::span{packet}.subspan(tc_arguments_offset_octets)};
    arguments.put(solution.solution_id, 16);
    arguments.put_double(solution.epoch.seconds);
    for (const double value : solution.p_MoB_M_m) arguments.put_double(value);
    for (const double value : solution.v_MB_M_mps) arguments.put_double(value);
    arguments.put_double(solution.entry.seconds);
    arguments.put_double(solution.target.latitude_deg);
    arguments.put_double(solution.target.longitude_deg);
    arguments.put_double(solution.target.radius_m);
    for (const float value : {405.0F, 6000.0F, 142.0F, 1660.0F, 79.1F}) arguments.put_float(value);
    seal_tc_packet(packet, Apid{1}, 0, flight::command::EDL_SET_PARAMETERS::opcode);
    return cltu_of(packet);
}

inline std::vector<std::uint8_t> do_edl() {
    std::vector<std::uint8_t> packet(tc_overhead_octets);
    seal_tc_packet(packet, Apid{1}, 1, flight::command::EDL_DO_EDL::opcode);
    return cltu_of(packet);
}

/// To a prime that stands by.
inline std::vector<std::uint8_t> resume_prime() {
    std::vector<std::uint8_t> packet(tc_overhead_octets);
    seal_tc_packet(packet, Apid{1}, 3, flight::command::PRIME_RESUME::opcode);
    return cltu_of(packet);
}

inline std::vector<std::uint8_t> set_timepoint_offset(TimepointId timepoint, double desired_s, double minimum_s) {
    using Command = flight::command::EDL_SET_TIMEPOINT_OFFSET;
    std::vector<std::uint8_t> packet(tc_overhead_octets + Command::argument_octets);
    BitWriter arguments{std::span{packet}.subspan(tc_arguments_offset_octets)};
    arguments.put(timepoint.value, 16);
    arguments.put_double(desired_s);
    arguments.put_double(minimum_s);
    seal_tc_packet(packet, Apid{1}, 2, Command::opcode);
    return cltu_of(packet);
}

inline std::vector<std::uint8_t> stage_parameter(ParameterId parameter, double value) {
    using Command = flight::command::EDL_STAGE_PARAMETER;
    std::vector<std::uint8_t> packet(tc_overhead_octets + Command::argument_octets);
    BitWriter arguments{std::span{packet}.subspan(tc_arguments_offset_octets)};
    arguments.put(parameter.value, 16);
    arguments.put_double(value);
    seal_tc_packet(packet, Apid{1}, 2, Command::opcode);
    return cltu_of(packet);
}
inline std::vector<std::uint8_t> activate_parameters(std::uint16_t version, std::uint16_t changes, std::uint16_t crc) {
    using Command = flight::command::EDL_ACTIVATE_PARAMETERS;
    std::vector<std::uint8_t> packet(tc_overhead_octets + Command::argument_octets);
    BitWriter arguments{std::span{packet}.subspan(tc_arguments_offset_octets)};
    arguments.put(version, 16);
    arguments.put(changes, 16);
    arguments.put(crc, 16);
    seal_tc_packet(packet, Apid{1}, 2, Command::opcode);
    return cltu_of(packet);
}
inline std::vector<std::uint8_t> discard_parameters() {
    std::vector<std::uint8_t> packet(tc_overhead_octets);
    seal_tc_packet(packet, Apid{1}, 2, flight::command::EDL_DISCARD_PARAMETERS::opcode);
    return cltu_of(packet);
}
inline std::vector<std::uint8_t> dump_parameters() {
    std::vector<std::uint8_t> packet(tc_overhead_octets);
    seal_tc_packet(packet, Apid{1}, 2, flight::command::EDL_DUMP_PARAMETERS::opcode);
    return cltu_of(packet);
}

inline std::vector<std::uint8_t> with_one_octet(Opcode opcode, std::uint8_t argument) {
    std::vector<std::uint8_t> packet(tc_overhead_octets + 1);
    packet[tc_arguments_offset_octets] = argument;
    seal_tc_packet(packet, Apid{1}, 2, opcode);
    return cltu_of(packet);
}
inline std::vector<std::uint8_t> enable_second_chance() {
    return with_one_octet(flight::command::SECOND_CHANCE_ENABLE::opcode, 1);
}
inline std::vector<std::uint8_t> select_prime_b() {
    return with_one_octet(flight::command::SELECT_PRIME::opcode, 1);
}
/// Units in the order of flight::Device, 0 for A and 1 for B.
inline std::vector<std::uint8_t> select_units(std::span<const std::uint8_t> units) {
    std::vector<std::uint8_t> packet(tc_overhead_octets + flight::command::EDL_SELECT_UNITS::argument_octets);
    BitWriter arguments{std::span{packet}.subspan(tc_arguments_offset_octets)};
    for (const std::uint8_t unit : units) arguments.put(unit, 8);
    seal_tc_packet(packet, Apid{1}, 2, flight::command::EDL_SELECT_UNITS::opcode);
    return cltu_of(packet);
}

}  // namespace aeolis::test
