// SPDX-License-Identifier: Apache-2.0
#include "telemetry/explanation.hpp"

#include "telemetry/text.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"
#include "tests/support/small_dictionary.hpp"

#include <array>
#include <initializer_list>
#include <tuple>

namespace telemetry_explanation_test {

using namespace aeolis;
using namespace aeolis::telemetry;
using aeolis::tests::PacketFiller;

namespace {

struct Ground {
    dictionary::Dictionary dictionary = tests::small_dictionary();
    Decommutator decommutator{dictionary};

    PacketFiller packet(unsigned decision, unsigned verdict, unsigned subject, unsigned conditions) const {
        PacketFiller filler{dictionary, "Explanation"};
        filler.raw("decision", decision).raw("verdict", verdict).raw("subject", subject);
        filler.raw("condition_count", conditions);
        return filler;
    }
    std::optional<Explanation> explained(PacketFiller filler) const {
        Decoded decoded;
        REQUIRE_FALSE(decommutator.decode(filler.seal(), decoded));
        return explain(dictionary, decoded);
    }
};

/// The number of a label in the packet of explanations.
std::uint64_t number_of(const dictionary::Dictionary& dictionary, std::string_view field, std::string_view label) {
    const auto& packet = *dictionary.packet("Explanation");
    for (const auto& entry : packet.fields.at(*field_index(packet, field)).type.enumeration)
        if (entry.label == label) return static_cast<std::uint64_t>(entry.value);
    FAIL("no label " << label);
    return 0;
}

}  // namespace

TEST_CASE("a decision reads with each condition, its value and its bound", "[explanation][R38]") {
    const Ground ground;
    auto packet = ground.packet(0, 0, 0, 2);
    packet.raw("condition_1", 1).real("value_1", 404.6).real("bound_1", 405.0).raw("comparison_1", 1).raw("holds_1", 1);
    packet.raw("condition_2", 2).real("value_2", 3).real("bound_2", 4).raw("comparison_2", 4);
    const auto explanation = ground.explained(packet);
    REQUIRE(explanation);
    CHECK(explanation->text == "parachute deploy fired: speed 404.6 m/s <= 405.0 m/s; tone priority 3 <= 4");
    CHECK(explanation->decision == "parachute_deploy");
    CHECK(explanation->verdict == "fired");
    REQUIRE(explanation->conditions.size() == 2);
    CHECK(explanation->conditions[0].quantity == "speed_mps");
    CHECK(explanation->conditions[0].comparison == "<=");
    CHECK(explanation->conditions[0].holds);
    CHECK_FALSE(explanation->conditions[1].holds);
}

TEST_CASE("a decision that is held reads by what is missing, then by what is there", "[explanation][R38]") {
    const Ground ground;
    auto packet = ground.packet(0, 1, 0, 1);
    packet.raw("condition_1", 1).real("value_1", 407.1).real("bound_1", 405.0).raw("comparison_1", 1);
    CHECK(ground.explained(packet)->text == "parachute deploy held: speed 407.1 m/s > 405.0 m/s");
    auto both = ground.packet(0, 1, 0, 2);
    both.raw("condition_1", 2).real("value_1", 5).real("bound_1", 4).raw("comparison_1", 3).raw("holds_1", 1);
    both.raw("condition_2", 1).real("value_2", 407.1).real("bound_2", 405.0).raw("comparison_2", 0);
    CHECK(ground.explained(both)->text == "parachute deploy held: speed 407.1 m/s >= 405.0 m/s (tone priority 5 >= 4)");
}

TEST_CASE("what does not hold is told by what holds instead", "[explanation][R38]") {
    const Ground ground;
    const std::array opposites{">=", ">", "!=", "<", "<="};  // of lt, le, eq, ge, gt
    for (unsigned comparison = 0; comparison < opposites.size(); ++comparison) {
        auto packet = ground.packet(0, 3, 0, 1);
        packet.raw("condition_1", 2).real("value_1", 1).real("bound_1", 2).raw("comparison_1", comparison);
        CHECK(ground.explained(packet)->text ==
              std::string{"parachute deploy refused: tone priority 1 "} + opposites[comparison] + " 2");
    }
}

TEST_CASE("how often flight held its tongue is said, and a tone in a condition has its name",
          "[explanation][R31][R38]") {
    const auto& dictionary = tests::shipped_dictionary();
    const Decommutator decommutator{dictionary};
    Decoded decoded;
    auto packet = PacketFiller{dictionary, "Explanation"};
    packet.raw("decision", number_of(dictionary, "decision", "tone"))
        .raw("verdict", number_of(dictionary, "verdict", "dropped"))
        .raw("subject", 46)
        .raw("condition_count", 1)
        .raw("condition_1", number_of(dictionary, "condition_1", "overtaking_tone"))
        .real("value_1", 47)
        .real("bound_1", 47)
        .raw("comparison_1", number_of(dictionary, "comparison_1", "eq"))
        .raw("holds_1", 1)
        .raw("suppressed", 316);
    REQUIRE_FALSE(decommutator.decode(packet.seal(), decoded));
    const auto explanation = explain(dictionary, decoded);
    REQUIRE(explanation);
    CHECK(explanation->suppressed == 316);
    CHECK(explanation->text == "tone “" + in_words(dictionary.tones[46].name) + "” dropped: overtaking tone “" +
                                   in_words(dictionary.tones[47].name) + "”; held 316 cycles untold");
}

TEST_CASE("the subject is told by name", "[explanation][R38]") {
    const Ground ground;
    CHECK(ground.explained(ground.packet(1, 1, 2, 0))->text == "timepoint coolant vent held");
    CHECK(ground.explained(ground.packet(1, 1, 9, 0))->text == "timepoint 9 held");
    CHECK(ground.explained(ground.packet(2, 2, 37, 0))->text == "tone “parachute out” chosen");
    CHECK(ground.explained(ground.packet(3, 3, 0x0103, 0))->text == "command EDL_DO_EDL refused");
    CHECK(ground.explained(ground.packet(4, 4, 1, 0))->text == "EDL phase changed to parachute descent");
}

TEST_CASE("a sub-constraint that does not hold is told by its two moments and its line, event and explanation alike",
          "[explanation][R39]") {
    const auto& dictionary = tests::shipped_dictionary();
    const Decommutator decommutator{dictionary};
    const auto row = std::ranges::find_if(dictionary.constraints, [&](const dictionary::ConstraintRow& each) {
        return each.from.kind == dictionary::Moment::Kind::fired &&
               each.to.kind == dictionary::Moment::Kind::triggered &&
               dictionary.timeline[each.from.index].name == "coolant_vent" &&
               dictionary.timeline[each.to.index].name == "uhf_start";
    });
    REQUIRE(row != dictionary.constraints.end());
    const auto number = static_cast<std::uint64_t>(row - dictionary.constraints.begin());
    const std::string subject = std::to_string(number) +
                                " (from the firing of coolant vent to the triggering of UHF start, constraints.csv:" +
                                std::to_string(row->line) + ")";
    Decoded decoded;
    auto packet = PacketFiller{dictionary, "Explanation"};
    packet.raw("decision", number_of(dictionary, "decision", "sub_constraint"))
        .raw("verdict", number_of(dictionary, "verdict", "violated"))
        .raw("subject", number)
        .raw("condition_count", 1)
        .raw("condition_1", number_of(dictionary, "condition_1", "elapsed_s"))
        .real("value_1", 12.5)
        .real("bound_1", 20.0)
        .raw("comparison_1", number_of(dictionary, "comparison_1", "ge"));
    REQUIRE_FALSE(decommutator.decode(packet.seal(), decoded));
    CHECK(explain(dictionary, decoded)->text == "sub-constraint " + subject + " violated: elapsed 12.5 s < 20 s");

    auto event = PacketFiller{dictionary, "SUB_CONSTRAINT_VIOLATED"};
    event.raw("constraint", number).real("elapsed_s", 12.5).real("bound_s", 20.0).raw("violations", 1);
    REQUIRE_FALSE(decommutator.decode(event.seal(), decoded));
    CHECK(event_text(dictionary, *event_of(dictionary, decoded), decoded) ==
          "Sub-constraint " + subject +
              " does not hold: 12.500 s, bound 20.000 s; 1 so far. Nothing was done about it");
}

TEST_CASE("facts read yes or no, modes and events by name, and no number stands for a name", "[explanation][R38]") {
    const auto& dictionary = tests::shipped_dictionary();
    const Decommutator decommutator{dictionary};
    const auto text_of = [&](const char* decision, const char* verdict, std::uint64_t subject,
                             std::initializer_list<std::tuple<const char*, double, double, bool>> conditions) {
        auto packet = PacketFiller{dictionary, "Explanation"};
        packet.raw("decision", number_of(dictionary, "decision", decision))
            .raw("verdict", number_of(dictionary, "verdict", verdict))
            .raw("subject", subject)
            .raw("condition_count", conditions.size());
        int slot = 0;
        for (const auto& [quantity, value, bound, holds] : conditions) {
            const std::string ending = "_" + std::to_string(++slot);
            packet.raw("condition" + ending, number_of(dictionary, "condition_1", quantity))
                .real("value" + ending, value)
                .real("bound" + ending, bound)
                .raw("comparison" + ending, number_of(dictionary, "comparison_1", "eq"))
                .raw("holds" + ending, holds ? 1 : 0);
        }
        Decoded decoded;
        REQUIRE_FALSE(decommutator.decode(packet.seal(), decoded));
        return explain(dictionary, decoded)->text;
    };
    CHECK(
        text_of("command", "refused", 0x0103, {{"parameters_received", 1, 1, true}, {"fault_inhibit", 1, 0, false}}) ==
        "command EDL_DO_EDL refused: fault inhibit: yes (parameters received: yes)");
    CHECK(text_of("gnc_mode", "changed", 3, {{"previous_mode", 2, 2, true}, {"mode_event", 2, 2, true}}) ==
          "GNC mode changed to range control: previous mode wait for guidance start; mode event drag felt");
    CHECK(text_of("edl_phase", "changed", 1, {{"previous_phase", 0, 0, true}, {"phase_event", 0, 0, true}}) ==
          "EDL phase changed to late cruise: previous phase pre EDL; phase event late cruise begins");
    CHECK(text_of("command", "refused", 0x0104, {{"unsafe_timepoint", 0, 0, true}}) ==
          "command EDL_SET_TIMEPOINT_OFFSET refused: unsafe timepoint " + in_words(dictionary.timeline[0].name));
    CHECK(text_of("command", "refused", 0x0107, {{"staged_parameter", 0, 0, true}}) ==
          "command EDL_STAGE_PARAMETER refused: staged parameter " + in_words(dictionary.parameters[0].name));
    REQUIRE(dictionary.parameters[0].name.ends_with("_s"));
    CHECK(text_of("command", "refused", 0x0107, {{"staged_parameter", 0, 0, true}, {"parameter_value", 5, 5, true}}) ==
          "command EDL_STAGE_PARAMETER refused: staged parameter " + in_words(dictionary.parameters[0].name) +
              "; parameter value 5 s == 5 s");
    CHECK(text_of("gnc_mode", "changed", 3, {{"mode_event", 999, 999, true}, {"next_tone", -7, -7, true}}) ==
          "GNC mode changed to range control: mode event 999; next tone -7");
}

TEST_CASE("a count of conditions beyond the slots gives the slots there are", "[explanation]") {
    const Ground ground;
    CHECK(ground.explained(ground.packet(0, 0, 0, 255))->conditions.size() == 4);
}

TEST_CASE("only the packet of explanations is explained", "[explanation]") {
    const Ground ground;
    Decoded decoded;
    REQUIRE_FALSE(ground.decommutator.decode(PacketFiller{ground.dictionary, "Status"}.seal(), decoded));
    CHECK_FALSE(explain(ground.dictionary, decoded));
}

TEST_CASE("the shipped dictionary's explanations have what is told of them", "[explanation][R38][R48]") {
    const auto& dictionary = tests::shipped_dictionary();
    const Decommutator decommutator{dictionary};
    Decoded decoded;
    auto packet = PacketFiller{dictionary, "Explanation"};
    packet.raw("decision", number_of(dictionary, "decision", "command")).raw("condition_count", 4);
    for (const char* slot : {"1", "2", "3", "4"})
        packet.real(std::string{"value_"} + slot, 2.0).real(std::string{"bound_"} + slot, 3.0);
    packet.raw("condition_4", number_of(dictionary, "condition_4", "speed_mps"));
    packet.raw("comparison_4", number_of(dictionary, "comparison_4", "le")).raw("holds_4", 1);
    REQUIRE_FALSE(decommutator.decode(packet.seal(), decoded));
    const auto explanation = explain(dictionary, decoded);
    REQUIRE(explanation);
    INFO(explanation->text);
    CHECK(explanation->decision == "command");
    CHECK(explanation->verdict == "decided");
    REQUIRE(explanation->conditions.size() == 4);
    CHECK(explanation->text.find("speed 2.00 m/s <= 3.00 m/s") != std::string::npos);
}

TEST_CASE("a device that is taken as lost is named", "[explanation][R38]") {
    const auto& dictionary = tests::shipped_dictionary();
    const Decommutator decommutator{dictionary};
    Decoded decoded;
    auto packet = PacketFiller{dictionary, "Explanation"};
    packet.raw("decision", number_of(dictionary, "decision", "device_lost"))
        .raw("subject", 4)
        .raw("condition_count", 1);
    packet.raw("condition_1", number_of(dictionary, "condition_1", "thrusters_felt")).real("value_1", 0.02);
    packet.real("bound_1", 0.3).raw("comparison_1", number_of(dictionary, "comparison_1", "lt")).raw("holds_1", 1);
    REQUIRE_FALSE(decommutator.decode(packet.seal(), decoded));
    CHECK(explain(dictionary, decoded)->text == "thrusters taken as lost: thrusters felt 0.02 < 0.3");
}

}  // namespace telemetry_explanation_test
