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
#include <string>
#include <vector>

namespace aeolis::server {

/// What a request says of who asks.
struct Credentials {
    std::string cookie, authorization;  ///< the header fields as they came
    std::string from;                   ///< address of the peer
};

/// Who may use the server: users and tokens of the file of accounts, and who has logged in.
///
/// In       credentials, log-ins, changes by an administrator; the file again when another program changed it
/// Out      identities
/// Threads  any. What takes a password is slow by intention (argon2id): not on the network thread
/// Memory   sessions_max sessions, failures_max networks that guessed; sessions end with the process
class Access {
  public:
    using Clock = std::chrono::system_clock;
    static constexpr std::chrono::hours session_length{12};  ///< ours: a shift, with its hand-overs
    static constexpr std::size_t sessions_max = 1'000;       ///< ours: the oldest ends
    static constexpr std::size_t sessions_of_user_max = 16;  ///< ours: the oldest of that user ends
    static constexpr const char* wrong_log_in = "user or password is wrong";
    static constexpr std::size_t failures_max = 4'096;  ///< ours: the oldest is forgotten
    static constexpr unsigned tries_of_user =
        5;  ///< ours: then this user waits, from this address; of version 6, from its /64
    static constexpr unsigned tries_of_address = 20;           ///< ours: then this address waits, whatever the user
    static constexpr std::chrono::seconds first_lock_out{30};  ///< ours: doubled by each further failure
    static constexpr std::chrono::seconds longest_lock_out{900};

    struct Settings {
        std::filesystem::path file;  ///< empty: no accounts, everybody may do all but administer
        std::function<Clock::time_point()> now = Clock::now;
    };
    /// Makes the file when there is none, with an administrator whose first_password() is to be printed. Fails with a
    /// line that names the file.
    static Result<std::unique_ptr<Access>> open(Settings settings);

    bool accounts() const { return !settings_.file.empty(); }
    /// Of user "administrator", when open() made the file; else empty.
    const std::string& first_password() const { return first_password_; }

    /// What `aeolis accounts reset` has done that no audit has yet; each is given once.
    std::vector<v1::PasswordReset> take_resets();

    Operator identify(const Credentials& credentials);

    struct LoggedIn {
        Operator who;
        std::string secret;  ///< of the cookie
    };
    /// Slow. Refused: wrong, or locked out, and then for how long.
    Result<LoggedIn> log_in(const v1::LogIn& asked, const std::string& from);
    void log_out(const Operator& who);

    v1::UserList users();
    /// Slow, as is change_user().
    Result<v1::User> add_user(const v1::NewUser& user);
    /// One's own password, or as an administrator anything of another's; ends that user's other sessions.
    Result<v1::User> change_user(const Operator& who, const std::string& user, const v1::UserChange& change);
    Result<void> remove_user(const std::string& user);
    v1::TokenList tokens();
    Result<v1::Token> add_token(const v1::NewToken& token);
    Result<void> remove_token(const std::string& name);

  private:
    explicit Access(Settings settings) : settings_(std::move(settings)) {}
    struct LiveSession {
        std::string user;
        Clock::time_point expires;
    };
    struct Failures {
        unsigned count = 0;
        Clock::time_point last, locked_until;
    };
    /// Makes the change, writes the file, and counts from then on; the disk holds up nobody who only identifies.
    /// Without mutex_.
    Result<void> change_file(const std::function<Result<void>(v1::AccountFile&)>& change);
    void end_sessions(const std::string& user, const std::string& but);  ///< without mutex_, too
    // With mutex_ held:
    void refresh();
    Result<void> refuse_locked_out(const std::string& user, const std::string& from);
    void count_failure(const std::string& key, unsigned allowed);
    Operator operator_of(const v1::Account& account, const std::string& session, const LiveSession& live) const;
    /// Without it: takes the mutex, and compares while it is free.
    /// @return the hash that it matched
    Result<std::string> check_log_in(const std::string& user, const std::string& password, const std::string& address);

    Settings settings_;
    std::string first_password_;
    std::mutex changing_;  ///< taken before mutex_
    std::mutex mutex_;
    v1::AccountFile file_;
    std::filesystem::file_time_type file_time_;
    std::map<std::string, LiveSession> sessions_;  ///< by the hash of their secret
    std::map<std::string, Failures> failures_;     ///< by network_of() the address, and by that and user
};

/// The cookies' names: of a log-in; and, without accounts, of a browser, by which a second person is told from the
/// first.
inline constexpr std::string_view session_cookie = "aeolis_session", browser_cookie = "aeolis_browser";

}  // namespace aeolis::server
