// SPDX-License-Identifier: Apache-2.0
#include "server/base/json.hpp"

#include <algorithm>
#include <google/protobuf/descriptor.h>
#include <google/protobuf/util/json_util.h>
#include <memory>
#include <vector>

namespace aeolis::server {
namespace {

using google::protobuf::Message;

constexpr std::size_t octets_at_once = 8 << 10;  // chosen: of encoded rows; their types are looked up once for all

}  // namespace

std::string to_json(const Message& message) {
    google::protobuf::util::JsonPrintOptions options;
    options.preserve_proto_field_names = true;
    options.always_print_primitive_fields = true;
    std::string json;
    AEOLIS_CHECK(google::protobuf::util::MessageToJsonString(message, &json, options).ok());
    return json;
}

std::string to_json_by_rows(Message&& message, std::string_view rows) {
    const auto& reflection = *message.GetReflection();
    const auto* field = message.GetDescriptor()->FindFieldByName(std::string{rows});
    const auto octets_of_all = static_cast<double>(message.ByteSizeLong());
    std::vector<std::unique_ptr<Message>> taken(static_cast<std::size_t>(reflection.FieldSize(message, field)));
    for (auto row = taken.rbegin(); row != taken.rend(); ++row) row->reset(reflection.ReleaseLast(&message, field));

    // What is before and behind the rows is the same however many there are. Text has no quotation mark of its own.
    const auto without_rows = to_json(message);
    const auto name = '"' + field->name() + "\":[";
    const auto at = without_rows.find(name);
    AEOLIS_CHECK(at != std::string::npos);
    const auto before = at + name.size();
    std::string json = without_rows.substr(0, before);
    for (auto row = taken.begin(); row != taken.end();) {
        const bool first = row == taken.begin();
        const std::unique_ptr<Message> some{message.New()};
        some->CopyFrom(message);
        std::size_t octets = 0;
        for (; row != taken.end() && octets < octets_at_once; ++row) {
            octets += (*row)->ByteSizeLong();
            reflection.AddAllocatedMessage(some.get(), field, row->release());
        }
        const auto with_some = to_json(*some);
        if (first)
            json.reserve(with_some.size() +
                         static_cast<std::size_t>(static_cast<double>(with_some.size()) * octets_of_all /
                                                  static_cast<double>(std::max<std::size_t>(octets, 1))));
        else
            json += ',';
        json.append(with_some, before, with_some.size() - without_rows.size());
    }
    return json.append(without_rows, before);
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
