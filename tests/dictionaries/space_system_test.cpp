// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/xtce/space_system.hpp"
#include "tests/support/planted.hpp"

namespace dictionaries_space_system_test {

using namespace aeolis;
using aeolis::tests::Planted;

namespace {

constexpr const char* msl = "msl.xml";

void check_all(const std::vector<Planted>& all) {
    for (const Planted& planted : all) tests::check_planted(planted);
}

}  // namespace

TEST_CASE("each broken rule of types gives one line, and nothing is loaded", "[dictionary][xtce][R40]") {
    check_all({
        {"number without unit", msl, "<Unit>octet</Unit>", "", "type 'octets_u32': has no unit", -1},
        {"value twice", msl, "value=\"4\" label=\"exo_atmospheric\"", "value=\"1\" label=\"exo_atmospheric\"",
         "value 1 is there twice"},
        {"label twice", msl, "label=\"exo_atmospheric\"", "label=\"pre_edl\"", "label 'pre_edl' is there twice"},
        {"value too large", msl, "value=\"4\" label=\"exo_atmospheric\"", "value=\"256\" label=\"exo_atmospheric\"",
         "value 256 does not fit 8 bits"},
        {"label no name", msl, "label=\"exo_atmospheric\"", "label=\"exo-atmospheric\"", "has characters other than"},
        {"alarms not nested", msl, "<CriticalRange maxInclusive=\"24000\"/>", "<CriticalRange maxInclusive=\"19000\"/>",
         "CriticalRange is not nested"},
        {"alarm upside down", msl, "<WatchRange minInclusive=\"-25\" maxInclusive=\"25\"/>",
         "<WatchRange minInclusive=\"25\" maxInclusive=\"-25\"/>", "minInclusive is above maxInclusive"},
        {"alarm of no label", msl, "enumerationLabel=\"second_chance\"", "enumerationLabel=\"third_chance\"",
         "the alarm names 'third_chance'"},
        {"alarm level", msl, "alarmLevel=\"critical\"", "alarmLevel=\"grave\"", "alarm level 'grave' is unknown"},
        {"minViolations", msl, "minViolations=\"8\"", "minViolations=\"0\"", "minViolations '0'"},
        {"range does not fit", msl, "minInclusive=\"1\" maxInclusive=\"65535\"",
         "minInclusive=\"1\" maxInclusive=\"65536\"", "the valid range does not fit 16 bits"},
        {"range upside down", msl, "minInclusive=\"380\" maxInclusive=\"450\"",
         "minInclusive=\"450\" maxInclusive=\"380\"", "minInclusive is above maxInclusive"},
        {"encoding", msl, "<IntegerDataEncoding sizeInBits=\"16\"/>", "<IntegerDataEncoding sizeInBits=\"65\"/>",
         "sizeInBits '65'"},
        {"type twice", msl, "<BooleanParameterType name=\"flag\"",
         "<BooleanParameterType name=\"header_u1\"><IntegerDataEncoding "
         "sizeInBits=\"1\"/></BooleanParameterType><BooleanParameterType name=\"flag\"",
         "'header_u1' is there twice"},
        {"not supported", msl, "<StaticAlarmRanges>", "<ChangeAlarmRanges/><StaticAlarmRanges>",
         "element 'ChangeAlarmRanges' in DefaultAlarm is unknown or not supported"},
        {"binary not in octets", msl, "<FixedValue>1840</FixedValue>", "<FixedValue>1841</FixedValue>",
         "only a fixed number of whole octets is supported"},
        {"binary a channel", msl,
         "parameterTypeRef=\"product_content\" shortDescription=\"this part; what is beyond "
         "product_octets is zero\"/>",
         "parameterTypeRef=\"product_content\"><AliasSet><Alias nameSpace=\"channel\" alias=\"X-1\"/></AliasSet>"
         "</Parameter>",
         "parameter 'content': binary data are no channel"},
        {"alarm context of no channel", msl, "parameterRef=\"edl_phase\" value=\"sky_crane\"",
         "parameterRef=\"edl_place\" value=\"sky_crane\"",
         "type 'deceleration_g_f32': there is no parameter 'edl_place'"},
        {"alarm context of no label", msl, "parameterRef=\"edl_phase\" value=\"sky_crane\"",
         "parameterRef=\"edl_phase\" value=\"sky_hook\"", "value 'sky_hook' is neither a number nor a label"},
        {"alarm without its context", msl,
         "<ContextMatch><Comparison parameterRef=\"edl_phase\" value=\"sky_crane\"/></ContextMatch>", "<ContextMatch/>",
         "a context alarm without ContextMatch"},
        {"latch", msl, "<AncillaryData name=\"latch\">true<", "<AncillaryData name=\"latch\">yes<",
         "latch 'yes' is neither true nor false"},
        {"minConformance", msl, "minConformance=\"4\"", "minConformance=\"0\"", "minConformance '0'"},
        {"misspelt attribute", msl, "minViolations=\"8\"", "minviolations=\"8\"", "attribute 'minviolations'"},
    });
}

TEST_CASE("each broken rule of packets and events gives one line, and nothing is loaded", "[dictionary][xtce][R40]") {
    check_all({
        {"binary off the octets", msl, "<ParameterRefEntry parameterRef=\"content\"/>",
         "<ParameterRefEntry parameterRef=\"content\"><LocationInContainerInBits "
         "referenceLocation=\"previousEntry\"><FixedValue>3</FixedValue></LocationInContainerInBits>"
         "</ParameterRefEntry>",
         "binary data begin at a whole octet"},
        {"dangling type", msl, "parameterTypeRef=\"EdlPhase\"", "parameterTypeRef=\"EdlFace\"",
         "there is no type 'EdlFace'"},
        {"dangling parameter", msl, "<ParameterRefEntry parameterRef=\"edl_cycle_count\"/>",
         "<ParameterRefEntry parameterRef=\"edl_cycles\"/>", "there is no parameter 'edl_cycles'"},
        {"dangling base", msl, "<BaseContainer containerRef=\"SpacePacket\">",
         "<BaseContainer containerRef=\"Packet\">", "there is no container 'Packet'"},
        {"dangling flag", msl, "<Comparison parameterRef=\"seconds_to_entry_s_defined\"",
         "<Comparison parameterRef=\"seconds_to_entry_s_known\"", "there is no parameter 'seconds_to_entry_s_known'"},
        {"dangling restriction", msl, "<Comparison parameterRef=\"apid\" value=\"0x010\"/>",
         "<Comparison parameterRef=\"vapid\" value=\"0x010\"/>", "there is no parameter 'vapid'"},
        {"overlapping bits", msl, "<FixedValue>7</FixedValue>", "<FixedValue>-1</FixedValue>",
         "overlaps the bits of 'seconds_to_entry_s_defined'", -1},
        {"before the packet", msl, "<FixedValue>7</FixedValue>", "<FixedValue>-1000</FixedValue>",
         "the entry begins before the packet"},
        {"twice in a packet", msl, "<ParameterRefEntry parameterRef=\"edl_cycle_count\"/>",
         "<ParameterRefEntry parameterRef=\"edl_cycle_count\"/><ParameterRefEntry parameterRef=\"edl_cycle_count\"/>",
         "'edl_cycle_count' is there twice in one packet"},
        {"APID twice", msl, "parameterRef=\"apid\" value=\"0x022\"", "parameterRef=\"apid\" value=\"0x021\"",
         "packet 'GncImu': APID 33 is taken", -12},
        {"APID too large", msl, "parameterRef=\"apid\" value=\"0x022\"", "parameterRef=\"apid\" value=\"0x7FF\"",
         "APID 2047 is outside", -12},
        {"event id twice", msl, "parameterRef=\"event_id\" value=\"2\"", "parameterRef=\"event_id\" value=\"1\"",
         "event 'COMMAND_REFUSED': id 1 is taken", -11},
        {"level", msl, ">WARNING_HI<", ">WARNING_HIGH<", "level 'WARNING_HIGH' is unknown", -2},
        {"format", msl, "refused: {reason}", "refused: {cause}", "its format names 'cause'", -3},
        {"alias twice", msl, "alias=\"EDL-0002\"", "alias=\"EDL-0001\"", "channel alias 'EDL-0001' is there twice", -1},
        {"name a keyword", msl, "<Parameter name=\"packet_version\"",
         "<Parameter name=\"union\" parameterTypeRef=\"header_u1\"/><Parameter name=\"packet_version\"",
         "is a keyword of C++"},
        {"unusable name", msl, "<SequenceContainer name=\"Wideband\"",
         "<SequenceContainer name=\"Wide/band\"/><SequenceContainer name=\"Wideband\"", "has no usable name"},
        {"no APID", msl, "<SequenceContainer name=\"Wideband\"",
         "<SequenceContainer name=\"Narrowband\"><EntryList/></SequenceContainer><SequenceContainer name=\"Wideband\"",
         "packet 'Narrowband' has no APID"},
        {"channel in no packet", msl, "<Parameter name=\"wideband_01\"",
         "<Parameter name=\"lost\" parameterTypeRef=\"number_f32\"><AliasSet><Alias nameSpace=\"channel\" "
         "alias=\"WB-0\"/></AliasSet></Parameter><Parameter name=\"wideband_01\"",
         "channel 'lost' is in no packet"},
    });
}

TEST_CASE("each broken rule of commands gives one line, and nothing is loaded", "[dictionary][xtce][R40]") {
    check_all({
        {"opcode twice", msl, "argumentValue=\"0x0103\"", "argumentValue=\"0x0102\"", "opcode 258 is taken", -2},
        {"opcode no number", msl, "argumentValue=\"0x0103\"", "argumentValue=\"begin\"", "argumentValue 'begin'"},
        {"dangling argument type", msl, "argumentTypeRef=\"latitude\"", "argumentTypeRef=\"altitude\"",
         "there is no type 'altitude'"},
        {"dangling argument", msl, "<ArgumentRefEntry argumentRef=\"anchor\"/>",
         "<ArgumentRefEntry argumentRef=\"rope\"/>", "there is no argument 'rope'"},
        {"default outside", msl, "initialValue=\"405\"", "initialValue=\"500\"",
         "default 500 is outside its valid range"},
        {"default no number", msl, "initialValue=\"405\"", "initialValue=\"fast\"",
         "initialValue 'fast' is not a number"},
        {"precondition", msl, "parameterRef=\"late_cruise\" value=\"1\"", "parameterRef=\"cruise\" value=\"1\"",
         "there is no parameter 'cruise'"},
        {"precondition no channel", msl, "parameterRef=\"late_cruise\" value=\"1\"",
         "parameterRef=\"apid\" value=\"1\"", "'apid' is no channel"},
        {"verifier", msl, "containerRef=\"Events/COMMAND_ACCEPTED\"", "containerRef=\"Events/COMMAND_EXCEPTED\"",
         "there is no container 'Events/COMMAND_EXCEPTED'"},
        {"verifier no event", msl, "containerRef=\"Events/COMMAND_ACCEPTED\"", "containerRef=\"SyncStatus\"",
         "'SyncStatus' is no event"},
        {"window", msl, "timeToStopChecking=\"PT10S\"", "timeToStopChecking=\"10\"", "a check window is a duration"},
        {"significance", msl, "consequenceLevel=\"critical\"", "consequenceLevel=\"dire\"", "'dire' is unknown"},
        {"base", msl, "metaCommandRef=\"Telecommand\"", "metaCommandRef=\"Command\"", "there is no command 'Command'"},
    });
}

TEST_CASE("XML that does not parse names its line", "[dictionary][xtce]") {
    check_all({
        {"cut tag", msl, "<Header version=\"1\"", "<Header version=\"1", "the XML does not parse"},
    });
}

TEST_CASE("XML of another kind is no dictionary", "[dictionary][xtce]") {
    for (const char* text : {"<Other/>", "<SpaceShip name=\"S\"></SpaceShip>"}) {
        std::vector<dictionary::Finding> all;
        dictionary::Findings findings{"f.xml", all};
        CHECK_FALSE(dictionary::xtce::read_space_system(text, findings));
        REQUIRE(all.size() == 1);
        CHECK(all.front().text() == "f.xml:1: the root element is not SpaceSystem");
    }
}

TEST_CASE("a reference is looked for in its own SpaceSystem, then outwards", "[dictionary][xtce]") {
    const std::string text = R"(<SpaceSystem name="Outer">
  <TelemetryMetaData>
    <ParameterTypeSet>
      <IntegerParameterType name="u16"><UnitSet><Unit>1</Unit></UnitSet><IntegerDataEncoding sizeInBits="16"/></IntegerParameterType>
      <IntegerParameterType name="u96"><UnitSet><Unit>1</Unit></UnitSet><IntegerDataEncoding sizeInBits="64"/></IntegerParameterType>
    </ParameterTypeSet>
    <ParameterSet><Parameter name="apid" parameterTypeRef="u16"/><Parameter name="a" parameterTypeRef="u96"/><Parameter name="b" parameterTypeRef="u16"/><Parameter name="c" parameterTypeRef="u16"/></ParameterSet>
    <ContainerSet>
      <SequenceContainer name="Base" abstract="true"><EntryList><ParameterRefEntry parameterRef="apid"/><ParameterRefEntry parameterRef="a"/><ParameterRefEntry parameterRef="b"/><ParameterRefEntry parameterRef="c"/></EntryList></SequenceContainer>
    </ContainerSet>
  </TelemetryMetaData>
  <SpaceSystem name="Inner">
    <TelemetryMetaData>
      <ParameterTypeSet>
        <IntegerParameterType name="u16"><UnitSet><Unit>m</Unit></UnitSet><IntegerDataEncoding sizeInBits="16"/></IntegerParameterType>
      </ParameterTypeSet>
      <ParameterSet><Parameter name="x" parameterTypeRef="u16"/><Parameter name="y" parameterTypeRef="/Outer/u16"/></ParameterSet>
      <ContainerSet>
        <SequenceContainer name="P"><EntryList><ParameterRefEntry parameterRef="x"/><ParameterRefEntry parameterRef="y"/></EntryList>
          <BaseContainer containerRef="Base"><RestrictionCriteria><Comparison parameterRef="apid" value="7"/></RestrictionCriteria></BaseContainer>
        </SequenceContainer>
      </ContainerSet>
    </TelemetryMetaData>
  </SpaceSystem>
</SpaceSystem>)";
    std::vector<dictionary::Finding> all;
    dictionary::Findings findings{"f.xml", all};
    const auto system = dictionary::xtce::read_space_system(text, findings);
    for (const auto& finding : all) UNSCOPED_INFO(finding.text());
    REQUIRE(all.empty());
    REQUIRE(system->packets.size() == 1);
    const auto& packet = system->packets.front();
    REQUIRE(packet.fields.size() == 2);
    CHECK(packet.fields[0].type.unit == "m");
    CHECK(packet.fields[1].type.unit == "1");
    CHECK(packet.fields[1].position_bits == 128);
    CHECK(packet.octets == 20);
}

TEST_CASE("a flag that stands behind the value that it makes defined is refused: packets are read front to back",
          "[dictionary][xtce]") {
    const auto findings_of = [](const char* entries) {
        const std::string text = std::string{R"(<SpaceSystem name="S"><TelemetryMetaData><ParameterTypeSet>
<IntegerParameterType name="u128"><UnitSet><Unit>1</Unit></UnitSet><IntegerDataEncoding sizeInBits="64"/></IntegerParameterType>
<IntegerParameterType name="u8"><UnitSet><Unit>1</Unit></UnitSet><IntegerDataEncoding sizeInBits="8"/></IntegerParameterType>
<IntegerParameterType name="u1"><UnitSet><Unit>1</Unit></UnitSet><IntegerDataEncoding sizeInBits="1"/></IntegerParameterType>
</ParameterTypeSet><ParameterSet><Parameter name="apid" parameterTypeRef="u128"/><Parameter name="rest" parameterTypeRef="u128"/>
<Parameter name="known" parameterTypeRef="u1"/><Parameter name="x" parameterTypeRef="u8"><ParameterProperties><ValidityCondition>
<Comparison parameterRef="known" value="1"/></ValidityCondition></ParameterProperties></Parameter></ParameterSet><ContainerSet>
<SequenceContainer name="Base" abstract="true"><EntryList><ParameterRefEntry parameterRef="apid"/><ParameterRefEntry parameterRef="rest"/></EntryList></SequenceContainer>
<SequenceContainer name="P"><EntryList>)"} +
                                 entries +
                                 R"(</EntryList><BaseContainer containerRef="Base"><RestrictionCriteria>
<Comparison parameterRef="apid" value="7"/></RestrictionCriteria></BaseContainer></SequenceContainer>
</ContainerSet></TelemetryMetaData></SpaceSystem>)";
        std::vector<dictionary::Finding> all;
        dictionary::Findings findings{"f.xml", all};
        dictionary::xtce::read_space_system(text, findings);
        return all;
    };
    constexpr const char *flag = R"(<ParameterRefEntry parameterRef="known"/>)",
                         *value = R"(<ParameterRefEntry parameterRef="x"/>)";
    CHECK(findings_of((std::string{flag} + value).c_str()).empty());
    const auto found = findings_of((std::string{value} + flag).c_str());
    REQUIRE(found.size() == 1);
    CHECK(found.front().text() == "f.xml:9: 'x' is valid by 'known', which stands behind it");
}

TEST_CASE("containers based on each other, and SpaceSystems without end, are found and end", "[dictionary][xtce]") {
    std::vector<dictionary::Finding> all;
    dictionary::Findings findings{"f.xml", all};
    CHECK(dictionary::xtce::read_space_system(
        R"(<SpaceSystem name="S"><TelemetryMetaData><ContainerSet>
<SequenceContainer name="A"><EntryList/><BaseContainer containerRef="B"/></SequenceContainer>
<SequenceContainer name="B"><EntryList/><BaseContainer containerRef="A"/></SequenceContainer>
</ContainerSet></TelemetryMetaData></SpaceSystem>)",
        findings));
    REQUIRE(all.size() == 2);  // by the reader of packets' layouts and by that of containers
    CHECK_THAT(all[0].message + all[1].message, Catch::Contains("is based on itself"));
    CHECK_THAT(all[0].message + all[1].message, Catch::Contains("derives from itself, by 'A': it takes no packet"));

    all.clear();
    std::string deep;
    for (int i = 0; i < 2000; ++i) deep += "<SpaceSystem name=\"S\">";
    for (int i = 0; i < 2000; ++i) deep += "</SpaceSystem>";
    CHECK(dictionary::xtce::read_space_system(deep, findings));
    REQUIRE(all.size() == 1);
    CHECK_THAT(all.front().message, Catch::Contains("are nested deeper than"));
}

}  // namespace dictionaries_space_system_test
