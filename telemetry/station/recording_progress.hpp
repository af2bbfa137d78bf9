// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/decoded.hpp"
#include "dictionaries/dictionary.hpp"

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace aeolis::telemetry {

class RecordingReceiver;

/// The fraction of the recording that is down, by the size that the vehicle reported.
///
/// In       decoded packets; what was received of the recording        Out   a fraction
/// Rule     once TOUCHDOWN was heard live, telemetry reports nearly the size (CommStatus); earlier reports are of a
///          part. The recording is whole when the file that the rover names its last is down, and all before it:
///          RECORDING_CLOSED is the last packet of one computer, and Second Chance never announces it
/// Faults   no size reported: the fraction is not known, and is 0
class RecordingProgress {
  public:
    explicit RecordingProgress(const dictionary::Dictionary& dictionary);

    /// Takes a packet that was received live; a packet of the recording may be older.
    void note(const dictionary::Decoded& packet);

    /// 0 … 1; 1: all of it, in whole files.
    double fraction(const RecordingReceiver& received) const;

  private:
    using Place = std::pair<std::size_t, std::size_t>;  ///< packet in Dictionary::packets, field
    std::vector<Place> sizes_;
    std::optional<std::size_t> touchdown_;  ///< packet
    bool landed_ = false;
    std::uint64_t told_octets_ = 0;
};

}  // namespace aeolis::telemetry
