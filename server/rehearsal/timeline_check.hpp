// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/run.pb.h"
#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"

#include <chrono>
#include <functional>
#include <map>
#include <mutex>
#include <span>
#include <string>
#include <vector>

namespace aeolis::server {

/// Whether the command changes an offset of the timeline.
bool changes_timeline(const v1::CommandRequest& request);

/// What becomes of the timeline's constraints when offsets are changed by command: the analysis of `aeolis timeline
/// analyse` on the timeline as it then stands. R19
///
/// In       the commands of the run so far, whose changes stand unless a stage of them failed, in the order in which
///          they left and then of those that wait; those that are asked for
/// Out      what the analysis says; an Error names the first constraint that would no longer hold; an internal one says
///          why nobody knows
/// Cost     a second of one processor for the mission's timeline: not for the network's or the rehearsal's thread. One
///          analysis at a time, which ends when `stop` says so. The newest answers are kept, for a dry run is asked
///          again and again
/// Threads  any
class TimelineCheck {
  public:
    static constexpr std::chrono::milliseconds turn_max{
        5'000};                                     ///< ours: so long one waits while another analysis goes on
    static constexpr std::size_t answers_max = 32;  ///< ours: kept
    using Stop = std::function<bool()>;

    explicit TimelineCheck(const dictionary::Dictionary& dictionary) : dictionary_(dictionary) {}

    /// `only_check`: a dry run, which waits for no other analysis than that of the same changes.
    Result<std::string> check(const v1::CommandList& before, std::span<const v1::CommandRequest> asked, bool only_check,
                              const Stop& stop);

    /// Of a command that waits: what the timeline comes to by it, after all that left and what waits before it.
    struct Waiting {
        std::uint64_t number = 0;
        bool refuted = false;
        std::string words;
    };
    struct Look {
        std::vector<Waiting> known;
        std::string not_known;  ///< why the rest is not known, for the log; empty: all is
        std::size_t undone =
            0;  ///< changes that had come to nothing by then: when there are more, the look is out of date
    };
    /// What of `before` waits and changes the timeline; the changes of one that is refuted do not count for those
    /// behind it.
    Look look_again(const v1::CommandList& before, const Stop& stop);

  private:
    Result<std::string> analysed(const std::string& key, const dictionary::Dictionary& changed, bool only_check,
                                 const Stop& stop);

    const dictionary::Dictionary& dictionary_;
    std::timed_mutex analysing_;  ///< taken before mutex_
    std::mutex mutex_;
    std::string analysed_now_;  ///< under mutex_: the newest that began; what has ended is among answers_ or not known
    std::map<std::string, Result<std::string>> answers_;  ///< under mutex_; by the changes in their order
};

}  // namespace aeolis::server
