// SPDX-License-Identifier: Apache-2.0
#include "flight/devices/unit_selector.hpp"

namespace aeolis::flight {
namespace {

constexpr std::array told{ModuleId::radar,           ModuleId::imu,       ModuleId::edl,   ModuleId::pyro,
                          ModuleId::descent_engines, ModuleId::thrusters, ModuleId::power, ModuleId::telecom};
constexpr std::int64_t report_period_s = 10;  // chosen: constant values need not be sent often

static_assert(static_cast<Unit>(SelectedUnit::a) == Unit::a && static_cast<Unit>(SelectedUnit::b) == Unit::b);
static_assert(static_cast<Unit>(RedundantUnit::a) == Unit::a && static_cast<Unit>(RedundantUnit::b) == Unit::b);
static_assert(redundant_device_count == 8, "each has its argument below and its channel");

UnitSelection selection_of(const command::EDL_SELECT_UNITS& c) {
    UnitSelection units;
    units[Device::radar] = static_cast<Unit>(c.radar_unit);
    units[Device::imu] = static_cast<Unit>(c.imu_unit);
    units[Device::pyro] = static_cast<Unit>(c.pyro_unit);
    units[Device::descent_engines] = static_cast<Unit>(c.descent_engines_unit);
    units[Device::thrusters] = static_cast<Unit>(c.thrusters_unit);
    units[Device::power] = static_cast<Unit>(c.power_unit);
    units[Device::uhf] = static_cast<Unit>(c.uhf_unit);
    units[Device::x_band] = static_cast<Unit>(c.x_band_unit);
    return units;
}

packet::UnitsHeld held(const UnitSelection& units) {
    const auto unit = [&](Device device) { return static_cast<RedundantUnit>(units[device]); };
    return {.radar_unit = unit(Device::radar),
            .imu_unit = unit(Device::imu),
            .pyro_unit = unit(Device::pyro),
            .descent_engines_unit = unit(Device::descent_engines),
            .thrusters_unit = unit(Device::thrusters),
            .power_unit = unit(Device::power),
            .uhf_unit = unit(Device::uhf),
            .x_band_unit = unit(Device::x_band)};
}

}  // namespace

void UnitSelector::on(const SelectUnitsCommand& command, Outbox& out) {
    CommandOutcome outcome{.tag = command.tag};
    outcome.conditions.push_back(gnc::is(Quantity::edl_enabled, edl_begun_, false));
    if (edl_begun_) {
        outcome.refused = CommandRefusal::wrong_phase;
        return out.send(ModuleId::command_dispatcher, outcome);
    }
    select(selection_of(command.arguments), out);
    out.event(evr::UNITS_SELECTED{});
    out.send(ModuleId::command_dispatcher, outcome);
}

void UnitSelector::on(const EdlBegun&, Outbox&) {
    edl_begun_ = true;
    reports_ = true;
}

void UnitSelector::on(const StandBy& stand_by, Outbox&) {
    reports_ = stand_by.over;
}

void UnitSelector::on(const UnitsSelected& taken_over, Outbox& out) {
    select(taken_over.units, out);
}

void UnitSelector::on(const ClockTick& tick, Outbox& out) {
    if (reports_ && tick.now.ticks() % (report_period_s * 64) == 0) out.record(held(selected_));
}

void UnitSelector::select(const UnitSelection& units, Outbox& out) {
    selected_ = units;
    for (const ModuleId module : told) out.send(module, UnitsSelected{units});
    if (reports_) out.record(held(units));
}

}  // namespace aeolis::flight
