// SPDX-License-Identifier: Apache-2.0
#include "telemetry/container_decoder.hpp"
#include "telemetry/container_plan.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/octets.hpp"

#include <cmath>
#include <map>
#include <random>

namespace telemetry_container_plan_test {

using namespace aeolis;
using namespace aeolis::telemetry;
using dictionary::xtce::PacketModel;

namespace {

/// Two levels of containers with numbers in every coding, at odd places, and one with text, which is not compiled.
const char* const xtce = R"(<SpaceSystem name='S'><TelemetryMetaData><ParameterTypeSet>
<IntegerParameterType name='u5'><IntegerDataEncoding sizeInBits='5'/></IntegerParameterType>
<IntegerParameterType name='u11'><IntegerDataEncoding sizeInBits='11'/></IntegerParameterType>
<IntegerParameterType name='u32'><IntegerDataEncoding sizeInBits='32'/></IntegerParameterType>
<IntegerParameterType name='u16'><IntegerDataEncoding sizeInBits='16'/></IntegerParameterType>
<IntegerParameterType name='i12'><IntegerDataEncoding sizeInBits='12' encoding='twosComplement'/></IntegerParameterType>
<IntegerParameterType name='mode4'><IntegerDataEncoding sizeInBits='4'/></IntegerParameterType>
<IntegerParameterType name='u64'><IntegerDataEncoding sizeInBits='64'/></IntegerParameterType>
<IntegerParameterType name='bcd'><IntegerDataEncoding sizeInBits='16' encoding='BCD'/></IntegerParameterType>
<IntegerParameterType name='little'><IntegerDataEncoding sizeInBits='24' byteOrder='leastSignificantByteFirst'/></IntegerParameterType>
<FloatParameterType name='f32'><FloatDataEncoding sizeInBits='32'/></FloatParameterType>
<FloatParameterType name='poly'><IntegerDataEncoding sizeInBits='8'><DefaultCalibrator><PolynomialCalibrator>
<Term coefficient='-3' exponent='0'/><Term coefficient='0.5' exponent='2'/></PolynomialCalibrator></DefaultCalibrator></IntegerDataEncoding></FloatParameterType>
<FloatParameterType name='spline'><IntegerDataEncoding sizeInBits='8'><DefaultCalibrator><SplineCalibrator>
<SplinePoint raw='10' calibrated='0'/><SplinePoint raw='200' calibrated='1'/></SplineCalibrator></DefaultCalibrator></IntegerDataEncoding></FloatParameterType>
<EnumeratedParameterType name='mode'><IntegerDataEncoding sizeInBits='4'/><EnumerationList><Enumeration value='2' maxValue='9' label='ON'/></EnumerationList></EnumeratedParameterType>
<BooleanParameterType name='flag'><IntegerDataEncoding sizeInBits='1'/></BooleanParameterType>
<AggregateParameterType name='pair'><MemberList><Member name='a' typeRef='u16'/><Member name='b' typeRef='f32'/></MemberList></AggregateParameterType>
<StringParameterType name='text'><StringDataEncoding><SizeInBits><Fixed><FixedValue>16</FixedValue></Fixed></SizeInBits></StringDataEncoding></StringParameterType>
</ParameterTypeSet><ParameterSet>
<Parameter name='first' parameterTypeRef='u5'/><Parameter name='apid' parameterTypeRef='u11'/><Parameter name='rest' parameterTypeRef='u32'/>
<Parameter name='COARSE' parameterTypeRef='u32'/><Parameter name='FINE' parameterTypeRef='u16'/><Parameter name='kind' parameterTypeRef='u16'/>
<Parameter name='i' parameterTypeRef='i12'/><Parameter name='m' parameterTypeRef='mode'/><Parameter name='big' parameterTypeRef='u64'/>
<Parameter name='d' parameterTypeRef='bcd'/><Parameter name='l' parameterTypeRef='little'/><Parameter name='x' parameterTypeRef='f32'/>
<Parameter name='p' parameterTypeRef='poly'/><Parameter name='s' parameterTypeRef='spline'/><Parameter name='q' parameterTypeRef='flag'/>
<Parameter name='n' parameterTypeRef='mode4'/><Parameter name='r' parameterTypeRef='i12'/><Parameter name='pair' parameterTypeRef='pair'/><Parameter name='t' parameterTypeRef='text'/>
</ParameterSet><ContainerSet>
<SequenceContainer name='Header' abstract='true'><EntryList><ParameterRefEntry parameterRef='first'/><ParameterRefEntry parameterRef='apid'/>
<ParameterRefEntry parameterRef='rest'/></EntryList></SequenceContainer>
<SequenceContainer name='Timed' abstract='true'><EntryList><ParameterRefEntry parameterRef='COARSE'/><ParameterRefEntry parameterRef='FINE'/>
<ParameterRefEntry parameterRef='kind'/></EntryList><BaseContainer containerRef='Header'><RestrictionCriteria><Comparison parameterRef='apid' value='7'/></RestrictionCriteria></BaseContainer></SequenceContainer>
<SequenceContainer name='Numbers'><EntryList><ParameterRefEntry parameterRef='i'/><ParameterRefEntry parameterRef='m'/><ParameterRefEntry parameterRef='big'/>
<ParameterRefEntry parameterRef='d'/><ParameterRefEntry parameterRef='l'/><ParameterRefEntry parameterRef='x'/></EntryList>
<BaseContainer containerRef='Timed'><RestrictionCriteria><Comparison parameterRef='kind' comparisonOperator='&lt;' value='20000'/></RestrictionCriteria></BaseContainer></SequenceContainer>
<SequenceContainer name='More'><EntryList><ParameterRefEntry parameterRef='p'/><ParameterRefEntry parameterRef='s'><LocationInContainerInBits><FixedValue>7</FixedValue></LocationInContainerInBits></ParameterRefEntry>
<ParameterRefEntry parameterRef='q'/><ParameterRefEntry parameterRef='pair'/></EntryList>
<BaseContainer containerRef='Timed'><RestrictionCriteria><ComparisonList><Comparison parameterRef='kind' comparisonOperator='&gt;=' value='15000'/><Comparison parameterRef='kind' comparisonOperator='&lt;' value='60000'/></ComparisonList></RestrictionCriteria></BaseContainer></SequenceContainer>
<SequenceContainer name='Words'><EntryList><ParameterRefEntry parameterRef='t'/></EntryList>
<BaseContainer containerRef='Header'><RestrictionCriteria><Comparison parameterRef='apid' value='8'/></RestrictionCriteria></BaseContainer></SequenceContainer>
<SequenceContainer name='Many'><EntryList><ParameterRefEntry parameterRef='n'/><ParameterRefEntry parameterRef='r'><RepeatEntry><Count><DynamicValue>
<ParameterInstanceRef parameterRef='n'/><LinearAdjustment slope='2' intercept='1'/></DynamicValue></Count></RepeatEntry></ParameterRefEntry><ParameterRefEntry parameterRef='x'/></EntryList>
<BaseContainer containerRef='Header'><RestrictionCriteria><Comparison parameterRef='apid' value='9'/></RestrictionCriteria></BaseContainer></SequenceContainer>
</ContainerSet></TelemetryMetaData></SpaceSystem>)";

std::optional<double> number_of(const DecodedValue& value) {
    const auto number = [](const Datum& datum) -> std::optional<double> {
        if (const auto* real = std::get_if<double>(&datum)) return *real;
        if (const auto* whole = std::get_if<std::uint64_t>(&datum)) return static_cast<double>(*whole);
        if (const auto* whole = std::get_if<std::int64_t>(&datum)) return static_cast<double>(*whole);
        return std::nullopt;
    };
    return std::holds_alternative<std::string>(value.calibrated) ? number(value.raw) : number(value.calibrated);
}

}  // namespace

TEST_CASE(
    "packets of compiled containers have the values and the times that the decoder of all containers gives; what is "
    "not compiled, ambiguous or not whole is left to it",
    "[telemetry][xtce][R54]") {
    std::vector<dictionary::Finding> findings;
    dictionary::Findings into{"m.xml", findings};
    auto model = dictionary::xtce::read_packet_model(xtce, into);
    REQUIRE(model);
    REQUIRE(findings.empty());
    model->root = 0;
    // Each value's place among those of its container.
    std::vector<std::map<std::pair<std::size_t, std::string>, std::size_t>> places(model->containers.size());
    const ContainerPlan plan{*model, std::vector<std::size_t>(model->containers.size(), 32),
                             [&](std::size_t container, std::size_t parameter, const std::string& name) {
                                 auto& of = places[container];
                                 // Of a list the first four are fields.
                                 const auto bracket = name.find('[');
                                 if (bracket != std::string::npos && std::stoi(name.substr(bracket + 1)) >= 4)
                                     return std::optional<std::size_t>{};
                                 return std::optional{of.try_emplace({parameter, name}, of.size()).first->second};
                             },
                             [&](std::size_t container, std::size_t field) {
                                 return std::ranges::any_of(places[container], [&](const auto& each) {
                                     return each.second == field && each.first.second == "big";
                                 });
                             }};
    CHECK(plan.compiled() == 3);
    const ContainerDecoder decoder{*model};
    std::mt19937 random{27};
    std::map<std::string, int> seen;
    for (int round = 0; round < 20'000; ++round) {
        auto packet = test::random_octets(random, random() % 4 == 0 ? random() % 60 : random() % 2 == 0 ? 33 : 23);
        if (packet.size() >= 2 && random() % 8 != 0) {
            packet[0] &= 0xF8;
            packet[1] = random() % 10 == 0 ? 8 : 7;
        }
        if (packet.size() > 7 && random() % 3 == 0) {
            packet[1] = 9;
            const unsigned n = random() % 8;
            packet[6] = static_cast<std::uint8_t>(n << 4U | (packet[6] & 0xFU));
            // Four bits, 2 n + 1 numbers of 12 bits and one of 32: whole octets; sometimes one is missing or too many.
            packet.resize(6 + (4 + 12 * (2 * n + 1) + 32) / 8 + (random() % 6 == 0 ? 1 : 0) -
                          (random() % 6 == 0 ? 1 : 0));
        }
        dictionary::Decoded decoded;
        const auto contents = decoder.decode(packet);
        if (!plan.decode(packet, decoded)) {
            const bool compiled =
                contents.container == "Numbers" || contents.container == "More" || contents.container == "Many";
            CHECK((!compiled || !contents.problem.empty()));
            ++seen["left"];
            continue;
        }
        ++seen[contents.container];
        REQUIRE(contents.problem.empty());
        REQUIRE(decoded.packet == contents.container_index);
        REQUIRE(decoded.timed == contents.time.has_value());
        if (decoded.timed) REQUIRE(decoded.header.time.seconds == contents.time->seconds);
        std::map<std::size_t, std::string> texts{decoded.texts.begin(), decoded.texts.end()};
        for (const DecodedValue& value : contents.values) {
            const auto place = places[decoded.packet].find({value.parameter, value.name});
            if (place == places[decoded.packet].end()) continue;  // far in a list
            const std::size_t field = place->second;
            INFO(value.name);
            REQUIRE(decoded.value[field] == number_of(value));
            if (value.name == "big") REQUIRE(texts[field] == datum_text(value.calibrated));
            if (const auto* raw = std::get_if<std::uint64_t>(&value.raw)) REQUIRE(decoded.raw[field] == *raw);
        }
    }
    CHECK(seen["Numbers"] > 500);
    CHECK(seen["More"] > 500);
    CHECK(seen["Many"] > 500);
    CHECK(seen["left"] > 500);
}

TEST_CASE(
    "flags that make values defined, octets, entries that step back, and many containers told apart by one number are "
    "compiled and read alike",
    "[telemetry][xtce][R54]") {
    std::string containers;
    constexpr int kinds = 40;
    for (int i = 0; i < kinds; ++i)
        containers += "<SequenceContainer name='K" + std::to_string(i) +
                      "'><EntryList><ParameterRefEntry parameterRef='known'/><ParameterRefEntry parameterRef='mode'/>"
                      "<ParameterRefEntry parameterRef='x'/><ParameterRefEntry parameterRef='blob'/><ParameterRefEntry "
                      "parameterRef='y'/><ParameterRefEntry parameterRef='back'><LocationInContainerInBits><FixedValue>"
                      "-40</FixedValue></LocationInContainerInBits></ParameterRefEntry></EntryList><BaseContainer "
                      "containerRef='Header'><RestrictionCriteria><ComparisonList><Comparison parameterRef='mark' "
                      "comparisonOperator='&lt;' value='200'/><Comparison parameterRef='apid' value='" +
                      std::to_string(3 * i) +
                      "'/></ComparisonList></RestrictionCriteria></BaseContainer></SequenceContainer>";
    const std::string text =
        "<SpaceSystem name='S'><TelemetryMetaData><ParameterTypeSet>"
        "<IntegerParameterType name='u8'><IntegerDataEncoding sizeInBits='8'/></IntegerParameterType>"
        "<BooleanParameterType name='flag'><IntegerDataEncoding sizeInBits='1'/></BooleanParameterType>"
        "<EnumeratedParameterType name='mode'><IntegerDataEncoding sizeInBits='7'/><EnumerationList><Enumeration "
        "value='2' label='ON'/></EnumerationList></EnumeratedParameterType>"
        "<FloatParameterType name='f32'><FloatDataEncoding sizeInBits='32'/></FloatParameterType>"
        "<BinaryParameterType name='blob'><BinaryDataEncoding><SizeInBits><FixedValue>24</FixedValue></SizeInBits>"
        "</BinaryDataEncoding></BinaryParameterType></ParameterTypeSet><ParameterSet>"
        "<Parameter name='mark' parameterTypeRef='u8'/><Parameter name='apid' parameterTypeRef='u8'/><Parameter "
        "name='known' parameterTypeRef='flag'/><Parameter name='mode' parameterTypeRef='mode'/><Parameter name='blob' "
        "parameterTypeRef='blob'/><Parameter name='x' parameterTypeRef='f32'><ParameterProperties><ValidityCondition>"
        "<ComparisonList><Comparison parameterRef='known' value='1' useCalibratedValue='false'/><Comparison "
        "parameterRef='mode' comparisonOperator='!=' value='2'/></ComparisonList></ValidityCondition>"
        "</ParameterProperties></Parameter><Parameter name='y' parameterTypeRef='u8'/><Parameter name='back' "
        "parameterTypeRef='u8'/></ParameterSet><ContainerSet>"
        "<SequenceContainer name='Header' abstract='true'><EntryList><ParameterRefEntry parameterRef='mark'/>"
        "<ParameterRefEntry parameterRef='apid'/></EntryList></SequenceContainer>" +
        containers + "</ContainerSet></TelemetryMetaData></SpaceSystem>";
    std::vector<dictionary::Finding> findings;
    dictionary::Findings into{"m.xml", findings};
    auto model = dictionary::xtce::read_packet_model(text, into);
    REQUIRE(model);
    REQUIRE(findings.empty());
    model->root = 0;
    const std::vector<std::string> names{"mark", "apid", "known", "mode", "x", "y", "back"};
    const ContainerPlan plan{*model, std::vector<std::size_t>(model->containers.size(), names.size()),
                             [&](std::size_t, std::size_t, const std::string& name) {
                                 const auto found = std::ranges::find(names, name);
                                 return std::optional{static_cast<std::size_t>(found - names.begin())};
                             },
                             [](std::size_t, std::size_t) { return false; }};
    CHECK(plan.compiled() == kinds);
    const ContainerDecoder decoder{*model};
    std::mt19937 random{41};
    int decoded_packets = 0, defined = 0, left = 0;
    for (int round = 0; round < 20'000; ++round) {
        auto packet = test::random_octets(random, random() % 8 == 0 ? random() % 12 : 11);
        if (packet.size() > 2 && random() % 4 != 0) packet[1] = static_cast<std::uint8_t>(random() % 3 == 0 ? 130 : 30);
        if (packet.size() > 2 && random() % 2 != 0) packet[2] = random() % 2 == 0 ? 0x82 : 0x83;
        dictionary::Decoded decoded;
        const auto contents = decoder.decode(packet);
        if (!plan.decode(packet, decoded)) {
            CHECK_FALSE(contents.problem.empty());
            ++left;
            continue;
        }
        ++decoded_packets;
        REQUIRE(contents.problem.empty());
        REQUIRE(decoded.packet == contents.container_index);
        for (const DecodedValue& value : contents.values) {
            if (value.name == "blob") continue;
            INFO(value.name);
            const auto field = static_cast<std::size_t>(std::ranges::find(names, value.name) - names.begin());
            REQUIRE(decoded.value[field] == number_of(value));
            defined += value.name == "x" && decoded.value[field] ? 1 : 0;
        }
    }
    CHECK(decoded_packets > 2'000);
    CHECK(defined > 200);
    CHECK(decoded_packets - defined > 200);
    CHECK(left > 2'000);
}

TEST_CASE("padding to whole octets is compiled and read alike, and what may be no number decides no container",
          "[telemetry][xtce][R54]") {
    const std::string text =
        "<SpaceSystem name='S'><TelemetryMetaData><ParameterTypeSet>"
        "<IntegerParameterType name='u8'><IntegerDataEncoding sizeInBits='8'/></IntegerParameterType>"
        "<IntegerParameterType name='u5'><IntegerDataEncoding sizeInBits='5'/></IntegerParameterType>"
        "<IntegerParameterType name='bcd'><IntegerDataEncoding sizeInBits='8' encoding='BCD'/></IntegerParameterType>"
        "</ParameterTypeSet><ParameterSet><Parameter name='kind' parameterTypeRef='u8'/>"
        "<Parameter name='digits' parameterTypeRef='bcd'/><Parameter name='five' parameterTypeRef='u5'/>"
        "</ParameterSet><ContainerSet><SequenceContainer name='Header'><EntryList><ParameterRefEntry "
        "parameterRef='kind'/></EntryList></SequenceContainer>"
        "<SequenceContainer name='Short'><EntryList><ParameterRefEntry parameterRef='five'/></EntryList><BaseContainer "
        "containerRef='Header'><RestrictionCriteria><Comparison parameterRef='kind' value='1'/></RestrictionCriteria>"
        "</BaseContainer></SequenceContainer>"
        "<SequenceContainer name='Digits'><EntryList><ParameterRefEntry parameterRef='digits'/></EntryList>"
        "<BaseContainer containerRef='Header'><RestrictionCriteria><Comparison parameterRef='kind' value='2'/>"
        "</RestrictionCriteria></BaseContainer></SequenceContainer>"
        "<SequenceContainer name='NotFive'><EntryList/><BaseContainer containerRef='Digits'><RestrictionCriteria>"
        "<Comparison parameterRef='digits' comparisonOperator='!=' value='5'/></RestrictionCriteria></BaseContainer>"
        "</SequenceContainer></ContainerSet></TelemetryMetaData></SpaceSystem>";
    std::vector<dictionary::Finding> findings;
    dictionary::Findings into{"m.xml", findings};
    auto model = dictionary::xtce::read_packet_model(text, into);
    REQUIRE(model);
    REQUIRE(findings.empty());
    model->root = 0;
    const std::vector<std::string> names{"kind", "digits", "five"};
    const ContainerPlan plan{*model, std::vector<std::size_t>(model->containers.size(), names.size()),
                             [&](std::size_t, std::size_t, const std::string& name) {
                                 const auto found = std::ranges::find(names, name);
                                 return std::optional{static_cast<std::size_t>(found - names.begin())};
                             },
                             [](std::size_t, std::size_t) { return false; }};
    const ContainerDecoder decoder{*model};
    dictionary::Decoded decoded;
    const auto both = [&](std::string_view octets, bool compiled) {
        INFO(octets);
        const auto contents = decoder.decode(test::hex(octets));
        CHECK(plan.decode(test::hex(octets), decoded) == compiled);
        return contents.container + (contents.problem.empty() ? "" : "?");
    };
    CHECK(both("01 08", true) == "Short");
    CHECK(decoded.value[2] == 1.0);
    CHECK(both("01 09", false) == "Short?");
    CHECK(both("01 08 b07b", false) == "Short?");
    CHECK(both("02 06", false) == "NotFive");
    CHECK(both("02 05", false) == "Digits");
    CHECK(both("02 0a", false) == "Digits?");
}

}  // namespace telemetry_container_plan_test
