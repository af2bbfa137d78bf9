// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"
#include "server/api/http_message.hpp"

#include <array>
#include <google/protobuf/message.h>
#include <optional>
#include <string_view>
#include <vector>

namespace aeolis::server {

/// Which field of a list has its rows, and of rows that are one of several (an Item) which of those come in it.
struct Rows {
    std::string_view field;                 ///< "events"
    std::vector<std::string_view> kinds{};  ///< "event"
};

/// The formats of a list, the first where none is asked for.
///
/// json   the list
/// csv    a header, then a line a row by RFC 4180, with a column a field in the schema's order, by its path:
///        "event.name". What a row does not have is empty. Octets are hexadecimal; of a repeated field one cell has
///        all, with blanks between, messages as JSON. Beside each SCLK stands SCET, where it is known by which clock
/// jsonl  a line a row, each as in the list
inline constexpr std::array<std::string_view, 3> list_formats{"json", "csv", "jsonl"};

/// Where the next page begins is in the header Aeolis-Next-After, too.
/// @param format  one of list_formats
/// @param clock   of the run whose rows they are
HttpResponse list_response(std::string_view format, const google::protobuf::Message& list, const Rows& rows,
                           const std::optional<ClockCorrelation>& clock = {});

}  // namespace aeolis::server
