#pragma once

#include "aeolis/v1/run.pb.h"
#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"

#include <mutex>
#include <span>
#include <string>

namespace aeolis::server {

/// Whether the command changes an offset of the timeline.
bool changes_timeline(const v1::CommandRequest& request);

/// What becomes of the timeline's constraints when offsets are changed by command: the analysis of `aeolis timeline analyse`
/// on the timeline as it then stands. R19
///
/// In       the commands of the run so far, whose changes stand unless a stage of them failed; those that are asked for
/// Out      what the analysis says; an Error names the first constraint that would no longer hold
/// Cost     a second of one processor for the mission's timeline: not for the network's or the rehearsal's thread. The last
///          answer is kept, for a dry run is asked again and again
/// Threads  any
class TimelineCheck {
  public:
    explicit TimelineCheck(const dictionary::Dictionary& dictionary) : dictionary_(dictionary) {}

    Result<std::string> check(const v1::CommandList& before, std::span<const v1::CommandRequest> asked);

  private:
    const dictionary::Dictionary& dictionary_;
    std::mutex mutex_;
    std::string last_key_;
    Result<std::string> last_ = std::string{};
};

} // namespace aeolis::server
