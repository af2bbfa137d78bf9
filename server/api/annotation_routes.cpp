// SPDX-License-Identifier: Apache-2.0
#include "server/api/api.hpp"
#include "server/api/query_text.hpp"
#include "server/archive/items.hpp"
#include "server/base/json.hpp"
#include "server/pipeline/annotations.hpp"

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
    annotate(call, [wanted](archive::Reader&, archive::RunId, Ert now) -> Annotated {
        auto note = note_of(wanted, wanted.by(), now);
        if (!note) return error_response(422, note.error());
        return std::move(*note);
    });
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
