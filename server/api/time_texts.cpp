// SPDX-License-Identifier: Apache-2.0
#include "server/api/time_texts.hpp"

#include "aeolis/v1/alarms.pb.h"
#include "aeolis/v1/run.pb.h"
#include "common/time.hpp"

#include <vector>

namespace aeolis::server {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

std::string text_of(std::int64_t time_us) {
    return day_of_year_text(Ert{time_us});
}

void write_clocks(v1::Clocks& clocks) {
    clocks.set_scet(clocks.has_scet_us() ? text_of(clocks.scet_us()) : "");
    clocks.set_ert(clocks.has_ert_us() ? text_of(clocks.ert_us()) : "");
    clocks.set_latest_useful(clocks.has_latest_useful_us() ? text_of(clocks.latest_useful_us()) : "");
}

void write_status(v1::ProcedureStatus& status) {
    status.set_begun(text_of(status.begun_us()));
    for (auto& step : *status.mutable_steps()) {
        if (step.has_limit_us()) step.set_limit(text_of(step.limit_us()));
        if (step.has_since_us()) step.set_since(text_of(step.since_us()));
        if (step.has_limit_passed_us()) step.set_limit_passed(text_of(step.limit_passed_us()));
        if (step.has_over_us()) step.set_over(text_of(step.over_us()));
        for (auto& signature : *step.mutable_signatures()) signature.set_at(text_of(signature.at_us()));
    }
    for (auto& watchdog : *status.mutable_watchdogs()) {
        if (watchdog.has_tripped_us()) watchdog.set_tripped(text_of(watchdog.tripped_us()));
        if (watchdog.has_acknowledged())
            watchdog.mutable_acknowledged()->set_at(text_of(watchdog.acknowledged().at_us()));
    }
}

void write_answer(v1::PositionAnswer& answer) {
    if (answer.has_at_us()) answer.set_at(text_of(answer.at_us()));
}

void write_board(v1::PositionBoard& board) {
    for (auto& seat : *board.mutable_seats())
        if (seat.has_since_us()) seat.set_since(text_of(seat.since_us()));
    if (!board.has_poll()) return;
    auto& poll = *board.mutable_poll();
    poll.set_at(text_of(poll.at_us()));
    for (auto& answer : *poll.mutable_answers()) write_answer(answer);
    if (poll.has_decision()) write_answer(*poll.mutable_decision());
}

void write_item(v1::Item& item) {
    const auto ert = text_of(item.ert_us());
    switch (item.item_case()) {
    case v1::Item::kUnit: item.mutable_unit()->set_ert(ert); break;
    case v1::Item::kEvent: item.mutable_event()->set_ert(ert); break;
    case v1::Item::kTone:
        item.mutable_tone()->set_ert_start(text_of(item.tone().ert_start_us()));
        item.mutable_tone()->set_ert_end(ert);
        break;
    case v1::Item::kCommandStage: item.mutable_command_stage()->set_at(ert); break;
    case v1::Item::kLink: {
        auto& link = *item.mutable_link();
        link.set_ert(ert);
        if (link.has_until_us()) link.set_until(text_of(link.until_us()));
        break;
    }
    case v1::Item::kSituation:
        for (auto& entry : *item.mutable_situation()->mutable_entries()) {
            entry.set_since(text_of(entry.since_us()));
            if (entry.has_at_us()) entry.set_at(text_of(entry.at_us()));
        }
        break;
    case v1::Item::kStaleness: item.mutable_staleness()->set_ert(ert); break;
    case v1::Item::kAlarmAction: {
        auto& action = *item.mutable_alarm_action();
        action.set_at(ert);
        action.set_until(action.has_until_us() ? text_of(action.until_us()) : "");
        break;
    }
    case v1::Item::kNote: item.mutable_note()->set_at(ert); break;
    case v1::Item::kProcedureAct: item.mutable_procedure_act()->set_at(ert); break;
    case v1::Item::kPositionAct:
        item.mutable_position_act()->set_at(ert);
        write_board(*item.mutable_position_act()->mutable_board());
        break;
    case v1::Item::kProcedure: write_status(*item.mutable_procedure()); break;
    case v1::Item::kSamples:
    case v1::Item::kTimepoint:
    case v1::Item::kExplanation:
    case v1::Item::kAlarm:
    case v1::Item::ITEM_NOT_SET: break;
    }
}

void write_reply(v1::CommandReply& reply) {
    reply.set_arrives(reply.has_arrives_us() ? text_of(reply.arrives_us()) : "");
    reply.set_effect_seen(reply.has_effect_seen_us() ? text_of(reply.effect_seen_us()) : "");
    reply.set_station_until(reply.has_station_until_us() ? text_of(reply.station_until_us()) : "");
    reply.set_leaves(reply.has_leaves_us() ? text_of(reply.leaves_us()) : "");
    reply.set_latest_useful(reply.has_latest_useful_us() ? text_of(reply.latest_useful_us()) : "");
    if (reply.has_fate_us()) reply.mutable_fate()->set_at(text_of(reply.fate_us()));
}

}  // namespace

void write_time_texts(Message& answer) {
    if (auto* item = dynamic_cast<v1::Item*>(&answer)) return write_item(*item);
    if (auto* board = dynamic_cast<v1::PositionBoard*>(&answer)) return write_board(*board);
    if (auto* reply = dynamic_cast<v1::CommandReply*>(&answer)) return write_reply(*reply);
    if (auto* alarm = dynamic_cast<v1::AlarmState*>(&answer))
        return alarm->set_shelved_until(alarm->has_shelved_until_us() ? text_of(alarm->shelved_until_us()) : "");
    if (auto* clocks = dynamic_cast<v1::Clocks*>(&answer)) return write_clocks(*clocks);
    if (auto* clock = dynamic_cast<v1::ClockReply*>(&answer)) return clock->set_scet(text_of(clock->scet_us()));
    if (auto* packet = dynamic_cast<v1::PacketRow*>(&answer))
        packet->mutable_unit()->set_ert(text_of(packet->ert_us()));
    const auto& reflection = *answer.GetReflection();
    std::vector<const FieldDescriptor*> fields;
    reflection.ListFields(answer, &fields);
    for (const auto* field : fields) {
        if (field->cpp_type() != FieldDescriptor::CPPTYPE_MESSAGE) continue;
        if (!field->is_repeated()) {
            write_time_texts(*reflection.MutableMessage(&answer, field));
            continue;
        }
        for (int i = 0; i < reflection.FieldSize(answer, field); ++i)
            write_time_texts(*reflection.MutableRepeatedMessage(&answer, field, i));
    }
}

}  // namespace aeolis::server
