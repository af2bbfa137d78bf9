// SPDX-License-Identifier: Apache-2.0
#include "server/access/account_file.hpp"
#include "server/access/this_user.hpp"
#include "server/base/wall_clock.hpp"
#include "server/cli/commands.hpp"
#include "server/cli/options.hpp"
#include "server/cli/shipped_paths.hpp"

#include <fmt/format.h>
#include <memory>

namespace aeolis::server {
namespace {

struct AccountsOptions {
    std::filesystem::path file;
    std::string user;
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

}  // namespace

void add_accounts_command(CLI::App& program, int& exit_code) {
    const auto options = std::make_shared<AccountsOptions>();
    auto& command = *program.add_subcommand("accounts", "lists and resets the accounts of a server");
    command.require_subcommand(1);
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
