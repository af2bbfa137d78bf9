// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <cstddef>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <string>

namespace aeolis::server {

/// Counts the places for connections, and who holds them.
///
/// Rule     a connection begins as a stranger's, and is known once a request on it came from somebody with rights.
///          Strangers have a part of the places only, and of these each network a part. When a network's part is full,
///          its oldest stranger gives way to the new one; when that of all is, the oldest of the network that has most,
///          so that whoever comes is heard and can become known. Of those known, nobody has more places than are free:
///          commands/shares
/// Shared   loopback, and proxies in front of the server, bring everybody from one address: for them the part of a
///          network does not count
/// Thread   the network thread
class ConnectionCount {
    struct Entry {
        std::string network, person;
        bool known = false;
        std::function<void()> close;
    };

  public:
    struct Limits {
        std::size_t all = 0, strangers = 0, strangers_of_network = 0;
    };
    explicit ConnectionCount(Limits limits) : limits_(limits) {}

    /// A place during its lifetime; the count must outlive it.
    class Place {
      public:
        Place(ConnectionCount& count, std::list<Entry>::iterator entry) : count_(count), entry_(entry) {}
        ~Place() { count_.leave(entry_); }
        Place(const Place&) = delete;
        Place& operator=(const Place&) = delete;
        bool known() const { return entry_->known; }
        /// Makes the connection a known one. The Error says why it must be refused; it then stays a stranger's.
        /// @param person  who it is by account; empty: there are no accounts
        Result<void> know(const std::string& person) { return count_.know(*entry_, person); }

      private:
        ConnectionCount& count_;
        std::list<Entry>::iterator entry_;
    };
    /// Takes a place for a stranger, or the Error says why the connection must be refused.
    /// @param close  closes the connection, which then gives up its place in its own time
    Result<std::shared_ptr<Place>> enter(const std::string& network, bool shared, std::function<void()> close);

    std::size_t all() const { return entries_.size(); }

  private:
    Result<void> know(Entry& entry, const std::string& person);
    void leave(std::list<Entry>::iterator entry);
    /// Closes the oldest stranger of the network with most of them. False: there is none.
    bool make_room();
    void close_oldest_of(const std::string& network);
    void forget_stranger(const Entry& entry);

    Limits limits_;
    std::list<Entry> entries_;  ///< the oldest first
    std::size_t strangers_ = 0;
    std::map<std::string, std::size_t> strangers_of_;  ///< by network
    std::map<std::string, std::size_t> places_of_;     ///< by person
};

}  // namespace aeolis::server
