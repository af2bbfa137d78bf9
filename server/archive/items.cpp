// SPDX-License-Identifier: Apache-2.0
#include "server/archive/items.hpp"

#include "server/archive/procedure_status.hpp"

#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace aeolis::archive {

namespace {
v1::Source source_of(Source source) {
    return static_cast<v1::Source>(source);
}
static_assert(static_cast<int>(Source::realtime) == v1::SOURCE_REALTIME);
static_assert(static_cast<int>(Source::recorded) == v1::SOURCE_RECORDED);
static_assert(static_cast<int>(Source::ground) == v1::SOURCE_GROUND);

/// Converts an enumeration to the schema's, with equal values; tests/server/archive/items_test.cpp compares the words.
template <typename Wire, typename Own>
Wire wire(Own value) {
    return static_cast<Wire>(static_cast<int>(value));
}

v1::Item item_with(const ItemRecord& record) {
    v1::Item item;
    item.set_seq(record.seq);
    item.set_ert_us(record.ert.microseconds);
    return item;
}

constexpr double ert_span_s = 8.0e12;  ///< chosen: 250 000 years; in microseconds still an int64
}  // namespace

v1::Item to_item(const PacketRecord& record, const dictionary::Dictionary* dictionary) {
    v1::Item item = item_with(record);
    auto& packet = *item.mutable_unit();
    packet.set_unit(record.seq);
    packet.set_apid(record.apid.value);
    if (!record.packet)
        packet.set_name("not decoded: " + record.refusal);
    else if (dictionary != nullptr)
        packet.set_name(dictionary->packets[*record.packet].name);
    packet.set_sclk(record.sclk.seconds);
    packet.set_octets(static_cast<std::uint32_t>(record.octets.count));
    packet.set_link(record.link);
    packet.set_source(source_of(record.source));
    packet.set_duplicate(record.duplicate());
    return item;
}

v1::Item to_item(const SampleRecord& record, std::span<const ChannelId> channels, std::span<const double> values) {
    v1::Item item = item_with(record);
    auto& samples = *item.mutable_samples();
    samples.set_sclk(record.sclk.seconds);
    samples.set_source(source_of(record.source));
    samples.mutable_ids()->Reserve(static_cast<int>(channels.size()));
    samples.mutable_values()->Reserve(static_cast<int>(channels.size()));
    for (std::size_t i = 0; i < values.size(); ++i) {
        samples.add_ids(channels[i].value);
        samples.add_values(values[i]);
    }
    for (const auto& [column, text] : record.texts) {
        auto& exact = *samples.add_exact();
        exact.set_id(channels[column].value);
        exact.set_text(text);
    }
    samples.set_sclk_by_reception(record.sclk_by_reception);
    return item;
}

v1::Item to_item(const EventRecord& record) {
    v1::Item item = item_with(record);
    auto& event = *item.mutable_event();
    event.set_id(record.id.value);
    event.set_name(record.name);
    event.set_level(wire<v1::Event::Level>(record.level));
    event.set_text(record.text);
    event.set_sclk(record.sclk.seconds);
    event.set_source(source_of(record.source));
    event.set_duplicate(record.duplicate);
    return item;
}

v1::Item to_item(const ToneRecord& record) {
    v1::Item item = item_with(record);
    auto& tone = *item.mutable_tone();
    tone.set_ert_start_us(record.start.microseconds);
    if (record.tone) tone.set_tone(record.tone->value);
    tone.set_name(record.name);
    tone.set_meaning(record.meaning);
    tone.set_likelihood(record.likelihood);
    if (record.runner_up) tone.set_runner_up(record.runner_up->value);
    tone.set_runner_up_likelihood(record.runner_up_likelihood);
    tone.set_c_n0_dbhz(record.c_n0_dbhz);
    tone.set_doppler_hz(record.doppler_hz);
    tone.set_locked(record.lock == CarrierLock::locked);
    tone.set_model(record.model);
    tone.set_sclk(record.sclk.seconds);
    tone.set_lock(wire<v1::Carrier::Lock>(record.lock));
    for (const ToneLikelihood& each : record.best) {
        auto& written = *tone.add_best();
        written.set_tone(each.tone);
        written.set_likelihood(each.likelihood);
    }
    if (record.spectrum) tone.set_spectrum(record.spectrum->data(), record.spectrum->size());
    return item;
}

v1::Item to_item(const StageRecord& record) {
    v1::Item item = item_with(record);
    auto& stage = *item.mutable_command_stage();
    stage.set_command(record.command);
    stage.set_name(record.name);
    stage.set_stage(wire<v1::CommandStage::Stage>(record.stage));
    stage.set_status(wire<v1::CommandStage::Status>(record.status));
    stage.set_evidence(record.evidence);
    stage.set_arguments(record.arguments);
    stage.set_count(record.count);
    stage.set_held(record.held);
    stage.set_needs_approval(record.needs_approval);
    stage.set_asked_by(record.asked_by);
    stage.set_client_id(record.client_id);
    return item;
}

v1::Item to_item(const FiringRecord& record) {
    v1::Item item = item_with(record);
    auto& firing = *item.mutable_timepoint();
    firing.set_timepoint(record.timepoint.value);
    firing.set_name(record.name);
    firing.set_triggered_sclk(record.triggered.seconds);
    firing.set_fired_sclk(record.fired.seconds);
    firing.set_verdict(wire<v1::TimepointFiring::Verdict>(record.verdict));
    firing.set_source(source_of(record.source));
    firing.set_duplicate(record.duplicate);
    return item;
}

v1::Item to_item(const ExplanationRecord& record) {
    v1::Item item = item_with(record);
    auto& said = *item.mutable_explanation();
    said.set_sclk(record.sclk.seconds);
    said.set_text(record.explanation.text);
    said.set_decision(record.explanation.decision);
    said.set_verdict(record.explanation.verdict);
    for (const auto& condition : record.explanation.conditions) {
        auto& written = *said.add_conditions();
        written.set_quantity(condition.quantity);
        written.set_value(condition.value);
        written.set_comparison(condition.comparison);
        written.set_bound(condition.bound);
        written.set_holds(condition.holds);
    }
    said.set_source(source_of(record.source));
    said.set_duplicate(record.duplicate);
    return item;
}

v1::Item to_item(const LinkRecord& record) {
    v1::Item item = item_with(record);
    auto& link = *item.mutable_link();
    link.set_link(record.link);
    link.set_up(record.up);
    link.set_reason(record.reason());
    if (record.silence) link.set_silence(wire<v1::LinkChange::Silence>(*record.silence));
    link.set_lost(record.lost);
    if (record.until) link.set_until_us(record.until->microseconds);
    return item;
}

v1::Item to_item(const AlarmRecord& record) {
    v1::Item item = item_with(record);
    auto& alarm = *item.mutable_alarm();
    alarm.set_channel(record.channel.value);
    alarm.set_severity(wire<v1::Alarm::Severity>(record.severity));
    alarm.set_value(record.value);
    alarm.set_sclk(record.sclk.seconds);
    alarm.set_limit(record.limit);
    return item;
}

v1::Item to_item(const StalenessRecord& record, const dictionary::Dictionary* dictionary) {
    v1::Item item = item_with(record);
    auto& staleness = *item.mutable_staleness();
    if (dictionary != nullptr) staleness.set_packet(dictionary->packets[record.packet].name);
    staleness.set_stale(record.stale);
    staleness.set_missing(record.expected_s > 0.0);
    staleness.set_silent_s(record.silent_s);
    staleness.set_expected_s(record.expected_s);
    staleness.set_reason(record.reason);
    return item;
}

v1::Item to_item(const SituationRecord& record) {
    v1::Item item = item_with(record);
    for (const auto& entry : record.entries) {
        auto& written = *item.mutable_situation()->add_entries();
        written.set_rank(wire<v1::SituationEntry::Rank>(entry.rank));
        written.set_subject(entry.subject);
        written.set_sentence(entry.sentence);
        written.set_evidence(entry.evidence);
        written.set_evidence_seq(entry.evidence_seq);
        written.set_since_us(entry.since.microseconds);
        written.set_awaited(entry.awaited);
        if (entry.at) written.set_at_us(entry.at->microseconds);
        written.set_overdue(entry.overdue);
        written.set_timepoint(entry.timepoint);
    }
    return item;
}

v1::Item to_item(const AlarmActionRecord& record) {
    v1::Item item = item_with(record);
    auto& action = *item.mutable_alarm_action();
    action.set_alarm(record.alarm);
    action.set_action(wire<v1::AlarmAction::Action>(record.action));
    if (record.until > record.ert) action.set_until_us(record.until.microseconds);
    action.set_note(record.note);
    action.set_by(record.by);
    return item;
}

v1::Item to_item(const NoteRecord& record) {
    v1::Item item = item_with(record);
    auto& note = *item.mutable_note();
    note.set_text(record.text);
    note.set_by(record.by);
    note.set_written(record.written);
    if (record.sclk_s) note.set_sclk(*record.sclk_s);
    note.set_call(record.call);
    note.set_position(record.position);
    note.set_reads_back(record.reads_back);
    return item;
}

v1::Item to_item(const ProcedureActRecord& record) {
    v1::Item item = item_with(record);
    auto& act = *item.mutable_procedure_act();
    act.set_number(record.number);
    act.set_kind(wire<v1::ProcedureAct::Kind>(record.kind));
    act.set_procedure(record.procedure);
    act.set_text(record.text);
    act.set_step(record.step);
    act.set_position(record.position);
    act.set_by(record.by);
    act.set_reason(record.reason);
    if (record.choice) act.set_choice(*record.choice);
    act.set_command(record.command);
    return item;
}

v1::Item to_item(const ProcedureStatusRecord& record) {
    v1::Item item = item_with(record);
    auto& status = *item.mutable_procedure();
    if (auto whole = unpacked_status(record.status)) {
        status = std::move(*whole);
        return item;
    }
    status.set_number(record.number);
    status.set_procedure(record.procedure);
    status.set_title(fmt::format("the status of procedure {} cannot be read: its octets in the archive are damaged",
                                 record.procedure));
    status.set_held(record.held);
    return item;
}

v1::Item to_item(const PositionActRecord& record) {
    v1::Item item = item_with(record);
    auto& act = *item.mutable_position_act();
    act.set_kind(wire<v1::PositionAct::Kind>(record.kind));
    act.set_position(record.position);
    act.set_by(record.by);
    act.set_to(record.to);
    act.set_subject(record.subject);
    act.set_reason(record.reason);
    if (!act.mutable_board()->ParseFromArray(record.board.data(), static_cast<int>(record.board.size()))) {
        act.mutable_board()->Clear();
        act.mutable_board()->set_closed(
            "how the room stands cannot be read: its octets in the archive are damaged; see the acts");
    }
    return item;
}

std::vector<std::uint8_t> octets_of_hex(std::string_view hex) {
    std::vector<std::uint8_t> octets;
    const auto digit = [](char c) { return static_cast<unsigned>(c <= '9' ? c - '0' : c - 'a' + 10); };
    for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
        octets.push_back(static_cast<std::uint8_t>(digit(hex[i]) << 4U | digit(hex[i + 1])));
    return octets;
}

v1::ClockReply to_reply(const ClockCorrelation& clock) {
    v1::ClockReply reply;
    reply.set_version(clock.version);
    reply.set_sclk(clock.sclk.seconds);
    reply.set_scet_us(clock.scet.microseconds);
    reply.set_rate(clock.rate);
    reply.set_leap_seconds(clock.leap_seconds);
    return reply;
}

v1::ForkOrigin to_reply(const ForkPoint& fork) {
    v1::ForkOrigin reply;
    reply.set_run(fork.run.value);
    reply.set_e_s(fork.e_s);
    reply.set_seed(fork.seed);
    return reply;
}

ClockCorrelation correlation_of(const v1::RunState& run) {
    const auto& clock = run.clock();
    return {Sclk{clock.sclk()}, Scet{clock.scet_us()}, clock.rate(), clock.leap_seconds(), clock.version()};
}

Ert ert_of(const v1::RunState& run, Sclk at) {
    const auto clock = correlation_of(run);
    const double since_s = (at - clock.sclk) * clock.rate + run.light_time_s();
    if (since_s > ert_span_s) return {std::numeric_limits<std::int64_t>::max()};
    if (since_s < -ert_span_s) return {std::numeric_limits<std::int64_t>::min()};
    return {clock.scet_of(at).microseconds + static_cast<std::int64_t>(run.light_time_s() * 1.0e6)};
}

Sclk sclk_at_ert(const v1::RunState& run, Ert ert) {
    return correlation_of(run).sclk_of(Scet{ert.microseconds - static_cast<std::int64_t>(run.light_time_s() * 1.0e6)});
}

}  // namespace aeolis::archive
