// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"
#include "telemetry/decommutator.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace aeolis::server {

/// A timepoint's firing as recorded.
struct RecordedFiring {
    std::string name;
    double fired_sclk = 0.0;
    std::string verdict;
    std::size_t row = 0;  ///< in the timeline
    double triggered_sclk = 0.0;
};

/// Collects the firings in a recording. Of other packets it reads only the header.
///
/// In       whole packets recorded in a cycle      Out   firings, oldest first
/// Memory   one of about 100 octets per timepoint
class RecordedFirings {
  public:
    /// The dictionary must outlive this and its copies.
    explicit RecordedFirings(const dictionary::Dictionary& dictionary);

    void read(std::span<const std::uint8_t> recorded);
    const std::vector<RecordedFiring>& all() const { return firings_; }

  private:
    const dictionary::Dictionary* dictionary_;
    const dictionary::Packet* packet_;
    telemetry::Decommutator decommutator_;
    telemetry::Decoded decoded_;
    std::vector<RecordedFiring> firings_;
};

}  // namespace aeolis::server
