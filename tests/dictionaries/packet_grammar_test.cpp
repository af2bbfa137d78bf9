// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/xtce/packet_grammar.hpp"

#include "dictionaries/xtce/packet_model.hpp"
#include "tests/support/catch.hpp"

#include <string>
#include <vector>

namespace dictionaries_packet_grammar_test {

using namespace aeolis::dictionary;
using namespace aeolis::dictionary::xtce;

namespace {

/// The findings in a mission of one type 't', parameters 'a' and 'z', and one container: "LINE: words" each.
std::string told(const std::string& type, const std::string& inside_parameter = "",
                 const std::string& entries = "<ParameterRefEntry parameterRef='a'/>",
                 const std::string& inside_container = "", const std::string& container_attributes = "") {
    std::vector<Finding> findings;
    Findings into{"t.xml", findings};
    const auto model = read_packet_model(
        "<SpaceSystem name='T' xmlns='http://www.omg.org/spec/XTCE/20180204'><TelemetryMetaData><ParameterTypeSet>\n" +
            type +
            "\n<IntegerParameterType name='u8'><IntegerDataEncoding/></IntegerParameterType></ParameterTypeSet>"
            "<ParameterSet>\n<Parameter name='a' parameterTypeRef='t'>" +
            inside_parameter +
            "</Parameter><Parameter name='z' parameterTypeRef='u8'/></ParameterSet><ContainerSet>\n" +
            "<SequenceContainer name='P' " + container_attributes + ">" + inside_container + "<EntryList>" + entries +
            "</EntryList></SequenceContainer></ContainerSet></TelemetryMetaData></SpaceSystem>",
        into);
    REQUIRE(model);
    std::string all;
    for (const auto& finding : findings)
        all += (all.empty() ? "" : "; ") + std::to_string(finding.line) + ": " + finding.message;
    return all;
}

std::string integer(const std::string& attributes, const std::string& inside = "", const std::string& outer = "",
                    const std::string& beside = "") {
    return "<IntegerParameterType name='t' " + outer + "><IntegerDataEncoding " + attributes + ">" + inside +
           "</IntegerDataEncoding>" + beside + "</IntegerParameterType>";
}

const std::string size8 = "<SizeInBits><FixedValue>8</FixedValue></SizeInBits>";

std::string binary(const std::string& attributes, const std::string& inside = "") {
    return "<BinaryParameterType name='t'><BinaryDataEncoding " + attributes + ">" + inside + size8 +
           "</BinaryDataEncoding></BinaryParameterType>";
}
std::string word(const std::string& attributes) {
    return "<StringParameterType name='t'><StringDataEncoding " + attributes +
           "><SizeInBits><Fixed><FixedValue>16</FixedValue></Fixed></SizeInBits></StringDataEncoding>"
           "</StringParameterType>";
}
std::string entry(const std::string& attributes, const std::string& inside = "") {
    return "<ParameterRefEntry parameterRef='a' " + attributes + ">" + inside + "</ParameterRefEntry>";
}
std::string alarm(const std::string& attributes, const std::string& inside) {
    return integer("", "", "", "<DefaultAlarm " + attributes + ">" + inside + "</DefaultAlarm>");
}
std::string unknown_attribute(const char* name, const char* element, int line = 2) {
    return std::to_string(line) + ": attribute '" + name + "' of " + element + " is unknown or not supported";
}
std::string unknown_element(const char* name, const char* element, int line) {
    return std::to_string(line) + ": element '" + name + "' in " + element + " is unknown or not supported";
}

}  // namespace

TEST_CASE("what XTCE does not have at its place is told with its line", "[dictionary][xtce][R54]") {
    const std::string plain = integer("");
    CHECK(told(plain).empty());
    CHECK(told(integer("sizeInBit='16'")) == unknown_attribute("sizeInBit", "IntegerDataEncoding"));
    CHECK(told(integer("", "<DefaultCalibratr/>")) == unknown_element("DefaultCalibratr", "IntegerDataEncoding", 2));
    CHECK(told(integer("", "", "sign='false'")) == unknown_attribute("sign", "IntegerParameterType"));
    CHECK(told(integer("", "", "", "<Unit>m</Unit>")) == unknown_element("Unit", "IntegerParameterType", 2));
    CHECK(told(integer("", "<DefaultCalibrator><PolynomialCalibrator><Term coefficient='1' exponent='0' base='2'/>"
                           "</PolynomialCalibrator></DefaultCalibrator>")) == unknown_attribute("base", "Term"));
    CHECK(told(integer(
              "", "<DefaultCalibrator><SplineCalibrator extrapolat='true'><SplinePoint raw='0' calibrated='0'/>"
                  "</SplineCalibrator></DefaultCalibrator>")) == unknown_attribute("extrapolat", "SplineCalibrator"));
    CHECK(told(plain, "<ParameterProperties><Validity/></ParameterProperties>") ==
          unknown_element("Validity", "ParameterProperties", 4));
    CHECK(told(plain, "", entry("sizeInBits='16'")) == unknown_attribute("sizeInBits", "ParameterRefEntry", 5));
    CHECK(told(plain, "", entry("", "<Foo/>")) == unknown_element("Foo", "ParameterRefEntry", 5));
    CHECK(told(plain, "",
               entry("", "<LocationInContainerInBits refLocation='containerStart'><FixedValue>0</FixedValue>"
                         "</LocationInContainerInBits>")) ==
          unknown_attribute("refLocation", "LocationInContainerInBits", 5));
    CHECK(told(plain, "", entry("", "<RepeatEntry><Count><FixedValue>1</FixedValue></Count><Gap/></RepeatEntry>")) ==
          unknown_element("Gap", "RepeatEntry", 5));
    CHECK(told(plain, "", entry(""), "<BinaryEncodings/>") ==
          unknown_element("BinaryEncodings", "SequenceContainer", 5));
    CHECK(told(plain, "", entry(""), "", "abstrakt='true'") == unknown_attribute("abstrakt", "SequenceContainer", 5));
    CHECK(told(plain, "", entry(""), "<y:Entry xmlns:y='urn:other'/>") ==
          unknown_element("y:Entry", "SequenceContainer", 5));
    CHECK(told(alarm("", "<StaticAlarmRanges><WarningRange minInclusiv='1' maxInclusive='9'/></StaticAlarmRanges>")) ==
          unknown_attribute("minInclusiv", "WarningRange"));
    CHECK(told(plain, "",
               entry("", "<IncludeCondition><Comparison parameterRef='z' value='0' operator='&gt;'/>"
                         "</IncludeCondition>")) == unknown_attribute("operator", "Comparison", 5));
}

TEST_CASE("what XTCE has and would change a value, a packet or an alarm is told as not read",
          "[dictionary][xtce][R54]") {
    const std::string plain = integer("");
    const std::string crc = "<ErrorDetectCorrect><CRC width='8'><Polynomial>07</Polynomial></CRC></ErrorDetectCorrect>";
    CHECK(told(integer("", crc)) == "2: element 'ErrorDetectCorrect' in IntegerDataEncoding is not read");
    CHECK(told(plain, "", entry(""), "<BinaryEncoding>" + crc + size8 + "</BinaryEncoding>") ==
          "5: element 'ErrorDetectCorrect' in BinaryEncoding is not read");
    CHECK(told(plain, "<ParameterProperties><TimeAssociation parameterRef='z'/></ParameterProperties>") ==
          "4: element 'TimeAssociation' in ParameterProperties is not read");
    CHECK(told(integer("", "", "", "<ValidRange minExclusive='5' maxInclusive='10'/>")) ==
          "2: attribute 'minExclusive' of ValidRange is not read");
    CHECK(told(integer("", "", "",
                       "<ValidRangeSet validRangeAppliesToCalibrated='false'><ValidRange minInclusive='1'/>"
                       "</ValidRangeSet>")) ==
          "2: attribute 'validRangeAppliesToCalibrated' of ValidRangeSet is not read");
    CHECK(told(integer("", "", "",
                       "<ValidRangeSet><ValidRange minInclusive='1' maxInclusive='2'/>"
                       "<ValidRange minInclusive='4' maxInclusive='5'/></ValidRangeSet>")) ==
          "2: of several valid ranges only the first is read");
    CHECK(told(integer("", "", "", "<UnitSet><Unit power='2'>m</Unit></UnitSet>")) ==
          "2: attribute 'power' of Unit is not read");
    CHECK(told(alarm("defaultAlarmLevel='warning'", "")) ==
          "2: attribute 'defaultAlarmLevel' of DefaultAlarm is not read");
    CHECK(told(integer("bitOrder='reversed'")) == "2: bit order 'reversed' is not supported: octets are given");
    CHECK(told(word("bitOrder='leastSignificantBitFirst'")) ==
          "2: bitOrder 'leastSignificantBitFirst' of StringDataEncoding is not supported: octets are given");
    CHECK(told(word("encoding='UTF-16' byteOrder='leastSignificantByteFirst'")) ==
          "2: byteOrder 'leastSignificantByteFirst' of StringDataEncoding is not supported: octets are given");
    CHECK(told(binary("bitOrder='leastSignificantBitFirst'")) ==
          "2: bitOrder 'leastSignificantBitFirst' of BinaryDataEncoding is not supported: the octets are given as they "
          "are");
    CHECK(told(plain, "", entry(""),
               "<BinaryEncoding bitOrder='leastSignificantBitFirst'>" + size8 + "</BinaryEncoding>") ==
          "5: bitOrder 'leastSignificantBitFirst' of BinaryEncoding is not supported: packets are read up to it");
    CHECK(told(integer("sizeInBits='8'", "", "signed='true'")) ==
          "2: signed, but no encoding says how: it is read as unsigned");
    CHECK(told(integer("encoding='twosComplement'", "", "signed='false'")) ==
          "2: unsigned by its type, signed by its encoding: the encoding is read");
    CHECK(told(integer("", "", "signed='maybe'")) == "2: signed 'maybe' is neither true nor false");
    CHECK(told(integer("", "<DefaultCalibrator><SplineCalibrator><SplinePoint raw='0' calibrated='0' order='2'/>"
                           "</SplineCalibrator></DefaultCalibrator>")) ==
          "2: a point of another order than its spline is not supported: its values are undefined");
}

TEST_CASE("what XTCE has and only describes is no finding, nor what is said of it by default",
          "[dictionary][xtce][R54]") {
    const std::string described =
        "<LongDescription>words</LongDescription><AliasSet><Alias nameSpace='n' alias='x'/></AliasSet>"
        "<AncillaryDataSet><AncillaryData name='any'><![CDATA[<Anything/>]]></AncillaryData></AncillaryDataSet>";
    CHECK(
        told(
            "<IntegerParameterType name='t' shortDescription='s' initialValue='1' signed='false' sizeInBits='32'>" +
                described +
                "<UnitSet><Unit description='metre' power='1' factor='1' form='calibrated'>m</Unit></UnitSet>"
                "<IntegerDataEncoding sizeInBits='8' encoding='unsigned' bitOrder='mostSignificantBitFirst' "
                "byteOrder='mostSignificantByteFirst' changeThreshold='1'><DefaultCalibrator name='c'>"
                "<PolynomialCalibrator shortDescription='p'><Term coefficient='1' exponent='0'/></PolynomialCalibrator>"
                "</DefaultCalibrator></IntegerDataEncoding><ToString><NumberFormat "
                "numberBase='Hexadecimal'/></ToString>"
                "<ValidRange minInclusive='1' validRangeAppliesToCalibrated='true'/>"
                "<DefaultAlarm minViolations='2' minConformance='1' disabled='false' defaultAlarmLevel='normal'>"
                "<StaticAlarmRanges rangeForm='outside' timeUnits='seconds'><WarningRange minInclusive='1'/>"
                "</StaticAlarmRanges></DefaultAlarm></IntegerParameterType>",
            described + "<ParameterProperties dataSource='telemetered' readOnly='false' persistence='true'>"
                        "<SystemName>s</SystemName><PhysicalAddressSet/></ParameterProperties>",
            entry("shortDescription='s'", "<AncillaryDataSet/>"), described + "<DefaultRateInStream minimumValue='1'/>",
            "shortDescription='s' abstract='false' idlePattern='0x0' xmlns:y='urn:other' y:any='1'")
            .empty());
    CHECK(
        told(word("encoding='UTF-8' bitOrder='mostSignificantBitFirst' byteOrder='mostSignificantByteFirst'")).empty());
    // XTCE 1.0 and 1.1
    CHECK(told(integer("sizeInBits='8'", "<UnitSet/><ByteOrderList><Byte byteSignificance='0'/></ByteOrderList>"))
              .empty());
    CHECK(
        told("<ArrayParameterType name='t' arrayTypeRef='u8' numberOfDimensions='1'/>", "",
             "<ArrayParameterRefEntry parameterRef='a' lastEntryForThisArrayInstance='true'><DimensionList><Dimension>"
             "<StartingIndex><FixedValue>0</FixedValue></StartingIndex><EndingIndex><FixedValue>1</FixedValue>"
             "</EndingIndex></Dimension></DimensionList></ArrayParameterRefEntry>")
            .empty());
}

TEST_CASE("what stands in a set for a parameter or a container is told", "[dictionary][xtce][R54]") {
    std::vector<Finding> findings;
    Findings into{"t.xml", findings};
    REQUIRE(read_packet_model("<SpaceSystem name='T'><TelemetryMetaData><ParameterTypeSet>" + integer("") +
                                  "</ParameterTypeSet><ParameterSet>\n<Paramter name='a' parameterTypeRef='t'/>"
                                  "</ParameterSet><ContainerSet>\n<SequenceContainr name='P'/></ContainerSet>"
                                  "\n<ParameterSet/>"
                                  "</TelemetryMetaData></SpaceSystem>",
                              into));
    REQUIRE(findings.size() == 3);
    CHECK("2: " + findings[0].message == unknown_element("Paramter", "ParameterSet", 2));
    CHECK(findings[1].line == 4);
    CHECK(findings[1].message == "a second ParameterSet is not read");
    CHECK("3: " + findings[2].message == unknown_element("SequenceContainr", "ContainerSet", 3));
}

TEST_CASE("an alarm that the file switches off is none", "[dictionary][xtce][R54]") {
    std::vector<Finding> findings;
    Findings into{"t.xml", findings};
    const auto text = [](const char* disabled) {
        return "<SpaceSystem name='T'><TelemetryMetaData><ParameterTypeSet>" +
               alarm("disabled='" + std::string{disabled} + "'",
                     "<StaticAlarmRanges><WarningRange minInclusive='1'/></StaticAlarmRanges>") +
               "</ParameterTypeSet><ParameterSet><Parameter name='a' parameterTypeRef='t'/></ParameterSet>"
               "</TelemetryMetaData></SpaceSystem>";
    };
    CHECK(read_packet_model(text("false"), into)->types[0].alarms.ranges.size() == 1);
    CHECK(read_packet_model(text("true"), into)->types[0].alarms.ranges.empty());
    CHECK(findings.empty());
}

}  // namespace dictionaries_packet_grammar_test
