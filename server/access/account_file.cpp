// SPDX-License-Identifier: Apache-2.0
#include "server/access/account_file.hpp"

#include "server/access/role.hpp"
#include "server/access/secrets.hpp"
#include "server/base/json.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <set>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace aeolis::server {
namespace {

constexpr std::size_t name_octets_max = 32;

std::filesystem::path folder_of(const std::filesystem::path& file) {
    return file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
}

Result<void> check_accounts(const v1::AccountFile& accounts) {
    std::set<std::string> users, tokens, followers, keys;
    const auto check = [](auto& names, const char* what, const std::string& name,
                          const std::string& role) -> Result<void> {
        if (auto named = check_name(name); !named) return named;
        if (!names.insert(name).second) return Error{fmt::format("{} '{}' is there twice", what, name)};
        if (!role_of(role)) return Error{fmt::format("{} '{}': there is no role '{}'", what, name, role)};
        return {};
    };
    for (const auto& account : accounts.accounts())
        if (auto right = check(users, "user", account.user(), account.role()); !right) return right;
    for (const auto& token : accounts.tokens())
        if (auto right = check(tokens, "token", token.name(), token.role()); !right) return right;
    for (const auto& follower : accounts.followers()) {
        if (auto right = check(followers, "follower", follower.name(), follower.role()); !right) return right;
        if (auto right = check_key(follower.key()); !right)
            return Error{fmt::format("follower '{}': {}", follower.name(), right.error().message)};
        if (!keys.insert(follower.key()).second)
            return Error{fmt::format("follower '{}': another one has its key", follower.name())};
    }
    return {};
}

}  // namespace

Result<void> check_name(const std::string& name) {
    const auto allowed = [](char letter) {
        return (letter >= 'a' && letter <= 'z') || (letter >= '0' && letter <= '9') || letter == '-' || letter == '_' ||
               letter == '.';
    };
    const bool begins = !name.empty() && name[0] >= 'a' && name[0] <= 'z';
    if (begins && name.size() <= name_octets_max && std::ranges::all_of(name, allowed)) return {};
    return Error{
        fmt::format("a name has 1 to {} of a-z, 0-9, '-', '_' and '.', and begins with a letter", name_octets_max)};
}

Result<void> check_key(const std::string& digits) {
    constexpr std::size_t key_octets = 32;  // Ed25519
    const auto octets = octets_of_hexadecimal(digits);
    if (octets.size() == key_octets && hexadecimal(octets) == digits) return {};
    return Error{"a public key has 64 hexadecimal digits, in small letters, as aeolis accounts follower-key prints it"};
}

v1::Account* find_account(v1::AccountFile& accounts, const std::string& user) {
    auto& all = *accounts.mutable_accounts();
    const auto found = std::ranges::find(all, user, &v1::Account::user);
    return found == all.end() ? nullptr : &*found;
}

std::string reset_account(v1::AccountFile& accounts, const std::string& user) {
    auto* account = find_account(accounts, user);
    if (account == nullptr) {
        account = accounts.add_accounts();
        account->set_user(user);
        account->set_role(std::string{name_of(Role::administrator)});
    }
    auto password = new_password();
    account->set_password_hash(password_hash(password));
    account->set_choose_password(true);
    return password;
}

AccountsLock::AccountsLock(const std::filesystem::path& file)
    : folder_(::open(folder_of(file).c_str(), O_RDONLY | O_CLOEXEC)) {
    if (folder_ >= 0) ::flock(folder_, LOCK_EX);  // a file system without locks: no exclusion
}

AccountsLock::~AccountsLock() {
    if (folder_ >= 0) ::close(folder_);
}

Result<v1::AccountFile> read_accounts(const std::filesystem::path& file) {
    std::ifstream in{file, std::ios::binary};
    const std::string text{std::istreambuf_iterator<char>{in}, {}};
    if (!in) return Error{file.string() + " cannot be read"};
    v1::AccountFile accounts;
    auto right = from_json(text, accounts);
    if (right) right = check_accounts(accounts);
    if (!right) return Error{fmt::format("{}: {}", file.string(), right.error().message)};
    return accounts;
}

Result<void> write_accounts(const std::filesystem::path& file, const v1::AccountFile& accounts) {
    auto partial = file;
    partial += "-partial";
    const auto failed = [&] { return Error{fmt::format("{}: {}", file.string(), std::strerror(errno))}; };
    const std::string text = to_json(accounts) + "\n";
    ::unlink(partial.c_str());
    const int out = ::open(partial.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    if (out < 0) return failed();
    // Keeps the owner: a server running as its own user must be able to read what root changed.
    struct stat owner{};
    const auto folder = folder_of(file);
    const bool owned = (::stat(file.c_str(), &owner) == 0 || ::stat(folder.c_str(), &owner) == 0) &&
                       ((owner.st_uid == ::geteuid() && owner.st_gid == ::getegid()) ||
                        ::fchown(out, owner.st_uid, owner.st_gid) == 0);
    const bool written =
        owned && ::write(out, text.data(), text.size()) == static_cast<ssize_t>(text.size()) && ::fsync(out) == 0;
    const auto why = failed();
    ::close(out);
    if (!written) return why;
    if (::rename(partial.c_str(), file.c_str()) != 0) return failed();
    const int directory = ::open(folder.c_str(), O_RDONLY | O_CLOEXEC);
    const bool durable = directory >= 0 && ::fsync(directory) == 0;
    const auto not_durable = failed();
    if (directory >= 0) ::close(directory);
    return durable ? Result<void>{} : not_durable;
}

}  // namespace aeolis::server
