// SPDX-License-Identifier: Apache-2.0
#include "server/api/rehearsal_score.hpp"

#include "server/api/plan_state.hpp"
#include "server/api/team_score.hpp"
#include "server/api/touchdown.hpp"
#include "server/archive/items.hpp"
#include "server/instruction/plan_reader.hpp"
#include "telemetry/text.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <map>

namespace aeolis::server {
namespace {

constexpr int missing_named = 6;  // timepoints

std::string count_of(std::uint64_t many, std::string_view one) {
    return fmt::format("{} {}{}", many, one, many == 1 ? "" : "s");
}

double mean(const std::vector<double>& shares) {
    double sum = 0.0;
    for (const double share : shares) sum += share;
    return sum / static_cast<double>(shares.size());
}

void add_fact(v1::Score& score, std::string_view of, std::string text, std::optional<double> e_s = {}) {
    auto& fact = *score.add_facts();
    fact.set_of(std::string{of});
    fact.set_text(std::move(text));
    if (e_s) fact.set_e_s(*e_s);
}

std::string outcome_words(v1::Landing::Outcome outcome) {
    switch (outcome) {
    case v1::Landing::impact: return "hit the ground too fast";
    case v1::Landing::not_commanded: return "the cruise stage was not commanded to separate";
    case v1::Landing::timeout: return "ended by its time limit";
    default: return in_words(v1::Landing::Outcome_Name(outcome));
    }
}

class Judge {
  public:
    Judge(const ScoreFacts& facts, const dictionary::Dictionary& dictionary, const instruction::Rubric& rubric)
        : facts_(facts), dictionary_(dictionary), rubric_(rubric),
          acts_(acts_of(facts.report, facts.alarms, facts.room, facts.heard, facts.end, dictionary)) {}

    v1::Score score() {
        auto team = judge_team(team_case());
        if (const auto& run = facts_.report.run(); run.has_forked_from())
            add_fact(score_, "landing",
                     fmt::format("forked from run {}: what was done before is that run's", run.forked_from().run()),
                     run.forked_from().e_s());
        add_landing();
        add_timepoints();
        add_data();
        add_alarms();
        for (auto& fault : team.faults) *score_.add_facts() = std::move(fault);
        for (auto& fault : team.injected) *score_.add_faults() = std::move(fault);
        for (const auto& act : acts_.acts) *score_.add_acts() = act.told();
        add_commands();
        add_team(std::move(team));
        double points = 0.0;
        for (const auto& term : score_.terms()) points += term.points();
        score_.set_sum(points);
        score_.set_rule(fmt::format(
            "A rule of Aeolis, no verdict on people: the rubric “{}”. The landing itself is worth {:.0f} of 100 "
            "points; the rest is the team's, over what there was to judge: if there was nothing of a kind, the others "
            "count more, and if nothing was expected of anybody, the rest is not given. What nobody could see is not "
            "judged, nor what there was no time for, nor what fell into a jump of time, nor what people did once it "
            "was over. What comes later than its limit earns less, and after twice the limit nothing; an alarm's "
            "acknowledgement counts in full within {:.0f} s and not at all after {:.0f} s. A line of the log is found "
            "by its words, and serves one fault: read it, too. Times are the run's: at 10× a second of yours is ten "
            "of them.",
            rubric_.title, rubric_.landing_worth, rubric_.alarm_within_s, rubric_.alarm_until_s));
        return std::move(score_);
    }

  private:
    TeamCase team_case() const {
        const auto& run = facts_.report.run();
        TeamCase judged{rubric_, facts_.plan ? &*facts_.plan : nullptr, facts_.interventions, acts_};
        judged.light_time_s = run.light_time_s();
        judged.jumps = facts_.jumps;
        if (run.has_forked_from()) judged.from_e_s = run.forked_from().e_s();
        if (facts_.end) judged.until_e_s = archive::sclk_at_ert(run, *facts_.end).seconds - run.entry_sclk();
        return judged;
    }

    void add_term(std::string_view name, double worth, double share, std::string why) {
        auto& term = *score_.add_terms();
        term.set_name(std::string{name});
        term.set_worth(worth);
        term.set_points(worth * share);
        term.set_why(std::move(why));
    }

    /// A term for each skill that there was something to judge by; together they are worth what the landing is not.
    void add_team(TeamPoints&& team) {
        using instruction::Skill;
        std::map<Skill, std::vector<v1::ScorePoint>> by_skill;
        for (auto& [of, point] : team.points) by_skill[of].push_back(std::move(point));
        double judged = 0.0;
        for (const auto& [skill, points] : by_skill) judged += rubric_.worth[static_cast<std::size_t>(skill)];
        for (auto& [skill, points] : by_skill) {
            std::vector<double> shares;
            for (const auto& point : points) shares.push_back(point.share());
            const double worth = rubric_.worth[static_cast<std::size_t>(skill)];
            add_term(instruction::name_of(skill), judged > 0.0 ? worth * (100.0 - rubric_.landing_worth) / judged : 0.0,
                     mean(shares), fmt::format("{} judged", count_of(points.size(), "point")));
            auto& term = *score_.mutable_terms(score_.terms_size() - 1);
            for (auto& point : points) *term.add_judged() = std::move(point);
        }
    }

    void add_landing() {
        const auto outcome = facts_.report.run().outcome();
        const auto words = outcome_words(outcome);
        const auto& landed = facts_.landed;
        add_fact(score_, "landing", words, landed ? std::optional{landed->e_s} : std::nullopt);
        if (landed) add_fact(score_, "landing", landed->words);
        if (landed && landed->miss_m)
            add_fact(
                score_, "landing",
                fmt::format("{:.1f} km from the target, by the vehicle's own navigation", *landed->miss_m / 1000.0));
        add_term("landing", rubric_.landing_worth, outcome == v1::Landing::touchdown ? 1.0 : 0.0, words);
    }

    void add_timepoints() {
        const int all = facts_.report.timepoints_size();
        std::vector<std::string> missing;
        for (const auto& row : facts_.report.timepoints())
            if (!row.has_recorded_e_s() && !row.has_realtime_e_s() && !row.has_tone_e_s())
                missing.push_back(in_words(row.name()));
        const int fired = all - static_cast<int>(missing.size());
        auto text = fmt::format("{} of {} are known to have fired", fired, all);
        for (std::size_t i = 0; i < missing.size() && i < missing_named; ++i)
            text += (i == 0 ? "; not: " : ", ") + missing[i];
        if (missing.size() > missing_named) text += " …";
        add_fact(score_, "timepoints", std::move(text));
    }

    void add_data() {
        std::uint64_t realtime = 0, missing = 0, differs = 0, lost = 0;
        for (const auto& row : facts_.report.proof().streams())
            realtime += row.realtime(), missing += row.missing_in_recording(), differs += row.differs();
        for (const auto& row : facts_.report.proof().counters()) lost += row.missing_frames() + row.bad_crc();
        add_fact(score_, "data",
                 fmt::format("{} heard live: {} missing in the recording, {} differ from it; {} lost on the way",
                             count_of(realtime, "packet"), missing, differs, count_of(lost, "frame")));
        add_fact(score_, "data",
                 fmt::format("{} decoded, {} lost", count_of(facts_.report.tones_decoded(), "tone"),
                             facts_.report.tones_erased()));
    }

    void add_alarms() {
        for (const auto& [name, limit, e_s, acknowledged] : acts_.raised.all)
            add_fact(score_, "alarm",
                     fmt::format("{} {}; {}", in_words(name), limit,
                                 acknowledged
                                     ? fmt::format("acknowledged {} later by {}",
                                                   telemetry::span_text(acknowledged->after_s), acknowledged->by)
                                     : "never acknowledged"),
                     e_s);
    }

    void add_sent(bool by_people) {
        using How = CommandOutcome::How;
        std::map<How, int> many;
        int all = 0;
        for (const auto& command : acts_.commands)
            if (command.sender.has_value() == by_people) ++many[command.how], ++all;
        if (all == 0 && !by_people) return;
        add_fact(score_, "commands",
                 fmt::format("{} {}: {} carried out, {} failed, {} cancelled, {} not known",
                             count_of(static_cast<std::uint64_t>(all), "command"),
                             by_people ? "of people" : "of the scenario's script", many[How::done], many[How::failed],
                             many[How::cancelled], many[How::not_known]));
    }

    bool is_hazardous(const std::string& name) const {
        const auto* command = dictionary_.command(name);
        return command != nullptr && command->significance >= dictionary::Significance::critical;
    }

    void add_commands() {
        using How = CommandOutcome::How;
        add_sent(true);
        add_sent(false);
        for (const auto& command : acts_.commands)
            if (command.how == How::failed || command.how == How::cancelled)
                add_fact(score_, "command",
                         fmt::format("{} {}{}{}: {}", command.number, command.name,
                                     is_hazardous(command.name) ? ", hazardous" : "",
                                     command.sender ? ", by " + *command.sender : "", command.why),
                         command.e_s);
    }

    const ScoreFacts& facts_;
    const dictionary::Dictionary& dictionary_;
    const instruction::Rubric& rubric_;
    ScoreActs acts_;
    v1::Score score_;
};

Result<void> add_alarm_items(archive::Reader& reader, archive::RunId run, ScoreFacts& facts) {
    for (archive::Sequence after = 0;;) {
        auto page = reader.alarms(run, after, archive::rows_page_max);
        if (!page) return page.error();
        facts.alarms.insert(facts.alarms.end(), page->changes().begin(), page->changes().end());
        if (facts.alarms.size() > scored_alarms_max)
            return Error{fmt::format("run {} has more than {} changes of alarms: no score is made of a part", run.value,
                                     scored_alarms_max)};
        if (page->next_after() == 0) return {};
        after = page->next_after();
    }
}

/// What people did with procedures and positions.
Result<void> add_room(archive::Reader& reader, archive::RunId run, ScoreFacts& facts) {
    const auto begun = reader.procedures(run);
    if (!begun) return begun.error();
    for (const auto& item : *begun) {
        auto acts = reader.procedure_acts(run, item.procedure().number());
        if (!acts) return acts.error();
        std::ranges::move(*acts, std::back_inserter(facts.room));
    }
    auto acts = reader.position_acts(run);
    if (!acts) return acts.error();
    std::ranges::move(*acts, std::back_inserter(facts.room));
    return {};
}

/// What was received of the vehicle's own reports: events but for diagnostic ones, and tones.
Result<void> add_heard(archive::Reader& reader, archive::RunId run, ScoreFacts& facts) {
    archive::EventQuery events;
    for (const auto level :
         {dictionary::EventLevel::fatal, dictionary::EventLevel::warning_hi, dictionary::EventLevel::warning_lo,
          dictionary::EventLevel::command, dictionary::EventLevel::activity_hi, dictionary::EventLevel::activity_lo})
        events.levels.emplace_back(telemetry::name_of(level));
    events.limit = archive::rows_page_max;
    do {
        auto page = reader.events(run, events);
        if (!page) return page.error();
        facts.heard.insert(facts.heard.end(), page->events().begin(), page->events().end());
        if (facts.heard.size() > scored_heard_max)
            return Error{fmt::format("run {} has more than {} reports: no score is made of a part", run.value,
                                     scored_heard_max)};
        events.after = page->next_after();
    } while (events.after != 0);
    archive::ToneQuery tones;
    do {
        auto page = reader.tones(run, tones);
        if (!page) return page.error();
        facts.heard.insert(facts.heard.end(), page->tones().begin(), page->tones().end());
        tones.after = page->next_after();
    } while (tones.after != 0);
    return {};
}

Result<void> add_plan(archive::Reader& reader, archive::RunId run, const dictionary::Dictionary& dictionary,
                      ScoreFacts& facts) {
    const auto kept = reader.instructor_plan(run);
    if (!kept) return kept.error();
    if (kept->text().empty()) return {};
    auto read = instruction::read_plan(*kept, dictionary);
    if (!read.plan)
        return Error{
            fmt::format("run {}: its plan breaks the rules of this version:\n{}", run.value, read.findings_text())};
    facts.plan = std::move(read.plan);
    return {};
}

Result<void> add_landed(archive::Reader& reader, archive::RunId run, const dictionary::Dictionary& dictionary,
                        ScoreFacts& facts) {
    const auto report = touchdown(reader, run, dictionary, {}, {}, true);
    if (!report) return report.error();
    const auto events = reader.events(run, {{}, {}, std::string{telemetry::touchdown_event}});
    if (!events) return events.error();
    for (const auto& item : events->events()) {
        if (item.event().name() != telemetry::touchdown_event) continue;
        facts.landed =
            ScoreFacts::Landed{item.event().sclk() - facts.report.run().entry_sclk(), item.event().text(), {}};
        if (report->has_place()) facts.landed->miss_m = std::hypot(report->place().east_m(), report->place().north_m());
        return {};
    }
    return {};
}

}  // namespace

v1::Score score_of(const ScoreFacts& facts, const dictionary::Dictionary& dictionary,
                   const instruction::Rubric& rubric) {
    return Judge{facts, dictionary, rubric}.score();
}

Result<v1::AsFlownReport> whole_report(archive::Reader& reader, archive::RunId run) {
    auto report = reader.as_flown(run);
    if (!report) return report;
    while (report->commands_next_after() != 0) {
        auto page = reader.commands(run, {{}, {}, report->commands_next_after()});
        if (!page) return page.error();
        report->mutable_commands()->MergeFrom(page->commands());
        report->set_commands_next_after(page->next_after());
    }
    while (report->notes_next_after() != 0) {
        auto page = reader.notes(run, {{}, report->notes_next_after()});
        if (!page) return page.error();
        report->mutable_notes()->MergeFrom(page->notes());
        report->set_notes_next_after(page->next_after());
    }
    return report;
}

bool has_score(const v1::RunState& run) {
    return run.state() == v1::RunState::finished && run.venue() != "downlink";
}

Result<ScoreFacts> score_facts(archive::Reader& reader, v1::AsFlownReport report,
                               const dictionary::Dictionary& dictionary) {
    const archive::RunId run{static_cast<std::uint32_t>(report.run().run())};
    ScoreFacts facts;
    facts.report = std::move(report);
    if (auto done = add_alarm_items(reader, run, facts); !done) return done.error();
    auto interventions = all_interventions(reader, run);
    if (!interventions) return interventions.error();
    facts.interventions = std::move(*interventions);
    auto jumps = reader.jumps(run);
    if (!jumps) return jumps.error();
    facts.jumps = std::move(*jumps);
    if (auto done = add_room(reader, run, facts); !done) return done.error();
    if (auto done = add_heard(reader, run, facts); !done) return done.error();
    if (auto done = add_plan(reader, run, dictionary, facts); !done) return done.error();
    if (auto done = add_landed(reader, run, dictionary, facts); !done) return done.error();
    const auto last = reader.last_seq(run);
    if (!last) return last.error();
    if (*last == 0) return facts;
    const auto page = reader.items(run, *last - 1, 1);
    if (!page) return page.error();
    if (!page->items.empty()) facts.end = Ert{page->items.back().ert_us()};
    return facts;
}

Result<v1::Score> rehearsal_score(archive::Reader& reader, v1::AsFlownReport report,
                                  const dictionary::Dictionary& dictionary, const instruction::Rubric& rubric) {
    const auto facts = score_facts(reader, std::move(report), dictionary);
    if (!facts) return facts.error();
    return score_of(*facts, dictionary, rubric);
}

}  // namespace aeolis::server
