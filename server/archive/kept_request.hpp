// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/kept.pb.h"

#include <string>

// Requests to a run as the table `requests` keeps them: Protobuf text, which anyone who opens the file can read.
namespace aeolis::archive {

std::string kept_text(const v1::KeptRequest& request);

/// Parses a kept request. Its case is KEPT_NOT_SET when the text is not one.
v1::KeptRequest kept_request(const std::string& text);

}  // namespace aeolis::archive
