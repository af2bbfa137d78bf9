// SPDX-License-Identifier: Apache-2.0
#include "server/api/team_score.hpp"

#include "telemetry/text.hpp"

#include <algorithm>
#include <cctype>
#include <fmt/format.h>
#include <limits>
#include <set>
#include <utility>

namespace aeolis::server {
namespace {

using instruction::Expectation;
using instruction::Handling;
using instruction::Skill;
using Act = Expectation::Act;

constexpr double early_s = 1.0;          ///< chosen: an alarm raised so much before the fault was felt is still of it
constexpr double signs_until_s = 300.0;  ///< chosen: signs come up to so long after the fault is over
constexpr double fades_by = 2.0;         ///< chosen: what comes later than so many times its limit earns nothing

std::string in_lower_case(std::string_view text) {
    std::string lower{text};
    std::ranges::transform(lower, lower.begin(), [](unsigned char letter) { return std::tolower(letter); });
    return lower;
}

bool has_any(const std::string& text, const std::vector<std::string>& words) {
    const auto lower = in_lower_case(text);
    return words.empty() || std::ranges::any_of(words, [&](const std::string& word) {
               return lower.find(in_lower_case(word)) != std::string::npos;
           });
}

bool is_in(const std::string& name, const std::vector<std::string>& names) {
    return std::ranges::find(names, name) != names.end();
}

double duration_s(const v1::FaultInjection& fault) {
    switch (fault.fault_case()) {
    case v1::FaultInjection::kDeviceFault: return fault.device_fault().duration_s();
    case v1::FaultInjection::kStationOutage: return fault.station_outage().duration_s();
    case v1::FaultInjection::kSystemFault: return fault.system_fault().duration_s();
    case v1::FaultInjection::kComputerReset:
    case v1::FaultInjection::FAULT_NOT_SET: break;
    }
    return 0.0;
}

struct Sign {
    double e_s = 0.0;
    std::string name;  ///< empty: none is listed, and the fault itself counts
};

class TeamJudge {
  public:
    explicit TeamJudge(const TeamCase& judged) : judged_(judged), acts_(judged.acts) {}

    TeamPoints judge() {
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
        inject_ = intervention.inject();
        auto& fact = judged_points_.faults.emplace_back();
        fact.set_of("fault");
        fact.set_e_s(felt_s);
        fact.set_text(fmt::format("{}; {}", instruction::text_of(intervention.fault()), sign_words(sign, felt_s)));
        if (!handling.team.empty()) {
            for (const auto& expectation : handling.team) {
                if (expectation.act == Act::no_command)
                    judge_restraint(expectation, sign ? sign->e_s : felt_s);
                else if (sign)
                    judge_expectation(expectation, *sign, felt_s, until_s);
            }
        }
        inject_.clear();
    }

    std::string sign_words(const std::optional<Sign>& sign, double felt_s) const {
        if (!sign) return "nothing that was received showed it";
        std::string words = sign->name.empty()
                                ? ""
                                : fmt::format("{} later: {}; ", telemetry::span_text(sign->e_s - felt_s), sign->name);
        const auto first =
            std::ranges::find_if(acts_.acts, [&](const PersonsAct& act) { return act.e_s >= sign->e_s; });
        if (first == acts_.acts.end()) return words + "nobody did anything afterwards";
        return words +
               fmt::format("first act {} later: {}", telemetry::span_text(first->e_s - sign->e_s), first->words);
    }

    void judge_expectation(const Expectation& expectation, const Sign& sign, double felt_s, double until_s) {
        if (expectation.act == Act::acknowledge) return judge_acknowledgement(expectation, felt_s, until_s);
        const bool note = expectation.act == Act::note;
        const auto done = std::ranges::find_if(acts_.acts, [&](const PersonsAct& act) {
            if (act.e_s < sign.e_s) return false;
            return note ? act.kind == PersonsAct::Kind::note && has_any(act.about, expectation.names)
                        : act.kind == PersonsAct::Kind::command && !act.without_effect &&
                              is_in(act.about, expectation.names);
        });
        const auto after_s = done == acts_.acts.end() ? std::nullopt : std::optional{done->e_s - sign.e_s};
        add(expectation.of, text_of(expectation), sign.e_s,
            instruction::share_of(after_s, expectation.within_s, fades_by * expectation.within_s),
            after_s ? fmt::format("{} later: {}", telemetry::span_text(*after_s), done->words) : "nobody did");
    }

    void judge_acknowledgement(const Expectation& expectation, double felt_s, double until_s) {
        for (std::size_t i = 0; i < acts_.raised.all.size(); ++i) {
            const auto& alarm = acts_.raised.all[i];
            if (!is_in(alarm.name, expectation.names) || alarm.e_s < felt_s - early_s || alarm.e_s > until_s) continue;
            judged_alarms_.insert(i);
            const auto after_s = alarm.acknowledged ? std::optional{alarm.acknowledged->after_s} : std::nullopt;
            add(expectation.of, text_of(expectation), alarm.e_s,
                instruction::share_of(after_s, expectation.within_s, fades_by * expectation.within_s),
                acknowledgement_words(alarm));
            return;
        }
    }

    static std::string acknowledgement_words(const RaisedAlarm& alarm) {
        return alarm.acknowledged
                   ? fmt::format("acknowledged {} later by {}", telemetry::span_text(alarm.acknowledged->after_s),
                                 alarm.acknowledged->by)
                   : "never acknowledged";
    }

    void judge_restraint(const Expectation& expectation, double from_s) {
        const double until_s = from_s + expectation.within_s;
        const auto sent = std::ranges::find_if(acts_.acts, [&](const PersonsAct& act) {
            return act.kind == PersonsAct::Kind::command && act.e_s >= from_s && act.e_s <= until_s &&
                   (expectation.names.empty() || is_in(act.about, expectation.names));
        });
        if (sent != acts_.acts.end()) {
            add(expectation.of, text_of(expectation), from_s, 0.0,
                fmt::format("{} later: {}", telemetry::span_text(sent->e_s - from_s), sent->words));
            return;
        }
        const auto present = std::ranges::find_if(acts_.acts, [&](const PersonsAct& act) {
            return act.e_s >= until_s - judged_.rubric.present_s - expectation.within_s && act.e_s <= until_s;
        });
        const bool anybody = present != acts_.acts.end();
        add(expectation.of, text_of(expectation), from_s, anybody ? 1.0 : 0.0,
            anybody ? fmt::format("nothing was sent; somebody was there: {}", present->words)
                    : "nothing was sent, and nothing shows that anybody was there");
    }

    void judge_other_alarms() {
        const auto& rubric = judged_.rubric;
        for (std::size_t i = 0; i < acts_.raised.all.size(); ++i) {
            if (judged_alarms_.contains(i)) continue;
            const auto& alarm = acts_.raised.all[i];
            const auto after_s = alarm.acknowledged ? std::optional{alarm.acknowledged->after_s} : std::nullopt;
            add(Skill::detection, fmt::format("acknowledges {} {}", in_words(alarm.name), alarm.limit), alarm.e_s,
                instruction::share_of(after_s, rubric.alarm_within_s, rubric.alarm_until_s),
                acknowledgement_words(alarm));
        }
    }

    void judge_calls() {
        for (const auto& [after, words, within_s] : judged_.rubric.calls) {
            const auto heard = acts_.heard.find(after);
            if (heard == acts_.heard.end() || heard->second.empty()) continue;  // nobody could know of it
            const Expectation expectation{Skill::communication, Act::note, words, within_s};
            judge_expectation(expectation, {*std::ranges::min_element(heard->second), after}, 0.0, 0.0);
            auto& point = judged_points_.points.back().point;
            point.set_expected(fmt::format("after {}: {}", in_words(after), point.expected()));
        }
    }

    void judge_failed_commands() {
        for (const auto& command : acts_.commands)
            if (command.sender && command.how == CommandOutcome::How::failed)
                add(Skill::action, fmt::format("sends {} so that it is carried out", command.name),
                    command.e_s.value_or(0.0), 0.0, command.why);
    }

    const TeamCase& judged_;
    const ScoreActs& acts_;
    TeamPoints judged_points_;
    std::string inject_;                   ///< of whose fault is judged
    std::set<std::size_t> judged_alarms_;  ///< those of a fault, in raised.all
};

}  // namespace

TeamPoints judge_team(const TeamCase& judged) {
    return TeamJudge{judged}.judge();
}

}  // namespace aeolis::server
