// SPDX-License-Identifier: Apache-2.0
#include "flight/file_delivery/recording_delivery.hpp"

#include "common/proximity_frame.hpp"
#include "common/space_packet.hpp"

#include <algorithm>
#include <charconv>
#include <limits>
#include <string_view>
#include <variant>

namespace aeolis::flight {
namespace {

constexpr std::string_view name_of_files = "recording/";
constexpr std::size_t pdu_octets_max = proximity_data_octets_max - primary_header_octets;

/// Name of a file: "recording/17"; of the last one "recording/18.last".
FixedVector<char, CfdpSource::name_octets_max> file_name(std::uint32_t number, bool last) {
    FixedVector<char, CfdpSource::name_octets_max> name;
    name.append(name_of_files);
    std::array<char, std::numeric_limits<std::uint32_t>::digits10 + 1> digits{};
    const auto end = std::to_chars(digits.begin(), digits.end(), number).ptr;
    name.append(std::string_view{digits.data(), static_cast<std::size_t>(end - digits.data())});
    if (last) name.append(cfdp::last_file_ending);
    return name;
}

}  // namespace

void RecordingDelivery::on(std::span<const std::uint8_t> pltu) {
    const auto frame = read_pltu(pltu);
    if (!frame) return;
    const auto header = read_primary_header(frame->data);
    if (!header || header->apid != file_delivery_apid || header->packet_octets() != frame->data.size()) return;
    const auto pdu = cfdp::read(frame->data.subspan(primary_header_octets));
    if (!pdu) return;
    bool open = false;
    for (auto& file : open_) {
        if (!file || file->number != pdu->header.sequence) continue;
        file->source.on(*pdu);
        open = true;
    }
    const bool ended = pdu->header.toward_sender && std::holds_alternative<cfdp::Finished>(pdu->content);
    if (ended && !open)
        static_cast<void>(ends_to_acknowledge_.try_push_back(static_cast<std::uint32_t>(pdu->header.sequence)));
}

bool RecordingDelivery::any_open() const {
    return std::any_of(open_.begin(), open_.end(), [](const auto& file) { return file.has_value(); });
}

bool RecordingDelivery::waits_for_answers() const {
    return any_open();
}

void RecordingDelivery::repeat() {
    for (auto& file : open_)
        if (file) file->source.repeat();
}

std::size_t RecordingDelivery::next(const Recording& recording, std::span<std::uint8_t> into) {
    AEOLIS_CHECK(into.size() >= pltu_octets_max);
    std::array<std::uint8_t, pdu_octets_max> pdu{};
    std::size_t size = next_acknowledgement(pdu);
    if (size == 0) size = next_of_open(recording, pdu);
    if (size == 0 && begin_next(recording)) size = next_of_open(recording, pdu);
    return size == 0 ? 0 : wrapped(std::span{pdu}.first(size), into);
}

std::size_t RecordingDelivery::next_of_open(const Recording& recording, std::span<std::uint8_t> pdu) {
    std::size_t size = 0;
    for (auto& file : open_) {
        if (!file) continue;
        if (size == 0) size = file->source.next(recording.octets.subspan(file->start, file->octets), pdu);
        if (!file->source.done()) continue;
        if (file->source.delivered())
            file.reset();
        else
            file->source = source_of(file->number, file->octets, file->last);
    }
    return size;
}

CfdpSource RecordingDelivery::source_of(std::uint32_t number, std::uint32_t octets, bool last) {
    const auto name = file_name(number, last);
    return CfdpSource{{.source = spacecraft_id, .destination = ground_entity, .sequence = number, .octets = octets},
                      std::string_view{name.begin(), name.size()}};
}

std::size_t RecordingDelivery::next_acknowledgement(std::span<std::uint8_t> pdu) {
    if (ends_to_acknowledge_.empty()) return 0;
    const std::uint32_t file = ends_to_acknowledge_.back();
    ends_to_acknowledge_.pop_back();
    return cfdp::write({{.source = spacecraft_id, .sequence = file, .destination = ground_entity},
                        cfdp::Ack{cfdp::Directive::finished, cfdp::Condition::no_error, 2}},
                       pdu);
}

bool RecordingDelivery::begin_next(const Recording& recording) {
    const auto place = std::find_if(open_.begin(), open_.end(), [](const auto& file) { return !file; });
    if (place == open_.end()) return false;
    while (scanned_ - next_start_ < file_octets) {
        const auto packet = space_packet_octets(recording.octets.subspan(scanned_));
        if (!packet || *packet > recording.octets.size() - scanned_) break;
        scanned_ += static_cast<std::uint32_t>(*packet);
    }
    const std::uint32_t octets = scanned_ - next_start_;
    if (last_begun_ || (octets < file_octets && !recording.closed)) return false;
    last_begun_ = octets < file_octets;
    ++files_;
    place->emplace(OpenFile{files_, next_start_, octets, last_begun_, source_of(files_, octets, last_begun_)});
    next_start_ = scanned_;
    return true;
}

// Marked as sequence controlled, so that ground counts these frames separately; CFDP retransmits lost data.
std::size_t RecordingDelivery::wrapped(std::span<const std::uint8_t> pdu, std::span<std::uint8_t> into) {
    std::array<std::uint8_t, proximity_data_octets_max> packet{};
    const std::size_t size = primary_header_octets + pdu.size();
    write_primary_header({.secondary_header = false,
                          .apid = file_delivery_apid,
                          .count = packet_count_,
                          .length = static_cast<std::uint16_t>(pdu.size() - 1)},
                         packet);
    packet_count_ = (packet_count_ + 1) & packet_count_mask;
    std::copy(pdu.begin(), pdu.end(), packet.begin() + primary_header_octets);
    return write_pltu({.expedited = false, .spacecraft = spacecraft_id, .sequence = frame_sequence_++},
                      std::span{packet}.first(size), into);
}

}  // namespace aeolis::flight
