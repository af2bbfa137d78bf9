// SPDX-License-Identifier: Apache-2.0
// GET /api/v1/runs/{run}/samples: any number of samples, in the memory of one page.

#include "server/api/api.hpp"
#include "server/api/body_parts.hpp"
#include "server/api/query_text.hpp"
#include "server/api/run_questions.hpp"
#include "server/api/sample_text.hpp"

#include <fmt/format.h>

namespace aeolis::server {
namespace {

/// An export request and its progress.
struct SampleExport {
    explicit SampleExport(SampleText lines) : text(std::move(lines)) {}
    SampleText text;
    archive::RunId run;
    std::vector<std::string> channels;
    archive::SclkRange range;
    std::optional<archive::SampleCursor> after;
    bool done = false;

    /// The next page as text, which may be empty; none at the end.
    BodyPart page(archive::Reader& reader) {
        if (done) return std::optional<std::string>{};
        const auto samples = reader.sample_page(run, channels, range, after);
        if (!samples) return samples.error();
        std::string lines;
        text.append(lines, samples->samples);
        after = samples->next;
        done = !after;
        if (done) text.finish(lines);
        return std::optional{std::move(lines)};
    }
};

}  // namespace

void Api::export_samples(const ApiRequest& call) {
    auto query = QueryText::parse(call.request.query, {"names", "from", "to", "format", "align"});
    if (!query) return call.respond(error_response(400, query.error()));
    auto channels = query->list("names");
    auto text = SampleText::make(parts_.dictionary, channels,
                                 {query->text("format").value_or("csv"), query->text("align").value_or("")});
    if (!text) return call.respond(error_response(400, text.error()));
    auto wanted = std::make_shared<SampleExport>(std::move(*text));
    wanted->channels = std::move(channels);
    ask(call, std::move(*query),
        [wanted, &queries = parts_.queries, asker = Asker{client_of(call.who), call.request.disconnected}](
            archive::Reader& reader, archive::RunId run, const QueryText& of) -> std::optional<HttpResponse> {
            const auto range = range_of(of, reader, run);
            if (!range) return error_response(400, range.error());
            wanted->range = *range;
            const auto state = reader.run(run);
            if (!state) return error_response(500, state.error());
            wanted->run = run;
            wanted->text.set_entry(Sclk{state->entry_sclk()});
            auto first = wanted->page(reader);
            if (!first) return error_response(400, first.error());
            HttpResponse response;
            response.content_type = wanted->text.is_csv() ? "text/csv; charset=utf-8" : "application/x-ndjson";
            response.body = wanted->text.head() + first->value_or("");
            if (!wanted->done)
                response.next_part =
                    in_parts(queries, asker, [wanted](archive::Reader& of_part) { return wanted->page(of_part); });
            return response;
        });
}

}  // namespace aeolis::server
