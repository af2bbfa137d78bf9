// SPDX-License-Identifier: Apache-2.0
// What ContainerPlan compiles, held against ContainerDecoder on seeded random packets: whole ones, and those that are
// an octet shorter or longer.
#include "telemetry/container_plan.hpp"
#include "telemetry/other_mission.hpp"
#include "tests/support/catch.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <memory>
#include <random>

namespace telemetry_compiled_constructs_test {

using namespace aeolis;
using namespace aeolis::telemetry;
using dictionary::xtce::PacketModel;

namespace {

using Octets = std::vector<std::uint8_t>;

std::string number(const std::string& name, int bits, const std::string& more = "", const std::string& inner = "") {
    return "<IntegerParameterType name='" + name + "'><IntegerDataEncoding sizeInBits='" + std::to_string(bits) + "' " +
           more + ">" + inner + "</IntegerDataEncoding></IntegerParameterType>";
}
std::string text_type(const std::string& name, const std::string& size, const std::string& more = "") {
    return "<StringParameterType name='" + name + "'><StringDataEncoding " + more + ">" + size +
           "</StringDataEncoding></StringParameterType>";
}
std::string by(const std::string& parameter, const std::string& line = "") {
    return "<DynamicValue><ParameterInstanceRef parameterRef='" + parameter + "'/>" + line + "</DynamicValue>";
}
std::string array_type(const std::string& name, const std::string& element, const std::string& last_indices) {
    return "<ArrayParameterType name='" + name + "' arrayTypeRef='" + element + "'><DimensionList>" + last_indices +
           "</DimensionList></ArrayParameterType>";
}
std::string up_to(const std::string& last) {
    return "<Dimension><StartingIndex><FixedValue>0</FixedValue></StartingIndex><EndingIndex>" + last +
           "</EndingIndex></Dimension>";
}
std::string compare(const std::string& parameter, const std::string& op, const std::string& value,
                    const std::string& more = "") {
    return "<Comparison parameterRef='" + parameter + "' comparisonOperator='" + op + "' value='" + value + "' " +
           more + "/>";
}
std::string entry(const std::string& parameter, const std::string& inner = "") {
    return "<ParameterRefEntry parameterRef='" + parameter + "'>" + inner + "</ParameterRefEntry>";
}
std::string when(const std::string& condition) {
    return "<IncludeCondition>" + condition + "</IncludeCondition>";
}
std::string repeat(const std::string& count) {
    return "<RepeatEntry><Count>" + count + "</Count></RepeatEntry>";
}
std::string at(const std::string& from, const std::string& offset) {
    return "<LocationInContainerInBits referenceLocation='" + from + "'>" + offset + "</LocationInContainerInBits>";
}
std::string fixed(int value) {
    return "<FixedValue>" + std::to_string(value) + "</FixedValue>";
}
std::string line(double slope, double intercept) {
    return "<PolynomialCalibrator><Term exponent='0' coefficient='" + std::to_string(intercept) +
           "'/><Term exponent='1' coefficient='" + std::to_string(slope) + "'/></PolynomialCalibrator>";
}
std::string context(const std::string& condition, const std::string& calibrator) {
    return "<ContextCalibrator><ContextMatch>" + condition + "</ContextMatch><Calibrator>" + calibrator +
           "</Calibrator></ContextCalibrator>";
}

const std::string spline =
    "<SplineCalibrator><SplinePoint raw='1' calibrated='-2'/><SplinePoint raw='3' calibrated='5'/></SplineCalibrator>";
const std::string count_of_a = by("a");

/// Types and parameters that every mission here has.
std::string types() {
    const std::string box = "<SizeInBits><Fixed><FixedValue>24</FixedValue></Fixed>";
    const std::string sizes_in_octets = "<LinearAdjustment slope='8'/>";
    return number("u2", 2) + number("u3", 3) + number("u8", 8) + number("u16", 16) + number("u24", 24) +
           number("u64", 64) + number("i8", 8, "encoding='twosComplement'") + number("bcd", 8, "encoding='BCD'") +
           number("little", 16, "byteOrder='leastSignificantByteFirst'") +
           number("doubled", 8, "", "<DefaultCalibrator>" + line(2, 0) + "</DefaultCalibrator>") +
           "<FloatParameterType name='f32'><FloatDataEncoding sizeInBits='32'/></FloatParameterType>"
           "<FloatParameterType name='between'><IntegerDataEncoding sizeInBits='8'><DefaultCalibrator>" +
           spline +
           "</DefaultCalibrator></IntegerDataEncoding></FloatParameterType>"
           "<AbsoluteTimeParameterType name='days'><Encoding units='days' offset='3'><IntegerDataEncoding "
           "sizeInBits='16'/></Encoding><ReferenceTime><Epoch>TAI</Epoch></ReferenceTime></AbsoluteTimeParameterType>"
           "<AbsoluteTimeParameterType name='seconds'><Encoding scale='0.5'><FloatDataEncoding sizeInBits='32'/>"
           "</Encoding><ReferenceTime><Epoch>GPS</Epoch></ReferenceTime></AbsoluteTimeParameterType>"
           "<RelativeTimeParameterType name='span'><Encoding><IntegerDataEncoding sizeInBits='8'/></Encoding>"
           "</RelativeTimeParameterType><AggregateParameterType name='timed'><MemberList><Member name='of' "
           "typeRef='days'/></MemberList></AggregateParameterType>"
           "<BooleanParameterType name='flag' zeroStringValue='OFF' oneStringValue='ON'><IntegerDataEncoding "
           "sizeInBits='8'/></BooleanParameterType>"
           "<EnumeratedParameterType name='mode'><IntegerDataEncoding sizeInBits='8'/><EnumerationList><Enumeration "
           "value='0' label='ZERO'/><Enumeration value='1' label='ONE'/><Enumeration value='2' maxValue='4' "
           "label='SOME'/><Enumeration value='7' label='ONE'/></EnumerationList></EnumeratedParameterType>"
           "<FloatParameterType name='ctx'><IntegerDataEncoding sizeInBits='8'><DefaultCalibrator>" +
           line(1, 100) + "</DefaultCalibrator><ContextCalibratorList>" +
           context(compare("m", "==", "ONE"), line(0.5, -1)) + context(compare("a", "&gt;", "2"), spline) +
           context(compare("x", "==", "0"), line(3, 3)) +
           "</ContextCalibratorList></IntegerDataEncoding></FloatParameterType>"
           "<IntegerParameterType name='ictx'><IntegerDataEncoding sizeInBits='8'><ContextCalibratorList>" +
           context(compare("m", "!=", "SOME"), line(2, 1)) +
           "</ContextCalibratorList></IntegerDataEncoding></IntegerParameterType>" +
           text_type("boxed", box + "</SizeInBits>") +
           text_type("boxed_ended", box + "<TerminationChar>00</TerminationChar></SizeInBits>") +
           text_type("boxed_sized", box + "<LeadingSize sizeInBitsOfSizeTag='8'/></SizeInBits>") +
           text_type("ended", "<SizeInBits><TerminationChar>00</TerminationChar></SizeInBits>") +
           text_type("ended_most", "<Variable maxSizeInBits='24'><TerminationChar>41</TerminationChar></Variable>") +
           text_type("wide", "<Variable maxSizeInBits='64'><TerminationChar>0000</TerminationChar></Variable>",
                     "encoding='UTF-16BE'") +
           text_type("latin", box + "</SizeInBits>", "encoding='ISO-8859-1'") +
           text_type("sized", "<SizeInBits><LeadingSize sizeInBitsOfSizeTag='8'/></SizeInBits>") +
           text_type("by_a", "<Variable maxSizeInBits='640'>" + by("a", sizes_in_octets) + "</Variable>") +
           text_type("by_bits", "<Variable maxSizeInBits='640'>" + by("a") + "</Variable>") +
           text_type("looked_up", "<SizeInBits><DiscreteLookupList defaultValue='16'><DiscreteLookup value='8'>" +
                                      compare("a", "==", "1") + "</DiscreteLookup><DiscreteLookup value='24'>" +
                                      compare("m", "==", "SOME") +
                                      "</DiscreteLookup></DiscreteLookupList></SizeInBits>") +
           text_type("by_sibling",
                     "<Variable maxSizeInBits='640'><DynamicValue><ParameterInstanceRef parameterRef='n' "
                     "y:aggregateMember='true'/><LinearAdjustment slope='8'/></DynamicValue></Variable>") +
           "<BinaryParameterType name='blob'><BinaryDataEncoding><SizeInBits>" + by("a", sizes_in_octets) +
           "</SizeInBits></BinaryDataEncoding></BinaryParameterType>"
           "<BinaryParameterType name='blob3'><BinaryDataEncoding><SizeInBits>" +
           fixed(24) +
           "</SizeInBits></BinaryDataEncoding></BinaryParameterType>"
           "<AggregateParameterType name='pair'><MemberList><Member name='p' typeRef='u8'/><Member name='q' "
           "typeRef='u3'/><Member name='r' typeRef='f32'/></MemberList></AggregateParameterType>"
           "<AggregateParameterType name='named'><MemberList><Member name='n' typeRef='u8'/><Member name='name' "
           "typeRef='by_sibling'/></MemberList></AggregateParameterType>" +
           array_type("three", "u8", up_to(fixed(2))) + array_type("table", "u3", up_to(fixed(1)) + up_to(fixed(2))) +
           array_type("many", "u8", up_to(by("a", "<LinearAdjustment intercept='-1'/>"))) +
           array_type("longs", "u64", up_to(by("a", "<LinearAdjustment intercept='-1'/>"))) +
           array_type("pairs", "pair", up_to(by("a", "<LinearAdjustment intercept='-1'/>"))) +
           array_type("texts", "ended", up_to(count_of_a)) + array_type("two_pairs", "pair", up_to(fixed(1)));
}

const std::vector<std::pair<std::string, std::string>> parameters{{"a", "u8"},
                                                                  {"b", "u8"},
                                                                  {"x", "f32"},
                                                                  {"m", "mode"},
                                                                  {"on", "flag"},
                                                                  {"odd", "u3"},
                                                                  {"big", "u64"},
                                                                  {"s", "i8"},
                                                                  {"digits", "bcd"},
                                                                  {"twice", "doubled"},
                                                                  {"some", "between"},
                                                                  {"l", "little"},
                                                                  {"w", "u16"},
                                                                  {"c", "ctx"},
                                                                  {"ic", "ictx"},
                                                                  {"t_box", "boxed"},
                                                                  {"t_0", "ended"},
                                                                  {"t_b0", "boxed_ended"},
                                                                  {"t_bs", "boxed_sized"},
                                                                  {"t_m", "ended_most"},
                                                                  {"t_w", "wide"},
                                                                  {"t_l", "latin"},
                                                                  {"t_s", "sized"},
                                                                  {"t_a", "by_a"},
                                                                  {"t_bits", "by_bits"},
                                                                  {"t_look", "looked_up"},
                                                                  {"o", "blob"},
                                                                  {"o3", "blob3"},
                                                                  {"p", "pair"},
                                                                  {"named", "named"},
                                                                  {"arr", "three"},
                                                                  {"tab", "table"},
                                                                  {"dyn", "many"},
                                                                  {"ll", "longs"},
                                                                  {"recs", "pairs"},
                                                                  {"tt", "texts"},
                                                                  {"pp", "two_pairs"},
                                                                  {"last", "u8"},
                                                                  {"v", "u8"},
                                                                  {"k", "u2"},
                                                                  {"h", "u24"},
                                                                  {"many_c", "ctx"},
                                                                  {"t_v", "ended"},
                                                                  {"big_v", "u64"},
                                                                  {"COARSE_T", "u16"},
                                                                  {"FINE_T", "u8"},
                                                                  {"day", "days"},
                                                                  {"sec", "seconds"},
                                                                  {"span", "span"},
                                                                  {"in_timed", "timed"},
                                                                  {"day_v", "days"}};

std::string valid(const std::string& name) {
    if (name == "v" || name == "t_v" || name == "big_v" || name == "day_v")
        return "<ParameterProperties><ValidityCondition>" + compare("m", "!=", "ONE") +
               "</ValidityCondition></ParameterProperties>";
    return "";
}

/// A mission of a header, a container with these entries and one derived from it, or more.
std::string mission_text(const std::string& entries, const std::string& containers = "") {
    std::string text = "<SpaceSystem name='S' xmlns:y='http://www.yamcs.org'><TelemetryMetaData><ParameterTypeSet>" +
                       types() + "</ParameterTypeSet><ParameterSet>";
    for (const auto& [name, type] : parameters)
        text += "<Parameter name='" + name + "' parameterTypeRef='" + type + "'>" + valid(name) + "</Parameter>";
    return text + "</ParameterSet><ContainerSet><SequenceContainer name='P'><EntryList>" + entries +
           "</EntryList></SequenceContainer>" + containers + "</ContainerSet></TelemetryMetaData></SpaceSystem>";
}

std::optional<double> channel_number(const DecodedValue& value) {
    const Datum& datum = std::holds_alternative<std::string>(value.calibrated) ? value.raw : value.calibrated;
    if (const auto* real = std::get_if<double>(&datum)) return *real;
    if (const auto* whole = std::get_if<std::uint64_t>(&datum)) return static_cast<double>(*whole);
    if (const auto* whole = std::get_if<std::int64_t>(&datum)) return static_cast<double>(*whole);
    return std::nullopt;
}

std::uint64_t raw_bits(const Octets& packet, const DecodedValue& value, std::uint64_t before) {
    if (const auto* raw = std::get_if<std::uint64_t>(&value.raw)) return *raw;
    if (value.bits == 0 || value.bits > 64) return before;
    std::uint64_t bits = 0;
    for (std::size_t i = value.position_bits; i < value.position_bits + value.bits; ++i)
        bits = bits << 1U | (packet[i / 8] >> (7 - i % 8) & 1U);
    return bits;
}

/// A mission's two decoders.
class Both {
  public:
    explicit Both(const std::string& text) {
        std::vector<dictionary::Finding> findings;
        dictionary::Findings into{"m.xml", findings};
        auto model = dictionary::xtce::read_packet_model(text, into);
        REQUIRE(model);
        for (const auto& finding : findings) FAIL(finding.message);
        model_ = std::move(*model);
        model_.root = 0;
        mission_ = std::make_unique<OtherMission>(model_, std::uint16_t{1});
        decoder_ = std::make_unique<ContainerDecoder>(model_);
        std::vector<std::size_t> fields;
        for (const auto& packet : mission_->dictionary().packets) fields.push_back(packet.fields.size());
        plan_ = std::make_unique<ContainerPlan>(
            model_, fields,
            [this](std::size_t container, std::size_t, const std::string& name) {
                return field_index(mission_->dictionary().packets[container], name);
            },
            [this](std::size_t container, std::size_t field) {
                return needs_text(mission_->dictionary().packets[container].fields[field].type);
            });
    }

    /// Decodes a packet with both. Returns the problem; "not compiled" where the plan left a whole one.
    std::string decode(const Octets& packet) {
        const auto contents = decoder_->decode(packet);
        if (!plan_->decode(packet, decoded_)) {
            if (!contents.problem.empty()) return contents.problem;
            return contents.time && std::abs(contents.time->seconds) > 1e12 ? "no time that is one" : "not compiled";
        }
        REQUIRE(contents.problem.empty());
        REQUIRE(decoded_.packet == contents.container_index);
        const auto& of = mission_->dictionary().packets[decoded_.packet];
        std::vector<std::optional<double>> values(of.fields.size());
        std::vector<std::uint64_t> raw(of.fields.size(), 0);
        std::vector<std::pair<std::size_t, std::string>> texts;
        for (const DecodedValue& value : contents.values) {
            const auto field = field_index(of, value.name);
            if (!field) continue;
            values[*field] = channel_number(value);
            raw[*field] = raw_bits(packet, value, raw[*field]);
            if (needs_text(of.fields[*field].type) && !std::holds_alternative<std::monostate>(value.calibrated))
                texts.emplace_back(*field, datum_text(value.calibrated));
        }
        REQUIRE(decoded_.value == values);
        REQUIRE(decoded_.raw == raw);
        REQUIRE(decoded_.texts == texts);
        REQUIRE(decoded_.timed == contents.time.has_value());
        if (decoded_.timed) REQUIRE(decoded_.header.time.seconds == contents.time->seconds);
        return "";
    }

    std::size_t compiled() const { return plan_->compiled(); }

  private:
    PacketModel model_;
    std::unique_ptr<OtherMission> mission_;
    std::unique_ptr<ContainerDecoder> decoder_;
    std::unique_ptr<ContainerPlan> plan_;
    dictionary::Decoded decoded_;  // one for all packets: what an earlier one had must not stay
};

/// Octets that are often small numbers, zeros and letters.
Octets some_octets(std::mt19937& random, std::size_t count) {
    Octets octets(count);
    for (auto& octet : octets) {
        const unsigned kind = random() % 8;
        octet = static_cast<std::uint8_t>(kind < 4 ? random() % 5 : kind < 6 ? 'A' + random() % 3 : random());
    }
    return octets;
}

struct Seen {
    int whole = 0, with_problem = 0, not_compiled = 0;
};

/// Random packets, and each that is too long once more with its own length, one octet less and one more.
Seen compare_decoders(Both& both, unsigned seed, int rounds) {
    std::mt19937 random{seed};
    Seen seen;
    const auto decode = [&](const Octets& packet) {
        const std::string problem = both.decode(packet);
        ++(problem.empty() ? seen.whole : problem == "not compiled" ? seen.not_compiled : seen.with_problem);
        return problem;
    };
    for (int round = 0; round < rounds; ++round) {
        Octets packet = some_octets(random, random() % 80);
        const std::string problem = decode(packet);
        std::size_t behind_bits = 0;
        const auto [end, error] = std::from_chars(problem.data(), problem.data() + problem.size(), behind_bits);
        if (error != std::errc{} || !std::string_view{end}.starts_with(" bits are behind")) continue;
        packet.erase(packet.end() - static_cast<std::ptrdiff_t>(behind_bits / 8), packet.end());
        if (behind_bits % 8 != 0) packet.back() &= static_cast<std::uint8_t>(0xFFU << behind_bits % 8);
        decode(packet);
        if (!packet.empty()) decode({packet.begin(), packet.end() - 1});
        packet.push_back(static_cast<std::uint8_t>(random()));
        decode(packet);
    }
    return seen;
}

}  // namespace

TEST_CASE("each construct that is compiled gives what the decoder of all containers gives", "[telemetry][xtce][R54]") {
    const std::string a = entry("a"), m = entry("m"), last = entry("last");
    const std::string any =
        "<BooleanExpression><ORedConditions><Condition><ParameterInstanceRef parameterRef='a'/>"
        "<ComparisonOperator>==</ComparisonOperator><Value>3</Value></Condition><ANDedConditions>"
        "<Condition><ParameterInstanceRef parameterRef='m'/><ComparisonOperator>==</"
        "ComparisonOperator><Value>SOME</Value></Condition><Condition><ParameterInstanceRef "
        "parameterRef='a'/><ComparisonOperator>&gt;</ComparisonOperator><Value>1</Value></Condition>"
        "</ANDedConditions></ORedConditions></BooleanExpression>";
    const std::string second = "<SequenceContainer name='Q' abstract='true'><EntryList>" + entry("b") +
                               entry("w", at("containerStart", fixed(8))) + "</EntryList></SequenceContainer>";
    const std::vector<std::pair<std::string, std::string>> constructs{
        {"a text of fixed size", a + entry("t_box") + last},
        {"a text in a box up to a character", entry("t_b0") + last},
        {"a text in a box with its size", entry("t_bs") + last},
        {"a text up to a character", a + entry("t_0") + last},
        {"a text up to a character, with a most", entry("t_m") + last},
        {"a text of characters of two octets", entry("t_w") + last},
        {"a text in Latin letters", entry("t_l") + last},
        {"a text with its size", entry("t_s") + last + entry("t_0")},
        {"a text of a size by a number", a + entry("t_a") + last},
        {"a text of parts of octets", a + entry("t_bits") + last},
        {"a text of a size by a list", a + m + entry("t_look") + last},
        {"texts between octets",
         a + entry("odd") + entry("t_0") + entry("t_box") + entry("t_a") + entry("odd") + entry("k") + last},
        {"texts and numbers that may be invalid", m + entry("t_v") + entry("v") + entry("big_v") + last},
        {"octets of a size by a number", a + entry("o") + last + entry("o3") + entry("b")},
        {"an entry by a number", a + entry("b", when(compare("a", "&lt;", "3"))) + last},
        {"an entry by a label", m + entry("b", when(compare("m", "==", "ZERO"))) + last},
        {"an entry by a label of several numbers",
         m + entry("b", when(compare("m", "!=", "SOME"))) + entry("w", when(compare("m", "==", "ONE"))) + last},
        {"an entry by a label's number", m + entry("b", when(compare("m", "&gt;=", "2"))) +
                                             entry("w", when(compare("m", "!=", "1", "useCalibratedValue='false'"))) +
                                             last},
        {"an entry by a flag", entry("on") + entry("b", when(compare("on", "==", "ON"))) +
                                   entry("w", when(compare("on", "!=", "ON"))) +
                                   entry("h", when(compare("on", "==", "OFF"))) + last},
        {"an entry by several conditions", a + m + entry("b", when(any)) + last},
        {"an entry by a real number", entry("x") + entry("b", when(compare("x", "&gt;", "0.5"))) + last},
        {"an entry by a calibrated number", entry("some") + entry("twice") +
                                                entry("b", when(compare("some", "&gt;", "0"))) +
                                                entry("w", when(compare("twice", "==", "4"))) + last},
        {"entries that are alternatives",
         a + entry("w", when(compare("a", "==", "1"))) + m + entry("x", when(compare("a", "!=", "1"))) + last},
        {"an entry by one that may be missing",
         a + entry("b", when(compare("a", "==", "1"))) + entry("w", when(compare("b", "&lt;", "3"))) + last},
        {"an entry by a number behind a text", entry("t_0") + a + entry("b", when(compare("a", "&lt;", "3"))) + last},
        {"several things by a condition",
         a + entry("p", when(compare("a", "==", "1"))) + entry("t_s", when(compare("a", "==", "2"))) +
             entry("arr", when(compare("a", "!=", "3"))) + entry("tab", when(compare("a", "!=", "3"))) + last},
        {"a container by a condition",
         a + "<ContainerRefEntry containerRef='R'>" + when(compare("a", "!=", "1")) + "</ContainerRefEntry>" + last},
        {"a container in a container", a + "<ContainerRefEntry containerRef='Q'/>" + last},
        {"contexts", m + a + entry("x") + entry("c") + entry("ic") + last},
        {"contexts of a list", m + a + entry("x") + entry("many_c", repeat(by("a"))) + last},
        {"contexts of what may be missing", m + a + entry("x", when(compare("a", "&lt;", "2"))) + entry("c") + last},
        {"an array of fixed size", entry("arr") + entry("b", when(compare("arr[1]", "==", "2"))) + last},
        {"a table", entry("tab") + last},
        {"an array of a size by a number", a + entry("dyn") + last},
        {"an array of numbers of 64 bits", a + entry("ll") + last},
        {"an array of aggregates", a + entry("recs") + last},
        {"an array of texts", a + entry("tt") + last},
        {"an array of aggregates of fixed size", entry("pp") + last},
        {"repeated aggregates", a + entry("p", repeat(by("a"))) + entry("named", repeat(fixed(2))) + last},
        {"repeated aggregates with texts", a + entry("named", repeat(by("a"))) + last},
        {"a repetition of fixed number", entry("s", repeat(fixed(3))) + entry("l", repeat(fixed(2))) + last},
        {"numbers behind what varies", entry("t_s") + entry("s") + entry("x") + entry("big") + entry("w") + entry("l") +
                                           entry("digits") + entry("some") + entry("b") + last},
        {"a place by a number", a + entry("b", at("previousEntry", by("a", "<LinearAdjustment slope='8'/>"))) + last},
        {"a place before, by a number",
         a + entry("b") + entry("w") + entry("odd", at("previousEntry", by("a", "<LinearAdjustment slope='-4'/>"))) +
             last},
        {"a place from the begin, by a number",
         a + entry("b") + entry("w", at("containerStart", by("a", "<LinearAdjustment slope='8'/>"))) + last},
        {"a fixed place behind what varies", a + entry("t_a") + entry("b", at("containerStart", fixed(24))) + last},
        {"a place behind what varies, before it",
         a + entry("t_a") + entry("b", at("previousEntry", fixed(-12))) + last},
        {"a time", entry("day") + last},
        {"times that may be undefined", m + entry("span") + entry("in_timed") + entry("day_v") + entry("sec") + last},
        {"a time before a text", entry("t_0") + entry("sec") + entry("day") + entry("COARSE_T")},
        {"a time by a condition", a + entry("day", when(compare("a", "==", "1"))) + entry("sec") + last},
        {"a time and a clock", entry("h") + entry("a") + m + entry("odd") + entry("odd") + entry("k") +
                                   entry("COARSE_T") + entry("FINE_T") + entry("day_v")},
        {"a clock before a text",
         entry("h") + entry("h", at("previousEntry", fixed(0))) + entry("COARSE_T") + entry("FINE_T") + entry("t_0")},
    };
    const std::string contained = "<SequenceContainer name='R' abstract='true'><EntryList>" + entry("b") +
                                  entry("t_s") + "</EntryList></SequenceContainer>" + second;
    unsigned seed = 1;
    for (const auto& [name, entries] : constructs) {
        INFO(name);
        Both both{mission_text(entries, contained)};
        REQUIRE(both.compiled() > 0);
        const Seen seen = compare_decoders(both, ++seed, 1500);
        CHECK(seen.whole > 100);
        CHECK(seen.with_problem > 100);
        CHECK(seen.not_compiled == 0);
    }
}

TEST_CASE("containers told apart by labels, reals and alternatives are compiled and read alike",
          "[telemetry][xtce][R54]") {
    const auto derived = [](const std::string& name, const std::string& entries, const std::string& condition) {
        return "<SequenceContainer name='" + name + "'><EntryList>" + entries +
               "</EntryList><BaseContainer containerRef='P'><RestrictionCriteria>" + condition +
               "</RestrictionCriteria></BaseContainer></SequenceContainer>";
    };
    Both both{mission_text(entry("m") + entry("x") + entry("t_s"),
                           derived("One", entry("b"), compare("m", "==", "ONE")) +
                               derived("Some", entry("t_0"), compare("m", "==", "SOME")) +
                               derived("Real", entry("w"),
                                       "<ComparisonList>" + compare("x", "&lt;", "0.25") + compare("m", "==", "0") +
                                           "</ComparisonList>"))};
    const Seen seen = compare_decoders(both, 5, 4000);
    CHECK(both.compiled() == 4);
    CHECK(seen.whole > 1000);
    CHECK(seen.with_problem > 1000);
}

TEST_CASE("missions of random constructs are read alike", "[telemetry][xtce][R54]") {
    std::mt19937 random{2026};
    const auto one_of = [&](const auto& from) { return from[random() % from.size()]; };
    const std::vector<std::string> conditions{compare("a", "&lt;", "3"),   compare("m", "==", "SOME"),
                                              compare("on", "!=", "ON"),   compare("x", "&gt;", "0"),
                                              compare("b", "==", "1"),     compare("some", "&gt;", "0"),
                                              compare("m", "!=", "ONE"),   compare("arr[0]", "==", "2"),
                                              compare("p.p", "&lt;", "4"), compare("t_0", "==", "A")};
    const std::vector<std::string> places{at("previousEntry", fixed(8)), at("previousEntry", fixed(-8)),
                                          at("previousEntry", fixed(3)), at("containerStart", fixed(16)),
                                          at("previousEntry", by("a"))};
    const auto entries = [&] {
        std::string made;
        for (std::size_t i = random() % 9 + 1; i > 0; --i) {
            std::string inner;
            if (random() % 8 == 0) inner += one_of(places);
            if (random() % 12 == 0)
                inner += repeat(random() % 2 == 0 ? by("a") : fixed(static_cast<int>(random() % 4)));
            if (random() % 5 == 0) inner += when(one_of(conditions));
            made += entry(one_of(parameters).first, inner);
        }
        return made;
    };
    Seen all;
    for (int round = 0; round < 800; ++round) {
        const std::string text = mission_text(
            (random() % 8 != 0 ? entry("a") + entry("m") + entry("on") + entry("x") + entry("some") : "") + entries(),
            "<SequenceContainer name='D'><EntryList>" + entries() +
                "</EntryList><BaseContainer containerRef='P'><RestrictionCriteria>" + one_of(conditions) +
                "</RestrictionCriteria></BaseContainer></SequenceContainer>");
        INFO(text.substr(text.find("<ContainerSet>")));
        Both both{text};
        const Seen seen = compare_decoders(both, static_cast<unsigned>(round), 60);
        all.whole += seen.whole;
        all.with_problem += seen.with_problem;
        all.not_compiled += seen.not_compiled;
    }
    INFO(all.whole << " " << all.with_problem << " " << all.not_compiled);
    CHECK(all.whole > 3000);
    CHECK(all.with_problem > 10000);
}

}  // namespace telemetry_compiled_constructs_test
