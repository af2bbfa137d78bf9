// SPDX-License-Identifier: Apache-2.0
#include "commands/parameter_table.hpp"
#include "common/deviation.hpp"
#include "flight/edl/edl_main.hpp"
#include "flight/kernel/parameter_parts.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/outbox.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <cmath>
#include <random>

namespace flight_edl_parameters_test {

using namespace aeolis;
using namespace aeolis::flight;

// The table of parameters in EdlMain's hands (flight/edl/edl_parameters.cpp).
namespace {

struct Fixture {
    EdlMain edl{Load{}};
    test::OutboxRecorder recorder;
    std::optional<CommandRefusal> refused;
    gnc::Conditions why;

    template <typename M>
    void handle(const M& message, double at_s = 1000.0) {
        recorder.begin(ModuleId::edl, Sclk{at_s});
        edl.on(message, recorder.out);
    }
    /// Whether the command is accepted and executed.
    template <typename M>
    bool takes(const M& message) {
        handle(message);
        const auto outcomes = recorder.sent<CommandOutcome>();
        REQUIRE(outcomes.size() == 1);
        refused = outcomes[0].refused;
        why = outcomes[0].conditions;
        return !refused;
    }
    bool stage(ParameterId id, double value) {
        return takes(StageParameterCommand{{}, {.parameter = id.value, .value = value}});
    }
    /// With the CRC of what is staged, unless one is given.
    bool activate(std::uint16_t version, std::uint16_t changes, std::optional<std::uint16_t> crc = {}) {
        return takes(
            ActivateParametersCommand{{},
                                      {.parameter_version = version,
                                       .parameter_changes = changes,
                                       .parameter_crc = crc.value_or(edl.parameter_table().crc_with_staged())}});
    }
    packet::ParameterTable report() const { return edl.parameter_table().report(); }
};

/// The state of another build of the same dictionary: one number more.
struct StateOfAnotherBuild {
    EdlMain& edl;
    double more = 7.0;

    template <typename Exchange>
    void carry(Exchange& exchange) {
        exchange(edl, more);
    }
};

}  // namespace

TEST_CASE("parameters are staged one by one and activated together, and every user of them gets the table",
          "[edl][parameters][R25]") {
    Fixture f;
    REQUIRE(f.stage(parameter::heartbeat_after_s, 30.0));
    CHECK(f.recorder.events<evr::PARAMETER_STAGED>() == 1);
    CHECK(f.recorder.packets<packet::ParameterTable>() == 1);
    REQUIRE(f.stage(parameter::radar_beams_min, 20.0));
    CHECK(f.edl.parameter_table().values() == Parameters{});
    REQUIRE(f.activate(7, 2));
    CHECK(f.recorder.events<evr::PARAMETERS_ACTIVATED>() == 1);
    CHECK(f.edl.parameter_table().values().heartbeat_after_s == 30.0);
    CHECK(f.report().parameter_version == 7);
    for (const ModuleId module : {ModuleId::edl_bg, ModuleId::mfsk}) {
        ReceivedParameters told;
        bool whole = false;
        for (const Envelope& envelope : f.recorder.out.sent())
            if (const auto* part = std::get_if<ParameterPart>(&envelope.message); part && envelope.to == module)
                whole = told.on(*part);
        CHECK(whole);
        CHECK(told.values() == f.edl.parameter_table().values());
    }
}

TEST_CASE("an activation needs the number of changes that ground staged, and a new version",
          "[edl][parameters][R25][R38]") {
    Fixture f;
    REQUIRE(f.stage(parameter::guidance_gain, 4.0));
    for (const std::uint16_t other : {2, 32}) {
        CHECK_FALSE(f.activate(1, other));
        CHECK(f.refused == CommandRefusal::bad_argument);
        CHECK(f.why[0].quantity == Quantity::staged_changes);
        CHECK_FALSE(f.why[0].holds);
    }
    REQUIRE(f.stage(parameter::sufr_lead_s, 19.0));
    CHECK_FALSE(f.activate(1, 1));  // one more was staged than ground knows
    CHECK(f.edl.parameter_table().values() == Parameters{});
    REQUIRE(f.activate(1, 2));
    REQUIRE(f.stage(parameter::guidance_gain, 4.5));
    CHECK_FALSE(f.activate(1, 1));
    CHECK(f.refused == CommandRefusal::bad_argument);
    CHECK(f.why[1].quantity == Quantity::parameter_version_new);
    CHECK_FALSE(f.why[1].holds);
    CHECK(f.edl.parameter_table().values().guidance_gain == 4.0);
    CHECK(f.activate(2, 1));
    CHECK_FALSE(f.activate(3, 1));  // nothing is staged any more
}

TEST_CASE("an activation of another table than ground means is refused, though number and version are right",
          "[edl][parameters][R25][R38][R48]") {
    Fixture f;
    commands::ParameterTable meant{tests::shipped_dictionary()};
    REQUIRE(meant.set(parameter::guidance_gain, 4.0));
    REQUIRE(f.stage(parameter::sufr_lead_s, 19.0));  // by somebody else, and ours was refused or lost
    CHECK_FALSE(f.activate(1, 1, meant.crc()));
    CHECK(f.refused == CommandRefusal::bad_argument);
    CHECK(f.why[2].quantity == Quantity::parameter_crc_as_sent);
    CHECK_FALSE(f.why[2].holds);
    CHECK(f.edl.parameter_table().values() == Parameters{});
    REQUIRE(f.takes(DiscardParametersCommand{}));
    REQUIRE(f.stage(parameter::guidance_gain, std::nextafter(4.0, 5.0)));  // one bit off
    CHECK_FALSE(f.activate(1, 1, meant.crc()));
    REQUIRE(f.stage(parameter::guidance_gain, 4.0));
    REQUIRE(f.activate(1, 1, meant.crc()));
    CHECK(f.report().parameter_crc == meant.crc());
}

TEST_CASE("an activation whose deviations add up to more than one range is refused, counted from the table built in",
          "[edl][parameters][R25][R38]") {
    Fixture f;
    REQUIRE(f.stage(parameter::guidance_gain, 3.0));  // half of what is below 5
    REQUIRE(f.activate(1, 1));
    REQUIRE(f.stage(parameter::tilt_max_deg, 80.0));  // all of what is above 60
    CHECK_FALSE(f.activate(2, 1));
    CHECK(f.refused == CommandRefusal::bad_argument);
    REQUIRE(f.why.size() == 4);
    CHECK(f.why[3].quantity == Quantity::table_deviation);
    CHECK(f.why[3].value == 1.5);
    CHECK(f.why[3].bound == 1.0);
    REQUIRE(f.stage(parameter::tilt_max_deg, 70.0));
    CHECK(f.activate(2, 1));
}

TEST_CASE("what may not be staged is refused with the reason: range, fixed, unknown, no room",
          "[edl][parameters][R25][R38]") {
    Fixture f;
    CHECK_FALSE(f.stage(parameter::guidance_gain, 10.5));
    CHECK(f.refused == CommandRefusal::bad_argument);
    CHECK_FALSE(f.stage(parameter::entry_moved_max_s, 12.0));
    CHECK(f.refused == CommandRefusal::fixed_at_build);
    CHECK_FALSE(f.stage(ParameterId{parameter_count}, 1.0));
    CHECK(f.refused == CommandRefusal::bad_argument);
    CHECK(f.why[0].quantity == Quantity::row_number);
    CHECK(f.report().parameters_staged == 0);
    for (std::uint16_t row = 0; row < parameter_count; ++row) {
        const ParameterSpec& spec = parameter_specs.at(row);
        if (spec.member == nullptr) continue;
        const bool room = f.report().parameters_staged < staged_changes_max;
        CHECK(f.stage(ParameterId{row}, spec.max) == room);
        if (room) continue;
        CHECK(f.refused == CommandRefusal::staging_full);
        CHECK(f.why[0].quantity == Quantity::staged_changes);
    }
    CHECK(f.report().parameters_staged == staged_changes_max);
}

TEST_CASE("staged parameters that are discarded change nothing", "[edl][parameters][R25]") {
    Fixture f;
    REQUIRE(f.stage(parameter::guidance_gain, 4.0));
    REQUIRE(f.takes(DiscardParametersCommand{}));
    CHECK(f.recorder.events<evr::PARAMETERS_DISCARDED>() == 1);
    CHECK_FALSE(f.activate(1, 1));
    CHECK(f.edl.parameter_table().values() == Parameters{});
    CHECK(f.takes(DiscardParametersCommand{}));  // of none
}

TEST_CASE("a dump hands the whole table to EdlComm and changes nothing", "[edl][parameters][R25][R30]") {
    Fixture f;
    REQUIRE(f.stage(parameter::guidance_gain, 4.0));
    const auto before = f.report();
    REQUIRE(f.takes(DumpParametersCommand{}));
    ReceivedParameters dumped;
    bool whole = false;
    for (const Envelope& envelope : f.recorder.out.sent())
        if (const auto* part = std::get_if<ParameterPart>(&envelope.message)) {
            CHECK(envelope.to == ModuleId::edl_comm);
            whole = dumped.on(*part);
        }
    CHECK(whole);
    CHECK(dumped.values() == f.edl.parameter_table().values());
    CHECK(f.report() == before);
}

TEST_CASE("the table's version is told on change and every eight seconds, also before the first solution",
          "[edl][parameters][R25]") {
    Fixture f;
    int told = 0;
    for (double at_s = 1000.0; at_s < 1080.0; at_s += 1.0 / 64) {
        f.handle(Tick{Sclk{at_s}}, at_s);
        told += f.recorder.packets<packet::ParameterTable>();
    }
    CHECK(told == 10);
}

TEST_CASE("a computer that is restarted with the state of another build goes on as if it had none",
          "[edl][parameters][R25][R32]") {
    Fixture f;
    REQUIRE(f.stage(parameter::guidance_gain, 4.0));
    REQUIRE(f.activate(5, 1));
    StateOfAnotherBuild another{f.edl};
    const StateHeader header{.time = Sclk{1000.0}, .revision = 9};
    const StateFrame frame = StateFrame::of(header, another);
    Load load;
    load.resets = 1;
    Fixture restarted;
    restarted.edl = EdlMain{load};
    REQUIRE(restarted.stage(parameter::heartbeat_after_s, 30.0));
    const StateFrame before = StateFrame::of(header, restarted.edl);
    frame.in_parts([&](const StatePart& part) { restarted.handle(part); });
    restarted.handle(Resume{ResumeReason::restart});
    CHECK(restarted.recorder.events<evr::STATE_UNREADABLE>() == 1);
    CHECK(std::ranges::equal(StateFrame::of(header, restarted.edl).octets(), before.octets()));
}

TEST_CASE("a computer that is restarted goes on with the table and what was staged, and tells those who need it",
          "[edl][parameters][R25][R32]") {
    Fixture f;
    REQUIRE(f.stage(parameter::guidance_gain, 4.0));
    REQUIRE(f.activate(5, 1));
    REQUIRE(f.stage(parameter::heartbeat_after_s, 30.0));
    f.handle(Tick{Sclk{1000.0}});
    const auto parts = f.recorder.sent<StatePart>();  // what prime keeps, though it has no solution yet
    REQUIRE_FALSE(parts.empty());
    Load load;
    load.resets = 1;
    Fixture restarted;
    restarted.edl = EdlMain{load};
    for (const StatePart& part : parts) restarted.handle(part);
    restarted.handle(Resume{ResumeReason::restart});
    CHECK(restarted.recorder.events<evr::STATE_UNREADABLE>() == 0);
    CHECK(restarted.recorder.sent<ParameterPart>().size() ==
          2 * ((parameter_count + part_parameters_max - 1) / part_parameters_max));
    CHECK(restarted.report() == f.report());
    CHECK(restarted.edl.parameter_table().values() == f.edl.parameter_table().values());
    REQUIRE(restarted.activate(6, 1));
    CHECK(restarted.edl.parameter_table().values().heartbeat_after_s == 30.0);
}

TEST_CASE("in any order of these commands the table is that of a simple model, and its values are within their ranges",
          "[edl][parameters][R25]") {
    std::mt19937 random{25};
    const auto below = [&](std::uint32_t count) { return random() % count; };
    Fixture f;
    Parameters held;
    std::vector<std::pair<ParameterId, double>> staged;
    std::uint16_t version = 0;
    const auto deviation_of = [](const Parameters& table) {
        double sum = 0.0;
        for (std::uint16_t row = 0; row < parameter_count; ++row) {
            const ParameterSpec& spec = parameter_specs.at(row);
            sum += deviation(value_of(table, ParameterId{row}), value_of(Parameters{}, ParameterId{row}), spec.min,
                             spec.max);
        }
        return sum;
    };
    int activated = 0;
    for (int i = 0; i < 20'000; ++i) {
        const auto kind = below(20);
        if (kind < 16) {
            const ParameterId id{static_cast<std::uint16_t>(below(parameter_count + 3))};
            const bool known = id.value < parameter_count && parameter_specs.at(id.value).member != nullptr;
            const double min = known ? parameter_specs.at(id.value).min : 0.0;
            const double max = known ? parameter_specs.at(id.value).max : 1.0;
            // Mostly so near the value built in that several may change together.
            const double near = known ? value_of(Parameters{}, id) : 0.0;
            const double value = below(16) == 0 ? min + (max - min) * (static_cast<double>(below(130)) - 15.0) / 100.0
                                                : near + (max - near) * static_cast<double>(below(10)) / 1000.0;
            const auto same = std::ranges::find(staged, id, &std::pair<ParameterId, double>::first);
            const bool room = same != staged.end() || staged.size() < staged_changes_max;
            const bool taken = known && value >= min && value <= max && room;
            REQUIRE(f.stage(id, value) == taken);
            if (taken && same != staged.end()) same->second = value;
            if (taken && same == staged.end()) staged.emplace_back(id, value);
        } else if (kind < 19) {
            const auto next = static_cast<std::uint16_t>(version + below(3));
            const auto changes = static_cast<std::uint16_t>(staged.size() + (below(4) == 0 ? 1 : 0));
            Parameters together = held;
            for (const auto& [id, value] : staged) set_value(together, id, value);
            const bool taken =
                next != version && changes == staged.size() && deviation_of(together) <= table_deviation_max;
            REQUIRE(f.activate(next, changes) == taken);
            activated += taken;
            if (!taken) continue;
            held = together;
            staged.clear();
            version = next;
        } else {
            REQUIRE(f.takes(DiscardParametersCommand{}));
            staged.clear();
        }
        REQUIRE(f.edl.parameter_table().values() == held);
        REQUIRE(f.report().parameters_staged == staged.size());
        REQUIRE(f.report().parameter_version == version);
    }
    CHECK(activated > 100);
    for (std::uint16_t row = 0; row < parameter_count; ++row) {
        const double value = value_of(held, ParameterId{row});
        CHECK(value >= parameter_specs.at(row).min);
        CHECK(value <= parameter_specs.at(row).max);
    }
}

}  // namespace flight_edl_parameters_test
