#pragma once

#include "server/api/query_text.hpp"
#include "server/net/http_message.hpp"

#include <google/protobuf/message.h>
#include <string_view>
#include <vector>

namespace aeolis::server {

/// Which field of a list has its rows, and of rows that are one of several (an Item) which of those come in it.
struct Rows {
    std::string_view field;                ///< "events"
    std::vector<std::string_view> kinds{}; ///< "event"
};

/// A list as it is asked for by the parameter "format"; where the next page begins is in the header Aeolis-Next-After, too.
///
/// json   the list, the default
/// csv    a header, then a line a row by RFC 4180, with a column a field in the schema's order, by its path: "event.name". What a row
///        does not have is empty. Octets are hexadecimal; of a repeated field one cell has all, with blanks between, messages as JSON
/// jsonl  a line a row, each as in the list
HttpResponse list_response(const QueryText& query, const google::protobuf::Message& list, const Rows& rows);

} // namespace aeolis::server
