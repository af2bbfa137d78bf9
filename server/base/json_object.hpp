// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <fmt/format.h>
#include <iterator>
#include <string>
#include <string_view>

// JSON for reports of subcommands that have no message in schema/.
namespace aeolis::server {

inline std::string json_text(std::string_view text) {
    std::string quoted = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\')
            quoted += {'\\', c};
        else if (static_cast<unsigned char>(c) < 0x20)
            fmt::format_to(std::back_inserter(quoted), "\\u{:04x}", static_cast<unsigned>(c));
        else
            quoted += c;
    }
    return quoted + '"';
}

inline std::string json_number(double value) {
    return std::isfinite(value) ? fmt::format("{}", value) : "null";
}

/// A JSON object; its members keep the order in which they were added.
class JsonObject {
  public:
    JsonObject& raw(std::string_view name, std::string_view json) {
        text_ += (text_.empty() ? "" : ",") + json_text(name) + ":" + std::string{json};
        return *this;
    }
    JsonObject& text(std::string_view name, std::string_view value) { return raw(name, json_text(value)); }
    JsonObject& number(std::string_view name, double value) { return raw(name, json_number(value)); }
    JsonObject& count(std::string_view name, std::uint64_t value) { return raw(name, fmt::format("{}", value)); }
    std::string str() const { return "{" + text_ + "}"; }

  private:
    std::string text_;
};

template <typename Rows, typename ToJson>
std::string json_array(const Rows& rows, ToJson to_json) {
    std::string text;
    for (const auto& row : rows) text += (text.empty() ? "" : ",") + to_json(row);
    return "[" + text + "]";
}

}  // namespace aeolis::server
