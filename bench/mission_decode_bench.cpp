// SPDX-License-Identifier: Apache-2.0
// Measures how fast another mission's packets become channel values, by its XTCE, against decoders of the same
// containers written by hand. Fixed layouts: 48 numbers; these and a text; these and numbers calibrated by context.
// Dynamic ones: these and numbers that a condition includes; a list and an array as long as the packet says; texts.
#include "telemetry/other_mission.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <span>
#include <string>
#include <vector>

namespace {

using namespace aeolis;

constexpr double fixed_goal = 0.5, dynamic_goal = 0.25;
constexpr std::size_t packets = 4096, list_max = 12, data_octet = 12, box_octets = 12;
constexpr std::size_t octets_max = 256;
constexpr std::size_t fixed_octets = 8 * (1 + 2 + 2 + 4 + 8 + 2);
constexpr int rounds = 100, parts = 5;

using Packets = std::vector<std::vector<std::uint8_t>>;

std::string entry(const std::string& parameter, const std::string& more = "") {
    return "<ParameterRefEntry parameterRef='" + parameter + "'>" + more + "</ParameterRefEntry>";
}

std::string container(const std::string& name, std::uint8_t apid, const std::string& entries) {
    return "<SequenceContainer name='" + name + "'><EntryList>" + entries +
           "</EntryList><BaseContainer containerRef='Header'><RestrictionCriteria><Comparison parameterRef='apid' "
           "value='" +
           std::to_string(apid) + "'/></RestrictionCriteria></BaseContainer></SequenceContainer>";
}

std::string polynomial(double offset, double slope) {
    return "<PolynomialCalibrator><Term coefficient='" + std::to_string(offset) +
           "' exponent='0'/><Term coefficient='" + std::to_string(slope) + "' exponent='1'/></PolynomialCalibrator>";
}

std::string types_text() {
    const auto integer = [](const char* name, int bits, const char* more = "") {
        return "<IntegerParameterType name='" + std::string(name) + "'><IntegerDataEncoding sizeInBits='" +
               std::to_string(bits) + "' " + more + "/></IntegerParameterType>";
    };
    const auto text = [](const char* name, const char* size) {
        return "<StringParameterType name='" + std::string(name) + "'><StringDataEncoding><SizeInBits>" + size +
               "</SizeInBits></StringDataEncoding></StringParameterType>";
    };
    const std::string by_default = "<DefaultCalibrator>" + polynomial(-40, 0.025) + "</DefaultCalibrator>";
    return integer("u5", 5) + integer("u11", 11) + integer("u32", 32) + integer("u8", 8) + integer("u16", 16) +
           integer("i16", 16, "encoding='twosComplement'") +
           "<FloatParameterType name='f32'><FloatDataEncoding sizeInBits='32'/></FloatParameterType>"
           "<FloatParameterType name='f64'><FloatDataEncoding sizeInBits='64'/></FloatParameterType>"
           "<FloatParameterType name='cal'><IntegerDataEncoding sizeInBits='16'>" +
           by_default +
           "</IntegerDataEncoding></FloatParameterType>"
           "<FloatParameterType name='ctx'><IntegerDataEncoding sizeInBits='16'>" +
           by_default +
           "<ContextCalibratorList><ContextCalibrator><ContextMatch><Comparison parameterRef='mode' value='COLD'/>"
           "</ContextMatch><Calibrator>" +
           polynomial(-80, 0.0125) +
           "</Calibrator></ContextCalibrator></ContextCalibratorList></IntegerDataEncoding></FloatParameterType>"
           "<EnumeratedParameterType name='mode'><IntegerDataEncoding sizeInBits='8'/><EnumerationList>"
           "<Enumeration value='0' label='WARM'/><Enumeration value='1' label='COLD'/></EnumerationList>"
           "</EnumeratedParameterType>" +
           text("boxed", "<Fixed><FixedValue>96</FixedValue></Fixed>") +
           text("ended", "<TerminationChar>00</TerminationChar>") +
           text("sized", "<LeadingSize sizeInBitsOfSizeTag='16'/>") +
           "<ArrayParameterType name='samples' arrayTypeRef='u16'><DimensionList><Dimension><StartingIndex><FixedValue>"
           "0</FixedValue></StartingIndex><EndingIndex><DynamicValue><ParameterInstanceRef parameterRef='N'/>"
           "<LinearAdjustment intercept='-1'/></DynamicValue></EndingIndex></Dimension></DimensionList>"
           "</ArrayParameterType>";
}

std::string xtce_text() {
    std::string parameters, fixed, in_context, of_reals;
    const auto add = [&](const std::string& name, const std::string& type) {
        parameters += "<Parameter name='" + name + "' parameterTypeRef='" + type + "'/>";
    };
    // Eight fields of each kind: whole numbers of 8 and 16 bits, signed of 16, reals of 32 and 64, and calibrated ones.
    for (const std::string type : {"u8", "u16", "i16", "f32", "f64", "cal"})
        for (int i = 0; i < 8; ++i) {
            add(type + "_" + std::to_string(i), type);
            fixed += entry(type + "_" + std::to_string(i));
        }
    for (int i = 0; i < 8; ++i) {
        add("ctx_" + std::to_string(i), "ctx");
        in_context += entry("ctx_" + std::to_string(i));
        add("cold_" + std::to_string(i), "f32");
        of_reals += entry("cold_" + std::to_string(i),
                          "<IncludeCondition><Comparison parameterRef='mode' value='COLD'/></IncludeCondition>");
    }
    for (const auto& [name, type] : {std::pair{"first", "u5"},
                                     {"apid", "u11"},
                                     {"rest", "u32"},
                                     {"COARSE", "u32"},
                                     {"FINE", "u16"},
                                     {"N", "u8"},
                                     {"list", "u16"},
                                     {"samples", "samples"},
                                     {"mode", "mode"},
                                     {"boxed", "boxed"},
                                     {"ended", "ended"},
                                     {"sized", "sized"},
                                     {"last", "u16"}})
        add(name, type);
    const std::string repeat =
        "<RepeatEntry><Count><DynamicValue><ParameterInstanceRef parameterRef='N'/></DynamicValue></Count>"
        "</RepeatEntry>";
    return "<SpaceSystem name='Bench'><TelemetryMetaData><ParameterTypeSet>" + types_text() +
           "</ParameterTypeSet><ParameterSet>" + parameters +
           "</ParameterSet><ContainerSet><SequenceContainer name='Header' abstract='true'><EntryList>" +
           entry("first") + entry("apid") + entry("rest") + entry("COARSE") + entry("FINE") +
           "</EntryList></SequenceContainer>" + container("Fixed", 100, fixed) +
           container("List", 101, entry("N") + entry("list", repeat)) +
           container("Texts", 102, entry("boxed") + entry("ended") + entry("sized") + entry("last")) +
           container("Condition", 103, fixed + entry("mode") + of_reals + entry("last")) +
           container("Array", 104, entry("N") + entry("samples") + entry("last")) +
           container("Context", 105, fixed + entry("mode") + in_context) +
           container("Text", 106, fixed + entry("boxed")) + "</ContainerSet></TelemetryMetaData></SpaceSystem>";
}

/// Packets of an APID with noise behind their header and time; `shape` completes the one of a number.
template <typename Shape>
Packets packets_of(std::uint8_t apid, Shape shape) {
    Packets made;
    std::uint32_t noise = 1;
    for (std::size_t i = 0; i < packets; ++i) {
        std::vector<std::uint8_t> octets;
        octets.reserve(octets_max);
        octets.assign(data_octet, 0);
        const auto add = [&](std::size_t count) {
            for (; count > 0; --count)
                octets.push_back(static_cast<std::uint8_t>((noise = noise * 1664525U + 1013904223U) >> 25));
        };
        shape(i, octets, add);
        octets[0] = 0;
        octets[1] = apid;
        octets[4] = 0;
        octets[5] = static_cast<std::uint8_t>(octets.size() - 7);
        made.push_back(std::move(octets));
    }
    return made;
}

/// Calls `each` on every packet repeatedly; returns the best rate of some parts, by processor time of this process.
template <typename Each>
double rate_per_s(const Packets& octets, Each each) {
    double best = 0.0;
    for (int part = 0; part < parts; ++part) {
        const std::clock_t start = std::clock();
        for (int round = 0; round < rounds / parts; ++round)
            for (const auto& packet : octets) each(packet);
        const double took_s = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
        best = std::max(best, static_cast<double>(rounds / parts) * static_cast<double>(octets.size()) / took_s);
    }
    return best;
}

// ---- by hand: the same fields, to the same form ------------------------------------------------------------------

struct Cursor {
    const std::uint8_t* at;
    std::uint64_t take(unsigned octets) {
        std::uint64_t value = 0;
        for (unsigned i = 0; i < octets; ++i) value = value << 8 | *at++;
        return value;
    }
};

/// The fields of a packet, one after another.
struct Fields {
    dictionary::Decoded& into;
    std::size_t next = 0;
    void put(std::uint64_t raw, double value) {
        into.raw[next] = raw;
        if (std::isfinite(value)) into.value[next] = value;
        ++next;
    }
    void whole(std::uint64_t raw) { put(raw, static_cast<double>(raw)); }
    /// Octets of noise are characters of one octet.
    void text(const std::uint8_t* at, std::size_t octets) {
        while (octets > 0 && at[octets - 1] == 0) --octets;
        into.texts.emplace_back(next++, std::string{at, at + octets});
    }
};

bool begins(std::span<const std::uint8_t> packet, std::uint8_t apid, Fields& fields, std::size_t count) {
    if (packet.size() < data_octet + 1 || packet[1] != apid) return false;
    dictionary::Decoded& into = fields.into;
    into.raw.assign(count, 0);
    into.value.assign(count, std::nullopt);
    into.texts.clear();
    Cursor cursor{packet.data() + 6};
    into.header.time.seconds = static_cast<double>(cursor.take(4));
    into.header.time.seconds += static_cast<double>(cursor.take(2)) / 65536.0;
    fields.whole(static_cast<std::uint64_t>(packet[0] >> 3U));
    fields.whole(static_cast<std::uint64_t>((packet[0] & 7U) << 8U | packet[1]));
    fields.whole(Cursor{packet.data() + 2}.take(4));
    fields.whole(Cursor{packet.data() + 6}.take(4));
    fields.whole(Cursor{packet.data() + 10}.take(2));
    return true;
}

double real_32(Cursor& cursor) {
    return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(cursor.take(4))));
}

void put_fixed(Cursor& cursor, Fields& fields) {
    for (int i = 0; i < 8; ++i) fields.whole(cursor.take(1));
    for (int i = 0; i < 8; ++i) fields.whole(cursor.take(2));
    for (int i = 0; i < 8; ++i) fields.put(0, static_cast<std::int16_t>(cursor.take(2)));
    for (int i = 0; i < 8; ++i) fields.put(0, real_32(cursor));
    for (int i = 0; i < 8; ++i) fields.put(0, std::bit_cast<double>(cursor.take(8)));
    for (int i = 0; i < 8; ++i) {
        const auto raw = cursor.take(2);
        fields.put(raw, -40.0 + 0.025 * static_cast<double>(raw));
    }
}

bool fixed_by_hand(std::span<const std::uint8_t> packet, dictionary::Decoded& into) {
    Fields fields{into};
    if (packet.size() != data_octet + fixed_octets || !begins(packet, 100, fields, 5 + 48)) return false;
    Cursor cursor{packet.data() + data_octet};
    put_fixed(cursor, fields);
    return true;
}

bool text_by_hand(std::span<const std::uint8_t> packet, dictionary::Decoded& into) {
    Fields fields{into};
    if (packet.size() != data_octet + fixed_octets + box_octets || !begins(packet, 106, fields, 5 + 48 + 1))
        return false;
    Cursor cursor{packet.data() + data_octet};
    put_fixed(cursor, fields);
    fields.text(cursor.at, box_octets);
    return true;
}

/// A number of numbers, these, and perhaps one more.
bool counted_by_hand(std::span<const std::uint8_t> packet, std::uint8_t apid, bool one_more,
                     dictionary::Decoded& into) {
    Fields fields{into};
    if (!begins(packet, apid, fields, 6 + 16 + (one_more ? 1 : 0))) return false;
    const std::size_t count = packet[data_octet];
    if (packet.size() != data_octet + 1 + 2 * (count + (one_more ? 1 : 0)) || count > 16) return false;
    fields.whole(count);
    Cursor cursor{packet.data() + data_octet + 1};
    for (std::size_t i = 0; i < count; ++i) fields.whole(cursor.take(2));
    fields.next = 6 + 16;
    if (one_more) fields.whole(cursor.take(2));
    return true;
}

bool list_by_hand(std::span<const std::uint8_t> packet, dictionary::Decoded& into) {
    return counted_by_hand(packet, 101, false, into);
}

bool array_by_hand(std::span<const std::uint8_t> packet, dictionary::Decoded& into) {
    return counted_by_hand(packet, 104, true, into);
}

bool texts_by_hand(std::span<const std::uint8_t> packet, dictionary::Decoded& into) {
    Fields fields{into};
    if (packet.size() < data_octet + box_octets + 1 || !begins(packet, 102, fields, 5 + 4)) return false;
    const std::uint8_t* at = packet.data() + data_octet;
    const std::uint8_t* const end = packet.data() + packet.size();
    fields.text(at, box_octets);
    at += box_octets;
    const std::uint8_t* const zero = std::find(at, end, std::uint8_t{0});
    if (end - zero < 1 + 2) return false;
    fields.text(at, static_cast<std::size_t>(zero - at));
    at = zero + 1;
    const std::size_t size = Cursor{at}.take(2) / 8;
    if (static_cast<std::size_t>(end - at) != 2 + size + 2) return false;
    fields.text(at + 2, size);
    fields.whole(Cursor{at + 2 + size}.take(2));
    return true;
}

bool condition_by_hand(std::span<const std::uint8_t> packet, dictionary::Decoded& into) {
    Fields fields{into};
    if (packet.size() <= data_octet + fixed_octets || !begins(packet, 103, fields, 5 + 48 + 1 + 8 + 1)) return false;
    const bool cold = packet[data_octet + fixed_octets] == 1;
    if (packet.size() != data_octet + fixed_octets + 1 + (cold ? 32 : 0) + 2) return false;
    Cursor cursor{packet.data() + data_octet};
    put_fixed(cursor, fields);
    fields.whole(cursor.take(1));
    for (int i = 0; cold && i < 8; ++i) fields.put(0, real_32(cursor));
    fields.next = 5 + 48 + 1 + 8;
    fields.whole(cursor.take(2));
    return true;
}

bool context_by_hand(std::span<const std::uint8_t> packet, dictionary::Decoded& into) {
    Fields fields{into};
    if (packet.size() != data_octet + fixed_octets + 1 + 16 || !begins(packet, 105, fields, 5 + 48 + 1 + 8))
        return false;
    Cursor cursor{packet.data() + data_octet};
    put_fixed(cursor, fields);
    const bool cold = *cursor.at == 1;
    fields.whole(cursor.take(1));
    for (int i = 0; i < 8; ++i) {
        const auto raw = cursor.take(2);
        fields.put(raw, (cold ? -80.0 : -40.0) + (cold ? 0.0125 : 0.025) * static_cast<double>(raw));
    }
    return true;
}

}  // namespace

int main() {
    std::vector<dictionary::Finding> findings;
    dictionary::Findings into{"bench.xml", findings};
    auto model = dictionary::xtce::read_packet_model(xtce_text(), into);
    if (!model || !findings.empty()) return 1;
    const telemetry::OtherMission mission{std::move(*model), 1};

    bool reached = true;
    std::uint64_t sum = 0, wrong = 0;
    const auto compare = [&](const char* name, const Packets& octets, auto by_hand, double goal) {
        dictionary::Decoded decoded, expected;
        for (const auto& packet : octets)
            if (mission.decode(packet, decoded) || !by_hand(packet, expected) || decoded.value != expected.value ||
                decoded.texts != expected.texts)
                ++wrong;
        const double rate = rate_per_s(octets, [&](const auto& packet) {
            mission.decode(packet, decoded);
            sum += decoded.raw[1];
        });
        const double limit = rate_per_s(octets, [&](const auto& packet) {
            by_hand(packet, expected);
            sum += expected.raw[1];
        });
        std::printf("%-9s by XTCE %10.0f /s   by hand %10.0f /s   ratio %.2f   goal %.2f\n", name, rate, limit,
                    rate / limit, goal);
        reached = reached && rate / limit >= goal;
    };
    const auto counted = [](bool one_more) {
        return [one_more](std::size_t i, auto& octets, auto add) {
            octets.push_back(static_cast<std::uint8_t>(i % (list_max + 1)));
            add(2 * (octets.back() + (one_more ? 1 : 0)));
        };
    };
    const auto noise = [](std::size_t count) { return [count](std::size_t, auto&, auto add) { add(count); }; };
    const auto texts = [](std::size_t i, auto& octets, auto add) {
        const auto letters = [&](std::size_t count) {
            for (; count > 0; --count) octets.push_back(static_cast<std::uint8_t>('A' + (i + count) % 26));
        };
        letters(box_octets);
        letters(i % 20);
        octets.push_back(0);
        octets.push_back(0);
        octets.push_back(static_cast<std::uint8_t>(8 * (i % 24)));
        letters(i % 24);
        add(2);
    };
    const auto moded = [](std::size_t warm_octets, std::size_t cold_octets) {
        return [warm_octets, cold_octets](std::size_t i, auto& octets, auto add) {
            add(fixed_octets);
            octets.push_back(i % 3 == 0 ? 1 : 0);
            add(i % 3 == 0 ? cold_octets : warm_octets);
        };
    };
    compare("fixed", packets_of(100, noise(fixed_octets)), fixed_by_hand, fixed_goal);
    compare("text", packets_of(106, noise(fixed_octets + box_octets)), text_by_hand, fixed_goal);
    compare("context", packets_of(105, moded(16, 16)), context_by_hand, fixed_goal);
    compare("condition", packets_of(103, moded(2, 34)), condition_by_hand, dynamic_goal);
    compare("list", packets_of(101, counted(false)), list_by_hand, dynamic_goal);
    compare("array", packets_of(104, counted(true)), array_by_hand, dynamic_goal);
    compare("texts", packets_of(102, texts), texts_by_hand, dynamic_goal);
    if (wrong > 0) std::printf("%llu packets differ\n", static_cast<unsigned long long>(wrong));
    std::printf("(%llu)\n", static_cast<unsigned long long>(sum & 1U));
    return reached && wrong == 0 ? 0 : 1;
}
