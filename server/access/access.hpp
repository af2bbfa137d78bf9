// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/access.pb.h"
#include "common/result.hpp"
#include "server/access/role.hpp"

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace aeolis::server {

/// A person for whom a follower vouches by its signature, and what that person may do there.
struct Vouched {
    std::string key;                    ///< public, of the follower, in hexadecimal digits
    std::string user, owner;            ///< as of an Operator
    std::string role;                   ///< of the person at the follower
    std::vector<std::string> commands;  ///< as of an Operator
    std::string session;                ///< empty: a token
};

/// The credentials that a request carries.
struct Credentials {
    std::string cookie, authorization;  ///< header fields, as received
    std::string from;                   ///< address of the peer
    std::optional<Vouched> vouched{};   ///< of a request whose signature was checked; then the fields are empty
};

/// Users, tokens and log-in sessions: decides who may use the server.
///
/// In       credentials, log-ins, changes by an administrator; the accounts file again when another program changed it
/// Out      identities
/// Threads  any. Password calls are slow by design (argon2id): never call them on the network thread
/// Memory   sessions_max sessions; failed log-ins of failures_max keys. Sessions end with the process
class Access {
  public:
    using Clock = std::chrono::system_clock;   ///< of dates: when a token ends
    using Uptime = std::chrono::steady_clock;  ///< of waits: no step of the system's clock ends or prolongs one
    static constexpr std::chrono::hours session_length{12};  ///< chosen: a shift with its hand-overs
    static constexpr std::size_t sessions_max = 1'000;       ///< chosen; the oldest session ends
    static constexpr std::size_t sessions_of_user_max = 16;  ///< chosen; the user's oldest session ends
    static constexpr const char* wrong_log_in = "user or password is wrong";
    static constexpr std::size_t failures_max = 4'096;  ///< chosen; the oldest is forgotten
    static constexpr unsigned tries_of_user = 5;        ///< chosen: per user and network; then that pair is locked out
    static constexpr unsigned tries_of_address = 20;  ///< chosen: per network, whatever the user; then it is locked out
    static constexpr std::chrono::seconds first_lock_out{30};  ///< chosen; each further failure doubles it
    static constexpr std::chrono::seconds longest_lock_out{900};

    struct Settings {
        std::filesystem::path file;  ///< empty: no accounts; everybody may do everything except administer
        bool secure = false;         ///< over TLS: cookies have names that only this host can set
        std::function<Clock::time_point()> now = Clock::now;
        std::function<Uptime::time_point()> uptime = Uptime::now;
    };
    /// Reads the accounts file. A missing file is created with one administrator, whose password is first_password().
    /// The Error names the file.
    static Result<std::unique_ptr<Access>> open(Settings settings);

    bool accounts() const { return !settings_.file.empty(); }
    /// Names of the cookies: of a log-in session and, without accounts, of a browser, which tells a second person from
    /// the first. Over TLS with the prefix __Host- (RFC 6265bis, 4.1.3.2).
    std::string session_cookie() const { return (settings_.secure ? "__Host-" : "") + std::string{"aeolis_session"}; }
    std::string browser_cookie() const { return (settings_.secure ? "__Host-" : "") + std::string{"aeolis_browser"}; }
    /// The password of user "administrator" when open() created the file; else empty.
    const std::string& first_password() const { return first_password_; }

    /// Password resets by `aeolis accounts reset` that are not yet in an audit. Returns each once.
    std::vector<v1::PasswordReset> take_resets();

    /// A person for whom a follower vouches has an account here: its role and commands, the follower's and those at the
    /// follower all bound what that person may do.
    Operator identify(const Credentials& credentials);
    /// The name of the follower with this public key (hexadecimal); none: it is not one, or no longer.
    std::optional<std::string> follower(const std::string& key);

    struct LoggedIn {
        Operator who;
        std::string secret;  ///< goes into the cookie
    };
    /// Logs a user in. Slow. Fails when user or password is wrong, and while locked out (the error says for how long).
    Result<LoggedIn> log_in(const v1::LogIn& asked, const std::string& from);
    /// How long this user, from this address, is refused without checking the password; 0: not locked out.
    std::chrono::seconds locked_out(const std::string& user, const std::string& from);
    void log_out(const Operator& who);

    v1::UserList users();
    /// Checks what a wish says by itself, whoever has an account: words, names and lengths. The Error names the field
    /// and what is allowed. add_user(), change_user() and add_token() check it, too.
    static Result<void> check_form(const v1::NewUser& user);
    static Result<void> check_form(const v1::UserChange& change);
    static Result<void> check_form(const v1::NewToken& token);
    /// Adds a user. Slow, as is change_user().
    Result<v1::User> add_user(const v1::NewUser& user);
    /// Changes one's own password or, as an administrator, any field of another user. Ends that user's other sessions.
    Result<v1::User> change_user(const Operator& who, const std::string& user, const v1::UserChange& change);
    Result<void> remove_user(const std::string& user);
    v1::TokenList tokens();
    Result<v1::Token> add_token(const v1::NewToken& token);
    Result<void> remove_token(const std::string& name);

  private:
    explicit Access(Settings settings) : settings_(std::move(settings)) {}
    struct LiveSession {
        std::string user;
        Uptime::time_point ends;
    };
    struct Failures {
        unsigned count = 0;
        Uptime::time_point last, locked_until;
    };
    /// Applies the change and writes the file; the change counts from then on. Identification does not wait for the
    /// disk. Call without mutex_.
    Result<void> change_file(const std::function<Result<void>(v1::AccountFile&)>& change);
    void end_sessions(const std::string& user, const std::string& but);  ///< call without mutex_
    // Call with mutex_ held:
    void refresh();
    Operator vouched_for(const Vouched& person, const std::string& from);
    std::chrono::seconds lock_out_of(const std::string& user, const std::string& network) const;
    void count_failure(const std::string& key, unsigned allowed);
    Operator operator_of(const v1::Account& account, const std::string& session, const LiveSession& live) const;
    /// Checks the password and its lock-out. Call without mutex_: the comparison runs while the mutex is free.
    /// @return  the hash that matched
    Result<std::string> check_log_in(const std::string& user, const std::string& password, const std::string& address);

    Settings settings_;
    std::string first_password_;
    std::mutex changing_;  ///< lock before mutex_
    std::mutex mutex_;
    v1::AccountFile file_;
    std::filesystem::file_time_type file_time_;
    std::map<std::string, LiveSession> sessions_;  ///< by hash of the secret
    std::map<std::string, Failures> failures_;     ///< by network_of(address), and by that and user
};

}  // namespace aeolis::server
