// SPDX-License-Identifier: Apache-2.0
#include "server/base/log_line.hpp"

#include "server/base/json_object.hpp"

#include <fmt/format.h>
#include <iterator>
#include <spdlog/pattern_formatter.h>
#include <spdlog/spdlog.h>

namespace aeolis::server {
namespace {

/// Of the process: set once, before there are threads.
bool& printed_json() {
    static bool json = false;
    return json;
}

class TextLine final : public spdlog::formatter {
  public:
    void format(const spdlog::details::log_msg& message, spdlog::memory_buf_t& line) override {
        head_.format(message, line);
        const auto text = printable({message.payload.data(), message.payload.size()});
        line.append(text.data(), text.data() + text.size());
        line.push_back('\n');
    }
    std::unique_ptr<spdlog::formatter> clone() const override { return std::make_unique<TextLine>(); }

  private:
    spdlog::pattern_formatter head_{"[%Y-%m-%d %H:%M:%S.%e] [%^%l%$] ", spdlog::pattern_time_type::local, ""};
};

// spdlog's patterns do not escape their arguments.
class JsonLine final : public spdlog::formatter {
  public:
    void format(const spdlog::details::log_msg& message, spdlog::memory_buf_t& line) override {
        time_.format(message, line);
        const std::string_view text{message.payload.data(), message.payload.size()};
        fmt::format_to(std::back_inserter(line), R"("level":"{}","message":{}}})", to_string_view(message.level),
                       json_text(text));
        line.push_back('\n');
    }
    std::unique_ptr<spdlog::formatter> clone() const override { return std::make_unique<JsonLine>(); }

  private:
    spdlog::pattern_formatter time_{R"({"time":"%Y-%m-%dT%H:%M:%S.%eZ",)", spdlog::pattern_time_type::utc, ""};
};

}  // namespace

std::string printable(std::string_view text) {
    std::string shown;
    shown.reserve(text.size());
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto octet = static_cast<unsigned char>(text[i]);
        const auto next = i + 1 < text.size() ? static_cast<unsigned char>(text[i + 1]) : 0U;
        if (octet == '\n')
            shown += "\\n";
        else if (octet == '\t')
            shown += "\\t";
        else if (octet < 0x20 || octet == 0x7F)
            fmt::format_to(std::back_inserter(shown), "\\x{:02x}", octet);
        else if (octet == 0xC2 && next >= 0x80 && next < 0xA0)  // control characters 80 to 9f in UTF-8
            fmt::format_to(std::back_inserter(shown), "\\x{:02x}", static_cast<unsigned char>(text[++i]));
        else
            shown += text[i];
    }
    return shown;
}

void print_json() {
    printed_json() = true;
}

void print_line(std::FILE* to, std::string_view text) {
    if (!printed_json()) return fmt::print(to, "{}\n", text);
    const auto level = to == stderr ? spdlog::level::err : spdlog::level::info;
    spdlog::memory_buf_t line;
    JsonLine{}.format(spdlog::details::log_msg{"", level, {text.data(), text.size()}}, line);
    std::fwrite(line.data(), 1, line.size(), to);
}

void log_always(std::string_view text) {
    const auto log = spdlog::default_logger();
    if (log->level() == spdlog::level::off) return;
    spdlog::logger unfiltered{log->name(), log->sinks().begin(), log->sinks().end()};  // the sinks filter nothing
    unfiltered.flush_on(log->flush_level());
    unfiltered.info("{}", text);
}

std::unique_ptr<spdlog::formatter> text_lines() {
    return std::make_unique<TextLine>();
}

std::unique_ptr<spdlog::formatter> json_lines() {
    return std::make_unique<JsonLine>();
}

}  // namespace aeolis::server
