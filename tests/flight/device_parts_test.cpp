// SPDX-License-Identifier: Apache-2.0
#include "flight/devices/device_parts.hpp"

#include "flight/kernel/dispatch.hpp"
#include "flight/timeline/actions.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/outbox.hpp"

#include <cstring>
#include <set>
#include <vector>

namespace flight_device_parts_test {

using namespace aeolis;
using namespace aeolis::flight;

namespace {

using Octets = std::vector<unsigned char>;

std::vector<Octets> octets_of(DeviceOutputs& outputs) {
    std::vector<Octets> parts;
    each_device(outputs, [&](DeviceLine, const auto& part) {
        Octets octets(sizeof part);
        std::memcpy(octets.data(), &part, sizeof part);
        parts.push_back(std::move(octets));
    });
    return parts;
}

template <std::size_t... I>
std::vector<Message> one_of_each(std::index_sequence<I...>) {
    return {Message{std::in_place_index<I>}...};
}

}  // namespace

TEST_CASE("a module writes the devices that it owns and no other, whatever it is told", "[flight][R5]") {
    std::vector<Message> messages = one_of_each(std::make_index_sequence<std::variant_size_v<Message>>{});
    // What makes a manager write differs from the default.
    messages.emplace_back(SetSwitch{SwitchId::radar, true});
    messages.emplace_back(EnableThrusters{true});
    messages.emplace_back(RunEngines{{.ignited = true, .throttle = {0.5}}});
    messages.emplace_back(FireThrusters{{.on_s = {0.01}}});
    messages.emplace_back(ToneRequest{tone::touchdown, Sclk{1000.0}});
    messages.emplace_back(ClockTick{Sclk{1000.0}});
    messages.emplace_back(Tick{Sclk{1000.0}});
    std::set<DeviceLine> written;
    auto state = std::make_unique<ComputerState>(Load{}, Sclk{1000.0});
    test::OutboxRecorder recorder;
    for (std::size_t i = 0; i < module_count; ++i) {
        const auto id = static_cast<ModuleId>(i);
        for (const Message& message : messages) {
            recorder.begin(id, Sclk{1000.0});
            const auto before = octets_of(*recorder.bus);
            (void)with_module(*state, id, [&](auto& module) { return handle(module, message, recorder.out); });
            const auto after = octets_of(*recorder.bus);
            each_device(*recorder.bus, [&, part = std::size_t{0}](DeviceLine device, const auto&) mutable {
                const bool changed = before[part] != after[part];
                ++part;
                if (!changed) return;
                written.insert(device);
                INFO("module " << i << ", message " << message.index() << ", device " << static_cast<unsigned>(device));
                CHECK(owner_of(device) == id);
            });
        }
    }
    CHECK(written.size() >= 6);  // else nothing was tried
}

TEST_CASE("an action commands the manager that owns it and no other", "[flight][R5]") {
    test::OutboxRecorder recorder;
    gnc::Configuration configuration;
    for (const TimepointSpec& row : timeline_specs) {
        if (row.action == nullptr) continue;
        recorder.begin(ModuleId::edl, Sclk{1000.0});
        ActionContext context{recorder.out, configuration};
        context.begin(row);
        INFO(row.name);
        REQUIRE_NOTHROW(row.action(context));
        REQUIRE(row.owner.has_value());
        for (const Envelope& envelope : recorder.out.sent()) CHECK(envelope.to == *row.owner);
    }
    ActionContext context{recorder.out, configuration};
    TimepointSpec mine = timeline_specs[0];
    mine.owner = ModuleId::power;
    context.begin(mine);
    CHECK_THROWS_AS(context.fire(PyroId::coolant_vent), CheckFailed);
}

TEST_CASE("a decision is explained by its owner; another that tries fails its check", "[flight][R5][R38]") {
    test::OutboxRecorder recorder{ModuleId::mfsk};
    recorder.out.record(packet::Explanation{.decision = Decision::tone});
    CHECK(recorder.packets<packet::Explanation>() == 1);
    CHECK_THROWS_AS(recorder.out.record(packet::Explanation{.decision = Decision::parachute_deploy}), CheckFailed);
}

}  // namespace flight_device_parts_test
