// SPDX-License-Identifier: Apache-2.0
#include "server/pipeline/annotations.hpp"

#include "server/base/wall_clock.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

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

}  // namespace

Result<void> check_note(const std::string& text, const std::string& by) {
    if (auto author = check_author(by); !author) return author;
    if (text.find_first_not_of(" \t\r\n") == std::string::npos) return Error{"text: the note is empty"};
    return check_text("text", text, note_octets_max);
}

Result<archive::NoteRecord> note_of(const v1::NoteRequest& request, const std::string& by, Ert now) {
    if (auto checked = check_note(request.text(), by); !checked) return checked.error();
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
