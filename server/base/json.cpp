// SPDX-License-Identifier: Apache-2.0
#include "server/base/json.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fmt/format.h>
#include <google/protobuf/descriptor.h>
#include <google/protobuf/util/json_util.h>
#include <limits>
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

namespace {

using google::protobuf::EnumDescriptor;
using google::protobuf::FieldDescriptor;

constexpr std::size_t quoted_octets_max = 60;  // chosen: of a value that is none

/// "a whole number from 0 to 255"
template <typename Number>
std::string whole_number() {
    return fmt::format("a whole number from {} to {}", std::numeric_limits<Number>::min(),
                       std::numeric_limits<Number>::max());
}

std::string one_of(const EnumDescriptor& type) {
    std::string names;
    for (int i = 0; i < type.value_count(); ++i) names += (i == 0 ? "one of " : ", ") + type.value(i)->name();
    return names;
}

/// What a field of the parser's type may hold; empty for texts and messages, which are of another kind in JSON.
std::string allowed(std::string_view type, const Message& message) {
    if (type == "TYPE_UINT32") return whole_number<std::uint32_t>();
    if (type == "TYPE_UINT64") return whole_number<std::uint64_t>();
    if (type == "TYPE_INT32" || type == "TYPE_SINT32") return whole_number<std::int32_t>();
    if (type == "TYPE_INT64" || type == "TYPE_SINT64") return whole_number<std::int64_t>();
    if (type == "TYPE_DOUBLE" || type == "TYPE_FLOAT") return "a finite number";
    if (type == "TYPE_BOOL") return "true or false";
    constexpr std::string_view prefix = "type.googleapis.com/";
    if (!type.starts_with(prefix)) return {};
    const auto* words =
        message.GetDescriptor()->file()->pool()->FindEnumTypeByName(std::string{type.substr(prefix.size())});
    return words == nullptr ? std::string{} : one_of(*words);
}

std::string fault_of(std::string_view field, std::string_view value, const std::string& allowed) {
    const auto shown =
        value.size() <= quoted_octets_max ? std::string{value} : std::string{value.substr(0, quoted_octets_max)} + "…";
    return fmt::format("{}: {} is not {}", field, shown, allowed);
}

/// Reads the parser's "(commands[0].priority): invalid value -1 for type TYPE_UINT32". Empty: it says something else.
std::string value_fault(std::string_view said, const Message& message) {
    constexpr std::string_view invalid = "): invalid value ", of_type = " for type ";
    const auto field_end = said.find(invalid), type = said.rfind(of_type);
    if (!said.starts_with('(') || field_end == std::string_view::npos || type == std::string_view::npos) return {};
    const auto value = field_end + invalid.size();
    if (type < value) return {};
    const auto wanted = allowed(said.substr(type + of_type.size()), message);
    return wanted.empty() ? wanted : fault_of(said.substr(1, field_end - 1), said.substr(value, type - value), wanted);
}

std::string senseless_value(const Message& message, const std::string& path);

/// @param index  of a repeated field; -1: of a single one
std::string senseless_value(const Message& message, const FieldDescriptor& field, int index, const std::string& path) {
    const auto& reflection = *message.GetReflection();
    const bool one = index < 0;
    switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_MESSAGE:
        return senseless_value(
            one ? reflection.GetMessage(message, &field) : reflection.GetRepeatedMessage(message, &field, index), path);
    case FieldDescriptor::CPPTYPE_DOUBLE: {
        const double value =
            one ? reflection.GetDouble(message, &field) : reflection.GetRepeatedDouble(message, &field, index);
        return std::isfinite(value) ? std::string{} : fault_of(path, fmt::format("{}", value), "a finite number");
    }
    case FieldDescriptor::CPPTYPE_FLOAT: {
        const float value =
            one ? reflection.GetFloat(message, &field) : reflection.GetRepeatedFloat(message, &field, index);
        return std::isfinite(value) ? std::string{} : fault_of(path, fmt::format("{}", value), "a finite number");
    }
    case FieldDescriptor::CPPTYPE_ENUM: {
        const int value =
            one ? reflection.GetEnumValue(message, &field) : reflection.GetRepeatedEnumValue(message, &field, index);
        const auto& type = *field.enum_type();
        return type.FindValueByNumber(value) != nullptr ? std::string{}
                                                        : fault_of(path, std::to_string(value), one_of(type));
    }
    default: return {};
    }
}

/// The first number that is not finite, or enumerator without a name; empty: there is none.
/// @param path  before the names of the message's fields
std::string senseless_value(const Message& message, const std::string& path) {
    std::vector<const FieldDescriptor*> fields;
    message.GetReflection()->ListFields(message, &fields);
    for (const auto* field : fields) {
        const auto name = path.empty() ? field->name() : path + '.' + field->name();
        const int size = field->is_repeated() ? message.GetReflection()->FieldSize(message, field) : 0;
        if (!field->is_repeated())
            if (auto fault = senseless_value(message, *field, -1, name); !fault.empty()) return fault;
        for (int i = 0; i < size; ++i)
            if (auto fault = senseless_value(message, *field, i, fmt::format("{}[{}]", name, i)); !fault.empty())
                return fault;
    }
    return {};
}

/// The parser's fault; none: the message is read.
std::optional<JsonFault> parse(std::string_view json, Message& message) {
    const auto status = google::protobuf::util::JsonStringToMessage(
        google::protobuf::StringPiece{json.data(), json.size()}, &message, {});
    if (status.ok()) return std::nullopt;
    // The parser adds lines that quote the text and mark the position; the first line is the fault.
    const auto text = status.message().ToString();
    const auto said = text.substr(0, text.find('\n'));
    if (auto fault = value_fault(said, message); !fault.empty()) return JsonFault{std::move(fault), true};
    return JsonFault{"not a " + message.GetDescriptor()->name() + " in JSON: " + said, false};
}

}  // namespace

std::optional<JsonFault> fault_of_json(std::string_view json, Message& message) {
    if (auto fault = parse(json, message)) return fault;
    if (auto fault = senseless_value(message, ""); !fault.empty()) return JsonFault{std::move(fault), true};
    return std::nullopt;
}

Result<void> from_json(std::string_view json, Message& message) {
    if (auto fault = parse(json, message)) return Error{std::move(fault->words)};
    return {};
}

}  // namespace aeolis::server
