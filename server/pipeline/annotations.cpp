// SPDX-License-Identifier: Apache-2.0
#include "server/pipeline/annotations.hpp"

#include "server/base/wall_clock.hpp"
#include "server/procedures/execution.hpp"
#include "server/procedures/position_board.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <vector>

namespace aeolis::server {
namespace {

Result<void> check_text(const char* field, const std::string& text, std::size_t octets_max) {
    if (text.size() > octets_max)
        return Error{fmt::format("{}: {} octets, at most {}", field, text.size(), octets_max)};
    if (text.find('\0') != std::string::npos) return Error{fmt::format("{}: a NUL character is no text", field)};
    return {};
}

Result<void> check_author(const std::string& by) {
    if (by.find_first_not_of(" \t\r\n") == std::string::npos) return Error{"by: who says so? A name is wanted"};
    return check_text("by", by, author_octets_max);
}

Result<void> check_position(const std::string& position) {
    if (procedures::position_named(position)) return {};
    std::vector<std::string_view> known;
    known.reserve(procedures::positions.size());
    for (const auto each : procedures::positions) known.push_back(procedures::name_of(each));
    return Error{fmt::format("position: there is no '{}'; positions are {}", position, fmt::join(known, ", "))};
}

/// "EDL communications: ", or nothing.
std::string said_by(const std::string& position) {
    if (position.empty()) return {};
    std::string words = position;
    std::ranges::replace(words, '_', ' ');
    const auto capitals = words.starts_with("edl ") || words == "gnc" ? std::size_t{3} : std::size_t{1};
    for (std::size_t i = 0; i < capitals; ++i)
        words[i] = static_cast<char>(std::toupper(static_cast<unsigned char>(words[i])));
    return words + ": ";
}

/// A line of the log that is more than its text.
Result<archive::NoteRecord> said(const v1::NoteRequest& request, std::string words, const std::string& by, Ert now) {
    if (!request.position().empty())
        if (auto position = check_position(request.position()); !position) return position.error();
    v1::NoteRequest line;
    line.set_text(said_by(request.position()) + std::move(words));
    if (request.has_sclk()) line.set_sclk(request.sclk());
    auto note = note_of(line, by, now);
    if (note) note->position = request.position();
    return note;
}

/// What all acts on procedures and positions have.
template <typename Record>
Result<Record> act_by(const std::string& position, const std::string& by, Ert now) {
    if (auto author = check_author(by); !author) return author.error();
    if (auto fits = check_text("by", by, procedures::person_octets_max); !fits) return fits.error();
    if (auto known = check_position(position); !known) return known.error();
    Record act;
    act.position = position;
    act.by = by;
    act.ert = now;
    return act;
}

/// An Error when the field is not wanted and set, or wanted and blank.
Result<void> check_wanted(const char* field, const std::string& text, bool wanted, const char* what) {
    const bool blank = text.find_first_not_of(" \t\r\n") == std::string::npos;
    if (wanted && blank) return Error{fmt::format("{}: {}", field, what)};
    if (!wanted && !text.empty()) return Error{fmt::format("{}: is not for this kind of act", field)};
    return {};
}

}  // namespace

Result<archive::ProcedureActRecord> procedure_act_of(const v1::ProcedureBeginRequest& request, std::string text,
                                                     const std::string& by, Ert now) {
    auto act = act_by<archive::ProcedureActRecord>(request.position(), by, now);
    if (!act) return act;
    act->kind = archive::ProcedureActKind::begin;
    act->procedure = request.procedure();
    act->text = std::move(text);
    return act;
}

Result<archive::ProcedureActRecord> procedure_act_of(const v1::ProcedureActRequest& request, std::uint32_t number,
                                                     const std::string& by, Ert now) {
    using archive::ProcedureActKind;
    auto act = act_by<archive::ProcedureActRecord>(request.position(), by, now);
    if (!act) return act;
    const auto kind = archive::procedure_act_kind(request.kind());
    if (!kind || *kind == ProcedureActKind::begin)
        return Error{fmt::format("kind: '{}' is none of tick, sign, choose, skip, sent, hold, release, acknowledge, "
                                 "stop",
                                 request.kind())};
    if (auto step = check_text("step", request.step(), author_octets_max); !step) return step.error();
    if (auto reason = check_text("reason", request.reason(), procedures::reason_octets_max); !reason)
        return reason.error();
    if (*kind == ProcedureActKind::sent && request.command() == 0)
        return Error{"command: which one was sent? Its number in the run is wanted"};
    if (*kind == ProcedureActKind::choose && !request.has_choice())
        return Error{"choice: which way is taken? Its place among the step's choices is wanted, from 0"};
    act->number = number;
    act->kind = *kind;
    act->step = request.step();
    act->reason = request.reason();
    if (*kind == ProcedureActKind::choose) act->choice = request.choice();
    if (*kind == ProcedureActKind::sent) act->command = request.command();
    return act;
}

Result<archive::PositionActRecord> position_act_of(const v1::PositionActRequest& request, const std::string& by,
                                                   Ert now) {
    using archive::PositionActKind;
    auto act = act_by<archive::PositionActRecord>(request.position(), by, now);
    if (!act) return act;
    const auto kind = archive::position_act_kind(request.kind());
    if (!kind) return Error{fmt::format("kind: '{}' is none of take, offer, leave, poll, go, no_go", request.kind())};
    if (auto to = check_wanted("to", request.to(), *kind == PositionActKind::offer, "to whom is it offered?"); !to)
        return to.error();
    if (auto to = check_text("to", request.to(), procedures::person_octets_max); !to) return to.error();
    // An answer may say to which poll it is one.
    const bool answers = *kind == PositionActKind::go || *kind == PositionActKind::no_go;
    const bool polls = *kind == PositionActKind::poll;
    if (auto subject = check_wanted("subject", request.subject(), polls, "what is the room asked about?");
        !subject && !answers)
        return subject.error();
    if (auto subject = check_text("subject", request.subject(), procedures::subject_octets_max); !subject)
        return subject.error();
    if (auto reason = check_text("reason", request.reason(), procedures::reason_octets_max); !reason)
        return reason.error();
    act->kind = *kind;
    act->to = request.to();
    act->subject = request.subject();
    act->reason = request.reason();
    return act;
}

Result<void> check_note(const std::string& text, const std::string& by) {
    if (auto author = check_author(by); !author) return author;
    if (text.find_first_not_of(" \t\r\n") == std::string::npos) return Error{"text: the note is empty"};
    return check_text("text", text, note_octets_max);
}

Result<archive::NoteRecord> note_of(const v1::NoteRequest& request, const std::string& by, Ert now) {
    if (auto checked = check_note(request.text(), by); !checked) return checked.error();
    if (!request.position().empty()) return Error{"position: is for standard calls and their read-backs"};
    archive::NoteRecord note;
    if (request.has_sclk()) {
        if (!std::isfinite(request.sclk())) return Error{"sclk: not a number of seconds"};
        note.sclk_s = request.sclk();
    }
    note.text = request.text();
    note.by = by;
    note.ert = now;
    note.written = wall_clock_text();
    return note;
}

Result<archive::NoteRecord> call_of(const v1::NoteRequest& request, const procedures::CallList& calls,
                                    const std::string& by, Ert now) {
    if (request.reads_back() != 0) return Error{"reads_back: a line makes a call or reads one back, not both"};
    const auto* call = calls.call(request.call());
    if (call == nullptr) {
        std::vector<std::string_view> known;
        known.reserve(calls.calls.size());
        for (const auto& each : calls.calls) known.push_back(each.id);
        return Error{known.empty()
                         ? fmt::format("call: the mission has no standard calls, so no '{}'", request.call())
                         : fmt::format("call: there is no '{}'; calls are {}", request.call(), fmt::join(known, ", "))};
    }
    const bool blank = request.text().find_first_not_of(" \t\r\n") == std::string::npos;
    if (call->asks.empty() && !request.text().empty())
        return Error{fmt::format("text: the call {} says all by itself", call->id)};
    if (!call->asks.empty() && blank) return Error{fmt::format("text: {}?", call->asks)};
    auto note = said(request, call->says + (call->asks.empty() ? "" : ": " + request.text()), by, now);
    if (note) note->call = call->id;
    return note;
}

Result<archive::NoteRecord> read_back_of(const v1::NoteRequest& request, const v1::Note& called, const std::string& by,
                                         Ert now) {
    if (!request.text().empty()) return Error{"text: what is read back is the call's"};
    auto note = said(request, fmt::format("reads back “{}”", called.text()), by, now);
    if (!note) return note;
    note->call = called.call();
    note->reads_back = request.reads_back();
    return note;
}

Result<archive::AlarmActionRecord> alarm_action_of(const v1::AlarmRequest& request,
                                                   const dictionary::Dictionary& dictionary,
                                                   std::span<const std::string> links, const std::string& by, Ert now) {
    if (auto author = check_author(by); !author) return author.error();
    if (auto text = check_text("note", request.note(), note_octets_max); !text) return text.error();
    archive::AlarmActionRecord record;
    if (const auto* channel = dictionary.channel(request.channel()))
        record.alarm = channel->name;
    else if (const auto* packet = dictionary.packet(request.channel()))
        record.alarm = packet->name;
    else if (std::ranges::find(links, request.channel()) != links.end())
        record.alarm = request.channel();
    else
        return Error{fmt::format("channel: there is no channel, packet or link '{}'", request.channel())};
    const auto act = telemetry::alarm_act(request.action());
    if (!act)
        return Error{fmt::format("action: '{}' is none of acknowledge, shelve, unshelve, reset", request.action())};
    if (*act == telemetry::AlarmAct::shelve) {
        const double seconds = request.shelve_s();
        if (!(seconds > 0.0 && seconds <= shelve_s_max))
            return Error{fmt::format("shelve_s: {} is not within 0 … {} s: for how long?", seconds, shelve_s_max)};
        record.until = Ert{now.microseconds + static_cast<std::int64_t>(seconds * 1e6)};
    } else if (request.shelve_s() != 0.0) {
        return Error{fmt::format("shelve_s: {} is not for a limited time", request.action())};
    }
    record.action = *act;
    record.note = request.note();
    record.by = by;
    record.ert = now;
    return record;
}

}  // namespace aeolis::server
