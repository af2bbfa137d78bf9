// SPDX-License-Identifier: Apache-2.0
#include "telemetry/cfdp_receiver.hpp"

#include <algorithm>
#include <variant>

namespace aeolis::telemetry {
namespace {

using cfdp::Range;
using Outcome = Reception::Outcome;

/// The first range that ends at `offset` or after it.
auto first_touching(std::vector<Range>& ranges, std::uint32_t offset) {
    return std::ranges::lower_bound(ranges, offset, {}, &Range::end);
}

/// The parts of `wanted` that are in none of `ranges`.
std::vector<Range> missing_in(const std::vector<Range>& ranges, const Range& wanted) {
    std::vector<Range> missing;
    std::uint32_t at = wanted.start;
    const auto first = std::ranges::upper_bound(ranges, at, {}, &Range::end);
    for (auto range = first; range != ranges.end() && range->start < wanted.end; ++range) {
        if (range->start > at) missing.push_back({at, range->start});
        at = range->end;
    }
    if (at < wanted.end) missing.push_back({at, wanted.end});
    return missing;
}

cfdp::Condition condition_of(Outcome outcome) {
    switch (outcome) {
    case Outcome::wrong_checksum: return cfdp::Condition::file_checksum_failure;
    case Outcome::wrong_size: return cfdp::Condition::file_size_error;
    case Outcome::cancelled: return cfdp::Condition::cancel_received;
    case Outcome::under_way:
    case Outcome::complete: break;
    }
    return cfdp::Condition::no_error;
}

}  // namespace

std::optional<Reception> reception_of(const cfdp::Header& header) {
    if (header.toward_sender || header.unacknowledged || header.source > 0xFFFF || header.destination > 0xFFFF ||
        header.sequence > 0xFFFFFFFF)
        return std::nullopt;
    Reception reception;
    reception.source = header.source;
    reception.sequence = header.sequence;
    reception.destination = header.destination;
    return reception;
}

std::uint64_t received_octets(const Reception& reception) {
    std::uint64_t sum = 0;
    for (const Range& range : reception.received) sum += range.octets();
    return sum;
}

std::vector<CfdpReceiver::Write> CfdpReceiver::on(const cfdp::Pdu& pdu) {
    const cfdp::Header& header = pdu.header;
    if (header.toward_sender || header.unacknowledged || header.source != state_.source ||
        header.sequence != state_.sequence || header.destination != state_.destination) {
        ++refused_;
        return {};
    }
    if (const auto* data = std::get_if<cfdp::FileData>(&pdu.content)) return take(*data);
    if (const auto* metadata = std::get_if<cfdp::Metadata>(&pdu.content))
        take(*metadata);
    else if (const auto* eof = std::get_if<cfdp::Eof>(&pdu.content))
        take(*eof);
    else if (const auto* ack = std::get_if<cfdp::Ack>(&pdu.content))
        state_.outcome_acknowledged |= ack->of == cfdp::Directive::finished && state_.outcome != Outcome::under_way;
    else if (std::holds_alternative<cfdp::Prompt>(pdu.content))
        ask();
    else
        ++refused_;
    return {};
}

std::vector<CfdpReceiver::Write> CfdpReceiver::take(const cfdp::FileData& data) {
    if (state_.outcome != Outcome::under_way || data.octets.empty()) return {};
    const std::uint64_t end = data.offset + std::uint64_t{data.octets.size()};
    const std::uint64_t most = state_.eof ? state_.eof->file_octets : state_.file_octets.value_or(file_octets_max);
    if (end > std::min<std::uint64_t>(most, file_octets_max)) {
        ++refused_;
        return {};
    }
    const Range whole{data.offset, static_cast<std::uint32_t>(end)};
    const auto missing = missing_in(state_.received, whole);
    if (missing.empty() || !insert(whole)) return {};
    std::vector<Write> writes;
    for (const Range& part : missing) {
        const auto octets = data.octets.subspan(part.start - data.offset, part.octets());
        state_.checksum += cfdp::modular_checksum(part.start, octets);
        writes.push_back({part.start, octets});
    }
    conclude();
    return writes;
}

/// Adds a range. Returns false when there would be too many.
bool CfdpReceiver::insert(const Range& range) {
    auto& all = state_.received;
    const auto first = first_touching(all, range.start);
    auto last = first;
    Range merged = range;
    for (; last != all.end() && last->start <= range.end; ++last) {
        merged.start = std::min(merged.start, last->start);
        merged.end = std::max(merged.end, last->end);
    }
    if (first == last) {
        if (all.size() >= ranges_max) return false;
        all.insert(first, merged);
    } else {
        *first = merged;
        all.erase(first + 1, last);
    }
    return true;
}

/// Repeats the outcome: the file's sender does not know it, or has forgotten it.
void CfdpReceiver::say_again() {
    finished_due_ = true;
    state_.outcome_acknowledged = false;
}

void CfdpReceiver::take(const cfdp::Metadata& metadata) {
    if (state_.outcome != Outcome::under_way) return say_again();
    const bool known = state_.file_octets.has_value();
    const bool other = known && *state_.file_octets != metadata.file_octets;
    if (other || metadata.file_octets > file_octets_max || metadata.checksum != cfdp::Checksum::modular) ++refused_;
    if (known || metadata.file_octets > file_octets_max || metadata.checksum != cfdp::Checksum::modular) return;
    state_.file_octets = metadata.file_octets;
    state_.source_name = metadata.source_name;
    state_.destination_name = metadata.destination_name;
    conclude();
}

void CfdpReceiver::take(const cfdp::Eof& eof) {
    eof_ack_due_ = true;
    if (state_.outcome != Outcome::under_way) say_again();
    if (state_.eof || state_.outcome != Outcome::under_way) return;
    if (eof.condition != cfdp::Condition::no_error) return end(Outcome::cancelled);
    if (eof.file_octets > file_octets_max) {
        ++refused_;
        return end(Outcome::wrong_size);
    }
    state_.eof = eof;
    conclude();
    if (state_.outcome == Outcome::under_way) ask();
}

void CfdpReceiver::conclude() {
    if (!state_.eof || !state_.file_octets || state_.outcome != Outcome::under_way) return;
    const std::uint32_t size = state_.eof->file_octets;
    const bool too_much = !state_.received.empty() && state_.received.back().end > size;
    if (too_much || size != *state_.file_octets) return end(Outcome::wrong_size);
    const bool whole = size == 0 || state_.received == std::vector<Range>{{0, size}};
    if (!whole) return;
    end(state_.checksum == state_.eof->checksum ? Outcome::complete : Outcome::wrong_checksum);
}

void CfdpReceiver::end(Outcome outcome) {
    state_.outcome = outcome;
    finished_due_ = true;
    naks_.clear();
}

void CfdpReceiver::ask() {
    if (state_.outcome != Outcome::under_way) {
        finished_due_ = !state_.outcome_acknowledged;
        return;
    }
    const std::uint32_t progress = state_.received.empty() ? 0 : state_.received.back().end;
    const Range scope{0, state_.eof ? std::max(state_.eof->file_octets, progress) : progress};
    auto wanted = missing_in(state_.received, scope);
    if (!state_.file_octets) wanted.insert(wanted.begin(), Range{0, 0});
    naks_.clear();
    for (std::size_t i = 0; i < wanted.size() && i < naks_at_once_max * cfdp::nak_requests_max; ++i) {
        if (i % cfdp::nak_requests_max == 0) naks_.push_back({{wanted[i].start, 0}, {}});
        naks_.back().requests.push_back(wanted[i]);
        naks_.back().scope.end = wanted[i].end;
    }
}

std::vector<std::uint8_t> CfdpReceiver::written(const cfdp::Content& content) const {
    const cfdp::Pdu pdu{{.toward_sender = true,
                         .source = state_.source,
                         .sequence = state_.sequence,
                         .destination = state_.destination},
                        content};
    std::vector<std::uint8_t> octets(cfdp::octets_of(pdu));
    cfdp::write(pdu, octets);
    return octets;
}

std::optional<std::vector<std::uint8_t>> CfdpReceiver::next() {
    if (eof_ack_due_) {
        eof_ack_due_ = false;
        return written(cfdp::Ack{cfdp::Directive::eof});
    }
    if (!naks_.empty()) {
        const cfdp::Nak first = naks_.front();
        naks_.erase(naks_.begin());
        return written(first);
    }
    if (!finished_due_) return std::nullopt;
    finished_due_ = false;
    const bool complete = state_.outcome == Outcome::complete;
    return written(cfdp::Finished{condition_of(state_.outcome), complete, static_cast<std::uint8_t>(complete ? 2 : 0)});
}

}  // namespace aeolis::telemetry
