// SPDX-License-Identifier: Apache-2.0
// Constructs of other missions' XTCE files, as their authors write them.
#include "telemetry/container_decoder.hpp"
#include "telemetry/other_mission.hpp"
#include "telemetry/time_source.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/octets.hpp"

#include <string>
#include <vector>

namespace telemetry_xtce_as_written_test {

using namespace aeolis;
using namespace aeolis::telemetry;
using dictionary::xtce::ReadAgreement;
using dictionary::xtce::XtceText;

namespace {

struct Read {
    std::string values;  ///< "a=1 b=text", then the problem
    std::vector<std::string> findings;
};

Read read(const std::vector<XtceText>& texts, std::string_view packet, const ReadAgreement& agreement = {}) {
    Read read;
    std::vector<dictionary::Finding> findings;
    const auto model = dictionary::xtce::read_packet_model(texts, findings, agreement);
    for (const auto& finding : findings) read.findings.push_back(finding.file + ": " + finding.message);
    if (!model) return read;
    const ContainerDecoder decoder{*model};
    const auto contents = decoder.decode(test::hex(packet));
    for (const auto& value : contents.values)
        read.values += (read.values.empty() ? "" : " ") + value.name + "=" + datum_text(value.calibrated);
    if (!contents.problem.empty()) read.values += " ! " + contents.problem;
    return read;
}

const std::string u8 = "<IntegerParameterType name='u8'><IntegerDataEncoding/></IntegerParameterType>";
const std::string u16 =
    "<IntegerParameterType name='u16'><IntegerDataEncoding sizeInBits='16'/></IntegerParameterType>";

std::string system_of(const std::string& types, const std::string& parameters, const std::string& containers,
                      const std::string& more = "", const std::string& name = "S") {
    return "<SpaceSystem name='" + name +
           "' xmlns='http://www.omg.org/spec/XTCE/20180204'><TelemetryMetaData>"
           "<ParameterTypeSet>" +
           types + "</ParameterTypeSet><ParameterSet>" + parameters + "</ParameterSet><ContainerSet>" + containers +
           "</ContainerSet>" + more + "</TelemetryMetaData></SpaceSystem>";
}
std::string parameter(const std::string& name, const std::string& type) {
    return "<Parameter name='" + name + "' parameterTypeRef='" + type + "'/>";
}
std::string container(const std::string& name, const std::vector<std::string>& entries, const std::string& more = "") {
    std::string text = "<SequenceContainer name='" + name + "'><EntryList>";
    for (const auto& entry : entries) text += "<ParameterRefEntry parameterRef='" + entry + "'/>";
    return text + "</EntryList>" + more + "</SequenceContainer>";
}
std::string text_type(const std::string& characters, const std::string& size) {
    return "<StringParameterType name='t'><StringDataEncoding encoding='" + characters + "'><SizeInBits>" + size +
           "</SizeInBits></StringDataEncoding></StringParameterType>";
}

}  // namespace

TEST_CASE("elements of XTCE count under any prefix that is bound to it", "[telemetry][xtce][R54]") {
    const std::string space = "http://www.omg.org/spec/XTCE/20180204";
    const auto with = [&](const std::string& root, const std::string& inner, const std::string& bound) {
        const auto p = [](const std::string& prefix) { return prefix.empty() ? "" : prefix + ":"; };
        return "<" + p(root) + "SpaceSystem name='S' " + bound + "><" + p(inner) + "TelemetryMetaData><" + p(root) +
               "ParameterTypeSet><" + p(inner) + "IntegerParameterType name='u8'><" + p(inner) +
               "IntegerDataEncoding/></" + p(inner) + "IntegerParameterType></" + p(root) + "ParameterTypeSet><" +
               p(inner) + "ParameterSet><" + p(root) + "Parameter name='a' parameterTypeRef='u8'/></" + p(inner) +
               "ParameterSet><" + p(inner) + "ContainerSet><" + p(inner) + "SequenceContainer name='P'><" + p(inner) +
               "EntryList><" + p(inner) + "ParameterRefEntry parameterRef='a'/></" + p(inner) + "EntryList></" +
               p(inner) + "SequenceContainer></" + p(inner) + "ContainerSet></" + p(inner) + "TelemetryMetaData></" +
               p(root) + "SpaceSystem>";
    };
    for (const auto& text :
         {with("", "x", "xmlns='" + space + "' xmlns:x='" + space + "'"), with("x", "", "xmlns:x='" + space + "'"),
          with("a", "b", "xmlns:a='" + space + "' xmlns:b='" + space + "'"), with("q", "q", "xmlns:q='urn:other'")})
        CHECK(read({{"m.xml", text}}, "07").values == "a=7");
    // A foreign element is none of XTCE's.
    CHECK(read({{"m.xml", with("", "f", "xmlns='" + space + "' xmlns:f='urn:foreign'")}}, "07").values.find("a=7") ==
          std::string::npos);
}

TEST_CASE("several files are one mission: they refer to each other, and a finding names its file",
          "[telemetry][xtce][R54]") {
    const auto types = system_of(u8 + "<StrangeParameterType name='odd'/>", "", "", "", "Types");
    const auto packets =
        system_of("", parameter("a", "/Types/u8") + parameter("b", "Types/u8") + parameter("c", "../Types/u8"),
                  container("P", {"a", "./b", "/Packets/c"}), "", "Packets");
    const auto both = read({{"packets.xml", packets}, {"types.xml", types}}, "010203");
    CHECK(both.values == "a=1 b=2 c=3");
    CHECK(both.findings.empty());  // the odd type is used by nothing
    const auto alone = read({{"packets.xml", packets}}, "010203");
    REQUIRE(alone.findings.size() == 3);
    CHECK(alone.findings[0] == "packets.xml: there is no type '/Types/u8'");
    // One SpaceSystem in two files.
    CHECK(
        read({{"1.xml", system_of(u8, "", "")}, {"2.xml", system_of("", parameter("a", "u8"), container("P", {"a"}))}},
             "09")
            .values == "a=9");
    CHECK(read({{"1.xml", "<no xml"}, {"2.xml", packets}}, "09").findings[0].starts_with("1.xml: "));
}

TEST_CASE("names may have dots and colons, and a member is reached by a dot or a slash", "[telemetry][xtce][R54]") {
    const std::string types = u8 + "<AggregateParameterType name='pair'><MemberList><Member name='n' typeRef='u8'/>"
                                   "<Member name='x' typeRef='u8'/></MemberList></AggregateParameterType>";
    for (const char* reference : {"HK.p.n", "HK.p/n"}) {
        const auto repeated =
            "<SequenceContainer name='P'><EntryList><ParameterRefEntry parameterRef='HK.p'/><ParameterRefEntry "
            "parameterRef='A:B.C'><RepeatEntry><Count><DynamicValue><ParameterInstanceRef parameterRef='" +
            std::string(reference) +
            "'/></DynamicValue></Count></RepeatEntry></ParameterRefEntry></EntryList></SequenceContainer>";
        const auto found = read(
            {{"m.xml", system_of(types, parameter("HK.p", "pair") + parameter("A:B.C", "u8"), repeated)}}, "02ff0506");
        INFO(reference);
        CHECK(found.findings.empty());
        CHECK(found.values == "HK.p.n=2 HK.p.x=255 A:B.C[0]=5 A:B.C[1]=6");
    }
}

TEST_CASE("a leading size counts bits, or octets where that is agreed", "[telemetry][xtce][R54]") {
    const auto of = [&](std::string_view packet, unsigned unit_bits) {
        return read({{"m.xml", system_of(text_type("UTF-8", "<LeadingSize sizeInBitsOfSizeTag='8'/>") + u8,
                                         parameter("s", "t") + parameter("a", "u8"), container("P", {"s", "a"}))}},
                    packet, {.leading_size_unit_bits = unit_bits})
            .values;
    };
    CHECK(of("10 4142 07", 1) == "s=AB a=7");
    CHECK(of("02 4142 07", 8) == "s=AB a=7");
    CHECK_THAT(of("10 4142 07", 8), Catch::Contains("the packet ends before s"));
}

TEST_CASE("text of UTF-16 ends at a character of two octets", "[telemetry][xtce][R54]") {
    const auto found =
        read({{"m.xml", system_of(text_type("UTF-16BE", "<TerminationChar>0000</TerminationChar>") + u8,
                                  parameter("s", "t") + parameter("a", "u8"), container("P", {"s", "a"}))}},
             "0100 0041 0000 07");
    CHECK(found.findings.empty());
    CHECK(found.values == "s=ĀA a=7");
}

TEST_CASE("least significant bit and octet first together are a field that begins with its least significant bit",
          "[telemetry][xtce][R54]") {
    const auto of = [&](const std::string& attributes, unsigned bits, std::string_view packet) {
        return read({{"m.xml", system_of("<IntegerParameterType name='n'><IntegerDataEncoding sizeInBits='" +
                                             std::to_string(bits) + "' " + attributes + "/></IntegerParameterType>",
                                         parameter("a", "n"), container("P", {"a"}))}},
                    packet)
            .values;
    };
    const std::string bit = "bitOrder='leastSignificantBitFirst' ", octet = "byteOrder='leastSignificantByteFirst'";
    CHECK(of(bit + octet, 16, "48 2c") == "a=13330");  // 0x3412: 0001 0010 and 0011 0100, each and both reversed
    CHECK(of(octet, 16, "12 34") == "a=13330");
    CHECK(of(bit, 16, "2c 48") == "a=13330");
}

TEST_CASE("an empty list of conditions restricts nothing", "[telemetry][xtce][R54]") {
    const auto xtce = system_of(
        u8, parameter("a", "u8") + parameter("b", "u8"),
        container("Base", {"a"}) + container("P", {"b"},
                                             "<BaseContainer containerRef='Base'><RestrictionCriteria><ComparisonList/>"
                                             "</RestrictionCriteria></BaseContainer>"));
    CHECK(read({{"m.xml", xtce}}, "0102").values == "a=1 b=2");
}

TEST_CASE("an algorithm is named as not run, and the packets are read", "[telemetry][xtce][R54]") {
    const auto found = read({{"m.xml", system_of(u8, parameter("a", "u8"), container("P", {"a"}),
                                                 "<AlgorithmSet><MathAlgorithm name='Power'/></AlgorithmSet>")}},
                            "05");
    CHECK(found.values == "a=5");
    REQUIRE(found.findings.size() == 1);
    CHECK(found.findings[0] == "m.xml: MathAlgorithm 'Power' is not run");
}

// Constructs that were met in public databases, written anew: docs/missions.md names those that can be named.

TEST_CASE("an array may be empty: its last index is then −1", "[telemetry][xtce][R54]") {
    const std::string list =
        "<ArrayParameterType name='list' arrayTypeRef='u8'><DimensionList><Dimension><StartingIndex><FixedValue>0"
        "</FixedValue></StartingIndex><EndingIndex><DynamicValue><ParameterInstanceRef parameterRef='n'/>"
        "<LinearAdjustment intercept='-1'/></DynamicValue></EndingIndex></Dimension></DimensionList>"
        "</ArrayParameterType>";
    const auto of = [&](std::string_view packet) {
        return read(
                   {{"m.xml", system_of(u8 + list, parameter("n", "u8") + parameter("l", "list") + parameter("z", "u8"),
                                        container("P", {"n", "l", "z"}))}},
                   packet)
            .values;
    };
    CHECK(of("00 09") == "n=0 z=9");
    CHECK(of("02 0506 09") == "n=2 l[0]=5 l[1]=6 z=9");
    CHECK_THAT(of("03 0506"), Catch::Contains("the packet ends before l[2]"));
}

TEST_CASE("a size that counts a member of the aggregate around it is that member's, whatever else has its name",
          "[telemetry][xtce][R54]") {
    const auto array = [](const std::string& name, const std::string& of, const std::string& count) {
        return "<ArrayParameterType name='" + name + "' arrayTypeRef='" + of +
               "'><DimensionList><Dimension><StartingIndex><FixedValue>0</FixedValue></StartingIndex><EndingIndex>"
               "<DynamicValue><ParameterInstanceRef parameterRef='" +
               count +
               "' y:aggregateMember='true'/><LinearAdjustment intercept='-1'/></DynamicValue></EndingIndex>"
               "</Dimension></DimensionList></ArrayParameterType>";
    };
    const auto aggregate = [](const std::string& name, const std::string& count, const std::string& list,
                              const std::string& type) {
        return "<AggregateParameterType name='" + name + "'><MemberList><Member name='" + count +
               "' typeRef='u8'/><Member name='" + list + "' typeRef='" + type +
               "'/></MemberList></AggregateParameterType>";
    };
    auto text = system_of(u8 + array("inner", "u8", "n") + aggregate("item", "n", "v", "inner") +
                              array("outer", "item", "count") + aggregate("report", "count", "items", "outer"),
                          parameter("count", "u8") + parameter("r", "report"), container("P", {"count", "r"}));
    text.insert(text.find(" xmlns="), " xmlns:y='urn:some:extension'");
    const auto found = read({{"m.xml", text}}, "07 02 01 0a 02 0b0c");
    CHECK(found.findings.empty());
    CHECK(found.values == "count=7 r.count=2 r.items[0].n=1 r.items[0].v[0]=10 r.items[1].n=2 r.items[1].v[0]=11 "
                          "r.items[1].v[1]=12");
}

TEST_CASE("a calibrated count is whole within the digits of its coefficients, and no further",
          "[telemetry][xtce][R54]") {
    const auto of = [&](const std::string& slope) {
        const std::string count =
            "<IntegerParameterType name='c'><IntegerDataEncoding><DefaultCalibrator><PolynomialCalibrator>"
            "<Term coefficient='-3' exponent='0'/><Term coefficient='" +
            slope +
            "' exponent='1'/></PolynomialCalibrator></DefaultCalibrator></IntegerDataEncoding></IntegerParameterType>";
        const std::string packet =
            "<SequenceContainer name='P'><EntryList><ParameterRefEntry parameterRef='n'/><ParameterRefEntry "
            "parameterRef='a'><RepeatEntry><Count><DynamicValue><ParameterInstanceRef parameterRef='n'/>"
            "</DynamicValue></Count></RepeatEntry></ParameterRefEntry></EntryList></SequenceContainer>";
        return read({{"m.xml", system_of(count + u8, parameter("n", "c") + parameter("a", "u8"), packet)}}, "41 0506")
            .values;  // 65/13 − 3
    };
    CHECK_THAT(of("0.07692307692308"), Catch::EndsWith("a[0]=5 a[1]=6"));
    CHECK_THAT(of("0.0769"), Catch::Contains("cannot be known"));
}

TEST_CASE("a container of a told size ends there, whatever its entries take", "[telemetry][xtce][R54]") {
    const auto of = [&](const std::string& bits, std::string_view packet) {
        const std::string record = "<SequenceContainer name='Record'><BinaryEncoding><SizeInBits><FixedValue>" + bits +
                                   "</FixedValue></SizeInBits></BinaryEncoding><EntryList><ParameterRefEntry "
                                   "parameterRef='a'/></EntryList></SequenceContainer>";
        const std::string outer =
            "<SequenceContainer name='P'><EntryList><ContainerRefEntry containerRef='Record'><RepeatEntry><Count>"
            "<FixedValue>2</FixedValue></Count></RepeatEntry></ContainerRefEntry><ParameterRefEntry parameterRef='z'/>"
            "</EntryList></SequenceContainer>";
        return read({{"m.xml", system_of(u8, parameter("a", "u8") + parameter("z", "u8"), outer + record)}}, packet)
            .values;
    };
    CHECK(of("16", "01ff 02ff 09") == "a=1 a=2 z=9");
    CHECK_THAT(of("16", "01ff 02"), Catch::Contains("the packet ends before the end of Record"));
    CHECK_THAT(of("4", "0102 09"), Catch::Contains("the entries of Record are longer than its size, 4 bits"));
}

TEST_CASE("text that tells its own end has no box, though a size that means nothing stands beside it",
          "[telemetry][xtce][R54]") {
    const auto variable = [](const std::string& size) {
        return "<StringParameterType name='t'><StringDataEncoding encoding='UTF-8'><Variable maxSizeInBits='48'>" +
               size + "</Variable></StringDataEncoding></StringParameterType>";
    };
    const auto of = [&](const std::string& size, std::string_view packet) {
        return read(
            {{"m.xml", system_of(variable(size) + u8, parameter("n", "u8") + parameter("s", "t") + parameter("z", "u8"),
                                 container("P", {"n", "s", "z"}))}},
            packet);
    };
    const std::string ignored = "<DynamicValue><ParameterInstanceRef parameterRef='_yamcs_ignore'/></DynamicValue>";
    CHECK(of(ignored + "<TerminationChar>00</TerminationChar>", "04 414200 09").values == "n=4 s=AB z=9");
    CHECK(of(ignored + "<TerminationChar>00</TerminationChar>", "04 414200 09").findings.empty());
    CHECK(of(ignored + "<LeadingSize sizeInBitsOfSizeTag='16'/>", "04 0010 4142 09").values == "n=4 s=AB z=9");
    CHECK(of("<DynamicValue><ParameterInstanceRef parameterRef='n'/><LinearAdjustment slope='8'/></DynamicValue>"
             "<TerminationChar>00</TerminationChar>",
             "04 414200ff 09")
              .values == "n=4 s=AB z=9");  // in a box of four octets
    CHECK_THAT(of(ignored + "<TerminationChar>00</TerminationChar>", "04 4142").values,
               Catch::Contains("the packet ends before the end of s"));
    CHECK(of(ignored, "04 41").findings.size() == 1);  // alone, it is a parameter that there is not
}

TEST_CASE("what is told of a packet's time and not read is a finding", "[telemetry][xtce][R54]") {
    const std::string packet =
        "<SequenceContainer name='P'><EntryList><ParameterRefEntry parameterRef='a'><TimeAssociation parameterRef='a' "
        "interpolateTime='false'/></ParameterRefEntry></EntryList></SequenceContainer>";
    const auto found = read({{"m.xml", system_of(u8, parameter("a", "u8"), packet)}}, "05");
    CHECK(found.values == "a=5");
    REQUIRE(found.findings.size() == 1);
    CHECK_THAT(found.findings[0], Catch::Contains("TimeAssociation is not read"));
}

TEST_CASE("what a root says of itself and its name spaces is no finding", "[telemetry][xtce][R54]") {
    auto text = system_of(u8, parameter("a", "u8"), container("P", {"a"}));
    text.insert(text.find(" xmlns="), " xmlns:y='urn:some:extension' operationalStatus='unittest' systemType='bus'");
    CHECK(read({{"m.xml", text}}, "05").findings.empty());
}

TEST_CASE("names that several parameters of a packet have are unique, and the same as values, channels and times",
          "[telemetry][xtce][R54]") {
    const auto within = [](const std::string& name) {
        return "<SpaceSystem name='" + name + "'><TelemetryMetaData><ParameterSet>" + parameter("TEMP", "/S/u8") +
               parameter("SPARE", "/S/u8") + "</ParameterSet></TelemetryMetaData></SpaceSystem>";
    };
    std::string text = system_of(u8 + "<AggregateParameterType name='pair'><MemberList><Member name='x' typeRef='u8'/>"
                                      "</MemberList></AggregateParameterType>",
                                 parameter("STATUS", "pair") + parameter("STATUS.x", "u8") + parameter("SPARE", "u8"),
                                 container("P", {"A/TEMP", "B/TEMP", "STATUS", "STATUS.x", "B/SPARE"}));
    text.insert(text.find("</SpaceSystem>"), within("A") + within("B"));
    CHECK(read({{"m.xml", text}}, "0102030405").values == "TEMP=1 S/B/TEMP=2 STATUS.x=3 S/STATUS.x=4 SPARE=5");

    std::vector<dictionary::Finding> findings;
    auto model = *dictionary::xtce::read_packet_model({{"m.xml", text}}, findings);
    CHECK(findings.empty());
    const auto ambiguous = TimeSource::parse(model, "TEMP");
    REQUIRE_FALSE(ambiguous);
    CHECK_THAT(ambiguous.error().message, Catch::Contains("several parameters are called 'TEMP'"));
    for (const char* name : {"S/B/TEMP", "/S/B/TEMP", "B/TEMP"}) {
        const auto time = TimeSource::parse(model, name);
        REQUIRE(time);
        CHECK(model.parameters[time->parameter].path == "/S/B/TEMP");
    }
    const OtherMission mission{model, std::uint16_t{1}};
    std::vector<std::string> channels;
    for (const auto& channel : mission.dictionary().channels) channels.push_back(channel.name);
    CHECK(channels == std::vector<std::string>{"TEMP", "S/B/TEMP", "STATUS.x", "S/STATUS.x", "SPARE"});
}

}  // namespace telemetry_xtce_as_written_test
