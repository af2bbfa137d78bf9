// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "server/archive/run_rows.hpp"
#include "server/cluster/run_messages.hpp"

#include <cstddef>
#include <deque>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

// A run as an answer of HTTP: the messages in which it travels by an engine, one behind the other (docs/decisions/0070).
namespace aeolis::server::cluster {

inline constexpr std::size_t frame_head_octets = 4;  ///< before each message: its length, the highest octet first
/// Of a message, with what it says of its step: as an engine takes it by default.
inline constexpr std::size_t framed_octets_max = 1U << 20U;

/// Reads what was committed of a run behind what somebody holds of it, for GET /api/v1/runs/{run}/rows. Its end is the
/// step that holds all that was committed when it was read.
///
/// In       the archive's file, a transaction for each step: the writer proceeds, and may commit more meanwhile
/// Memory   a step
/// Threads  one at a time
class RunSnapshot {
  public:
    /// The Error: there is no such run, it does not go as far as `held`, or nobody follows this archive.
    static Result<RunSnapshot> begin(const std::filesystem::path& archive, archive::RunId run, v1::RunPosition held);

    /// The next message, behind its length; none at the end.
    Result<std::optional<std::string>> next();

  private:
    RunSnapshot(archive::RunRowsReader reader, v1::RunRows head, v1::RunPosition held);

    archive::RunRowsReader reader_;
    v1::RunRows head_;
    v1::RunPosition position_;
    std::deque<std::string> messages_;  ///< of the step that was read last
    bool whole_ = false;                ///< that step was the last one
};

/// Finds the messages again in octets as they come.
class FramedMessages {
  public:
    void add(std::string_view octets) { octets_ += octets; }
    /// The next message of which all octets are there; none: more are to come. The Error: these are no messages.
    Result<std::optional<v1::RunRows>> next();
    /// Whether a message has begun that is not complete.
    bool within() const { return !octets_.empty(); }

  private:
    std::string octets_;
};

}  // namespace aeolis::server::cluster
