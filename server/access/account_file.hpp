// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/access.pb.h"
#include "common/result.hpp"

#include <filesystem>

namespace aeolis::server {

/// Reads the accounts file: proto3 JSON of AccountFile. It is kept apart from the archive, which is copied and handed
/// on.
///
/// Fails with the file's name and the fault: JSON, an unknown role, a duplicate name.
Result<v1::AccountFile> read_accounts(const std::filesystem::path& file);
/// Writes the whole file or nothing; durable, and readable by its owner only.
Result<void> write_accounts(const std::filesystem::path& file, const v1::AccountFile& accounts);

/// A lock on the accounts file across processes, held from reading it until it is written. Others wait.
class AccountsLock {
  public:
    explicit AccountsLock(const std::filesystem::path& file);
    ~AccountsLock();
    AccountsLock(const AccountsLock&) = delete;
    AccountsLock& operator=(const AccountsLock&) = delete;

  private:
    int folder_;  ///< the folder is locked: each change replaces the file
};

/// Checks the name of a user or token: 1 to 32 of a-z, 0-9, '-', '_', '.', beginning with a letter.
Result<void> check_name(const std::string& name);

/// Checks the public key of a follower.
Result<void> check_key(const std::string& digits);

/// Finds an account. Null when there is none.
v1::Account* find_account(v1::AccountFile& accounts, const std::string& user);

/// Gives the user a new one-time password, which only permits choosing another. Creates an administrator of that name
/// when the user does not exist. @return the password
std::string reset_account(v1::AccountFile& accounts, const std::string& user);

}  // namespace aeolis::server
