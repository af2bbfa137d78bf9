// SPDX-License-Identifier: Apache-2.0
#include "telemetry/station/ground_station.hpp"

#include "common/space_packet.hpp"

#include <algorithm>

namespace aeolis::telemetry {

Received& GroundStation::receive(const Downlink& downlink) {
    now_ = downlink.now;
    out_ = downlink.station_out;
    received_.clear();
    received_.links = downlink.links;
    received_.tones = downlink.tones;
    received_.carrier = downlink.carrier;
    received_.octets = downlink.octets;
    for (const LinkState& state : downlink.links) note(state);
    for (const ReceivedOctets& piece : downlink.octets) receive(piece);
    for (LinkReceiver& link : links_)
        if (link.waits && static_cast<double>(now_.microseconds - link.heard_at.microseconds) * 1e-6 > quiet_s)
            search_to_the_end(link, now_);
    recording_.pass(now_, relay_up_);
    if (tones_) tones_->receive(downlink, received_);
    if (doppler_)
        for (const ReceivedCarrier& carrier : received_.carrier)
            if (const auto seen = doppler_->hear(carrier)) received_.seen.push_back(*seen);
    return received_;
}

void GroundStation::explain_silences(double recording_progress) {
    if (!silences_) return;
    SilenceClassifier::Station station{recording_progress, {}, out_ ? "nothing comes from the station" : ""};
    for (const LinkReceiver& link : links_) station.heard.emplace_back(link.link.name, link.heard_at);
    received_.links = silences_->tell(received_.links, now_, station);
}

GroundStation::LinkReceiver& GroundStation::receiver_of(const Link& link) {
    const auto known = std::ranges::find(links_, link, &LinkReceiver::link);
    return known != links_.end() ? *known : links_.emplace_back(LinkReceiver{link});
}

void GroundStation::receive(const ReceivedOctets& piece) {
    LinkReceiver& from = receiver_of(piece.link);
    from.rate.add(piece.ert, piece.octets.size());
    from.heard_at = piece.ert;
    from.waits = true;
    from.pltus.receive(piece.octets);
    receive_frames(from, piece.ert);
}

void GroundStation::receive_frames(LinkReceiver& from, Ert ert) {
    while (const auto frame = from.pltus.next()) {
        from.packets.add(*frame);
        while (const auto packet = from.packets.next()) {
            const auto header = read_primary_header(*packet);
            if (!header || header->apid != file_delivery_apid)
                received_.packets.push_back(
                    {.link = from.link, .ert = ert, .octets = {packet->begin(), packet->end()}});
            else
                recording_.receive(packet->subspan(primary_header_octets), ert,
                                   [&](std::span<const std::uint8_t> file) { take_file(file, ert); });
        }
    }
}

std::vector<LinkTotals> GroundStation::link_totals(Ert now) const {
    std::vector<LinkTotals> totals;
    totals.reserve(links_.size());
    for (const LinkReceiver& link : links_)
        totals.push_back({link.link.name, link.pltus.counters(), link.rate.per_second(now), link.packets.counters(), 0,
                          link.pltus.sequences()});
    return totals;
}

/// Handles a link's change. A link that went down cannot complete a frame: its waiting octets are searched as they are.
void GroundStation::note(const LinkState& state) {
    if (state.link == relay_link) relay_up_ = state.up;
    const auto known = std::ranges::find(links_, state.link, &LinkReceiver::link);
    if (known == links_.end() || state.up) return;
    search_to_the_end(*known, state.ert);
}

void GroundStation::search_to_the_end(LinkReceiver& link, Ert ert) {
    link.waits = false;
    link.pltus.end();
    receive_frames(link, ert);
}

void GroundStation::take_file(std::span<const std::uint8_t> octets, Ert ert) {
    while (const auto size = space_packet_octets(octets)) {
        if (*size > octets.size()) break;
        const auto packet = octets.first(*size);
        received_.packets.push_back({.link = relay_link, .ert = ert, .octets = {packet.begin(), packet.end()}});
        octets = octets.subspan(*size);
    }
    unreadable_file_octets_ += octets.size();
}

}  // namespace aeolis::telemetry
