#include "server/pipeline/segment_builder.hpp"

#include "common/check.hpp"

#include <algorithm>

namespace aeolis::pipeline {

using archive::Source;

namespace {
std::size_t index_of(Source source) {
    return source == Source::realtime ? 0 : 1;
}
} // namespace

SegmentBuilder::SegmentBuilder(const archive::PacketColumns& columns, std::size_t samples_max)
    : columns_(columns), samples_max_(samples_max), open_(columns.packets()) {}

void SegmentBuilder::add(std::uint16_t packet, Source source, archive::Sequence unit, Sclk sclk,
                         std::span<const double> values, std::vector<archive::SegmentRecord>& full) {
    AEOLIS_CHECK(source != Source::ground && values.size() == columns_.channels(packet).size());
    auto& open = open_[packet][index_of(source)];
    if (open.values.empty()) {
        open.values.resize(values.size() * samples_max_);
        open.sclk_s.reserve(samples_max_);
    }
    if (open.sclk_s.empty()) open.first_unit = unit;
    open.last_unit = unit;
    const std::size_t row = open.sclk_s.size();
    for (std::size_t c = 0; c < values.size(); ++c)
        open.values[c * samples_max_ + row] = values[c];
    open.sclk_s.push_back(sclk.seconds);
    if (open.sclk_s.size() == samples_max_) full.push_back(take(packet, source, open));
}

void SegmentBuilder::seal(std::vector<archive::SegmentRecord>& out) {
    for (std::size_t packet = 0; packet < open_.size(); ++packet)
        for (const Source source : {Source::realtime, Source::recorded})
            if (auto& open = open_[packet][index_of(source)]; !open.sclk_s.empty())
                out.push_back(take(packet, source, open));
}

archive::SegmentRecord SegmentBuilder::take(std::size_t packet, Source source, Open& open) const {
    archive::SegmentRecord segment;
    segment.packet = static_cast<std::uint16_t>(packet);
    segment.source = source;
    segment.first_unit = open.first_unit;
    segment.last_unit = open.last_unit;
    segment.sclk_s = open.sclk_s;
    segment.channels = columns_.channels(packet);
    const std::size_t samples = open.sclk_s.size();
    segment.values.resize(segment.channels.size() * samples);
    for (std::size_t c = 0; c < segment.channels.size(); ++c)
        std::copy_n(open.values.begin() + static_cast<std::ptrdiff_t>(c * samples_max_), samples,
                    segment.values.begin() + static_cast<std::ptrdiff_t>(c * samples));
    open.sclk_s.clear();
    return segment;
}

} // namespace aeolis::pipeline
