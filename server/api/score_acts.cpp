// SPDX-License-Identifier: Apache-2.0
#include "server/api/score_acts.hpp"

#include "server/archive/items.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <fmt/format.h>

namespace aeolis::server {
namespace {

constexpr std::string_view of_script = "asked for by the scenario's script";  // the gateway's words

std::string or_someone(const std::string& who, const char* otherwise = "someone") {
    return who.empty() ? otherwise : who;
}

/// The sender by the evidence of the stage authorised: "no arming needed, by Ann; left to flight: …".
std::string signature_in(const std::string& evidence) {
    for (const std::string_view begin : {"armed and confirmed by name, by ", "no arming needed, by "})
        if (evidence.starts_with(begin))
            return evidence.substr(begin.size(), evidence.find("; left to flight: ") - begin.size());
    return {};
}

std::string first_line(const std::string& text) {
    const auto end = text.find('\n');
    return end == std::string::npos ? text : text.substr(0, end) + " …";
}

std::string with_reason(std::string deed, const std::string& reason) {
    if (!reason.empty()) deed += ": " + reason;
    return deed;
}

/// "ticked look of uhf_lost".
std::string deed_of(const v1::ProcedureAct& act) {
    const auto of = fmt::format("{} {}", act.procedure(), act.number());
    const auto step = act.step().empty() ? of : fmt::format("{} of {}", act.step(), of);
    switch (act.kind()) {
    case v1::ProcedureAct::begin: return "began procedure " + of;
    case v1::ProcedureAct::tick: return with_reason("ticked " + step, act.reason());
    case v1::ProcedureAct::sign: return "signed " + step;
    case v1::ProcedureAct::choose:
        return with_reason(fmt::format("chose way {} at {}", act.choice() + 1, step), act.reason());
    case v1::ProcedureAct::skip: return with_reason("skipped " + step, act.reason());
    case v1::ProcedureAct::sent: return fmt::format("tied command {} to {}", act.command(), step);
    case v1::ProcedureAct::hold: return with_reason("held " + of, act.reason());
    case v1::ProcedureAct::release: return "released " + step;
    case v1::ProcedureAct::acknowledge: return "saw watchdog " + step;
    case v1::ProcedureAct::stop: return with_reason("stopped " + of, act.reason());
    default: return "acted on " + step + ", in a way that this server does not know";
    }
}

/// "took gnc", "called a poll: do edl".
std::string deed_of(const v1::PositionAct& act) {
    switch (act.kind()) {
    case v1::PositionAct::take: return with_reason("took " + act.position(), act.reason());
    case v1::PositionAct::offer: return fmt::format("offered {} to {}", act.position(), act.to());
    case v1::PositionAct::leave: return with_reason("left " + act.position(), act.reason());
    case v1::PositionAct::poll: return "called a poll: " + act.subject();
    case v1::PositionAct::go: return with_reason("said go as " + act.position(), act.reason());
    case v1::PositionAct::no_go: return with_reason("said no go as " + act.position(), act.reason());
    default: return "acted on " + act.position() + ", in a way that this server does not know";
    }
}

/// "wrote “…”", "called “…”".
std::string deed_of(const v1::Note& note) {
    if (note.reads_back() != 0) return first_line(note.text());
    return fmt::format("{} “{}”", note.call().empty() ? "wrote" : "called", first_line(note.text()));
}

/// Reads the items of a run into ScoreActs.
class ActReader {
  public:
    ActReader(const v1::AsFlownReport& report, std::optional<Ert> end, const dictionary::Dictionary& dictionary)
        : report_(report), end_(end), dictionary_(dictionary) {}

    ScoreActs read(const std::vector<v1::Item>& alarms, const std::vector<v1::Item>& room,
                   const std::vector<v1::Item>& heard) {
        for (const auto& item : alarms)
            if (!item.has_alarm_action() || in_time(item)) take_alarm(item);
        for (const auto& command : report_.commands()) read_.commands.push_back(outcome_of(command));
        collect_acts(alarms, room);
        collect_heard(heard);
        return std::move(read_);
    }

  private:
    bool in_time(const v1::Item& item) const { return !end_ || item.ert_us() < end_->microseconds; }
    double e_s_of(const v1::Item& item) const {
        return archive::sclk_at_ert(report_.run(), Ert{item.ert_us()}).seconds - report_.run().entry_sclk();
    }

    void take_alarm(const v1::Item& item) {
        const double e_s = e_s_of(item);
        if (item.has_alarm()) {
            const auto& alarm = item.alarm();
            const auto& name = dictionary_.channels.at(alarm.channel()).name;
            if (alarm.severity() == v1::Alarm::none) return read_.raised.take_inside(name);
            read_.raised.take_raised(name, alarm.limit(), alarm.sclk() - report_.run().entry_sclk());
        } else if (item.has_link()) {
            if (!item.link().lost()) return read_.raised.take_inside(item.link().link());
            read_.raised.take_raised(item.link().link(), "lost", e_s);
        } else if (item.has_staleness()) {
            if (!item.staleness().missing()) return read_.raised.take_inside(item.staleness().packet());
            read_.raised.take_raised(item.staleness().packet(), "silent", e_s);
        } else if (item.has_alarm_action() && item.alarm_action().action() == v1::AlarmAction::acknowledge) {
            read_.raised.take_acknowledged(item.alarm_action(), e_s);
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

    void collect_acts(const std::vector<v1::Item>& alarms, const std::vector<v1::Item>& room) {
        using Kind = PersonsAct::Kind;
        auto& acts = read_.acts;
        for (const auto& item : alarms) {
            if (!item.has_alarm_action() || !in_time(item)) continue;
            const auto& action = item.alarm_action();
            acts.push_back({Kind::alarm, e_s_of(item), or_someone(action.by()),
                            fmt::format("{} {}", v1::AlarmAction::Action_Name(action.action()), action.alarm()),
                            action.alarm()});
        }
        for (const auto& command : read_.commands)
            if (command.sender && command.e_s)
                acts.push_back(
                    {Kind::command, *command.e_s, *command.sender, "sent " + command.name, command.name,
                     command.how == CommandOutcome::How::failed || command.how == CommandOutcome::How::cancelled});
        for (const auto& item : report_.notes())
            if (in_time(item))
                acts.push_back({Kind::note, e_s_of(item), or_someone(item.note().by()), deed_of(item.note()),
                                item.note().text(), item.note().reads_back() != 0});
        for (const auto& item : room) {
            if (!in_time(item)) continue;
            if (item.has_procedure_act())
                acts.push_back({Kind::procedure, e_s_of(item), or_someone(item.procedure_act().by()),
                                deed_of(item.procedure_act()), ""});
            else if (item.has_position_act())
                acts.push_back({Kind::position, e_s_of(item), or_someone(item.position_act().by()),
                                deed_of(item.position_act()), ""});
        }
        std::ranges::stable_sort(acts, {}, &PersonsAct::e_s);
    }

    void collect_heard(const std::vector<v1::Item>& heard) {
        for (const auto& item : heard)
            if (item.has_event()) {
                const auto& event = item.event();
                read_.on_board[event.name()].push_back(event.sclk() - report_.run().entry_sclk());
                if (event.source() == v1::SOURCE_REALTIME) read_.heard[event.name()].push_back(e_s_of(item));
            } else if (item.has_tone() && item.tone().has_tone()) {
                read_.heard[item.tone().name()].push_back(e_s_of(item));
            }
    }

    const v1::AsFlownReport& report_;
    std::optional<Ert> end_;
    const dictionary::Dictionary& dictionary_;
    ScoreActs read_;
};

}  // namespace

std::string in_words(std::string name) {
    std::ranges::transform(name, name.begin(), [](unsigned char letter) {
        return letter == '_' ? ' ' : static_cast<char>(std::tolower(letter));
    });
    return name;
}

void RaisedAlarms::take_raised(const std::string& name, std::string limit, double e_s) {
    const auto known = open_.find(name);
    const bool again = known != open_.end() && all[known->second].acknowledged && inside_.contains(name);
    inside_.erase(name);
    if (known != open_.end() && !again) return;
    open_[name] = all.size();
    all.push_back({name, std::move(limit), e_s});
}

void RaisedAlarms::take_acknowledged(const v1::AlarmAction& action, double e_s) {
    const auto known = open_.find(action.alarm());
    if (known == open_.end() || all[known->second].acknowledged) return;
    auto& raised = all[known->second];
    raised.acknowledged = Acknowledged{e_s - raised.e_s, or_someone(action.by(), "unsigned")};
}

std::string PersonsAct::words() const {
    return kind == Kind::note ? by + " " + deed : by + ": " + deed;
}

v1::ScoreAct PersonsAct::told() const {
    static constexpr std::array kinds{"alarm", "command", "note", "procedure", "position"};
    v1::ScoreAct told;
    told.set_kind(kinds[static_cast<std::size_t>(kind)]);
    told.set_e_s(e_s);
    told.set_by(by);
    told.set_text(deed);
    return told;
}

ScoreActs acts_of(const v1::AsFlownReport& report, const std::vector<v1::Item>& alarms,
                  const std::vector<v1::Item>& room, const std::vector<v1::Item>& heard, std::optional<Ert> end,
                  const dictionary::Dictionary& dictionary) {
    return ActReader{report, end, dictionary}.read(alarms, room, heard);
}

}  // namespace aeolis::server
