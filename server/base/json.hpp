// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <google/protobuf/message.h>
#include <optional>
#include <string>
#include <string_view>

namespace aeolis::server {

/// proto3 JSON with snake_case names; fields without presence are always printed.
std::string to_json(const google::protobuf::Message& message);
/// The same for a message with many rows, some rows at a time, because Protobuf takes twenty times the memory of the
/// text. Frees the rows meanwhile.
/// @param rows  name of the message's field with the rows, which are messages
std::string to_json_by_rows(google::protobuf::Message&& message, std::string_view rows);

/// Why a text is not the JSON of a message, in one line.
struct JsonFault {
    std::string words;
    /// The text is such a message, but for a value that its field cannot hold. The words then name the field and what
    /// is allowed: "commands[0].priority: -1 is not a whole number from 0 to 4294967295".
    bool of_value = false;
};
/// Parses strictly as from_json(), and refuses numbers that are not finite, and enumerators without a name.
std::optional<JsonFault> fault_of_json(std::string_view json, google::protobuf::Message& message);

/// Parses strictly: an unknown field or a wrong type is an Error that names it.
Result<void> from_json(std::string_view json, google::protobuf::Message& message);

}  // namespace aeolis::server
