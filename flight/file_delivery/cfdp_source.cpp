// SPDX-License-Identifier: Apache-2.0
#include "flight/file_delivery/cfdp_source.hpp"

#include <algorithm>
#include <variant>

namespace aeolis::flight {

CfdpSource::CfdpSource(const File& file, std::string_view name) : file_(file) {
    AEOLIS_CHECK(file.segment_octets > 0);
    name_.append(name);
}

std::size_t CfdpSource::pdu_octets_max() const {
    const std::size_t data = 4 + std::size_t{file_.segment_octets};
    const std::size_t metadata = 8 + 2 * name_.size();
    return cfdp::written_header_octets + std::max(data, metadata);
}

std::uint32_t CfdpSource::to_repeat_octets() const {
    std::uint32_t sum = 0;
    for (const cfdp::Range& range : again_) sum += range.octets();
    return sum;
}

void CfdpSource::on(const cfdp::Pdu& pdu) {
    const cfdp::Header& header = pdu.header;
    if (!header.toward_sender || header.source != file_.source || header.sequence != file_.sequence ||
        header.destination != file_.destination)
        return;
    if (const auto* nak = std::get_if<cfdp::Nak>(&pdu.content)) {
        for (const cfdp::Range& range : nak->requests) send_again(range);
    } else if (const auto* ack = std::get_if<cfdp::Ack>(&pdu.content)) {
        if (ack->of == cfdp::Directive::eof) {
            eof_acknowledged_ = true;
            eof_due_ = false;
        }
    } else if (const auto* finished = std::get_if<cfdp::Finished>(&pdu.content)) {
        finished_ = true;
        finished_ack_due_ = true;
        delivered_ = finished->condition == cfdp::Condition::no_error && finished->complete;
    }
}

void CfdpSource::send_again(const cfdp::Range& asked) {
    if (asked == cfdp::Range{0, 0}) {
        metadata_due_ = true;
        return;
    }
    // Octets that were not sent yet will be sent anyway.
    const cfdp::Range range{asked.start, std::min(asked.end, sent_octets_)};
    const auto holds = [&](const cfdp::Range& each) { return each.start <= range.start && range.end <= each.end; };
    if (range.start >= range.end || std::any_of(again_.begin(), again_.end(), holds)) return;
    static_cast<void>(again_.try_push_back(range));
}

std::size_t CfdpSource::put(const cfdp::Content& content, std::span<std::uint8_t> into) const {
    return cfdp::write(
        {{.source = file_.source, .sequence = file_.sequence, .destination = file_.destination}, content}, into);
}

std::size_t CfdpSource::next(std::span<const std::uint8_t> file, std::span<std::uint8_t> into) {
    AEOLIS_CHECK(file.size() >= file_.octets && into.size() >= pdu_octets_max());
    if (finished_) {
        if (!finished_ack_due_) return 0;
        finished_ack_due_ = false;
        return put(cfdp::Ack{cfdp::Directive::finished, cfdp::Condition::no_error, 2}, into);
    }
    if (metadata_due_) {
        metadata_due_ = false;
        const std::string_view name{name_.begin(), name_.size()};
        return put(cfdp::Metadata{.file_octets = file_.octets, .source_name = name, .destination_name = name}, into);
    }
    if (!again_.empty()) return put_repeated(file, into);
    if (sent_octets_ < file_.octets) return put_first_time(file, into);
    if (!eof_due_ || eof_acknowledged_) return 0;
    eof_due_ = false;
    return put(cfdp::Eof{.checksum = checksum_, .file_octets = file_.octets}, into);
}

std::size_t CfdpSource::put_repeated(std::span<const std::uint8_t> file, std::span<std::uint8_t> into) {
    cfdp::Range& first = again_[0];
    const std::uint32_t start = first.start;
    const std::uint32_t now = std::min<std::uint32_t>(file_.segment_octets, first.octets());
    first.start += now;
    if (first.start == first.end) again_.erase_at(0);
    return put(cfdp::FileData{start, file.subspan(start, now)}, into);
}

std::size_t CfdpSource::put_first_time(std::span<const std::uint8_t> file, std::span<std::uint8_t> into) {
    const std::uint32_t start = sent_octets_;
    const auto part = file.subspan(start, std::min<std::uint32_t>(file_.segment_octets, file_.octets - start));
    checksum_ += cfdp::modular_checksum(start, part);
    sent_octets_ += static_cast<std::uint32_t>(part.size());
    return put(cfdp::FileData{start, part}, into);
}

void CfdpSource::repeat() {
    if (!finished_ && !eof_acknowledged_ && sent_octets_ == file_.octets) eof_due_ = true;
}

}  // namespace aeolis::flight
