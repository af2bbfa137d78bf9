// SPDX-License-Identifier: Apache-2.0
#include "aeolis/v1/stream.pb.h"
#include "server/api/api.hpp"
#include "server/api/embedded_texts.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <google/protobuf/descriptor.pb.h>

// What the API is written in: its description, the Protobuf schema, and that as a set of descriptors.
namespace aeolis::server {
namespace {

constexpr std::string_view schema_folder = "aeolis/v1/";
constexpr std::string_view descriptor_set_name = "descriptor_set.binpb";

const EmbeddedText* text_named(std::string_view name) {
    const auto found = std::ranges::find(embedded_texts, name, &EmbeddedText::name);
    return found == embedded_texts.end() ? nullptr : &*found;
}

bool is_schema(const EmbeddedText& text) {
    return text.name.ends_with(".proto");
}

/// The files in an order in which each follows those that it imports.
void add_file(const google::protobuf::FileDescriptor& file, google::protobuf::FileDescriptorSet& set) {
    if (std::ranges::any_of(set.file(), [&](const auto& added) { return added.name() == file.name(); })) return;
    for (int i = 0; i < file.dependency_count(); ++i) add_file(*file.dependency(i), set);
    file.CopyTo(set.add_file());
}

std::string descriptor_set() {
    google::protobuf::FileDescriptorSet set;
    const auto* pool = v1::ServerMessage::descriptor()->file()->pool();
    for (const auto& text : embedded_texts)
        if (is_schema(text))
            if (const auto* file = pool->FindFileByName(fmt::format("{}{}", schema_folder, text.name)))
                add_file(*file, set);
    return set.SerializeAsString();
}

}  // namespace

void Api::openapi(const ApiRequest& call) {
    answer_on_query_thread(  // where it may be compressed: it is long
        call,
        [](archive::Reader&) {
            return HttpResponse{200, "application/yaml", "no-cache", std::string{text_named("openapi.yaml")->text}};
        },
        JobPriority::at_once);
}

void Api::list_schema(const ApiRequest& call) {
    v1::SchemaFileList list;
    list.set_folder(std::string{schema_folder});
    for (const auto& text : embedded_texts)
        if (is_schema(text)) list.add_files(std::string{text.name});
    list.set_descriptor_set(std::string{descriptor_set_name});
    call.respond(json_response(list));
}

void Api::schema(const ApiRequest& call) {
    const auto& name = call.parts[0];
    if (name == descriptor_set_name) return call.respond({200, "application/x-protobuf", "no-cache", descriptor_set()});
    const auto* text = text_named(name);
    if (text == nullptr || !is_schema(*text))
        return call.respond(
            error_response(404, fmt::format("schema '{}': there is none; /api/v1/schema lists them", name)));
    call.respond({200, "text/plain; charset=utf-8", "no-cache", std::string{text->text}});
}

}  // namespace aeolis::server
