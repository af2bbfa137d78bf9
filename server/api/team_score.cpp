// SPDX-License-Identifier: Apache-2.0
#include "server/api/team_score.hpp"

#include "telemetry/text.hpp"

#include <algorithm>
#include <cctype>
#include <fmt/format.h>
#include <map>
#include <set>
#include <utility>

namespace aeolis::server {
namespace {

using instruction::Expectation;
using instruction::Handling;
using instruction::Skill;
using Act = Expectation::Act;

constexpr double early_s = 1.0;     ///< chosen: an alarm raised so much before the fault was felt is still of it
constexpr double follows_s = 60.0;  ///< chosen: what is raised up to so long after the fault is over may come of it
constexpr double signs_until_s = 300.0;  ///< chosen: signs come up to so long after the fault is over
constexpr double stamped_s = 1.0;        ///< chosen: at a fast pace an act is stamped so much before what it answers
constexpr std::size_t causes_max = 4;    ///< chosen: a line that names more causes than that is no diagnosis
constexpr double fades_by = 2.0;         ///< chosen: what comes later than so many times its limit earns nothing

std::string in_lower_case(std::string_view text) {
    std::string lower{text};
    std::ranges::transform(lower, lower.begin(), [](unsigned char letter) { return std::tolower(letter); });
    return lower;
}

bool is_letter(char one) {
    return std::isalnum(static_cast<unsigned char>(one)) != 0;
}

/// What a person says in a line of the log. An anomaly report is the console's own words but for its first line, in
/// which its author names the cause.
std::string_view said_in(std::string_view note) {
    return note.starts_with("Anomaly report:") ? note.substr(0, note.find('\n')) : note;
}

/// Whether a text in lower case has this word or phrase, whole, or with an s behind it.
bool has_word(std::string_view text, std::string_view word) {
    for (auto at = text.find(word); at != std::string_view::npos; at = text.find(word, at + 1)) {
        auto end = at + word.size();
        if (end < text.size() && text[end] == 's') ++end;
        if ((at == 0 || !is_letter(text[at - 1])) && (end == text.size() || !is_letter(text[end]))) return true;
    }
    return false;
}

bool has_any(const std::string& text, const std::vector<std::string>& words) {
    const auto lower = in_lower_case(said_in(text));
    return words.empty() ||
           std::ranges::any_of(words, [&](const std::string& word) { return has_word(lower, in_lower_case(word)); });
}

bool is_in(const std::string& name, const std::vector<std::string>& names) {
    return std::ranges::find(names, name) != names.end();
}

double duration_s(const v1::FaultInjection& fault) {
    switch (fault.fault_case()) {
    case v1::FaultInjection::kDeviceFault: return fault.device_fault().duration_s();
    case v1::FaultInjection::kStationOutage: return fault.station_outage().duration_s();
    case v1::FaultInjection::kSystemFault: return fault.system_fault().duration_s();
    case v1::FaultInjection::kOrbiterOutage: return fault.orbiter_outage().duration_s();
    case v1::FaultInjection::kUhfLoss: return fault.uhf_loss().duration_s();
    case v1::FaultInjection::kWindShift: return fault.wind_shift().duration_s();
    case v1::FaultInjection::kAirShift: return fault.air_shift().duration_s();
    case v1::FaultInjection::kFalseTone: return fault.false_tone().duration_s();
    case v1::FaultInjection::kSensorError: return fault.sensor_error().duration_s();
    case v1::FaultInjection::kComputerReset:
    case v1::FaultInjection::FAULT_NOT_SET: break;
    }
    return 0.0;
}

std::string later(double after_s) {
    return telemetry::span_text(std::max(after_s, 0.0)) + " later";
}

struct Sign {
    double e_s = 0.0;
    std::string name;  ///< empty: none is listed, and the fault itself counts
};

class TeamJudge {
  public:
    explicit TeamJudge(const TeamCase& judged) : judged_(judged), acts_(judged.acts) {}

    TeamPoints judge() {
        collect_causes();
        for (const auto& intervention : judged_.interventions)
            if (intervention.has_fault()) judge_fault(intervention);
        judge_other_alarms();
        judge_calls();
        judge_failed_commands();
        std::ranges::stable_sort(judged_points_.points, {}, [](const auto& each) { return each.point.e_s(); });
        return std::move(judged_points_);
    }

  private:
    v1::ScorePoint& add(Skill of, std::string expected, double e_s, double share, std::string evidence) {
        auto& point = judged_points_.points.emplace_back(TeamPoints::Point{of, {}}).point;
        point.set_expected(std::move(expected));
        point.set_e_s(e_s);
        point.set_share(share);
        point.set_evidence(std::move(evidence));
        point.set_inject(inject_);
        return point;
    }

    const Handling& handling_of(const v1::Intervention& intervention) const {
        if (judged_.plan != nullptr && !intervention.inject().empty()) {
            const auto& injects = judged_.plan->injects;
            const auto inject = std::ranges::find(injects, intervention.inject(), &instruction::Inject::id);
            if (inject != injects.end() && !inject->handling.team.empty()) return inject->handling;
        }
        return judged_.rubric.handling_of(intervention.fault());
    }

    /// The words by which a cause is named, each kind of fault its own, by the rubric and the plan.
    void collect_causes() {
        const auto take = [&](const Handling& handling) {
            for (const auto& expectation : handling.team)
                if (expectation.of == Skill::diagnosis && expectation.act == Act::note && !expectation.names.empty())
                    causes_.insert(expectation.names);
        };
        for (const auto& each : judged_.rubric.faults) take(each.handling);
        if (judged_.plan != nullptr)
            for (const auto& inject : judged_.plan->injects) take(inject.handling);
    }

    /// Whether a line of the log answers an expectation. A line counts for one fault only and where it says something
    /// new; and who names every cause has found none.
    bool answers(std::size_t act, const Expectation& expectation) const {
        const auto& note = acts_.acts[act];
        if (note.kind != PersonsAct::Kind::note || note.without_effect || !has_any(note.about, expectation.names))
            return false;
        const auto used = used_for_.find(act);
        if (used != used_for_.end() && used->second != judging_) return false;
        const auto before = std::ranges::find(acts_.acts, note.about, &PersonsAct::about);
        if (before != acts_.acts.begin() + static_cast<std::ptrdiff_t>(act)) return false;
        return expectation.of != Skill::diagnosis || std::ranges::count_if(causes_, [&](const auto& names) {
                                                         return has_any(note.about, names);
                                                     }) <= static_cast<std::ptrdiff_t>(causes_max);
    }

    /// The first sign within the window; none: nothing showed.
    std::optional<Sign> first_sign(const Handling& handling, double felt_s, double until_s) const {
        if (handling.signs.empty()) return Sign{felt_s, ""};
        std::optional<Sign> first;
        const auto take = [&](const std::string& name, double e_s) {
            if (e_s >= felt_s - early_s && e_s <= until_s && (!first || e_s < first->e_s)) first = Sign{e_s, name};
        };
        for (const auto& [name, times] : acts_.heard)
            if (is_in(name, handling.signs))
                for (const double e_s : times) take(name, e_s);
        for (const auto& alarm : acts_.raised.all)
            if (is_in(alarm.name, handling.signs)) take(alarm.name, alarm.e_s);
        return first;
    }

    void judge_fault(const v1::Intervention& intervention) {
        const auto& handling = handling_of(intervention);
        // A station's outage is felt on Earth itself.
        const bool on_earth = intervention.fault().has_station_outage();
        const double felt_s = intervention.e_s() - (on_earth ? judged_.light_time_s : 0.0);
        const double until_s = felt_s + duration_s(intervention.fault()) + signs_until_s;
        const auto sign = first_sign(handling, felt_s, until_s);
        auto& injected = tell_fault(intervention, handling, felt_s, until_s, sign);
        if (intervention.e_s() < judged_.from_e_s) {
            injected.add_not_judged("all of it: it was done before the fork");
            return;
        }
        inject_ = intervention.inject();
        auto& fact = judged_points_.faults.emplace_back();
        fact.set_of("fault");
        fact.set_e_s(felt_s);
        fact.set_text(fmt::format("{}; {}", instruction::text_of(intervention.fault()), sign_words(sign, felt_s)));
        ++judging_;
        if (handling.team.empty()) injected.add_not_judged("all of it: nothing is expected of a team about it");
        for (const auto& expectation : handling.team)
            if (const auto why = judge_in_time(expectation, sign, felt_s, until_s); !why.empty())
                injected.add_not_judged(fmt::format("{}: {}", text_of(expectation), why));
        judge_consequences(felt_s, until_s);
        inject_.clear();
    }

    /// Why an expectation is not judged; empty: it was.
    std::string judge_in_time(const Expectation& expectation, const std::optional<Sign>& sign, double felt_s,
                              double until_s) {
        if (!sign) return "no sign of it was received";
        if (sign->e_s + expectation.within_s > judged_.until_e_s) return "the run ended before";
        const auto judged_before = judged_points_.points.size();
        if (expectation.act == Act::acknowledge) {
            if (!judge_acknowledgement(expectation, felt_s, until_s)) return "no such alarm was raised by it";
        } else {
            judge_expectation(expectation, *sign);
        }
        // What was done in time before the jump is earned; that nothing is done in one says nothing.
        const bool earned = expectation.act != Act::no_command && judged_points_.points.back().point.share() == 1.0;
        const double at_most = expectation.act == Act::no_command ? 1.0 : fades_by;
        if (earned || !jumped(sign->e_s, sign->e_s + at_most * expectation.within_s)) return "";
        judged_points_.points.resize(judged_before);
        return "the rehearsal jumped ahead meanwhile";
    }

    /// Whether the rehearsal jumped between two times at which word reached Earth.
    bool jumped(double from_s, double to_s) const {
        return std::ranges::any_of(judged_.jumps, [&](const v1::Jump& jump) {
            return jump.from_e_s() - judged_.light_time_s < to_s && jump.to_e_s() - judged_.light_time_s > from_s;
        });
    }

    v1::ScoreFault& tell_fault(const v1::Intervention& intervention, const Handling& handling, double felt_s,
                               double until_s, const std::optional<Sign>& first) {
        auto& told = judged_points_.injected.emplace_back();
        told.set_text(instruction::text_of(intervention.fault()));
        told.set_inject(intervention.inject());
        told.set_e_s(intervention.e_s());
        told.set_felt_e_s(felt_s);
        const auto earliest = [&](const std::map<std::string, std::vector<double>>& of, const std::string& name) {
            std::optional<double> found;
            if (const auto times = of.find(name); times != of.end())
                for (const double e_s : times->second)
                    if (e_s >= felt_s - early_s && e_s <= until_s && (!found || e_s < *found)) found = e_s;
            return found;
        };
        for (const auto& name : handling.signs) {
            auto& sign = *told.add_signs();
            sign.set_name(name);
            if (const auto e_s = earliest(acts_.on_board, name)) sign.set_on_board_e_s(*e_s);
            if (const auto heard = first_sign({{name}, {}}, felt_s, until_s)) sign.set_heard_e_s(heard->e_s);
        }
        if (!first) return told;
        told.set_seen_e_s(first->e_s);
        if (const auto act = first_act(first->e_s); act != acts_.acts.end()) *told.mutable_first_act() = act->told();
        return told;
    }

    std::vector<PersonsAct>::const_iterator first_act(double from_s) const {
        return std::ranges::find_if(acts_.acts, [&](const PersonsAct& act) { return act.e_s >= from_s - stamped_s; });
    }

    std::string sign_words(const std::optional<Sign>& sign, double felt_s) const {
        if (!sign) return "nothing that was received showed it";
        std::string words = sign->name.empty() ? "" : fmt::format("{}: {}; ", later(sign->e_s - felt_s), sign->name);
        const auto first = first_act(sign->e_s);
        if (first == acts_.acts.end()) return words + "nobody did anything afterwards";
        return words + fmt::format("first act {}: {}", later(first->e_s - sign->e_s), first->words());
    }

    void judge_expectation(const Expectation& expectation, const Sign& sign) {
        if (expectation.act == Act::no_command) return judge_restraint(expectation, sign.e_s);
        std::size_t done = 0;
        for (; done < acts_.acts.size(); ++done) {
            const auto& act = acts_.acts[done];
            if (act.e_s < sign.e_s - stamped_s) continue;
            if (expectation.act == Act::note ? answers(done, expectation)
                                             : act.kind == PersonsAct::Kind::command && !act.without_effect &&
                                                   is_in(act.about, expectation.names))
                break;
        }
        if (done == acts_.acts.size()) {
            add(expectation.of, text_of(expectation), sign.e_s, 0.0, "nobody did");
            return;
        }
        const auto& act = acts_.acts[done];
        if (expectation.act == Act::note) used_for_.emplace(done, judging_);
        const double after_s = act.e_s - sign.e_s;
        add(expectation.of, text_of(expectation), sign.e_s,
            instruction::share_of(after_s, expectation.within_s, fades_by * expectation.within_s),
            fmt::format("{}: {}", later(after_s), act.words()));
    }

    /// False: there was no such alarm.
    bool judge_acknowledgement(const Expectation& expectation, double felt_s, double until_s) {
        for (std::size_t i = 0; i < acts_.raised.all.size(); ++i) {
            const auto& alarm = acts_.raised.all[i];
            if (!is_in(alarm.name, expectation.names) || alarm.e_s < felt_s - early_s || alarm.e_s > until_s) continue;
            if (!judged_alarms_.insert(i).second) continue;  // it was another fault's
            const auto after_s = alarm.acknowledged ? std::optional{alarm.acknowledged->after_s} : std::nullopt;
            add(expectation.of, text_of(expectation), alarm.e_s,
                instruction::share_of(after_s, expectation.within_s, fades_by * expectation.within_s),
                acknowledgement_words(alarm));
            return true;
        }
        return false;
    }

    static std::string acknowledgement_words(const RaisedAlarm& alarm) {
        return alarm.acknowledged
                   ? fmt::format("acknowledged {} by {}", later(alarm.acknowledged->after_s), alarm.acknowledged->by)
                   : "never acknowledged";
    }

    /// Nothing is sent for so long, by somebody who was there: some act between a while before and the end of that time.
    void judge_restraint(const Expectation& expectation, double from_s) {
        const double until_s = from_s + expectation.within_s;
        const auto within = [&](const PersonsAct& act, double begin_s) {
            return act.e_s >= begin_s - stamped_s && act.e_s <= until_s;
        };
        const auto sent = std::ranges::find_if(acts_.acts, [&](const PersonsAct& act) {
            return act.kind == PersonsAct::Kind::command && within(act, from_s) &&
                   (expectation.names.empty() || is_in(act.about, expectation.names));
        });
        if (sent != acts_.acts.end()) {
            add(expectation.of, text_of(expectation), from_s, 0.0,
                fmt::format("{}: {}", later(sent->e_s - from_s), sent->words()));
            return;
        }
        const auto present = std::ranges::find_if(
            acts_.acts, [&](const PersonsAct& act) { return within(act, from_s - judged_.rubric.present_s); });
        const bool anybody = present != acts_.acts.end();
        add(expectation.of, text_of(expectation), from_s, anybody ? 1.0 : 0.0,
            anybody ? fmt::format("nothing was sent; somebody was there: {}", present->words())
                    : "nothing was sent, and nothing shows that anybody was there");
    }

    /// What else a fault raised: all of that together is one point, so that who acknowledges everything but the fault's
    /// own alarm earns little.
    void judge_consequences(double felt_s, double until_s) {
        double sum = 0.0, first_s = 0.0;
        std::size_t many = 0, acknowledged = 0;
        for (std::size_t i = 0; i < acts_.raised.all.size(); ++i) {
            const auto& alarm = acts_.raised.all[i];
            const bool of_fault = alarm.e_s >= felt_s - early_s && alarm.e_s <= until_s - signs_until_s + follows_s;
            if (!of_fault || !judged_alarms_.insert(i).second) continue;
            if (promptness(alarm) < 1.0 && jumped(alarm.e_s, alarm.e_s + judged_.rubric.alarm_until_s)) continue;
            if (many++ == 0) first_s = alarm.e_s;
            if (alarm.acknowledged) ++acknowledged;
            sum += promptness(alarm);
        }
        if (many > 0)
            add(Skill::detection, "acknowledges what else it raised, all as one", first_s,
                sum / static_cast<double>(many), fmt::format("{} of {} were acknowledged", acknowledged, many));
    }

    double promptness(const RaisedAlarm& alarm) const {
        return instruction::share_of(alarm.acknowledged ? std::optional{alarm.acknowledged->after_s} : std::nullopt,
                                     judged_.rubric.alarm_within_s, judged_.rubric.alarm_until_s);
    }

    void judge_other_alarms() {
        for (std::size_t i = 0; i < acts_.raised.all.size(); ++i) {
            const auto& alarm = acts_.raised.all[i];
            if (judged_alarms_.contains(i) || alarm.e_s < judged_.from_e_s) continue;
            if (promptness(alarm) < 1.0 && jumped(alarm.e_s, alarm.e_s + judged_.rubric.alarm_until_s)) continue;
            add(Skill::detection, fmt::format("acknowledges {} {}", in_words(alarm.name), alarm.limit), alarm.e_s,
                promptness(alarm), acknowledgement_words(alarm));
        }
    }

    void judge_calls() {
        for (const auto& [after, words, within_s] : judged_.rubric.calls) {
            const auto heard = acts_.heard.find(after);
            if (heard == acts_.heard.end() || heard->second.empty()) continue;  // nobody could know of it
            const double heard_s = *std::ranges::min_element(heard->second);
            if (heard_s < judged_.from_e_s || heard_s + within_s > judged_.until_e_s) continue;
            ++judging_;
            judge_expectation({Skill::communication, Act::note, words, within_s}, {heard_s, after});
            auto& point = judged_points_.points.back().point;
            point.set_expected(fmt::format("after {}: {}", in_words(after), point.expected()));
            if (point.share() < 1.0 && jumped(heard_s, heard_s + fades_by * within_s)) judged_points_.points.pop_back();
        }
    }

    void judge_failed_commands() {
        for (const auto& command : acts_.commands)
            if (command.sender && command.how == CommandOutcome::How::failed &&
                command.e_s.value_or(judged_.from_e_s) >= judged_.from_e_s)
                add(Skill::action, fmt::format("sends {} so that it is carried out", command.name),
                    command.e_s.value_or(0.0), 0.0, command.why);
    }

    const TeamCase& judged_;
    const ScoreActs& acts_;
    TeamPoints judged_points_;
    std::string inject_;                   ///< of whose fault is judged
    std::set<std::size_t> judged_alarms_;  ///< those of a fault, in raised.all
    std::set<std::vector<std::string>> causes_;
    std::size_t judging_ = 0;                      ///< counts the faults and calls
    std::map<std::size_t, std::size_t> used_for_;  ///< lines of the log, by act: for which of these
};

}  // namespace

TeamPoints judge_team(const TeamCase& judged) {
    return TeamJudge{judged}.judge();
}

}  // namespace aeolis::server
