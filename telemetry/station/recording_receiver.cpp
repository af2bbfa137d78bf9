// SPDX-License-Identifier: Apache-2.0
#include "telemetry/station/recording_receiver.hpp"

#include "common/ids.hpp"
#include "common/proximity_frame.hpp"
#include "common/space_packet.hpp"

#include <algorithm>
#include <variant>

namespace aeolis::telemetry {
namespace {

constexpr double answer_margin_s = 30.0;

using Outcome = Reception::Outcome;

bool ended(const Reception& reception) {
    return reception.outcome != Outcome::under_way && reception.outcome_acknowledged;
}

}  // namespace

RecordingReceiver::File* RecordingReceiver::file_of(const cfdp::Header& header) {
    const auto known = files_.find({header.source, header.sequence});
    if (known != files_.end()) return &known->second;
    auto reception = reception_of(header);
    if (!reception || files_.size() >= files_max) return nullptr;
    if (files_under_way() >= files_under_way_max) forget_the_most_silent();
    return &files_.emplace(FileName{header.source, header.sequence}, File{CfdpReceiver{std::move(*reception)}})
                .first->second;
}

void RecordingReceiver::forget_the_most_silent() {
    auto silent = files_.end();
    for (auto file = files_.begin(); file != files_.end(); ++file) {
        const bool under_way = file->second.receiver.state().outcome == Outcome::under_way;
        if (under_way && (silent == files_.end() || file->second.heard < silent->second.heard)) silent = file;
    }
    if (silent != files_.end()) files_.erase(silent);
}

std::uint64_t RecordingReceiver::refused() const {
    std::uint64_t refused = refused_;
    for (const auto& [name, file] : files_) refused += file.receiver.refused();
    return refused;
}

/// Whether a PDU is plausible: memory grows with the octets that it claims, so excessive claims are refused.
bool RecordingReceiver::fits(const cfdp::Pdu& pdu) {
    const cfdp::Header& header = pdu.header;
    if (header.source != spacecraft_id || header.destination != ground_entity || header.sequence == 0 ||
        header.sequence > files_max)
        return false;
    if (const auto* data = std::get_if<cfdp::FileData>(&pdu.content))
        return data->offset <= file_octets_max && data->octets.size() <= file_octets_max - data->offset;
    if (const auto* metadata = std::get_if<cfdp::Metadata>(&pdu.content))
        return metadata->file_octets <= file_octets_max;
    const auto* eof = std::get_if<cfdp::Eof>(&pdu.content);
    return eof == nullptr || eof->file_octets <= file_octets_max;
}

void RecordingReceiver::receive(std::span<const std::uint8_t> octets, Ert now, const OnFile& on_file) {
    const auto pdu = cfdp::read(octets);
    File* file = pdu && fits(*pdu) ? file_of(pdu->header) : nullptr;
    if (file == nullptr) {
        ++refused_;
        return;
    }
    heard_ = file->heard = now;
    for (const auto& write : file->receiver.on(*pdu)) {
        const std::size_t end = write.offset + write.octets.size();
        if (file->octets.size() < end) file->octets.resize(end);
        std::ranges::copy(write.octets, file->octets.begin() + write.offset);
    }
    // A repeated end of file shows that the answer to the first was lost.
    if (std::holds_alternative<cfdp::Eof>(pdu->content)) file->receiver.ask();
    answer(*file);
    if (file->receiver.state().outcome == Outcome::complete && !std::exchange(file->given_out, true)) {
        on_file(file->octets);
        file->octets = {};
    }
    const Outcome outcome = file->receiver.state().outcome;
    if (outcome != Outcome::complete && outcome != Outcome::under_way) {
        refused_ += file->receiver.refused() + 1;
        files_.erase({pdu->header.source, pdu->header.sequence});
    }
}

void RecordingReceiver::pass(Ert now, bool bent_pipe_up) {
    const std::int64_t overdue_us = static_cast<std::int64_t>((2.0 * light_time_s_ + answer_margin_s) * 1.0e6);
    const Ert last = std::max(heard_, asked_at_);
    const bool may_ask = bent_pipe_up || heard_ > asked_at_;
    if (files_.empty() || !may_ask || now.microseconds - last.microseconds < overdue_us) return;
    asked_at_ = now;
    for (auto& [name, file] : files_) {
        if (ended(file.receiver.state())) continue;
        file.receiver.ask();
        answer(file);
    }
}

void RecordingReceiver::answer(File& file) {
    while (const auto pdu = file.receiver.next()) {
        const auto content = cfdp::read(*pdu);
        if (content && std::holds_alternative<cfdp::Nak>(content->content)) ++asked_;
        std::vector<std::uint8_t> packet(primary_header_octets + pdu->size());
        write_primary_header({.telecommand = true,
                              .secondary_header = false,
                              .apid = file_delivery_apid,
                              .count = packet_count_,
                              .length = static_cast<std::uint16_t>(pdu->size() - 1)},
                             packet);
        packet_count_ = (packet_count_ + 1) & 0x3FFF;
        std::ranges::copy(*pdu, packet.begin() + primary_header_octets);
        auto& pltu = pltus_.emplace_back(pltu_octets_max);
        pltu.resize(write_pltu(
            {.expedited = false, .spacecraft = spacecraft_id, .to_spacecraft = true, .sequence = frame_sequence_++},
            packet, pltu));
    }
}

std::uint64_t RecordingReceiver::received_octets() const {
    std::uint64_t octets = 0;
    for (const auto& [name, file] : files_) octets += telemetry::received_octets(file.receiver.state());
    return octets;
}

bool RecordingReceiver::whole() const {
    const auto last = std::ranges::find_if(files_, [](const auto& each) {
        const Reception& file = each.second.receiver.state();
        return file.outcome == Outcome::complete && file.source_name.ends_with(cfdp::last_file_ending);
    });
    // All have one source and are numbered from 1.
    return last != files_.end() && files_under_way() == 0 && last->first.second == files_.size();
}

std::size_t RecordingReceiver::files_whole() const {
    return static_cast<std::size_t>(std::ranges::count_if(
        files_, [](const auto& each) { return each.second.receiver.state().outcome == Outcome::complete; }));
}

}  // namespace aeolis::telemetry
