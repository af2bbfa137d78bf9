// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/pipeline/pipeline_thread.hpp"

#include <cstdint>
#include <fmt/format.h>
#include <string>
#include <utility>

namespace aeolis::server {

/// What an ingest has made ready for the archive, and the faults that it told.
class IngestDelivery {
  public:
    explicit IngestDelivery(PipelineThread& pipeline) : pipeline_(pipeline) {}

    Delivery next;  ///< handed over when it is due

    Result<void> hand_over() {
        if (pipeline_.deliver(std::exchange(next, {}))) return {};
        return Error{pipeline_.fault()};
    }
    /// Tells what was lost or not used, in a line.
    void fault(const std::string& words) {
        ++faults_;
        fmt::print(stderr, "{}\n", words);
    }
    bool is_clean() const { return faults_ == 0; }

  private:
    PipelineThread& pipeline_;
    std::uint64_t faults_ = 0;
};

}  // namespace aeolis::server
