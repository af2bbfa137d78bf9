// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/run.pb.h"

#include <string>
#include <variant>

// What was asked of a run, as the table `requests` keeps it: Protobuf text, which whoever opens the file can read.
namespace aeolis::archive {

std::string kept_text(const google::protobuf::Message& request);

/// None: it is neither of the two.
using KeptRequest = std::variant<std::monostate, v1::CommandRequest, v1::Intervention>;
KeptRequest kept_request(const std::string& text);

}  // namespace aeolis::archive
