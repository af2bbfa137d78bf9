// SPDX-License-Identifier: Apache-2.0
#include "telemetry/station/foreign_station.hpp"

namespace aeolis::telemetry {

Result<void> ForeignStation::recognise(std::span<const std::uint8_t> beginning, bool ended) {
    auto recognised = recognise_(beginning, ended);
    if (!recognised) return recognised.error();
    source_.emplace(std::move(recognised->source));
    layout_ = std::move(recognised->layout);
    return {};
}

Received& ForeignStation::receive(Downlink downlink) {
    received_.clear();
    received_.links = std::move(downlink.links);
    std::erase_if(downlink.octets, [](const ReceivedOctets& piece) { return piece.octets.empty(); });
    received_.octets = std::move(downlink.octets);
    for (const ReceivedOctets& piece : received_.octets) receive(piece);
    return received_;
}

void ForeignStation::receive(const ReceivedOctets& piece) {
    ledger_.received(piece.ert, piece.octets.size());
    if (source_)
        read(piece.octets, piece.ert, piece.datagram);
    else
        begin(piece);
}

Received& ForeignStation::end(Ert now) {
    received_.clear();
    if (!source_ && !beginning_.empty()) read_beginning(true);
    if (source_) {
        source_->end(now);
        take_packets();
        stray_octets_ += source_->stray_octets();
        ledger_.end(*source_);
        source_.reset();
    }
    return received_;
}

void ForeignStation::begin(const ReceivedOctets& piece) {
    beginning_.insert(beginning_.end(), piece.octets.begin(), piece.octets.end());
    if (piece.datagram || pieces_.empty() || pieces_.back().datagram || pieces_.back().ert != piece.ert)
        pieces_.push_back({piece.octets.size(), piece.ert, piece.datagram});
    else
        pieces_.back().octets += piece.octets.size();
    const bool full = beginning_.size() >= beginning_octets_max;
    // Octets that come one by one cost at most twice the work.
    if (full || beginning_.size() >= 2 * tried_octets_) read_beginning(full);
}

/// Reads the beginning if its layout is recognised; if it is not, and no more of it comes, gives it up.
void ForeignStation::read_beginning(bool ended) {
    tried_octets_ = beginning_.size();
    const auto recognised = recognise(beginning_, ended);
    if (recognised) {
        auto rest = std::span<const std::uint8_t>{beginning_};
        for (const Piece& piece : pieces_) {
            read(rest.first(piece.octets), piece.ert, piece.datagram);
            rest = rest.subspan(piece.octets);
        }
    } else if (ended) {
        ledger_.unread(beginning_.size());
        unread_ = {beginning_.size(), recognised.error().message};
    }
    if (recognised || ended) {
        beginning_.clear();
        pieces_.clear();
        tried_octets_ = 0;
    }
}

void ForeignStation::read(std::span<const std::uint8_t> octets, Ert ert, bool datagram) {
    source_->receive(octets, ert);
    if (datagram && !source_->end_datagram()) ledger_.bad_datagram();
    take_packets();
}

void ForeignStation::take_packets() {
    while (const auto packet = source_->next())
        received_.packets.push_back({downlink_link, source_->received(), {packet->begin(), packet->end()}, {}});
}

}  // namespace aeolis::telemetry
