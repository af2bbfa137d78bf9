// SPDX-License-Identifier: Apache-2.0
#include "server/base/log_line.hpp"

#include "tests/support/catch.hpp"

#include <spdlog/details/log_msg.h>

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

}  // namespace server_log_line_test
