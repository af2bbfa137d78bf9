// SPDX-License-Identifier: Apache-2.0
#include "flight/devices/switch_replies.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/outbox.hpp"

#include <algorithm>

namespace flight_switch_replies_test {

using namespace aeolis;
using namespace aeolis::flight;

namespace {

struct Fixture {
    SwitchReplies replies;
    test::OutboxRecorder recorder{ModuleId::power};
    void command(SwitchId id, bool on) {
        recorder.begin(ModuleId::power, Sclk{1.0});
        replies.command({id, on}, recorder.bus->switches, recorder.out);
    }
    std::size_t answers(const SwitchReply& reply, Evidence evidence = Evidence::verified) {
        recorder.begin(ModuleId::power, Sclk{1.0});
        replies.reply(reply, Unit::a, recorder.out);
        const auto sent = recorder.sent<ActionReply>();
        return static_cast<std::size_t>(std::ranges::count(sent, evidence, &ActionReply::evidence));
    }
};

}  // namespace

TEST_CASE("a switch answers the timeline once, when it is as it was told to be", "[devices][R14]") {
    Fixture f;
    f.command(SwitchId::uhf, true);
    CHECK(f.answers({SwitchId::uhf, true}) == 1);
    CHECK(f.answers({SwitchId::uhf, true}) == 0);
    CHECK(f.recorder.events<evr::REPLY_UNEXPECTED>() == 1);
}

TEST_CASE("a switch that refuses is reported and verifies nothing, even when it is on already", "[devices][R14][R50]") {
    Fixture f;
    f.command(SwitchId::uhf, true);
    CHECK(f.answers({SwitchId::uhf, true, Unit::a, true}, Evidence::refused) == 1);
    CHECK(f.recorder.sent<ActionReply>().size() == 1);
    CHECK(f.recorder.events<evr::DEVICE_REFUSED>() == 1);
}

TEST_CASE("a switch that says it is not as it was told to be is reported and counts as refused", "[devices][R50]") {
    Fixture f;
    f.command(SwitchId::uhf, true);
    CHECK(f.answers({SwitchId::uhf, false}, Evidence::refused) == 1);
    CHECK(f.recorder.events<evr::REPLY_CONTRADICTS>() == 1);
}

TEST_CASE("a switch is as its last reply says, and as commanded until it replies", "[devices][R52]") {
    Fixture f;
    using enum SwitchState;
    CHECK(f.replies.state(SwitchId::uhf) == not_commanded);
    f.command(SwitchId::uhf, true);
    CHECK(f.replies.state(SwitchId::uhf) == commanded_on);
    f.answers({SwitchId::uhf, true});
    CHECK(f.replies.state(SwitchId::uhf) == on);
    f.command(SwitchId::uhf, false);
    CHECK(f.replies.state(SwitchId::uhf) == commanded_off);
    f.answers({SwitchId::uhf, true, Unit::a, true});
    CHECK(f.replies.state(SwitchId::uhf) == refused);
    f.command(SwitchId::uhf, false);
    f.answers({SwitchId::uhf, false});
    CHECK(f.replies.state(SwitchId::uhf) == off);
}

TEST_CASE("the answer to an overtaken switch command is not taken for the newer one's", "[devices][R14]") {
    Fixture f;
    f.command(SwitchId::radar, true);
    f.command(SwitchId::radar, false);
    CHECK(f.answers({SwitchId::radar, true}) == 0);
    CHECK(f.recorder.out.sent().empty());
    CHECK(f.answers({SwitchId::radar, false}) == 1);
}

TEST_CASE("a switch that there is not, and one more than the bus takes, are reported", "[devices][R4]") {
    Fixture f;
    f.command(static_cast<SwitchId>(99), true);
    CHECK(f.recorder.events<evr::SWITCH_QUEUE_FULL>() == 1);
    CHECK(f.answers({static_cast<SwitchId>(99), true}) == 0);
    for (int i = 0; i < 8; ++i) f.command(SwitchId::radar, true);
    f.command(SwitchId::radar, true);
    CHECK(f.recorder.events<evr::SWITCH_QUEUE_FULL>() == 1);
}

}  // namespace flight_switch_replies_test
