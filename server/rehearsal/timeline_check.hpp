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

/// Analyses the timeline's constraints after changes of offsets by command: the analysis of `aeolis timeline analyse`
/// on the changed timeline. R19
///
/// In       the run's commands so far: released ones in their order, then waiting ones. Their changes stand unless a
///          stage of them failed. And the commands to be checked
/// Out      the analysis in words. An Error names the first constraint that would be violated; an internal Error says
///          why the result is unknown
/// Cost     a second of one processor for the mission's timeline: not for the network's or the rehearsal's thread. One
///          analysis at a time; `stop` ends it. The newest answers are kept, since dry runs are often repeated
/// Threads  any
class TimelineCheck {
  public:
    static constexpr std::chrono::milliseconds turn_max{5'000};  ///< chosen: the longest wait for another analysis
    static constexpr std::size_t answers_max = 32;               ///< chosen
    using Stop = std::function<bool()>;

    explicit TimelineCheck(const dictionary::Dictionary& dictionary) : dictionary_(dictionary) {}

    /// Analyses `asked` after `before`. @param only_check  a dry run, which waits only for an analysis of the same
    /// changes
    Result<std::string> check(const v1::CommandList& before, std::span<const v1::CommandRequest> asked, bool only_check,
                              const Stop& stop);

    /// The analysis for a waiting command: after all released commands and those waiting before it.
    struct Waiting {
        std::uint64_t number = 0;
        bool refuted = false;
        std::string words;
    };
    struct Reanalysis {
        std::vector<Waiting> known;
        std::string not_known;   ///< why the rest is unknown, for the log; empty: all known
        std::size_t undone = 0;  ///< changes without effect at that time; when more, this is outdated
    };
    /// Analyses the waiting commands of `before` that change the timeline. The changes of a refuted one do not count
    /// for those behind it.
    Reanalysis reanalyse(const v1::CommandList& before, const Stop& stop);

  private:
    Result<std::string> analysed(const std::string& key, const dictionary::Dictionary& changed, bool only_check,
                                 const Stop& stop);

    const dictionary::Dictionary& dictionary_;
    std::timed_mutex analysing_;  ///< lock before mutex_
    std::mutex mutex_;
    /// Under mutex_: key of the newest analysis begun; once ended it is in answers_ or unknown.
    std::string analysed_now_;
    std::map<std::string, Result<std::string>> answers_;  ///< under mutex_; by the changes in order
};

}  // namespace aeolis::server
