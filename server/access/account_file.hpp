// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/access.pb.h"
#include "common/result.hpp"

#include <filesystem>

namespace aeolis::server {

/// The file of accounts: proto3 JSON of AccountFile. Apart from the archive, which is copied and handed on.
///
/// Fails with the file's name and what is wrong: JSON, a role that there is none of, a name given twice.
Result<v1::AccountFile> read_accounts(const std::filesystem::path& file);
/// In one piece or not at all, durable, and readable for its owner only.
Result<void> write_accounts(const std::filesystem::path& file, const v1::AccountFile& accounts);

/// Held from reading the file until it is written: another process that wants to change it waits.
class AccountsLock {
  public:
    explicit AccountsLock(const std::filesystem::path& file);
    ~AccountsLock();
    AccountsLock(const AccountsLock&) = delete;
    AccountsLock& operator=(const AccountsLock&) = delete;

  private:
    int folder_;  ///< locked itself, for the file is another one after each change
};

/// A user's or token's name: 1 to 32 of a-z, 0-9, '-', '_', '.', beginning with a letter.
Result<void> check_name(const std::string& name);

/// Null when there is none.
v1::Account* find_account(v1::AccountFile& accounts, const std::string& user);

/// Gives the user a new password, which only lets its owner choose one; makes an administrator of that name when the
/// user is not there. @return the password
std::string reset_account(v1::AccountFile& accounts, const std::string& user);

}  // namespace aeolis::server
