#include "server/net/connection_count.hpp"

#include <fmt/format.h>

namespace aeolis::server {

std::string ConnectionCount::enter(const std::string& address, bool loopback) {
    const auto open = ++from_[address];
    ++all_;
    if (all_ > all_max_) return fmt::format("{} connections are open already", all_max_);
    if (!loopback && open > each_max_) return fmt::format("{} connections are open from {} already", each_max_, address);
    return {};
}

void ConnectionCount::leave(const std::string& address) {
    --all_;
    if (const auto found = from_.find(address); --found->second == 0) from_.erase(found);
}

} // namespace aeolis::server
