// SPDX-License-Identifier: Apache-2.0
#include "server/pipeline/packet_intake.hpp"

#include "common/space_packet.hpp"
#include "telemetry/explanation.hpp"
#include "telemetry/proof.hpp"
#include "telemetry/text.hpp"

#include <algorithm>
#include <cmath>

namespace aeolis::pipeline {

using archive::Batch;
using archive::PacketRecord;
using archive::Source;
using telemetry::Standing;

PacketIntake::PacketIntake(const dictionary::Dictionary& dictionary, const archive::PacketColumns& columns,
                           const telemetry::OtherMission* other)
    : dictionary_(dictionary), columns_(columns), firing_(find_firing_fields(dictionary)), other_(other),
      decoder_(dictionary, other), alarms_(dictionary), segments_(columns), latest_(dictionary.channels.size()),
      clocks_(other == nullptr ? 0 : dictionary.packets.size()) {
    const auto* phase = dictionary.channel("edl_phase");  // null: not in this mission
    const auto tells_phase = [&](const dictionary::Field& field) {
        return phase != nullptr &&
               (field.channel == phase->id || (!phase->type.name.empty() && field.type.name == phase->type.name));
    };
    for (const auto& packet : dictionary.packets) {
        const auto field = std::ranges::find_if(packet.fields, tells_phase);
        phase_field_.push_back(field == packet.fields.end()
                                   ? std::nullopt
                                   : std::optional(static_cast<std::size_t>(field - packet.fields.begin())));
    }
}

void PacketIntake::note_phase(const PacketRecord& record, const telemetry::Decoded& content) {
    const auto field = phase_field_[*record.packet];
    if (!field || record.source != Source::realtime || record.sclk < phase_sclk_ || !content.value[*field]) return;
    phase_ = telemetry::value_text(dictionary_.packets[*record.packet].fields[*field].type, content.value[*field]);
    phase_sclk_ = record.sclk;
}

std::optional<PacketIntake::FiringFields> PacketIntake::find_firing_fields(const dictionary::Dictionary& dictionary) {
    const auto* packet = dictionary.packet("TimepointFired");
    if (packet == nullptr) return {};
    const auto timepoint = telemetry::field_index(*packet, "timepoint");
    const auto triggered = telemetry::field_index(*packet, "triggered_sclk");
    const auto fired = telemetry::field_index(*packet, "fired_sclk");
    const auto verdict = telemetry::field_index(*packet, "verdict");
    if (!timepoint || !triggered || !fired || !verdict) return {};
    return FiringFields{static_cast<std::size_t>(packet - dictionary.packets.data()), *timepoint, *triggered, *fired,
                        *verdict};
}

void PacketIntake::take(const telemetry::ReceivedPacket& packet, Numbering& numbering, Batch& batch) {
    const bool recorded = packet.link.recorded;
    remark_.clear();
    PacketRecord record;
    record.seq = numbering.next(batch);
    record.ert = packet.ert;
    record.link = packet.link.name;
    record.source = recorded ? Source::recorded : Source::realtime;
    record.octets = {batch.octets.size(), packet.octets.size()};
    batch.octets.insert(batch.octets.end(), packet.octets.begin(), packet.octets.end());
    if (recorded) recorded_octets_ += packet.octets.size();

    const bool has_apid = other_ != nullptr ? packet.octets.size() >= primary_header_octets
                                            : read_primary_header(packet.octets).has_value();
    if (has_apid) record.apid = Apid{static_cast<std::uint16_t>((packet.octets[0] & 7U) << 8U | packet.octets[1])};
    if (other_ != nullptr) {
        ++of_others_;
        record.standing = Standing::unregistered;
    }
    const bool of_station = other_ == nullptr && packet.link == telemetry::station_link;
    const auto& decoded = this->decoded(packet);
    const auto& content = decoded.content;
    record.refusal = decoded.refusal;
    if (record.refusal.empty() && other_ == nullptr && is_made_on_ground(record.apid) != of_station)
        record.refusal = of_station ? "not_of_the_station" : "made_on_ground";
    if (!record.refusal.empty()) {
        ++not_decoded_;
        if (other_ != nullptr)
            tell_once("a packet of APID " + std::to_string(record.apid.value) + " is not decoded: " + record.refusal);
        batch.packets.push_back(std::move(record));
        return;
    }
    record.packet = static_cast<std::uint16_t>(content.packet);
    record.sclk = content.header.time;
    if (other_ != nullptr) {
        const auto own = content.timed ? std::optional{content.header.time} : std::nullopt;
        auto place = clocks_.place(content.packet, dictionary_.packets[content.packet].name, own, packet.ert);
        record.sclk = place.sclk;
        remark_ = std::move(place.remark).value_or("");
        if (!content.problem.empty()) {
            ++not_decoded_;
            record.refusal = content.problem;
            tell_once("a packet " + dictionary_.packets[content.packet].name +
                      " is not decoded to its end: " + content.problem);
        }
    }
    if (of_station) record.standing = Standing::unregistered;
    if (other_ == nullptr && !of_station)
        record.standing =
            register_.add(packet.octets, recorded ? telemetry::Path::recorded : telemetry::Path::realtime);
    const bool fresh = record.standing == Standing::first || record.standing == Standing::unregistered;
    record.sampled = fresh && !columns_.channels(content.packet).empty();
    batch.packets.push_back(record);
    if (record.standing == Standing::again) return;
    note_phase(record, content);
    if (record.sampled) sample(record, content, numbering, batch);
    if (other_ == nullptr) interpret(record, decoded, numbering, batch);
}

void PacketIntake::tell_once(const std::string& words) {
    if (told_.size() == told_max || !told_.insert(words).second) return;
    remark_ += (remark_.empty() ? "" : "; ") + words;
}

const telemetry::DecodedPacket& PacketIntake::decoded(const telemetry::ReceivedPacket& packet) {
    if (packet.decoded) return *packet.decoded;
    decoder_.decode(packet.octets, decoded_);
    return decoded_;
}

void PacketIntake::sample(const PacketRecord& record, const telemetry::Decoded& content, Numbering& numbering,
                          Batch& batch) {
    const std::size_t first = batch.values.size();
    columns_.append_values(content, batch.values);
    const auto values = std::span<const double>(batch.values).subspan(first);
    batch.samples.push_back({{numbering.next(batch), record.ert},
                             *record.packet,
                             record.sclk,
                             record.source,
                             {first, batch.values.size() - first},
                             columns_.texts(content),
                             !content.timed});
    segments_.add(*record.packet, record.source, record.seq, record.sclk, values, batch);
    if (record.source == Source::realtime) judge(record, values, numbering, batch);
}

void PacketIntake::judge(const PacketRecord& record, std::span<const double> values, Numbering& numbering,
                         Batch& batch) {
    const auto& channels = columns_.channels(*record.packet);
    changes_.clear();
    for (std::size_t i = 0; i < channels.size(); ++i) {
        auto& latest = latest_[channels[i].value];
        // Our clock never goes back: an earlier time is late, from an orbiter's memory.
        if (other_ == nullptr && latest && latest->sclk > record.sclk) continue;
        latest = LatestValue{std::isnan(values[i]) ? std::nullopt : std::optional(values[i]), record.sclk, record.ert};
        if (latest->value) alarms_.sample(channels[i], values[i], record.sclk, changes_);
    }
    for (const auto& change : changes_)
        batch.alarms.push_back({{numbering.next(batch), record.ert},
                                record.seq,
                                change.channel,
                                change.severity,
                                change.value,
                                change.sclk,
                                change.limit});
}

void PacketIntake::interpret(const PacketRecord& record, const telemetry::DecodedPacket& decoded, Numbering& numbering,
                             Batch& batch) const {
    const auto& content = decoded.content;
    if (const auto* event = decoded.event) {
        batch.events.push_back({{numbering.next(batch), record.ert},
                                record.seq,
                                event->id,
                                event->name,
                                event->level,
                                decoded.text,
                                record.sclk,
                                record.source,
                                record.duplicate()});
    }
    if (firing_ && firing_->packet == content.packet) {
        const auto value = [&](std::size_t field) { return content.value[field].value_or(0.0); };
        const auto& fields = dictionary_.packets[content.packet].fields;
        const auto index = static_cast<std::size_t>(value(firing_->timepoint));
        batch.firings.push_back({{numbering.next(batch), record.ert},
                                 record.seq,
                                 TimepointId{static_cast<std::uint16_t>(index)},
                                 index < dictionary_.timeline.size() ? dictionary_.timeline[index].name : std::string(),
                                 telemetry::value_text(fields[firing_->verdict].type, content.value[firing_->verdict]),
                                 Sclk{value(firing_->triggered)},
                                 Sclk{value(firing_->fired)},
                                 record.source,
                                 record.duplicate()});
    }
    if (auto explanation = telemetry::explain(dictionary_, content))
        batch.explanations.push_back({{numbering.next(batch), record.ert},
                                      record.seq,
                                      record.sclk,
                                      std::move(*explanation),
                                      record.source,
                                      record.duplicate()});
}

archive::RecordingTotals PacketIntake::totals() const {
    const auto proof = telemetry::prove(register_);
    archive::RecordingTotals totals;
    totals.recorded = proof.recorded;
    totals.recorded_octets = recorded_octets_;
    totals.realtime = proof.realtime + of_others_;
    totals.realtime_not_recorded = proof.realtime_not_recorded;
    totals.realtime_differs = proof.realtime_differs;
    totals.never_seen_live = proof.never_seen_live;
    totals.not_decoded = not_decoded_;
    return totals;
}

}  // namespace aeolis::pipeline
