// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/cluster.pb.h"
#include "server/cluster/engine.hpp"

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>

namespace aeolis::server::cluster {

/// Sends the requests of people at this follower to its origin, signed, and gives their answers back.
///
/// In       requests, in their order
/// Out      one answer to each; status 503 with a sentence when none came within `wait`: then it is not known whether
///          the origin has done it, and its stream will tell
/// Memory   `waiting_max` requests
/// Threads  one of its own, on which answers are given. ask() from any
class RequestSender {
  public:
    static constexpr std::size_t waiting_max = 100;  ///< chosen: more people than are at one site
    using Answered = std::function<void(v1::RequestAnswer)>;
    /// What the follower heard of its origin last. Without it the origin would refuse the request, so it is not asked.
    struct Origin {
        std::string publisher;  ///< empty: it has not been heard
        std::uint64_t heard = 0;
    };
    struct Settings {
        EngineAddress engine;
        std::string origin;                        ///< identity of the archive that is followed
        std::string seed;                          ///< of the key that signs
        std::function<Origin()> heard;             ///< called on the thread of this
        std::chrono::milliseconds wait{20'000};    ///< chosen: longer than a timeline's analysis takes
        std::chrono::milliseconds look_every{20};  ///< for answers, while one is due
        std::chrono::milliseconds again_after{500};
    };
    explicit RequestSender(Settings settings);
    ~RequestSender();  ///< requests that wait for their answer are told so

    /// Signs and sends it; whose request it is, method, path and body are its caller's to fill in.
    void ask(v1::FollowerRequest request, Answered answered);

  private:
    class Thread;
    std::unique_ptr<Thread> thread_;
};

}  // namespace aeolis::server::cluster
