// SPDX-License-Identifier: Apache-2.0
#include "server/access/account_file.hpp"
#include "server/access/secrets.hpp"
#include "server/api/api.hpp"
#include "server/api/list_response.hpp"
#include "server/base/json.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

// The routes of log-in, users, tokens and audit. Passwords are hashed on the query threads and are in no audit entry.
namespace aeolis::server {
namespace {

constexpr std::size_t audit_page_max = 1'000;  // chosen: about 300 kB

v1::Session session_of(const Operator& who) {
    v1::Session session;
    session.set_accounts(who.accounts);
    session.set_user(who.user);
    if (who.role) session.set_role(std::string{name_of(*who.role)});
    for (const Right right : rights)
        if (right != Right::open && may(who, right)) session.add_rights(std::string{name_of(right)});
    session.set_expires(who.expires);
    session.set_choose_password(who.choose_password);
    return session;
}

constexpr std::chrono::hours browser_length{24 * 365};  // chosen: longer than the preparation of a rehearsal

void set_cookie(HttpResponse& response, const std::string& name, const std::string& value, std::chrono::seconds length,
                bool secure) {
    response.fields.emplace_back("Set-Cookie", fmt::format("{}={}; Path=/; Max-Age={}; HttpOnly; SameSite=Strict{}",
                                                           name, value, length.count(), secure ? "; Secure" : ""));
}

/// What became of a wish: 422 when it was malformed, 409 when it was not possible now.
template <typename Message>
HttpResponse response_of(const Result<void>& formed, const Result<Message>& done, unsigned status) {
    return done ? json_response(*done, status) : error_response(formed ? 409 : 422, done.error());
}
HttpResponse response_of(const Result<void>& done) {
    return done ? HttpResponse{204, "application/json", "no-store", ""} : error_response(409, done.error());
}

Result<void> check_commands(const dictionary::Dictionary& dictionary,
                            const google::protobuf::RepeatedPtrField<std::string>& names) {
    for (const auto& name : names)
        if (dictionary.command(name) == nullptr)
            return Error{fmt::format("commands: '{}' is no command of the dictionary", name)};
    return {};
}

/// Says so in the log, too: by it an administrator sees who guesses.
HttpResponse refused_log_in(Access& access, const std::string& user, const Operator& who, const std::string& why) {
    if (!who.accounts) return error_response(409, why);
    spdlog::warn("log-in of '{}' from {} refused: {}", check_name(user) ? user : "?", who.from, why);
    const auto wait = access.locked_out(user, who.from);
    return wait.count() > 0 && why != Access::wrong_log_in ? retry_response(429, why, wait) : error_response(401, why);
}

std::string outcome_of(bool done, const std::string& why) {
    return done ? "done" : "refused: " + why;
}

}  // namespace

void Api::session(const ApiRequest& call) {
    auto response = json_response(session_of(call.who));
    // Set here, since only the console's page requests this. Set with the page, it would be replaced for every visitor
    // who follows a link from elsewhere: such a request carries no SameSite=Strict cookie.
    if (call.who.browser == no_browser)
        set_cookie(response, parts_.access.browser_cookie(), new_secret(), browser_length, parts_.secure);
    call.respond(std::move(response));
}

void Api::log_in(const ApiRequest& call) {
    v1::LogIn wanted;
    if (auto unreadable = read_body(call.request.body, wanted)) return call.respond(std::move(*unreadable));
    answer_on_query_thread(
        call,
        [this, wanted, who = call.who](archive::Reader&) {
            const auto done = parts_.access.log_in(wanted, who.from);
            // Lock-outs and impossible user names are not audited: somebody not logged in must not be able to fill the
            // audit.
            if (done || (who.accounts && done.error().message == Access::wrong_log_in && check_name(wanted.user())))
                note(done ? done->who : who, "log-in", wanted.user(),
                     outcome_of(done.ok(), done ? "" : done.error().message));
            if (!done) return refused_log_in(parts_.access, wanted.user(), who, done.error().message);
            auto response = json_response(session_of(done->who), 201);
            set_cookie(response, parts_.access.session_cookie(), done->secret, Access::session_length, parts_.secure);
            return response;
        },
        JobPriority::soon);
}

void Api::log_out(const ApiRequest& call) {
    parts_.access.log_out(call.who);
    if (!call.who.session.empty()) note(call.who, "log-out", "", "done");
    HttpResponse response{204, "application/json", "no-store", ""};
    set_cookie(response, parts_.access.session_cookie(), "", std::chrono::seconds{0}, parts_.secure);
    call.respond(std::move(response));
}

void Api::list_users(const ApiRequest& call) {
    answer_page(call, ListPage::usual(archive::Order::oldest_first),
                [this](archive::Reader&, const ListRequest& wanted) {
                    return wanted.response_of_whole(parts_.access.users(), {"users"});
                });
}

void Api::add_user(const ApiRequest& call) {
    v1::NewUser wanted;
    if (auto unreadable = read_body(call.request.body, wanted)) return call.respond(std::move(*unreadable));
    if (const auto known = check_commands(parts_.dictionary, wanted.commands()); !known)
        return call.respond(error_response(422, known.error()));
    answer_on_query_thread(
        call,
        [this, wanted, who = call.who](archive::Reader&) {
            const auto done = parts_.access.add_user(wanted);
            note(who, "user", fmt::format("add '{}' as {}", wanted.user().substr(0, 64), wanted.role().substr(0, 64)),
                 outcome_of(done.ok(), done ? "" : done.error().message));
            return response_of(Access::check_form(wanted), done, 201);
        },
        JobPriority::soon);
}

void Api::change_user(const ApiRequest& call) {
    if (!call.who.role) return call.respond(refusal_of(call.who, Right::watch));
    if (!call.who.accounts) return call.respond(refusal_of(call.who, Right::administer));
    const auto& user = call.parts[0];
    if (user != call.who.user)
        if (auto refused = refusal_of(call.who, Right::administer); refused.status != 200) {
            note(call.who, "user", fmt::format("change '{}'", user.substr(0, 64)), outcome_of(false, refused.body));
            return call.respond(std::move(refused));
        }
    v1::UserChange change;
    if (auto unreadable = read_body(call.request.body, change)) return call.respond(std::move(*unreadable));
    if (const auto known = check_commands(parts_.dictionary, change.commands()); !known)
        return call.respond(error_response(422, known.error()));
    answer_on_query_thread(
        call,
        [this, change, user, who = call.who](archive::Reader&) {
            const auto done = parts_.access.change_user(who, user, change);
            note(who, "user",
                 fmt::format("change '{}'{}{}{}", user.substr(0, 64),
                             change.role().empty() ? "" : ", role " + change.role().substr(0, 64),
                             change.password().empty() ? "" : ", password",
                             change.all_commands() ? ", all commands"
                             : change.commands().empty()
                                 ? ""
                                 : fmt::format(", commands {}", fmt::join(change.commands(), " "))),
                 outcome_of(done.ok(), done ? "" : done.error().message));
            return response_of(Access::check_form(change), done, 200);
        },
        JobPriority::soon);
}

void Api::remove_user(const ApiRequest& call) {
    answer_on_query_thread(
        call, [this, user = call.parts[0]](archive::Reader&) { return response_of(parts_.access.remove_user(user)); },
        JobPriority::soon);
}

void Api::list_tokens(const ApiRequest& call) {
    answer_page(call, ListPage::usual(archive::Order::oldest_first),
                [this](archive::Reader&, const ListRequest& wanted) {
                    return wanted.response_of_whole(parts_.access.tokens(), {"tokens"});
                });
}

void Api::add_token(const ApiRequest& call) {
    v1::NewToken wanted;
    if (auto unreadable = read_body(call.request.body, wanted)) return call.respond(std::move(*unreadable));
    if (const auto known = check_commands(parts_.dictionary, wanted.commands()); !known)
        return call.respond(error_response(422, known.error()));
    if (wanted.owner().empty()) wanted.set_owner(person_of(call.who));
    answer_on_query_thread(
        call,
        [this, wanted](archive::Reader&) {
            return response_of(Access::check_form(wanted), parts_.access.add_token(wanted), 201);
        },
        JobPriority::soon);
}

void Api::remove_token(const ApiRequest& call) {
    answer_on_query_thread(
        call, [this, name = call.parts[0]](archive::Reader&) { return response_of(parts_.access.remove_token(name)); },
        JobPriority::soon);
}

void Api::audit(const ApiRequest& call) {
    const ListPage::Limits limits{audit_page_max, audit_page_max, archive::Order::oldest_first, UINT32_MAX};
    answer_page(call, limits, [](archive::Reader& reader, const ListRequest& wanted) {
        const auto& page = wanted.page;
        const auto entries = reader.audit(page.after, page.limit, page.order);
        if (!entries) return error_response(500, entries.error());
        v1::AuditList list;
        for (const auto& entry : *entries) {
            auto& shown = *list.add_entries();
            shown.set_entry(entry.entry);
            shown.set_at(entry.at);
            shown.set_who(entry.who);
            shown.set_from(entry.from);
            shown.set_action(entry.action);
            shown.set_detail(entry.detail);
            shown.set_outcome(entry.outcome);
            shown.set_hash(entry.hash);
        }
        if (entries->size() == page.limit) list.set_next_after(entries->back().entry);
        return wanted.response(std::move(list), {"entries"});
    });
}

}  // namespace aeolis::server
