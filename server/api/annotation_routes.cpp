// SPDX-License-Identifier: Apache-2.0
#include "server/api/api.hpp"
#include "server/api/query_text.hpp"
#include "server/archive/items.hpp"
#include "server/base/json.hpp"
#include "server/pipeline/annotations.hpp"

#include <fmt/format.h>

// The routes that add notes and alarm actions to a run of any age. Answered once durable.
namespace aeolis::server {
namespace {

/// The callback that answers with the stored item, once it is durable. What is taken and not stored yet is answered
/// without Retry-After: sent again, it would be there twice.
std::function<void(Result<PipelineThread::Annotated>)> added(const Respond& respond) {
    return [respond](const Result<PipelineThread::Annotated>& annotated) {
        if (!annotated)
            return respond(annotated.error().internal ? error_response(500, annotated.error().message)
                                                      : disk_response(annotated.error().message));
        if (!annotated->not_stored_yet.empty()) return respond(error_response(503, annotated->not_stored_yet));
        respond(json_response(archive::to_item(annotated->annotation), 201));
    };
}

}  // namespace

void Api::annotate(const ApiRequest& call, Annotating annotating) {
    const auto question = [this, annotating = std::move(annotating), clock = clock(),
                           respond = call.respond](archive::Reader& reader, archive::RunId id,
                                                   const QueryText&) -> std::optional<HttpResponse> {
        const auto newest = reader.newest_ert(id);
        if (!newest) return error_response(500, newest.error());
        auto made = annotating(reader, id, clock(id).value_or(*newest));
        if (auto* refused = std::get_if<HttpResponse>(&made)) return std::move(*refused);
        if (parts_.pipeline.annotate(id, std::get<archive::Annotation>(std::move(made)), added(respond))) return {};
        return full_response("too much waits to be stored: try again");
    };
    ask(call, {}, question, JobPriority::at_once);
}

void Api::post_note(const ApiRequest& call) {
    v1::NoteRequest wanted;
    if (auto unreadable = read_signed(call, wanted)) return call.respond(std::move(*unreadable));
    const bool plain = wanted.call().empty() && wanted.reads_back() == 0;
    annotate(call, [this, wanted, plain](archive::Reader& reader, archive::RunId id, Ert now) -> Annotated {
        if (!plain) return called(wanted, reader, id, now);
        auto note = note_of(wanted, wanted.by(), now);
        if (!note) return error_response(422, note.error());
        return std::move(*note);
    });
}

/// A standard call, or its read-back: of a run that goes on, and from a position that is no other person's.
Api::Annotated Api::called(const v1::NoteRequest& wanted, archive::Reader& reader, archive::RunId id, Ert now) {
    const auto run = reader.run(id);
    if (!run) return error_response(500, run.error());
    if (run->state() != v1::RunState::running && run->state() != v1::RunState::paused)
        return error_response(409, fmt::format("run {} does not go on: calls are made while a run does", id.value));
    if (!wanted.position().empty())
        if (const auto may = parts_.pipeline.positions().may_act(wanted.position(), wanted.by()); !may)
            return error_response(409, may.error());
    if (wanted.call().empty()) return read_back(wanted, reader, id, now);
    auto note = call_of(wanted, calls_, wanted.by(), now);
    if (!note) return error_response(422, note.error());
    return std::move(*note);
}

Api::Annotated Api::read_back(const v1::NoteRequest& wanted, archive::Reader& reader, archive::RunId id, Ert now) {
    const auto page = reader.items(id, wanted.reads_back() - 1, 1);
    if (!page) return error_response(500, page.error());
    const auto* item = page->items.empty() ? nullptr : &page->items.front();
    if (item == nullptr || item->seq() != wanted.reads_back() || !item->has_note() || item->note().call().empty() ||
        item->note().reads_back() != 0)
        return error_response(
            422, fmt::format("reads_back: item {} of run {} is no standard call", wanted.reads_back(), id.value));
    if (item->note().by() == wanted.by())
        return error_response(409, fmt::format("{} made this call: another person reads it back", wanted.by()));
    auto note = read_back_of(wanted, item->note(), wanted.by(), now);
    if (!note) return error_response(422, note.error());
    return std::move(*note);
}

void Api::post_alarm(const ApiRequest& call) {
    v1::AlarmRequest wanted;
    if (auto unreadable = read_signed(call, wanted)) return call.respond(std::move(*unreadable));
    annotate(call, [this, wanted](archive::Reader& reader, archive::RunId id, Ert now) -> Annotated {
        const auto links = reader.links();
        if (!links) return error_response(500, links.error());
        auto action = alarm_action_of(wanted, parts_.dictionary, *links, wanted.by(), now);
        if (!action) return error_response(422, action.error());
        if (const auto may = reader.may(id, action->alarm, action->action, action->ert); !may)
            return error_response(409, may.error());
        return std::move(*action);
    });
}

}  // namespace aeolis::server
