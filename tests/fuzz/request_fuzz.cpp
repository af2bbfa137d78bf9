// SPDX-License-Identifier: Apache-2.0
// JSON as a client may send it: a CommandRequest to a landing's command path, a StartRehearsal up to its first cycles.
// The first octet chooses. It is refused in words, or it can be done.
#include "server/base/json.hpp"
#include "server/rehearsal/command_messages.hpp"
#include "server/rehearsal/rehearsal.hpp"
#include "server/scenario/scenario_library.hpp"
#include "server/scenario/scenario_text.hpp"
#include "server/scenario/script_check.hpp"

#include <cstdlib>
#include <spdlog/spdlog.h>

namespace {

using namespace aeolis;
using namespace aeolis::server;

constexpr int requests_a_landing = 200;  // then its queue is full, and another begins
constexpr int cycles_flown = 3;

void must(bool holds) {
    if (!holds) std::abort();
}

const dictionary::Dictionary& mission() {
    static const auto loaded = dictionary::load(AEOLIS_SOURCE_DIR "/dictionaries/msl");
    must(loaded.dictionary.has_value());
    return *loaded.dictionary;
}

const ScenarioLibrary& library() {
    static const ScenarioLibrary shipped{AEOLIS_SOURCE_DIR "/simulation/scenarios"};
    return shipped;
}

void command(std::string_view json) {
    static std::optional<ScriptedLanding> landing;
    static int requests = 0;
    v1::CommandRequest request;
    if (const auto parsed = from_json(json, request); !parsed) return must(!parsed.error().message.empty());
    if (requests++ % requests_a_landing == 0) landing.emplace(library().scenario("nominal").value(), 1, 0, mission());
    const auto asked = request_of(request, {});
    if (!asked) return must(!asked.error().message.empty());
    const auto reply = message_of(landing->submit(*asked));
    must(reply.request() == request.request() && reply.accepted() == reply.reason().empty());
    must(!reply.accepted() || request.dry_run() || !request.action().empty() || reply.command() != 0);
    (void)to_json(reply);
    (void)landing->step();
    (void)landing->take_stages();
}

void start(std::string_view json) {
    v1::StartRehearsal request;
    if (const auto parsed = from_json(json, request); !parsed) return must(!parsed.error().message.empty());
    auto scenario = request.has_inline_scenario() ? scenario_from_message(request.inline_scenario())
                                                  : library().scenario(request.scenario());
    if (!scenario) return must(!scenario.error().message.empty());
    if (const auto script = check_script(*scenario, mission()); !script) return must(!script.error().message.empty());
    Rehearsal rehearsal{*scenario, request.seed(), 0, mission()};
    for (int i = 0; i < cycles_flown; ++i) (void)rehearsal.step();
    (void)to_json(rehearsal.clocks());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    spdlog::set_level(spdlog::level::off);
    const std::string_view json{reinterpret_cast<const char*>(data) + 1, size - 1};
    data[0] % 2 == 0 ? command(json) : start(json);
    return 0;
}
