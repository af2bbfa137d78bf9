// SPDX-License-Identifier: Apache-2.0
#include "server/access/account_file.hpp"
#include "server/access/role.hpp"
#include "server/access/this_user.hpp"
#include "server/base/wall_clock.hpp"
#include "server/cli/commands.hpp"
#include "server/cli/options.hpp"
#include "server/cli/shipped_paths.hpp"
#include "server/cluster/signed_request.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <functional>
#include <memory>

namespace aeolis::server {
namespace {

struct AccountsOptions {
    std::filesystem::path file;
    std::string user;
    std::string follower, key, role{name_of(Role::controller)};
    std::filesystem::path out;
};

/// Prints the users and tokens of an accounts file.
int accounts_list(const AccountsOptions& options) {
    const auto accounts = read_accounts(options.file);
    if (!accounts) return failed("accounts list: " + accounts.error().message);
    for (const auto& account : accounts->accounts())
        fmt::print("{:<32}  {}{}\n", account.user(), account.role(),
                   account.choose_password() ? ", has yet to choose a password" : "");
    for (const auto& token : accounts->tokens())
        fmt::print("token {:<26}  {}, {}\n", token.name(), token.role(),
                   token.expires().empty() ? "does not expire" : "until " + token.expires());
    for (const auto& follower : accounts->followers())
        fmt::print("follower {:<23}  at most {}, key {}\n", follower.name(), follower.role(), follower.key());
    return 0;
}

/// Changes the followers in the file; a running server takes it over, and its audit has the change.
int change_followers(const AccountsOptions& options, const char* command, const std::string& told,
                     const std::function<Result<void>(v1::AccountFile&)>& change) {
    const auto of_command = [command](const Error& error) {
        return failed(fmt::format("accounts {}: {}", command, error.message));
    };
    const AccountsLock lock{options.file};
    auto accounts = read_accounts(options.file);
    if (!accounts) return of_command(accounts.error());
    if (const auto done = change(*accounts); !done) return of_command(done.error());
    auto& noted = *accounts->add_resets();
    noted.set_user(options.follower);
    noted.set_at(wall_clock_text());
    noted.set_by(this_user());
    noted.set_change(fmt::format("aeolis accounts {}: {}", command, told));
    if (const auto written = write_accounts(options.file, *accounts); !written) return of_command(written.error());
    fmt::print("{}\n", told);
    return 0;
}

int add_follower(const AccountsOptions& options) {
    for (const auto& right : {check_name(options.follower), check_key(options.key)})
        if (!right) return failed("accounts add-follower: " + right.error().message, 2);
    const auto told = fmt::format("follower '{}', whose people are {} at most", options.follower, options.role);
    return change_followers(options, "add-follower", told, [&](v1::AccountFile& accounts) -> Result<void> {
        for (const auto& follower : accounts.followers()) {
            if (follower.name() == options.follower)
                return Error{fmt::format("there is a follower '{}': remove it first", options.follower)};
            if (follower.key() == options.key) return Error{fmt::format("'{}' has this key", follower.name())};
        }
        auto& follower = *accounts.add_followers();
        follower.set_name(options.follower);
        follower.set_key(options.key);
        follower.set_role(options.role);
        return {};
    });
}

int remove_follower(const AccountsOptions& options) {
    const auto told = fmt::format("follower '{}' may ask nothing any more", options.follower);
    return change_followers(options, "remove-follower", told, [&](v1::AccountFile& accounts) -> Result<void> {
        auto& all = *accounts.mutable_followers();
        const auto found = std::ranges::find(all, options.follower, &v1::FollowerKey::name);
        if (found == all.end()) return Error{fmt::format("there is no follower '{}'", options.follower)};
        all.erase(found);
        return {};
    });
}

int make_follower_key(const AccountsOptions& options) {
    const auto key = cluster::make_key(options.out);
    if (!key) return failed("accounts follower-key: " + key.error().message);
    fmt::print("{}\n", *key);
    return 0;
}

/// Gives a user a new password, or creates an administrator of that name; prints the password.
int accounts_reset(const AccountsOptions& options) {
    if (const auto named = check_name(options.user); !named)
        return failed("accounts reset: --user: " + named.error().message, 2);
    const AccountsLock lock{options.file};
    std::error_code ignored;
    auto accounts = std::filesystem::exists(options.file, ignored) ? read_accounts(options.file)
                                                                   : Result<v1::AccountFile>{v1::AccountFile{}};
    if (!accounts) return failed("accounts reset: " + accounts.error().message);
    const bool fresh = find_account(*accounts, options.user) == nullptr;
    const auto password = reset_account(*accounts, options.user);
    auto& reset = *accounts->add_resets();
    reset.set_user(options.user);
    reset.set_at(wall_clock_text());
    reset.set_by(this_user());
    if (const auto written = write_accounts(options.file, *accounts); !written)
        return failed("accounts reset: " + written.error().message);
    fmt::print("{} '{}': {}\n  It only lets its owner choose another.\n", fresh ? "a new administrator," : "user",
               options.user, password);
    return 0;
}

/// Adds what concerns the servers that follow this one (docs/scale.md).
void add_follower_commands(CLI::App& accounts, const std::shared_ptr<AccountsOptions>& options, int& exit_code) {
    const auto of_file = [&](const char* name, const char* help) -> CLI::App& {
        auto& command = *accounts.add_subcommand(name, help);
        command.add_option("--accounts", options->file, "the file")->required()->envname("AEOLIS_ACCOUNTS");
        command.add_option("--name", options->follower, "of the follower")->required();
        return command;
    };
    auto& key = *accounts.add_subcommand(
        "follower-key", "makes the key of a follower (serve --follower-key), and prints its public part");
    key.add_option("--out", options->out, "new file")->required();
    key.callback([options, &exit_code] { exit_code = make_follower_key(*options); });

    auto& add = of_file("add-follower", "lets people at a follower command here, each by the account of that name; a "
                                        "running server takes it over");
    add.add_option("--key", options->key, "its public key")->required();
    add.add_option("--role", options->role, "the most that its people are here")
        ->check(CLI::IsMember({"controller", "director"}))
        ->capture_default_str();
    add.callback([options, &exit_code] { exit_code = add_follower(*options); });

    auto& remove = of_file("remove-follower", "revokes a follower's key; a running server takes it over");
    remove.callback([options, &exit_code] { exit_code = remove_follower(*options); });
}

}  // namespace

void add_accounts_command(CLI::App& program, int& exit_code) {
    const auto options = std::make_shared<AccountsOptions>();
    auto& command =
        *program.add_subcommand("accounts", "lists and resets the accounts of a server, and lists its followers");
    command.require_subcommand(1);
    add_follower_commands(command, options, exit_code);
    auto& list = *command.add_subcommand("list", "prints users and tokens with their roles");
    list.add_option("--accounts", options->file, "the file")->required()->envname("AEOLIS_ACCOUNTS");
    list.callback([options, &exit_code] { exit_code = accounts_list(*options); });

    auto& reset = *command.add_subcommand(
        "reset", "gives a user a new password, or makes a new administrator; a running server takes it over");
    reset.add_option("--accounts", options->file, "the file")->required()->envname("AEOLIS_ACCOUNTS");
    reset.add_option("--user", options->user, "the name")->required();
    reset.callback([options, &exit_code] { exit_code = accounts_reset(*options); });
}

}  // namespace aeolis::server
