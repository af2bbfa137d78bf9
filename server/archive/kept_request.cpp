// SPDX-License-Identifier: Apache-2.0
#include "server/archive/kept_request.hpp"

#include <google/protobuf/io/tokenizer.h>
#include <google/protobuf/text_format.h>

namespace aeolis::archive {
namespace {

class IgnoredErrors : public google::protobuf::io::ErrorCollector {
  public:
    void AddError(int, int, const std::string&) override {}
};

}  // namespace

std::string kept_text(const v1::KeptRequest& request) {
    std::string text;
    google::protobuf::TextFormat::Printer printer;
    printer.SetUseShortRepeatedPrimitives(true);
    printer.PrintToString(request, &text);
    return text;
}

v1::KeptRequest kept_request(const std::string& text) {
    google::protobuf::TextFormat::Parser parser;
    IgnoredErrors errors;
    parser.RecordErrorsTo(&errors);
    v1::KeptRequest request;
    if (!parser.ParseFromString(text, &request)) request.Clear();
    return request;
}

}  // namespace aeolis::archive
