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
    case v1::KeptRequest::kEnsemble:
    case v1::KeptRequest::kPlan:
    case v1::KeptRequest::kJump: return true;  // of ground and of its instructor, not of the landing
    case v1::KeptRequest::KEPT_NOT_SET: break;
    }
    return false;
}

bool is_fork(const archive::RequestRecord& request) {
    return archive::kept_request(request.request).has_fork();
}

Result<void> fly_again(Rehearsal& rehearsal, const archive::FlownRun& run, const FlyAgain& how) {
    for (auto request = run.requests.begin();;) {
        const bool there = rehearsal.cycles() >= how.cycle;
        for (; request != run.requests.end() && request->cycle == rehearsal.cycles(); ++request)
            if (!there || how.with_requests_of_cycle || is_fork(*request))
                if (!repeat(rehearsal, archive::kept_request(request->request)))
                    return Error{fmt::format("run {}: what was taken at cycle {} is refused now", run.run.value,
                                             request->cycle)};
        if (there) return {};
        if (how.stop()) return Error{"it was stopped"};
        if (rehearsal.finished())
            return Error{fmt::format("run {} ends before, at E{:+.1f} s: {}", run.run.value, rehearsal.clocks().e_s(),
                                     rehearsal.outcome_reason())};
        if (auto looked = how.look(rehearsal.step()); !looked) return looked;
        rehearsal.take_stages();
    }
}

}  // namespace aeolis::server
