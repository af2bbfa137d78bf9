// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"
#include "server/archive/records.hpp"
#include "telemetry/decommutator.hpp"

#include <cstdint>
#include <vector>

namespace aeolis::archive {

/// Maps packets to columns: the fields that are channels, and the packets in which each channel occurs.
class PacketColumns {
  public:
    explicit PacketColumns(const dictionary::Dictionary& dictionary);

    struct Place {
        std::uint16_t packet = 0;
        std::size_t column = 0;
    };

    /// The channels of a packet, in the order of its fields. Empty: the packet has no samples.
    const std::vector<ChannelId>& channels(std::size_t packet) const { return packets_[packet].channels; }
    const std::vector<Place>& places(ChannelId channel) const { return places_[channel.value]; }
    std::size_t packets() const { return packets_.size(); }

    /// Appends one value per column; NaN where undefined.
    void append_values(const telemetry::Decoded& decoded, std::vector<double>& values) const;
    double value(const telemetry::Decoded& decoded, std::size_t column) const;
    bool defined(const telemetry::Decoded& decoded, std::size_t column) const;
    /// The exact values that doubles do not hold, by column.
    std::vector<SampleText> texts(const telemetry::Decoded& decoded) const;

  private:
    struct Columns {
        std::vector<ChannelId> channels;
        std::vector<std::size_t> fields;
    };
    std::vector<Columns> packets_;
    std::vector<std::vector<Place>> places_;  ///< by ChannelId
};

}  // namespace aeolis::archive
