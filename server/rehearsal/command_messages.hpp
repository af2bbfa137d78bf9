// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/run.pb.h"
#include "commands/request.hpp"
#include "server/archive/records.hpp"

// What the command path takes and gives, as messages of the stream and rows of the archive.
namespace aeolis::server {

commands::Request request_of(const v1::CommandRequest& message);
v1::CommandReply message_of(const commands::Reply& reply);
/// `seq` is not given yet.
archive::StageRecord record_of(commands::StageReport stage);

}  // namespace aeolis::server
