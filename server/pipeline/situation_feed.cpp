// SPDX-License-Identifier: Apache-2.0
#include "server/pipeline/situation_feed.hpp"

#include "server/archive/packet_columns.hpp"
#include "server/pipeline/new_records.hpp"

#include <algorithm>
#include <cmath>

namespace aeolis::pipeline {
namespace {

using telemetry::SituationMonitor;

SituationMonitor::Clocks clocks_of(const archive::RunStart& start) {
    const bool known = start.entry != Sclk{};  // of another mission nobody knows when it enters
    return {known ? std::optional(start.entry) : std::nullopt, start.correlation, start.light_time_s};
}

SituationMonitor::Origin origin_of(const archive::ItemRecord& record,
                                   archive::Source source = archive::Source::realtime) {
    return {record.seq, record.ert, source == archive::Source::recorded};
}

}  // namespace

SituationFeed::SituationFeed(const dictionary::Dictionary& dictionary, const archive::RunStart& start)
    : monitor_(dictionary, clocks_of(start)),
      // Another mission may have a packet of this name, but no model of ours.
      expects_(dictionary.model ? dictionary.packet("ShadowExpects") : nullptr) {
    if (expects_ != nullptr) decommutator_.emplace(dictionary);
    const archive::PacketColumns columns{dictionary};
    for (std::size_t packet = 0; packet < columns.packets(); ++packet) {
        TouchdownColumns found;
        const auto& channels = columns.channels(packet);
        for (std::size_t column = 0; column < channels.size(); ++column) {
            const std::string_view name = dictionary.channels[channels[column].value].name;
            if (name == telemetry::touchdown_flag) found.flag = column;
            if (name == telemetry::rover_rate_channel) found.rover_rate = column;
            if (name == telemetry::rover_force_channel) found.rover_force = column;
            if (name == telemetry::touchdown_live) found.live = column;
        }
        if (found.flag || found.rover_rate || found.live)
            touchdown_columns_.emplace(static_cast<std::uint16_t>(packet), found);
    }
}

void SituationFeed::give_expected(const archive::Batch& batch, const archive::PacketRecord& packet) {
    const auto octets = std::span{batch.octets}.subspan(packet.octets.first, packet.octets.count);
    if (decommutator_->decode(octets, decoded_)) return;
    const auto value = [&](std::string_view name) {
        const auto field = telemetry::field_index(*expects_, name);
        return field ? decoded_.value[*field].value_or(0.0) : 0.0;
    };
    const TimepointId timepoint{static_cast<std::uint16_t>(value("expected_timepoint"))};
    if (value("expected_cases") == 0.0) return monitor_.expected(timepoint, std::nullopt);
    const double e_s = value("expected_after_entry_s");
    monitor_.expected(timepoint, SituationMonitor::ExpectedStep{
                                     e_s, value("expected_interval_defined") != 0.0 ? value("expected_to_s") : e_s});
}

void SituationFeed::give_touchdown(const archive::Batch& batch, const archive::SampleRecord& sample) {
    if (sample.source != archive::Source::realtime) return;
    const auto of_packet = touchdown_columns_.find(sample.packet);
    if (of_packet == touchdown_columns_.end()) return;
    const auto value = [&](std::optional<std::size_t> column) {
        if (!column || *column >= sample.values.count) return std::optional<double>{};
        const double told = batch.values[sample.values.first + *column];
        return std::isnan(told) ? std::optional<double>{} : std::optional{told};
    };
    const TouchdownColumns& at = of_packet->second;
    monitor_.touchdown(
        {sample.sclk, value(at.flag), value(at.rover_rate), value(at.rover_force), value(at.live).has_value()},
        origin_of(sample));
}

void SituationFeed::follow(const archive::Batch& batch) {
    if (batch.last_seq <= followed_) return;
    each_new(batch.links, followed_, [&](const archive::LinkRecord& link) {
        monitor_.link({{link.link, false}, link.ert, link.up, link.words, link.lost, link.until, link.silence},
                      origin_of(link));
    });
    each_new(batch.packets, followed_, [&](const archive::PacketRecord& packet) {
        const bool of_station = packet.link == telemetry::station_link.name;
        if (of_station && packet.packet && expects_ != nullptr && packet.apid == expects_->apid)
            give_expected(batch, packet);
        if (!packet.packet || packet.source != archive::Source::realtime || of_station) return;
        const bool at_once = packet.link == telemetry::uhf_live_link.name ||
                             packet.link == telemetry::x_band_telemetry_link.name ||
                             packet.link == telemetry::downlink_link.name;
        monitor_.heard(packet.sclk, at_once ? std::optional{packet.ert} : std::nullopt);
    });
    each_new(batch.events, followed_, [&](const archive::EventRecord& event) {
        monitor_.event({event.name, event.text, event.level, event.sclk}, origin_of(event, event.source));
    });
    each_new(batch.firings, followed_, [&](const archive::FiringRecord& firing) {
        monitor_.fired(firing.timepoint, firing.triggered, firing.fired, origin_of(firing, firing.source));
    });
    each_new(batch.samples, followed_, [&](const archive::SampleRecord& sample) { give_touchdown(batch, sample); });
    each_new(batch.explanations, followed_, [&](const archive::ExplanationRecord& explanation) {
        monitor_.explained(explanation.explanation, origin_of(explanation, explanation.source));
    });
    each_new(batch.alarms, followed_, [&](const archive::AlarmRecord& alarm) {
        monitor_.alarm(alarm.channel, alarm.severity, alarm.limit, alarm.sclk, origin_of(alarm));
    });
    each_new(batch.tones, followed_, [&](const archive::ToneRecord& tone) {
        if (tone.tone) monitor_.tone(*tone.tone, tone.likelihood, tone.sclk, origin_of(tone));
    });
    each_new(batch.stages, followed_, [&](const archive::StageRecord& stage) {
        const bool executed = stage.stage == commands::Stage::executed || stage.stage == commands::Stage::verified;
        monitor_.stage({stage.command, stage.name, stage.evidence, stage.status == commands::Status::failed,
                        executed && stage.status == commands::Status::ok},
                       origin_of(stage));
    });
    followed_ = batch.last_seq;
}

std::optional<archive::SituationRecord> SituationFeed::changed(Ert now) {
    now_ = now;
    auto entries = monitor_.at(now);
    if (entries == told_) return {};
    told_ = entries;
    archive::SituationRecord record;
    record.ert = now;
    record.sentence = entries.front().sentence;
    record.entries = std::move(entries);
    return record;
}

}  // namespace aeolis::pipeline
