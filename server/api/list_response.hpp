// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"
#include "server/api/http_message.hpp"
#include "server/api/query_text.hpp"
#include "server/archive/records.hpp"

#include <array>
#include <google/protobuf/message.h>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace aeolis::server {

/// Names a list's field with the rows and, for rows that are a oneof (Item), the cases in it.
struct Rows {
    std::string_view field;                 ///< "events"
    std::vector<std::string_view> kinds{};  ///< "event"
};

/// The rows of a list that are requested, by the parameters after, limit and order.
struct ListPage {
    struct Limits {
        std::size_t usual = 0, most = 0;            ///< rows when none is asked for; most that may be asked for
        archive::Order order{};                     ///< when none is asked for
        std::uint64_t after_max = UINT64_MAX >> 1;  ///< SQLite's integers are signed
    };
    std::uint64_t after = 0;
    std::size_t limit = 0;
    archive::Order order{};

    /// Chosen: 1000 rows when none is asked for, and the most of any list.
    static Limits usual(archive::Order order);
    static Result<ListPage> of(const QueryText& query, const Limits& limits);
};
/// The formats of a list. The first is the default.
///
/// json   the list
/// csv    a header, then one line per row (RFC 4180). One column per field, in the schema's order, named by path:
///        "event.name". An absent field is empty. Octets are hexadecimal. A repeated field takes one cell, its elements
///        separated by blanks, messages as JSON. Beside each SCLK stands SCET when the clock correlation is known
/// jsonl  one line per row, each as in the list
inline constexpr std::array<std::string_view, 3> list_formats{"json", "csv", "jsonl"};

/// Builds the response in a format. The header Aeolis-Next-After also says where the next page begins; 0: there is
/// none.
/// @param format  one of list_formats
/// @param clock   clock correlation of the run that the rows belong to
HttpResponse list_response(std::string_view format, google::protobuf::Message&& list, const Rows& rows,
                           const std::optional<ClockCorrelation>& clock = {});

/// Adds the address of the next page (Link, rel="next", RFC 8288) to the response of a list that has one.
void add_next_link(HttpResponse& response, std::string_view path, std::string_view query);

/// Reduces a complete list to one page, and sets its next_after. A row's number is its place in the list as it
/// stands now, from 1: rows removed between two requests move the later ones.
/// @param list   oldest first
/// @param field  the list's field with the rows
void keep_page(google::protobuf::Message& list, std::string_view field, const ListPage& page);

/// A request for a page of a list that belongs to no run. Its parameters are after, limit, order and format.
struct ListRequest {
    ListPage page;
    std::string format;       ///< one of list_formats
    std::string path, query;  ///< as asked

    static Result<ListRequest> of(const HttpRequest& request, const ListPage::Limits& limits);
    /// The response with the page, and with the address of the next.
    HttpResponse response(google::protobuf::Message&& rows_of_page, const Rows& rows) const;
    /// The same for a complete list, oldest first.
    HttpResponse response_of_whole(google::protobuf::Message&& list, const Rows& rows) const;
};

}  // namespace aeolis::server
