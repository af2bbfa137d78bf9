// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/file_delivery/recording_delivery.hpp"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace aeolis::simulation {

/// The rover's UHF radio after landing, with file delivery on top.
///
/// In       the recording; PLTUs from ground; the rate of the pass, cycle by cycle     Out   PLTUs, as octets
/// The ends of the files under way are announced again when a pass begins, or when nothing is left to send and no
/// answer has come within both light times and 10 s (our assumption).
class RelayRadio {
  public:
    explicit RelayRadio(double light_time_s) : answer_cycles_(cycles_for_answer(light_time_s)) {}

    void receive(std::span<const std::uint8_t> pltu) { delivery_.on(pltu); }

    /// Runs one cycle at `rate_bps`, 0 without a pass. Returns the octets sent, valid until the next call. PLTUs go
    /// whole; unused octets carry over.
    std::span<const std::uint8_t> cycle(const flight::RecordingDelivery::Recording& recording, double rate_bps);

    /// Injects a fault: the radio loses its state.
    void restart() { delivery_ = {}; }

    bool done(const flight::RecordingDelivery::Recording& recording) const { return delivery_.done(recording); }

  private:
    static std::int64_t cycles_for_answer(double light_time_s);

    flight::RecordingDelivery delivery_;
    std::vector<std::uint8_t> sent_;
    double credit_octets_ = 0.0;
    std::int64_t answer_cycles_, silent_cycles_ = 0;
    bool in_pass_ = false;
};

}  // namespace aeolis::simulation
