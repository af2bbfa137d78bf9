// SPDX-License-Identifier: Apache-2.0
#include "server/api/http_message.hpp"

#include "aeolis/v1/run.pb.h"
#include "server/base/json.hpp"

#include <algorithm>
#include <array>

namespace aeolis::server {
namespace {

struct Phrase {
    unsigned status;
    const char* text;
};
/// The reason phrases of RFC 9110, 15, for the statuses that this server sends.
constexpr std::array phrases{
    Phrase{400, "Bad Request"},
    Phrase{401, "Unauthorized"},
    Phrase{403, "Forbidden"},
    Phrase{404, "Not Found"},
    Phrase{405, "Method Not Allowed"},
    Phrase{409, "Conflict"},
    Phrase{413, "Content Too Large"},
    Phrase{414, "URI Too Long"},
    Phrase{417, "Expectation Failed"},
    Phrase{422, "Unprocessable Content"},
    Phrase{426, "Upgrade Required"},
    Phrase{429, "Too Many Requests"},
    Phrase{431, "Request Header Fields Too Large"},
    Phrase{500, "Internal Server Error"},
    Phrase{503, "Service Unavailable"},
};

}  // namespace

std::string HttpResponse::field(std::string_view name) const {
    const auto found = std::ranges::find(fields, name, &std::pair<std::string, std::string>::first);
    return found == fields.end() ? std::string{} : found->second;
}

std::string reason_phrase(unsigned status) {
    const auto phrase = std::ranges::find(phrases, status, &Phrase::status);
    return phrase == phrases.end() ? "" : phrase->text;
}

HttpResponse error_response(unsigned status, const std::string& error) {
    v1::ErrorReply problem;
    problem.set_type(std::string{about_blank});
    problem.set_title(reason_phrase(status));
    problem.set_status(status);
    problem.set_detail(error);
    problem.set_error(error);
    HttpResponse response;
    response.status = status;
    response.content_type = "application/problem+json";
    response.body = to_json(problem);
    if (status == 401) response.fields.emplace_back("WWW-Authenticate", "Bearer");
    return response;
}

HttpResponse upgrade_response(const std::string& error) {
    auto response = error_response(426, error);
    response.fields.emplace_back("Upgrade", "websocket");
    response.fields.emplace_back("Connection", "Upgrade");
    response.fields.emplace_back("Sec-WebSocket-Version", "13");
    return response;
}

HttpResponse retry_response(unsigned status, const std::string& error, std::chrono::seconds after) {
    auto response = error_response(status, error);
    response.fields.emplace_back("Retry-After", std::to_string(after.count()));
    return response;
}

}  // namespace aeolis::server
