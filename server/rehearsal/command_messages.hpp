// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/kept.pb.h"
#include "aeolis/v1/run.pb.h"
#include "commands/request.hpp"
#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"
#include "server/archive/records.hpp"
#include "server/archive/run_instant.hpp"

#include <string>

// Converts the command path's inputs and outputs to and from stream messages and archive rows.
namespace aeolis::server {

/// Reads a request. The Error names a field that cannot be read. `clocks`: of its run, for release_at. `browser`:
/// without accounts, the browser that sends it, by which a second person is told apart. `director`: whether its sender
/// may send hazardous commands.
Result<commands::Request> request_of(const v1::CommandRequest& message, const archive::RunClocks& clocks,
                                     const std::string& browser = {}, bool director = false);
/// Checks what a request says by itself, whatever the run does: see commands::check_form(). Also its `release_at` must
/// be an instant, and its `client_id` of its form.
Result<void> check_form(const v1::CommandRequest& message, const dictionary::Dictionary& dictionary);
v1::CommandReply message_of(const commands::Reply& reply);
commands::TimelineVerdict verdict_of(const v1::TimelineVerdict& message);
v1::TimelineVerdict message_of(const commands::TimelineVerdict& verdict);
/// A stage as an archive record, without `seq`.
archive::StageRecord record_of(commands::StageReport stage);

}  // namespace aeolis::server
