// SPDX-License-Identifier: Apache-2.0
#include "server/api/rehearsal_score.hpp"

#include "common/entry_time.hpp"
#include "server/api/touchdown.hpp"
#include "server/archive/items.hpp"
#include "telemetry/text.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <set>

namespace aeolis::server {
namespace {

// All chosen: the worth of each term in points, and the bounds of promptness.
constexpr double landing_worth = 40.0, timepoints_worth = 20.0, faults_worth = 20.0, alarms_worth = 10.0,
                 commands_worth = 10.0;
constexpr double quick_s = 30.0;                                              // full worth up to here
constexpr double late_s = 300.0;                                              // no worth from here on
constexpr int missing_named = 6;                                              // timepoints
constexpr std::string_view of_script = "asked for by the scenario's script";  // the gateway's words

std::string in_words(std::string name) {
    std::ranges::transform(name, name.begin(), [](unsigned char letter) {
        return letter == '_' ? ' ' : static_cast<char>(std::tolower(letter));
    });
    return name;
}

std::string count_of(std::uint64_t many, std::string_view one) {
    return fmt::format("{} {}{}", many, one, many == 1 ? "" : "s");
}

std::string or_someone(const std::string& who, const char* otherwise = "someone") {
    return who.empty() ? otherwise : who;
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

void add_term(v1::Score& score, std::string_view name, double worth, double share, std::string why) {
    auto& term = *score.add_terms();
    term.set_name(std::string{name});
    term.set_worth(worth);
    term.set_points(worth * share);
    term.set_why(std::move(why));
}

struct Acknowledged {
    double after_s = 0.0;
    std::string by;
};
struct Raised {
    std::string name, limit;
    double e_s = 0.0;
    std::optional<Acknowledged> acknowledged{};
};

/// Each alarm from its raising, or its raising again, to the first acknowledgement.
class RaisedAlarms {
  public:
    std::vector<Raised> all;

    void take_raised(const std::string& name, std::string limit, double e_s) {
        const auto known = open_.find(name);
        const bool again = known != open_.end() && all[known->second].acknowledged && inside_.contains(name);
        inside_.erase(name);
        if (known != open_.end() && !again) return;
        open_[name] = all.size();
        all.push_back({name, std::move(limit), e_s});
    }
    void take_inside(const std::string& name) { inside_.insert(name); }
    void take_acknowledged(const v1::AlarmAction& action, double e_s) {
        const auto known = open_.find(action.alarm());
        if (known == open_.end() || all[known->second].acknowledged) return;
        auto& raised = all[known->second];
        raised.acknowledged = Acknowledged{e_s - raised.e_s, or_someone(action.by(), "unsigned")};
    }

  private:
    std::map<std::string, std::size_t> open_;  ///< outside its limits, or not acknowledged yet: its place in `all`
    std::set<std::string> inside_;
};

struct CommandOutcome {
    enum class How : std::uint8_t { done, failed, cancelled, not_known };
    std::string name;
    std::uint64_t number = 0;
    std::optional<double> e_s{};
    How how = How::not_known;
    std::string why{};
    std::optional<std::string> sender{};  ///< who signed it; none: the scenario's script
};

/// The sender by the evidence of the stage authorised: "no arming needed, by Ann; left to flight: …".
std::string signature_in(const std::string& evidence) {
    for (const std::string_view begin : {"armed and confirmed by name, by ", "no arming needed, by "})
        if (evidence.starts_with(begin))
            return evidence.substr(begin.size(), evidence.find("; left to flight: ") - begin.size());
    return {};
}

/// What a person did, and when.
struct Act {
    double e_s = 0.0;
    std::string words;
};

std::string device_words(const std::string& name, std::string_view prefix) {
    return in_words(name.substr(prefix.size()));
}
std::string fault_words(const v1::FaultInjection& injected) {
    if (injected.has_device_fault()) {
        const auto& fault = injected.device_fault();
        return fmt::format("{} {} {}, for {} s", device_words(v1::Device_Name(fault.device()), "DEVICE_"),
                           v1::RedundantUnit_Name(fault.unit()).back(),
                           device_words(v1::DeviceFaultKind_Name(fault.kind()), "DEVICE_FAULT_KIND_"),
                           fault.duration_s());
    }
    if (injected.has_station_outage())
        return fmt::format("the ground station brings nothing, for {} s", injected.station_outage().duration_s());
    if (injected.has_system_fault())
        return fmt::format("a system outside EDL, for {} s", injected.system_fault().duration_s());
    return "the prime computer starts anew";
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
    Judge(const ScoreFacts& facts, const dictionary::Dictionary& dictionary) : facts_(facts), dictionary_(dictionary) {
        for (const auto& item : facts_.alarms) take_alarm(item);
        for (const auto& command : facts_.report.commands()) commands_.push_back(outcome_of(command));
        collect_acts();
    }

    v1::Score score() {
        add_landing();
        add_timepoints();
        add_data();
        add_alarms();
        add_faults();
        add_commands();
        double worth = 0.0, points = 0.0;
        for (const auto& term : score_.terms()) worth += term.worth(), points += term.points();
        score_.set_sum(100.0 * points / worth);
        score_.set_rule(fmt::format(
            "A rule of Aeolis, no verdict on people: the points of each term that there was something to judge by, as "
            "a share of what all of those are worth. Commands of the scenario's script do not count. Within {:.0f} s a "
            "reaction counts in full, after {:.0f} s not at all. Times are the run's: at 10× a second of yours is ten "
            "of them.",
            quick_s, late_s));
        return std::move(score_);
    }

  private:
    double e_s_of(const v1::Item& item) const {
        return archive::sclk_at_ert(facts_.report.run(), Ert{item.ert_us()}).seconds - facts_.report.run().entry_sclk();
    }

    void take_alarm(const v1::Item& item) {
        const double e_s = e_s_of(item);
        if (item.has_alarm()) {
            const auto& alarm = item.alarm();
            const auto& name = dictionary_.channels.at(alarm.channel()).name;
            if (alarm.severity() == v1::Alarm::none) return raised_.take_inside(name);
            raised_.take_raised(name, alarm.limit(), alarm.sclk() - facts_.report.run().entry_sclk());
        } else if (item.has_link()) {
            if (!item.link().lost()) return raised_.take_inside(item.link().link());
            raised_.take_raised(item.link().link(), "lost", e_s);
        } else if (item.has_staleness()) {
            if (!item.staleness().missing()) return raised_.take_inside(item.staleness().packet());
            raised_.take_raised(item.staleness().packet(), "silent", e_s);
        } else if (item.has_alarm_action() && item.alarm_action().action() == v1::AlarmAction::acknowledge) {
            raised_.take_acknowledged(item.alarm_action(), e_s);
        }
    }

    /// By the last word on each stage.
    CommandOutcome outcome_of(const v1::CommandHistory& command) const {
        using How = CommandOutcome::How;
        CommandOutcome outcome{.name = command.name(), .number = command.command()};
        if (!command.stages().empty()) outcome.e_s = e_s_of(command.stages(0));
        std::map<v1::CommandStage::Stage, const v1::CommandStage*> last;
        bool script = false;
        std::string signature;
        for (const auto& item : command.stages()) {
            const auto& stage = item.command_stage();
            last[stage.stage()] = &stage;
            if (stage.stage() == v1::CommandStage::queued && stage.evidence().starts_with(of_script)) script = true;
            if (stage.stage() == v1::CommandStage::authorised && signature.empty())
                signature = signature_in(stage.evidence());
        }
        const auto failed = std::ranges::find_if(
            last, [](const auto& each) { return each.second->status() == v1::CommandStage::failed; });
        if (failed != last.end()) {
            outcome.why = failed->second->evidence();
            outcome.how = outcome.why.starts_with("cancelled") ? How::cancelled : How::failed;
        } else if (last.contains(v1::CommandStage::executed) && std::ranges::all_of(last, [](const auto& each) {
                       return each.second->status() == v1::CommandStage::ok;
                   })) {
            outcome.how = How::done;
        }
        if (!script) outcome.sender = or_someone(signature);
        return outcome;
    }

    void collect_acts() {
        for (const auto& item : facts_.alarms)
            if (item.has_alarm_action())
                acts_.push_back({e_s_of(item), fmt::format("{}: {} {}", or_someone(item.alarm_action().by()),
                                                           v1::AlarmAction::Action_Name(item.alarm_action().action()),
                                                           item.alarm_action().alarm())});
        for (const auto& command : commands_)
            if (command.sender && command.e_s)
                acts_.push_back({*command.e_s, fmt::format("{}: sent {}", *command.sender, command.name)});
        for (const auto& item : facts_.report.notes())
            acts_.push_back(
                {e_s_of(item), fmt::format("{} wrote “{}”", or_someone(item.note().by()), item.note().text())});
        std::ranges::stable_sort(acts_, {}, &Act::e_s);
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
        add_term(score_, "landing", landing_worth, outcome == v1::Landing::touchdown ? 1.0 : 0.0, words);
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
        if (all > 0)
            add_term(score_, "timepoints", timepoints_worth, static_cast<double>(fired) / all,
                     fmt::format("{} of {}", fired, all));
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
        std::vector<double> shares;
        for (const auto& [name, limit, e_s, acknowledged] : raised_.all) {
            shares.push_back(promptness(acknowledged ? std::optional{acknowledged->after_s} : std::nullopt));
            add_fact(score_, "alarm",
                     fmt::format("{} {}; {}", in_words(name), limit,
                                 acknowledged
                                     ? fmt::format("acknowledged {} later by {}",
                                                   telemetry::span_text(acknowledged->after_s), acknowledged->by)
                                     : "never acknowledged"),
                     e_s);
        }
        if (!shares.empty())
            add_term(score_, "alarms", alarms_worth, mean(shares),
                     fmt::format("{}, by the acknowledgement", count_of(shares.size(), "alarm")));
    }

    /// From when a fault's effect can be heard on Earth to the first thing that a person did.
    void add_faults() {
        std::vector<double> shares;
        for (const auto& intervention : facts_.interventions) {
            if (!intervention.has_fault()) continue;
            // A station's outage is felt on Earth itself.
            const bool on_earth = intervention.fault().has_station_outage();
            const double felt_s = intervention.e_s() - (on_earth ? facts_.report.run().light_time_s() : 0.0);
            const auto first = std::ranges::find_if(acts_, [&](const Act& act) { return act.e_s >= felt_s; });
            const bool any = first != acts_.end();
            shares.push_back(promptness(any ? std::optional{first->e_s - felt_s} : std::nullopt));
            add_fact(
                score_, "fault",
                fmt::format("{}; {}", fault_words(intervention.fault()),
                            any ? fmt::format("{} later: {}", telemetry::span_text(first->e_s - felt_s), first->words)
                                : "nobody did anything afterwards"),
                felt_s);
        }
        if (!shares.empty())
            add_term(score_, "faults", faults_worth, mean(shares),
                     fmt::format("{}, by the first reaction", count_of(shares.size(), "fault")));
    }

    void add_sent(bool by_people) {
        using How = CommandOutcome::How;
        std::map<How, int> many;
        int all = 0;
        for (const auto& command : commands_)
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
        int judged = 0, done = 0;
        for (const auto& command : commands_) {
            if (command.how == How::failed || command.how == How::cancelled)
                add_fact(score_, "command",
                         fmt::format("{} {}{}{}: {}", command.number, command.name,
                                     is_hazardous(command.name) ? ", hazardous" : "",
                                     command.sender ? ", by " + *command.sender : "", command.why),
                         command.e_s);
            if (!command.sender || command.how == How::cancelled) continue;
            ++judged;
            if (command.how == How::done) ++done;
        }
        if (judged > 0)
            add_term(score_, "commands", commands_worth, static_cast<double>(done) / judged,
                     fmt::format("{} of {} of people were carried out", done, judged));
    }

    const ScoreFacts& facts_;
    const dictionary::Dictionary& dictionary_;
    RaisedAlarms raised_;
    std::vector<CommandOutcome> commands_;
    std::vector<Act> acts_;  ///< by time
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

Result<void> add_interventions(archive::Reader& reader, archive::RunId run, ScoreFacts& facts) {
    for (std::uint64_t after = 0;;) {
        auto page = reader.interventions(run, {.after = after});
        if (!page) return page.error();
        facts.interventions.insert(facts.interventions.end(), page->interventions().begin(),
                                   page->interventions().end());
        if (page->next_after() == 0) return {};
        after = page->next_after();
    }
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

double promptness(std::optional<double> after_s) {
    return after_s ? std::clamp((late_s - *after_s) / (late_s - quick_s), 0.0, 1.0) : 0.0;
}

v1::Score score_of(const ScoreFacts& facts, const dictionary::Dictionary& dictionary) {
    return Judge{facts, dictionary}.score();
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

Result<v1::Score> rehearsal_score(archive::Reader& reader, v1::AsFlownReport report,
                                  const dictionary::Dictionary& dictionary) {
    const archive::RunId run{static_cast<std::uint32_t>(report.run().run())};
    ScoreFacts facts;
    facts.report = std::move(report);
    if (auto done = add_alarm_items(reader, run, facts); !done) return done.error();
    if (auto done = add_interventions(reader, run, facts); !done) return done.error();
    if (auto done = add_landed(reader, run, dictionary, facts); !done) return done.error();
    return score_of(facts, dictionary);
}

}  // namespace aeolis::server
