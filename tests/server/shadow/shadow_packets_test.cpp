// SPDX-License-Identifier: Apache-2.0
#include "server/shadow/shadow_packets.hpp"

#include "telemetry/decoded_packet.hpp"
#include "telemetry/text.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <algorithm>

namespace server_shadow_packets_test {

using namespace aeolis;
using namespace aeolis::server::shadow;

namespace {

telemetry::DecodedPacket decoded(const std::vector<std::uint8_t>& packet) {
    telemetry::PacketDecoder decoder{tests::shipped_dictionary()};
    telemetry::DecodedPacket decoded;
    decoder.decode(packet, decoded);
    INFO(decoded.refusal);
    REQUIRE(decoded.refusal.empty());
    return decoded;
}

std::optional<double> value(const std::vector<std::uint8_t>& octets, std::string_view name) {
    const auto packet = decoded(octets);
    const auto& container = tests::shipped_dictionary().packets[packet.content.packet];
    const auto field = telemetry::field_index(container, name);
    REQUIRE(field);
    return packet.content.value[*field];
}

}  // namespace

TEST_CASE("the state of ground's flight decodes by the dictionary, and what is not known is undefined",
          "[shadow][R57]") {
    ShadowPackets packets{tests::shipped_dictionary()};
    ShadowState state;
    state.stand = Stand::with_the_vehicle;
    state.timepoint = 31;
    state.flight = {12'000.0, 405.0};
    state.heard_age_s = 0.5;
    state.residual = {25.0, -3.0, 0.25, 0.125};
    state.plan.emplace();
    state.plan->altitude_m.least = 11'000.0;
    state.plan->altitude_m.most = 13'000.0;
    state.plan->speed_mps.median = 400.0;
    state.departures = 2;
    state.plan_cases = 300;
    const auto all = packets.state(state, Sclk{2000.0});
    CHECK(value(all, "shadow_stand") == 1.0);
    CHECK(value(all, "shadow_timepoint") == 31.0);
    CHECK(value(all, "shadow_altitude_m") == 12'000.0);
    CHECK(value(all, "shadow_heard_age_s") == 0.5);
    CHECK(value(all, "residual_position_m") == 25.0);
    CHECK(value(all, "residual_altitude_m") == -3.0);
    CHECK(value(all, "residual_attitude_deg") == 0.125);
    CHECK(value(all, "plan_altitude_low_m") == 11'000.0);
    CHECK(value(all, "plan_altitude_high_m") == 13'000.0);
    CHECK(value(all, "plan_speed_mps") == 400.0);
    CHECK(value(all, "shadow_departures") == 2.0);
    CHECK(value(all, "plan_cases") == 300.0);

    const auto none = packets.state({}, Sclk{2001.0});
    CHECK(value(none, "shadow_stand") == 0.0);
    for (const char* name : {"shadow_timepoint", "shadow_altitude_m", "shadow_heard_age_s", "residual_position_m",
                             "residual_speed_mps", "plan_altitude_m", "plan_speed_high_mps"})
        CHECK_FALSE(value(none, name));
    CHECK(read_primary_header(none)->count == read_primary_header(all)->count + 1);
}

TEST_CASE("an expected time decodes by the dictionary", "[shadow][R57]") {
    ShadowPackets packets{tests::shipped_dictionary()};
    ExpectedTime time;
    time.e_s = 277.375;
    time.interval_99 = ExpectedTime::Interval{275.0, 280.5};
    time.cases = 300;
    const auto packet = packets.expects(34, time, true, Sclk{2000.0});
    CHECK(value(packet, "expected_timepoint") == 34.0);
    CHECK(value(packet, "expected_told") == 1.0);
    CHECK(value(packet, "expected_interval_defined") == 1.0);
    CHECK(value(packet, "expected_after_entry_s") == 277.375);
    CHECK(value(packet, "expected_to_s") == 280.5);
    CHECK(value(packet, "expected_cases") == 300.0);
    CHECK(value(packets.moved({7.0, 0.5, 0.25}, Sclk{2000.0}), "moved_speed_mps") == 0.5);
}

TEST_CASE("a departure names what departs, when it was seen, and what was expected", "[shadow][R57]") {
    const auto& dictionary = tests::shipped_dictionary();
    ShadowPackets packets{dictionary};
    const auto text = [&](const std::vector<std::uint8_t>& octets) {
        const auto packet = decoded(octets);
        REQUIRE(packet.event != nullptr);
        CHECK(packet.event->level == (packet.event->name.ends_with("DEPARTED") ? dictionary::EventLevel::warning_hi
                                                                               : dictionary::EventLevel::activity_lo));
        return telemetry::event_text(dictionary, *packet.event, packet.content);
    };
    const auto row = std::ranges::find(dictionary.timeline, "heatshield_separation", &dictionary::TimelineRow::name);
    TimepointDeparture late;
    late.row = static_cast<std::uint16_t>(row - dictionary.timeline.begin());
    late.seen_s = 292.0;
    late.expected.e_s = 282.0;
    late.expected.tolerated = {278.0, 286.0};
    CHECK_THAT(text(packets.departed(late, Sclk{2292.0})), Catch::Contains("heatshield") && Catch::Contains("292") &&
                                                               Catch::Contains("282") && Catch::Contains("286"));
    CourseDeparture course;
    course.quantity = Quantity::speed_mps;
    course.seen_s = 300.0;
    course.observed = 160.5;
    course.range.least = course.range.most = 90.0;
    CHECK_THAT(text(packets.departed(course, Sclk{2300.0})),
               Catch::Contains("speed") && Catch::Contains("160.5") && Catch::Contains("90"));
    CHECK_THAT(text(packets.plan_flown(300, Sclk{2000.0})), Catch::StartsWith("300 flights of the plan"));
    CHECK_THAT(text(packets.plan_changed(Sclk{2000.0})), Catch::StartsWith("A command changes the plan"));
}

}  // namespace server_shadow_packets_test
