// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/kept.pb.h"

#include <string>

// What was asked of a run, as the table `requests` keeps it: Protobuf text, which anyone who opens the file can read.
namespace aeolis::archive {

std::string kept_text(const v1::KeptRequest& request);

/// Its case is KEPT_NOT_SET when the text is not of a kept request.
v1::KeptRequest kept_request(const std::string& text);

}  // namespace aeolis::archive
