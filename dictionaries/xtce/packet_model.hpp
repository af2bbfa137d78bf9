// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"
#include "dictionaries/findings.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

/// Packets of any mission, as its XTCE file describes them.
/// Packets are decoded by it: telemetry/container_plan.hpp, telemetry/container_decoder.hpp. Here, unreadable content
/// is a finding, and everything else is kept. Rules for our own dictionary, which flight's code is made from, stand
/// beside it: space_system.hpp. [xtce-1.2], and files of 1.0 and 1.1
namespace aeolis::dictionary::xtce {

/// A comparison, or a combination of several.
struct Condition {
    enum class Form : std::uint8_t {
        always,
        compare,
        all,      ///< of `parts`: all must hold
        any,      ///< of `parts`: one must hold
        unknown,  ///< not supported: whether it holds is not known
    };
    enum class Operator : std::uint8_t { equal, not_equal, less, less_or_equal, greater, greater_or_equal };

    Form form = Form::always;
    std::vector<Condition> parts{};
    std::size_t parameter = 0;  ///< index in PacketModel::parameters; its latest value in the packet
    std::string member{};       ///< of a composite value: ".flags.valid", as the decoder names it
    bool calibrated = true;
    Operator op = Operator::equal;
    std::string value{};    ///< a number, a label or a text
    bool by_label = false;  ///< `value` is a label of the parameter's type, even where it reads as a number
};

/// A number of bits, octets or repetitions: fixed, or computed from the packet.
struct Amount {
    struct Case {
        Condition when{};
        double value = 0.0;
    };
    std::optional<std::size_t> parameter{};  ///< intercept + slope × its value
    std::string member{};                    ///< of a composite value: ".length"
    std::string sibling{};                   ///< instead of a parameter: a member of the aggregate that it is part of
    bool calibrated = true;
    double slope = 1.0;
    double intercept = 0.0;     ///< without parameter: the amount itself
    std::vector<Case> cases{};  ///< if not empty: the amount is that of the first case that holds
    bool known = true;          ///< false: not supported

    static Amount fixed(double value) { return {.intercept = value}; }
    bool is_fixed() const { return known && !parameter && sibling.empty() && cases.empty(); }
};

struct Calibration {
    std::vector<double> polynomial{};                 ///< coefficient of each power
    std::vector<std::pair<double, double>> spline{};  ///< raw, calibrated; sorted; linear between points
    bool flat = false;                                ///< spline of order 0: steps
    bool extrapolate = false;                         ///< also applies outside the points; false: undefined there
    bool known = true;                                ///< false: not supported; the value is undefined
    bool empty() const { return known && polynomial.empty() && spline.empty(); }
};

struct Coding {
    enum class Form : std::uint8_t {
        unsigned_integer,
        twos_complement,
        ones_complement,
        sign_and_magnitude,
        bcd,         ///< four bits per decimal digit
        bcd_octets,  ///< an octet per decimal digit
        ieee754,
        mil1750a,
        text,
        octets,
    };
    enum class Characters : std::uint8_t { utf8, latin1, utf16_big_endian, utf16_little_endian };

    Form form = Form::unsigned_integer;
    Characters characters = Characters::utf8;  ///< of text; US-ASCII is a part of it
    Amount bits{};                             ///< of text and octets: without terminator or leading size
    double most_bits = 0.0;                    ///< of text in a box: it is never longer; 0: as long as the box
    bool least_significant_octet_first = false;
    bool least_significant_bit_first = false;
    std::vector<std::uint8_t> terminator{};  ///< a character that ends the text; `bits` is then its maximum size
    unsigned leading_size_bits = 0;          ///< text: size in bits of the leading field that holds its size …
    unsigned leading_size_unit_bits = 1;     ///< … in units of so many bits
    bool boxed = true;                       ///< text always takes `bits`, even where it ends before; false: only as
                                             ///< many as it needs
    Calibration calibration{};
    struct Context {
        Condition when;
        Calibration calibration;
    };
    std::vector<Context> contexts{};  ///< the first that holds replaces `calibration`
};

struct PacketType {
    enum class Kind : std::uint8_t {
        integer,
        real,
        enumerated,
        boolean,
        text,
        octets,
        time,
        aggregate,
        array,
        unknown
    };
    struct Label {
        std::int64_t first = 0;
        std::int64_t last = 0;
        std::string label;
        unsigned line = 0;
    };
    struct Member {
        std::string name;
        std::size_t type = 0;
    };
    struct ContextAlarm {
        Condition when;
        Alarms alarms;
    };

    std::string name{};
    unsigned line = 0;
    Kind kind = Kind::unknown;  ///< unknown: not supported; a packet is decoded only up to such a field
    bool unread = false;        ///< what its values are is not understood: they are octets, or undefined
    bool uncoded = false;       ///< it has no encoding, as of what ground derives: it can be in no packet
    std::string unit{};         ///< the first one; empty: the file gives none
    Coding coding{};
    std::vector<Label> labels{};
    std::optional<double> valid_min{}, valid_max{};
    Alarms alarms{};                             ///< without contexts
    std::vector<ContextAlarm> context_alarms{};  ///< the first that holds replaces `alarms`
    std::string zero = "False", one = "True";    ///< of a boolean
    double time_offset_s = 0.0, time_scale_s = 1.0;
    bool relative = false;  ///< of a time: a duration, or a time since something other than an epoch
    std::string epoch{};    ///< of a time: "UNIX", "TAI", "GPS", "J2000", a date; empty: the file does not say
    std::optional<std::size_t> time_since{};  ///< of a time: counts from the time in this parameter
    std::vector<Member> members{};
    std::size_t element = 0;             ///< type of an array's elements
    std::vector<Amount> last_indices{};  ///< of an array's dimensions, which begin at 0
};

struct PacketParameter {
    std::string name;      ///< unique in a packet of another mission: its path where an earlier one has the name
    std::string path;      ///< "/MSL/Events/opcode": unique
    std::size_t type = 0;  ///< in PacketModel::types
    Condition valid{};     ///< where it is false, the value is undefined
    unsigned line = 0;
};

struct PacketEntry {
    enum class What : std::uint8_t {
        parameter,
        container,
        around,  ///< a container that holds this one, and is never read in it
        unknown,
    };
    enum class From : std::uint8_t { previous, container_start };

    What what = What::unknown;
    std::size_t index = 0;  ///< of the parameter or container
    From from = From::previous;
    Amount offset_bits = Amount::fixed(0);
    Condition when{};
    Amount count = Amount::fixed(1);
    Amount gap_bits = Amount::fixed(0);  ///< between repetitions
    std::vector<Amount> last_indices{};  ///< of an array whose dimensions are given here
    unsigned line = 0;
};

struct PacketContainer {
    std::string name;
    std::string path;  ///< unique
    unsigned line = 0;
    bool abstract = false;
    std::optional<std::size_t> base{};
    Condition when{};  ///< on the fields of the base
    std::vector<PacketEntry> entries{};
    std::optional<Amount> bits{};  ///< from its start to what follows it; none: up to the end of its entries
    std::optional<double> expected_rate_hz{};  ///< at least; none: the file promises none
};

struct PacketModel {
    std::string name;
    std::vector<PacketType> types;
    std::vector<PacketParameter> parameters;
    std::vector<PacketContainer> containers;
    std::optional<std::size_t> root{};  ///< the container with which packets begin, where the file leaves it open
};

/// Properties of a file that it does not state itself.
struct ReadAgreement {
    unsigned leading_size_unit_bits = 1;  ///< LeadingSize counts bits (1, by [xtce-1.2]) or octets (8)
};

/// The bits of a number, octets or repetitions where they are fixed: a whole number up to a million.
std::optional<std::size_t> fixed_amount(const Amount& amount);
/// A type of numbers, labels, text or octets in the words of the dictionary.
Type field_type(const PacketType& type);

struct XtceText {
    std::string file;  ///< for findings
    std::string text;
};

/// Reads the model of one mission from its files, whose SpaceSystems may refer to each other. Its name is the first
/// file's. None when a text is not XTCE; unsupported or wrong content becomes findings with file and line.
std::optional<PacketModel> read_packet_model(const std::vector<XtceText>& texts, std::vector<Finding>& findings,
                                             const ReadAgreement& agreement = {});
/// Reads the model from one text.
std::optional<PacketModel> read_packet_model(const std::string& text, Findings& findings);

}  // namespace aeolis::dictionary::xtce
