// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/run.pb.h"
#include "common/result.hpp"
#include "server/archive/records.hpp"

#include <map>
#include <optional>
#include <span>
#include <string>

namespace aeolis::server {

/// Fails when a command's id is malformed or given twice. An id has 1 to 64 characters of A–Z a–z 0–9 . _ : -
Result<void> check_client_ids(std::span<const v1::CommandRequest> requests);

/// The commands of a run that carry an id of their client, so that a command sent again is not executed twice.
///
/// In       accepted requests and their stages             Out   the reply to a request that repeats one
/// Rule     within a run an id belongs to one request: one that is equal, apart from its `request` number, repeats it;
///          any other with that id is refused. A refused request leaves no trace, and may be sent again
/// Memory   a few hundred octets per accepted command with an id
class ClientIds {
  public:
    void accepted(const v1::CommandRequest& request, std::uint64_t number);
    /// Keeps the stage as the last one known of its command.
    void note(const archive::StageRecord& stage);

    bool knows(const v1::CommandRequest& request) const { return find(request) != nullptr; }
    /// The reply to a request that repeats a known one, or refuses one that differs; none: the id is new, or there is
    /// none.
    std::optional<v1::CommandReply> reply_to(const v1::CommandRequest& request) const;

  private:
    struct Sent {
        std::uint64_t number = 0;
        std::string content;    ///< a digest
        v1::CommandStage fate;  ///< the last stage
        Ert fate_at{};
    };
    const Sent* find(const v1::CommandRequest& request) const;

    std::map<std::string, Sent> sent_;
    std::map<std::uint64_t, std::string> ids_;  ///< by the command's number
};

}  // namespace aeolis::server
