// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <google/protobuf/message.h>
#include <string>
#include <string_view>

namespace aeolis::server {

/// proto3 JSON with snake_case names; fields without presence are always printed.
std::string to_json(const google::protobuf::Message& message);

/// Strict: an unknown field or a wrong type is an Error that names it.
Result<void> from_json(std::string_view json, google::protobuf::Message& message);

}  // namespace aeolis::server
