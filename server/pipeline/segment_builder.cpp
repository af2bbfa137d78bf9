// SPDX-License-Identifier: Apache-2.0
#include "server/pipeline/segment_builder.hpp"

#include "common/check.hpp"

#include <algorithm>
#include <utility>

namespace aeolis::pipeline {

using archive::segment_samples;
using archive::Source;

namespace {
std::size_t index_of(Source source) {
    return source == Source::realtime ? 0 : 1;
}
}  // namespace

SegmentBuilder::SegmentBuilder(const archive::PacketColumns& columns) : columns_(columns), open_(columns.packets()) {}

void SegmentBuilder::add(std::uint16_t packet, Source source, archive::Sequence packet_seq, Sclk sclk,
                         std::span<const double> values, archive::Batch& batch) {
    AEOLIS_CHECK(source != Source::ground && values.size() == columns_.channels(packet).size());
    auto& open = open_[packet][index_of(source)];
    if (open.values.empty()) {
        open.values.resize(values.size() * segment_samples);
        open.sclk_s.reserve(segment_samples);
    }
    if (open.sclk_s.empty()) open.first_packet_seq = packet_seq;
    open.last_packet_seq = packet_seq;
    const std::size_t row = open.sclk_s.size();
    for (std::size_t c = 0; c < values.size(); ++c) open.values[c * segment_samples + row] = values[c];
    open.sclk_s.push_back(sclk.seconds);
    if (open.sclk_s.size() == segment_samples) close(packet, source, open, batch);
}

void SegmentBuilder::seal(archive::Batch& batch) {
    for (std::size_t packet = 0; packet < open_.size(); ++packet)
        for (const Source source : {Source::realtime, Source::recorded})
            if (auto& open = open_[packet][index_of(source)]; !open.sclk_s.empty()) close(packet, source, open, batch);
    pyramid_.seal(batch.pyramid);
}

void SegmentBuilder::close(std::size_t packet, Source source, Open& open, archive::Batch& batch) {
    auto& segment = batch.segments.emplace_back();
    segment.packet = static_cast<std::uint16_t>(packet);
    segment.source = source;
    segment.position = open.position++;
    segment.first_packet_seq = open.first_packet_seq;
    segment.last_packet_seq = open.last_packet_seq;
    segment.channels = columns_.channels(packet);
    const std::size_t samples = open.sclk_s.size();
    segment.sclk_s = std::exchange(open.sclk_s, {});
    if (samples == segment_samples) {
        segment.values = std::exchange(open.values, {});  // a copy would double the memory where many end together
    } else {
        segment.values.resize(segment.channels.size() * samples);
        for (std::size_t c = 0; c < segment.channels.size(); ++c)
            std::copy_n(open.values.begin() + static_cast<std::ptrdiff_t>(c * segment_samples), samples,
                        segment.values.begin() + static_cast<std::ptrdiff_t>(c * samples));
    }
    pyramid_.add(segment, batch.pyramid);
}

}  // namespace aeolis::pipeline
