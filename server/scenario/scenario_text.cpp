// SPDX-License-Identifier: Apache-2.0
#include "server/scenario/scenario_text.hpp"

#include "server/scenario/air_table.hpp"
#include "server/scenario/height_grid_text.hpp"
#include "server/scenario/loaded_parameters.hpp"
#include "server/scenario/text_file.hpp"

#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <google/protobuf/io/tokenizer.h>
#include <google/protobuf/text_format.h>
#include <initializer_list>
#include <limits>
#include <memory>
#include <sstream>
#include <utility>

namespace aeolis::server {
namespace {

using google::protobuf::Message;
using simulation::Scenario;

constexpr std::size_t scenario_octets_max = 1 << 20;  // chosen: shipped scenarios are under 2 KiB
constexpr int like_chain_max = 8;                     // chosen
constexpr const char* shipped_extension = ".textproto";

/// Binds a field of the message to the member of the struct with the same name and number.
template <typename Struct>
struct Bound {
    const char* field;
    double Struct::* member;
};
template <typename Struct>
using Bindings = std::initializer_list<Bound<Struct>>;

#define AEOLIS_BIND(Struct, member) {#member, &simulation::Struct::member}

const Bindings<simulation::EntryState> entry_fields = {
    AEOLIS_BIND(EntryState, radius_m),        AEOLIS_BIND(EntryState, latitude_deg),
    AEOLIS_BIND(EntryState, longitude_deg),   AEOLIS_BIND(EntryState, speed_mps),
    AEOLIS_BIND(EntryState, flight_path_deg), AEOLIS_BIND(EntryState, azimuth_deg),
};
const Bindings<simulation::Target> target_fields = {
    AEOLIS_BIND(Target, latitude_deg),    AEOLIS_BIND(Target, longitude_deg),   AEOLIS_BIND(Target, radius_m),
    AEOLIS_BIND(Target, ellipse_major_m), AEOLIS_BIND(Target, ellipse_minor_m),
};
const Bindings<simulation::Ground> ground_fields = {
    AEOLIS_BIND(Ground, height_m),
    AEOLIS_BIND(Ground, slope_deg),
    AEOLIS_BIND(Ground, uphill_azimuth_deg),
    AEOLIS_BIND(Ground, roughness_length_m),
};
const Bindings<simulation::EngineDesign> engine_fields = {
    AEOLIS_BIND(EngineDesign, largest_thrust_N),
    AEOLIS_BIND(EngineDesign, least_thrust_N),
    AEOLIS_BIND(EngineDesign, least_impulse_s),
    AEOLIS_BIND(EngineDesign, most_impulse_s),
};
const Bindings<simulation::Guidance> guidance_fields = {
    AEOLIS_BIND(Guidance, divert_m),
    AEOLIS_BIND(Guidance, divert_azimuth_deg),
    AEOLIS_BIND(Guidance, entry_lift_to_drag),
    AEOLIS_BIND(Guidance, engine_impulse_s),
    AEOLIS_BIND(Guidance, aim_east_m),
    AEOLIS_BIND(Guidance, aim_north_m),
    AEOLIS_BIND(Guidance, reference_turn_mps),
    AEOLIS_BIND(Guidance, reference_held_from_mps),
    AEOLIS_BIND(Guidance, reference_held_to_mps),
    AEOLIS_BIND(Guidance, reference_up_mps),
    AEOLIS_BIND(Guidance, reference_end_mps),
};
const Bindings<simulation::AeroScale> aero_fields = {
    AEOLIS_BIND(AeroScale, mach),
    AEOLIS_BIND(AeroScale, drag),
    AEOLIS_BIND(AeroScale, lift),
};
const Bindings<simulation::Belief> belief_fields = {
    AEOLIS_BIND(Belief, parachute_drag_area_m2), AEOLIS_BIND(Belief, steady_wind_east_mps),
    AEOLIS_BIND(Belief, steady_wind_north_mps),  AEOLIS_BIND(Belief, gravity_fraction),
    AEOLIS_BIND(Belief, position_east_m),        AEOLIS_BIND(Belief, position_north_m),
    AEOLIS_BIND(Belief, position_up_m),          AEOLIS_BIND(Belief, attitude_x_deg),
    AEOLIS_BIND(Belief, attitude_y_deg),         AEOLIS_BIND(Belief, attitude_z_deg),
};
const Bindings<simulation::Masses> mass_fields = {
    AEOLIS_BIND(Masses, cruise_stage_kg),    AEOLIS_BIND(Masses, cruise_balance_each_kg),
    AEOLIS_BIND(Masses, entry_kg),           AEOLIS_BIND(Masses, entry_balance_each_kg),
    AEOLIS_BIND(Masses, heatshield_kg),      AEOLIS_BIND(Masses, backshell_and_parachute_kg),
    AEOLIS_BIND(Masses, powered_descent_kg), AEOLIS_BIND(Masses, propellant_kg),
    AEOLIS_BIND(Masses, rover_kg),
};
const Bindings<simulation::Gyration> gyration_fields = {
    AEOLIS_BIND(Gyration, with_cruise_stage_across_m),
    AEOLIS_BIND(Gyration, with_cruise_stage_along_m),
    AEOLIS_BIND(Gyration, entry_vehicle_across_m),
    AEOLIS_BIND(Gyration, entry_vehicle_along_m),
    AEOLIS_BIND(Gyration, without_heatshield_across_m),
    AEOLIS_BIND(Gyration, without_heatshield_along_m),
    AEOLIS_BIND(Gyration, stage_with_rover_across_m),
    AEOLIS_BIND(Gyration, stage_with_rover_along_m),
    AEOLIS_BIND(Gyration, stage_across_m),
    AEOLIS_BIND(Gyration, stage_along_m),
};
const Bindings<simulation::Stations> station_fields = {
    AEOLIS_BIND(Stations, rover_m),     AEOLIS_BIND(Stations, heatshield_m),
    AEOLIS_BIND(Stations, backshell_m), AEOLIS_BIND(Stations, cruise_stage_m),
    AEOLIS_BIND(Stations, balances_m),  AEOLIS_BIND(Stations, balances_off_axis_m),
};
const Bindings<simulation::Dispersions> dispersion_fields = {
    AEOLIS_BIND(Dispersions, delivery_flight_path_deg),
    AEOLIS_BIND(Dispersions, delivery_position_m),
    AEOLIS_BIND(Dispersions, knowledge_position_m),
    AEOLIS_BIND(Dispersions, knowledge_velocity_mps),
    AEOLIS_BIND(Dispersions, density_fraction),
    AEOLIS_BIND(Dispersions, drag_fraction),
    AEOLIS_BIND(Dispersions, parachute_drag_fraction),
    AEOLIS_BIND(Dispersions, wind_mps),
    AEOLIS_BIND(Dispersions, imu_bias_mps2),
    AEOLIS_BIND(Dispersions, gyro_bias_rps),
    AEOLIS_BIND(Dispersions, attitude_rad),
    AEOLIS_BIND(Dispersions, radar_range_fraction),
    AEOLIS_BIND(Dispersions, radar_velocity_mps),
    AEOLIS_BIND(Dispersions, imu_misalignment_rad),
    AEOLIS_BIND(Dispersions, gust_mps),
    AEOLIS_BIND(Dispersions, parachute_plane_deg),
    AEOLIS_BIND(Dispersions, radar_dropout_fraction),
    AEOLIS_BIND(Dispersions, terrain_height_m),
    AEOLIS_BIND(Dispersions, terrain_slope_deg),
    AEOLIS_BIND(Dispersions, mass_fraction),
    AEOLIS_BIND(Dispersions, slow_drag_fraction),
    AEOLIS_BIND(Dispersions, imu_scale_fraction),
    AEOLIS_BIND(Dispersions, gyro_scale_fraction),
    AEOLIS_BIND(Dispersions, imu_noise_mps),
    AEOLIS_BIND(Dispersions, gyro_noise_rad),
    AEOLIS_BIND(Dispersions, density_aloft_fraction),
    AEOLIS_BIND(Dispersions, parachute_oscillation_fraction),
    AEOLIS_BIND(Dispersions, radar_sand_mps),
    AEOLIS_BIND(Dispersions, terrain_roughness_m),
};
const Bindings<simulation::Limits> limit_fields = {
    AEOLIS_BIND(Limits, propellant_left_min_kg),
    AEOLIS_BIND(Limits, touchdown_vertical_max_mps),
    AEOLIS_BIND(Limits, touchdown_horizontal_max_mps),
    AEOLIS_BIND(Limits, touchdown_tilt_max_deg),
    AEOLIS_BIND(Limits, recontact_min_m),
    AEOLIS_BIND(Limits, parachute_mach_max),
    AEOLIS_BIND(Limits, parachute_pressure_max_Pa),
    AEOLIS_BIND(Limits, timeline_margin_min_s),
    AEOLIS_BIND(Limits, campaign_within_min_fraction),
};
const Bindings<simulation::Radio> radio_fields = {
    AEOLIS_BIND(Radio, light_time_s),
    AEOLIS_BIND(Radio, uhf_rate_bps),
    AEOLIS_BIND(Radio, blackout_start_speed_mps),
    AEOLIS_BIND(Radio, blackout_end_speed_mps),
    AEOLIS_BIND(Radio, blackout_start_altitude_m),
    AEOLIS_BIND(Radio, uhf_loss_fraction),
    AEOLIS_BIND(Radio, uhf_burst_s),
    AEOLIS_BIND(Radio, uplink_loss_fraction),
    AEOLIS_BIND(Radio, x_band_c_n0_dbhz),
    AEOLIS_BIND(Radio, relay_rate_bps),
    AEOLIS_BIND(Radio, relay_start_after_touchdown_s),
    AEOLIS_BIND(Radio, uhf_loss_range_km),
    AEOLIS_BIND(Radio, uhf_hand_over_s),
};
const Bindings<Scenario> scenario_fields = {
    AEOLIS_BIND(Scenario, start_before_entry_s),       AEOLIS_BIND(Scenario, end_after_touchdown_s),
    AEOLIS_BIND(Scenario, timeout_after_entry_s),      AEOLIS_BIND(Scenario, parachute_drag_area_m2),
    AEOLIS_BIND(Scenario, steady_wind_east_mps),       AEOLIS_BIND(Scenario, steady_wind_north_mps),
    AEOLIS_BIND(Scenario, bus_message_error_fraction), AEOLIS_BIND(Scenario, parachute_lift_to_drag),
    AEOLIS_BIND(Scenario, wrist_damping_Nms),
};
const Bindings<Scenario> trigger_fields = {
    AEOLIS_BIND(Scenario, parachute_speed_mps),
    AEOLIS_BIND(Scenario, heatshield_speed_mps),
    AEOLIS_BIND(Scenario, backshell_altitude_m),
};
const Bindings<simulation::AirRow> air_fields = {
    AEOLIS_BIND(AirRow, altitude_m),
    AEOLIS_BIND(AirRow, temperature_K),
    AEOLIS_BIND(AirRow, density_kgm3),
};
const Bindings<simulation::WindRow> wind_fields = {
    AEOLIS_BIND(WindRow, altitude_m),
    AEOLIS_BIND(WindRow, east_mps),
    AEOLIS_BIND(WindRow, north_mps),
};
const Bindings<simulation::DensityScale> density_fields = {
    AEOLIS_BIND(DensityScale, altitude_m),
    AEOLIS_BIND(DensityScale, scale),
    AEOLIS_BIND(DensityScale, deviation),
};
const Bindings<simulation::SystemFault> fault_fields = {
    AEOLIS_BIND(SystemFault, begin_before_entry_s),
    AEOLIS_BIND(SystemFault, duration_s),
};
const Bindings<simulation::StationOutage> outage_fields = {
    AEOLIS_BIND(StationOutage, begin_before_entry_s),
    AEOLIS_BIND(StationOutage, duration_s),
};
const Bindings<simulation::OrbiterOutage> orbiter_outage_fields = {
    AEOLIS_BIND(OrbiterOutage, begin_before_entry_s),
    AEOLIS_BIND(OrbiterOutage, duration_s),
};
const Bindings<simulation::UhfLoss> uhf_loss_fields = {
    AEOLIS_BIND(UhfLoss, begin_before_entry_s),
    AEOLIS_BIND(UhfLoss, duration_s),
    AEOLIS_BIND(UhfLoss, fraction),
};
const Bindings<simulation::WindShift> wind_shift_fields = {
    AEOLIS_BIND(WindShift, begin_before_entry_s),
    AEOLIS_BIND(WindShift, duration_s),
    AEOLIS_BIND(WindShift, east_mps),
    AEOLIS_BIND(WindShift, north_mps),
};
const Bindings<simulation::AirShift> air_shift_fields = {
    AEOLIS_BIND(AirShift, begin_before_entry_s),
    AEOLIS_BIND(AirShift, duration_s),
    AEOLIS_BIND(AirShift, fraction),
};
const Bindings<simulation::SensorError> sensor_error_fields = {
    AEOLIS_BIND(SensorError, begin_before_entry_s),
    AEOLIS_BIND(SensorError, duration_s),
    AEOLIS_BIND(SensorError, off_by),
    AEOLIS_BIND(SensorError, grows_per_s),
};
const Bindings<simulation::DeviceFault> device_fault_fields = {
    AEOLIS_BIND(DeviceFault, begin_before_entry_s),
    AEOLIS_BIND(DeviceFault, duration_s),
    AEOLIS_BIND(DeviceFault, late_s),
};
const Bindings<simulation::RelayPass> pass_fields = {
    AEOLIS_BIND(RelayPass, rise_after_entry_s),   AEOLIS_BIND(RelayPass, set_after_entry_s),
    AEOLIS_BIND(RelayPass, horizon_km),           AEOLIS_BIND(RelayPass, nearest_km),
    AEOLIS_BIND(RelayPass, delivery_after_set_s), AEOLIS_BIND(RelayPass, delivery_rate_bps),
};
const Bindings<simulation::TrackingPass> tracking_fields = {
    AEOLIS_BIND(TrackingPass, begin_after_entry_s),
    AEOLIS_BIND(TrackingPass, end_after_entry_s),
};
const Bindings<simulation::FalseTone> false_tone_fields = {
    AEOLIS_BIND(FalseTone, begin_before_entry_s),
    AEOLIS_BIND(FalseTone, duration_s),
};
const Bindings<simulation::ComputerReset> reset_fields = {
    AEOLIS_BIND(ComputerReset, before_entry_s),
};
#undef AEOLIS_BIND

const google::protobuf::FieldDescriptor& field_of(const Message& message, const char* name) {
    const auto* field = message.GetDescriptor()->FindFieldByName(name);
    AEOLIS_CHECK(field != nullptr);
    return *field;
}

template <typename Struct>
void read(const Message& message, const Bindings<Struct>& bindings, Struct& into) {
    for (const auto& bound : bindings) {
        const auto& field = field_of(message, bound.field);
        if (!field.has_presence() || message.GetReflection()->HasField(message, &field))
            into.*bound.member = message.GetReflection()->GetDouble(message, &field);
    }
}

template <typename Struct>
void write(const Struct& from, const Bindings<Struct>& bindings, Message& message) {
    for (const auto& bound : bindings)
        message.GetReflection()->SetDouble(&message, &field_of(message, bound.field), from.*bound.member);
}

/// Collects every non-finite number, also in repeated and nested fields: text format accepts "nan" and "inf".
void collect_not_finite(const Message& message, const std::string& prefix, std::vector<std::string>& lines) {
    const auto& reflection = *message.GetReflection();
    std::vector<const google::protobuf::FieldDescriptor*> fields;
    reflection.ListFields(message, &fields);
    for (const auto* field : fields) {
        const std::string name = prefix + field->name();
        const int count = field->is_repeated() ? reflection.FieldSize(message, field) : 1;
        for (int i = 0; i < count; ++i) {
            const std::string where = field->is_repeated() ? fmt::format("{}[{}]", name, i) : name;
            if (field->cpp_type() == google::protobuf::FieldDescriptor::CPPTYPE_DOUBLE) {
                const double value = field->is_repeated() ? reflection.GetRepeatedDouble(message, field, i)
                                                          : reflection.GetDouble(message, field);
                if (!std::isfinite(value)) lines.push_back(fmt::format("{}: {} is not a finite number", where, value));
            } else if (field->cpp_type() == google::protobuf::FieldDescriptor::CPPTYPE_MESSAGE) {
                collect_not_finite(field->is_repeated() ? reflection.GetRepeatedMessage(message, field, i)
                                                        : reflection.GetMessage(message, field),
                                   where + ".", lines);
            }
        }
    }
}

std::string joined(const std::vector<std::string>& lines, const std::string& prefix) {
    std::string text;
    for (const auto& line : lines) text += (text.empty() ? "" : "\n") + prefix + line;
    return text;
}

class Faults : public google::protobuf::io::ErrorCollector {
  public:
    explicit Faults(std::string file) : file_(std::move(file)) {}
    void AddError(int line, google::protobuf::io::ColumnNumber column, const std::string& message) override {
        lines_.push_back(fmt::format("{}:{}:{}: {}", file_, line + 1, column + 1, message));
    }
    std::string text() const { return joined(lines_, ""); }

  private:
    std::string file_;
    std::vector<std::string> lines_;
};

std::string utc_text(Scet scet) {
    using namespace std::chrono;
    const sys_time<microseconds> time{sys_days{year{2000} / January / 1} + hours{12} + microseconds{scet.microseconds}};
    const auto day = floor<days>(time);
    const year_month_day date{day};
    const hh_mm_ss clock{time - day};
    return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:06}", static_cast<int>(date.year()),
                       static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()), clock.hours().count(),
                       clock.minutes().count(), clock.seconds().count(), clock.subseconds().count());
}

/// Converts an enumeration: the schema's values start at one after "unspecified", the structs' at zero.
template <typename Enumeration>
Result<Enumeration> named(int number, bool known, const std::string& field) {
    if (number == 0) return Error{field + ": missing"};
    if (!known) return Error{fmt::format("{}: {} is not one of its values", field, number)};
    return static_cast<Enumeration>(number - 1);
}

Result<simulation::DeviceFault> device_fault_from_message(const v1::DeviceFault& row, const std::string& name) {
    const auto device = named<flight::Device>(row.device(), v1::Device_IsValid(row.device()), name + ".device");
    if (!device) return device.error();
    const auto unit = named<flight::Unit>(row.unit(), v1::RedundantUnit_IsValid(row.unit()), name + ".unit");
    if (!unit) return unit.error();
    const auto kind =
        named<simulation::DeviceFault::Kind>(row.kind(), v1::DeviceFaultKind_IsValid(row.kind()), name + ".kind");
    if (!kind) return kind.error();
    simulation::DeviceFault fault;
    fault.device = *device;
    fault.unit = *unit;
    fault.kind = *kind;
    read(row, device_fault_fields, fault);
    return fault;
}

Result<simulation::SensorError> sensor_error_from_message(const v1::SensorError& row, const std::string& name) {
    const auto device = named<flight::Device>(row.device(), v1::Device_IsValid(row.device()), name + ".device");
    if (!device) return device.error();
    const auto unit = named<flight::Unit>(row.unit(), v1::RedundantUnit_IsValid(row.unit()), name + ".unit");
    if (!unit) return unit.error();
    simulation::SensorError error;
    error.device = *device;
    error.unit = *unit;
    read(row, sensor_error_fields, error);
    return error;
}

void write_sensor_error(const simulation::SensorError& error, v1::SensorError& row) {
    row.set_device(static_cast<v1::Device>(static_cast<int>(error.device) + 1));
    row.set_unit(static_cast<v1::RedundantUnit>(static_cast<int>(error.unit) + 1));
    write(error, sensor_error_fields, row);
}

Result<simulation::FalseTone> false_tone_from_message(const v1::FalseTone& row, const std::string& name) {
    if (row.tone() > std::numeric_limits<std::uint8_t>::max())
        return Error{fmt::format("{}.tone: {} is no id of a tone", name, row.tone())};
    simulation::FalseTone tone;
    read(row, false_tone_fields, tone);
    tone.tone = ToneId{static_cast<std::uint8_t>(row.tone())};
    return tone;
}

/// What begins with the next cycle and lasts. `read_row` makes the struct of the message, or says what is wrong.
template <typename Message, typename ReadRow>
Result<simulation::Fault> begun_now(const Message& message, const char* name, const ReadRow& read_row) {
    if (message.begin_before_entry_s() != 0.0)
        return Error{fmt::format("{}.begin_before_entry_s: it begins now", name)};
    auto row = read_row(message, name);
    if (!row) return row.error();
    return simulation::Fault{*row};
}
template <typename Spell, typename Message>
Result<simulation::Fault> spell_now(const Message& message, const Bindings<Spell>& fields, const char* name) {
    return begun_now(message, name, [&](const Message& row, const char*) {
        Spell spell;
        read(row, fields, spell);
        return Result<Spell>{spell};
    });
}

Result<simulation::Fault> read_fault(const v1::FaultInjection& message) {
    switch (message.fault_case()) {
    case v1::FaultInjection::kDeviceFault:
        return begun_now(message.device_fault(), "device_fault", device_fault_from_message);
    case v1::FaultInjection::kSystemFault: return spell_now(message.system_fault(), fault_fields, "system_fault");
    case v1::FaultInjection::kComputerReset:
        if (!message.computer_reset()) return Error{"computer_reset: false asks for nothing"};
        return simulation::Fault{simulation::ComputerReset{}};
    case v1::FaultInjection::kStationOutage:
        return spell_now(message.station_outage(), outage_fields, "station_outage");
    case v1::FaultInjection::kOrbiterOutage:
        return spell_now(message.orbiter_outage(), orbiter_outage_fields, "orbiter_outage");
    case v1::FaultInjection::kUhfLoss: return spell_now(message.uhf_loss(), uhf_loss_fields, "uhf_loss");
    case v1::FaultInjection::kWindShift: return spell_now(message.wind_shift(), wind_shift_fields, "wind_shift");
    case v1::FaultInjection::kAirShift: return spell_now(message.air_shift(), air_shift_fields, "air_shift");
    case v1::FaultInjection::kSensorError:
        return begun_now(message.sensor_error(), "sensor_error", sensor_error_from_message);
    case v1::FaultInjection::kFalseTone: return begun_now(message.false_tone(), "false_tone", false_tone_from_message);
    case v1::FaultInjection::FAULT_NOT_SET: break;
    }
    return Error{"the injection says nothing: device_fault, system_fault, computer_reset, station_outage, "
                 "orbiter_outage, uhf_loss, wind_shift, air_shift, sensor_error or false_tone is wanted"};
}

void write_device_fault(const simulation::DeviceFault& fault, v1::DeviceFault& row) {
    row.set_device(static_cast<v1::Device>(static_cast<int>(fault.device) + 1));
    row.set_unit(static_cast<v1::RedundantUnit>(static_cast<int>(fault.unit) + 1));
    row.set_kind(static_cast<v1::DeviceFaultKind>(static_cast<int>(fault.kind) + 1));
    write(fault, device_fault_fields, row);
}

void read_links(const v1::Radio& message, simulation::Radio& radio) {
    read(message, radio_fields, radio);
    if (message.has_earth_set_after_entry_s()) radio.earth_set_after_entry_s = message.earth_set_after_entry_s();
    if (message.has_tones_from_samples()) radio.tones_from_samples = message.tones_from_samples();
    for (const auto& row : message.relay_passes()) {
        auto& pass = radio.relay_passes.emplace_back();
        read(row, pass_fields, pass);
        pass.orbiter = row.orbiter();
        pass.stored = row.stored();
        for (const auto& rate : row.rates()) pass.rates.push_back({rate.after_rise_s(), rate.bps()});
    }
    for (const auto& row : message.tracking_passes()) {
        auto& pass = radio.tracking_passes.emplace_back();
        read(row, tracking_fields, pass);
        pass.station = row.station();
    }
    for (const auto& row : message.tone_outages())
        radio.tone_outages.push_back({row.name(), row.event(), row.from_s(), row.to_s()});
    radio.delivery_restarts_after_touchdown_s.assign(message.delivery_restarts_after_touchdown_s().begin(),
                                                     message.delivery_restarts_after_touchdown_s().end());
}

void write_links(const simulation::Radio& radio, v1::Radio& message) {
    write(radio, radio_fields, message);
    if (radio.earth_set_after_entry_s) message.set_earth_set_after_entry_s(*radio.earth_set_after_entry_s);
    if (radio.tones_from_samples) message.set_tones_from_samples(*radio.tones_from_samples);
    for (const auto& pass : radio.relay_passes) {
        auto& row = *message.add_relay_passes();
        write(pass, pass_fields, row);
        row.set_orbiter(pass.orbiter);
        row.set_stored(pass.stored);
        for (const auto& rate : pass.rates) {
            auto& step = *row.add_rates();
            step.set_after_rise_s(rate.after_rise_s);
            step.set_bps(rate.bps);
        }
    }
    for (const auto& pass : radio.tracking_passes) {
        auto& row = *message.add_tracking_passes();
        write(pass, tracking_fields, row);
        row.set_station(pass.station);
    }
    for (const auto& outage : radio.tone_outages) {
        auto& row = *message.add_tone_outages();
        row.set_name(outage.name);
        row.set_event(outage.event);
        row.set_from_s(outage.from_s);
        row.set_to_s(outage.to_s);
    }
    for (const double restart : radio.delivery_restarts_after_touchdown_s)
        message.add_delivery_restarts_after_touchdown_s(restart);
}

/// What is believed begins as the truth.
simulation::Belief belief_of(const v1::Belief& message, const Scenario& truth) {
    simulation::Belief belief{truth.masses,
                              truth.density_scale,
                              truth.aero_scale,
                              truth.parachute_drag_area_m2,
                              truth.steady_wind_east_mps,
                              truth.steady_wind_north_mps};
    belief.air = truth.air;
    belief.winds = truth.winds;
    if (message.air_size() > 0) belief.air.clear(), belief.density_scale.clear();  // it scaled the other air
    for (const auto& row : message.air()) read(row, air_fields, belief.air.emplace_back());
    if (message.winds_size() > 0) belief.winds.clear();
    for (const auto& row : message.winds()) read(row, wind_fields, belief.winds.emplace_back());
    read(message.masses(), mass_fields, belief.masses);
    if (message.density_scale_size() > 0) belief.density_scale.clear();
    for (const auto& row : message.density_scale()) read(row, density_fields, belief.density_scale.emplace_back());
    if (message.aero_scale_size() > 0) belief.aero_scale.clear();
    for (const auto& row : message.aero_scale()) read(row, aero_fields, belief.aero_scale.emplace_back());
    read(message, belief_fields, belief);
    return belief;
}

/// Whoever is not in a folder cannot name a file beside it. Of a Scenario, or a Belief.
template <typename OfAir>
Result<void> refuse_table_names(const OfAir& message) {
    if (!message.air_table().empty()) return Error{"air_table: only a file can name another"};
    if (!message.wind_table().empty()) return Error{"wind_table: only a file can name another"};
    if (message.air_table_landing_m() != 0.0) return Error{"air_table_landing_m: only a file can name a table"};
    return {};
}

void write_belief(const simulation::Belief& belief, v1::Belief& message) {
    write(belief.masses, mass_fields, *message.mutable_masses());
    for (const auto& row : belief.density_scale) write(row, density_fields, *message.add_density_scale());
    for (const auto& row : belief.aero_scale) write(row, aero_fields, *message.add_aero_scale());
    for (const auto& row : belief.air) write(row, air_fields, *message.add_air());
    for (const auto& row : belief.winds) write(row, wind_fields, *message.add_winds());
    write(belief, belief_fields, message);
}

}  // namespace

Result<Scenario> scenario_from_message(const v1::Scenario& message) {
    std::vector<std::string> faults;
    collect_not_finite(message, "", faults);
    if (!faults.empty()) return Error{joined(faults, "")};
    if (message.name().empty()) return Error{"name: missing"};
    if (!message.like().empty()) return Error{"like: only a file can be like another"};
    if (const auto refused = refuse_table_names(message); !refused) return refused.error();
    if (const auto refused = refuse_table_names(message.believed()); !refused)
        return Error{"believed." + refused.error().message};
    if (const auto& ground = message.ground(); !ground.grid_file().empty() || ground.grid_target_x_m() != 0.0 ||
                                               ground.grid_target_y_m() != 0.0 || ground.grid_landing_m() != 0.0)
        return Error{"ground.grid_file: only a file can name another, and say where the target lies in it"};
    if (message.entry_scet().empty()) return Error{"entry_scet: missing"};
    const auto entry_scet = scet_from_text(message.entry_scet());
    if (!entry_scet)
        return Error{fmt::format("entry_scet: '{}' is not a UTC time like 2012-08-06T05:10:47.4 or 2012-219T05:10:47.4",
                                 message.entry_scet())};

    Scenario scenario;
    scenario.name = message.name();
    scenario.title = message.title();
    scenario.entry_scet = *entry_scet;
    if (message.has_entry_sclk()) scenario.entry_sclk = Sclk{message.entry_sclk()};
    if (!is_multiple_of_tick(scenario.entry_sclk.seconds))
        return Error{fmt::format("entry_sclk: {} is not a multiple of 1/64 s", scenario.entry_sclk.seconds)};
    read(message, scenario_fields, scenario);
    if (message.has_disperse_before_entry_s()) scenario.disperse_before_entry_s = message.disperse_before_entry_s();
    read(message.entry(), entry_fields, scenario.entry);
    read(message.target(), target_fields, scenario.target);
    read(message.ground(), ground_fields, scenario.ground);
    if (!message.ground().grid().empty()) {
        auto grid = height_grid_from_text(message.ground().grid());
        if (!grid) return Error{"ground.grid: " + grid.error().message};
        scenario.ground.grid = std::make_shared<const simulation::HeightGrid>(std::move(grid).value());
    }
    read(message.masses(), mass_fields, scenario.masses);
    read(message.gyration(), gyration_fields, scenario.gyration);
    read(message.stations(), station_fields, scenario.stations);
    read(message.dispersions(), dispersion_fields, scenario.dispersions);
    read(message.limits(), limit_fields, scenario.limits);
    read_links(message.radio(), scenario.radio);
    read(message.triggers(), trigger_fields, scenario);
    read(message.engines(), engine_fields, scenario.engines);
    read(message.guidance(), guidance_fields, scenario.guidance);
    const auto parameters = parameters_of(message);
    if (!parameters) return parameters.error();
    scenario.parameters = *parameters;
    for (const auto& row : message.density_scale()) read(row, density_fields, scenario.density_scale.emplace_back());
    for (const auto& row : message.aero_scale()) read(row, aero_fields, scenario.aero_scale.emplace_back());
    for (const auto& row : message.air()) read(row, air_fields, scenario.air.emplace_back());
    for (const auto& row : message.winds()) read(row, wind_fields, scenario.winds.emplace_back());
    if (message.has_believed()) scenario.believed = belief_of(message.believed(), scenario);
    if (message.has_ground_flight()) scenario.ground_flight = message.ground_flight();
    if (message.test_venue() != v1::TEST_VENUE_UNSPECIFIED) {
        const auto venue = named<simulation::TestVenue>(message.test_venue(),
                                                        v1::TestVenue_IsValid(message.test_venue()), "test_venue");
        if (!venue) return venue.error();
        scenario.test_venue = *venue;
    }
    if (message.telemetry_plan() == v1::TELEMETRY_PLAN_WIDEBAND) scenario.telemetry_plan = flight::Plan::wideband;
    scenario.second_person.assign(message.second_person().begin(), message.second_person().end());
    for (const auto& row : message.commands()) {
        simulation::ScriptedCommand command;
        command.send_before_entry_s = row.send_before_entry_s();
        command.command = row.command();
        command.from_solution = row.from_solution();
        for (const auto& argument : row.arguments()) command.arguments.emplace_back(argument.name(), argument.value());
        scenario.commands.push_back(std::move(command));
    }
    for (const auto& row : message.system_faults()) read(row, fault_fields, scenario.system_faults.emplace_back());
    for (int i = 0; i < message.device_faults_size(); ++i) {
        auto fault = device_fault_from_message(message.device_faults(i), fmt::format("device_faults[{}]", i));
        if (!fault) return fault.error();
        scenario.device_faults.push_back(*fault);
    }
    for (const auto& row : message.computer_resets()) read(row, reset_fields, scenario.computer_resets.emplace_back());
    for (const auto& row : message.station_outages()) read(row, outage_fields, scenario.station_outages.emplace_back());
    for (const auto& row : message.orbiter_outages())
        read(row, orbiter_outage_fields, scenario.orbiter_outages.emplace_back());
    for (const auto& row : message.uhf_losses()) read(row, uhf_loss_fields, scenario.uhf_losses.emplace_back());
    for (const auto& row : message.wind_shifts()) read(row, wind_shift_fields, scenario.wind_shifts.emplace_back());
    for (const auto& row : message.air_shifts()) read(row, air_shift_fields, scenario.air_shifts.emplace_back());
    for (int i = 0; i < message.sensor_errors_size(); ++i) {
        const auto error = sensor_error_from_message(message.sensor_errors(i), fmt::format("sensor_errors[{}]", i));
        if (!error) return error.error();
        scenario.sensor_errors.push_back(*error);
    }
    for (int i = 0; i < message.false_tones_size(); ++i) {
        const auto tone = false_tone_from_message(message.false_tones(i), fmt::format("false_tones[{}]", i));
        if (!tone) return tone.error();
        scenario.false_tones.push_back(*tone);
    }
    const auto impossible = simulation::impossible_values(scenario);
    if (!impossible.empty()) return Error{joined(impossible, "")};
    return scenario;
}

Result<simulation::Fault> fault_from_message(const v1::FaultInjection& message, const simulation::Scenario& scenario) {
    auto fault = read_fault(message);
    if (!fault) return fault;
    auto with_it_alone = scenario;
    with_it_alone.system_faults.clear();
    with_it_alone.device_faults.clear();
    with_it_alone.computer_resets.clear();
    with_it_alone.station_outages.clear();
    with_it_alone.orbiter_outages.clear();
    with_it_alone.uhf_losses.clear();
    with_it_alone.wind_shifts.clear();
    with_it_alone.air_shifts.clear();
    with_it_alone.sensor_errors.clear();
    with_it_alone.false_tones.clear();
    if (const auto* device = std::get_if<simulation::DeviceFault>(&*fault)) with_it_alone.device_faults = {*device};
    if (const auto* system = std::get_if<simulation::SystemFault>(&*fault)) with_it_alone.system_faults = {*system};
    if (const auto* reset = std::get_if<simulation::ComputerReset>(&*fault)) with_it_alone.computer_resets = {*reset};
    if (const auto* outage = std::get_if<simulation::StationOutage>(&*fault)) with_it_alone.station_outages = {*outage};
    if (const auto* orbiter = std::get_if<simulation::OrbiterOutage>(&*fault))
        with_it_alone.orbiter_outages = {*orbiter};
    if (const auto* loss = std::get_if<simulation::UhfLoss>(&*fault)) with_it_alone.uhf_losses = {*loss};
    if (const auto* shift = std::get_if<simulation::WindShift>(&*fault)) with_it_alone.wind_shifts = {*shift};
    if (const auto* air = std::get_if<simulation::AirShift>(&*fault)) with_it_alone.air_shifts = {*air};
    if (const auto* sensor = std::get_if<simulation::SensorError>(&*fault)) with_it_alone.sensor_errors = {*sensor};
    if (const auto* tone = std::get_if<simulation::FalseTone>(&*fault)) with_it_alone.false_tones = {*tone};
    if (const auto found = simulation::impossible_values(with_it_alone); !found.empty()) return Error{found.front()};
    return fault;
}

v1::Scenario scenario_to_message(const Scenario& scenario) {
    v1::Scenario message;
    message.set_name(scenario.name);
    message.set_title(scenario.title);
    message.set_entry_scet(utc_text(scenario.entry_scet));
    message.set_entry_sclk(scenario.entry_sclk.seconds);
    write(scenario, scenario_fields, message);
    message.set_disperse_before_entry_s(scenario.disperse_before_entry_s.value_or(scenario.start_before_entry_s));
    write(scenario.entry, entry_fields, *message.mutable_entry());
    write(scenario.target, target_fields, *message.mutable_target());
    write(scenario.ground, ground_fields, *message.mutable_ground());
    if (scenario.ground.grid) message.mutable_ground()->set_grid(grid_text(*scenario.ground.grid));
    write(scenario.masses, mass_fields, *message.mutable_masses());
    write(scenario.gyration, gyration_fields, *message.mutable_gyration());
    write(scenario.stations, station_fields, *message.mutable_stations());
    write(scenario.dispersions, dispersion_fields, *message.mutable_dispersions());
    write(scenario.limits, limit_fields, *message.mutable_limits());
    write_links(scenario.radio, *message.mutable_radio());
    write(scenario, trigger_fields, *message.mutable_triggers());
    for (const auto& scale : scenario.density_scale) write(scale, density_fields, *message.add_density_scale());
    write(scenario.engines, engine_fields, *message.mutable_engines());
    write(scenario.guidance, guidance_fields, *message.mutable_guidance());
    write_parameters(scenario.parameters, message);
    for (const auto& row : scenario.aero_scale) write(row, aero_fields, *message.add_aero_scale());
    if (scenario.believed) write_belief(*scenario.believed, *message.mutable_believed());
    for (const auto& row : scenario.air) write(row, air_fields, *message.add_air());
    for (const auto& row : scenario.winds) write(row, wind_fields, *message.add_winds());
    if (scenario.ground_flight) message.set_ground_flight(*scenario.ground_flight);
    message.set_test_venue(static_cast<v1::TestVenue>(static_cast<int>(scenario.test_venue) + 1));
    message.set_telemetry_plan(scenario.telemetry_plan == flight::Plan::wideband ? v1::TELEMETRY_PLAN_WIDEBAND
                                                                                 : v1::TELEMETRY_PLAN_MISSION);
    for (const auto& name : scenario.second_person) message.add_second_person(name);
    for (const auto& command : scenario.commands) {
        auto& row = *message.add_commands();
        row.set_send_before_entry_s(command.send_before_entry_s);
        row.set_command(command.command);
        row.set_from_solution(command.from_solution);
        for (const auto& [name, value] : command.arguments) {
            auto& argument = *row.add_arguments();
            argument.set_name(name);
            argument.set_value(value);
        }
    }
    for (const auto& fault : scenario.system_faults) write(fault, fault_fields, *message.add_system_faults());
    for (const auto& fault : scenario.device_faults) write_device_fault(fault, *message.add_device_faults());
    for (const auto& reset : scenario.computer_resets) write(reset, reset_fields, *message.add_computer_resets());
    for (const auto& outage : scenario.station_outages) write(outage, outage_fields, *message.add_station_outages());
    for (const auto& outage : scenario.orbiter_outages)
        write(outage, orbiter_outage_fields, *message.add_orbiter_outages());
    for (const auto& loss : scenario.uhf_losses) write(loss, uhf_loss_fields, *message.add_uhf_losses());
    for (const auto& shift : scenario.wind_shifts) write(shift, wind_shift_fields, *message.add_wind_shifts());
    for (const auto& shift : scenario.air_shifts) write(shift, air_shift_fields, *message.add_air_shifts());
    for (const auto& error : scenario.sensor_errors) write_sensor_error(error, *message.add_sensor_errors());
    for (const auto& tone : scenario.false_tones) {
        auto& row = *message.add_false_tones();
        write(tone, false_tone_fields, row);
        row.set_tone(tone.tone.value);
    }
    return message;
}

std::string scenario_to_text(const Scenario& scenario) {
    std::string text;
    google::protobuf::TextFormat::PrintToString(scenario_to_message(scenario), &text);
    return text;
}

namespace {

Result<v1::Scenario> parsed(std::string_view text, const std::string& file) {
    v1::Scenario message;
    Faults faults{file};
    google::protobuf::TextFormat::Parser parser;
    parser.RecordErrorsTo(&faults);
    if (!parser.ParseFromString(std::string{text}, &message)) return Error{faults.text()};
    return message;
}

/// Converts and checks; each line of an Error begins with the file name.
Result<Scenario> checked(const v1::Scenario& message, const std::string& file) {
    auto scenario = scenario_from_message(message);
    if (scenario) return scenario;
    std::istringstream lines{scenario.error().message};
    std::vector<std::string> faulty;
    for (std::string line; std::getline(lines, line);) faulty.push_back(line);
    return Error{joined(faulty, file + ": ")};
}

/// Clears the base's lists that the file has too, at any depth: a file's list replaces that of its base.
void clear_lists_of(const Message& message, Message& base) {
    const auto& reflection = *message.GetReflection();
    std::vector<const google::protobuf::FieldDescriptor*> fields;
    reflection.ListFields(message, &fields);
    for (const auto* field : fields) {
        if (field->is_repeated())
            base.GetReflection()->ClearField(&base, field);
        else if (field->cpp_type() == google::protobuf::FieldDescriptor::CPPTYPE_MESSAGE &&
                 base.GetReflection()->HasField(base, field))
            clear_lists_of(reflection.GetMessage(message, field), *base.GetReflection()->MutableMessage(&base, field));
    }
}

/// Replaces the name of a grid by its heights.
Result<void> fill_grid(v1::Ground& ground, const std::filesystem::path& folder) {
    const GridDatum datum{ground.grid_target_x_m(), ground.grid_target_y_m(), ground.grid_landing_m()};
    for (const auto& [field, value] : {std::pair{"grid_target_x_m", datum.target_x_m},
                                       {"grid_target_y_m", datum.target_y_m},
                                       {"grid_landing_m", datum.landing_m}})
        if (!std::isfinite(value)) return Error{fmt::format("ground.{}: {} is not a finite number", field, value)};
    ground.clear_grid_target_x_m();
    ground.clear_grid_target_y_m();
    ground.clear_grid_landing_m();
    const std::string name = std::exchange(*ground.mutable_grid_file(), {});
    if (name.empty()) {
        if (datum.target_x_m != 0.0 || datum.target_y_m != 0.0 || datum.landing_m != 0.0)
            return Error{"ground.grid_file: missing, and something is said of its coordinates"};
        return {};
    }
    if (!ground.grid().empty()) return Error{"ground.grid_file: the scenario has a grid of its own"};
    const auto grid = height_grid_from_file(folder / name, datum);
    if (!grid) return Error{"ground.grid_file: " + grid.error().message};
    ground.set_grid(grid_text(*grid));
    return {};
}

/// Replaces the names of tables by their rows. Of a Scenario, or a Belief.
template <typename OfAir>
Result<void> fill_tables(OfAir& message, const std::filesystem::path& folder) {
    if (const std::string name = std::exchange(*message.mutable_air_table(), {}); !name.empty()) {
        if (message.air_size() > 0) return Error{"air_table: the scenario has air of its own"};
        const auto table = air_table_from_file(folder / name, message.air_table_landing_m());
        if (!table) return Error{"air_table: " + table.error().message};
        for (const auto& row : table->air) write(row, air_fields, *message.add_air());
        if (message.density_scale_size() > 0 && !table->scale.empty())
            return Error{"air_table: the scenario has a density_scale of its own, and the table has another"};
        for (const auto& row : table->scale) write(row, density_fields, *message.add_density_scale());
        if (message.winds_size() == 0 && message.wind_table().empty())
            for (const auto& row : table->winds) write(row, wind_fields, *message.add_winds());
    } else if (message.air_table_landing_m() != 0.0) {
        return Error{"air_table_landing_m: there is no air_table"};
    }
    message.clear_air_table_landing_m();
    if (const std::string name = std::exchange(*message.mutable_wind_table(), {}); !name.empty()) {
        if (message.winds_size() > 0) return Error{"wind_table: the scenario has winds of its own"};
        const auto winds = wind_table_from_file(folder / name);
        if (!winds) return Error{"wind_table: " + winds.error().message};
        for (const auto& row : *winds) write(row, wind_fields, *message.add_winds());
    }
    return {};
}

/// Replaces the names of files by what they hold.
Result<void> fill_files(v1::Scenario& message, const std::filesystem::path& folder) {
    if (const auto filled = fill_tables(message, folder); !filled) return filled;
    if (message.has_believed())
        if (const auto filled = fill_tables(*message.mutable_believed(), folder); !filled)
            return Error{"believed." + filled.error().message};
    if (message.has_ground()) return fill_grid(*message.mutable_ground(), folder);
    return {};
}

/// The message with its base merged in, recursively; `further` bases are allowed.
Result<v1::Scenario> whole(const std::filesystem::path& file, const std::filesystem::path& shipped, int further) {
    const auto text = bounded_text(file, scenario_octets_max, "scenario");
    if (!text) return text.error();
    auto message = parsed(*text, file.string());
    if (!message) return message;
    if (const auto filled = fill_files(*message, file.parent_path()); !filled)
        return Error{fmt::format("{}: {}", file.string(), filled.error().message)};
    if (message->like().empty()) return message;

    const std::string like = std::exchange(*message->mutable_like(), {});
    const auto refused = [&](const std::string& why) { return Error{fmt::format("{}: like: {}", file.string(), why)}; };
    if (like.find('/') != std::string::npos) return refused('\'' + like + "' is a path, not a scenario beside it");
    if (further == 0) return refused("too many are like one another: is it a circle?");
    // Beside it, else among those that ship.
    std::filesystem::path other = file.parent_path() / (like + file.extension().string());
    std::error_code ignored;
    if (!shipped.empty() && !std::filesystem::exists(other, ignored)) other = shipped / (like + shipped_extension);
    auto base = whole(other, shipped, further - 1);
    if (!base) return refused(base.error().message);
    if (message->has_target() && !base->ground().grid().empty() && message->ground().grid().empty())
        return Error{fmt::format("{}: target: the grid of the ground of '{}' lies about another target: name its "
                                 "grid_file again",
                                 file.string(), like)};
    base->clear_name();  // the name is not inherited
    clear_lists_of(*message, *base);
    if (message->air_size() > 0) base->clear_density_scale();  // it belongs to the other's air
    const bool believes_other_air =
        message->believed().air_size() > 0 || (message->air_size() > 0 && base->believed().air_size() == 0);
    if (believes_other_air && base->has_believed()) base->mutable_believed()->clear_density_scale();
    base->MergeFrom(*message);
    return base;
}

}  // namespace

Result<Scenario> scenario_from_text(std::string_view text, const std::string& file) {
    const auto message = parsed(text, file);
    if (!message) return message.error();
    return checked(*message, file);
}

Result<Scenario> scenario_from_file(const std::filesystem::path& file, const std::filesystem::path& shipped) {
    const auto message = whole(file, shipped, like_chain_max);
    if (!message) return message.error();
    return checked(*message, file.string());
}

}  // namespace aeolis::server
