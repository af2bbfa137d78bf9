// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/ids.hpp"
#include "common/mfsk_waveform.hpp"
#include "common/result.hpp"
#include "common/time.hpp"
#include "dictionaries/telemetry_plan.hpp"
#include "dictionaries/timeline_rule.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

// A mission's dictionary, loaded and checked.
// XTCE: commands, channels, packets and events. CSV: timeline, anchors, tones and parameters. Plain values, shared by
// the autocoder and every part of the ground.
namespace aeolis::dictionary {

namespace xtce {
struct PacketModel;
}

// ---- types -----------------------------------------------------------------------------------------------------

enum class Encoding { unsigned_integer, twos_complement, ieee754 };
enum class ValueKind { integer, real, enumerated, boolean, text };

struct EnumValue {
    std::int64_t value = 0;
    std::string label;
    std::optional<std::int64_t> last{};  ///< of a range of values with this label; none: only `value`

    bool holds(double number) const {
        return number >= static_cast<double>(value) && number <= static_cast<double>(last.value_or(value));
    }
};

/// Calibrated = sum of coefficient[i] · raw^i; empty: calibrated is raw.
using Polynomial = std::vector<double>;

enum class Severity { none, watch, warning, distress, critical, severe };

struct AlarmRange {
    Severity severity = Severity::none;
    std::optional<double> below;  ///< in alarm when value < below
    std::optional<double> above;  ///< in alarm when value > above
    bool at_below = false;        ///< in alarm also when value = below
    bool at_above = false;        ///< in alarm also when value = above

    bool is_below(double value) const { return below && (value < *below || (at_below && value == *below)); }
    bool is_above(double value) const { return above && (value > *above || (at_above && value == *above)); }
};
struct EnumAlarm {
    Severity severity = Severity::none;
    std::int64_t value = 0;
    std::optional<std::int64_t> last{};  ///< of a range of values; none: only `value`
};
/// Condition on a channel's latest value: for the release of a command, or for the alarms of a context.
struct Precondition {
    ChannelId channel;
    std::string comparison;  ///< "==", "!=", "<", "<=", ">", ">="
    double value = 0.0;
    std::string text;

    bool holds(double latest) const;
};

struct ContextAlarms;
struct Alarms {
    std::vector<AlarmRange> ranges;  ///< nested, least severe first
    std::vector<EnumAlarm> values;
    std::uint32_t min_violations = 1;     ///< consecutive samples before the alarm is raised
    std::uint32_t min_conformance = 1;    ///< consecutive samples before it is cleared
    bool latches = false;                 ///< stays raised after clearing until someone resets it
    std::vector<ContextAlarms> contexts;  ///< of a channel: the first whose context holds replaces the alarms above
};
/// Alarms that apply while their context holds, for example in one phase of EDL.
struct ContextAlarms {
    std::vector<Precondition> context;  ///< all must hold
    Alarms alarms;
};

/// Encoding of one value in a packet or a command, and its meaning.
struct Type {
    std::string name;
    ValueKind kind = ValueKind::integer;
    Encoding encoding = Encoding::unsigned_integer;
    unsigned bits = 0;
    bool binary = false;  ///< not a number but bits / 8 octets: never a field, only Packet::content
    std::string unit;     ///< "1" for a dimensionless number
    Polynomial calibrator;
    std::vector<EnumValue> enumeration;
    std::optional<double> valid_min, valid_max;
    Alarms alarms;
};
/// Whether a double cannot hold every value of the type: true for text, and for whole numbers of more than 53 bits.
bool needs_text(const Type& type);

// ---- telemetry -------------------------------------------------------------------------------------------------

/// One telemetered quantity (EHA channel). Its ChannelId is its index in Dictionary::channels.
struct Channel {
    ChannelId id;
    std::string name;   ///< XTCE parameter name, snake_case with the unit last: "altitude_m"
    std::string alias;  ///< "GNC-0101"
    std::string text;   ///< one line, for people
    Type type;
};

/// A field of a packet: a channel, or a header field or argument that is not a channel.
struct Field {
    std::string name;
    Type type;
    std::optional<ChannelId> channel;
    unsigned position_bits = 0;            ///< from the first octet of the packet
    std::optional<unsigned> validity_bit;  ///< position of the bit that says whether the value is defined
};

/// Octets in a packet that are not a number: a part of a data product. They begin at a whole octet.
struct Content {
    std::string name;
    unsigned offset_octets = 0;  ///< from the first octet of the packet
    unsigned octets = 0;
};

/// One concrete container: the content of packets with this APID and, for events, this event id.
struct Packet {
    std::string name;  ///< "GncNavigation"
    std::string text;
    Apid apid;
    std::optional<EvrId> event;  ///< set for the containers of events
    unsigned octets = 0;         ///< whole packet with headers and CRC
    std::vector<Field> fields;   ///< after the secondary header, in order
    std::optional<double> expected_rate_hz;
    std::optional<Content> content;
};
/// Index of the field with this name; for people, and for the few fields that ground itself interprets.
std::optional<std::size_t> field_index(const Packet& packet, std::string_view name);

enum class EventLevel { fatal, warning_hi, warning_lo, command, activity_hi, activity_lo, diagnostic };

/// Event report (EVR). Its arguments are the fields of its packet.
/// `format` names them in braces: "speed {speed_mps} m/s".
struct Event {
    EvrId id;
    std::string name;
    EventLevel level = EventLevel::diagnostic;
    std::string format;
    std::size_t packet = 0;  ///< index in Dictionary::packets
};

// ---- commands --------------------------------------------------------------------------------------------------

struct Argument {
    std::string name;
    std::string text;
    Type type;
    unsigned position_bits = 0;  ///< from the first octet of the argument field
    std::optional<double> default_value;
};

enum class Significance { none, watch, warning, distress, critical, severe };

/// Evidence that a command reached a stage: an event whose `opcode` field equals the command's.
struct Verifier {
    std::string stage;  ///< "accepted", "executed", "verified"
    EvrId event;
    std::optional<EvrId> failure_event;
    double window_s = 0.0;  ///< from release, light time excluded
};

struct Command {
    Opcode opcode;
    std::string name;
    std::string text;
    Significance significance = Significance::none;
    std::string reason_for_warning;
    std::vector<Argument> arguments;
    unsigned argument_octets = 0;
    std::vector<Precondition> preconditions;
    std::vector<Verifier> verifiers;
};

// ---- timeline, tones, parameters -------------------------------------------------------------------------------

/// Assumption about an action whose reply did not come in time. R50
enum class IfUnverified { done, not_done, done_unless_imu };
constexpr const char* name_of(IfUnverified taken) {
    switch (taken) {
    case IfUnverified::done: return "done";
    case IfUnverified::not_done: return "not_done";
    case IfUnverified::done_unless_imu: return "done_unless_imu";
    }
    return "done";
}

/// A row of timeline.csv. R11, R13
struct TimelineRow {
    TimepointId id;
    std::string name;
    std::optional<AnchorId> anchor;  ///< none: relative to the previous timepoint
    MaybeOffset desired_offset_s;
    MaybeOffset minimum_offset_s;           ///< from the previous timepoint
    std::string action;                     ///< name of a function in aeolis::flight::actions; empty: none
    std::optional<double> reply_timeout_s;  ///< set when the timeline waits for the action's reply
    IfUnverified if_unverified = IfUnverified::done;
    std::optional<double> hold_repeat_s;  ///< set when the timeline is held: interval of repeating the action
    std::string backtrack;                ///< timepoint to return to after a reboot in pre-EDL; empty: none
    bool essential = true;                ///< kept in Second Chance
    bool may_be_late = false;             ///< a "do edl" after its time does no harm: the timepoint then fires at once
    std::optional<ToneId> tone;
    std::string event;  ///< name of an event emitted when the action is done; empty: none
    std::string note;
    unsigned line = 0;  ///< in timeline.csv
};

struct AnchorRow {
    AnchorId id;
    std::string name;
    std::optional<AnchorId> parent;  ///< none: the root
    MaybeOffset offset_s;            ///< from the parent; undefined until flight or a command sets it
    std::string note;
};

enum class ToneSet { prime, second_chance, spare };

/// Prefix of the Second Chance tone with the same meaning: "touchdown" and "sc_touchdown". R35
inline constexpr std::string_view second_chance_prefix = "sc_";
/// Prefix of the prime tone that is sent in a phase while no tone is requested: "heartbeat_sky_crane". R31
inline constexpr std::string_view heartbeat_prefix = "heartbeat_";

struct ToneRow {
    ToneId id;
    ToneSet set = ToneSet::spare;
    std::string name;        ///< empty for spares
    std::string meaning;     ///< for people
    int priority = 0;        ///< larger is more important
    double expires_s = 0.0;  ///< a request older than this is dropped
    std::string supersedes;  ///< name of the tone whose outstanding request is dropped for this one's; empty: none
};

/// A flight parameter: parameters.csv.
struct ParameterRow {
    enum class Change {
        until_gnc,  ///< ground may change it until GNC is enabled
        build,      ///< fixed when flight is built
    };
    ParameterId id;
    std::string name;
    double default_value = 0.0;
    double min = 0.0, max = 0.0;  ///< range that ground may set; the default lies in it
    Change change = Change::until_gnc;
    std::string unit;
    std::string text;
    std::string source;
};

/// A row of state_machines.csv: in the state `from`, `event` leads to the state `to`.
struct StateTransition {
    std::string from, event, to;
    std::string note;
    unsigned line = 0;  ///< in state_machines.csv
};
/// One state machine of flight. Its name is that of the XTCE enumeration whose labels are its states.
struct StateMachineTable {
    std::string name;
    std::string initial;
    std::vector<StateTransition> transitions;
};

/// A row of owners.csv: the one module responsible for a device or a decision. R5
/// The owner of an action stands beside it: flight/timeline/actions.hpp.
struct OwnerRow {
    enum class Kind {
        device,    ///< a part of DeviceOutputs
        decision,  ///< a label of the XTCE enumeration Decision
    };
    Kind kind = Kind::device;
    std::string name;
    std::string module;  ///< an enumerator of flight's ModuleId; the compiler checks it
    std::string note;
    unsigned line = 0;  ///< in owners.csv
};

using timeline::Moment;  // NAME:anchor, NAME:triggered, NAME:fired, do_edl

/// A row of constraints.csv: minimum_s <= to - from <= maximum_s. R19
struct ConstraintRow {
    enum class Kind {
        required,  ///< must follow from the timeline and the given rows
        given,     ///< a bound on the time of an anchor, kept by GNC or by ground's commands
        ensured,   ///< holds in any flight: GNC's own logic sets the anchor no sooner
    };
    Kind kind = Kind::required;
    Moment from, to;
    MaybeOffset minimum_s, maximum_s;  ///< undefined: no bound
    std::string source;
    std::string note;
    unsigned line = 0;  ///< in constraints.csv
};

/// A row of clock_correlation.csv: correlation of SCLK and SCET from `valid_from` to the next row's.
struct ClockRow {
    Sclk valid_from;
    ClockCorrelation correlation;  ///< with the row's version
    std::string note;
    unsigned line = 0;  ///< in clock_correlation.csv
};

// ---- the whole -------------------------------------------------------------------------------------------------

struct Dictionary {
    std::string mission;                 ///< SpaceSystem name
    std::uint16_t id = 0;                ///< in every telemetry packet; changes with any change of a file used on board
    std::uint32_t timeline_version = 0;  ///< in telemetry and archive; changes with any change of the timeline's sheets
    std::vector<Channel> channels;
    std::vector<Packet> packets;
    std::vector<Event> events;
    std::vector<Command> commands;
    std::vector<TimelineRow> timeline;
    std::vector<AnchorRow> anchors;
    std::vector<ToneRow> tones;  ///< 256, by id
    std::vector<ParameterRow> parameters;
    std::vector<ConstraintRow> constraints;
    std::vector<StateMachineTable> state_machines;
    std::vector<OwnerRow> owners;
    std::vector<TelemetryPlanRow> telemetry_plan;
    MfskWaveform mfsk;                                        ///< how tones are sent: mfsk.csv
    std::vector<ClockRow> clock;                              ///< by valid_from. Used by ground only, like the next
    std::vector<std::optional<double>> predicted_anchor_e_s;  ///< by anchor: seconds from entry; none: not predicted
    std::shared_ptr<const xtce::PacketModel> model;           ///< what `packets` were made of, and are decoded by

    const Channel* channel(std::string_view name_or_alias) const;
    const Command* command(std::string_view name) const;
    const Command* command(Opcode opcode) const;
    const Event* event(EvrId id) const;
    const Event* event(std::string_view name) const;
    const Packet* packet(std::string_view name) const;
    /// The correlation that holds at `t`; none before the first row.
    const ClockCorrelation* clock_at(Sclk t) const;
};

/// One broken rule: "timeline.csv:12: timepoint 'x': desired offset 0.3 s is not a multiple of 1/64 s".
struct Finding {
    std::string file;
    unsigned line = 0;
    std::string message;
    std::string text() const;
};

/// The whole dictionary of a mission's folder, or every rule that the folder breaks.
struct Loaded {
    std::optional<Dictionary> dictionary;  ///< none when there are findings
    std::vector<Finding> findings;
};

/// Loads and checks a mission's dictionary: one XTCE file (*.xml with one SpaceSystem) and the sheets.
///
/// Used on board   timeline.csv, anchors.csv, tones.csv, mfsk.csv, parameters.csv, constraints.csv, state_machines.csv,
///                 owners.csv, telemetry_plan.csv and the XTCE file. `id` changes with each of them, `timeline_version`
///                 only with the timeline's own two, timeline.csv and anchors.csv.
/// Ground only     clock_correlation.csv, predicted_anchors.csv. They change neither number.
///
/// `directory` may also be one file that holds them all: dictionaries/mission_files.hpp.
Loaded load(const std::filesystem::path& directory);

}  // namespace aeolis::dictionary
