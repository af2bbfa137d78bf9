// SPDX-License-Identifier: Apache-2.0
#include "telemetry/situation_monitor.hpp"

#include "common/entry_time.hpp"
#include "dictionaries/timeline_plan.hpp"
#include "telemetry/alarms.hpp"
#include "telemetry/text.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <fmt/format.h>
#include <functional>

namespace aeolis::telemetry {
namespace {

using dictionary::EventLevel;
using dictionary::Severity;
using Entries = std::vector<SituationEntry>;

// Names of the dictionary that the ground itself interprets.
constexpr std::string_view begin_event = "EDL_BEGUN", begin_tone = "edl_enabled", begin_command = "EDL_DO_EDL";
constexpr std::string_view take_over_event = "SECOND_CHANCE_TAKES_OVER", take_over_tone = "taken_over";
constexpr std::string_view resume_event = "PRIME_RESUMES", designate_event = "PRIME_DESIGNATED";
constexpr std::string_view role_channel = "computer_role";  // its alarm says what the take-over says
/// Told by the stages of the command itself, or in words of their own.
constexpr std::array<std::string_view, 3> told_otherwise{"COMMAND_REFUSED", take_over_event, resume_event};
constexpr std::string_view stand_by_event = "PRIME_STANDS_BY";  // told by the take-over, where there was one
constexpr std::array<std::string_view, 2> change_events{"TIMEPOINT_OFFSET_CHANGED", "ANCHOR_OFFSET_CHANGED"};

/// An event or tone that ends the news of another.
struct Follower {
    std::string_view news, by;
};
constexpr std::array<Follower, 16> followers{{{"FAULT_PROTECTION_INHIBITS_EDL", "FAULT_PROTECTION_RELEASES_EDL"},
                                              {"TIMEPOINT_UNVERIFIED", "TIMEPOINT_VERIFIED_LATE"},
                                              {"TIMEPOINT_UNVERIFIED", "TIMEPOINT_FELT"},
                                              {"TIMEPOINT_UNVERIFIED", "TIMEPOINT_WITNESSED"},
                                              {"TIMEPOINT_REFUSED", "TIMEPOINT_VERIFIED_LATE"},
                                              {"TIMEPOINT_REFUSED", "TIMEPOINT_FELT"},
                                              {"TIMEPOINT_REFUSED", "TIMEPOINT_WITNESSED"},
                                              {"THRUSTERS_NOT_FELT", "THRUSTERS_FELT_AGAIN"},
                                              {"THRUSTERS_NOT_FELT", "THRUSTERS_NOT_JUDGED"},
                                              {"ENGINES_SILENT", "ENGINES_HEARD_AGAIN"},
                                              {"TIMEPOINT_HELD", "TIMEPOINT_VERIFIED"},
                                              {"IMU_SILENT", "IMU_HEARD_AGAIN"},
                                              {"RADAR_LOST", "RADAR_LOCK"},
                                              {"FATAL_CHECK_FAILED", "COMPUTER_STARTED"},
                                              {"fault_inhibit", "fault_inhibit_over"},
                                              {"check_failed", "computer_started"}}};
/// Tones of what went wrong. They are news where telemetry does not tell the same with more words.
constexpr std::array<std::string_view, 17> bad_tones{
    "check_failed",   "fault_inhibit",      "command_refused", "action_unverified",   "action_refused",
    "action_held",    "recording_fault",    "overrun",         "constraint_violated", "radar_lost",
    "imu_silent",     "attitude_lost",      "propellant_low",  "pyro_refused",        "thrusters_not_felt",
    "engines_silent", "action_contradicted"};
constexpr std::string_view fatal_tone = "check_failed";
// Subjects.
constexpr std::string_view landing = "landed", computer = "computer", station_fault = "station",
                           commanding = "commanding", recording = "recording";

constexpr std::size_t sentence_octets_max = 240;  ///< chosen: two lines of the console
constexpr double orbiter_soon_s = 600.0;          ///< chosen: nobody looks at a countdown to a pass beyond it
constexpr std::size_t touchdown_facts_max = 64;   ///< chosen: of each kind, over ten seconds even at 4 Hz
constexpr double held_known_s = 5.0;              ///< flight tells a held decision again after 4 s

std::string shortened(std::string text) {
    if (text.size() <= sentence_octets_max) return text;
    std::size_t end = sentence_octets_max;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;  // not within a character
    return text.substr(0, end) + "…";
}

std::string capitalised(std::string text) {
    if (!text.empty()) text.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(text.front())));
    return text;
}

std::string title_of(std::string_view link) {
    if (link == uhf_live_link.name) return "UHF";
    if (link == x_band_link.name) return "X-band";
    if (link == x_band_telemetry_link.name) return "X-band telemetry";
    if (link == relay_link.name) return "Relay";
    if (link == downlink_link.name) return "Downlink";
    if (link.starts_with("uhf_")) return "UHF by " + capitalised(std::string(link.substr(4)));
    if (link.starts_with("relay_")) return "Relay by " + capitalised(std::string(link.substr(6)));
    return std::string(link);
}

/// Of a link that the plan has yet to begin.
std::string not_begun_title(std::string_view link) {
    return link == x_band_link.name ? "X-band tones" : title_of(link);
}

/// The station's fault, told behind the prediction that it stands beside.
std::string fault_of(const std::string& words) {
    const auto behind = words.rfind("; ");
    return behind == std::string::npos ? words : words.substr(behind + 2);
}

/// The order of news: what concerns the whole landing first; what closes in every landing last.
int weight_of(std::string_view subject) {
    constexpr std::array<std::string_view, 3> heavy{landing, computer, station_fault};
    if (const auto found = std::ranges::find(heavy, subject); found != heavy.end())
        return static_cast<int>(heavy.end() - found);
    return subject == commanding ? -1 : 0;
}

/// @param name  "A" or "B"; empty: a designation told of neither
std::string flying_on(std::string_view name, std::string_view role) {
    return name.empty() ? fmt::format("Flying on the {} computer", role)
                        : fmt::format("Flying on {} computer {}", role, name);
}

double seconds_from(Ert from, Ert to) {
    return static_cast<double>(to.microseconds - from.microseconds) * 1e-6;
}

/// "heard by tone: parachute deploy, posterior 0.998"; what rounds to one is not certain.
std::string heard_by_tone(std::string_view what, double likelihood) {
    constexpr double almost_one = 0.9995;
    return fmt::format("heard by tone: {}, posterior {}", what,
                       likelihood >= almost_one ? "above 0.999" : fmt::format("{:.3f}", likelihood));
}

/// "speed ≤ 405.0 m/s", as it must become.
std::string requirement(const Condition& condition) {
    const std::string sign = condition.comparison == "<="   ? "≤"
                             : condition.comparison == ">=" ? "≥"
                             : condition.comparison == "==" ? "="
                                                            : condition.comparison;
    std::string bound = named_value_text(condition.quantity, condition.bound);
    if (const auto square = bound.rfind("/s2"); square != std::string::npos) bound.replace(square, 3, "/s²");
    return in_words(without_unit(condition.quantity)) + " " + sign + " " + bound;
}

}  // namespace

const char* name_of(SituationRank rank) {
    static constexpr std::array names{"lasting", "calm", "waiting", "silence", "news", "danger"};
    static_assert(names.size() == situation_ranks);
    return names[static_cast<std::size_t>(rank)];
}

std::vector<std::string_view> SituationMonitor::mission_names() {
    std::vector<std::string_view> names{begin_event,         begin_tone,      begin_command,  touchdown_event,
                                        touchdown_timepoint, take_over_event, take_over_tone, resume_event,
                                        designate_event,     role_channel,    stand_by_event, fatal_tone};
    names.insert(names.end(), told_otherwise.begin(), told_otherwise.end());
    names.insert(names.end(), change_events.begin(), change_events.end());
    names.insert(names.end(), bad_tones.begin(), bad_tones.end());
    for (const auto& [news, by] : followers) names.insert(names.end(), {news, by});
    return names;
}

SituationMonitor::SituationMonitor(const dictionary::Dictionary& dictionary, const Clocks& clocks)
    : dictionary_(&dictionary), clocks_(clocks), timeline_(dictionary) {
    if (!clocks_.entry) return;
    touchdown_facts_.entry = *clocks_.entry;
    touchdown_facts_.flag_name = touchdown_flag;
    touchdown_facts_.live_name = touchdown_live;
    touchdown_facts_.rover_imu_known =
        dictionary.channel(rover_rate_channel) != nullptr && dictionary.channel(rover_force_channel) != nullptr;
    std::optional<double> last_e_s;
    for (const auto& e_s : dictionary::planned_from_entry_s(dictionary))
        if (e_s) last_e_s = std::max(*e_s, last_e_s.value_or(*e_s));
    if (last_e_s)
        closes_ = {seen(*clocks_.entry + *last_e_s).microseconds -
                   static_cast<std::int64_t>(2.0 * clocks_.light_time_s * 1e6)};
}

Ert SituationMonitor::seen(Sclk sclk) const {
    return {clocks_.correlation.scet_of(sclk).microseconds + static_cast<std::int64_t>(clocks_.light_time_s * 1e6)};
}

std::string SituationMonitor::when(Ert ert) const {
    if (!clocks_.entry) return day_of_year_text(ert);
    const Scet sent{ert.microseconds - static_cast<std::int64_t>(clocks_.light_time_s * 1e6)};
    return from_entry_text(clocks_.correlation.sclk_of(sent) - *clocks_.entry);
}

void SituationMonitor::add_news(SituationEntry entry) {
    std::erase_if(news_, [&](const auto& old) { return old.subject == entry.subject; });
    entry.sentence = shortened(std::move(entry.sentence));
    news_.push_back(std::move(entry));
    if (news_.size() > news_max) news_.erase(news_.begin());
}

void SituationMonitor::follow(std::string_view subject) {
    std::erase_if(news_, [&](const auto& old) { return old.subject == subject; });
}

bool SituationMonitor::up(std::string_view link) const {
    const auto found = links_.find(link);
    return found != links_.end() && found->second.up;
}

bool SituationMonitor::telemetry_comes() const {
    return std::ranges::any_of(links_,
                               [](const auto& link) { return link.second.up && is_live_telemetry(link.first); });
}

bool SituationMonitor::anything_up() const {
    return std::ranges::any_of(links_, [](const auto& link) { return link.second.up; });
}

Ert SituationMonitor::last_change() const {
    Ert last;
    for (const auto& [name, link] : links_) last = std::max(last, link.since);
    return last;
}

// ---- facts -------------------------------------------------------------------------------------------------------

void SituationMonitor::heard(Sclk sclk, std::optional<Ert> received) {
    if (received) last_received_ = std::max(last_received_.value_or(*received), *received);
    if (!clocks_.entry) return;
    const Ert at = received ? std::max(*received, seen(sclk)) : seen(sclk);
    if (!last_heard_ || at > *last_heard_) last_heard_ = at;
}

void SituationMonitor::take_over(std::string_view how, Ert at, const Origin& origin, std::string evidence) {
    if (backup_ && (!how.empty() || backup_->evidence.starts_with("event"))) return;  // an event knows better
    const std::string flying = flying_on(backup_name_, "backup");
    const std::string sentence = how.empty() ? fmt::format("{} since {}: it took over the timeline", flying, when(at))
                                             : fmt::format("{}, {} {}", flying, how, when(at));
    SituationEntry entry{landed_ ? SituationRank::news : SituationRank::danger,
                         std::string(computer),
                         sentence,
                         std::move(evidence),
                         origin.seq,
                         at,
                         {}};
    add_news(entry);
    entry.rank = SituationRank::lasting;
    backup_ = std::move(entry);
}

void SituationMonitor::touch_down(Sclk sclk, std::string_view how, const Origin& origin, std::string evidence) {
    begun_ = true;
    auto& told = touchdown_facts_.told;
    if (told.size() < touchdown_facts_max) told.push_back({sclk, evidence});
    if (landed_) return judge_touchdown(sclk, origin);
    const Ert at = seen(sclk, origin);
    landed_ = SituationEntry{SituationRank::news,
                             std::string(landing),
                             fmt::format("Touchdown reported at {}{}{}", when(at), how.empty() ? "" : ", ", how),
                             std::move(evidence),
                             origin.seq,
                             at,
                             {}};
    for (auto& news : news_)
        if (news.subject == computer) news.rank = SituationRank::news;  // the landing is what matters now
    judge_touchdown(sclk, origin);
}

void SituationMonitor::touchdown(const TouchdownSample& sample, const Origin& origin) {
    TouchdownFacts& facts = touchdown_facts_;
    // By the vehicle's time: packets of less priority come later.
    const auto keep = [&sample](auto& all, auto fact, auto sclk) {
        if (all.size() == touchdown_facts_max) all.erase(all.begin());
        all.insert(std::ranges::upper_bound(all, sample.sclk, {}, sclk), std::move(fact));
    };
    if (sample.live) keep(facts.live, sample.sclk, std::identity{});
    if (sample.rover_rate_rps && sample.rover_force_mps2)
        keep(facts.rover_imu, TouchdownFacts::RoverImu{sample.sclk, *sample.rover_rate_rps, *sample.rover_force_mps2},
             &TouchdownFacts::RoverImu::sclk);
    if (sample.flag && (!facts.flag || sample.sclk >= facts.flag->sclk))
        facts.flag = TouchdownFacts::Flag{sample.sclk, *sample.flag};
    judge_touchdown(sample.sclk, origin);
}

// What confirmed it may be older than what is kept: a confirmation is undone by a contradiction only.
void SituationMonitor::judge_touchdown(Sclk now, const Origin& origin) {
    if (!landed_ || !clocks_.entry) return;
    touchdown_facts_.now = std::max(touchdown_facts_.now, now);
    const TouchdownJudgement judged = telemetry::judge_touchdown(touchdown_facts_);
    if (judged.verdict == touchdown_verdict_) return;
    if (judged.verdict == TouchdownVerdict::reported && touchdown_verdict_ == TouchdownVerdict::confirmed) return;
    touchdown_verdict_ = judged.verdict;
    touchdown_told_.reset();
    if (judged.verdict == TouchdownVerdict::reported) return;
    SituationEntry told = *landed_;
    told.evidence_seq = origin.seq;
    if (judged.verdict == TouchdownVerdict::contradicted) {
        told.rank = SituationRank::danger;
        told.sentence = fmt::format("Touchdown contradicted: {}", judged.steps.front().words);
        told.evidence = judged.steps.front().words;
    } else {
        told.sentence = fmt::format("Touchdown confirmed, at {}", when(seen(judged.sclk, origin)));
        told.evidence.clear();
        for (const auto& step : judged.steps)
            told.evidence += fmt::format("{}{}: {}", told.evidence.empty() ? "" : "; ", step.name, step.words);
    }
    touchdown_told_ = std::move(told);
}

void SituationMonitor::event(const EventFact& event, const Origin& origin) {
    const Ert at = seen(event.sclk, origin);
    const std::string evidence = fmt::format("event {}{}", event.name, origin.recorded ? ", by the recording" : "");
    if (event.name == begin_event) begun_ = true;
    if (event.name == touchdown_event)
        touch_down(event.sclk, origin.recorded ? "by the recording" : "", origin, evidence);
    if (event.name == take_over_event && !origin.recorded) take_over("", at, origin, evidence);
    if (origin.recorded) return;  // the rest is of the present
    if (event.name == designate_event) designate(event.text);
    if (event.name == resume_event) {
        backup_.reset();
        add_news({SituationRank::news,
                  std::string(computer),
                  fmt::format("{} since {}", flying_on(prime_, "prime"), when(at)),
                  evidence,
                  origin.seq,
                  at,
                  {}});
    }
    for (const auto& follower : followers)
        if (follower.by == event.name) follow(fmt::format("event {}", follower.news));
    if (std::ranges::find(change_events, event.name) != change_events.end()) offsets_changed_ = true;
    if (std::ranges::find(told_otherwise, event.name) != told_otherwise.end()) return;
    if (event.name == stand_by_event && backup_) return;
    if (event.level != EventLevel::fatal && event.level != EventLevel::warning_hi) return;
    add_news({event.level == EventLevel::fatal ? SituationRank::danger : SituationRank::news,
              fmt::format("event {}", event.name),
              fmt::format("{}: {}", when(at), event.text),
              evidence,
              origin.seq,
              at,
              {}});
}

// The event's only value stands in its text where the dictionary's format has a brace.
void SituationMonitor::designate(std::string_view text) {
    const auto event = std::ranges::find(dictionary_->events, designate_event, &dictionary::Event::name);
    const auto brace = event == dictionary_->events.end() ? std::string::npos : event->format.find('{');
    const char number = brace < text.size() ? text[brace] : '?';
    prime_ = number == '0' ? "A" : number == '1' ? "B" : "";
    backup_name_ = number == '0' ? "B" : number == '1' ? "A" : "";
}

void SituationMonitor::fired(TimepointId timepoint, Sclk triggered, Sclk fired, const Origin& origin) {
    if (!clocks_.entry || timepoint.value >= dictionary_->timeline.size()) return;
    begun_ = true;
    timeline_.fired(timepoint, triggered - *clocks_.entry, fired - *clocks_.entry, origin.recorded, origin.seq);
    if (dictionary_->timeline[timepoint.value].name == touchdown_timepoint)
        touch_down(fired, origin.recorded ? "by the recording" : "", origin, "timepoint touchdown");
}

void SituationMonitor::tone(ToneId tone, double likelihood, Sclk start, const Origin& origin) {
    if (!clocks_.entry || likelihood < tone_believed || tone.value >= dictionary_->tones.size()) return;
    const auto& row = dictionary_->tones[tone.value];
    const bool twin = row.set == dictionary::ToneSet::second_chance;
    const auto name = twin && row.name.starts_with(dictionary::second_chance_prefix)
                          ? std::string_view(row.name).substr(dictionary::second_chance_prefix.size())
                          : std::string_view(row.name);
    if (name.empty()) return;
    heard(start);
    const Ert at = seen(start);
    const std::string evidence = heard_by_tone(fmt::format("{} {}", tone.value, in_words(row.name)), likelihood);
    if (name == begin_tone) begun_ = true;
    if (name == take_over_tone && twin) take_over("by tone at", at, origin, evidence);
    if (const auto told = timeline_.tone(tone, likelihood, start - *clocks_.entry, origin.seq)) {
        begun_ = true;
        if (dictionary_->timeline[told->value].name == touchdown_timepoint)
            touch_down(start, "by tone", origin, evidence);
    }
    for (const auto& follower : followers)
        if (follower.by == name) follow(fmt::format("tone {}", follower.news));
    if (telemetry_comes() || std::ranges::find(bad_tones, name) == bad_tones.end()) return;
    add_news({name == fatal_tone ? SituationRank::danger : SituationRank::news,
              fmt::format("tone {}", name),
              fmt::format("{}, by tone: {}", when(at), row.meaning),
              evidence,
              origin.seq,
              at,
              {}});
}

void SituationMonitor::link(const LinkState& state, const Origin& origin) {
    LinkRow& row = links_[state.link.name];
    if (state.link.name == uhf_live_link.name) note_touchdown_silence(state);
    if (state.link.name == relay_link.name && landed_)
        recording_told_ = recording_told_ || state.up || state.silence == SilenceClass::recording_complete;
    if (state.up) {
        was_up_ = true;
        note_loss(state.link.name, row, state.ert, origin);
        row = LinkRow{};
        row.up = true;
        row.since = state.ert;
        row.seq = origin.seq;
        return;
    }
    const auto silence = state.silence;
    if (row.up || row.seq == 0) {
        row = LinkRow{};
        row.since = state.ert;
    }
    const bool unexplained = state.lost && (!silence || *silence == SilenceClass::unexplained);
    if (row.station && (!state.lost || unexplained)) note_loss(state.link.name, row, state.ert, origin);
    if (unexplained && !row.lost_since && !row.station) {
        row.lost_since = row.silence ? state.ert : row.since;
        row.lost_seq = origin.seq;
        if (row.silence && row.until) row.outlasted = row.silence, row.outlasted_until = row.until;
    }
    if (!row.station) row.station_since = state.ert;
    row.station = state.lost && !unexplained;
    row.lost = state.lost;
    row.silence = silence;
    row.words = silence ? state.words : std::string{};
    row.until = state.until;
    row.seq = origin.seq;
    if (silence == SilenceClass::no_orbiter && state.until) pass_ = {*state.until, row.words};
}

void SituationMonitor::note_touchdown_silence(const LinkState& state) {
    auto& silences = touchdown_facts_.silences;
    const bool silent = !silences.empty() && !silences.back().to;
    if (state.up == !silent || !clocks_.entry) return;
    const Sclk at =
        clocks_.correlation.sclk_of({state.ert.microseconds - static_cast<std::int64_t>(clocks_.light_time_s * 1e6)});
    if (state.up) {
        silences.back().to = at;
        return;
    }
    if (silences.size() == touchdown_facts_max) silences.erase(silences.begin());
    silences.push_back({at, {}, state.words});
}

void SituationMonitor::note_loss(const std::string& link, const LinkRow& row, Ert to, const Origin& origin) {
    if (!row.station && (!row.lost_since || row.outlasted)) return;
    const std::string_view of = row.station ? station_fault : std::string_view(link);
    auto loss = std::ranges::find(losses_, of, &Loss::of);
    if (loss == losses_.end()) {
        if (losses_.size() == losses_max) losses_.erase(losses_.begin());
        loss = losses_.insert(losses_.end(), Loss{std::string(of)});
    }
    const Ert from = row.station ? row.station_since : *row.lost_since;
    if (loss->times == 0 || from > loss->to) {  // each link tells the station's fault
        ++loss->times;
        loss->from = from;
    }
    loss->to = to;
    loss->seq = origin.seq;
}

void SituationMonitor::stage(const StageFact& stage, const Origin& origin) {
    const std::string subject = fmt::format("command {}", stage.name);
    if (stage.done) {
        follow(subject);
        if (stage.name == begin_command) begun_ = true;
    }
    if (!stage.failed || stage.evidence.starts_with("cancelled")) return;
    add_news({SituationRank::news,
              subject,
              fmt::format("{} failed: {}", stage.name, stage.evidence),
              fmt::format("command {}", stage.command),
              origin.seq,
              origin.ert,
              {}});
}

void SituationMonitor::alarm(ChannelId channel, Severity severity, std::string_view limit, Sclk sclk,
                             const Origin& origin) {
    const auto& name = dictionary_->channels[channel.value].name;
    if (name == role_channel) return;
    const std::string subject = fmt::format("channel {}", name);
    if (severity < Severity::critical) return follow(subject);
    const Ert at = seen(sclk, origin);
    add_news({SituationRank::danger,
              subject,
              fmt::format("{} {}: {} since {}", capitalised(in_words(without_unit(name))), limit, name_of(severity),
                          when(at)),
              fmt::format("channel {}", name),
              origin.seq,
              at,
              {}});
}

void SituationMonitor::explained(const Explanation& explanation, const Origin& origin) {
    if (explanation.verdict != "held" || origin.recorded) return;
    const auto unmet = std::ranges::find(explanation.conditions, false, &Condition::holds);
    if (unmet == explanation.conditions.end()) return;
    held_ = Held{explanation.decision == "timepoint" ? explanation.subject : explanation.decision, requirement(*unmet),
                 origin.seq, origin.ert};
}

// ---- the situation -----------------------------------------------------------------------------------------------

Entries SituationMonitor::at(Ert now) const {
    Entries all = news_;
    if (landed_) {
        all.push_back(touchdown_told_ ? *touchdown_told_ : *landed_);
        if (recording_follows()) all.back().rank = SituationRank::lasting;
    }
    const bool silent = add_not_heard(all, now);
    add_links(all, now, silent);
    if (!silent) add_waiting(all, now);
    add_lasting(all, now);
    const auto told = [](const auto& entry) { return entry.rank >= SituationRank::calm; };
    if (std::ranges::none_of(all, told))
        all.push_back({SituationRank::calm, "calm", "Nothing is awaited", "", 0, last_change(), {}});
    std::ranges::stable_sort(all, [](const auto& a, const auto& b) {
        if (a.rank != b.rank) return a.rank > b.rank;
        const int before = weight_of(a.subject), behind = weight_of(b.subject);
        return before != behind ? before > behind : a.since > b.since;
    });
    while (all.size() > entries_max) {  // what lasts is kept
        const auto last = std::ranges::find(all, SituationRank::lasting, &SituationEntry::rank);
        all.erase(std::prev(last));
    }
    return all;
}

void SituationMonitor::add_links(Entries& all, Ert now, bool not_heard) const {
    add_station(all);
    for (const auto& [name, link] : links_) {
        if (link.up || link.station) continue;
        if (awaits_begin(link)) continue;
        if (link.lost_since)
            add_lost(all, name, link);
        else if (!not_heard && (is_live_telemetry(name) || name == x_band_link.name))
            add_silent(all, name, link, now);
    }
}

// One fault, however many links it silences: those that fell silent together are named together.
void SituationMonitor::add_station(Entries& all) const {
    const auto first = std::ranges::find_if(links_, [](const auto& link) { return link.second.station; });
    if (first == links_.end()) return;
    const LinkRow& link = first->second;
    std::string titles;
    for (const auto& [name, row] : links_)
        if (row.station && when(row.since) == when(link.since)) titles += (titles.empty() ? "" : ", ") + title_of(name);
    if (const auto comma = titles.rfind(", "); comma != std::string::npos) titles.replace(comma, 2, " and ");
    all.push_back(
        {SituationRank::news,
         std::string(station_fault),
         fmt::format("A fault on the ground: {} ({} silent since {})", fault_of(link.words), titles, when(link.since)),
         "the station",
         link.seq,
         link.since,
         {}});
}

// The timeline switches it on, and telemetry would have told that the timeline runs: that is said where "do EDL" is.
bool SituationMonitor::awaits_begin(const LinkRow& link) const {
    return !begun_ && telemetry_comes() && link.lost_since && link.outlasted == SilenceClass::not_begun;
}

void SituationMonitor::add_lost(Entries& all, const std::string& name, const LinkRow& link) const {
    const std::string title = title_of(name);
    SituationEntry entry{SituationRank::news, name, {}, "link " + name, link.lost_seq, *link.lost_since, {}};
    if (link.outlasted == SilenceClass::not_begun && link.outlasted_until) {
        entry.sentence = fmt::format("{} not heard: due since {}{}", not_begun_title(name), when(*link.outlasted_until),
                                     begun_ ? "" : "; “Do EDL” is not confirmed");
    } else if (link.outlasted && link.outlasted_until) {
        entry.sentence = fmt::format("{} silent since {}, longer than predicted ({} until {})", title, when(link.since),
                                     title_of(*link.outlasted), when(*link.outlasted_until));
        entry.awaited = title + " back";
        entry.at = link.outlasted_until;
        entry.overdue = true;
    } else if (link.lost || !link.silence) {
        entry.sentence = fmt::format("{} lost since {}: nothing predicted it", title, when(link.since));
    } else {
        entry.sentence = fmt::format("{} lost since {}, before what was predicted ({})", title, when(link.since),
                                     title_of(*link.silence));
    }
    all.push_back(std::move(entry));
}

void SituationMonitor::add_silent(Entries& all, const std::string& name, const LinkRow& link, Ert now) const {
    if (!link.silence || is_over(*link.silence) || *link.silence == SilenceClass::not_begun) return;
    const std::string title = title_of(name);
    const bool uhf = name == uhf_live_link.name;
    if (*link.silence == SilenceClass::light_time) {
        if (uhf)
            all.push_back({SituationRank::silence, "light time", "Nothing can have come yet: it is under way",
                           "the light time", link.seq, link.since, "first word", link.until,
                           link.until && now > *link.until});
        return;
    }
    SituationEntry entry{SituationRank::silence, name, {}, "predicted before the landing", link.seq, link.since, {}};
    constexpr std::string_view window = "predicted from ";
    const bool in_window = link.words.starts_with(window);  // its cause is not known, only that it was predicted
    entry.sentence = in_window ? fmt::format("{} silent within the predicted {}, {}", title, title_of(*link.silence),
                                             link.words.substr(window.find(' ') + 1))
                               : fmt::format("{} silent: {}{}{}", title, title_of(*link.silence),
                                             link.words.empty() ? "" : ", ", link.words);
    if (uhf && tones_come()) entry.sentence += "; X-band is received";
    const bool other_tells =
        telemetry_comes() || (uhf && tones_come() && link.until && seconds_from(now, *link.until) > orbiter_soon_s);
    if (other_tells) entry.rank = SituationRank::calm;  // the landing is followed by the other link
    if (link.until) {
        entry.awaited = *link.silence == SilenceClass::orbiter_records ? "delivery" : title + " back";
        entry.at = link.until;
        entry.overdue = now > *link.until;
    }
    all.push_back(std::move(entry));
}

std::string SituationMonitor::last_heard(std::size_t timepoint) const {
    const auto& known = *timeline_.known(timepoint);
    const auto name = in_words(dictionary_->timeline[timepoint].name);
    return known.by_tone ? "last " + heard_by_tone(name, known.likelihood) : "last heard: " + name;
}

bool SituationMonitor::add_not_heard(Entries& all, Ert now) const {
    if (!clocks_.entry || dictionary_->timeline.empty() || !last_heard_ || landed_ || anything_up()) return false;
    const LinkRow* next = nullptr;
    bool lost = links_.empty(), down = false;
    for (const auto& [name, link] : links_) {
        down = down || name == uhf_live_link.name || name == x_band_telemetry_link.name || name == x_band_link.name;
        lost = lost || link.lost_since || link.station;
        if (link.lost_since || link.station) continue;  // what was predicted for it no longer holds
        if (link.until && (next == nullptr || *link.until < *next->until)) next = &link;
    }
    if (!down) return false;
    SituationEntry entry{lost ? SituationRank::news : SituationRank::silence,
                         "vehicle",
                         fmt::format("Not heard since {}", when(*last_heard_)),
                         "predicted before the landing",
                         0,
                         *last_heard_,
                         {}};
    if (const auto row = timeline_.row_of(touchdown_timepoint); row && timeline_.foreseen_e_s(*row)) {
        const Ert lands = seen(*clocks_.entry + *timeline_.foreseen_e_s(*row));
        entry.sentence += fmt::format("; landing {} predicted at {}", now < lands ? "is" : "was", when(lands));
    }
    const bool rises = next != nullptr ? next->silence == SilenceClass::no_orbiter : pass_ && pass_->rises > now;
    if (next == nullptr && !rises) {
        entry.sentence += "; when the next word comes is not predicted";
    } else {
        entry.at = next != nullptr ? *next->until : pass_->rises;
        entry.sentence +=
            rises ? fmt::format("; next word when {}", capitalised(next != nullptr ? next->words : pass_->words))
                  : fmt::format("; next word predicted at {}", when(*entry.at));
        entry.awaited = "next word";
        entry.overdue = now > *entry.at;
    }
    if (const auto last = timeline_.last()) {
        const auto& known = *timeline_.known(*last);
        entry.evidence = last_heard(*last);
        entry.evidence_seq = known.seq;
    }
    all.push_back(std::move(entry));
    return true;
}

void SituationMonitor::add_waiting(Entries& all, Ert now) const {
    if (!clocks_.entry || dictionary_->timeline.empty()) {
        const std::string words =
            anything_up()    ? "Listening"
            : last_received_ ? fmt::format("Nothing comes now: the last packet came at {}", when(*last_received_))
            : was_up_        ? "Nothing comes now"
                             : "Nothing comes yet";
        all.push_back({SituationRank::calm, "waiting", words, "", 0, last_change(), {}});
        return;
    }
    if (landed_) return add_recording(all, now);
    if (!begun_) {
        const Ert entry_at = seen(*clocks_.entry);
        SituationEntry entry{SituationRank::waiting,
                             "begin",
                             "“Do EDL” is not confirmed: the timeline does not run",
                             "",
                             0,
                             entry_at,
                             {}};
        if (now < entry_at)
            entry.awaited = "entry", entry.at = entry_at;
        else
            entry.sentence = fmt::format("“Do EDL” was never confirmed; entry was predicted at {}", when(entry_at));
        for (const auto& [name, link] : links_)
            if (awaits_begin(link) && link.outlasted_until)
                entry.sentence +=
                    fmt::format("; {} not heard, due since {}", not_begun_title(name), when(*link.outlasted_until));
        all.push_back(std::move(entry));
        return;
    }
    const bool live = telemetry_comes();
    const auto next = timeline_.next(live ? 0 : tone_sure);
    const bool only_recording = up(relay_link.name) && !live && !tones_come();
    if (next && !only_recording)
        add_step(all, *next, now);
    else
        add_recording(all, now);
}

void SituationMonitor::expected(TimepointId timepoint, const std::optional<ExpectedStep>& step) {
    if (timepoint.value >= dictionary_->timeline.size()) return;
    expected_.resize(dictionary_->timeline.size());
    expected_[timepoint.value] = step;
}

void SituationMonitor::add_step(Entries& all, std::size_t next, Ert now) const {
    const auto& row = dictionary_->timeline[next];
    SituationEntry entry{SituationRank::waiting,
                         "step",
                         (timeline_.is_planned(next) ? "Next: " : "Waiting for ") + in_words(row.name),
                         {},
                         0,
                         last_change(),
                         {}};
    entry.timepoint = row.name;
    const bool live = telemetry_comes();
    auto step = next < expected_.size() ? expected_[next] : std::nullopt;
    const auto by_plan = timeline_.predicted_e_s(next);
    if (!step && by_plan && !offsets_changed_) step = ExpectedStep{*by_plan, *by_plan};
    if (step) {
        entry.awaited = in_words(row.name);
        entry.at = seen(*clocks_.entry + step->e_s);
        entry.overdue = seconds_from(seen(*clocks_.entry + step->late_e_s), now) > (live ? uhf_late_s : tone_late_s);
    }
    // An anchor's decision is that of the step at it. Of what is overdue, the condition may have been met unheard.
    const bool at_anchor = row.anchor && row.desired_offset_s == 0.0;
    const bool of_step = held_ && (held_->decision == row.name ||
                                   (at_anchor && held_->decision == dictionary_->anchors[row.anchor->value].name));
    if (of_step && live && !entry.overdue && seconds_from(held_->at, now) <= held_known_s) {
        entry.sentence += fmt::format(", not yet {} at {}", held_->condition, when(held_->at));
        entry.evidence_seq = held_->seq;
        entry.evidence = "as the vehicle explained";
    }
    if (const auto last = timeline_.last()) {
        const auto& known = *timeline_.known(*last);
        const Ert at = seen(*clocks_.entry + known.e_s);
        entry.since = at;
        if (entry.evidence_seq == 0) {
            entry.evidence_seq = known.seq;
            entry.evidence = last_heard(*last);
        }
        if (known.by_tone)
            entry.sentence +=
                fmt::format("; last by tone: {}, {}", in_words(dictionary_->timeline[*last].name), when(at));
    }
    all.push_back(std::move(entry));
}

bool SituationMonitor::recording_follows() const {
    return touchdown_verdict_ == TouchdownVerdict::confirmed && recording_told_;
}

void SituationMonitor::add_recording(Entries& all, Ert now) const {
    SituationEntry entry{
        SituationRank::waiting, std::string(recording), "Waiting for the recording", {}, 0, last_change(), {}};
    if (landed_) entry.since = landed_->since;
    if (const auto found = links_.find(relay_link.name); found != links_.end()) {
        const LinkRow& link = found->second;
        entry.since = link.since;
        entry.evidence_seq = link.seq;
        entry.evidence = "link " + relay_link.name;
        if (link.up) {
            if (recording_follows()) entry.rank = SituationRank::news;
            entry.sentence =
                landed_ ? "The recording comes down" : "The recording comes down; it has not told of a landing yet";
        } else if (link.silence == SilenceClass::recording_complete) {
            entry.rank = recording_follows() ? SituationRank::news : SituationRank::calm;
            entry.sentence = "The recording is complete";
        } else if (link.until) {
            entry.sentence += ": " + capitalised(link.words);
            entry.awaited = recording;
            entry.at = link.until;
            entry.overdue = now > *link.until;
        } else if (link.silence == SilenceClass::no_orbiter) {
            entry.rank = SituationRank::calm;
            entry.sentence = "The recording is not complete, and " + link.words;
        }
    }
    all.push_back(std::move(entry));
}

void SituationMonitor::add_lasting(Entries& all, Ert now) const {
    if (backup_) all.push_back(*backup_);
    for (const Loss& loss : losses_) {
        const bool station = loss.of == station_fault;
        const std::string times = loss.times == 1 ? "" : fmt::format(" {} times, last", loss.times);
        all.push_back(
            {SituationRank::lasting,
             "loss of " + loss.of,
             fmt::format("{} was lost{} from {} to {}: {}", station ? "Station" : title_of(loss.of), times,
                         when(loss.from), when(loss.to), station ? "a fault on the ground" : "nothing predicted it"),
             station ? "the station" : "link " + loss.of,
             loss.seq,
             loss.from,
             {}});
    }
    if (!closes_ || now < *closes_) return;
    SituationEntry closed{
        SituationRank::lasting,
        std::string(commanding),
        fmt::format("Too late for planned steps since {}: what is sent now comes after the last of them",
                    when(*closes_)),
        "the plan and the light time",
        0,
        *closes_,
        {}};
    all.push_back(closed);
    const auto last = timeline_.last();
    const bool followed = landed_ || (last && seen(*clocks_.entry + timeline_.known(*last)->e_s) > *closes_);
    if (followed) return;
    closed.rank = SituationRank::news;
    all.push_back(std::move(closed));
}

}  // namespace aeolis::telemetry
