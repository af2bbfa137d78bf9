// SPDX-License-Identifier: Apache-2.0
#include "server/access/this_user.hpp"

#include <array>
#include <pwd.h>
#include <unistd.h>

namespace aeolis::server {

std::string this_user() {
    passwd entry{};
    passwd* found = nullptr;
    std::array<char, 4096> text{};
    if (::getpwuid_r(::geteuid(), &entry, text.data(), text.size(), &found) == 0 && found != nullptr)
        return found->pw_name;
    return std::to_string(::geteuid());
}

}  // namespace aeolis::server
