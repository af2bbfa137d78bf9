// SPDX-License-Identifier: Apache-2.0
// The parameters of a question to a recorded run, as anyone may write them behind '?'. The first octet chooses the
// question and the run. What cannot be answered is refused in words; each answer is of the type that it says.
#include "server/api/query_text.hpp"
#include "server/api/run_questions.hpp"
#include "server/base/json.hpp"
#include "tests/fuzz/recorded_run.hpp"

#include <array>
#include <google/protobuf/struct.pb.h>

namespace {

using namespace aeolis;

constexpr std::array questions{"",         "channels",   "packets",      "tones",     "events",
                               "commands", "timepoints", "explanations", "recording", "proof",
                               "report",   "state",      "alarms",       "notes"};

struct Ground {
    test::RecordedRun recorded;
    archive::Reader reader = std::move(archive::Reader::open(recorded.file(), recorded.dictionary)).value();
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static Ground ground;
    if (size == 0) return 0;
    const auto* question = server::run_question(questions[data[0] % questions.size()]);
    if (question == nullptr) std::abort();
    const archive::RunId run{1U + data[0] / 128U};
    const auto query =
        server::QueryText::parse({reinterpret_cast<const char*>(data) + 1, size - 1}, question->parameters);
    if (!query) {
        if (query.error().message.empty()) std::abort();
        return 0;
    }
    const server::instruction::PlanLibrary plans{{}, ground.recorded.dictionary};
    const auto answer = question->answer({ground.recorded.dictionary, plans, std::nullopt}, ground.reader, run, *query);
    if (answer.status >= 500 || answer.body.empty()) std::abort();
    if (answer.content_type == "application/json" && answer.status == 200) {
        google::protobuf::Value parsed;
        if (!server::from_json(answer.body, parsed)) std::abort();
    }
    if (answer.status >= 400) {
        v1::ErrorReply reply;
        if (!server::from_json(answer.body, reply) || reply.error().empty()) std::abort();
    }
    return 0;
}
