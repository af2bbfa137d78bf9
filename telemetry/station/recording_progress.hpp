// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/decoded.hpp"
#include "dictionaries/dictionary.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace aeolis::telemetry {

class RecordingReceiver;

/// How much of the recording is down, by what the vehicle told of its size.
///
/// In       decoded packets; what was received of the recording        Out   a fraction
/// Rule     once TOUCHDOWN was heard live, telemetry tells nearly the size (CommStatus); what it told earlier was a
///          part. RECORDING_CLOSED, the last packet, tells the whole size; before it is down nothing is called whole
/// Faults   no size told: the fraction is not known, and is 0
class RecordingProgress {
  public:
    explicit RecordingProgress(const dictionary::Dictionary& dictionary);

    /// Whether note() may learn from a packet that came with the recording. Reads its header only.
    bool may_close(std::span<const std::uint8_t> packet) const;
    void note(const dictionary::Decoded& packet, bool live);

    /// 0 … 1; 1: all of it, to its last packet, in whole files.
    double fraction(const RecordingReceiver& received) const;

  private:
    using Place = std::pair<std::size_t, std::size_t>;  ///< packet in Dictionary::packets, field
    std::vector<Place> sizes_;
    std::optional<Place> closed_;
    std::optional<Apid> closed_apid_;
    std::optional<std::size_t> touchdown_;  ///< packet
    bool landed_ = false;
    std::uint64_t told_octets_ = 0;
    std::optional<std::uint64_t> closed_octets_;  ///< without the last packet
};

}  // namespace aeolis::telemetry
