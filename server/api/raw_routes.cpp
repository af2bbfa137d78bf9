// SPDX-License-Identifier: Apache-2.0
// GET /api/v1/runs/{run}/raw: what links brought, in the memory of one page.

#include "server/api/api.hpp"
#include "server/api/body_parts.hpp"
#include "server/api/query_text.hpp"
#include "server/api/raw_export.hpp"

namespace aeolis::server {
namespace {

/// A time of reception in a query, UTC.
Result<std::optional<Ert>> ert_of(const QueryText& query, const char* name) {
    const auto text = query.text(name);
    if (!text) return std::optional<Ert>{};
    const auto ert = ert_from_text(*text);
    if (!ert) return Error{std::string{name} + ": '" + *text + "' is no UTC time, such as 2012-219T05:10:47.4"};
    return std::optional{*ert};
}

}  // namespace

void Api::export_raw(const ApiRequest& call) {
    auto query = QueryText::parse(call.request.query, {"of", "link", "from", "to", "format"});
    if (!query) return call.respond(error_response(400, query.error()));
    archive::RawQuery wanted;
    const auto of = query->text("of").value_or("octets");
    if (of != "octets" && of != "packets")
        return call.respond(error_response(400, "of: '" + of + "' is neither octets nor packets"));
    wanted.packets = of == "packets";
    wanted.link = query->text("link").value_or("");
    const auto from = ert_of(*query, "from"), to = ert_of(*query, "to");
    if (!from) return call.respond(error_response(400, from.error()));
    if (!to) return call.respond(error_response(400, to.error()));
    wanted.from = *from;
    wanted.to = *to;
    const auto format = query->text("format").value_or("pcap");
    ask(call, std::move(*query),
        [wanted, format, &queries = parts_.queries, asker = Asker{client_of(call.who), call.request.disconnected}](
            archive::Reader& reader, archive::RunId run, const QueryText&) -> std::optional<HttpResponse> {
            if (const auto state = reader.run(run); !state) return error_response(500, state.error());
            auto begun = RawExport::begin(reader, run, wanted, format);
            if (!begun) return error_response(400, begun.error());
            auto pages = std::make_shared<RawExport>(std::move(*begun));
            auto first = pages->page(reader);
            if (!first) return error_response(400, first.error());
            HttpResponse response;
            response.content_type = pages->is_pcap() ? "application/vnd.tcpdump.pcap" : "application/octet-stream";
            response.body = pages->head() + first->value_or("");
            if (!pages->done())
                response.next_part =
                    in_parts(queries, asker, [pages](archive::Reader& of_part) { return pages->page(of_part); });
            return response;
        });
}

}  // namespace aeolis::server
