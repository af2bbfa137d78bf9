// SPDX-License-Identifier: Apache-2.0
// GET /api/v1/runs/{run}/rows: a run for the archive of a follower, in the memory of one step.

#include "server/api/api.hpp"
#include "server/api/body_parts.hpp"
#include "server/api/query_text.hpp"
#include "server/base/json.hpp"
#include "server/cluster/run_snapshot.hpp"

#include <atomic>
#include <chrono>
#include <memory>

namespace aeolis::server {
namespace {

constexpr int at_once_max = 4;  // chosen: each holds a connection to the archive and a step, some MB
constexpr std::chrono::seconds retry_after{5};

/// One of the answers that may be under way.
class UnderWay {
  public:
    explicit UnderWay(std::shared_ptr<std::atomic<int>> taken) : taken_(std::move(taken)) { ++*taken_; }
    UnderWay(const UnderWay&) = delete;
    UnderWay& operator=(const UnderWay&) = delete;
    ~UnderWay() { --*taken_; }
    bool is_free() const { return *taken_ <= at_once_max; }

  private:
    std::shared_ptr<std::atomic<int>> taken_;
};

struct RowsAnswer {
    cluster::RunSnapshot snapshot;
    std::shared_ptr<UnderWay> under_way;
};

}  // namespace

void Api::export_rows(const ApiRequest& call) {
    auto query = QueryText::parse(call.request.query, {"held"});
    if (!query) return call.respond(error_response(400, query.error()));
    v1::RunPosition held;
    if (const auto text = query->text("held"); text && !text->empty())
        if (const auto parsed = from_json(*text, held); !parsed)
            return call.respond(error_response(400, "held: " + parsed.error().message));
    ask(call, std::move(*query),
        [held, file = parts_.archive, taken = rows_under_way_, &queries = parts_.queries,
         asker = Asker{client_of(call.who), call.request.disconnected}](
            archive::Reader&, archive::RunId run, const QueryText&) -> std::optional<HttpResponse> {
            auto under_way = std::make_shared<UnderWay>(taken);
            if (!under_way->is_free())
                return retry_response(503, "runs are given to as many others as is possible at once", retry_after);
            auto begun = cluster::RunSnapshot::begin(file, run, held);
            if (!begun) return error_response(409, begun.error());
            const auto rows = std::make_shared<RowsAnswer>(RowsAnswer{std::move(*begun), std::move(under_way)});
            auto first = rows->snapshot.next();
            if (!first) return error_response(409, first.error());
            HttpResponse response;
            response.content_type = "application/octet-stream";
            response.body = first->value_or("");
            response.next_part = in_parts(queries, asker, [rows](archive::Reader&) { return rows->snapshot.next(); });
            return response;
        });
}

}  // namespace aeolis::server
