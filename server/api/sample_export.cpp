// GET /api/v1/runs/{run}/samples: as many samples as there are, in the memory of a page.

#include "server/api/api.hpp"
#include "server/api/query_text.hpp"
#include "server/api/run_questions.hpp"
#include "server/api/sample_text.hpp"

namespace aeolis::server {
namespace {

/// What is asked for, and how far it has come.
struct SampleExport : std::enable_shared_from_this<SampleExport> {
    SampleExport(QueryThreads& threads, const dictionary::Dictionary& words) : queries(threads), dictionary(words) {}
    QueryThreads& queries;
    const dictionary::Dictionary& dictionary;
    archive::RunId run;
    std::vector<std::string> channels;
    archive::SclkRange range;
    RowFormat format{};
    Sclk entry;
    bool done = false;
    std::function<bool()> gone;

    /// The next page as text; empty: there is none.
    BodyPart page(archive::Reader& reader) {
        const auto samples = reader.sample_page(run, channels, range);
        if (!samples) return samples.error();
        std::string text;
        append_rows(text, format, samples->samples, entry, dictionary);
        done = !samples->next_s;
        if (!done) range.from_s = samples->next_s;
        return text;
    }
    void tell_next(const std::function<void(BodyPart)>& tell) {
        if (done) return tell(std::string{});
        const auto job = [self = shared_from_this(), tell](archive::Reader& reader) { tell(self->page(reader)); };
        if (!queries.ask(job, gone)) tell(Error{"too many questions wait"});
    }
};

} // namespace

void Api::export_samples(const Asked& asked) {
    auto query = QueryText::parse(asked.request.query, {"names", "from", "to", "format"});
    if (!query) return asked.respond(error_response(400, query.error().message));
    const auto format = row_format(query->text("format").value_or("csv"));
    if (!format) return asked.respond(error_response(400, format.error().message));
    const auto range = range_of(*query);
    if (!range) return asked.respond(error_response(400, range.error().message));
    auto wanted = std::make_shared<SampleExport>(parts_.queries, parts_.dictionary);
    wanted->channels = query->list("names");
    wanted->range = *range;
    wanted->format = *format;
    wanted->gone = asked.request.gone;
    ask(asked, std::move(*query), [wanted](archive::Reader& reader, archive::RunId run, const QueryText&) -> std::optional<HttpResponse> {
        const auto state = reader.run(run);
        if (!state) return error_response(500, state.error().message);
        wanted->run = run;
        wanted->entry = Sclk{state->entry_sclk()};
        auto first = wanted->page(reader);
        if (!first) return error_response(400, first.error().message);
        const bool csv = wanted->format == RowFormat::csv;
        HttpResponse response;
        response.content_type = csv ? "text/csv; charset=utf-8" : "application/x-ndjson";
        response.body = std::string{head_of(wanted->format)} + *first;
        if (!wanted->done) response.more = [wanted](const auto& tell) { wanted->tell_next(tell); };
        return response;
    });
}

} // namespace aeolis::server
