// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/kept.pb.h"
#include "common/time.hpp"
#include "telemetry/station/received.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace aeolis::server {

class Rehearsal;

/// What ground flies beside a run. It is given what ground received and what was sent, never the run itself.
///
/// In       each cycle's Received, and each request with the number of cycles flown when it was taken
/// Out      packets that ground makes (telemetry/port.hpp, station_link), by the run's cycles alone: a run that is
///          flown again makes the same
/// Thread   the run's
class Companion {
  public:
    Companion() = default;
    Companion(const Companion&) = delete;
    Companion& operator=(const Companion&) = delete;
    virtual ~Companion() = default;

    /// The run has taken this request, before its next cycle.
    virtual void take(std::uint64_t cycle, const v1::KeptRequest& request) = 0;

    struct Made {
        std::vector<telemetry::ReceivedPacket> packets;
        std::optional<v1::KeptRequest> request;  ///< to be kept with the run, and then taken as any
    };
    /// After each cycle. `now`: Earth's time at its end.
    virtual Made hear(const telemetry::Received& received, Ert now) = 0;

    /// From here on the run is not flown again any more: what takes other processors may begin.
    virtual void go_live() = 0;
};

/// Makes the companion of a run at its beginning; null: it has none.
using MakeCompanion = std::function<std::unique_ptr<Companion>(const Rehearsal& run)>;

}  // namespace aeolis::server
