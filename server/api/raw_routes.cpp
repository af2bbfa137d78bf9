// SPDX-License-Identifier: Apache-2.0
// GET /api/v1/runs/{run}/raw: what links brought, in the memory of one page.

#include "server/api/api.hpp"
#include "server/api/body_parts.hpp"
#include "server/api/query_text.hpp"
#include "server/api/raw_export.hpp"
#include "server/archive/run_instant.hpp"

namespace aeolis::server {
namespace {

/// A time of reception in a query. None when absent.
Result<std::optional<Ert>> ert_of(const QueryText& query, const char* name, const v1::RunState& run) {
    const auto text = query.text(name);
    if (!text) return std::optional<Ert>{};
    const auto ert = archive::reception_of(*text, archive::clocks_of(run), name);
    if (!ert) return ert.error();
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
    const auto format = query->text("format").value_or("pcap");
    ask(call, std::move(*query),
        [wanted, format, &queries = parts_.queries, asker = Asker{client_of(call.who), call.request.disconnected}](
            archive::Reader& reader, archive::RunId run,
            const QueryText& asked) mutable -> std::optional<HttpResponse> {
            const auto state = reader.run(run);
            if (!state) return error_response(500, state.error());
            const auto from = ert_of(asked, "from", *state), to = ert_of(asked, "to", *state);
            if (!from || !to) return error_response(400, (from ? to : from).error());
            wanted.from = *from;
            wanted.to = *to;
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
