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

TEST_CASE("entries may lie over the header, told from the packet's beginning, and out of order",
          "[telemetry][xtce][R54]") {  // Yamcs quickstart
    const auto unsigned_of = [](const std::string& name, const std::string& bits) {
        return "<IntegerParameterType name='" + name + "' signed='false'><IntegerDataEncoding sizeInBits='" + bits +
               "'/></IntegerParameterType>";
    };
    const std::string direction =
        "<BooleanParameterType name='direction' zeroStringValue='DOWN' oneStringValue='UP'><IntegerDataEncoding "
        "sizeInBits='1'/></BooleanParameterType>";
    const std::string word =
        "<AggregateParameterType name='word'><MemberList><Member name='V' typeRef='u3'/><Member name='D' "
        "typeRef='direction'/><Member name='Id' typeRef='u12'/></MemberList></AggregateParameterType>";
    const auto over = [](const std::string& name, int bit) {
        return "<ParameterRefEntry parameterRef='" + name +
               "'><LocationInContainerInBits referenceLocation='containerStart'><FixedValue>" + std::to_string(bit) +
               "</FixedValue></LocationInContainerInBits></ParameterRefEntry>";
    };
    const std::string header = "<SequenceContainer name='Header' abstract='true'><EntryList><ParameterRefEntry "
                               "parameterRef='w'/><ParameterRefEntry parameterRef='count'/></EntryList>"
                               "</SequenceContainer>";
    const std::string house =
        "<SequenceContainer name='House'><EntryList><ParameterRefEntry parameterRef='a'/>" + over("low", 29) +
        over("mid", 27) + over("high", 25) +
        "</EntryList><BaseContainer containerRef='Header'><RestrictionCriteria><ComparisonList><Comparison "
        "value='DOWN' parameterRef='w/D'/><Comparison value='100' parameterRef='w/Id'/></ComparisonList>"
        "</RestrictionCriteria></BaseContainer></SequenceContainer>";
    const std::string types = u8 + u16 + unsigned_of("u3", "3") + unsigned_of("u12", "12") + direction + word;
    const std::string parameters = parameter("w", "word") + parameter("count", "u16") + parameter("a", "u8") +
                                   parameter("low", "u3") + parameter("mid", "u3") + parameter("high", "u3");
    const auto of = [&](std::string_view packet) {
        return read({{"m.xml", system_of(types, parameters, header + house)}}, packet);
    };
    const auto found = of("0064 c02d 07");
    CHECK(found.findings.empty());
    CHECK(found.values == "w.V=0 w.D=DOWN w.Id=100 count=49197 a=7 low=5 mid=3 high=2");
    CHECK_THAT(of("1064 c02d 07").values, Catch::Contains("!") && !Catch::Contains("a="));  // UP
    CHECK_THAT(of("0064 c02d 07 09").values, Catch::Contains("8 bits are behind the last entry of House"));
}

TEST_CASE("records are counted by the length they take, calibrated, and lie behind it in boxes of their own",
          "[telemetry][xtce][R54]") {  // xtcetools, diagnostic log
    const std::string form = "<EnumeratedParameterType name='form'><IntegerDataEncoding/><EnumerationList>"
                             "<Enumeration value='0' label='SHORT'/><Enumeration value='1' label='LONG'/>"
                             "</EnumerationList></EnumeratedParameterType>";
    const std::string header = "<SequenceContainer name='Log' abstract='true'><EntryList><ParameterRefEntry "
                               "parameterRef='length'/><ParameterRefEntry parameterRef='form'/></EntryList>"
                               "</SequenceContainer>";
    const std::string types =
        "<IntegerParameterType name='records'><IntegerDataEncoding sizeInBits='16'><DefaultCalibrator>"
        "<PolynomialCalibrator><Term coefficient='-1' exponent='0'/><Term coefficient='0.33333333333333' "
        "exponent='1'/></PolynomialCalibrator></DefaultCalibrator></IntegerDataEncoding></IntegerParameterType>"
        "<IntegerParameterType name='u6'><IntegerDataEncoding sizeInBits='6'/></IntegerParameterType>";
    const auto start = [](int bit) {
        return "<LocationInContainerInBits referenceLocation='containerStart'><FixedValue>" + std::to_string(bit) +
               "</FixedValue></LocationInContainerInBits>";
    };
    const std::string list =
        "<SequenceContainer name='Short'><EntryList><ParameterRefEntry parameterRef='n'>" + start(0) +
        "</ParameterRefEntry><ContainerRefEntry containerRef='Record'>" + start(24) +
        "<RepeatEntry><Count><DynamicValue><ParameterInstanceRef parameterRef='n'/></DynamicValue></Count>"
        "</RepeatEntry></ContainerRefEntry><ParameterRefEntry parameterRef='end'/></EntryList><BaseContainer "
        "containerRef='../Log'><RestrictionCriteria><Comparison parameterRef='form' value='SHORT'/>"
        "</RestrictionCriteria></BaseContainer></SequenceContainer>"
        "<SequenceContainer name='Record'><BinaryEncoding><SizeInBits><FixedValue>24</FixedValue></SizeInBits>"
        "</BinaryEncoding><EntryList><ParameterRefEntry parameterRef='a'/><ParameterRefEntry parameterRef='b'>"
        "<LocationInContainerInBits referenceLocation='previousEntry'><FixedValue>2</FixedValue>"
        "</LocationInContainerInBits></ParameterRefEntry></EntryList></SequenceContainer>";
    auto text =
        system_of(u8 + u16 + form, parameter("length", "u16") + parameter("form", "form"), header, "", "Buffer");
    const auto formats = system_of(
        types, parameter("n", "records") + parameter("a", "../u8") + parameter("b", "u6") + parameter("end", "../u8"),
        list, "", "Formats");
    text.insert(text.rfind("</SpaceSystem>"), formats);
    const auto of = [&](std::string_view packet) { return read({{"m.xml", text}}, packet); };
    const auto found = of("0009 00 01c5ee 02ffee 7f");
    CHECK(found.findings.empty());
    CHECK_THAT(found.values,
               Catch::StartsWith("length=9 form=SHORT n=") && Catch::EndsWith(" a=1 b=5 a=2 b=63 end=127"));
    CHECK_THAT(of("0009 00 01c5ee 02ff").values, Catch::Contains("the packet ends before the end of Record"));
    CHECK_THAT(of("000a 00 01c5ee 02ffee 7f").values, Catch::Contains("cannot be known"));
    CHECK_THAT(of("0009 01 01c5ee 02ffee 7f").values, !Catch::Contains("a="));
}

TEST_CASE("a type has the encoding of the type it is based on, and references go down into SpaceSystems",
          "[telemetry][xtce][R54]") {  // F´
    const std::string types =
        u8 + u16 + "<IntegerParameterType name='Id' baseType='u16' signed='false' sizeInBits='16'/>";
    const std::string base =
        "<SequenceContainer name='Channel' abstract='true'><EntryList><ParameterRefEntry parameterRef='id'/>"
        "<ParameterRefEntry parameterRef='time'/></EntryList></SequenceContainer>";
    auto text = system_of(types, parameter("id", "Id") + parameter("time", "Fw/Time"), base, "", "Deployment");
    const std::string state =
        "<EnumeratedParameterType name='State'><IntegerDataEncoding encoding='unsigned'/><EnumerationList><Enumeration "
        "value='0' label='OK'/><Enumeration value='1' label='BAD'/></EnumerationList></EnumeratedParameterType>";
    const std::string component = system_of(
        state, parameter("State", "Part/State"),
        "<SequenceContainer name='State'><EntryList><ParameterRefEntry parameterRef='Part/State'/></EntryList>"
        "<BaseContainer containerRef='Channel'><RestrictionCriteria><ComparisonList><Comparison parameterRef='id' "
        "value='258'/></ComparisonList></RestrictionCriteria></BaseContainer></SequenceContainer>",
        "", "Part");
    const std::string framework =
        system_of("<AggregateParameterType name='Time'><MemberList><Member name='base' typeRef='Id'/><Member name='s' "
                  "typeRef='u8'/></MemberList></AggregateParameterType>",
                  "", "", "", "Fw");
    text.insert(text.rfind("</SpaceSystem>"), component + framework);
    const auto found = read({{"m.xml", text}}, "0102 0003 09 01");
    CHECK(found.findings.empty());
    CHECK(found.values == "id=258 time.base=3 time.s=9 State=BAD");
    CHECK_THAT(read({{"m.xml", text}}, "0103 0003 09 01").values, !Catch::Contains("State="));
}

TEST_CASE("an array whose size stands nowhere is named, and its packet read up to it",
          "[telemetry][xtce][R54]") {  // GovSat
    const std::string types =
        u8 +
        "<IntegerParameterType name='i8' signed='true'><IntegerDataEncoding sizeInBits='8' "
        "encoding='twosCompliment'/></IntegerParameterType>"
        "<StringParameterType name='label'><StringDataEncoding><SizeInBits><Fixed><FixedValue>32</FixedValue></Fixed>"
        "</SizeInBits></StringDataEncoding></StringParameterType>"
        "<ArrayParameterType numberOfDimensions='1' arrayTypeRef='u8' name='axis'/>";
    auto text = system_of(types, parameter("n", "i8") + parameter("s", "label") + parameter("v", "axis"),
                          container("P", {"n", "s", "v"}));
    const auto found = read({{"m.xml", text}}, "fe 41420000 0102");
    CHECK_THAT(found.values, Catch::Equals("n=-2 s=AB ! the dimensions of v are not known (line 1)"));
    REQUIRE(found.findings.size() == 1);
    CHECK_THAT(found.findings[0], Catch::Contains("the dimensions of the array are told nowhere"));
}

TEST_CASE("a header includes its second part by a flag, and what derives from it begins behind what is there",
          "[telemetry][xtce][R54]") {  // CCSDS 660.1-G
    const std::string types =
        u8 + "<IntegerParameterType name='bit'><IntegerDataEncoding sizeInBits='1'/></IntegerParameterType>"
             "<IntegerParameterType name='u7'><IntegerDataEncoding sizeInBits='7'/></IntegerParameterType>"
             "<AbsoluteTimeParameterType name='seconds'><Encoding units='seconds'><IntegerDataEncoding "
             "sizeInBits='32'/></Encoding><ReferenceTime><Epoch>TAI</Epoch></ReferenceTime>"
             "</AbsoluteTimeParameterType>"
             "<AbsoluteTimeParameterType name='fraction'><Encoding scale='0.001' units='seconds'><IntegerDataEncoding "
             "sizeInBits='16'/></Encoding><ReferenceTime><OffsetFrom parameterRef='coarse'/></ReferenceTime>"
             "</AbsoluteTimeParameterType>"
             "<AbsoluteTimeParameterType name='derived'><ReferenceTime><OffsetFrom parameterRef='coarse'/>"
             "</ReferenceTime></AbsoluteTimeParameterType>"
             "<FloatParameterType name='power4' sizeInBits='64'><IntegerDataEncoding sizeInBits='16' "
             "encoding='twosCompliment'><DefaultCalibrator><PolynomialCalibrator><Term coefficient='-3' exponent='0'/>"
             "<Term coefficient='0.5' exponent='1'/><Term coefficient='25e-2' exponent='4'/></PolynomialCalibrator>"
             "</DefaultCalibrator></IntegerDataEncoding></FloatParameterType>";
    const std::string containers =
        "<SequenceContainer abstract='true' name='Header'><EntryList><ParameterRefEntry parameterRef='has'/>"
        "<ParameterRefEntry parameterRef='type'/><ContainerRefEntry containerRef='Second'><IncludeCondition>"
        "<Comparison parameterRef='has' value='1'/></IncludeCondition></ContainerRefEntry></EntryList>"
        "</SequenceContainer>" +
        container("Second", {"coarse", "fine"}) +
        container("House", {"t"},
                  "<BaseContainer containerRef='Header'><RestrictionCriteria><ComparisonList><Comparison value='24' "
                  "parameterRef='type'/></ComparisonList></RestrictionCriteria></BaseContainer>");
    const auto of = [&](std::string_view packet) {
        return read({{"m.xml", system_of(types,
                                         parameter("has", "bit") + parameter("type", "u7") +
                                             parameter("coarse", "seconds") + parameter("fine", "fraction") +
                                             parameter("t", "power4") + parameter("mission", "derived"),
                                         containers)}},
                    packet);
    };
    CHECK(of("18 fffe").findings.empty());  // a derived time without an encoding is in no packet
    CHECK(of("18 fffe").values == "has=0 type=24 t=0");
    CHECK_THAT(of("98 00000010 01f4 0002").values,
               Catch::StartsWith("has=1 type=24 coarse=") && Catch::EndsWith(" t=2"));
}

TEST_CASE("a type without an encoding is a finding where it is in a packet", "[telemetry][xtce][R54]") {
    const std::string none = "<IntegerParameterType name='none'/><AggregateParameterType name='pair'><MemberList>"
                             "<Member name='a' typeRef='u8'/><Member name='b' typeRef='none'/></MemberList>"
                             "</AggregateParameterType>";
    const auto of = [&](const std::string& type) {
        return read(
            {{"m.xml", system_of(u8 + none, parameter("a", "u8") + parameter("n", type) + parameter("l", "none"),
                                 container("P", {"a", "n"}))}},
            "0102");
    };
    CHECK(of("u8").findings.empty());
    for (const char* type : {"none", "pair"}) {
        const auto found = of(type);
        REQUIRE(found.findings.size() == 1);
        CHECK_THAT(found.findings[0], Catch::Contains("type 'none' has no data encoding"));
        CHECK_THAT(found.values, Catch::StartsWith("a=1") && Catch::Contains("!"));
    }
}

TEST_CASE("calibration by context takes splines of another order, and an operation that is not read leaves undefined",
          "[telemetry][xtce][R54]") {  // BogusSAT
    const auto spline = [](int order, int first) {
        std::string text = "<SplineCalibrator order='" + std::to_string(order) + "'>";
        for (int i = 0; i < 3; ++i)
            text += "<SplinePoint raw='" + std::to_string(10 * i) + "' calibrated='" + std::to_string(first + 5 * i) +
                    "'/>";
        return text + "</SplineCalibrator>";
    };
    const auto context = [](const std::string& label, const std::string& reference, const std::string& calibrator) {
        return "<ContextCalibrator><ContextMatch><Comparison value='" + label + "' parameterRef='" + reference +
               "'/></ContextMatch><Calibrator>" + calibrator + "</Calibrator></ContextCalibrator>";
    };
    const std::string types =
        "<EnumeratedParameterType name='mode'><IntegerDataEncoding/><EnumerationList><Enumeration label='OFF' "
        "value='0'/><Enumeration label='LOW' value='1'/><Enumeration label='HIGH' value='2'/></EnumerationList>"
        "</EnumeratedParameterType><FloatParameterType name='sensor'><IntegerDataEncoding sizeInBits='16' "
        "encoding='twosComplement'><DefaultCalibrator>" +
        spline(1, 0) + "</DefaultCalibrator><ContextCalibratorList>" + context("LOW", "m", spline(1, 5)) +
        context("HIGH", "/S/m", spline(0, 10)) +
        "</ContextCalibratorList></IntegerDataEncoding></FloatParameterType>"
        "<FloatParameterType name='operation'><FloatDataEncoding sizeInBits='32'><DefaultCalibrator>"
        "<MathOperationCalibrator><ValueOperand>0.5</ValueOperand><ThisParameterOperand/><Operator>*</Operator>"
        "</MathOperationCalibrator></DefaultCalibrator></FloatDataEncoding></FloatParameterType>";
    const auto of = [&](std::string_view packet) {
        return read(
            {{"m.xml", system_of(types, parameter("m", "mode") + parameter("s", "sensor") + parameter("o", "operation"),
                                 container("P", {"m", "s", "o"}))}},
            packet);
    };
    CHECK_THAT(of("00 000f 40000000").values, Catch::StartsWith("m=OFF s=7.5 o="));
    CHECK_THAT(of("01 000f 40000000").values, Catch::StartsWith("m=LOW s=12.5 o="));
    CHECK_THAT(of("02 000f 40000000").values, Catch::StartsWith("m=HIGH s=15 o="));
    CHECK_THAT(of("00 ffff 40000000").values, Catch::StartsWith("m=OFF s=undefined o="));  // outside of the spline
    CHECK_THAT(of("00 000f 40000000").values, !Catch::Contains("o=1"));
    REQUIRE(of("00 000f 40000000").findings.size() == 1);
    CHECK_THAT(of("00 000f 40000000").findings[0],
               Catch::Contains("a calibrator that is neither polynomial nor spline"));
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

TEST_CASE("a container that holds or derives from itself is a finding, also where no packet uses it",
          "[telemetry][xtce][R56]") {
    const auto holds = [](const std::string& name, const std::string& entries, const std::string& more = "") {
        return "<SequenceContainer name='" + name + "'><EntryList>" + entries + "</EntryList>" + more +
               "</SequenceContainer>";
    };
    const std::string a = "<ParameterRefEntry parameterRef='a'/>";
    const auto entry = [](const std::string& name) { return "<ContainerRefEntry containerRef='" + name + "'/>"; };
    const auto base = [](const std::string& name) { return "<BaseContainer containerRef='" + name + "'/>"; };
    const auto found =
        read({{"m.xml", system_of(u8, parameter("a", "u8"),
                                  holds("P", a + entry("X")) + holds("X", entry("Y")) + holds("Y", a + entry("X")))}},
             "01 02 03 04");
    CHECK(found.findings ==
          std::vector<std::string>{"m.xml: container 'Y' holds itself, by 'X': packets are read up to it"});
    CHECK_THAT(found.values, Catch::StartsWith("a=1 a=2 ! an entry of Y holds itself"));
    const auto unused = read({{"m.xml", system_of(u8, parameter("a", "u8"),
                                                  holds("P", a) + holds("Z", entry("Z")) + holds("Q", "", base("R")) +
                                                      holds("R", "", base("Q")))}},
                             "01");
    CHECK(unused.findings ==
          std::vector<std::string>{"m.xml: container 'Z' holds itself, by 'Z': packets are read up to it",
                                   "m.xml: container 'R' derives from itself, by 'Q': it takes no packet"});
    CHECK(unused.values == "a=1");
}

TEST_CASE("labels that can never be, and two of one value, are findings that name them", "[telemetry][xtce][R56]") {
    const auto found = read(
        {{"m.xml",
          system_of("<EnumeratedParameterType name='e'><IntegerDataEncoding/><EnumerationList><Enumeration value='1' "
                    "label='A'/><Enumeration value='1' label='B'/><Enumeration value='2' maxValue='1' label='REV'/>"
                    "<Enumeration value='3' maxValue='9' label='C'/><Enumeration value='9' maxValue='12' label='D'/>"
                    "<Enumeration value='12' label='D'/></EnumerationList></EnumeratedParameterType>",
                    parameter("a", "e"), container("P", {"a"}))}},
        "01");
    CHECK(found.values == "a=A");
    CHECK(found.findings == std::vector<std::string>{
                                "m.xml: labels 'A' and 'B' are of one value: it has the first of the file",
                                "m.xml: label 'REV': maxValue 1 is below value 2: it labels nothing",
                                "m.xml: labels 'C' and 'D' are of one value: it has the first of the file",
                            });
}

TEST_CASE("BCD has an octet for each digit and packedBCD half of one, and other octets are no digits",
          "[telemetry][xtce][R56]") {
    const auto digits = [](const std::string& encoding, const char* packet) {
        return read({{"m.xml",
                      system_of("<IntegerParameterType name='d'><IntegerDataEncoding sizeInBits='16' encoding='" +
                                    encoding + "'/></IntegerParameterType>",
                                parameter("a", "d"), container("P", {"a"}))}},
                    packet)
            .values;
    };
    CHECK(digits("BCD", "0407") == "a=47");
    CHECK(digits("BCD", "1234") == "a=undefined");
    CHECK(digits("packedBCD", "1234") == "a=1234");
    CHECK(digits("packedBCD", "0407") == "a=407");
}

TEST_CASE("a text is never longer than its maxSizeInBits, though its packet says so", "[telemetry][xtce][R56]") {
    const auto text = [](const std::string& most, const char* packet) {
        return read({{"m.xml", system_of(u8 +
                                             "<StringParameterType name='t'><StringDataEncoding><Variable "
                                             "maxSizeInBits='" +
                                             most +
                                             "'><DynamicValue><ParameterInstanceRef parameterRef='n'/>"
                                             "<LinearAdjustment slope='8'/></DynamicValue></Variable>"
                                             "</StringDataEncoding></StringParameterType>",
                                         parameter("n", "u8") + parameter("s", "t") + parameter("z", "u8"),
                                         container("P", {"n", "s", "z"}))}},
                    packet)
            .values;
    };
    CHECK(text("24", "03 616263 07") == "n=3 s=abc z=7");
    CHECK(text("16", "03 616263 07") == "n=3 ! s is longer than its maxSizeInBits (line 1)");
}

TEST_CASE("an epoch that is neither a name of one nor a date is a finding", "[telemetry][xtce][R56]") {
    const auto findings = [](const std::string& epoch) {
        return read({{"m.xml", system_of("<AbsoluteTimeParameterType name='t'><Encoding><IntegerDataEncoding "
                                         "sizeInBits='8'/></Encoding><ReferenceTime><Epoch>" +
                                             epoch + "</Epoch></ReferenceTime></AbsoluteTimeParameterType>",
                                         parameter("a", "t"), container("P", {"a"}))}},
                    "01")
            .findings;
    };
    for (const std::string known : {"TAI", "gps", "J2000", "UNIX", "POSIX", "2000-01-01", "2000-01-01T12:00:00",
                                    "1980-01-06T00:00:00Z", "2000-01-01T11:58:55.816", "1970-01-01T00:00:00+01:00"}) {
        CAPTURE(known);
        CHECK(findings(known).empty());
    }
    for (const std::string unknown : {"foo", "2020-13-01", "UTC", "2000-01-01T12:00:00+1:00"}) {
        CAPTURE(unknown);
        REQUIRE(findings(unknown).size() == 1);
        CHECK_THAT(findings(unknown)[0], Catch::Contains("is neither TAI, GPS, J2000, UNIX, POSIX nor a date"));
    }
}

TEST_CASE("a whole number of 64 bits keeps its last digit through a polynomial that is the value itself",
          "[telemetry][xtce][R56]") {
    const std::string polynomial = "<IntegerParameterType name='u' signed='false'><IntegerDataEncoding sizeInBits='64'>"
                                   "<DefaultCalibrator><PolynomialCalibrator><Term coefficient='0' exponent='0'/><Term "
                                   "coefficient='1' exponent='1'/></PolynomialCalibrator></DefaultCalibrator>"
                                   "</IntegerDataEncoding></IntegerParameterType>";
    CHECK(read({{"m.xml", system_of(polynomial, parameter("a", "u"), container("P", {"a"}))}}, "0020000000000001")
              .values == "a=9007199254740993");
}

}  // namespace telemetry_xtce_as_written_test
