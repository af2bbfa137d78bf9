// SPDX-License-Identifier: Apache-2.0
#include "server/archive/items.hpp"

#include "aeolis/v1/alarms.pb.h"
#include "server/archive/item_tables.hpp"
#include "server/archive/procedure_status.hpp"
#include "tests/support/catch.hpp"

namespace server_archive_items_test {

using namespace aeolis;

namespace {

/// The words of an enumeration, as the archive has them in its columns.
template <typename Own>
std::vector<std::string> kept() {
    std::vector<std::string> words;
    for (std::size_t i = 0; i < archive::EnumWords<Own>::count; ++i)
        words.emplace_back(archive::EnumWords<Own>::of(static_cast<Own>(i)));
    return words;
}

/// The same of an enumeration of the schema: the names are the words in JSON.
std::vector<std::string> sent(const google::protobuf::EnumDescriptor* wire) {
    std::vector<std::string> words;
    for (int i = 0; i < wire->value_count(); ++i) {
        CHECK(wire->value(i)->number() == i);
        words.push_back(wire->value(i)->name());
    }
    return words;
}

}  // namespace

TEST_CASE("an enumeration has the same words, in the same order, in the archive and on the stream", "[archive]") {
    CHECK(kept<dictionary::EventLevel>() == sent(v1::Event::Level_descriptor()));
    CHECK(kept<commands::Stage>() == sent(v1::CommandStage::Stage_descriptor()));
    CHECK(kept<commands::Status>() == sent(v1::CommandStage::Status_descriptor()));
    CHECK(kept<dictionary::Severity>() == sent(v1::Alarm::Severity_descriptor()));
    CHECK(kept<telemetry::AlarmAct>() == sent(v1::AlarmAction::Action_descriptor()));
    CHECK(kept<telemetry::SilenceClass>() == sent(v1::LinkChange::Silence_descriptor()));
    CHECK(kept<archive::FiringVerdict>() == sent(v1::TimepointFiring::Verdict_descriptor()));
    CHECK(kept<archive::Outcome>() == sent(v1::Landing::Outcome_descriptor()));
    CHECK(kept<CarrierLock>() == sent(v1::Carrier::Lock_descriptor()));
}

TEST_CASE("the standing of an alarm has the same words on the ground and in the API", "[archive][alarms]") {
    std::vector<std::string> words;
    for (int i = 0; i <= static_cast<int>(telemetry::AlarmStanding::shelved); ++i)
        words.emplace_back(name_of(static_cast<telemetry::AlarmStanding>(i)));
    CHECK(words == sent(v1::StandingAlarm::State_descriptor()));
}

TEST_CASE("a verdict on a firing that no schema names is unknown, never another", "[archive]") {
    CHECK(archive::firing_verdict("no_operation") == archive::FiringVerdict::no_operation);
    CHECK(archive::firing_verdict("timed_out") == archive::FiringVerdict::unknown);
    CHECK(archive::firing_verdict("") == archive::FiringVerdict::unknown);
}

TEST_CASE("a status whose octets are damaged says so, and of which procedure it was", "[archive][procedures]") {
    archive::ProcedureStatusRecord record;
    record.number = 3;
    record.procedure = "start";
    record.held = "Ada (gnc): not yet";
    v1::ProcedureStatus status;
    status.set_number(3);
    status.set_title("Start");
    record.status = archive::packed(status);
    CHECK(archive::to_item(record).procedure().title() == "Start");
    record.status.pop_back();
    const auto damaged = archive::to_item(record).procedure();
    CHECK(damaged.number() == 3);
    CHECK(damaged.title() == "the status of procedure start cannot be read: its octets in the archive are damaged");
    CHECK(damaged.held() == "Ada (gnc): not yet");
}

}  // namespace server_archive_items_test
