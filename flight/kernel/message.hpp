// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/fixed_vector.hpp"
#include "common/ids.hpp"
#include "common/time.hpp"
#include "flight/devices/device_messages.hpp"
#include "flight/gnc/edl_gnc.hpp"
#include "generated/dictionary_flight.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <type_traits>
#include <variant>

// Every message between modules. Plain data: message.cpp does not compile with a pointer in one, however deep. R3
namespace aeolis::flight {

/// Every module of the load, in order of priority.
/// Up to `thrusters` they are the rate group, in sync's order. R8, R22
enum class ModuleId : std::uint8_t {
    sync,
    radar,
    imu,
    edl,
    pyro,
    descent_engines,
    thrusters,
    power,
    telecom,
    units,
    cruise_attitude,
    system_fault_protection,
    cross_string,
    command_dispatcher,
    edl_bg,
    mfsk,
    edl_comm,
};
inline constexpr std::size_t module_count = 17;
constexpr bool in_rate_group(ModuleId id) {
    return id <= ModuleId::thrusters;
}
constexpr std::uint32_t bit_of(ModuleId id) {
    return 1U << static_cast<unsigned>(id);
}

// ---- clock and rate group --------------------------------------------------------------------------------------

struct ClockTick {  ///< from the clock interrupt: to sync and the other subscribers
    Sclk now;
};
struct Tick {  ///< from sync: your turn in this cycle
    Sclk now;
};
struct Confirm {  ///< to sync: done for this cycle
    ModuleId from{};
};

// ---- messages from interrupts (R10) ----------------------------------------------------------------------------

struct ImuReadings {
    Sclk now;
    FixedVector<ImuSample, 4> samples;
};
struct RadarReturns {
    Sclk now;
    FixedVector<RadarBeam, radar_beam_count> beams;
};
/// Part of a state that one computer sends to another, or to itself over a restart. R33
/// The parts of one state arrive in order, within one cycle.
inline constexpr std::size_t state_part_octets_max = 240;  ///< chosen: no larger than the largest other message
struct StatePart {
    Sclk time;               ///< of the state
    std::uint8_t index = 0;  ///< 0 … count − 1
    std::uint8_t count = 0;
    std::uint8_t size = 0;
    std::array<std::uint8_t, state_part_octets_max> octets{};
};
struct StoredStatePart {  ///< from non-volatile memory, once, after a restart
    StatePart part;
};
/// `placed`: put in from outside, by a simulation that begins in mid-flight; nothing on board asks for it.
enum class ResumeReason : std::uint8_t { restart, take_over, placed };
/// To Edl, after the parts: continue from that state. R32, R33
struct Resume {
    ResumeReason reason{};
};

struct OtherRunsBuses {  ///< in each cycle in which a monitor on the buses sees the other computer run them
    Sclk now;
};

inline constexpr std::size_t uplink_octets_max =
    256;  ///< chosen: the longest command of the dictionary makes a CLTU of 194
struct UplinkReceived {
    std::array<std::uint8_t, uplink_octets_max> octets{};
    std::uint16_t size = 0;  ///< as received; above uplink_octets_max the rest is lost and the CLTU is refused
};
struct UplinkStatus {  ///< from the command dispatcher to EdlComm, for its status channel
    std::uint32_t clcw = 0;
};
struct NvmStatus {
    std::uint32_t used_octets = 0;
    std::uint32_t capacity_octets = 0;
};

// ---- timeline's actions and the devices' answers ---------------------------------------------------------------

enum class ReplyKind : std::uint8_t { none, pyro, arming, device_switch, thrusters, engines, bridle, recording };
/// A device's answer to its command. None: it was commanded again, so that an earlier answer no longer counts. R50
enum class Evidence : std::uint8_t { none, verified, refused };
/// The reply that a timepoint waits for, and that a device manager sends. R14, R50
struct ActionReply {
    ReplyKind kind = ReplyKind::none;
    std::uint8_t id = 0;
    Evidence evidence = Evidence::verified;
    bool on = true;  ///< of a switch or the thrusters: the commanded state
    bool operator==(const ActionReply&) const = default;

    constexpr bool answers(const ActionReply& asked) const {
        return kind == asked.kind && id == asked.id && on == asked.on;
    }

    template <typename Exchange>
    void carry(Exchange& exchange) {
        exchange(kind, id, evidence, on);
    }
};
struct FirePyro {
    PyroId pyro{};
    Sclk until;  ///< time-out of the timepoint, and end of retries
};
struct ArmPyros {
    bool armed = false;
};
struct CloseRecording {};
struct SetSwitch {
    SwitchId id{};
    bool on = false;
};
struct EnableThrusters {
    bool enabled = false;
};
struct FireThrusters {
    ThrusterCommand thrusters;
};
struct RunEngines {
    EngineCommand engines;
};
struct PayOutBridle {};
struct UnitsSelected {  ///< to the device managers: address these units from now on. R2
    UnitSelection units;
};
struct EdlBegun {};         ///< "do edl" was accepted: choices made before EDL are now fixed
struct NavigatedAttitude {  ///< used by EdlBg to transform the radar's beams to Mars's frame
    std::array<double, 4> q_MB{1, 0, 0, 0};
    std::array<double, 3> up_M{};
    bool radar_locked = false;
};

struct InhibitEdl {  ///< from system fault protection: EDL must stop its progress, or may continue. R24
    bool inhibited = false;
};

// ---- commands --------------------------------------------------------------------------------------------------

/// Identifies one uplinked command, so that its outcome can be matched to it.
struct CommandTag {
    Opcode opcode;
    std::uint16_t count = 0;
};
struct SetParametersCommand {
    CommandTag tag;
    command::EDL_SET_PARAMETERS arguments;
};
struct ParametersUpdate {  ///< checked parameters, from EdlBg to Edl
    CommandTag tag;
    command::EDL_SET_PARAMETERS parameters;
};
struct StageParameterCommand {  ///< to EdlBg, which checks it, and on to Edl
    CommandTag tag;
    command::EDL_STAGE_PARAMETER arguments;
};
struct ActivateParametersCommand {  ///< by EdlBg too, behind the changes that it activates
    CommandTag tag;
    command::EDL_ACTIVATE_PARAMETERS arguments;
};
struct DiscardParametersCommand {
    CommandTag tag;
};
struct DumpParametersCommand {
    CommandTag tag;
};
/// Part of the table of parameters that Edl holds, to modules that need it. The parts of a table arrive in order.
inline constexpr std::size_t part_parameters_max = 28;  ///< chosen: no larger than the largest other message
struct ParameterPart {
    std::uint16_t first = 0;
    std::uint8_t count = 0;
    std::array<double, part_parameters_max> values{};
};
struct DoEdlCommand {
    CommandTag tag;
};
struct SetTimepointOffsetCommand {
    CommandTag tag;
    command::EDL_SET_TIMEPOINT_OFFSET arguments;
};
struct SetAnchorOffsetCommand {
    CommandTag tag;
    command::EDL_SET_ANCHOR_OFFSET arguments;
};
struct EnableSecondChanceCommand {
    CommandTag tag;
    bool enabled = false;
};
struct SelectPrimeCommand {
    CommandTag tag;
    bool string_b = false;
};
struct ResumePrimeCommand {  ///< to a prime that stands by: fly on
    CommandTag tag;
};
struct SelectUnitsCommand {
    CommandTag tag;
    command::EDL_SELECT_UNITS arguments;
};
struct CommandOutcome {
    CommandTag tag;
    std::optional<CommandRefusal> refused{};  ///< none: accepted and executed
    gnc::Conditions conditions{};             ///< by which the owner decided. R38
};

// ---- data ------------------------------------------------------------------------------------------------------

inline constexpr std::size_t record_octets_max = 248;
/// The data field of one telemetry packet, for EdlComm to seal, record, and perhaps send. R29
struct Record {
    Apid apid;
    Sclk time;
    std::uint16_t size = 0;
    std::array<std::uint8_t, record_octets_max> data{};
};
struct ToneRequest {
    ToneId tone;
    Sclk requested;
};
struct PhaseChanged {
    EdlPhase phase{};
};
struct StandBy {        ///< from Edl of a prime restarted too late: the other computer flies and transmits
    bool over = false;  ///< ground has ordered prime to fly on
};
struct EdlFinished {};  ///< from Edl: the last timepoint has fired
struct ToneStatus {     ///< from MFSK to EdlComm, for its status channels
    std::uint8_t tone = 0;
    std::uint8_t outstanding = 0;
};

using Message =
    std::variant<ClockTick, Tick, Confirm, ImuReadings, RoverImuReading, RadarReturns, StatePart, StoredStatePart,
                 Resume, UplinkReceived, NvmStatus, PyroReply, SwitchReply, EngineReply, ThrusterReply, BridleReply,
                 CruiseAttitude, gnc::RadarSolution, ActionReply, FirePyro, ArmPyros, SetSwitch, EnableThrusters,
                 FireThrusters, RunEngines, PayOutBridle, UnitsSelected, EdlBegun, NavigatedAttitude, SystemFaultReport,
                 InhibitEdl, SetParametersCommand, ParametersUpdate, StageParameterCommand, ActivateParametersCommand,
                 DiscardParametersCommand, DumpParametersCommand, ParameterPart, DoEdlCommand,
                 SetTimepointOffsetCommand, SetAnchorOffsetCommand, SelectUnitsCommand, EnableSecondChanceCommand,
                 SelectPrimeCommand, ResumePrimeCommand, OtherRunsBuses, CommandOutcome, Record, ToneRequest,
                 PhaseChanged, StandBy, EdlFinished, ToneStatus, UplinkStatus, CloseRecording>;
static_assert(std::is_trivially_copyable_v<Message>, "messages hold only data");

/// Copies only the content of a message, not the space of the largest alternative.
inline void copy_content(Message& to, const Message& from) {
    std::visit([&](const auto& content) { to.emplace<std::remove_cvref_t<decltype(content)>>(content); }, from);
}

/// Whether a message makes its module run.
/// In the rate group only the Tick does: other messages wait for it. R22
inline bool wakes(ModuleId to, const Message& message) {
    return to == ModuleId::sync || !in_rate_group(to) || std::holds_alternative<Tick>(message);
}

struct Envelope {
    ModuleId from{};
    ModuleId to{};
    Message message;
};

}  // namespace aeolis::flight
