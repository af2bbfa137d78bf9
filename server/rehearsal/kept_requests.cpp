// SPDX-License-Identifier: Apache-2.0
#include "server/rehearsal/kept_requests.hpp"

#include "server/archive/kept_request.hpp"
#include "server/rehearsal/command_messages.hpp"

#include <fmt/format.h>

namespace aeolis::server {

bool repeat(Rehearsal& rehearsal, const v1::KeptRequest& kept,
            const std::function<void(const v1::CommandReply&)>& accepted) {
    switch (kept.kept_case()) {
    case v1::KeptRequest::kCommand: {
        const auto reply = rehearsal.submit(kept.command(), kept.browser(), kept.director());
        if (reply.accepted() && accepted) accepted(reply);
        return reply.accepted();
    }
    case v1::KeptRequest::kVerdict: return rehearsal.judge(verdict_of(kept.verdict())).ok();
    case v1::KeptRequest::kIntervention:
        return !kept.intervention().has_fault() || rehearsal.inject(kept.intervention().fault()).ok();
    case v1::KeptRequest::kFork: return kept.fork().seed() == 0 || rehearsal.redraw(kept.fork().seed()).ok();
    case v1::KeptRequest::KEPT_NOT_SET: break;
    }
    return false;
}

Result<void> fly_again(Rehearsal& rehearsal, const archive::FlownRun& run, std::uint64_t cycle,
                       const std::function<bool()>& stop) {
    for (auto request = run.requests.begin();;) {
        for (; request != run.requests.end() && request->cycle == rehearsal.cycles() && rehearsal.cycles() < cycle;
             ++request)
            if (!repeat(rehearsal, archive::kept_request(request->request)))
                return Error{
                    fmt::format("run {}: what was taken at cycle {} is refused now", run.run.value, request->cycle)};
        if (rehearsal.cycles() >= cycle) return {};
        if (stop()) return Error{"it was stopped"};
        if (rehearsal.finished())
            return Error{fmt::format("run {} ends before, at E{:+.1f} s: {}", run.run.value, rehearsal.clocks().e_s(),
                                     rehearsal.outcome_reason())};
        rehearsal.step();
        rehearsal.take_stages();
    }
}

}  // namespace aeolis::server
