// SPDX-License-Identifier: Apache-2.0
#include "common/crc.hpp"
#include "telemetry/container_decoder.hpp"
#include "telemetry/decommutator.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/octets.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>

namespace telemetry_container_decoder_test {

using namespace aeolis;
using namespace aeolis::telemetry;
namespace xtce = aeolis::dictionary::xtce;

namespace {

/// A mission of few words: types, parameters "NAME TYPE", containers.
struct Mission {
    std::vector<dictionary::Finding> findings;
    xtce::PacketModel model;

    Mission(const std::string& types, const std::vector<std::pair<std::string, std::string>>& parameters,
            const std::string& containers) {
        std::string text =
            "<SpaceSystem name='T'><TelemetryMetaData><ParameterTypeSet>"
            "<IntegerParameterType name='u8'><IntegerDataEncoding sizeInBits='8'/></IntegerParameterType>"
            "<IntegerParameterType name='u16'><IntegerDataEncoding sizeInBits='16'/></IntegerParameterType>" +
            types + "</ParameterTypeSet><ParameterSet>";
        for (const auto& [name, type] : parameters)
            text += "<Parameter name='" + name + "' parameterTypeRef='" + type + "'/>";
        text += "</ParameterSet><ContainerSet>" + containers + "</ContainerSet></TelemetryMetaData></SpaceSystem>";
        dictionary::Findings into{"t.xml", findings};
        auto read = xtce::read_packet_model(text, into);
        REQUIRE(read);
        model = std::move(*read);
    }
    DecodedContents decode(std::string_view octets) const { return ContainerDecoder{model}.decode(test::hex(octets)); }
};

std::string container(const std::string& name, const std::string& entries, const std::string& base = "") {
    return "<SequenceContainer name='" + name + "'><EntryList>" + entries + "</EntryList>" + base +
           "</SequenceContainer>";
}
std::string entry(const std::string& name, const std::string& inside = "") {
    return "<ParameterRefEntry parameterRef='" + name + "'>" + inside + "</ParameterRefEntry>";
}
std::string base(const std::string& name, const std::string& criteria) {
    return "<BaseContainer containerRef='" + name + "'><RestrictionCriteria>" + criteria +
           "</RestrictionCriteria></BaseContainer>";
}
std::string when(const std::string& parameter, const std::string& op, const std::string& value) {
    return "<Comparison parameterRef='" + parameter + "' comparisonOperator='" + op + "' value='" + value + "'/>";
}

/// "name=raw|calibrated" of each value, with blanks between.
std::string text(const DecodedContents& contents) {
    std::string all;
    for (const auto& value : contents.values)
        all += (all.empty() ? "" : " ") + value.name + "=" + datum_text(value.raw) + "|" + datum_text(value.calibrated);
    return all;
}

const std::string dynamic_octets =
    "<BinaryParameterType name='rest'><BinaryDataEncoding><SizeInBits><DynamicValue>"
    "<ParameterInstanceRef parameterRef='n'/><LinearAdjustment slope='8' intercept='-8'/>"
    "</DynamicValue></SizeInBits></BinaryDataEncoding></BinaryParameterType>";

}  // namespace

TEST_CASE("every packet of ours reads the same by its XTCE file as by the decommutator", "[telemetry]") {
    std::ifstream in{AEOLIS_SOURCE_DIR "/dictionaries/msl/msl.xml"};
    const std::string file{std::istreambuf_iterator<char>{in}, {}};
    std::vector<dictionary::Finding> findings;
    dictionary::Findings into{"msl.xml", findings};
    const auto model = xtce::read_packet_model(file, into);
    REQUIRE(model);
    CHECK(findings.empty());
    const ContainerDecoder decoder{*model};
    const auto& ours = tests::shipped_dictionary();
    const Decommutator decommutator{ours};
    std::mt19937 random{1};
    Decoded decoded;
    for (const auto& packet : ours.packets)
        for (int round = 0; round < 5; ++round) {
            auto octets = test::random_octets(random, packet.octets);
            if (packet.event) {
                octets[tm_data_offset_octets] = static_cast<std::uint8_t>(packet.event->value >> 8);
                octets[tm_data_offset_octets + 1] = static_cast<std::uint8_t>(packet.event->value & 0xFF);
            }
            seal_tm_packet(octets, packet.apid, 1, Sclk{5.0}, ours.id);
            REQUIRE_FALSE(decommutator.decode(octets, decoded));
            const auto contents = decoder.decode(octets);
            INFO(packet.name << ": " << contents.problem);
            REQUIRE(contents.container == packet.name);
            REQUIRE(contents.time);
            REQUIRE(contents.time->seconds == 5.0);
            std::map<std::string, DecodedValue> by_name;
            for (const auto& value : contents.values) by_name.emplace(value.name, value);
            for (std::size_t i = 0; i < packet.fields.size(); ++i) {
                const auto& field = packet.fields[i];
                INFO(field.name);
                REQUIRE(by_name.contains(field.name));
                const Datum& raw = by_name.at(field.name).raw;
                const Datum& calibrated = by_name.at(field.name).calibrated;
                REQUIRE(std::holds_alternative<std::monostate>(calibrated) == !decoded.value[i]);
                REQUIRE(by_name.at(field.name).position_bits == field.position_bits);
                REQUIRE(by_name.at(field.name).bits == field.type.bits);
                if (!decoded.value[i]) continue;
                const bool label = std::holds_alternative<std::string>(calibrated);
                const double value = std::visit(
                    [](const auto& datum) {
                        if constexpr (std::is_arithmetic_v<std::decay_t<decltype(datum)>>)
                            return static_cast<double>(datum);
                        else
                            return -1.0;
                    },
                    label ? raw : calibrated);
                REQUIRE(value == *decoded.value[i]);
            }
        }
}

TEST_CASE("octets whose number another value tells, and what stands behind them", "[telemetry]") {
    const Mission mission{dynamic_octets,
                          {{"n", "u8"}, {"data", "rest"}, {"after", "u8"}},
                          container("P", entry("n") + entry("data") + entry("after"))};
    CHECK(mission.findings.empty());
    CHECK(text(mission.decode("04 a1b2c3 ff")) == "n=4|4 data=a1b2c3|a1b2c3 after=255|255");
    CHECK(text(mission.decode("01 07")) == "n=1|1 data=| after=7|7");
    CHECK(mission.decode("04 a1b2").problem.starts_with("the packet ends before data: 24 bits at bit 8 of 24"));
    CHECK(mission.decode("00 07").problem.starts_with("the size of data cannot be known"));
}

TEST_CASE("the derived container whose restriction holds goes on; none leaves the packet where it is", "[telemetry]") {
    const Mission mission{
        "",
        {{"kind", "u8"}, {"a", "u8"}, {"b", "u16"}},
        container("Root", entry("kind")) + container("One", entry("a"), base("Root", when("kind", "==", "1"))) +
            container("Big", entry("b"),
                      base("Root",
                           "<BooleanExpression><ORedConditions><Condition><ParameterInstanceRef "
                           "parameterRef='kind'/><ComparisonOperator>&gt;=</ComparisonOperator><Value>0x10</Value>"
                           "</Condition></ORedConditions></BooleanExpression>"))};
    CHECK(mission.findings.empty());
    CHECK(mission.decode("01 05").container == "One");
    CHECK(text(mission.decode("10 0102")) == "kind=16|16 b=258|258");
    CHECK(mission.decode("05 0102").container == "Root");
}

TEST_CASE("what no container describes, or more than one, is not decoded further", "[telemetry][R55]") {
    const std::vector<std::pair<std::string, std::string>> parameters{{"kind", "u8"}, {"a", "u8"}, {"b", "u16"}};
    const std::string root = container("Root", entry("kind"));
    const Mission two{"", parameters,
                      root + container("Low", entry("a"), base("Root", when("kind", "<", "5"))) +
                          container("Odd", entry("b"), base("Root", when("kind", "==", "3")))};
    CHECK(text(two.decode("01 07")) == "kind=1|1 a=7|7");
    const auto both = two.decode("03 0102");
    CHECK(text(both) == "kind=3|3");
    CHECK_THAT(both.problem, Catch::StartsWith("Low and Odd both describe it"));

    const Mission rest{"", parameters,
                       root + container("Rest", entry("b"), "<BaseContainer containerRef='Root'/>") +
                           container("One", entry("a"), base("Root", when("kind", "==", "1")))};
    CHECK(text(rest.decode("01 07")) == "kind=1|1 a=7|7");  // one without a restriction gives way
    CHECK(text(rest.decode("02 0007")) == "kind=2|2 b=7|7");

    const Mission unresolved{"", parameters,
                             root + container("Science", entry("b"), base("../X/Root", when("kind", "==", "9")))};
    REQUIRE(unresolved.findings.size() == 1);
    CHECK(unresolved.findings[0].message == "there is no container '../X/Root'");
    const auto contents = unresolved.decode("09 0102");
    CHECK(text(contents) == "kind=9|9");
    CHECK_THAT(contents.problem, Catch::StartsWith("16 bits are behind the last entry of Root"));
}

TEST_CASE("nothing is decided by a condition that is not understood: no entry, no container, no calibration, no size",
          "[telemetry][xtce][R54]") {
    const std::string two_parameters = "<BooleanExpression><Condition><ParameterInstanceRef parameterRef='a'/>"
                                       "<ComparisonOperator>==</ComparisonOperator><ParameterInstanceRef "
                                       "parameterRef='b'/></Condition></BooleanExpression>";
    const auto with = [&](const std::string& first, const char* joined) {
        const std::string name = joined;
        return "<BooleanExpression><" + name + ">" + first + two_parameters.substr(19, two_parameters.size() - 39) +
               "</" + name + "></BooleanExpression>";
    };
    const auto is = [](const char* value) {
        return "<Condition><ParameterInstanceRef parameterRef='a'/><ComparisonOperator>==</ComparisonOperator><Value>" +
               std::string{value} + "</Value></Condition>";
    };
    const std::vector<std::pair<std::string, std::string>> parameters{{"a", "u8"}, {"b", "u8"},      {"c", "u8"},
                                                                      {"d", "u8"}, {"k", "doubled"}, {"n", "sized"}};
    const std::string types =
        "<FloatParameterType name='doubled'><IntegerDataEncoding "
        "sizeInBits='8'><DefaultCalibrator><PolynomialCalibrator>"
        "<Term coefficient='2' exponent='1'/></PolynomialCalibrator></DefaultCalibrator><ContextCalibratorList>"
        "<ContextCalibrator><ContextMatch>" +
        with(is("9"), "ORedConditions") +
        "</ContextMatch><Calibrator><PolynomialCalibrator><Term coefficient='100' exponent='0'/></PolynomialCalibrator>"
        "</Calibrator></ContextCalibrator></ContextCalibratorList></IntegerDataEncoding></FloatParameterType>"
        "<BinaryParameterType name='sized'><BinaryDataEncoding><SizeInBits><DiscreteLookupList><DiscreteLookup "
        "value='8'>" +
        two_parameters +
        "</DiscreteLookup><DiscreteLookup value='16'><Comparison parameterRef='a' value='1'/></DiscreteLookup>"
        "</DiscreteLookupList></SizeInBits></BinaryDataEncoding></BinaryParameterType>";
    const auto included = [&](const std::string& condition) {
        return Mission{types, parameters,
                       container("P", entry("a") + entry("b") +
                                          entry("c", "<IncludeCondition>" + condition + "</IncludeCondition>") +
                                          entry("d"))};
    };
    const auto entries = included(two_parameters).decode("07 07 08 09");
    CHECK(text(entries) == "a=7|7 b=7|7");
    CHECK_THAT(entries.problem, Catch::StartsWith("an entry of P has a condition that is not understood"));
    // What the other parts decide is decided.
    CHECK(text(included(with(is("7"), "ORedConditions")).decode("07 07 08 09")) == "a=7|7 b=7|7 c=8|8 d=9|9");
    CHECK(text(included(with(is("6"), "ANDedConditions")).decode("07 07 09")) == "a=7|7 b=7|7 d=9|9");
    CHECK_FALSE(included(with(is("6"), "ORedConditions")).decode("07 07 09").problem.empty());

    const Mission calibrated{types, parameters, container("P", entry("a") + entry("b") + entry("k"))};
    CHECK(text(calibrated.decode("07 07 05")) == "a=7|7 b=7|7 k=5|undefined");
    CHECK(text(calibrated.decode("09 07 05")) == "a=9|9 b=7|7 k=5|100");

    const Mission sized{types, parameters, container("P", entry("a") + entry("b") + entry("n"))};
    CHECK_THAT(sized.decode("01 07 05 05").problem, Catch::StartsWith("the size of n cannot be known"));

    const Mission derived{types, parameters,
                          container("Root", entry("a") + entry("b")) +
                              container("Strange", entry("c"), base("Root", two_parameters)) +
                              container("One", entry("d"), base("Root", when("a", "==", "1"))) +
                              container("Rest", entry("c"), "<BaseContainer containerRef='Root'/>")};
    CHECK(text(derived.decode("01 07 08")) == "a=1|1 b=7|7 d=8|8");
    const auto rest = derived.decode("02 02 08");
    CHECK(text(rest) == "a=2|2 b=2|2");
    CHECK_THAT(rest.problem, Catch::StartsWith("whether Strange describes it is not known"));
}

TEST_CASE("a comparison whose value is undefined, not there yet or not comparable decides nothing",
          "[telemetry][xtce][R54]") {
    const std::string types =
        "<IntegerParameterType name='bcd'><IntegerDataEncoding sizeInBits='8' encoding='BCD'/></IntegerParameterType>"
        "<FloatParameterType name='curve'><IntegerDataEncoding sizeInBits='8'><DefaultCalibrator><SplineCalibrator>"
        "<SplinePoint raw='10' calibrated='0'/><SplinePoint raw='20' calibrated='1'/></SplineCalibrator>"
        "</DefaultCalibrator></IntegerDataEncoding></FloatParameterType>"
        "<FloatParameterType name='strange'><FloatDataEncoding sizeInBits='32' encoding='IBM'/></FloatParameterType>"
        "<EnumeratedParameterType name='mode'><IntegerDataEncoding sizeInBits='8'/><EnumerationList>"
        "<Enumeration value='5' label='FIVE'/><Enumeration value='6' label='7'/></EnumerationList>"
        "</EnumeratedParameterType>"
        "<StringParameterType name='word'><StringDataEncoding><SizeInBits><Fixed><FixedValue>16</FixedValue></Fixed>"
        "</SizeInBits></StringDataEncoding></StringParameterType>"
        "<AggregateParameterType name='pair'><MemberList><Member name='x' typeRef='u8'/><Member name='y' typeRef='u8'/>"
        "</MemberList></AggregateParameterType>";
    const auto is = [](const char* op, const std::string& value, const char* more = "") {
        return "<Comparison parameterRef='k' comparisonOperator='" + std::string{op} + "' value='" + value + "' " +
               more + "/>";
    };
    const auto mission = [&](const char* type, const std::string& condition) {
        return Mission{types,
                       {{"k", type}, {"a", "u8"}, {"z", "u8"}},
                       container("P", entry("k")) + container("Q", entry("a"), base("P", condition)) +
                           container("R", entry("z"), "<BaseContainer containerRef='P'/>")};
    };
    const auto not_known = [&](const char* type, const std::string& condition, const char* packet) {
        INFO(type << " " << condition);
        const auto contents = mission(type, condition).decode(packet);
        CHECK(contents.container == "P");
        CHECK_THAT(contents.problem, Catch::StartsWith("whether Q describes it is not known"));
    };
    const auto taken_by = [&](const char* type, const std::string& condition, const char* packet) {
        const auto read = mission(type, condition);
        return read.findings.empty() ? read.decode(packet).container : read.findings[0].message;
    };
    not_known("bcd", is("==", "5"), "fa 02");
    not_known("bcd", is("!=", "5"), "fa 02");
    not_known("bcd", is("!=", "5", "useCalibratedValue='false'"), "fa 02");
    not_known("curve", is("&lt;", "5"), "01 02");
    not_known("strange", is("==", "1"), "00000001 02");
    not_known("u8", is("==", "FIVE"), "05 02");
    not_known("u8", is("==", "5", "useCalibratedValue='maybe'"), "05 02");
    not_known("mode", is("==", "FIV"), "05 02");
    not_known("mode", is("&lt;", "FIVE"), "05 02");
    not_known("mode", is("==", "FIVE", "useCalibratedValue='false'"), "05 02");
    not_known("pair", is("==", "5"), "0506 02");
    CHECK(taken_by("u8", is("==", "FIVE"), "05 02") ==
          "it compares with 'FIVE', which is neither a number nor a label of 'u8': whether it holds is not known");
    CHECK(taken_by("bcd", is("==", "5"), "05 02") == "Q");
    CHECK(taken_by("curve", is("&lt;", "5", "useCalibratedValue='false'"), "01 02") == "Q");
    CHECK(taken_by("u8", is("==", " 5 "), "05 02") == "Q");
    CHECK(taken_by("u8", is("==", "+5.0"), "05 02") == "Q");
    CHECK(taken_by("mode", is("==", "5"), "05 02") == "Q");
    CHECK(taken_by("mode", is("==", " FIVE "), "05 02") == "Q");
    CHECK(taken_by("mode", is("==", "FIVE"), "08 02") == "R");  // a number without a label has not that one
    CHECK(taken_by("mode", is("!=", "FIVE"), "08 02") == "Q");
    CHECK(taken_by("mode", is("==", "7"), "06 02") == "Q");
    CHECK(taken_by("mode", is("==", "7"), "07 02") == "R");  // it is the label of 6
    CHECK(taken_by("word", is("==", "AB"), "4142 02") == "Q");
    CHECK(taken_by("word", is("==", "AB", "useCalibratedValue='false'"), "4142 02") == "Q");
    not_known("word", is("==", "AB"), "ff42 02");

    const auto later =
        Mission{"",
                {{"y", "u8"}, {"z", "u8"}},
                container("P",
                          entry("z", "<IncludeCondition>" + when("y", "==", "0") + "</IncludeCondition>") + entry("y"))}
            .decode("01 00");
    CHECK(later.values.empty());
    CHECK_THAT(later.problem, Catch::StartsWith("an entry of P has a condition that is not understood"));

    // A count whose bits are no number counts nothing.
    const Mission counted{
        types,
        {{"n", "bcd"}, {"a", "u8"}},
        container("P", entry("n") + entry("a", "<RepeatEntry><Count><DynamicValue><ParameterInstanceRef "
                                               "parameterRef='n'/></DynamicValue></Count></RepeatEntry>"))};
    CHECK(text(counted.decode("02 0708")) == "n=2|2 a[0]=7|7 a[1]=8|8");
    CHECK(text(counted.decode("0a 00000000000000000000")) == "n=10|undefined");
}

TEST_CASE("where several containers can begin a packet, the user says which", "[telemetry][R55]") {
    Mission mission{"", {{"a", "u8"}, {"b", "u16"}}, container("P", entry("a")) + container("Q", entry("b"))};
    CHECK(mission.decode("0102").problem ==
          "several containers of the XTCE file have no base: say with which one packets begin: /T/P, /T/Q");
    CHECK(mission.decode("0102").values.empty());
    CHECK_FALSE(ContainerDecoder::root_of(mission.model, "R"));
    mission.model.root = ContainerDecoder::root_of(mission.model, "Q").value();
    CHECK(text(mission.decode("0102")) == "b=258|258");
    mission.model.root = ContainerDecoder::root_of(mission.model, "/T/P").value();
    CHECK(text(mission.decode("01")) == "a=1|1");
}

TEST_CASE("octets behind the last entry are told, wherever the entries stand", "[telemetry][R55]") {
    const std::string at_start =
        "<LocationInContainerInBits referenceLocation='containerStart'><FixedValue>0</FixedValue>"
        "</LocationInContainerInBits>";
    const Mission mission{
        "", {{"a", "u8"}, {"b", "u16"}}, container("P", entry("a") + entry("b") + entry("a", at_start))};
    CHECK(mission.decode("010203").problem.empty());
    CHECK_THAT(mission.decode("01020304050607").problem, Catch::StartsWith("32 bits are behind the last entry of P"));
    CHECK(mission.decode("010203adad").problem.empty());  // the right CRC-16
    CHECK_THAT(mission.decode("010203adac").problem, Catch::StartsWith("16 bits are behind the last entry of P"));
}

TEST_CASE("a size that is looked up has the value of the list where no case holds", "[telemetry][xtce][R54]") {
    const auto read = [](const std::string& otherwise) {
        const Mission mission{"<BinaryParameterType name='t'><BinaryDataEncoding><SizeInBits><DiscreteLookupList " +
                                  otherwise +
                                  "><DiscreteLookup value='8'><Comparison parameterRef='n' value='1'/></DiscreteLookup>"
                                  "</DiscreteLookupList></SizeInBits></BinaryDataEncoding></BinaryParameterType>",
                              {{"n", "u8"}, {"k", "t"}},
                              container("P", entry("n") + entry("k"))};
        return text(mission.decode("01 0a")) + ", " + text(mission.decode("02 0a0b"));
    };
    CHECK(read("") == "n=1|1 k=0a|0a, n=2|2");
    CHECK(read("defaultValue='16'") == "n=1|1 k=0a|0a, n=2|2 k=0a0b|0a0b");
    CHECK(read("defaultValue='x'") == "n=1|1, n=2|2");
}

TEST_CASE("nothing is read of a container whose octets are made by an algorithm or stand in another order",
          "[telemetry][xtce][R54]") {
    const auto read = [](const std::string& attributes, const std::string& inside) {
        const Mission mission{"",
                              {{"a", "u8"}},
                              "<SequenceContainer name='P'><BinaryEncoding " + attributes + ">" + inside +
                                  "<SizeInBits><FixedValue>8</FixedValue></SizeInBits></BinaryEncoding><EntryList>" +
                                  entry("a") + "</EntryList></SequenceContainer>"};
        const auto contents = mission.decode("07");
        return text(contents) + contents.problem;
    };
    CHECK(read("", "") == "a=7|7");
    CHECK(read("bitOrder='leastSignificantBitFirst'", "") == "an entry of P is not supported (line 1)");
    CHECK(read("", "<FromBinaryTransformAlgorithm name='x'/>") == "an entry of P is not supported (line 1)");
}

TEST_CASE("zeros that fill the last octet are the end of a packet, also before its CRC-16", "[telemetry][xtce][R54]") {
    const std::string types =
        "<IntegerParameterType name='u5'><IntegerDataEncoding sizeInBits='5'/></IntegerParameterType>";
    const Mission mission{types, {{"a", "u8"}, {"b", "u5"}}, container("P", entry("a") + entry("b"))};
    CHECK(mission.decode("01 10").problem.empty());
    CHECK_THAT(mission.decode("01 11").problem, Catch::StartsWith("3 bits are behind the last entry of P"));
    CHECK_THAT(mission.decode("01 10 00").problem, Catch::StartsWith("11 bits are behind the last entry of P"));
    const auto with_crc = [](std::vector<std::uint8_t> octets) {
        const auto crc = crc16(octets);
        octets.push_back(static_cast<std::uint8_t>(crc >> 8));
        octets.push_back(static_cast<std::uint8_t>(crc & 0xFF));
        return octets;
    };
    const ContainerDecoder decoder{mission.model};
    CHECK(decoder.decode(with_crc({0x01, 0x10})).problem.empty());
    auto wrong = with_crc({0x01, 0x10});
    wrong.back() ^= 1U;
    CHECK_THAT(decoder.decode(wrong).problem, Catch::StartsWith("19 bits are behind the last entry of P"));
    CHECK_FALSE(decoder.decode(with_crc({0x01, 0x12})).problem.empty());
    CHECK_FALSE(decoder.decode(with_crc({0x01, 0x10, 0x00})).problem.empty());
}

TEST_CASE("values that are not read are counted, those that are undefined by the file's own rule are not",
          "[telemetry][xtce][R54]") {
    const std::string spline = "<SplineCalibrator><SplinePoint raw='10' calibrated='0'/><SplinePoint raw='20' "
                               "calibrated='1'/></SplineCalibrator>";
    const auto integer = [](const std::string& attributes, const std::string& inside = "") {
        return "<IntegerParameterType name='t'><IntegerDataEncoding " + attributes + ">" + inside +
               "</IntegerDataEncoding></IntegerParameterType>";
    };
    const auto real = [](const std::string& attributes) {
        return "<FloatParameterType name='t'><FloatDataEncoding " + attributes + "/></FloatParameterType>";
    };
    const auto word = [](const std::string& characters, const std::string& bits) {
        return "<StringParameterType name='t'><StringDataEncoding encoding='" + characters +
               "'><SizeInBits><Fixed><FixedValue>" + bits + "</FixedValue></Fixed></SizeInBits></StringDataEncoding>" +
               "</StringParameterType>";
    };
    const auto time = [](const std::string& encoding) {
        return "<AbsoluteTimeParameterType name='t'><Encoding " + encoding +
               "</Encoding><ReferenceTime><Epoch>TAI</Epoch></ReferenceTime></AbsoluteTimeParameterType>";
    };
    const auto calibrated = [](const std::string& calibrator) {
        return "<DefaultCalibrator>" + calibrator + "</DefaultCalibrator>";
    };
    const auto unread = [](const std::string& type, std::string_view packet) {
        INFO(type);
        const Mission mission{
            type, {{"a", "t"}, {"b", "t"}, {"z", "u8"}}, container("P", entry("a") + entry("b") + entry("z"))};
        const auto contents = mission.decode(packet);
        CHECK(contents.problem.empty());
        for (const auto& value : contents.unread) CHECK(value.line == 1);
        return contents.unread.size();
    };
    CHECK(unread(real("sizeInBits='48' encoding='MILSTD_1750A'"), "3c3c3c3c3c3c 3c3c3c3c3c3c 07") == 2);
    CHECK(unread(real("sizeInBits='32' encoding='IBM'"), "3c3c3c3c 3c3c3c3c 07") == 2);
    CHECK(unread(integer("sizeInBits='24'", "<ByteOrderList><Byte byteSignificance='1'/><Byte byteSignificance='2'/>"
                                            "<Byte byteSignificance='0'/></ByteOrderList>"),
                 "010203 040506 07") == 2);
    CHECK(unread(integer("sizeInBits='16' bitOrder='reversed'"), "0102 0304 07") == 2);
    CHECK(unread(integer("sizeInBits='8'", calibrated("<MathOperationCalibrator/>")), "01 02 07") == 2);
    CHECK(unread(integer("sizeInBits='8' encoding='packedBCD'"), "1a 12 07") == 1);
    CHECK(unread(integer("sizeInBits='8' encoding=''"), "01 02 07") == 2);
    CHECK(unread(word("UTF-32", "32"), "00000041 00000042 07") == 2);
    CHECK(unread(word("UTF-8", "16"), "ff41 4142 07") == 1);
    CHECK(unread(time("units='minutes'><IntegerDataEncoding sizeInBits='16'/>"), "0001 0002 07") == 2);
    CHECK(unread(time("scale='0'><IntegerDataEncoding sizeInBits='16'/>"), "0001 0002 07") == 2);

    const std::string in_text =
        "><StringDataEncoding><SizeInBits><Fixed><FixedValue>8</FixedValue></Fixed></SizeInBits>"
        "</StringDataEncoding>";
    CHECK(unread("<IntegerParameterType name='t'" + in_text + "</IntegerParameterType>", "31 32 07") == 2);
    CHECK(unread("<EnumeratedParameterType name='t'" + in_text +
                     "<EnumerationList><Enumeration value='1' label='ON'/>"
                     "</EnumerationList></EnumeratedParameterType>",
                 "31 32 07") == 2);
    CHECK(
        unread("<BooleanParameterType name='t'><BinaryDataEncoding><SizeInBits><FixedValue>8</FixedValue></SizeInBits>"
               "</BinaryDataEncoding></BooleanParameterType>",
               "01 00 07") == 2);
    CHECK(unread("<StringParameterType name='t'><IntegerDataEncoding/></StringParameterType>", "41 42 07") == 2);

    CHECK(unread(integer("sizeInBits='8'", calibrated(spline)), "01 02 07") == 0);
    CHECK(unread(integer("sizeInBits='8' encoding='packedBCD'"), "19 12 07") == 0);
    CHECK(unread(real("sizeInBits='32'"), "7fc00000 7f800000 07") == 0);
    CHECK(unread(word("UTF-8", "16"), "4141 4142 07") == 0);
    CHECK(unread(time("scale='2'><IntegerDataEncoding sizeInBits='16'/>"), "0001 0002 07") == 0);
}

TEST_CASE("no value is calibrated, sized or timed by what is not a number", "[telemetry][xtce][R54]") {
    const auto calibrated = [](const std::string& calibrator) {
        return "<IntegerParameterType name='t'><IntegerDataEncoding sizeInBits='8'><DefaultCalibrator>" + calibrator +
               "</DefaultCalibrator></IntegerDataEncoding></IntegerParameterType>";
    };
    const auto polynomial = [&](const std::string& terms) {
        return calibrated("<PolynomialCalibrator>" + terms + "</PolynomialCalibrator>");
    };
    const auto spline = [&](const std::string& attributes, const std::string& point) {
        return calibrated("<SplineCalibrator " + attributes + "><SplinePoint raw='0' calibrated='0'/>" + point +
                          "<SplinePoint raw='10' calibrated='100'/></SplineCalibrator>");
    };
    const auto octets = [](const std::string& size) {
        return "<BinaryParameterType name='t'><BinaryDataEncoding><SizeInBits>" + size +
               "</SizeInBits></BinaryDataEncoding></BinaryParameterType>";
    };
    const auto by_n = [&](const std::string& line) {
        return octets("<DynamicValue><ParameterInstanceRef parameterRef='n'/><LinearAdjustment " + line +
                      "/></DynamicValue>");
    };
    const auto read = [](const std::string& type) {
        const Mission mission{
            type, {{"n", "u8"}, {"k", "t"}, {"z", "u8"}}, container("P", entry("n") + entry("k") + entry("z"))};
        const auto contents = mission.decode("02 05 07");
        const auto found = mission.findings.empty() ? std::string{} : mission.findings[0].message + ": ";
        return found + (contents.problem.empty() ? text(contents) : contents.problem);
    };
    CHECK(read(polynomial("<Term coefficient='1' exponent='0'/><Term coefficient=' +2 ' exponent='1'/>")) ==
          "n=2|2 k=5|11 z=7|7");
    CHECK(read(polynomial("<Term coefficient='abc' exponent='0'/><Term coefficient='2' exponent='1'/>")) ==
          "coefficient 'abc' is not a number: n=2|2 k=5|undefined z=7|7");
    CHECK(read(polynomial("<Term exponent='0'/><Term coefficient='2' exponent='1'/>")) ==
          "Term has no coefficient: n=2|2 k=5|undefined z=7|7");
    CHECK(read(polynomial("<Term coefficient='1'/>")) == "Term has no exponent: n=2|2 k=5|undefined z=7|7");
    CHECK(read(polynomial("<Term coefficient='1' exponent='0'/><Term coefficient='2' exponent='40'/>")) ==
          "exponent '40' is not a whole number from 0 to 32: n=2|2 k=5|undefined z=7|7");
    CHECK(read(polynomial("")) == "a polynomial without terms: its values are undefined: n=2|2 k=5|undefined z=7|7");
    CHECK(read(polynomial("<Term coefficient='1' exponent='0'/><Trem coefficient='2' exponent='1'/>")) ==
          "element 'Trem' in PolynomialCalibrator is unknown or not supported: n=2|2 k=5|undefined z=7|7");
    CHECK(read(spline("extrapolat='true'", "")) ==
          "attribute 'extrapolat' of SplineCalibrator is unknown or not supported: n=2|2 k=5|undefined z=7|7");
    CHECK(read(spline("", "<SplinPoint raw='5' calibrated='7'/>")) ==
          "element 'SplinPoint' in SplineCalibrator is unknown or not supported: n=2|2 k=5|undefined z=7|7");
    CHECK(read(spline("", "")) == "n=2|2 k=5|50 z=7|7");
    CHECK(read(spline("", "<SplinePoint raw='5' calibrated='x'/>")) ==
          "calibrated 'x' is not a number: n=2|2 k=5|undefined z=7|7");
    CHECK(read(spline("", "<SplinePoint raw='5'/>")) == "SplinePoint has no calibrated: n=2|2 k=5|undefined z=7|7");
    CHECK(read(spline("order='quadratic'", "")) ==
          "order 'quadratic' is not a whole number from 0 to 1000: n=2|2 k=5|undefined z=7|7");
    CHECK(read(spline("extrapolate='perhaps'", "")) ==
          "extrapolate 'perhaps' is neither true nor false: n=2|2 k=5|undefined z=7|7");

    const std::string no_size = "the size of k cannot be known (line 1)";
    CHECK(read(by_n("slope='4' intercept='0'")) == "n=2|2 k=05|05 z=7|7");
    CHECK(read(by_n("slope='eight' intercept='8'")) == "slope 'eight' is not a number: " + no_size);
    CHECK(read(by_n("slope='8' intercept='eight'")) == "intercept 'eight' is not a number: " + no_size);
    CHECK(
        read(octets("<DynamicValue><ParameterInstanceRef parameterRef='n' useCalibratedValue='2'/></DynamicValue>")) ==
        "useCalibratedValue '2' is neither true nor false: " + no_size);
    CHECK(read(octets("<DynamicValue><ParameterInstanceRef parameterRef='n' instance='x'/></DynamicValue>")) ==
          "instance 'x' is not a whole number from -2147483648 to 2147483647: " + no_size);
    CHECK(read(octets("<DiscreteLookupList><DiscreteLookup value='x'><Comparison parameterRef='n' value='2'/>"
                      "</DiscreteLookup></DiscreteLookupList>")) == "value 'x' is not a number: " + no_size);
    CHECK(read(octets("<FixedValue>\n8\n</FixedValue>")) == "n=2|2 k=05|05 z=7|7");

    const std::string list = "<ByteOrderList><Byte byteSignificance='0'/></ByteOrderList>";
    CHECK(read("<IntegerParameterType name='t'><IntegerDataEncoding sizeInBits='16'>" + list +
               "</IntegerDataEncoding></IntegerParameterType>") ==
          "ByteOrderList does not name each of 2 octets once: octets are given: the packet ends before z: 8 bits at "
          "bit 24 of 24 (line 1)");
}

TEST_CASE("a spline extends outside its points where the file says so", "[telemetry][R55]") {
    const auto type = [](const char* attributes) {
        return std::string{"<FloatParameterType name='t'><IntegerDataEncoding sizeInBits='16'><DefaultCalibrator>"
                           "<SplineCalibrator "} +
               attributes +
               "><SplinePoint raw='10' calibrated='5'/><SplinePoint raw='20' calibrated='15'/><SplinePoint raw='40' "
               "calibrated='20'/></SplineCalibrator></DefaultCalibrator></IntegerDataEncoding></FloatParameterType>";
    };
    const auto value = [&](const char* attributes, const char* octets) {
        const Mission mission{type(attributes), {{"v", "t"}}, container("P", entry("v"))};
        CHECK(mission.findings.empty());
        return datum_text(mission.decode(octets).values.at(0).calibrated);
    };
    for (const char* outside : {"0000", "0009", "0029", "ffff"}) CHECK(value("", outside) == "undefined");
    CHECK(value("", "000a") == "5");
    CHECK(value("", "0014") == "15");
    CHECK(value("", "001e") == "17.5");
    CHECK(value("", "0028") == "20");
    const char* extended = "extrapolate='true'";
    CHECK(value(extended, "0000") == "-5");
    CHECK(value(extended, "0014") == "15");
    CHECK(value(extended, "003c") == "25");
    CHECK(value("order='0' extrapolate='true'", "0000") == "5");
    CHECK(value("order='0' extrapolate='true'", "ffff") == "20");
    CHECK(value("order='0'", "0013") == "5");
    CHECK(value("order='0'", "ffff") == "undefined");
}

TEST_CASE("entries repeat as often as told, are there only when their condition holds, and stand where told",
          "[telemetry]") {
    const std::string repeat =
        "<RepeatEntry><Count><DynamicValue><ParameterInstanceRef parameterRef='n'/></DynamicValue>"
        "</Count><Offset><FixedValue>8</FixedValue></Offset></RepeatEntry>";
    const std::string include = "<IncludeCondition>" + when("n", "!=", "2") + "</IncludeCondition>";
    const std::string at_start =
        "<LocationInContainerInBits referenceLocation='containerStart'><FixedValue>4</FixedValue>"
        "</LocationInContainerInBits>";
    const Mission mission{"",
                          {{"n", "u8"}, {"a", "u8"}, {"b", "u8"}, {"c", "u8"}},
                          container("P", entry("n") + entry("a", repeat) + entry("b", include) + entry("c", at_start))};
    CHECK(mission.findings.empty());
    CHECK(text(mission.decode("02 01ff02 99")) == "n=2|2 a[0]=1|1 a[1]=2|2 c=32|32");
    CHECK(text(mission.decode("01 01 99")) == "n=1|1 a[0]=1|1 b=153|153 c=16|16");
    CHECK(text(mission.decode("00 77")) == "n=0|0 b=119|119 c=7|7");
}

TEST_CASE("labels, flags, polynomials, splines and calibrators by context", "[telemetry]") {
    const Mission mission{
        "<EnumeratedParameterType name='mode'><IntegerDataEncoding sizeInBits='4'/><EnumerationList>"
        "<Enumeration value='1' label='ON'/><Enumeration value='2' maxValue='5' label='WARM'/></EnumerationList>"
        "</EnumeratedParameterType><BooleanParameterType name='flag' oneStringValue='yes'><IntegerDataEncoding "
        "sizeInBits='4'/></BooleanParameterType><FloatParameterType name='volt'><IntegerDataEncoding sizeInBits='8' "
        "encoding='twosComplement'><DefaultCalibrator><PolynomialCalibrator><Term coefficient='1' exponent='0'/><Term "
        "coefficient='0.5' exponent='1'/></PolynomialCalibrator></DefaultCalibrator><ContextCalibratorList>"
        "<ContextCalibrator><ContextMatch>" +
            when("m", "==", "WARM") +
            "</ContextMatch><Calibrator><PolynomialCalibrator><Term coefficient='10' "
            "exponent='1'/></PolynomialCalibrator>"
            "</Calibrator></ContextCalibrator></ContextCalibratorList></IntegerDataEncoding></FloatParameterType>"
            "<FloatParameterType name='temp'><IntegerDataEncoding sizeInBits='8'><DefaultCalibrator><SplineCalibrator>"
            "<SplinePoint raw='100' calibrated='30'/><SplinePoint raw='0' calibrated='-10'/></SplineCalibrator>"
            "</DefaultCalibrator></IntegerDataEncoding></FloatParameterType>",
        {{"m", "mode"}, {"f", "flag"}, {"v", "volt"}, {"t", "temp"}},
        container("P", entry("m") + entry("f") + entry("v") + entry("t"))};
    CHECK(mission.findings.empty());
    CHECK(text(mission.decode("11 fe 32")) == "m=1|ON f=1|yes v=-2|0 t=50|10");
    CHECK(text(mission.decode("30 02 65")) == "m=3|WARM f=0|False v=2|20 t=101|undefined");
    CHECK(text(mission.decode("90 02 64")) == "m=9|9 f=0|False v=2|2 t=100|30");
}

TEST_CASE("text of fixed size, ended by a character, and behind its own size", "[telemetry]") {
    const auto type = [](const std::string& name, const std::string& size) {
        return "<StringParameterType name='" + name + "'><StringDataEncoding>" + size +
               "</StringDataEncoding></StringParameterType>";
    };
    const Mission mission{
        type("fixed", "<SizeInBits><Fixed><FixedValue>32</FixedValue></Fixed></SizeInBits>") +
            type("ended", "<Variable maxSizeInBits='80'><TerminationChar>00</TerminationChar></Variable>") +
            type("sized", "<Variable maxSizeInBits='80'><LeadingSize sizeInBitsOfSizeTag='8'/></Variable>") +
            type("boxed", "<SizeInBits><Fixed><FixedValue>32</FixedValue></Fixed><TerminationChar>2c</TerminationChar>"
                          "</SizeInBits>"),
        {{"a", "fixed"}, {"b", "ended"}, {"c", "sized"}, {"d", "boxed"}, {"e", "u8"}},
        container("P", entry("a") + entry("b") + entry("c") + entry("d") + entry("e"))};
    CHECK(mission.findings.empty());
    CHECK(text(mission.decode("41420000 434400 10 4546 472c4849 01")) ==
          "a=41420000|AB b=4344|CD c=4546|EF d=47|G e=1|1");
    CHECK(mission.decode("41420000 434400 60 4546").problem.find("ends before c") != std::string::npos);
}

TEST_CASE("what is composed: members, arrays of one and two dimensions, containers within containers", "[telemetry]") {
    const Mission mission{
        "<AggregateParameterType name='pair'><MemberList><Member name='x' typeRef='u8'/><Member name='y' "
        "typeRef='u16'/>"
        "</MemberList></AggregateParameterType><ArrayParameterType name='row' "
        "arrayTypeRef='u8'><DimensionList><Dimension>"
        "<StartingIndex><FixedValue>0</FixedValue></StartingIndex><EndingIndex><DynamicValue><ParameterInstanceRef "
        "parameterRef='n'/></DynamicValue></EndingIndex></Dimension><Dimension><EndingIndex><FixedValue>1</FixedValue>"
        "</EndingIndex></Dimension></DimensionList></ArrayParameterType>",
        {{"n", "u8"}, {"p", "pair"}, {"r", "row"}},
        container("Inner", entry("p")) +
            container("P", entry("n") + "<ContainerRefEntry containerRef='Inner'/>" + entry("r"))};
    CHECK(mission.findings.empty());
    CHECK(text(mission.decode("01 050102 0a0b0c0d")) ==
          "n=1|1 p.x=5|5 p.y=258|258 r[0][0]=10|10 r[0][1]=11|11 r[1][0]=12|12 r[1][1]=13|13");
}

TEST_CASE("a condition and a size may ask for a member of what is composed", "[telemetry]") {
    const std::string types =
        "<AggregateParameterType name='head'><MemberList><Member name='id' typeRef='u8'/><Member "
        "name='sizes' typeRef='sizes'/></MemberList></AggregateParameterType><AggregateParameterType "
        "name='sizes'><MemberList><Member name='all' typeRef='u8'/><Member name='n' typeRef='u8'/>"
        "</MemberList></AggregateParameterType>";
    const std::string octets = "<BinaryParameterType name='octets'><BinaryDataEncoding><SizeInBits><DynamicValue>"
                               "<ParameterInstanceRef parameterRef='h/sizes/n'/><LinearAdjustment slope='8'/>"
                               "</DynamicValue></SizeInBits></BinaryDataEncoding></BinaryParameterType>";
    const Mission mission{types + octets,
                          {{"h", "head"}, {"d", "octets"}},
                          container("Root", entry("h")) +
                              container("Seven", entry("d"), base("Root", when("h/id", "==", "7")))};
    CHECK(mission.findings.empty());
    CHECK(text(mission.decode("07 0902 a1b2c3")) == "h.id=7|7 h.sizes.all=9|9 h.sizes.n=2|2 d=a1b2|a1b2");
    CHECK(mission.decode("08 0902 a1b2c3").container == "Root");
    const Mission dangling{
        types, {{"h", "head"}}, container("Root", entry("h"), base("Root", when("h/gone", "==", "7")))};
    REQUIRE(dangling.findings.size() == 2);
    CHECK(dangling.findings[0].message == "there is no parameter 'h/gone'");
    CHECK_THAT(dangling.findings[1].message, Catch::Contains("'Root' derives from itself"));
}

TEST_CASE("time is seconds from the epoch, by offset and scale", "[telemetry]") {
    const Mission mission{
        "<AbsoluteTimeParameterType name='when'><Encoding offset='1000' scale='0.5'><IntegerDataEncoding "
        "sizeInBits='32'/></Encoding></AbsoluteTimeParameterType>",
        {{"t", "when"}},
        container("P", entry("t"))};
    CHECK(mission.decode("00000009").time->seconds == 1004.5);
}

TEST_CASE("what is not supported is named with its line, and the packet is read up to it", "[telemetry]") {
    const Mission mission{"",
                          {{"a", "u8"}, {"b", "nowhere"}, {"c", "u8"}},
                          container("P", entry("a") + "\n<StreamSegmentEntry streamRef='s'/>" + entry("c")) +
                              container("Q", entry("b"), base("P", when("a", "==", "99")))};
    REQUIRE(mission.findings.size() == 2);
    CHECK(mission.findings[1].line == 2);
    CHECK(mission.findings[1].message.find("StreamSegmentEntry") != std::string::npos);
    const auto contents = mission.decode("07 08");
    CHECK(text(contents) == "a=7|7");
    CHECK(contents.problem.find("(line 2)") != std::string::npos);
}

TEST_CASE("containers and types that hold themselves, and counts without end, come to an end", "[telemetry]") {
    const std::string endless = "<RepeatEntry><Count><FixedValue>1000000000000</FixedValue></Count></RepeatEntry>";
    const std::string self = "<ContainerRefEntry containerRef='A'/>";
    const Mission loop{"", {{"a", "u8"}}, container("P", self) + container("A", self + self)};
    CHECK_FALSE(loop.decode("0102").problem.empty());
    const Mission bases{"", {{"a", "u8"}}, container("A", "", base("B", "")) + container("B", "", base("A", ""))};
    CHECK(bases.decode("0102").problem == "the XTCE file has no container to begin with");
    const Mission nothing{"",
                          {{"a", "u8"}},
                          container("P", "<ContainerRefEntry containerRef='E'>" + endless + "</ContainerRefEntry>") +
                              container("E", "")};
    CHECK_FALSE(nothing.decode("0102").problem.empty());
    const Mission type{"<AggregateParameterType name='t'><MemberList><Member name='m' typeRef='t'/><Member name='n' "
                       "typeRef='t'/></MemberList></AggregateParameterType>",
                       {{"a", "t"}},
                       container("P", entry("a"))};
    CHECK_FALSE(type.decode("0102").problem.empty());
}

TEST_CASE("a datum is written in the fewest digits that read back the same", "[telemetry]") {
    CHECK(datum_text(Datum{}) == "undefined");
    CHECK(datum_text(0.1) == "0.1");
    CHECK(datum_text(std::uint64_t{18446744073709551615U}) == "18446744073709551615");
    CHECK(datum_text(std::int64_t{-5}) == "-5");
    CHECK(datum_text(std::vector<std::uint8_t>{0x0A, 0xFF}) == "0aff");
}

TEST_CASE(
    "a fine time that counts from the coarse one makes the packet's time finer; a duration is no time of a packet",
    "[telemetry]") {
    const std::string types =
        "<AbsoluteTimeParameterType name='coarse_t'><Encoding><IntegerDataEncoding "
        "sizeInBits='16'/></Encoding><ReferenceTime>"
        "<Epoch>Gps</Epoch></ReferenceTime></AbsoluteTimeParameterType><AbsoluteTimeParameterType "
        "name='fine_t'><Encoding "
        "scale='0.25'><IntegerDataEncoding sizeInBits='8'/></Encoding><ReferenceTime><OffsetFrom parameterRef='c'/>"
        "</ReferenceTime></AbsoluteTimeParameterType><RelativeTimeParameterType "
        "name='span'><Encoding><IntegerDataEncoding "
        "sizeInBits='8'/></Encoding></RelativeTimeParameterType>";
    const Mission mission{types,
                          {{"c", "coarse_t"}, {"f", "fine_t"}, {"d", "span"}},
                          container("P", entry("d") + entry("c") + entry("f"))};
    CHECK(mission.findings.empty());
    const auto contents = mission.decode("09 0064 03");
    CHECK(text(contents) == "d=9|9 c=100|100 f=3|100.75");
    CHECK(contents.time->seconds == 100.75);
    CHECK(contents.time->epoch == "GPS");
}

TEST_CASE("two numbers right behind the primary header are the clock when their names say so, and nowhere else",
          "[telemetry]") {
    const std::string types =
        "<IntegerParameterType name='u48'><IntegerDataEncoding sizeInBits='48'/></IntegerParameterType>"
        "<IntegerParameterType name='u32'><IntegerDataEncoding sizeInBits='32'/></IntegerParameterType>";
    const auto time_of = [&](const std::string& first, const std::string& second, const std::string& type = "u32") {
        const Mission mission{types,
                              {{"header", "u48"}, {first, type}, {second, "u16"}},
                              container("P", entry("header") + entry(first) + entry(second))};
        return mission.decode("000000000000 00000007 8000 0000").time;
    };
    CHECK(time_of("SHCOARSE", "SHFINE")->seconds == 7.5);
    CHECK(time_of("SHCOARSE", "SHFINE")->epoch.empty());
    CHECK(time_of("sclk_coarse", "sclk_fine")->seconds == 7.5);
    CHECK_FALSE(time_of("SHCOARSE", "COUNT"));
    CHECK_FALSE(time_of("COUNT", "SHFINE"));
    CHECK_FALSE(time_of("SHCOARSE", "SHFINE", "u48"));
    const Mission elsewhere{
        types, {{"SHCOARSE", "u32"}, {"SHFINE", "u16"}}, container("P", entry("SHCOARSE") + entry("SHFINE"))};
    CHECK_FALSE(elsewhere.decode("000000000000 00000007 8000").time);
}

TEST_CASE("a value is undefined where the condition of its validity does not hold", "[telemetry]") {
    std::vector<dictionary::Finding> findings;
    dictionary::Findings into{"t.xml", findings};
    const auto model = xtce::read_packet_model(
        "<SpaceSystem name='T'><TelemetryMetaData><ParameterTypeSet><IntegerParameterType "
        "name='u8'><IntegerDataEncoding/>"
        "</IntegerParameterType></ParameterTypeSet><ParameterSet><Parameter name='flag' parameterTypeRef='u8'/>"
        "<Parameter name='x' parameterTypeRef='u8'><ParameterProperties><ValidityCondition><Comparison "
        "parameterRef='flag' "
        "value='1'/></ValidityCondition></ParameterProperties></Parameter></ParameterSet><ContainerSet>" +
            container("P", entry("flag") + entry("x")) + "</ContainerSet></TelemetryMetaData></SpaceSystem>",
        into);
    REQUIRE(model);
    CHECK(findings.empty());
    const ContainerDecoder decoder{*model};
    CHECK(text(decoder.decode(test::hex("0109"))) == "flag=1|1 x=9|9");
    CHECK(text(decoder.decode(test::hex("0009"))) == "flag=0|0 x=9|undefined");
}

}  // namespace telemetry_container_decoder_test
