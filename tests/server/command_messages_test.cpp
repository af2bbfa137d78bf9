// SPDX-License-Identifier: Apache-2.0
#include "server/rehearsal/command_messages.hpp"

#include "tests/support/catch.hpp"

namespace server_command_messages_test {

using namespace aeolis;

TEST_CASE("the time at which a command leaves is read in either form, and what is no time is refused", "[gateway]") {
    v1::CommandRequest request;
    CHECK_FALSE(server::request_of(request)->release_at.has_value());
    request.set_release_at("2000-001T12:00:01.500");
    CHECK(server::request_of(request)->release_at == Ert{1'500'000});
    request.set_release_at("2000-01-01T12:00:01.5Z");
    CHECK(server::request_of(request)->release_at == Ert{1'500'000});
    request.set_release_at("tomorrow");
    const auto refused = server::request_of(request);
    REQUIRE_FALSE(refused.ok());
    CHECK(refused.error().message == "release_at: 'tomorrow' is not a time like 2012-219T05:10:47.400");
}

}  // namespace server_command_messages_test
