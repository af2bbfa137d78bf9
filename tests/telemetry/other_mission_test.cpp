// SPDX-License-Identifier: Apache-2.0
#include "telemetry/other_mission.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/mission_copy.hpp"
#include "tests/support/octets.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <algorithm>
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
    CHECK(packet.apid == OtherMission::any_apid);
    CHECK(mission->decode(test::hex("000100000007 0506"), decoded) == "not_a_packet");
    CHECK(mission->decode({}, decoded) == "not_a_packet");
    CHECK(mission_of(with_containers("", "", ""))->decode(test::hex("000100000001 0506"), decoded) ==
          "the XTCE file has no container to begin with");
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
    CHECK(mission->left_out() == 0);
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

}  // namespace telemetry_other_mission_test
