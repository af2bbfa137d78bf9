// SPDX-License-Identifier: Apache-2.0
// What openapi.yaml says of a scenario is what its message has.
#include "aeolis/v1/scenario.pb.h"
#include "tests/support/catch.hpp"

#include <fstream>
#include <google/protobuf/descriptor.h>
#include <iterator>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace server_openapi_scenario_test {

using namespace aeolis;

namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;

std::string schema_of(const Descriptor& message) {
    if (message.name() == "Scenario" || message.name() == "CommandArgument") return message.name();
    return "Scenario" + message.name();
}

/// The names under `properties:` of a schema, in order.
std::vector<std::string> properties_of(const std::string& yaml, const std::string& schema) {
    std::vector<std::string> names;
    const auto begin = yaml.find("\n    " + schema + ":\n");
    if (begin == std::string::npos) return names;
    std::istringstream lines{yaml.substr(begin + 1)};
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line) && line.starts_with("      "))
        if (line.starts_with("        ") && line[8] != ' ') names.push_back(line.substr(8, line.find(':') - 8));
    return names;
}

void check_described(const std::string& yaml, const Descriptor& message, std::set<std::string>& seen) {
    if (message.name() == "CommandArgument" || !seen.insert(message.name()).second) return;
    std::vector<std::string> fields;
    for (int i = 0; i < message.field_count(); ++i) fields.push_back(message.field(i)->name());
    INFO(schema_of(message));
    CHECK(properties_of(yaml, schema_of(message)) == fields);
    for (int i = 0; i < message.field_count(); ++i) {
        const auto* field = message.field(i);
        if (field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) check_described(yaml, *field->message_type(), seen);
    }
}

}  // namespace

TEST_CASE("the description of the API has every field of a scenario, and no other", "[api][R62]") {
    std::ifstream in{AEOLIS_SOURCE_DIR "/server/api/openapi.yaml"};
    REQUIRE(in);
    const std::string yaml{std::istreambuf_iterator<char>{in}, {}};
    std::set<std::string> seen;
    check_described(yaml, *v1::Scenario::descriptor(), seen);
    CHECK(seen.size() > 20);
}

}  // namespace server_openapi_scenario_test
