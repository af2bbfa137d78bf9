// SPDX-License-Identifier: Apache-2.0
#include "server/base/json.hpp"

#include "aeolis/v1/run.pb.h"
#include "aeolis/v1/stream.pb.h"
#include "aeolis/v1/what_if.pb.h"
#include "tests/support/catch.hpp"

namespace server_json_test {

using namespace aeolis;

namespace {

template <typename Message>
server::JsonFault fault_of(const char* json) {
    Message message;
    return server::fault_of_json(json, message).value_or(server::JsonFault{});
}

}  // namespace

TEST_CASE("a value that its field cannot hold is named with the field and what is allowed", "[api][bounds][R62]") {
    const std::pair<const char*, const char*> commands[] = {
        {R"({"priority":-1})", "priority: -1 is not a whole number from 0 to 4294967295"},
        {R"({"priority":1.5})", "priority: 1.5 is not a whole number from 0 to 4294967295"},
        {R"({"priority":"first"})", "priority: \"first\" is not a whole number from 0 to 4294967295"},
        {R"({"number":-3})", "number: -3 is not a whole number from 0 to 18446744073709551615"},
        {R"({"number":"18446744073709551616"})",
         "number: \"18446744073709551616\" is not a whole number from 0 to 18446744073709551615"},
        {R"({"armed":"perhaps"})", "armed: \"perhaps\" is not true or false"},
        {R"({"arguments":[{"value":1},{"value":"much"}]})", "arguments[1].value: \"much\" is not a finite number"},
        {R"({"arguments":[{"value":"NaN"}]})", "arguments[0].value: nan is not a finite number"},
        {R"({"arguments":[{"value":1},{"value":"-Infinity"}]})", "arguments[1].value: -inf is not a finite number"},
    };
    for (const auto& [json, says] : commands) {
        INFO(json);
        const auto fault = fault_of<v1::CommandRequest>(json);
        CHECK(fault.of_value);
        CHECK(fault.words == says);
    }
    for (const char* json :
         {R"({"inject":{"device_fault":{"unit":"C"}}})", R"({"inject":{"device_fault":{"unit":77}}})",
          R"({"inject":{"device_fault":{"unit":0.5}}})"}) {
        INFO(json);
        const auto fault = fault_of<v1::RehearsalControl>(json);
        CHECK(fault.of_value);
        CHECK_THAT(fault.words, Catch::StartsWith("inject.device_fault.unit: ") && Catch::Contains(" is not one of ") &&
                                    Catch::Contains("REDUNDANT_UNIT_A"));
    }
    const auto longest = R"({"pace":")" + std::string(100'000, '9') + R"(x"})";
    CHECK(fault_of<v1::RehearsalControl>(longest.c_str()).words.size() < 120);
}

TEST_CASE("a text that is no such message is told apart from one with a value that makes no sense", "[api][R62]") {
    for (const char* json : {"", "{", "[]", "5", R"({"comand":"NO_OP"})", R"({"command":5})", R"({"command":{}})",
                             R"({"arguments":5})", R"({"arguments":[{"value":NaN}]})"}) {
        INFO(json);
        const auto fault = fault_of<v1::CommandRequest>(json);
        CHECK_FALSE(fault.of_value);
        CHECK_THAT(fault.words, Catch::StartsWith("not a CommandRequest in JSON: "));
        CHECK_THAT(fault.words, !Catch::Contains("\n"));
    }
    v1::CommandRequest message;
    CHECK_FALSE(server::fault_of_json(R"({"command":"NO_OP","priority":3.0,"number":"5"})", message));
    CHECK(message.priority() == 3);
    CHECK(message.number() == 5);
}

}  // namespace server_json_test
