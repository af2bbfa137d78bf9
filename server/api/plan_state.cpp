// SPDX-License-Identifier: Apache-2.0
#include "server/api/plan_state.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace aeolis::server {
namespace {

using instruction::Inject;

v1::PlannedInject inject_message(const Inject& inject, const dictionary::Dictionary& dictionary,
                                 const instruction::Rubric& rubric) {
    v1::PlannedInject message;
    message.set_inject(inject.id);
    message.set_title(inject.title);
    message.set_when(instruction::when_text(inject, dictionary));
    message.set_does(instruction::text_of(inject.fault));
    message.set_shows(inject.shows);
    for (auto& words : instruction::team_texts(inject, rubric)) message.add_team(std::move(words));
    return message;
}

}  // namespace

Result<std::vector<v1::Intervention>> all_interventions(archive::Reader& reader, archive::RunId run) {
    std::vector<v1::Intervention> all;
    for (std::uint64_t after = 0;;) {
        auto page = reader.interventions(run, {.after = after});
        if (!page) return page.error();
        all.insert(all.end(), page->interventions().begin(), page->interventions().end());
        if (page->next_after() == 0) return all;
        after = page->next_after();
    }
}

Result<v1::PlanState> plan_state(archive::Reader& reader, archive::RunId run, const dictionary::Dictionary& dictionary,
                                 const instruction::PlanLibrary& plans) {
    const auto kept = reader.instructor_plan(run);
    if (!kept) return kept.error();
    v1::PlanState state;
    if (kept->text().empty()) return state;
    const auto read = instruction::read_plan(*kept, dictionary);
    if (!read.plan)
        return Error{
            fmt::format("run {}: its plan breaks the rules of this version:\n{}", run.value, read.findings_text())};
    const auto interventions = all_interventions(reader, run);
    if (!interventions) return interventions.error();
    const auto rubric = plans.rubric();
    state.set_name(read.plan->id);
    state.set_title(read.plan->title);
    state.set_purpose(read.plan->purpose);
    state.set_scenario(read.plan->scenario);
    state.set_text(kept->text());
    for (const auto& inject : read.plan->injects) {
        auto& message = *state.add_injects();
        message = inject_message(inject, dictionary, rubric ? *rubric : instruction::Rubric{});
        const auto done = std::ranges::find(*interventions, inject.id, &v1::Intervention::inject);
        if (done == interventions->end()) continue;
        message.set_state(done->skipped() ? v1::PlannedInject::skipped : v1::PlannedInject::done);
        message.set_e_s(done->e_s());
    }
    return state;
}

}  // namespace aeolis::server
