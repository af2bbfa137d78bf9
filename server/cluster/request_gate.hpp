// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/cluster.pb.h"
#include "server/cluster/engine.hpp"
#include "server/cluster/signed_request.hpp"

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace aeolis::server::cluster {

/// Takes the requests of people at followers, at their origin.
///
/// In       what comes by the engine, of which RequestCheck decides
/// Out      `taken`, once for each request that is the follower's; its answer goes back. What is refused is answered
///          with the reason, counted, and told in a line
/// Faults   an engine that is away is waited for; requests meanwhile are their sender's to repeat
/// Memory   `answers_max` answers
/// Threads  one of its own, on which `taken` is called. An answer may be given from any, also after the end
class RequestGate {
  public:
    using Answer = std::function<void(v1::RequestAnswer)>;
    struct Settings {
        EngineAddress engine;
        RequestCheck::Rules rules;
        std::chrono::milliseconds wait{10};  ///< for requests, until answers are sent
        std::chrono::milliseconds again_after{500};
    };
    using Take = std::function<void(RequestCheck::Taken, Answer)>;
    RequestGate(Settings settings, Take taken);
    ~RequestGate();

    struct Counts {
        std::uint64_t taken = 0, refused = 0;  ///< since the start
    };
    Counts counts() const;

  private:
    class Thread;
    std::unique_ptr<Thread> thread_;
};

}  // namespace aeolis::server::cluster
