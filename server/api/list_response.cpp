// SPDX-License-Identifier: Apache-2.0
#include "server/api/list_response.hpp"

#include "server/archive/reader.hpp"
#include "server/base/csv_text.hpp"
#include "server/base/json.hpp"
#include "server/base/json_object.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fmt/format.h>
#include <google/protobuf/descriptor.h>
#include <google/protobuf/reflection.h>
#include <google/protobuf/text_format.h>
#include <memory>

namespace aeolis::server {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

constexpr double dated_s_max = 1.0e9;  // chosen: an SCLK over thirty years from the correlation is not converted

struct Column {
    std::string name;
    std::vector<const FieldDescriptor*> path;  ///< messages, then the field with the value
    bool scet = false;                         ///< its SCLK converted to SCET
};

bool is_message(const FieldDescriptor& field) {
    return field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE;
}

/// Whether the field is an SCLK: "sclk", "fired_sclk".
bool is_sclk(const FieldDescriptor& field) {
    return field.cpp_type() == FieldDescriptor::CPPTYPE_DOUBLE && field.name().ends_with("sclk") &&
           !field.is_repeated();
}

void add_columns(const Descriptor& row, const std::vector<std::string_view>& kinds, bool dated, const Column& above,
                 std::vector<Column>& columns) {
    for (int i = 0; i < row.field_count(); ++i) {
        const auto* field = row.field(i);
        if (field->real_containing_oneof() != nullptr && std::ranges::find(kinds, field->name()) == kinds.end())
            continue;
        if (field->name().ends_with("_us")) continue;  // its text is read instead
        Column column{above.name + (above.path.empty() ? "" : ".") + field->name(), above.path};
        column.path.push_back(field);
        if (is_message(*field) && !field->is_repeated())
            add_columns(*field->message_type(), kinds, dated, column, columns);
        else
            columns.push_back(column);
        if (!dated || !is_sclk(*field)) continue;
        column.scet = true;
        column.name.replace(column.name.size() - 4, 4, "scet");
        columns.push_back(std::move(column));
    }
}

/// An enumeration as in parameters and in CSV samples: SOURCE_REALTIME is "realtime", UNSPECIFIED is empty. An
/// enumeration whose first value is not called UNSPECIFIED has its words as names.
std::string enum_text(const google::protobuf::EnumDescriptor& kind, int number) {
    constexpr std::string_view unsaid = "UNSPECIFIED";  // follows the prefix of all values
    const auto* value = kind.FindValueByNumber(number);
    if (value == nullptr) return std::to_string(number);
    if (!kind.value(0)->name().ends_with(unsaid)) return value->name();
    if (value->index() == 0) return {};
    std::string text = value->name().substr(kind.value(0)->name().size() - unsaid.size());
    std::ranges::transform(text, text.begin(),
                           [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
    return text;
}

/// @param index  of an element of a repeated field; else -1
std::string value_text(const Message& message, const FieldDescriptor& field, int index) {
    const auto& reflection = *message.GetReflection();
    if (field.cpp_type() == FieldDescriptor::CPPTYPE_ENUM)
        return enum_text(*field.enum_type(), index < 0 ? reflection.GetEnumValue(message, &field)
                                                       : reflection.GetRepeatedEnumValue(message, &field, index));
    std::string text;
    if (field.cpp_type() != FieldDescriptor::CPPTYPE_STRING) {
        google::protobuf::TextFormat::PrintFieldValueToString(message, &field, index, &text);
        return text;
    }
    text = index < 0 ? reflection.GetString(message, &field) : reflection.GetRepeatedString(message, &field, index);
    if (field.type() != FieldDescriptor::TYPE_BYTES) return text;
    std::string hexadecimal;
    for (const char octet : text)
        fmt::format_to(std::back_inserter(hexadecimal), "{:02x}", static_cast<unsigned char>(octet));
    return hexadecimal;
}

std::string repeated_text(const Message& message, const FieldDescriptor& field) {
    const auto& reflection = *message.GetReflection();
    if (is_message(field)) return json_array(reflection.GetRepeatedFieldRef<Message>(message, &field), to_json);
    std::string text;
    for (int i = 0; i < reflection.FieldSize(message, &field); ++i)
        text += (i == 0 ? "" : " ") + value_text(message, field, i);
    return text;
}

std::string scet_text(const ClockCorrelation& clock, Sclk sclk) {
    return std::abs(sclk - clock.sclk) < dated_s_max ? day_of_year_text(clock.scet_of(sclk)) : std::string{};
}

std::string cell_text(const Message& row, const Column& column, const std::optional<ClockCorrelation>& clock) {
    const Message* message = &row;
    for (std::size_t i = 0; i + 1 < column.path.size(); ++i) {
        if (!message->GetReflection()->HasField(*message, column.path[i])) return {};
        message = &message->GetReflection()->GetMessage(*message, column.path[i]);
    }
    const auto& field = *column.path.back();
    if (field.is_repeated()) return repeated_text(*message, field);
    if (field.has_presence() && !message->GetReflection()->HasField(*message, &field)) return {};
    if (column.scet) return scet_text(*clock, Sclk{message->GetReflection()->GetDouble(*message, &field)});
    return value_text(*message, field, -1);
}

/// Appends a CSV line with the texts that `text_of` gives for the columns.
template <typename TextOf>
void append_line(std::string& csv, const std::vector<Column>& columns, TextOf text_of) {
    for (std::size_t i = 0; i < columns.size(); ++i) csv += (i == 0 ? "" : ",") + csv_text(text_of(columns[i]));
    csv += '\n';
}

}  // namespace

ListPage::Limits ListPage::usual(archive::Order order) {
    return {1'000, archive::rows_page_max, order};
}

Result<ListPage> ListPage::of(const QueryText& query, const Limits& limits) {
    static constexpr std::array<std::string_view, 2> orders{"oldest", "newest"};
    const auto after = query.count("after", limits.after_max);
    if (!after) return after.error();
    const auto limit = query.amount("limit", limits.most);
    if (!limit) return limit.error();
    ListPage page{after->value_or(0), static_cast<std::size_t>(limit->value_or(limits.usual)), limits.order};
    if (!query.text("order")) return page;
    const auto order = query.one_of("order", orders);
    if (!order) return order.error();
    page.order = *order == "newest" ? archive::Order::newest_first : archive::Order::oldest_first;
    return page;
}

HttpResponse list_response(std::string_view format, Message&& list, const Rows& rows,
                           const std::optional<ClockCorrelation>& clock) {
    const auto& reflection = *list.GetReflection();
    const auto* field = list.GetDescriptor()->FindFieldByName(std::string{rows.field});
    const auto* next_after = list.GetDescriptor()->FindFieldByName("next_after");
    HttpResponse response;
    if (next_after != nullptr)
        response.fields.emplace_back("Aeolis-Next-After", std::to_string(reflection.GetUInt64(list, next_after)));
    if (format == "json") {
        response.body = to_json_by_rows(std::move(list), rows.field);
    } else if (format == "jsonl") {
        response.content_type = "application/x-ndjson";
        for (const auto& row : reflection.GetRepeatedFieldRef<Message>(list, field))
            response.body += to_json(row) + '\n';
    } else {
        response.content_type = "text/csv; charset=utf-8";
        std::vector<Column> columns;
        add_columns(*field->message_type(), rows.kinds, clock.has_value(), {}, columns);
        append_line(response.body, columns, [](const Column& column) { return column.name; });
        for (const auto& row : reflection.GetRepeatedFieldRef<Message>(list, field))
            append_line(response.body, columns, [&](const Column& column) { return cell_text(row, column, clock); });
    }
    return response;
}

void add_next_link(HttpResponse& response, std::string_view path, std::string_view query) {
    const auto next = response.field("Aeolis-Next-After");
    if (next.empty() || next == "0") return;
    std::string parameters;
    while (!query.empty()) {
        const auto parameter = query.substr(0, query.find('&'));
        query.remove_prefix(std::min(query.size(), parameter.size() + 1));
        if (!parameter.empty() && !parameter.starts_with("after=")) parameters += std::string{parameter} + '&';
    }
    response.fields.emplace_back("Link", fmt::format("<{}?{}after={}>; rel=\"next\"", path, parameters, next));
}

void keep_page(Message& list, std::string_view field_name, const ListPage& page) {
    const auto& reflection = *list.GetReflection();
    const auto* field = list.GetDescriptor()->FindFieldByName(std::string{field_name});
    std::vector<std::unique_ptr<Message>> rows(static_cast<std::size_t>(reflection.FieldSize(list, field)));
    for (auto row = rows.rbegin(); row != rows.rend(); ++row) row->reset(reflection.ReleaseLast(&list, field));

    const bool newest_first = page.order == archive::Order::newest_first;
    const std::uint64_t count = rows.size();
    const std::uint64_t left = !newest_first     ? count - std::min(page.after, count)
                               : page.after == 0 ? count
                                                 : std::min(page.after - 1, count);
    std::uint64_t kept = 0, place = 0;
    for (std::size_t octets = 0; kept < left && kept < page.limit && octets < archive::page_octets_max; ++kept) {
        place = newest_first ? left - kept : count - left + kept + 1;
        auto& row = rows[place - 1];
        octets += row->ByteSizeLong();
        reflection.AddAllocatedMessage(&list, field, row.release());
    }
    if (kept < left) reflection.SetUInt64(&list, list.GetDescriptor()->FindFieldByName("next_after"), place);
}

Result<ListRequest> ListRequest::of(const HttpRequest& request, const ListPage::Limits& limits) {
    const auto query = QueryText::parse(request.query, {"after", "limit", "order", "format"});
    if (!query) return query.error();
    auto format = query->one_of("format", list_formats);
    if (!format) return format.error();
    const auto page = ListPage::of(*query, limits);
    if (!page) return page.error();
    return ListRequest{*page, std::move(*format), request.path, request.query};
}

HttpResponse ListRequest::response(Message&& rows_of_page, const Rows& rows) const {
    auto response = list_response(format, std::move(rows_of_page), rows);
    add_next_link(response, path, query);
    return response;
}

HttpResponse ListRequest::response_of_whole(Message&& list, const Rows& rows) const {
    keep_page(list, rows.field, page);
    return response(std::move(list), rows);
}

}  // namespace aeolis::server
