#include "server/api/api.hpp"
#include "server/api/json.hpp"
#include "server/api/query_text.hpp"

#include <fmt/format.h>

// The routes of campaigns: every one reads or makes files, and answers from a query thread.
namespace aeolis::server {
namespace {

HttpResponse no_campaign(const std::string& campaign) {
    return error_response(404, fmt::format("campaign '{}': there is none; GET /api/v1/campaigns lists them", campaign));
}

template <typename Message>
HttpResponse response_or_conflict(const Result<Message>& done, unsigned status = 200) {
    return done ? json_response(*done, status) : error_response(409, done.error().message);
}

} // namespace

void Api::list_campaigns(const Asked& asked) {
    aside(asked.respond, [this](archive::Reader&) { return json_response(parts_.campaigns.list()); });
}

void Api::start_campaign(const Asked& asked) {
    v1::StartCampaign wanted;
    if (const auto parsed = from_json(asked.request.body, wanted); !parsed)
        return asked.respond(error_response(400, parsed.error().message));
    aside(asked.respond, [this, wanted](archive::Reader&) {
        auto order = parts_.campaigns.order_of(wanted);
        if (!order) return error_response(422, order.error().message);
        return response_or_conflict(parts_.campaigns.start(std::move(*order)), 202);
    });
}

void Api::campaign_report(const Asked& asked) {
    aside(asked.respond, [this, name = asked.parts[0]](archive::Reader&) {
        return parts_.campaigns.has(name) ? response_or_conflict(parts_.campaigns.report(name)) : no_campaign(name);
    });
}

void Api::campaign_touchdowns(const Asked& asked) {
    const auto query = QueryText::parse(asked.request.query, {"after", "limit"});
    if (!query) return asked.respond(error_response(400, query.error().message));
    constexpr auto most = campaign::CampaignDesk::touchdowns_max;
    const auto after = query->count("after", UINT32_MAX), limit = query->count("limit", most);
    if (!after) return asked.respond(error_response(400, after.error().message));
    if (!limit) return asked.respond(error_response(400, limit.error().message));
    aside(asked.respond, [this, name = asked.parts[0], place = after->value_or(0), limit = limit->value_or(most)](archive::Reader&) {
        return parts_.campaigns.has(name) ? response_or_conflict(parts_.campaigns.touchdowns(name, place, limit)) : no_campaign(name);
    });
}

void Api::cancel_campaign(const Asked& asked) {
    aside(asked.respond, [this, name = asked.parts[0]](archive::Reader&) {
        return parts_.campaigns.has(name) ? response_or_conflict(parts_.campaigns.cancel(name)) : no_campaign(name);
    });
}

} // namespace aeolis::server
