// SPDX-License-Identifier: Apache-2.0
#include "server/api/api.hpp"
#include "server/api/query_text.hpp"
#include "server/archive/items.hpp"
#include "server/base/json.hpp"
#include "server/pipeline/annotations.hpp"
#include "server/pipeline/procedure_status.hpp"
#include "server/procedures/procedure_text.hpp"

#include <array>
#include <fmt/format.h>

// The routes of procedures and positions: the library, and what people do with those of a run. Acts are answered once
// durable.
namespace aeolis::server {
namespace {

constexpr std::array<std::string_view, 2> form_formats{"json", "text"};

const archive::ProcedureStatusRecord& item_behind(const pipeline::Pipeline::Acted& acted) {
    return acted.status;
}
const archive::PositionActRecord& item_behind(const pipeline::Pipeline::PositionActed& acted) {
    return acted.act;
}

/// The callback that answers with the item behind an act, once it is durable. What is taken and not stored yet is
/// answered without Retry-After: sent again, it would be done twice.
template <typename Acted>
std::function<void(Result<Acted>)> acted(const Respond& respond) {
    return [respond](const Result<Acted>& done) {
        if (!done)
            return respond(done.error().internal ? error_response(500, done.error().message)
                                                 : disk_response(done.error().message));
        if (!done->outcome.refused.empty()) return respond(error_response(409, done->outcome.refused));
        if (!done->not_stored_yet.empty()) return respond(error_response(503, done->not_stored_yet));
        respond(json_response(archive::to_item(item_behind(done->outcome)), 201));
    };
}

/// Gives an act to the pipeline. False: too much waits.
struct ToPipeline {
    PipelineThread& pipeline;
    archive::RunId run;
    const Respond& respond;

    bool operator()(archive::ProcedureActRecord act) const {
        return pipeline.act(run, std::move(act), acted<PipelineThread::Acted>(respond));
    }
    bool operator()(archive::PositionActRecord act) const {
        return pipeline.act(run, std::move(act), acted<PipelineThread::PositionActed>(respond));
    }
    bool operator()(const HttpResponse&) const { return false; }  // answered already
};

/// Whoever directs the flight permits hazardous commands, and needs the right to them.
Result<void> may_direct(const Operator& who, const v1::PositionActRequest& wanted) {
    const bool directs = wanted.position() == "flight_director" && wanted.kind() != "offer" && wanted.kind() != "leave";
    if (!directs || may(who, Right::hazardous)) return {};
    return Error{fmt::format("flight_director needs a {}, and {} is {}", name_of(*least_role(Right::hazardous)),
                             who.user, name_of(*who.role))};
}

/// The number of a procedure in a path; none: it is no such number.
std::optional<std::uint32_t> procedure_number(const std::string& text) {
    const auto number = run_id(text);
    return number ? std::optional{number->value} : std::nullopt;
}

HttpResponse no_procedure(archive::RunId run, const std::string& number) {
    return error_response(404, fmt::format("run {} has no procedure of the number '{}'", run.value, number));
}

}  // namespace

void Api::list_procedures(const ApiRequest& call) {
    answer_page(call, ListPage::usual(archive::Order::oldest_first),
                [this](archive::Reader&, const ListRequest& wanted) {
                    return wanted.response_of_whole(parts_.procedures.list(parts_.dictionary), {"procedures"});
                });
}

void Api::get_procedure(const ApiRequest& call) {
    const auto query = QueryText::parse(call.request.query, {"format"});
    if (!query) return call.respond(error_response(400, query.error()));
    const auto format = query->one_of("format", form_formats);
    if (!format) return call.respond(error_response(400, format.error()));
    answer_on_query_thread(call, [this, id = call.parts[0], format = *format](archive::Reader&) {
        auto found = parts_.procedures.procedure(id, parts_.dictionary);
        if (!found) return error_response(404, found.error());
        if (format == "text") {
            if (!found->read.procedure)
                return error_response(409, fmt::format("procedure {} breaks a rule: {}", id, found->findings_text()));
            return HttpResponse{200, "text/plain; charset=utf-8", "no-store",
                                procedures::printed(*found->read.procedure, parts_.dictionary)};
        }
        v1::ProcedureForm form;
        if (found->read.procedure) form = pipeline::form_of(*found->read.procedure, parts_.dictionary);
        form.mutable_entry()->set_procedure(id);
        for (const auto& finding : found->read.findings) form.mutable_entry()->add_findings(finding.text());
        form.set_text(std::move(found->text));
        return json_response(form);
    });
}

void Api::act(const ApiRequest& call, Acting acting) {
    const auto question = [this, acting = std::move(acting), clock = clock(),
                           respond = call.respond](archive::Reader& reader, archive::RunId id,
                                                   const QueryText&) -> std::optional<HttpResponse> {
        const auto newest = reader.newest_ert(id);
        if (!newest) return error_response(500, newest.error());
        auto made = acting(reader, id, clock(id).value_or(*newest));
        if (auto* refused = std::get_if<HttpResponse>(&made)) return std::move(*refused);
        const bool taken = std::visit(ToPipeline{parts_.pipeline, id, respond}, std::move(made));
        if (taken) return {};
        return full_response("too much waits to be stored: try again");
    };
    ask(call, {}, question, JobPriority::at_once);
}

void Api::begin_procedure(const ApiRequest& call) {
    v1::ProcedureBeginRequest wanted;
    if (auto unreadable = read_signed(call, wanted)) return call.respond(std::move(*unreadable));
    act(call, [this, wanted](archive::Reader&, archive::RunId, Ert now) -> Acted {
        auto found = parts_.procedures.procedure(wanted.procedure(), parts_.dictionary);
        if (!found) return error_response(422, found.error());
        if (!found->read.procedure)
            return error_response(
                422, fmt::format("procedure {} breaks a rule: {}", wanted.procedure(), found->findings_text()));
        auto made = procedure_act_of(wanted, std::move(found->text), wanted.by(), now);
        if (!made) return error_response(422, made.error());
        return std::move(*made);
    });
}

void Api::post_procedure_act(const ApiRequest& call) {
    v1::ProcedureActRequest wanted;
    if (auto unreadable = read_signed(call, wanted)) return call.respond(std::move(*unreadable));
    act(call, [wanted, given = call.parts[1]](archive::Reader& reader, archive::RunId id, Ert now) -> Acted {
        const auto number = procedure_number(given);
        if (!number) return no_procedure(id, given);
        const auto begun = reader.has_procedure(id, *number);
        if (!begun) return error_response(500, begun.error());
        if (!*begun) return no_procedure(id, given);
        auto made = procedure_act_of(wanted, *number, wanted.by(), now);
        if (!made) return error_response(422, made.error());
        return std::move(*made);
    });
}

void Api::post_position_act(const ApiRequest& call) {
    v1::PositionActRequest wanted;
    if (auto unreadable = read_body(call.request.body, wanted)) return call.respond(std::move(*unreadable));
    if (call.who.accounts) wanted.set_by(person_of(call.who));
    if (const auto allowed = may_direct(call.who, wanted); !allowed)
        return call.respond(error_response(403, allowed.error()));
    act(call, [wanted](archive::Reader&, archive::RunId, Ert now) -> Acted {
        auto made = position_act_of(wanted, wanted.by(), now);
        if (!made) return error_response(422, made.error());
        return std::move(*made);
    });
}

void Api::list_procedure_acts(const ApiRequest& call) {
    const auto question = [given = call.parts[1]](archive::Reader& reader, archive::RunId id,
                                                  const QueryText&) -> std::optional<HttpResponse> {
        const auto number = procedure_number(given);
        if (!number) return no_procedure(id, given);
        auto acts = reader.procedure_acts(id, *number);
        if (!acts) return error_response(500, acts.error());
        if (acts->empty()) return no_procedure(id, given);
        v1::ProcedureActList list;
        for (auto& act : *acts) *list.add_acts() = std::move(act);
        return json_response(list);
    };
    ask(call, {}, question, JobPriority::soon);
}

}  // namespace aeolis::server
