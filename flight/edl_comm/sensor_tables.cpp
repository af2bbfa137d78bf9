// SPDX-License-Identifier: Apache-2.0
#include "flight/edl_comm/sensor_tables.hpp"

namespace aeolis::flight {
namespace {

packet::BeamReading row_of(const RadarBeam& beam, Sclk at) {
    return {.beam_sclk = at.seconds,
            .beam_range_m = single(beam.range_m),
            .beam_range_rate_mps = single(beam.range_rate_mps),
            .beam_direction_x = single(beam.direction_B[0]),
            .beam_direction_y = single(beam.direction_B[1]),
            .beam_direction_z = single(beam.direction_B[2]),
            .beam = beam.beam,
            .beam_valid = beam.valid};
}

}  // namespace

packet::ImuIncrements row_of(const ImuSample& sample) {
    return {.imu_count = sample.count,
            .delta_v_x_mps = single(sample.delta_v_mps[0]),
            .delta_v_y_mps = single(sample.delta_v_mps[1]),
            .delta_v_z_mps = single(sample.delta_v_mps[2]),
            .delta_angle_x_rad = single(sample.delta_angle_rad[0]),
            .delta_angle_y_rad = single(sample.delta_angle_rad[1]),
            .delta_angle_z_rad = single(sample.delta_angle_rad[2])};
}

void SensorTables::on(const ImuReadings& readings, Outbox& out) {
    if (!in_edl_) return;
    for (const ImuSample& sample : readings.samples) imu_.add(row_of(sample), out);
}

void SensorTables::on(const RadarReturns& returns, Outbox& out) {
    if (!in_edl_) return;
    for (const RadarBeam& beam : returns.beams) radar_.add(row_of(beam, returns.now), out);
}

void SensorTables::on(const PhaseChanged& change, Outbox& out) {
    in_edl_ = change.phase >= EdlPhase::exo_atmospheric && change.phase != EdlPhase::landed;
    if (in_edl_) return;
    imu_.flush(out);
    radar_.flush(out);
}

}  // namespace aeolis::flight
