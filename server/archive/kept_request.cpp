// SPDX-License-Identifier: Apache-2.0
#include "server/archive/kept_request.hpp"

#include <google/protobuf/io/tokenizer.h>
#include <google/protobuf/text_format.h>

namespace aeolis::archive {
namespace {

class NoWords : public google::protobuf::io::ErrorCollector {
  public:
    void AddError(int, int, const std::string&) override {}  // what is no command is an intervention
};

bool read_text(const std::string& text, google::protobuf::Message& into) {
    google::protobuf::TextFormat::Parser parser;
    NoWords silence;
    parser.RecordErrorsTo(&silence);
    return parser.ParseFromString(text, &into);
}

}  // namespace

std::string kept_text(const google::protobuf::Message& request) {
    std::string text;
    google::protobuf::TextFormat::PrintToString(request, &text);
    return text;
}

KeptRequest kept_request(const std::string& text) {
    if (v1::CommandRequest command; read_text(text, command)) return command;
    if (v1::Intervention intervention; read_text(text, intervention)) return intervention;
    return {};
}

}  // namespace aeolis::archive
