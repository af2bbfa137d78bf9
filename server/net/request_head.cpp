// SPDX-License-Identifier: Apache-2.0
#include "server/net/request_head.hpp"

#include <boost/beast/core/string.hpp>
#include <boost/url/parse.hpp>
#include <fmt/format.h>

namespace aeolis::server::net {
namespace {

namespace http = boost::beast::http;
using boost::beast::iequals;

constexpr unsigned http_1_0 = 10;

/// Decodes a path. An encoded slash is no separator and stays encoded [RFC 3986, 2.2].
std::string decoded_path(const boost::urls::url_view& target) {
    std::string path{target.encoded_path()};
    for (auto at = path.find('%'); at != std::string::npos; at = path.find('%', at + 1))
        if (iequals(path.substr(at, 3), "%2f")) path.insert(at + 1, "25");
    return boost::urls::pct_string_view{path}.decode();
}

Result<RequestTarget> parts_of(const boost::urls::url_view& target, std::string host) {
    auto path = decoded_path(target);
    if (path.find('\0') != std::string::npos) return Error{"the request's target has a NUL character"};
    return RequestTarget{std::move(host), std::move(path), std::string{target.encoded_query()}};
}

}  // namespace

std::string refusal_of_framing(const RequestHead& head) {
    for (const auto field : {http::field::host, http::field::content_length, http::field::transfer_encoding})
        if (head.count(field) > 1)
            return fmt::format("{}: once, not {} times", std::string{to_string(field)}, head.count(field));
    if (head.count(http::field::host) == 0 && head.version() != http_1_0) return "Host: is missing";
    const auto encoding = head.find(http::field::transfer_encoding);
    if (encoding == head.end()) return {};
    if (!iequals(encoding->value(), "chunked"))
        return fmt::format("Transfer-Encoding: only chunked, not '{}'", std::string{encoding->value()});
    if (head.version() == http_1_0) return "Transfer-Encoding: HTTP/1.0 has none";
    if (head.count(http::field::content_length) > 0) return "Content-Length and Transfer-Encoding: one of them";
    return {};
}

Result<RequestTarget> target_of(const RequestHead& head) {
    if (const auto path = boost::urls::parse_origin_form(head.target()))
        return parts_of(*path, std::string{head[http::field::host]});
    const auto whole = boost::urls::parse_uri(head.target());
    if (!whole || !whole->has_authority() || (whole->scheme() != "http" && whole->scheme() != "https"))
        return Error{"the request's target is not a path"};
    auto target = parts_of(*whole, std::string{whole->encoded_host_and_port()});
    if (target && target->path.empty()) target->path.push_back('/');
    return target;
}

}  // namespace aeolis::server::net
