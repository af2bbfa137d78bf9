// SPDX-License-Identifier: Apache-2.0
#include "server/base/json.hpp"

#include <google/protobuf/util/json_util.h>

namespace aeolis::server {

std::string to_json(const google::protobuf::Message& message) {
    google::protobuf::util::JsonPrintOptions options;
    options.preserve_proto_field_names = true;
    options.always_print_primitive_fields = true;
    std::string json;
    AEOLIS_CHECK(google::protobuf::util::MessageToJsonString(message, &json, options).ok());
    return json;
}

Result<void> from_json(std::string_view json, google::protobuf::Message& message) {
    const auto status = google::protobuf::util::JsonStringToMessage(
        google::protobuf::StringPiece{json.data(), json.size()}, &message, {});
    if (status.ok()) return {};
    // The parser adds lines that quote the text and mark the position; the first line is the fault.
    const auto said = status.message().ToString();
    return Error{"not a " + message.GetDescriptor()->name() + " in JSON: " + said.substr(0, said.find('\n'))};
}

}  // namespace aeolis::server
