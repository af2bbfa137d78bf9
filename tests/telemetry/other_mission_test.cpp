// SPDX-License-Identifier: Apache-2.0
#include "telemetry/alarms.hpp"
#include "telemetry/other_mission.hpp"
#include "telemetry/staleness.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/mission_copy.hpp"
#include "tests/support/octets.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <algorithm>
#include <map>
#include <memory>

namespace telemetry_other_mission_test {

using namespace aeolis;
using namespace aeolis::telemetry;

namespace {

std::unique_ptr<OtherMission> mission_of(const std::string& xtce) {
    std::vector<dictionary::Finding> findings;
    dictionary::Findings into{"m.xml", findings};
    auto model = dictionary::xtce::read_packet_model(xtce, into);
    REQUIRE(model);
    return std::make_unique<OtherMission>(std::move(*model), std::uint16_t{1});
}

std::string with_containers(const std::string& types, const std::string& parameters, const std::string& containers) {
    return "<SpaceSystem name='T'><TelemetryMetaData><ParameterTypeSet><IntegerParameterType "
           "name='u8'><IntegerDataEncoding/>"
           "</IntegerParameterType><IntegerParameterType name='u48'><IntegerDataEncoding "
           "sizeInBits='48'/></IntegerParameterType>" +
           types + "</ParameterTypeSet><ParameterSet><Parameter name='header' parameterTypeRef='u48'/>" + parameters +
           "</ParameterSet><ContainerSet>" + containers + "</ContainerSet></TelemetryMetaData></SpaceSystem>";
}

}  // namespace

TEST_CASE("our own packets, read as another mission's, have the values that the decommutator gives",
          "[telemetry][downlink]") {
    const auto mission = mission_of(tests::text_of(tests::shipped_mission / "msl.xml"));
    const auto& ours = tests::shipped_dictionary();
    const Decommutator decommutator{ours};
    std::mt19937 random{2};
    Decoded by_plan, by_containers;
    for (const auto& packet : ours.packets) {
        auto octets = test::random_octets(random, packet.octets);
        if (packet.event) {
            octets[tm_data_offset_octets] = static_cast<std::uint8_t>(packet.event->value >> 8);
            octets[tm_data_offset_octets + 1] = static_cast<std::uint8_t>(packet.event->value & 0xFF);
        }
        seal_tm_packet(octets, packet.apid, 3, Sclk{7.5}, ours.id);
        REQUIRE_FALSE(decommutator.decode(octets, by_plan));
        REQUIRE_FALSE(mission->decode(octets, by_containers));
        const auto& read = mission->dictionary().packets[by_containers.packet];
        INFO(packet.name);
        REQUIRE(read.name == packet.name);
        REQUIRE(read.apid == packet.apid);  // found in what the containers ask for
        REQUIRE(by_containers.header.time.seconds == 7.5);
        for (std::size_t i = 0; i < packet.fields.size(); ++i) {
            const auto& name = packet.fields[i].name;  // an event's argument may be called as a channel is
            auto field = field_index(read, name);
            for (std::size_t k = 0; !field && k < read.fields.size(); ++k)
                if (read.fields[k].name.ends_with("/" + name)) field = k;
            INFO(packet.fields[i].name);
            REQUIRE(field);
            REQUIRE(by_containers.value[*field] == by_plan.value[i]);
            REQUIRE(read.fields[*field].channel);
        }
    }
}

TEST_CASE("a packet that cannot be read to its end gives what stands before; one of nobody is refused with the reason",
          "[telemetry][downlink]") {
    const auto mission = mission_of(with_containers(
        "<StrangeParameterType name='odd'/>",
        "<Parameter name='a' parameterTypeRef='u8'/><Parameter name='b' parameterTypeRef='odd'/>"
        "<Parameter name='c' parameterTypeRef='u8'/>",
        "<SequenceContainer name='P'><EntryList><ParameterRefEntry parameterRef='header'/><ParameterRefEntry "
        "parameterRef='a'/>"
        "<ParameterRefEntry parameterRef='b'/><ParameterRefEntry parameterRef='c'/></EntryList></SequenceContainer>"));
    Decoded decoded;
    const auto refused = mission->decode(test::hex("000100000001 0506"), decoded);
    INFO(refused.value_or(""));
    REQUIRE_FALSE(refused);
    const auto& packet = mission->dictionary().packets[decoded.packet];
    CHECK(decoded.value[*field_index(packet, "a")] == 5.0);
    CHECK_FALSE(decoded.value[*field_index(packet, "c")]);
    CHECK(packet.apid == OtherMission::unrestricted_apid);
    CHECK(mission->decode(test::hex("000100000007 0506"), decoded) == "not_a_packet");
    CHECK(mission->decode({}, decoded) == "not_a_packet");
    CHECK(mission_of(with_containers("", "", ""))->decode(test::hex("000100000001 0506"), decoded) ==
          "the XTCE file has no container to begin with");
}

TEST_CASE("live, too, a container that might be the packet's lets no other take it", "[telemetry][downlink][R54]") {
    for (const char* wanted : {"FIVE", "6"}) {
        const auto mission = mission_of(with_containers(
            "<IntegerParameterType name='bcd'><IntegerDataEncoding encoding='BCD'/></IntegerParameterType>",
            "<Parameter name='k' parameterTypeRef='bcd'/><Parameter name='y' parameterTypeRef='u8'/><Parameter "
            "name='z' "
            "parameterTypeRef='u8'/>",
            "<SequenceContainer name='P'><EntryList><ParameterRefEntry parameterRef='header'/><ParameterRefEntry "
            "parameterRef='k'/></EntryList></SequenceContainer><SequenceContainer name='Q'><EntryList>"
            "<ParameterRefEntry parameterRef='y'/></EntryList><BaseContainer containerRef='P'><RestrictionCriteria>"
            "<Comparison parameterRef='k' value='" +
                std::string{wanted} +
                "'/></RestrictionCriteria></BaseContainer></SequenceContainer><SequenceContainer name='R'><EntryList>"
                "<ParameterRefEntry parameterRef='z'/></EntryList><BaseContainer containerRef='P'/>"
                "</SequenceContainer>"));
        Decoded decoded;
        for (const char* octets : {"000100000001 fa02", "000100000001 0502"}) {
            INFO(wanted << " " << octets);
            REQUIRE_FALSE(mission->decode(test::hex(octets), decoded));
            const bool known = std::string{wanted} == "6" && std::string{octets}.ends_with("0502");
            CHECK(mission->dictionary().packets[decoded.packet].name == (known ? "R" : "P"));
            CHECK(decoded.problem.empty() == known);
        }
    }
}

TEST_CASE("of lists without a known length the first are channels, and a hostile number of them is bounded",
          "[telemetry][downlink]") {
    const std::string arrays =
        "<ArrayParameterType name='many' "
        "arrayTypeRef='u8'><DimensionList><Dimension><StartingIndex><FixedValue>0</FixedValue></StartingIndex>"
        "<EndingIndex><FixedValue>999999999</FixedValue></EndingIndex></Dimension></DimensionList></"
        "ArrayParameterType>";
    const auto mission = mission_of(with_containers(
        arrays, "<Parameter name='m' parameterTypeRef='many'/>",
        "<SequenceContainer name='P'><EntryList><ParameterRefEntry parameterRef='header'/><ParameterRefEntry "
        "parameterRef='m'/></EntryList></SequenceContainer>"));
    CHECK(mission->dictionary().channels.size() == 1 + OtherMission::elements_max);
    CHECK(mission->dictionary().channel("m[15]") != nullptr);
    CHECK(mission->omitted_fields() == 0);
}

TEST_CASE("two parameters of one name in different systems are two channels", "[telemetry][downlink]") {
    const std::string inner =
        "<TelemetryMetaData><ParameterTypeSet><IntegerParameterType "
        "name='u8'><IntegerDataEncoding/></IntegerParameterType>"
        "</ParameterTypeSet><ParameterSet><Parameter name='x' parameterTypeRef='u8'/></ParameterSet><ContainerSet>"
        "<SequenceContainer name='P'><EntryList><ParameterRefEntry parameterRef='x'/></EntryList></SequenceContainer>"
        "</ContainerSet></TelemetryMetaData>";
    const auto mission = mission_of("<SpaceSystem name='T'><SpaceSystem name='A'>" + inner +
                                    "</SpaceSystem><SpaceSystem name='B'>" + inner + "</SpaceSystem></SpaceSystem>");
    CHECK(mission->dictionary().channel("x") != nullptr);
    CHECK(mission->dictionary().channel("T/B/x") != nullptr);
    CHECK(mission->dictionary().packet("T/B/P") != nullptr);
}

TEST_CASE("a packet is expected at the least rate that its container promises, and at none that is no promise",
          "[telemetry][downlink]") {
    std::vector<dictionary::Finding> findings;
    dictionary::Findings into{"m.xml", findings};
    std::string containers;
    const auto add = [&](const std::string& name, const std::string& rate) {
        containers += "\n<SequenceContainer name='" + name + "'>" + rate +
                      "<EntryList><ParameterRefEntry parameterRef='header'/></EntryList></SequenceContainer>";
    };
    add("Least", "<DefaultRateInStream basis='perSecond' minimumValue='0.1' maximumValue='2'/>");
    add("Unsaid", "");
    add("Most", "<DefaultRateInStream maximumValue='2'/>");
    add("Zero", "<DefaultRateInStream minimumValue='0'/>");
    add("Updates", "<DefaultRateInStream basis='perContainerUpdate' minimumValue='2'/>");
    add("Negative", "<DefaultRateInStream minimumValue='-1'/>");
    add("Exchanged", "<DefaultRateInStream minimumValue='3' maximumValue='2'/>");
    add("Word", "<DefaultRateInStream minimumValue='often'/>");
    auto model = dictionary::xtce::read_packet_model(with_containers("", "", containers), into);
    REQUIRE(model);
    std::vector<unsigned> lines;
    for (const auto& finding : findings) lines.push_back(finding.line);
    CHECK(lines == std::vector<unsigned>{6, 7, 8, 9});
    const OtherMission mission{std::move(*model), std::uint16_t{1}};
    for (const auto& packet : mission.dictionary().packets)
        CHECK(packet.expected_rate_hz == (packet.name == "Least" ? std::optional{0.1} : std::nullopt));
    CHECK(stale_after_s(mission.dictionary(), 0) == Approx(40.0));
}

TEST_CASE("whole numbers of 64 bits and text are channels with their exact value; undefined text is undefined",
          "[telemetry][downlink][R54]") {
    const auto mission = mission_of(with_containers(
        "<IntegerParameterType name='u64'><IntegerDataEncoding sizeInBits='64'/></IntegerParameterType>"
        "<IntegerParameterType name='i64' signed='true'><IntegerDataEncoding sizeInBits='64' "
        "encoding='twosComplement'/></IntegerParameterType>"
        "<IntegerParameterType name='u53'><IntegerDataEncoding sizeInBits='53'/></IntegerParameterType>"
        "<IntegerParameterType name='u3'><IntegerDataEncoding sizeInBits='3'/></IntegerParameterType>"
        "<StringParameterType name='latin'><StringDataEncoding encoding='ISO-8859-1'><SizeInBits><Fixed><FixedValue>24"
        "</FixedValue></Fixed></SizeInBits></StringDataEncoding></StringParameterType>"
        "<StringParameterType name='utf8'><StringDataEncoding encoding='UTF-8'><SizeInBits><Fixed><FixedValue>8"
        "</FixedValue></Fixed></SizeInBits></StringDataEncoding></StringParameterType>",
        "<Parameter name='a' parameterTypeRef='u64'/><Parameter name='b' parameterTypeRef='i64'/>"
        "<Parameter name='c' parameterTypeRef='u53'/><Parameter name='pad' parameterTypeRef='u3'/>"
        "<Parameter name='name' parameterTypeRef='latin'/><Parameter name='bad' parameterTypeRef='utf8'/>",
        "<SequenceContainer name='P'><EntryList><ParameterRefEntry parameterRef='header'/>"
        "<ParameterRefEntry parameterRef='a'/><ParameterRefEntry parameterRef='b'/><ParameterRefEntry "
        "parameterRef='c'/><ParameterRefEntry parameterRef='pad'/><ParameterRefEntry parameterRef='name'/>"
        "<ParameterRefEntry parameterRef='bad'/></EntryList></SequenceContainer>"));
    const auto packet = test::hex("0000c000001a"
                                  "0020000000000001"
                                  "8000000000000001"
                                  "ffffffffffffff"
                                  "c4d641"
                                  "ff");
    Decoded decoded;
    REQUIRE_FALSE(mission->decode(packet, decoded));
    const auto& fields = mission->dictionary().packets[decoded.packet].fields;
    std::map<std::string, std::string> texts;
    for (const auto& [field, text] : decoded.texts) texts[fields[field].name] = text;
    CHECK(texts == std::map<std::string, std::string>{
                       {"a", "9007199254740993"}, {"b", "-9223372036854775807"}, {"name", "ÄÖA"}});
    CHECK(mission->dictionary().channel("bad")->type.kind == dictionary::ValueKind::text);
    CHECK_FALSE(decoded.value[*field_index(mission->dictionary().packets[decoded.packet], "name")]);
    CHECK(*decoded.value[*field_index(mission->dictionary().packets[decoded.packet], "c")] == 9007199254740991.0);
    CHECK_FALSE(decoded.timed);
}

TEST_CASE("a text of no octets is an empty channel, and what follows it is read", "[telemetry][downlink][R54]") {
    const auto mission = mission_of(with_containers(
        "<StringParameterType name='counted'><StringDataEncoding encoding='UTF-8'><Variable maxSizeInBits='64'>"
        "<DynamicValue><ParameterInstanceRef parameterRef='n'/><LinearAdjustment slope='8'/></DynamicValue>"
        "</Variable></StringDataEncoding></StringParameterType>",
        "<Parameter name='n' parameterTypeRef='u8'/><Parameter name='name' parameterTypeRef='counted'/>"
        "<Parameter name='after' parameterTypeRef='u8'/>",
        "<SequenceContainer name='P'><EntryList><ParameterRefEntry parameterRef='header'/>"
        "<ParameterRefEntry parameterRef='n'/><ParameterRefEntry parameterRef='name'/>"
        "<ParameterRefEntry parameterRef='after'/></EntryList></SequenceContainer>"));
    Decoded decoded;
    REQUIRE_FALSE(mission->decode(test::hex("0000c000000100"
                                            "07"),
                                  decoded));
    const auto& packet = mission->dictionary().packets[decoded.packet];
    CHECK(decoded.value[*field_index(packet, "after")] == 7.0);
    CHECK(decoded.raw[*field_index(packet, "name")] == 0);
    REQUIRE_FALSE(mission->decode(test::hex("0000c000000302"
                                            "4142"
                                            "07"),
                                  decoded));
    CHECK(decoded.value[*field_index(packet, "after")] == 7.0);
}

TEST_CASE("limits and label alarms of the file are judged, exclusive ones and contexts too; what is not is named",
          "[telemetry][downlink][alarms][R54]") {
    const std::string types =
        "<EnumeratedParameterType name='mode'><IntegerDataEncoding/><EnumerationList><Enumeration value='0' "
        "label='OFF'/>"
        "<Enumeration value='1' maxValue='5' label='WARM'/></EnumerationList><DefaultAlarm><EnumerationAlarmList>"
        "<EnumerationAlarm alarmLevel='warning' enumerationLabel='WARM'/></EnumerationAlarmList></DefaultAlarm>"
        "</EnumeratedParameterType>"
        "<IntegerParameterType name='temp'><IntegerDataEncoding/><DefaultAlarm minViolations='2'><StaticAlarmRanges>"
        "<WarningRange maxExclusive='50'/><CriticalRange maxInclusive='60'/></StaticAlarmRanges><ChangeAlarmRanges/>"
        "</DefaultAlarm><ContextAlarmList><ContextAlarm><StaticAlarmRanges><SevereRange maxInclusive='10'/>"
        "</StaticAlarmRanges><ContextMatch><Comparison parameterRef='m' value='OFF'/></ContextMatch></ContextAlarm>"
        "</ContextAlarmList></IntegerParameterType>";
    std::vector<dictionary::Finding> findings;
    dictionary::Findings into{"m.xml", findings};
    auto model = dictionary::xtce::read_packet_model(
        with_containers(types,
                        "<Parameter name='m' parameterTypeRef='mode'/><Parameter name='t' parameterTypeRef='temp'/>",
                        "<SequenceContainer name='P'><EntryList><ParameterRefEntry parameterRef='header'/>"
                        "<ParameterRefEntry parameterRef='m'/><ParameterRefEntry parameterRef='t'/></EntryList>"
                        "</SequenceContainer>"),
        into);
    REQUIRE(model);
    REQUIRE(findings.size() == 1);
    CHECK(findings[0].message == "ChangeAlarmRanges of type 'temp' is not judged");
    const OtherMission mission{std::move(*model), 1};
    CHECK(mission.unsupported_alarms().empty());
    const auto& dictionary = mission.dictionary();
    AlarmMonitor monitor{dictionary};
    const auto id = [&](const char* name) { return dictionary.channel(name)->id; };
    std::vector<std::string> said;
    const auto sample = [&](const char* name, double value) {
        std::vector<AlarmChange> changes;
        monitor.sample(id(name), value, Sclk{0.0}, changes);
        for (const auto& change : changes) said.push_back(std::string(name_of(change.severity)) + " " + change.limit);
    };
    sample("m", 5.0);   // in the range of WARM
    sample("t", 50.0);  // the exclusive limit itself, the first of two
    sample("t", 50.0);
    sample("t", 61.0);
    sample("t", 61.0);
    sample("m", 0.0);
    sample("t", 11.0);  // the context replaces the limits
    CHECK(said ==
          std::vector<std::string>{"warning = WARM", "warning >= 50", "critical > 60", "none ", "severe > 10 in OFF"});
}

}  // namespace telemetry_other_mission_test
