// SPDX-License-Identifier: Apache-2.0
#include "server/rehearsal/command_messages.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

namespace server_command_messages_test {

using namespace aeolis;

namespace {

/// Entry at SCLK 1000, which is 2000-001T12:00:10 at the vehicle; light takes 4 s.
const archive::RunClocks clocks{{Sclk{1000.0}, Scet{10'000'000}, 1.0, 0, 1}, Sclk{1000.0}, 4.0};

Result<commands::Request> request_at(const std::string& release_at) {
    v1::CommandRequest request;
    request.set_release_at(release_at);
    return server::request_of(request, clocks);
}

}  // namespace

TEST_CASE("a command leaves at a time of Earth as it is written", "[gateway][R62]") {
    CHECK_FALSE(request_at("")->release_at.has_value());
    for (const char* text : {"2000-001T12:00:01.500", "2000-01-01T12:00:01.5Z", "ert:2000-001T12:00:01.500",
                             "2000-01-01T14:00:01.500000+02:00", "ert:2000-01-01T12:00:01.5+00:00"}) {
        INFO(text);
        CHECK(request_at(text)->release_at == Ert{1'500'000});
    }
}

TEST_CASE("a command with a time of the vehicle leaves so that it arrives there then", "[gateway][R62]") {
    for (const char* text :
         {"1000", "1000.0", "E+0", "E+0:00", "E-0:00:00", "scet:2000-001T12:00:10", "scet:2000-01-01T14:00:10+02:00"}) {
        INFO(text);
        CHECK(request_at(text)->release_at == Ert{6'000'000});
    }
    CHECK(request_at("E-10:00")->release_at == Ert{-594'000'000});
    CHECK(request_at("E+100.5")->release_at == Ert{106'500'000});
    CHECK(request_at("997.25")->release_at == Ert{3'250'000});
}

TEST_CASE("what is no time is refused as the time at which a command leaves, and so is one beyond all clocks",
          "[gateway][R62]") {
    for (const char* text : {"tomorrow", "E+", "ert:", "ert:E+100", "scet:1000", "nan", "1e300", "-1e12"}) {
        INFO(text);
        const auto refused = request_at(text);
        REQUIRE_FALSE(refused.ok());
        CHECK_THAT(refused.error().message,
                   Catch::StartsWith("release_at: '" + std::string{text} + "' is no instant: seconds of SCLK"));
    }
    v1::CommandRequest request;
    request.set_release_at("E-10:00");
    CHECK(server::request_of(request, {}).error().message ==
          "release_at: 'E-10:00' counts from entry, and nobody knows when the run has it: a time of a clock is wanted");
    request.set_release_at("997.25");
    CHECK(server::request_of(request, {}).error().message ==
          "release_at: nobody knows which SCET the run has: a UTC time is wanted");
}

TEST_CASE("a command that makes no sense is known by what it says, before anybody knows the run's clocks",
          "[gateway][bounds][R62]") {
    const auto fault = [](const v1::CommandRequest& request) {
        const auto checked = server::check_form(request, tests::shipped_dictionary());
        return checked ? "" : checked.error().message;
    };
    v1::CommandRequest request;
    request.set_command("NO_OP");
    CHECK(fault(request).empty());
    for (const char* at : {"2000-001T12:00:01", "ert:2000-001T12:00:01", "E-10:00", "997.25"}) {
        INFO(at);
        request.set_release_at(at);
        CHECK(fault(request).empty());  // whether it is past, and what it means, the run knows
    }
    for (const char* at : {"NaN", "nan", "inf", "-Infinity", "1e300", "soon", "E+", "ert:"}) {
        INFO(at);
        request.set_release_at(at);
        CHECK_THAT(fault(request), Catch::StartsWith("release_at: '" + std::string{at} + "' is no instant"));
    }
    request.clear_release_at();
    request.set_client_id("a b");
    CHECK_THAT(fault(request), Catch::StartsWith("client_id: "));
    request.clear_client_id();
    request.set_service("CD");
    CHECK_THAT(fault(request), Catch::StartsWith("unknown service 'CD'"));
}

}  // namespace server_command_messages_test
