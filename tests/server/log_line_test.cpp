// SPDX-License-Identifier: Apache-2.0
#include "server/base/log_line.hpp"

#include "tests/support/catch.hpp"

#include <memory>
#include <spdlog/details/log_msg.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>
#include <sstream>
#include <string>

namespace server_log_line_test {

using namespace aeolis::server;

TEST_CASE("what a client sends makes no line of its own in the log, and says nothing to a terminal", "[operation]") {
    CHECK(printable("X\n2026-11-24 [info] run 1: forged\r\t\x1b[2J\x7f") ==
          "X\\n2026-11-24 [info] run 1: forged\\x0d\\t\\x1b[2J\\x7f");
    CHECK(printable("a\xc2\x9b"
                    "b") == "a\\x9bb");  // CSI in one character
    CHECK(printable("\xc2\xb5s, 10\xe2\x81\xb7 \xc2") == "\xc2\xb5s, 10\xe2\x81\xb7 \xc2");
    for (const auto& formatter : {text_lines(), json_lines()}) {
        spdlog::memory_buf_t line;
        formatter->format({"", spdlog::level::warn, "command 'X\nY' is unknown"}, line);
        const std::string_view text{line.data(), line.size()};
        CHECK(text.find('\n') == text.size() - 1);
        CHECK((text.find("X\\nY") != text.npos || text.find("X\\u000aY") != text.npos));
        CHECK(text.find("warning") != std::string_view::npos);
    }
}

TEST_CASE("what must not be missing is logged at any level, as info, unless there is no log", "[operation][audit]") {
    std::ostringstream text;
    const auto before = spdlog::default_logger();
    const auto logger =
        std::make_shared<spdlog::logger>("test", std::make_shared<spdlog::sinks::ostream_sink_mt>(text));
    logger->set_formatter(json_lines());
    spdlog::set_default_logger(logger);
    for (const auto level : {spdlog::level::info, spdlog::level::warn, spdlog::level::critical, spdlog::level::off}) {
        logger->set_level(level);
        log_always("audit head 7:ab");
        spdlog::info("a command");
    }
    spdlog::set_default_logger(before);
    const auto lines = [&](const std::string& words) {
        int count = 0;
        for (auto at = text.str().find(words); at != std::string::npos; at = text.str().find(words, at + 1)) ++count;
        return count;
    };
    CHECK(lines(R"("level":"info","message":"audit head 7:ab"})") == 3);
    CHECK(lines("a command") == 1);
}

}  // namespace server_log_line_test
