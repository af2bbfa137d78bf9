// SPDX-License-Identifier: Apache-2.0
#include "server/net/connection_count.hpp"

#include <fmt/format.h>

namespace aeolis::server {

std::string ConnectionCount::enter(const std::string& from, bool loopback) {
    if (all_ >= all_max_) return fmt::format("{} connections are open already", all_max_);
    const auto found = from_.find(from);
    if (!loopback && found != from_.end() && found->second >= each_max_)
        return fmt::format("{} connections are open from {} already", each_max_, from);
    ++all_;
    ++from_[from];
    return {};
}

void ConnectionCount::leave(const std::string& from) {
    --all_;
    if (const auto found = from_.find(from); --found->second == 0) from_.erase(found);
}

}  // namespace aeolis::server
