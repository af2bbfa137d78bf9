// SPDX-License-Identifier: Apache-2.0
#include "server/api/time_texts.hpp"

#include "aeolis/v1/lists.pb.h"
#include "aeolis/v1/run.pb.h"
#include "tests/support/catch.hpp"

namespace server_time_texts_test {

using namespace aeolis;

TEST_CASE("in an answer of HTTP each time of an item has its text, however deep the item lies", "[http][api]") {
    v1::StateAt state;
    auto& tone = *state.mutable_tone();
    tone.set_ert_us(10'250'000);
    tone.mutable_tone()->set_ert_start_us(250'000);
    auto& link = *state.add_links();
    link.set_ert_us(1'000'999);
    link.mutable_link();
    server::write_time_texts(state);
    CHECK(tone.tone().ert_start() == "2000-001T12:00:00.250");
    CHECK(tone.tone().ert_end() == "2000-001T12:00:10.250");
    CHECK(link.link().ert() == "2000-001T12:00:01.000");  // cut, not rounded

    v1::CommandList commands;
    auto& stage = *commands.add_commands()->add_stages();
    stage.set_ert_us(-1'000'000);
    stage.mutable_command_stage();
    server::write_time_texts(commands);
    CHECK(stage.command_stage().at() == "2000-001T11:59:59.000");

    v1::PacketList packets;
    auto& row = *packets.add_packets();
    row.set_ert_us(2'000'000);
    server::write_time_texts(packets);
    CHECK(row.unit().ert() == "2000-001T12:00:02.000");
}

TEST_CASE("the clocks of a run have texts in an answer of HTTP, empty where a time is not known", "[http][api]") {
    v1::RunList runs;
    auto& run = *runs.add_runs();
    run.mutable_clock()->set_scet_us(1'000'000);
    run.mutable_clocks()->set_ert_us(2'000'000);
    server::write_time_texts(runs);
    CHECK(run.clock().scet() == "2000-001T12:00:01.000");
    CHECK(run.clocks().ert() == "2000-001T12:00:02.000");
    CHECK(run.clocks().scet().empty());
    CHECK(run.clocks().has_latest_useful());
    CHECK(run.clocks().latest_useful().empty());
}

TEST_CASE("the reply to a command has texts in an answer of HTTP, empty where a time is not known", "[http][api]") {
    v1::SequenceReply replies;
    auto& reply = *replies.add_commands();
    reply.set_arrives_us(1'000'000);
    reply.set_fate_us(2'000'000);
    server::write_time_texts(replies);
    CHECK(reply.arrives() == "2000-001T12:00:01.000");
    CHECK(reply.fate().at() == "2000-001T12:00:02.000");
    CHECK(reply.has_leaves());
    CHECK(reply.leaves().empty());
}

TEST_CASE("of what was done about an alarm only a shelving has an end", "[http][api]") {
    v1::Item shelved, acknowledged;
    shelved.mutable_alarm_action()->set_until_us(60'000'000);
    acknowledged.mutable_alarm_action();
    server::write_time_texts(shelved);
    server::write_time_texts(acknowledged);
    CHECK(shelved.alarm_action().until() == "2000-001T12:01:00.000");
    CHECK(acknowledged.alarm_action().at() == "2000-001T12:00:00.000");
    CHECK(acknowledged.alarm_action().has_until());
    CHECK(acknowledged.alarm_action().until().empty());
}

}  // namespace server_time_texts_test
