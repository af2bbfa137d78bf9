// SPDX-License-Identifier: Apache-2.0
#include "server/api/api.hpp"
#include "server/api/query_text.hpp"
#include "server/base/json.hpp"

#include <fmt/format.h>

// The routes of campaigns. All read or create files, so they answer from a query thread.
namespace aeolis::server {
namespace {

template <typename Message>
HttpResponse response_or_conflict(const Result<Message>& done, unsigned status = 200) {
    return done ? json_response(*done, status) : error_response(409, done.error().message);  // also an unreadable file
}

}  // namespace

void Api::ask_campaign(const ApiRequest& call, CampaignQuestion question) {
    answer_on_query_thread(call, [this, name = call.parts[0], disconnected = call.request.disconnected,
                                  question = std::move(question)](archive::Reader&) {
        const auto file = parts_.campaigns.file_of(name);
        if (!file)
            return error_response(404,
                                  fmt::format("campaign '{}': there is none; GET /api/v1/campaigns lists them", name));
        const auto stop = parts_.queries.stop_of_question(disconnected);
        auto response = question(*file, stop);
        return stop() ? stopped_response("ask for fewer touchdowns by limit; aeolis campaign reads a file of any size")
                      : response;
    });
}

void Api::list_campaigns(const ApiRequest& call) {
    answer_page(
        call, ListPage::usual(archive::Order::newest_first),
        [this](archive::Reader&, const ListRequest& wanted) {
            return wanted.response_of_whole(parts_.campaigns.list(), {"campaigns"});
        },
        JobPriority::in_turn);  // it opens a file per campaign
}

void Api::start_campaign(const ApiRequest& call) {
    v1::StartCampaign wanted;
    if (auto unreadable = read_body(call.request.body, wanted)) return call.respond(std::move(*unreadable));
    answer_on_query_thread(call, [this, wanted](archive::Reader&) {
        auto order = parts_.campaigns.order_of(wanted);
        if (!order) return error_response(422, order.error());
        return response_or_conflict(parts_.campaigns.start(std::move(*order)), 202);
    });
}

void Api::campaign_report(const ApiRequest& call) {
    ask_campaign(call, [this](const std::filesystem::path& file, const std::function<bool()>& stop) {
        return response_or_conflict(parts_.campaigns.report(file, stop));
    });
}

void Api::campaign_touchdowns(const ApiRequest& call) {
    const auto query = QueryText::parse(call.request.query, {"after", "limit"});
    if (!query) return call.respond(error_response(400, query.error()));
    constexpr auto most = campaign::CampaignManager::touchdowns_max;
    const auto after = query->count("after", UINT32_MAX), limit = query->amount("limit", most);
    if (!after) return call.respond(error_response(400, after.error()));
    if (!limit) return call.respond(error_response(400, limit.error()));
    ask_campaign(call, [this, place = after->value_or(0), limit = limit->value_or(most)](
                           const std::filesystem::path& file, const std::function<bool()>& stop) {
        return response_or_conflict(parts_.campaigns.touchdowns(file, place, limit, stop));
    });
}

void Api::cancel_campaign(const ApiRequest& call) {
    ask_campaign(call, [this, name = call.parts[0]](const std::filesystem::path&, const std::function<bool()>&) {
        return response_or_conflict(parts_.campaigns.cancel(name), 202);
    });
}

}  // namespace aeolis::server
