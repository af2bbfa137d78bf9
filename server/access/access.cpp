// SPDX-License-Identifier: Apache-2.0
#include "server/access/access.hpp"

#include "server/access/account_file.hpp"
#include "server/access/network.hpp"
#include "server/access/secrets.hpp"

#include <algorithm>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

namespace aeolis::server {
namespace {

constexpr unsigned token_days_max = 3'650;  // chosen

std::string iso_text(Access::Clock::time_point time) {
    return fmt::format("{:%Y-%m-%dT%H:%M:%S}Z", fmt::gmtime(std::chrono::floor<std::chrono::seconds>(time)));
}

/// The value of the cookie `name` in a Cookie header field; empty when absent.
std::string cookie_value(std::string_view field, std::string_view name) {
    while (!field.empty()) {
        const auto end = field.find(';');
        auto pair = field.substr(0, end);
        field = end == std::string_view::npos ? std::string_view{} : field.substr(end + 1);
        while (pair.starts_with(' ')) pair.remove_prefix(1);
        const auto equals = pair.find('=');
        if (equals != std::string_view::npos && pair.substr(0, equals) == name)
            return std::string{pair.substr(equals + 1)};
    }
    return {};
}

v1::User user_of(const v1::Account& account) {
    v1::User user;
    user.set_user(account.user());
    user.set_role(account.role());
    user.set_choose_password(account.choose_password());
    *user.mutable_commands() = account.commands();
    return user;
}

v1::Token token_of(const v1::AccessToken& token) {
    v1::Token shown;
    shown.set_name(token.name());
    shown.set_role(token.role());
    shown.set_created(token.created());
    shown.set_expires(token.expires());
    shown.set_owner(token.owner());
    *shown.mutable_commands() = token.commands();
    return shown;
}

bool is_administrator(const v1::Account& account) {
    return account.role() == name_of(Role::administrator);
}

Error no_accounts() {
    return Error{"this server has no accounts: it is started with --accounts FILE to have some"};
}
Error no_user(const std::string& user) {
    return Error{fmt::format("there is no user '{}'", user)};
}

Result<void> check_role(const std::string& role) {
    if (role_of(role)) return {};
    return Error{fmt::format("role: '{}' is none of observer, controller, director, instructor, administrator", role)};
}

Result<void> check_name_of(const char* field, const std::string& name) {
    const auto named = check_name(name);
    return named ? named : Error{fmt::format("{}: {}", field, named.error().message)};
}

}  // namespace

Result<std::unique_ptr<Access>> Access::open(Settings settings) {
    std::unique_ptr<Access> access{new Access{std::move(settings)}};
    if (!access->accounts()) return access;
    const auto& file = access->settings_.file;
    std::error_code error;
    const AccountsLock lock{file};
    if (!std::filesystem::exists(file, error)) {
        v1::AccountFile fresh;
        access->first_password_ = reset_account(fresh, "administrator");
        if (auto written = write_accounts(file, fresh); !written) return written.error();
    }
    auto accounts = read_accounts(file);
    if (!accounts) return accounts.error();
    if (std::ranges::none_of(accounts->accounts(), is_administrator))
        return Error{fmt::format("{}: no user is an administrator; aeolis accounts reset makes one", file.string())};
    access->file_ = std::move(*accounts);
    access->file_time_ = std::filesystem::last_write_time(file, error);
    return access;
}

void Access::refresh() {
    std::error_code error;
    const auto time = std::filesystem::last_write_time(settings_.file, error);
    if (error || time == file_time_) return;
    file_time_ = time;
    auto accounts = read_accounts(settings_.file);
    if (!accounts) return spdlog::error("accounts: {}; those of before count on", accounts.error().message);
    file_ = std::move(*accounts);
}

Result<void> Access::change_file(const std::function<Result<void>(v1::AccountFile&)>& change) {
    const std::scoped_lock one_at_a_time{changing_};
    const AccountsLock of_all_processes{settings_.file};
    auto changed = read_accounts(settings_.file);
    if (!changed) return changed.error();
    if (auto done = change(*changed); !done) return done;
    if (auto written = write_accounts(settings_.file, *changed); !written) return written;
    const std::scoped_lock lock{mutex_};
    file_ = std::move(*changed);
    std::error_code ignored;
    file_time_ = std::filesystem::last_write_time(settings_.file, ignored);
    return {};
}

std::vector<v1::PasswordReset> Access::take_resets() {
    std::vector<v1::PasswordReset> resets;
    {
        const std::scoped_lock lock{mutex_};
        if (accounts()) refresh();
        if (file_.resets().empty()) return resets;
    }
    const auto taken = change_file([&](v1::AccountFile& file) -> Result<void> {
        resets.assign(file.resets().begin(), file.resets().end());
        file.clear_resets();
        return {};
    });
    if (!taken) resets.clear();
    return resets;
}

Operator Access::operator_of(const v1::Account& account, const std::string& session, const LiveSession& live) const {
    Operator who;
    who.user = account.user();
    who.role = role_of(account.role());
    who.commands.assign(account.commands().begin(), account.commands().end());
    who.choose_password = account.choose_password();
    who.session = session;
    who.expires =
        iso_text(settings_.now() + std::chrono::duration_cast<Clock::duration>(live.ends - settings_.uptime()));
    return who;
}

namespace {

/// Binds `who` to the commands of an account as well. With none left it may only watch: an empty list would allow all.
void bind_to_commands(Operator& who, const v1::Account& account) {
    const auto& allowed = account.commands();
    if (allowed.empty()) return;
    if (who.commands.empty()) return who.commands.assign(allowed.begin(), allowed.end());
    std::erase_if(who.commands,
                  [&](const std::string& command) { return std::ranges::find(allowed, command) == allowed.end(); });
    if (who.commands.empty()) who.role = std::min(who.role, std::optional{Role::observer});
}

}  // namespace

Operator Access::identify(const Credentials& credentials) {
    Operator nobody;
    nobody.from = credentials.from;
    if (!accounts()) {
        nobody.accounts = false;
        nobody.role = Role::instructor;
        const auto browser = cookie_value(credentials.cookie, browser_cookie());
        nobody.browser = browser.empty() ? std::string{no_browser} : secret_hash(browser);
        return nobody;
    }
    constexpr std::string_view bearer = "Bearer ";
    const std::scoped_lock lock{mutex_};
    refresh();
    if (credentials.vouched) return vouched_for(*credentials.vouched, credentials.from);
    if (credentials.authorization.starts_with(bearer)) {
        const auto hash = secret_hash(credentials.authorization.substr(bearer.size()));
        const auto token = std::ranges::find(file_.tokens(), hash, &v1::AccessToken::secret_hash);
        if (token == file_.tokens().end() ||
            (!token->expires().empty() && token->expires() < iso_text(settings_.now())))
            return nobody;
        const auto* owner = find_account(file_, token->owner());
        if (!token->owner().empty() && owner == nullptr) return nobody;
        nobody.user = "token " + token->name();
        nobody.owner = token->owner();
        nobody.role = role_of(token->role());
        if (owner != nullptr) nobody.role = std::min(nobody.role, role_of(owner->role()));
        nobody.expires = token->expires();
        nobody.commands.assign(token->commands().begin(), token->commands().end());
        if (owner != nullptr) bind_to_commands(nobody, *owner);
        return nobody;
    }
    const auto secret = cookie_value(credentials.cookie, session_cookie());
    if (secret.empty()) return nobody;
    const auto session = sessions_.find(secret_hash(secret));
    if (session == sessions_.end()) return nobody;
    const auto* account = find_account(file_, session->second.user);
    if (account == nullptr || session->second.ends < settings_.uptime()) {
        sessions_.erase(session);
        return nobody;
    }
    auto who = operator_of(*account, session->first, session->second);
    who.from = credentials.from;
    return who;
}

Operator Access::vouched_for(const Vouched& person, const std::string& from) {
    Operator nobody;
    nobody.from = from;
    const auto follower = std::ranges::find(file_.followers(), person.key, &v1::FollowerKey::key);
    if (follower == file_.followers().end()) return nobody;
    nobody.from = fmt::format("follower {}, {}", follower->name(), from);
    const auto* account = find_account(file_, person.owner.empty() ? person.user : person.owner);
    const auto there = role_of(person.role);
    if (account == nullptr || !there) return nobody;
    auto who = nobody;
    who.user = person.user;
    who.owner = person.owner;
    who.role = std::min({role_of(account->role()), role_of(follower->role()), there});
    who.choose_password = account->choose_password();
    if (!person.session.empty()) who.session = follower->name() + ' ' + person.session;
    who.commands = person.commands;
    bind_to_commands(who, *account);
    return who;
}

std::optional<std::string> Access::follower(const std::string& key) {
    if (!accounts()) return std::nullopt;
    const std::scoped_lock lock{mutex_};
    refresh();
    const auto found = std::ranges::find(file_.followers(), key, &v1::FollowerKey::key);
    return found == file_.followers().end() ? std::nullopt : std::optional{found->name()};
}

std::chrono::seconds Access::lock_out_of(const std::string& user, const std::string& network) const {
    const auto now = settings_.uptime();
    std::chrono::seconds wait{0};
    for (const auto& key : {network, network + ' ' + user})
        if (const auto found = failures_.find(key); found != failures_.end() && found->second.locked_until > now)
            wait = std::max(wait, std::chrono::ceil<std::chrono::seconds>(found->second.locked_until - now));
    return wait;
}

std::chrono::seconds Access::locked_out(const std::string& user, const std::string& from) {
    const std::scoped_lock lock{mutex_};
    return lock_out_of(user, network_of(from));
}

void Access::count_failure(const std::string& key, unsigned allowed) {
    const auto now = settings_.uptime();
    if (failures_.size() >= failures_max && !failures_.contains(key))
        failures_.erase(std::ranges::min_element(failures_, {}, [](const auto& each) { return each.second.last; }));
    auto& failures = failures_[key];
    if (now - failures.last > longest_lock_out) failures.count = 0;  // the last failure is long ago
    failures.last = now;
    if (++failures.count < allowed) return;
    const auto doublings = std::min(failures.count - allowed, 5U);
    failures.locked_until = now + std::min<std::chrono::seconds>(first_lock_out * (1U << doublings), longest_lock_out);
}

Result<std::string> Access::check_log_in(const std::string& user, const std::string& password,
                                         const std::string& address) {
    const std::string from = network_of(address);
    std::string hash;
    {
        const std::scoped_lock lock{mutex_};
        refresh();
        if (const auto wait = lock_out_of(user, from); wait.count() > 0)
            return Error{fmt::format("too many wrong log-ins from {}: wait {} s", from, wait.count())};
        if (const auto* account = find_account(file_, user)) hash = account->password_hash();
    }
    const bool matches = password.size() <= password_octets_max && password_matches(hash, password);
    const std::scoped_lock lock{mutex_};
    if (matches) {
        failures_.erase(from + ' ' + user);
        return hash;
    }
    count_failure(from, tries_of_address);
    count_failure(from + ' ' + user, tries_of_user);
    return Error{wrong_log_in};
}

Result<Access::LoggedIn> Access::log_in(const v1::LogIn& asked, const std::string& from) {
    if (!accounts()) return no_accounts();
    if (!check_name(asked.user())) return Error{wrong_log_in};
    const auto matched = check_log_in(asked.user(), asked.password(), from);
    if (!matched) return matched.error();
    const auto now = settings_.uptime();
    const std::scoped_lock lock{mutex_};
    const auto* account = find_account(file_, asked.user());
    // The account may have changed during the check.
    if (account == nullptr || account->password_hash() != *matched) return Error{wrong_log_in};
    std::erase_if(sessions_, [&](const auto& each) { return each.second.ends < now; });
    const auto own = [&](const auto& each) { return each.second.user == asked.user(); };
    const auto older = [](const auto& one, const auto& other) { return one.second.ends < other.second.ends; };
    if (static_cast<std::size_t>(std::ranges::count_if(sessions_, own)) >= sessions_of_user_max)
        sessions_.erase(std::ranges::min_element(sessions_, [&](const auto& one, const auto& other) {
            return own(one) != own(other) ? own(one) : older(one, other);
        }));
    if (sessions_.size() >= sessions_max) sessions_.erase(std::ranges::min_element(sessions_, older));
    LoggedIn done;
    done.secret = new_secret();
    const auto hash = secret_hash(done.secret);
    const LiveSession live{asked.user(), now + session_length};
    sessions_[hash] = live;
    done.who = operator_of(*account, hash, live);
    done.who.from = from;
    return done;
}

void Access::log_out(const Operator& who) {
    const std::scoped_lock lock{mutex_};
    sessions_.erase(who.session);
}

void Access::end_sessions(const std::string& user, const std::string& but) {
    const std::scoped_lock lock{mutex_};
    std::erase_if(sessions_, [&](const auto& each) { return each.second.user == user && each.first != but; });
}

v1::UserList Access::users() {
    const std::scoped_lock lock{mutex_};
    if (accounts()) refresh();
    v1::UserList list;
    for (const auto& account : file_.accounts()) *list.add_users() = user_of(account);
    return list;
}

Result<void> Access::check_form(const v1::NewUser& user) {
    if (auto named = check_name_of("user", user.user()); !named) return named;
    if (auto role = check_role(user.role()); !role) return role;
    return check_password(user.password());
}

Result<void> Access::check_form(const v1::UserChange& change) {
    if (!change.role().empty())
        if (auto role = check_role(change.role()); !role) return role;
    if (change.all_commands() && !change.commands().empty())
        return Error{"commands and all_commands: one of them, not both"};
    if (!change.password().empty()) return check_password(change.password());
    if (change.role().empty() && change.commands().empty() && !change.all_commands())
        return Error{"the change says nothing: role, password, commands or all_commands is wanted"};
    return {};
}

Result<void> Access::check_form(const v1::NewToken& token) {
    if (auto named = check_name_of("name", token.name()); !named) return named;
    if (auto role = check_role(token.role()); !role) return role;
    if (token.days() > token_days_max)
        return Error{fmt::format("days: {} is more than {}", token.days(), token_days_max)};
    return {};
}

Result<v1::User> Access::add_user(const v1::NewUser& user) {
    if (!accounts()) return no_accounts();
    if (auto formed = check_form(user); !formed) return formed.error();
    v1::Account account;
    account.set_user(user.user());
    account.set_role(user.role());
    account.set_password_hash(password_hash(user.password()));
    account.set_choose_password(true);
    *account.mutable_commands() = user.commands();
    const auto done = change_file([&](v1::AccountFile& file) -> Result<void> {
        if (find_account(file, user.user()) != nullptr)
            return Error{fmt::format("there is a user '{}' already", user.user())};
        *file.add_accounts() = account;
        return {};
    });
    if (!done) return done.error();
    return user_of(account);
}

Result<v1::User> Access::change_user(const Operator& who, const std::string& user, const v1::UserChange& change) {
    if (!accounts()) return no_accounts();
    const bool own = user == who.user;
    if (!own && !may(who, Right::administer))
        return Error{fmt::format("only an administrator changes user '{}'", user)};
    if (auto formed = check_form(change); !formed) return formed.error();
    if (own && !change.role().empty()) return Error{"role: nobody changes their own; another administrator does"};
    const bool other_commands = change.all_commands() || !change.commands().empty();
    if (own && other_commands) return Error{"commands: nobody changes their own; another administrator does"};
    std::string hash, hash_before;
    if (!change.password().empty()) {
        if (own && change.password() == change.current_password())
            return Error{"password: it is the one of before, choose another"};
        if (own) {
            auto right = check_log_in(user, change.current_password(), who.from);
            if (!right) return Error{"current_password: " + right.error().message};
            hash_before = std::move(*right);
        }
        hash = password_hash(change.password());
    }
    v1::User shown;
    const auto done = change_file([&](v1::AccountFile& file) -> Result<void> {
        auto* account = find_account(file, user);
        if (account == nullptr) return no_user(user);
        if (!hash_before.empty() && account->password_hash() != hash_before)
            return Error{"current_password: it was changed meanwhile"};
        if (!change.role().empty()) account->set_role(change.role());
        if (other_commands) *account->mutable_commands() = change.commands();
        if (!hash.empty()) {
            account->set_password_hash(hash);
            account->set_choose_password(!own);
        }
        if (std::ranges::none_of(file.accounts(), is_administrator))
            return Error{"role: one administrator must remain"};
        shown = user_of(*account);
        return {};
    });
    if (!done) return done.error();
    if (!hash.empty()) end_sessions(user, who.session);
    return shown;
}

Result<void> Access::remove_user(const std::string& user) {
    if (!accounts()) return no_accounts();
    auto done = change_file([&](v1::AccountFile& file) -> Result<void> {
        auto& all = *file.mutable_accounts();
        const auto found = std::ranges::find(all, user, &v1::Account::user);
        if (found == all.end()) return no_user(user);
        all.erase(found);
        if (std::ranges::none_of(all, is_administrator)) return Error{"one administrator must remain"};
        auto& tokens = *file.mutable_tokens();
        tokens.erase(std::remove_if(tokens.begin(), tokens.end(),
                                    [&](const v1::AccessToken& token) { return token.owner() == user; }),
                     tokens.end());
        return {};
    });
    if (done) end_sessions(user, "");
    return done;
}

v1::TokenList Access::tokens() {
    const std::scoped_lock lock{mutex_};
    if (accounts()) refresh();
    v1::TokenList list;
    for (const auto& token : file_.tokens()) *list.add_tokens() = token_of(token);
    return list;
}

Result<v1::Token> Access::add_token(const v1::NewToken& asked) {
    if (!accounts()) return no_accounts();
    if (auto formed = check_form(asked); !formed) return formed.error();
    const auto role = role_of(asked.role());
    const auto secret = new_secret();
    const auto now = settings_.now();
    v1::AccessToken token;
    token.set_name(asked.name());
    token.set_role(asked.role());
    token.set_owner(asked.owner());
    token.set_secret_hash(secret_hash(secret));
    token.set_created(iso_text(now));
    *token.mutable_commands() = asked.commands();
    if (asked.days() > 0) token.set_expires(iso_text(now + std::chrono::hours{24} * asked.days()));
    const auto done = change_file([&](v1::AccountFile& file) -> Result<void> {
        if (std::ranges::find(file.tokens(), asked.name(), &v1::AccessToken::name) != file.tokens().end())
            return Error{fmt::format("there is a token '{}' already", asked.name())};
        const auto* owner = find_account(file, asked.owner());
        if (owner == nullptr) return Error{fmt::format("owner: there is no user '{}'", asked.owner())};
        if (*role > role_of(owner->role()))
            return Error{fmt::format("role: {} is more than that of its owner {}, {}", asked.role(), owner->user(),
                                     owner->role())};
        *file.add_tokens() = token;
        return {};
    });
    if (!done) return done.error();
    auto shown = token_of(token);
    shown.set_token(secret);
    return shown;
}

Result<void> Access::remove_token(const std::string& name) {
    if (!accounts()) return no_accounts();
    return change_file([&](v1::AccountFile& file) -> Result<void> {
        auto& all = *file.mutable_tokens();
        const auto found = std::ranges::find(all, name, &v1::AccessToken::name);
        if (found == all.end()) return Error{fmt::format("there is no token '{}'", name)};
        all.erase(found);
        return {};
    });
}

}  // namespace aeolis::server
