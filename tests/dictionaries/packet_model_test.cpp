// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/xtce/packet_model.hpp"
#include "tests/support/catch.hpp"

#include <algorithm>
#include <string>

namespace dictionaries_packet_model_test {

using namespace aeolis::dictionary;
using namespace aeolis::dictionary::xtce;

namespace {

struct Read {
    std::vector<Finding> findings;
    std::optional<PacketModel> model;
    explicit Read(const std::string& text) {
        Findings into{"t.xml", findings};
        model = read_packet_model(text, into);
    }
    bool has(unsigned line, const std::string& words) const {
        return std::ranges::any_of(findings, [&](const Finding& finding) {
            return finding.line == line && finding.message.find(words) != std::string::npos;
        });
    }
};

std::string mission(const std::string& types) {
    return "<SpaceSystem name='T'><TelemetryMetaData><ParameterTypeSet>\n" + types +
           "\n</ParameterTypeSet><ParameterSet><Parameter name='p' parameterTypeRef='t'/></ParameterSet>"
           "</TelemetryMetaData></SpaceSystem>";
}

}  // namespace

TEST_CASE("the prefix that a file gives XTCE does not matter, and lines stay known", "[dictionary]") {
    const Read read{"<x:SpaceSystem name='T' xmlns:x='http://www.omg.org/space/xtce'>\n<x:TelemetryMetaData>\n"
                    "<x:ParameterTypeSet>\n<x:StrangeParameterType name='t'/>\n</x:ParameterTypeSet>\n"
                    "<x:ParameterSet><x:Parameter name='p' parameterTypeRef='t'/></x:ParameterSet>\n"
                    "</x:TelemetryMetaData></x:SpaceSystem>"};
    REQUIRE(read.model);
    CHECK(read.model->parameters.size() == 1);
    CHECK(read.has(4, "StrangeParameterType is unknown or not supported"));
}

TEST_CASE("octet order is read as 1.2 and as 1.0 spell it", "[dictionary]") {
    const Read newer{mission("<IntegerParameterType name='t'><IntegerDataEncoding sizeInBits='16' "
                             "byteOrder='leastSignificantByteFirst'/></IntegerParameterType>")};
    CHECK(newer.model->types[0].coding.least_significant_octet_first);
    const Read older{mission("<IntegerParameterType name='t'><IntegerDataEncoding sizeInBits='16'><ByteOrderList>"
                             "<Byte byteSignificance='0'/><Byte byteSignificance='1'/></ByteOrderList>"
                             "</IntegerDataEncoding></IntegerParameterType>")};
    CHECK(older.model->types[0].coding.least_significant_octet_first);
    CHECK(newer.findings.empty());
    CHECK(older.findings.empty());
}

TEST_CASE("a type takes from its base what it does not say itself", "[dictionary]") {
    const Read read{
        mission("<EnumeratedParameterType name='t' baseType='b'/>"
                "<IntegerParameterType name='b'><IntegerDataEncoding sizeInBits='3'/></IntegerParameterType>")};
    CHECK(read.findings.empty());
    const auto& type = read.model->types[read.model->parameters[0].type];
    CHECK(type.kind == PacketType::Kind::enumerated);
    CHECK(type.coding.bits.intercept == 3.0);
}

TEST_CASE("a type without an encoding is a finding at its entry in a packet, and only there", "[dictionary]") {
    const std::string derived = mission("<IntegerParameterType name='t'/>");
    CHECK(Read{derived}.findings.empty());
    std::string sent = derived;
    sent.insert(sent.find("</TelemetryMetaData>"),
                "\n<ContainerSet><SequenceContainer name='P'><EntryList>"
                "<ParameterRefEntry parameterRef='p'/></EntryList></SequenceContainer></ContainerSet>");
    CHECK(Read{sent}.has(4, "type 't' has no data encoding"));
}

TEST_CASE("each thing that is not supported is named with its line", "[dictionary]") {
    const auto found = [](const std::string& types, const std::string& words) {
        INFO(types);
        CHECK(Read{mission(types)}.has(2, words));
    };
    found("<IntegerParameterType name='t'><IntegerDataEncoding sizeInBits='99'/></IntegerParameterType>",
          "from 1 to 64");
    found("<FloatParameterType name='t'><FloatDataEncoding encoding='IBM' sizeInBits='32'/></FloatParameterType>",
          "'IBM' of 32 bits is not supported");
    found("<BinaryParameterType name='t'><BinaryDataEncoding><SizeInBits/></BinaryDataEncoding></BinaryParameterType>",
          "says no number");
    found("<BinaryParameterType name='t'><BinaryDataEncoding><SizeInBits><DynamicValue><ParameterInstanceRef "
          "parameterRef='gone'/></DynamicValue></SizeInBits></BinaryDataEncoding></BinaryParameterType>",
          "there is no parameter 'gone'");
    found("<IntegerParameterType name='t'><IntegerDataEncoding><DefaultCalibrator><MathOperationCalibrator/>"
          "</DefaultCalibrator></IntegerDataEncoding></IntegerParameterType>",
          "neither polynomial nor spline");
    found("<StringParameterType name='t'><StringDataEncoding/></StringParameterType>", "how long its text is");
    found("<EnumeratedParameterType name='t'><IntegerDataEncoding/><EnumerationList><Enumeration value='1' label=''/>"
          "</EnumerationList></EnumeratedParameterType>",
          "a value without a label");
    found("<EnumeratedParameterType name='t'><IntegerDataEncoding/><EnumerationList><Enumeration value='x' label='A'/>"
          "</EnumerationList></EnumeratedParameterType>",
          "its value is not a whole number");
    found("<IntegerParameterType name='t'><IntegerDataEncoding byteOrder=''/></IntegerParameterType>",
          "byte order '' is not supported");
}

TEST_CASE("a condition of a kind that is not supported is named with its line, wherever it stands", "[dictionary]") {
    const auto found = [](const std::string& inside_parameter, const std::string& inside_base,
                          const std::string& words) {
        INFO(inside_parameter << inside_base);
        const Read read{
            "<SpaceSystem name='T'><TelemetryMetaData><ParameterTypeSet><IntegerParameterType name='t'>"
            "<IntegerDataEncoding/></IntegerParameterType></ParameterTypeSet><ParameterSet>"
            "<Parameter name='p' parameterTypeRef='t'><ParameterProperties><ValidityCondition>\n" +
            inside_parameter +
            "</ValidityCondition></ParameterProperties></Parameter></ParameterSet><ContainerSet>"
            "<SequenceContainer name='A'><EntryList/></SequenceContainer><SequenceContainer name='B'><EntryList/>"
            "<BaseContainer containerRef='A'><RestrictionCriteria>" +
            inside_base +
            "</RestrictionCriteria>"
            "</BaseContainer></SequenceContainer></ContainerSet></TelemetryMetaData></SpaceSystem>"};
        REQUIRE(read.findings.size() == 1);
        CHECK(read.has(2, words));
    };
    found("<CustomAlgorithm/>", "", "CustomAlgorithm is not supported as a condition: whether it holds is not known");
    found("", "<CustomAlgorithm/>", "CustomAlgorithm is not supported as a condition: whether it holds is not known");
    found("", "<NextContainer containerRef='A'/>", "NextContainer is not supported as a condition");
    found("", "<Comparison parameterRef='p' value='1'/><NextContainer containerRef='A'/>",
          "NextContainer beside another condition is not supported: it is left out");
    found("<Comparison parameterRef='gone' value='1'/>", "", "there is no parameter 'gone'");
    found("<Comparison parameterRef='p' value='1' comparisonOperator='~'/>", "", "operator '~' is unknown");
}

TEST_CASE("types of types without end are refused, not followed", "[dictionary]") {
    const Read base{mission("<IntegerParameterType name='t' baseType='t'/>")};
    REQUIRE(base.model);
    std::string chain;
    for (int i = 0; i < 100; ++i)
        chain += "<IntegerParameterType name='t" + (i == 0 ? std::string{} : std::to_string(i)) + "' baseType='t" +
                 std::to_string(i + 1) + "'/>";
    CHECK(Read{mission(chain)}.has(2, "nested deeper"));
}

TEST_CASE("what is no XTCE is refused", "[dictionary]") {
    CHECK_FALSE(Read{"<Other/>"}.model);
    CHECK_FALSE(Read{"not XML"}.model);
}

}  // namespace dictionaries_packet_model_test
