// SPDX-License-Identifier: Apache-2.0
#include "flight/edl_comm/sensor_tables.hpp"

#include "telemetry/product_assembler.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/outbox.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <algorithm>

namespace flight_sensor_tables_test {

using namespace aeolis;
using namespace aeolis::flight;

namespace {

struct Fixture {
    SensorTables tables;
    std::vector<Record> records;
    std::uint32_t next_count = 100;

    template <typename M>
    void say(const M& message) {
        test::OutboxRecorder recorder{ModuleId::edl_comm};
        tables.on(message, recorder.out);
        for (const Record& record : recorder.sent<Record>()) records.push_back(record);
    }
    void read(std::size_t samples) {
        ImuReadings readings;
        for (std::size_t i = 0; i < samples; ++i) {
            const double number = next_count++;
            readings.samples.push_back({static_cast<std::uint32_t>(number), {number, 0.0, -1.0}, {0.0, 0.25, 0.0}});
        }
        say(readings);
    }
};

/// The rows of a recorded table, decoded as the ground does: the values of one field.
std::vector<double> column(const std::vector<Record>& records, const char* field) {
    const auto& dictionary = tests::shipped_dictionary();
    const telemetry::Decommutator decommutator{dictionary};
    telemetry::Decoded decoded;
    std::vector<double> all;
    for (const Record& record : records) {
        std::vector<std::uint8_t> packet(record.size + tm_overhead_octets);
        std::copy_n(record.data.begin(), record.size, packet.begin() + tm_data_offset_octets);
        seal_tm_packet(packet, record.apid, 0, record.time, dictionary_id);
        REQUIRE_FALSE(decommutator.decode(packet, decoded));
        const auto rows = telemetry::rows_in(dictionary, decoded, packet);
        REQUIRE(rows);
        for (const auto& row : *rows) {
            REQUIRE_FALSE(decommutator.decode(row, decoded));
            const auto index = telemetry::field_index(dictionary.packets[decoded.packet], field);
            REQUIRE(index);
            all.push_back(decoded.value[*index].value_or(-1.0));
        }
    }
    return all;
}

}  // namespace

TEST_CASE("eight readings of the IMU make a packet, whatever number comes with a tick", "[edl_comm][R52]") {
    Fixture f;
    f.say(PhaseChanged{EdlPhase::exo_atmospheric});
    for (const std::size_t samples : {3U, 3U, 4U, 3U, 3U}) f.read(samples);
    CHECK(f.records.size() == 2);
    CHECK(column(f.records, "imu_count").size() == 16);
    CHECK(column(f.records, "imu_count").front() == 100.0);
    CHECK(column(f.records, "delta_v_x_mps").back() == 115.0);
    CHECK(column(f.records, "delta_angle_y_rad").back() == 0.25);
}

TEST_CASE("readings are recorded from separation on, and what is left of a packet when the landing is over",
          "[edl_comm][R52]") {
    Fixture f;
    for (int i = 0; i < 10; ++i) f.read(4);
    CHECK(f.records.empty());
    f.say(PhaseChanged{EdlPhase::exo_atmospheric});
    f.next_count = 500;
    f.read(4);
    f.say(PhaseChanged{EdlPhase::flyaway});
    f.read(1);
    CHECK(f.records.empty());
    f.say(PhaseChanged{EdlPhase::landed});
    CHECK(column(f.records, "imu_count") == std::vector{500.0, 501.0, 502.0, 503.0, 504.0});
    for (int i = 0; i < 10; ++i) f.read(4);
    CHECK(f.records.size() == 1);
}

TEST_CASE("each reading of a beam is recorded with its tick, valid or not", "[edl_comm][R52]") {
    Fixture f;
    f.say(PhaseChanged{EdlPhase::parachute_descent});
    for (std::uint8_t i = 0; i < 8; ++i) {
        RadarReturns returns{Sclk{1000.0 + i / 64.0}, {}};
        returns.beams.push_back({.beam = static_cast<std::uint8_t>(i % 6),
                                 .direction_B = {0.0, 0.5, 0.75},
                                 .valid = i % 2 == 0,
                                 .range_m = 4000.0 + i,
                                 .range_rate_mps = -80.5});
        f.say(returns);
    }
    REQUIRE(f.records.size() == 1);
    CHECK(f.records.front().apid == packet::RadarTable::apid);
    CHECK(column(f.records, "beam_sclk")[5] == 1000.0 + 5.0 / 64.0);
    CHECK(column(f.records, "beam") == std::vector{0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 0.0, 1.0});
    CHECK(column(f.records, "beam_valid") == std::vector{1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0});
    CHECK(column(f.records, "beam_range_m")[7] == 4007.0);
    CHECK(column(f.records, "beam_range_rate_mps")[0] == -80.5);
    CHECK(column(f.records, "beam_direction_z")[0] == 0.75);
}

}  // namespace flight_sensor_tables_test
