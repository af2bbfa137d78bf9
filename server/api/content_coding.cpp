// SPDX-License-Identifier: Apache-2.0
#include "server/api/content_coding.hpp"

#include "common/check.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <optional>
#include <zlib.h>

namespace aeolis::server {
namespace {

constexpr int gzip_window_bits = 15 + 16;  // zlib.h: 16 more than the window asks for gzip's header
constexpr int memory_level = 8;            // zlib's default
constexpr int compression_level = 5;       // chosen: three quarters of the time of 6, for 2 % more octets of a list

std::string_view trimmed(std::string_view text) {
    const auto begin = text.find_first_not_of(" \t");
    if (begin == std::string_view::npos) return {};
    return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

/// Takes the text up to `separator`, without blanks at its ends, off the front of `rest`.
std::string_view next_part(std::string_view& rest, char separator) {
    const auto part = rest.substr(0, rest.find(separator));
    rest.remove_prefix(std::min(rest.size(), part.size() + 1));
    return trimmed(part);
}

bool same_word(std::string_view one, std::string_view other) {
    return std::ranges::equal(one, other, [](unsigned char a, unsigned char b) { return std::tolower(a) == b; });
}

/// A weight, "q=0.5"; none when it is not well formed.
std::optional<double> weight_of(std::string_view text) {
    if (text.empty()) return 1.0;
    if (text.size() < 3 || !same_word(text.substr(0, 2), "q=")) return std::nullopt;
    text.remove_prefix(2);
    double weight = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), weight, std::chars_format::fixed);
    if (error != std::errc{} || end != text.data() + text.size() || !(weight >= 0.0 && weight <= 1.0))
        return std::nullopt;
    return weight;
}

bool is_text(std::string_view content_type) {
    static constexpr std::array<std::string_view, 5> types{"text/", "application/json", "application/x-ndjson",
                                                           "application/yaml", "image/svg+xml"};
    return std::ranges::any_of(types, [&](std::string_view type) { return content_type.starts_with(type); });
}

/// A body in parts on its way.
struct CodedParts {
    Gzip gzip;
    decltype(HttpResponse::next_part) next_part;
    bool ended = false;

    BodyPart coded(const BodyPart& part) {
        if (!part) return part.error();
        if (*part) return std::optional{gzip.add(**part)};
        ended = true;
        return std::optional{gzip.end()};
    }
};

}  // namespace

AcceptedCodings accepted_codings(std::string_view accept_encoding) {
    std::optional<double> gzip, identity, any;
    while (!accept_encoding.empty()) {
        auto element = next_part(accept_encoding, ',');
        const auto name = next_part(element, ';');
        const auto weight = weight_of(trimmed(element));
        if (!weight) continue;
        if (same_word(name, "gzip") || same_word(name, "x-gzip"))
            gzip = weight;
        else if (same_word(name, "identity"))
            identity = weight;
        else if (name == "*")
            any = weight;
    }
    const double gzip_weight = gzip.value_or(any.value_or(0.0));
    return {gzip_weight > 0.0 && gzip_weight >= identity.value_or(0.0), identity.value_or(any.value_or(1.0)) > 0.0};
}

struct Gzip::State {
    z_stream stream{};
    State() {
        AEOLIS_CHECK(deflateInit2(&stream, compression_level, Z_DEFLATED, gzip_window_bits, memory_level,
                                  Z_DEFAULT_STRATEGY) == Z_OK);
    }
    ~State() { deflateEnd(&stream); }
    State(const State&) = delete;
    State& operator=(const State&) = delete;
};

Gzip::Gzip() : state_(std::make_shared<State>()) {}

std::string Gzip::add(std::string_view part) {
    return deflated(part, Z_NO_FLUSH);
}

std::string Gzip::end() {
    return deflated({}, Z_FINISH);
}

std::string Gzip::deflated(std::string_view part, int flush) {
    constexpr std::size_t step_octets = 64 << 10;
    auto& stream = state_->stream;
    std::string input{part};
    stream.next_in = reinterpret_cast<Bytef*>(input.data());
    stream.avail_in = static_cast<uInt>(input.size());
    std::string output;
    int done = Z_OK;
    do {
        const auto written = output.size();
        output.resize(written + step_octets);
        stream.next_out = reinterpret_cast<Bytef*>(output.data() + written);
        stream.avail_out = step_octets;
        done = deflate(&stream, flush);
        output.resize(output.size() - stream.avail_out);
    } while (done == Z_OK && (stream.avail_out == 0 || stream.avail_in > 0));
    return output;
}

void encode(HttpResponse& response, const AcceptedCodings& accepted) {
    if (response.status != 200 || !is_text(response.content_type)) return;
    if (!response.next_part && response.body.size() < coded_octets_min && accepted.identity) return;
    response.fields.emplace_back("Vary", "Accept-Encoding");
    if (!accepted.gzip) return;
    response.fields.emplace_back("Content-Encoding", "gzip");
    const auto parts = std::make_shared<CodedParts>();
    response.body = parts->gzip.add(response.body);
    if (!response.next_part) {
        response.body += parts->gzip.end();
        return;
    }
    parts->next_part = std::move(response.next_part);
    response.next_part = [parts](const std::function<void(BodyPart)>& tell) {
        if (parts->ended) return tell(std::optional<std::string>{});
        parts->next_part([parts, tell](const BodyPart& part) { tell(parts->coded(part)); });
    };
}

Respond in_accepted_coding(const HttpRequest& request, const Respond& respond) {
    if (request.method != "GET" && request.method != "HEAD") return respond;
    return [accepted = accepted_codings(request.accept_encoding), respond](HttpResponse response) {
        encode(response, accepted);
        respond(std::move(response));
    };
}

}  // namespace aeolis::server
