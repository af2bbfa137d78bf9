// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <string>

namespace aeolis::server {

/// Limits the open connections, in all and per address or network: one peer cannot take all. Loopback has only the
/// total limit: its users can do worse, and a proxy in front of the server brings everybody from there.
class ConnectionCount {
  public:
    ConnectionCount(std::size_t all_max, std::size_t each_max) : all_max_(all_max), each_max_(each_max) {}

    /// Counts one more connection. Returns why it must be refused (then not counted); empty: accepted, until leave().
    std::string enter(const std::string& from, bool loopback);
    void leave(const std::string& from);
    std::size_t all() const { return all_; }

  private:
    std::size_t all_max_, each_max_;
    std::size_t all_ = 0;
    std::map<std::string, std::size_t> from_;
};

}  // namespace aeolis::server
