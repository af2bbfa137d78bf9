// SPDX-License-Identifier: Apache-2.0
#include "server/api/api.hpp"
#include "server/api/query_text.hpp"
#include "server/base/json.hpp"

#include <charconv>
#include <fmt/format.h>

// The routes of forecasts. Those from the truth of a rehearsal are for who may instruct: to others there are none.
namespace aeolis::server {
namespace {

std::optional<std::uint64_t> number_of(std::string_view text) {
    std::uint64_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc{} || end != text.data() + text.size() || number == 0) return std::nullopt;
    return number;
}

HttpResponse no_forecast(archive::RunId run, std::string_view number) {
    return error_response(404, fmt::format("run {}, forecast '{}': there is none; GET /api/v1/runs/{}/forecasts lists "
                                           "them",
                                           run.value, number, run.value));
}

}  // namespace

void Api::post_forecast(const ApiRequest& call) {
    v1::ForecastRequest wanted;
    if (auto unreadable = read_body(call.request.body, wanted)) return call.respond(std::move(*unreadable));
    const bool truth = wanted.from() == v1::ForecastRequest::truth;
    if (truth)
        if (auto refusal = refusal_of(call.who, Right::instruct); refusal.status != 200)
            return call.respond(std::move(refusal));
    if (const auto place = parts_.forecasts->reserve(truth); !place)
        return call.respond(full_response(place.error().message));
    const std::weak_ptr<shadow::ForecastService> service = parts_.forecasts;
    const auto give_back = [service, truth](const Respond& respond) -> Respond {
        return [service, truth, respond](HttpResponse response) {
            if (const auto forecasts = service.lock()) forecasts->fill(truth, {});
            respond(std::move(response));
        };
    };
    ApiRequest asked = call;
    asked.respond = give_back(call.respond);  // whatever is answered but by `kept`, the place is free again
    ask(
        asked, {},
        [this, wanted, service, truth, by = person_of(call.who), respond = call.respond, current = current_run()](
            archive::Reader& reader, archive::RunId id, const QueryText&) -> std::optional<HttpResponse> {
            auto state = reader.run(id);
            if (!state) return error_response(404, state.error());
            if (current.run() == id.value && current.state() != v1::RunState::finished)
                *state->mutable_clocks() = current.clocks();
            auto read = shadow::read_forecast(wanted, *state, reader);
            if (!read) return error_response(422, read.error());
            read->record.asked_by = by;
            const auto kept = [service, truth, read = *read, respond](const Result<std::uint64_t>& number) mutable {
                const auto forecasts = service.lock();  // on the pipeline's thread, which may outlive it
                if (!forecasts) return respond(disk_response("the server ends"));
                if (!number) {
                    forecasts->fill(truth, {});
                    return respond(disk_response(number.error().message));
                }
                read.record.number = *number;
                const auto record = read.record;
                forecasts->fill(truth, std::move(read));
                respond(json_response(forecasts->now(record), 201));
            };
            if (!parts_.pipeline.keep_forecast(read->record, kept))
                return full_response("nothing was asked, too much waits to be stored: try again");
            return std::nullopt;
        },
        JobPriority::soon);
}

void Api::list_forecasts(const ApiRequest& call) {
    auto wanted = ListRequest::of(call.request, ListPage::usual(archive::Order::newest_first));
    if (!wanted) return call.respond(error_response(400, wanted.error()));
    ask(
        call, {},
        [this, wanted = *wanted, truths = may(call.who, Right::instruct)](
            archive::Reader& reader, archive::RunId id, const QueryText&) -> std::optional<HttpResponse> {
            const auto& page = wanted.page;
            const auto records = reader.forecasts(id, truths, page.after, page.limit, page.order);
            if (!records) return error_response(500, records.error());
            v1::ForecastList list;
            for (const auto& record : *records) *list.add_forecasts() = parts_.forecasts->now(record);
            if (records->size() == page.limit) list.set_next_after(records->back().number);
            return wanted.response(std::move(list), {"forecasts"});
        },
        JobPriority::soon);
}

void Api::get_forecast(const ApiRequest& call) {
    ask_forecast(
        call, [this](const archive::ForecastRecord& record) { return json_response(parts_.forecasts->now(record)); });
}

void Api::cancel_forecast(const ApiRequest& call) {
    ask_forecast(call, [this](const archive::ForecastRecord& record) {
        return parts_.forecasts->cancel(record.run, record.number)
                   ? json_response(parts_.forecasts->now(record), 202)
                   : error_response(409, fmt::format("run {}, forecast {}: it neither flies nor waits",
                                                     record.run.value, record.number));
    });
}

void Api::ask_forecast(const ApiRequest& call,
                       const std::function<HttpResponse(const archive::ForecastRecord&)>& answer) {
    ask(
        call, {},
        [answer, truths = may(call.who, Right::instruct), text = call.parts[1]](
            archive::Reader& reader, archive::RunId id, const QueryText&) -> std::optional<HttpResponse> {
            const auto number = number_of(text);
            if (!number) return no_forecast(id, text);
            const auto record = reader.forecast(id, *number);
            if (!record) return error_response(500, record.error());
            if (!*record || ((*record)->truth && !truths)) return no_forecast(id, text);
            return answer(**record);
        },
        JobPriority::soon);
}

}  // namespace aeolis::server
