// SPDX-License-Identifier: Apache-2.0
#include "server/api/api.hpp"
#include "server/base/json.hpp"

// The routes of rehearsals: start, control and faults. RehearsalManager carries out and answers.
namespace aeolis::server {
namespace {

// 409: may be requested again later. 422: the request itself is wrong.
RehearsalManager::Began tell_begun(const Respond& respond, bool going_on) {
    return [respond, refused = going_on ? 409U : 422U](const Result<v1::RunState>& state) {
        respond(state ? json_response(*state, 201) : error_response(refused, state.error()));
    };
}

}  // namespace

void sign(const Operator& who, v1::RehearsalControl& control) {
    if (who.accounts && control.has_note()) control.mutable_note()->set_by(person_of(who));
}

void Api::list_rehearsals(const ApiRequest& call) {
    v1::RunList list;
    if (const auto state = current_run(); state.run() != 0) *list.add_runs() = state;
    call.respond(json_response(list));
}

void Api::current_rehearsal(const ApiRequest& call) {
    const auto state = current_run();
    call.respond(state.run() == 0 ? error_response(404, "no rehearsal was started since the server came up")
                                  : json_response(state));
}

void Api::start_rehearsal(const ApiRequest& call) {
    v1::StartRehearsal start;
    if (auto unreadable = read_body(call.request.body, start)) return call.respond(std::move(*unreadable));
    if (const auto allowed = may_start(call.who, parts_.dictionary, start); !allowed)
        return call.respond(error_response(403, allowed.error()));
    if (const auto formed = parts_.rehearsals.check_form(start); !formed)
        return call.respond(error_response(422, formed.error()));
    parts_.rehearsals.start(start, tell_begun(call.respond, parts_.rehearsals.going_on()));
}

void Api::control_rehearsal(const ApiRequest& call) {
    v1::RehearsalControl control;
    if (auto unreadable = read_body(call.request.body, control)) return call.respond(std::move(*unreadable));
    if (const auto allowed = may_control(call.who, parts_.dictionary, control); !allowed)
        return call.respond(error_response(403, allowed.error()));
    sign(call.who, control);
    if (const auto formed = parts_.rehearsals.check_form(control); !formed)
        return call.respond(error_response(422, formed.error()));
    const bool going_on = parts_.rehearsals.going_on();
    const bool starts = control.action_case() == v1::RehearsalControl::kStart;
    const auto done = parts_.rehearsals.control(control, tell_begun(call.respond, going_on));
    if (!done) return call.respond(error_response(going_on ? 422 : 409, done.error()));
    if (!starts) call.respond(json_response(current_run(), 202));
}

}  // namespace aeolis::server
