// SPDX-License-Identifier: Apache-2.0
#include "aeolis/v1/items.pb.h"
#include "aeolis/v1/lists.pb.h"
#include "aeolis/v1/run.pb.h"
#include "server/access/this_user.hpp"
#include "server/api/command_rates.hpp"
#include "server/archive/items.hpp"
#include "server/archive/shared_archive.hpp"
#include "server/base/json.hpp"
#include "server/cluster/run_snapshot.hpp"
#include "tests/server/archive/faulty_disk.hpp"
#include "tests/server/audited.hpp"
#include "tests/server/running_server.hpp"
#include "tests/server/web_client.hpp"

#include <algorithm>
#include <chrono>
#include <fmt/format.h>
#include <fstream>
#include <google/protobuf/descriptor.pb.h>
#include <thread>

namespace server_http_test {

using namespace aeolis;
using namespace aeolis::test;
using server::from_json;

namespace {

std::string field(const WebReply& reply, std::string_view name) {
    const auto found = std::ranges::find(reply.fields, name, &std::pair<std::string, std::string>::first);
    return found == reply.fields.end() ? "" : found->second;
}

struct Exchange {
    const char* method;
    const char* target;
    const char* body;
    unsigned status;
    const char* says;
};

}  // namespace

TEST_CASE("a run's rows are given to other servers in messages, behind what they hold", "[http][cluster][R61]") {
    RunningServer server{short_landing(), 0.0};
    REQUIRE(archive::SharedArchive::open(server.archive())->identity());
    const auto ask = [&](const std::string& what) {
        return web_request(server.port(), "GET", "/api/v1/runs/1" + what);
    };
    for (int i = 0; i < 6'000 && ask("").body.find("\"state\":\"finished\"") == std::string::npos; ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds{50});
    const auto messages_of = [&](const WebReply& reply) {
        CHECK(reply.status == 200);
        CHECK(reply.content_type == "application/octet-stream");
        server::cluster::FramedMessages framed;
        framed.add(reply.body);
        std::vector<v1::RunRows> messages;
        for (auto message = framed.next(); message && *message; message = framed.next())
            messages.push_back(std::move(**message));
        CHECK_FALSE(framed.within());
        return messages;
    };
    const auto all = messages_of(ask("/rows"));
    REQUIRE(all.size() > 2);
    CHECK(all.front().before().seq() == 0);
    for (std::size_t each = 1; each < all.size(); ++each)
        if (all[each].piece() == 0) CHECK(archive::equal(all[each].before(), all[each - 1].after()));
    const auto held = all[all.size() / 2].before();
    const auto rest = messages_of(ask(fmt::format("/rows?held=%7B%22seq%22:%22{}%22%7D", held.seq())));
    REQUIRE_FALSE(rest.empty());
    CHECK(rest.front().before().seq() == held.seq());
    CHECK(rest.back().after().seq() == all.back().after().seq());
    CHECK_THAT(ask("/rows?held=%7B%22seq%22:%22999999999%22%7D").body, Catch::Contains("not up to 999999999"));
}

TEST_CASE("every route answers what it can and refuses the rest by name", "[http][R43]") {
    RunningServer server{shipped_scenario("nominal"), 100.0};
    const auto port = server.port();
    for (int i = 0; i < 200; ++i) {  // the run is there as soon as it is in the archive
        if (web_request(port, "GET", "/api/v1/runs/1").status == 200) break;
        std::this_thread::sleep_for(std::chrono::milliseconds{20});
    }
    const Exchange table[] = {
        {"GET", "/healthz", "", 200, "ok"},
        {"GET", "/metrics", "", 200, "\naeolis_build_info{version=\""},
        {"GET", "/metrics", "", 200, "\naeolis_resident_memory_bytes "},
        {"GET", "/metrics", "", 200, "\naeolis_archive_commit_seconds_count "},
        {"GET", "/metrics", "", 200, "\naeolis_archive_pending_bytes "},
        {"GET", "/metrics", "", 200, "\naeolis_commands_waiting 0\n"},
        {"GET", "/metrics", "", 200, "\naeolis_commands_put_off 0\n"},
        {"GET", "/metrics", "", 200, "\naeolis_commands_queued 0\n"},
        {"GET", "/api/v1/openapi.yaml", "", 200, "openapi: 3"},
        {"GET", "/api/v1/runs", "", 200, "\"scenario\":\"nominal\""},
        {"GET", "/api/v1/runs/latest", "", 200, "\"state\":\"running\""},
        {"GET", "/api/v1/runs/1/channels?names=altitude_m", "", 200, "\"name\":\"altitude_m\""},
        {"GET", "/api/v1/runs/1/channels?names=altitude_m&format=csv", "", 200, "channel,unit,sclk_s,value,source"},
        {"GET", "/api/v1/runs/1/samples?names=altitude_m", "", 200, "sclk,e_s,channel,value,unit,source\n"},
        {"GET", "/api/v1/runs/1/samples?format=jsonl&to=1", "", 200, ""},
        {"GET", "/api/v1/runs/1/samples?names=speed_mps,altitude_m&align=speed_mps", "", 200,
         "sclk,e_s,speed_mps,altitude_m\n"},
        {"GET", "/api/v1/runs/1/samples?names=speed_mps&align=mach", "", 400, "align: 'mach'"},
        {"GET", "/api/v1/runs/1/samples?format=xlsx", "", 400, "neither csv nor jsonl"},
        {"GET", "/api/v1/runs/1/samples?names=altitud", "", 400, "altitud"},
        {"GET", "/api/v1/runs/1/samples?from=2&to=1", "", 400, "upside down"},
        {"GET", "/api/v1/runs/1/samples?limit=1", "", 400, "limit"},
        {"GET", "/api/v1/runs/9/samples", "", 404, "9"},
        {"GET", "/api/v1/runs/1/rows", "", 409, "nobody follows this archive"},
        {"GET", "/api/v1/runs/1/rows?held=much", "", 400, "held: "},
        {"GET", "/api/v1/runs/1/rows?after=1", "", 400, "after"},
        {"GET", "/api/v1/runs/9/rows", "", 404, "9"},
        {"GET", "/api/v1/runs/1/channels?names=altitude_m&format=protobuf", "", 200, "altitude_m"},
        {"GET", "/api/v1/runs/1/packets?apid=0x20&limit=5", "", 200, "\"packets\":["},
        {"GET", "/api/v1/runs/1/tones", "", 200, "\"tones\":["},
        {"GET", "/api/v1/runs/1/events?level=FATAL&text=x", "", 200, "\"events\":["},
        {"GET", "/api/v1/runs/1/commands", "", 200, "\"commands\":["},
        {"GET", "/api/v1/runs/1/timepoints", "", 200, "\"timepoints\":["},
        {"GET", "/api/v1/runs/1/explanations", "", 200, "\"explanations\":["},
        {"GET", "/api/v1/runs/1/prediction", "", 200, "\"state\":\"flying\""},
        {"GET", "/api/v1/runs/1/prediction?channels=altitud_m", "", 400, "the nearest name is 'altitude_m'"},
        {"GET", "/api/v1/runs?format=csv", "", 200, "run,scenario,title,"},
        {"GET", "/api/v1/runs?format=xml", "", 400, "format: 'xml' is none of json, csv, jsonl"},
        {"GET", "/api/v1/runs?colour=red", "", 400, "colour"},
        {"GET", "/api/v1/runs/1/events?format=csv&limit=1", "", 200, "seq,event.id,event.name,"},
        {"GET", "/api/v1/runs/1/events?format=jsonl&limit=1", "", 200, ""},
        {"GET", "/api/v1/runs/1/events?format=xml", "", 400, "format"},
        {"GET", "/api/v1/runs/1/tones?format=csv", "", 200, "seq,tone.ert_start,"},
        {"GET", "/api/v1/runs/1/commands?format=csv", "", 200, "command,name,arguments,octets,stages,"},
        {"GET", "/api/v1/runs/1/explanations?format=csv", "", 200, "seq,explanation.sclk,"},
        {"GET", "/api/v1/runs/1/packets?format=csv&limit=5", "", 200, "unit.unit,unit.apid,"},
        {"GET", "/api/v1/runs/1/timepoints?format=csv", "", 200, "\n1,catbed_heaters,"},
        {"GET", "/api/v1/runs/1/timepoints?at=2012-219T05:00:00&recorded=false", "", 200, "\"predicted_e_s\":-826"},
        {"GET", "/api/v1/runs/1/timepoints?recorded=maybe", "", 400, "recorded"},
        {"GET",
         "/api/v1/runs/1/timepoints?command=EDL_SET_TIMEPOINT_OFFSET"
         "&arguments=timepoint%3D3%2Cdesired_offset_s%3D-810%2Cminimum_offset_s%3D0",
         "", 200, "\"moved_e_s\":-810"},
        {"GET", "/api/v1/runs/1/timepoints?command=NO_OP", "", 200, "\"command_moves\":false"},
        {"GET", "/api/v1/runs/1/timepoints?command=FLY", "", 400, "command: there is no 'FLY'"},
        {"GET", "/api/v1/runs/1/timepoints?command=NO_OP&arguments=x=much", "", 400, "'x=much' is not name=number"},
        {"GET", "/api/v1/runs/1/timepoints?arguments=x=1", "", 400, "of which command?"},
        {"GET", "/api/v1/runs/1/preconditions?command=EDL_DO_EDL", "", 200, "parameters_received == 1: "},
        {"GET", "/api/v1/runs/1/preconditions", "", 400, "command: there is no ''"},
        {"GET", "/api/v1/runs/1/events?format=csv&limit=5", "", 200, ",event.sclk,event.scet,"},
        {"GET", "/api/v1/runs/1/interventions?format=csv", "", 200, "e_s,fault.device_fault.device,"},
        {"GET", "/api/v1/runs/1/events?format=xml", "", 400, "format: 'xml' is none of json, csv, jsonl"},
        {"GET", "/api/v1/runs/1/channels?names=altitude_m&format=jsonl", "", 400, "is none of json, csv, protobuf"},
        {"GET", "/api/v1/runs/1/report?format=jsonl", "", 400, "is none of json, csv"},
        {"GET", "/api/v1/runs?format=xml", "", 400, "is none of json, csv, jsonl"},
        {"GET", "/api/v1/runs/1/notes?format=csv", "", 200, "seq,note.text,"},
        {"GET", "/api/v1/runs/1/alarms?format=csv", "", 200, "seq,link.link,"},
        {"GET", "/api/v1/runs/1/alarms?state=current&format=jsonl", "", 200, ""},
        {"GET", "/api/v1/runs/1/events?from=2012-219T04:00:00&to=2012-219T06:00:00.5", "", 200, "\"events\":["},
        {"GET", "/api/v1/runs/1/state?at=2012-219T05:00:00", "", 200, "\"channels\":["},
        {"GET", "/api/v1/runs/1/samples?names=altitude_m&to=2012-219T05:00:00", "", 200, "sclk,e_s,"},
        {"GET", "/api/v1/runs/1/state?at=2012-400T05:00:00", "", 400, "at: '2012-400T05:00:00'"},
        {"GET", "/api/v1/runs/1/events?to=noon", "", 400,
         "to: 'noon' is no instant: seconds of SCLK, SCET as 2012-219T05:00:00"},
        {"GET", "/api/v1/runs/1/events?from=2012-219T05:00:01&to=2012-219T05:00:00", "", 400, "upside down"},
        {"GET", "/api/v1/runs/1/limits", "", 200, "\"name\":\"descent_rate_mps\",\"stretches\":[{"},
        {"GET", "/api/v1/runs/1/limits?recorded=maybe", "", 400, "recorded"},
        {"GET", "/api/v1/runs/1/touchdown", "", 200, "\"verdict\":\"untold\""},
        {"GET", "/api/v1/runs/1/touchdown?at=noon", "", 400, "at: 'noon' is no instant"},
        {"GET", "/api/v1/runs/1/score", "", 400, "run 1 has no score"},
        {"GET", "/api/v1/runs/1/recording", "", 200, "\"realtime_differs\":\"0\""},
        {"GET", "/api/v1/runs/1/staleness", "", 200, "{\"packets\":[]}"},
        {"GET", "/api/v1/runs/1/report", "", 200, "\"timepoints\":["},
        {"GET", "/api/v1/runs/1/state", "", 200, "\"channels\":["},
        {"GET", "/api/v1/scenarios", "", 200, "nominal_auto"},
        {"GET", "/api/v1/rehearsals", "", 200, "\"run\":\"1\""},
        {"GET", "/api/v1/rehearsals/current", "", 200, "\"run\":\"1\""},
        {"GET", "/api/v1/dictionary", "", 200, "EDL_DO_EDL"},
        {"PATCH", "/api/v1/rehearsals/current", R"({"pace": 50})", 202, "\"run\":\"1\""},

        {"GET", "/api/v1/runs/1/alarms", "", 200, "\"changes\":["},
        {"GET", "/api/v1/runs/1/alarms?state=current", "", 200, "\"alarms\":["},
        {"GET", "/api/v1/runs/1/alarms?state=past", "", 400, "state"},
        {"POST", "/api/v1/runs/1/alarms", R"({"channel":"speed_mps","action":"acknowledge","by":"Ada"})", 409,
         "speed_mps is normal"},
        {"POST", "/api/v1/runs/1/alarms", R"({"channel":"GNC-0007","action":"shelve","shelve_s":60,"by":"Ada"})", 201,
         "\"until\":\""},
        {"GET", "/api/v1/runs/1/alarms?state=current", "", 200, "\"state\":\"shelved\""},
        {"POST", "/api/v1/runs/1/alarms", R"({"channel":"moon","action":"shelve","shelve_s":60,"by":"Ada"})", 422,
         "moon"},
        {"POST", "/api/v1/runs/1/alarms", R"({"canal":"moon"})", 400, "canal"},
        {"POST", "/api/v1/runs/9/alarms", R"({"channel":"speed_mps","action":"shelve","shelve_s":60,"by":"Ada"})", 404,
         "9"},
        {"POST", "/api/v1/runs/latest/notes", R"({"text":"all <b>well</b>","by":"Ada","sclk":1.5})", 201,
         "\\u003cb\\u003ewell"},
        {"GET", "/api/v1/runs/1/notes?text=WELL", "", 200, "\"by\":\"Ada\""},
        {"POST", "/api/v1/runs/1/notes", R"({"text":"","by":"Ada"})", 422, "empty"},
        {"POST", "/api/v1/runs/1/notes", R"({"text":"x"})", 422, "by:"},
        {"GET", "/api/v1/procedures", "", 200, "\"procedure\":\"start\""},
        {"GET", "/api/v1/procedures?format=csv&limit=2", "", 200, "procedure,title,purpose,begin_when,revision,"},
        {"GET", "/api/v1/procedures/start", "", 200, "\"text\":\"# SPDX"},
        {"GET", "/api/v1/procedures/start?format=text", "", 200, "PRECONDITIONS"},
        {"GET", "/api/v1/procedures/start?format=pdf", "", 400, "format"},
        {"GET", "/api/v1/procedures/none", "", 404, "there are: commanding_closed, computer_reset"},
        {"GET", "/api/v1/runs/1/procedures", "", 200, "{\"procedures\":[]}"},
        {"GET", "/api/v1/runs/1/procedures/1/acts", "", 404, "run 1 has no procedure of the number '1'"},
        {"POST", "/api/v1/runs/1/procedures", R"({"procedure":"none","position":"gnc","by":"Ada"})", 422,
         "there is none of this id"},
        {"POST", "/api/v1/runs/1/procedures", R"({"procedure":"day_after","position":"captain","by":"Ada"})", 422,
         "positions are flight_director, command"},
        {"POST", "/api/v1/runs/1/procedures", R"({"procedure":"day_after","position":"gnc"})", 422, "by:"},
        {"POST", "/api/v1/runs/9/procedures", R"({"procedure":"day_after","position":"gnc","by":"Ada"})", 404, "9"},
        {"POST", "/api/v1/runs/1/procedures", R"({"procedure":"day_after","position":"gnc","by":"Ada"})", 201,
         "\"begun_by\":\"Ada (gnc)\""},
        {"POST", "/api/v1/runs/latest/procedures/1/acts",
         R"({"kind":"hold","position":"gnc","by":"Ada","reason":"not yet"})", 201, "\"held\":\"Ada (gnc): not yet\""},
        {"POST", "/api/v1/runs/1/procedures/1/acts",
         R"({"kind":"hold","position":"gnc","by":"Ada","reason":"not yet"})", 409, "is held already"},
        {"POST", "/api/v1/runs/1/procedures/1/acts", R"({"kind":"begin","position":"gnc","by":"Ada"})", 422,
         "kind: 'begin' is none of tick"},
        {"POST", "/api/v1/runs/1/procedures/1/acts", R"({"kind":"sent","position":"command","by":"Ada"})", 422,
         "command:"},
        {"POST", "/api/v1/runs/1/procedures/1/acts", R"({"kind":"choose","step":"poll","position":"gnc","by":"Ada"})",
         422, "choice: which way is taken?"},
        {"POST", "/api/v1/runs/1/procedures/7/acts", R"({"kind":"tick","position":"gnc","by":"Ada"})", 404,
         "run 1 has no procedure of the number '7'"},
        {"POST", "/api/v1/runs/1/procedures/one/acts", R"({"kind":"tick","position":"gnc","by":"Ada"})", 404, "'one'"},
        {"POST", "/api/v1/runs/1/procedures/1/acts", R"({"kind":"tick","colour":"red"})", 400, "colour"},
        {"GET", "/api/v1/runs/1/procedures", "", 200, "\"procedure\":\"day_after\""},
        {"GET", "/api/v1/runs/1/positions", "", 200, "\"acts\":[]}"},
        {"POST", "/api/v1/runs/1/positions", R"({"kind":"sit","position":"gnc","by":"Ada"})", 422,
         "kind: 'sit' is none of take, offer"},
        {"POST", "/api/v1/runs/1/positions", R"({"kind":"take","position":"captain","by":"Ada"})", 422,
         "positions are flight_director, command"},
        {"POST", "/api/v1/runs/1/positions", R"({"kind":"take","position":"gnc"})", 422, "by:"},
        {"POST", "/api/v1/runs/1/positions", R"({"kind":"take","position":"gnc","by":"Ada","to":"Bob"})", 422,
         "to: is not for this kind of act"},
        {"POST", "/api/v1/runs/1/positions", R"({"kind":"offer","position":"gnc","by":"Ada","to":" "})", 422,
         "to: to whom is it offered?"},
        {"POST", "/api/v1/runs/1/positions", R"({"kind":"poll","position":"flight_director","by":"Ada"})", 422,
         "subject: what is the room asked about?"},
        {"POST", "/api/v1/runs/1/positions", R"({"kind":"take","position":"gnc","colour":"red"})", 400, "colour"},
        {"POST", "/api/v1/runs/9/positions", R"({"kind":"take","position":"gnc","by":"Ada"})", 404, "9"},
        {"POST", "/api/v1/runs/1/positions", R"({"kind":"take","position":"systems","by":"Ada"})", 201,
         "\"by\":\"Ada\""},
        {"POST", "/api/v1/runs/1/positions", R"({"kind":"take","position":"systems","by":"Bob"})", 409,
         "systems is held by Ada"},
        {"POST", "/api/v1/runs/1/procedures/1/acts", R"({"kind":"release","position":"systems","by":"Bob"})", 409,
         "systems is held by Ada, not by Bob"},
        {"GET", "/api/v1/runs/1/positions?at=2012-219T04:00:00", "", 200, "\"acts\":[]}"},
        {"GET", "/api/v1/runs/1/positions?at=noon", "", 400, "at: 'noon' is no instant"},
        {"GET", "/api/v1/runs/1/positions", "", 200, "\"kind\":\"take\""},
        {"GET", "/api/v1/runs/1/state", "", 200, "\"position_act\":{\"seq\":"},
        {"GET", "/api/v1/runs/1/procedures?at=2012-219T04:00:00", "", 200, "{\"procedures\":[]}"},
        {"GET", "/api/v1/runs/1/procedures?at=noon", "", 400, "at: 'noon' is no instant"},
        {"GET", "/api/v1/runs/1/procedures/1/acts", "", 200, "\"kind\":\"begin\""},
        {"GET", "/api/v1/runs/1/state", "", 200, "\"procedures\":[{\"seq\":"},
        {"GET", "/api/v1/runs/1/commands?text=NO_OP", "", 200, "\"commands\":["},
        {"GET", "/api/v1/runs/1/explanations?text=nothing%22", "", 200, "\"explanations\":["},
        {"GET", "/api/v1/runs/1/channels?expression=speed_mps*2%2B%7BGNC-0007%7D&points=20", "", 200,
         "\"name\":\"speed_mps*2"},
        {"GET", "/api/v1/runs/1/channels?expression=speed_mps*(2", "", 400, "character"},
        {"GET", "/api/v1/runs/1/channels?expression=speed_mps&names=speed_mps", "", 400, "not both"},

        {"GET", "/api/v1/nothing", "", 404, "no such route"},
        {"GET", "/api/v1/runs/99", "", 404, "99"},
        {"GET", "/api/v1/runs/0/events", "", 404, "run '0'"},
        {"GET", "/api/v1/runs/99999999999/events", "", 404, "99999999999"},
        {"GET", "/api/v1/runs/1/feelings", "", 404, "feelings"},
        {"GET", "/api/v1/runs/1/channels", "", 400, "names"},
        {"GET", "/api/v1/runs/1/channels?names=moon_phase", "", 400, "moon_phase"},
        {"GET", "/api/v1/runs/1/channels?names=altitude_m&from=5&to=3", "", 400, "upside down"},
        {"GET", "/api/v1/runs/1/channels?names=altitude_m&from=five", "", 400, "five"},
        {"GET", "/api/v1/runs/1/channels?names=altitude_m&points=0", "", 400, "points"},
        {"GET", "/api/v1/runs/1/channels?names=altitude_m&format=xml", "", 400, "xml"},
        {"GET", "/api/v1/runs/1/channels?names=altitude_m&colour=red", "", 400, "colour"},
        {"GET", "/api/v1/runs/1/channels?names=altitude_m&source=rumour", "", 400, "rumour"},
        {"GET", "/api/v1/runs/1/channels?expression=speed_mps&source=realtime", "", 400, "named channels only"},
        {"GET", "/api/v1/runs/1/channels?names=altitude_m&source=recorded", "", 200, "altitude_m"},
        {"GET", "/api/v1/runs/1/events?level=PANIC", "", 400, "PANIC"},
        {"GET", "/api/v1/runs/1/events?limit=1000000", "", 400, "limit"},
        {"GET", "/api/v1/runs/1/explanations?decision=zz", "", 400, "zz"},
        {"GET", "/api/v1/runs/1/packets?apid=0x30", "", 400, "share"},
        {"GET", "/api/v1/runs/1/packets?apid=9999999", "", 400, "apid"},
        {"DELETE", "/api/v1/runs/1/events", "", 405, "DELETE"},
        {"POST", "/api/v1/runs", "{}", 405, "POST"},
        {"GET", "/api/v1/stream", "", 426, "WebSocket"},
        {"POST", "/api/v1/rehearsals", "{", 400, "StartRehearsal"},
        {"POST", "/api/v1/rehearsals", R"({"senario":"nominal"})", 400, "senario"},
        {"POST", "/api/v1/rehearsals", R"({"scenario":"nominal","pace":1})", 409, "goes on"},
        {"POST", "/api/v1/rehearsals/current", R"({"pace":100000})", 422, "pace"},
        {"POST", "/api/v1/rehearsals/current", "{}", 422, "says nothing"},
        {"POST", "/api/v1/runs/1/commands", R"({"command":"NO_SUCH"})", 422, "NO_SUCH"},
        {"POST", "/api/v1/runs/1/commands", R"({"command":5})", 400, "CommandRequest"},
        {"POST", "/api/v1/runs/1/commands", R"({"command":"NO_OP","run":"2"})", 400, "the path says 1"},
        {"POST", "/api/v1/runs/2/commands", R"({"command":"NO_OP"})", 409, "not the one that goes on"},
        {"POST", "/api/v1/runs/latest/commands", R"({"command":"NO_OP"})", 202, "\"accepted\":true"},
    };
    for (const auto& asked : table) {
        auto reply = web_request(port, asked.method, asked.target, asked.body);
        // A rehearsal at full pace fills the queue of a busy machine: the answer says to try again, and so it is done.
        for (int again = 0; again < 100 && reply.status == 503 && reply.body.find("try again") != std::string::npos;
             ++again) {
            std::this_thread::sleep_for(std::chrono::milliseconds{100});
            reply = web_request(port, asked.method, asked.target, asked.body);
        }
        INFO(asked.method << ' ' << asked.target << ' ' << asked.body << " -> " << reply.body.substr(0, 300));
        CHECK(reply.status == asked.status);
        CHECK_THAT(reply.body, Catch::Contains(asked.says));
        const bool is_command =
            std::string_view{asked.target}.ends_with("/commands") && (reply.status == 409 || reply.status == 422);
        if (reply.status >= 400)  // a command that was refused is answered by its own message
            CHECK_THAT(reply.body, Catch::StartsWith(is_command ? "{\"request\":" : "{\"error\":"));
    }
}

TEST_CASE(
    "a value that makes no sense is 422 and named with what is allowed, whatever goes on; what is not possible now "
    "is 409",
    "[http][bounds][R62]") {
    constexpr const char *commands = "/api/v1/runs/latest/commands", *files = "/api/v1/runs/latest/sequences",
                         *notes = "/api/v1/runs/latest/notes", *alarms = "/api/v1/runs/latest/alarms",
                         *rehearsals = "/api/v1/rehearsals", *current = "/api/v1/rehearsals/current",
                         *campaigns = "/api/v1/campaigns", *forecasts = "/api/v1/runs/latest/forecasts";
    const Exchange table[] = {
        {"POST", commands, R"({"command":"NO_OP","release_at":"NaN"})", 422, "release_at: 'NaN' is no instant: "},
        {"POST", commands, R"({"command":"NO_OP","release_at":"Infinity"})", 422, "release_at: 'Infinity' is no "},
        {"POST", commands, R"({"command":"NO_OP","release_at":"1e300"})", 422, "release_at: '1e300' is no instant: "},
        {"POST", commands, R"({"command":"NO_OP","release_at":"soon"})", 422, "release_at: 'soon' is no instant: "},
        {"POST", commands, R"({"command":"NO_OP","service":"CD"})", 422, "unknown service 'CD': AD, BD"},
        {"POST", commands, R"({"command":"NO_OP","client_id":"a b"})", 422, "client_id: 1 to 64 of A-Z"},
        {"POST", commands, R"({"command":"NO_OP","priority":-1})", 422,
         "priority: -1 is not a whole number from 0 to 4294967295"},
        {"POST", commands, R"({"command":"NO_OP","priority":0.5})", 422, "priority: 0.5 is not a whole number"},
        {"POST", commands, R"({"command":"NO_OP","hold":"perhaps"})", 422,
         "hold: \\\"perhaps\\\" is not true or false"},
        {"POST", commands, R"({"command":"NO_OP","arguments":[{"name":"x","value":"NaN"}]})", 422,
         "arguments[0].value: nan is not a finite number"},
        {"POST", commands, R"({"command":"NO_OP","arguments":[{"name":"x","value":1}]})", 422,
         "NO_OP has no argument 'x'"},
        {"POST", commands, R"({"command":"EDL_SET_PARAMETERS"})", 422, "is missing"},
        {"POST", commands, R"({"command":"NO_SUCH"})", 422, "unknown command 'NO_SUCH'"},
        {"POST", commands, R"({"action":"launch","number":1})", 422, "unknown action 'launch': release, hold, cancel"},
        {"POST", commands, R"({"action":"cancel"})", 422, "number: "},
        {"POST", commands, R"({"action":"cancel","number":-1})", 422, "number: -1 is not a whole number from 0"},
        {"POST", commands, R"({"action":"cancel","number":99})", 409, "99"},
        {"POST", commands, R"({"command":"EDL_DO_EDL"})", 409, "must be armed first"},
        {"POST", commands, R"({"command":"NO_OP","release_at":"2000-001T12:00:00"})", 409, "is past"},
        {"POST", files, R"({"commands":[{"command":"NO_OP"},{"command":"NO_OP","service":"CD"}]})", 422,
         "commands[1]: unknown service 'CD'"},
        {"POST", files, R"({"commands":[{"command":"NO_OP","priority":-1}]})", 422, "commands[0].priority: -1 is not"},
        {"POST", files, R"({"commands":[{"command":"NO_OP","client_id":"a"},{"command":"NO_OP","client_id":"a"}]})",
         422, "client_id: 'a' is given to two commands"},
        {"POST", files, R"({"commands":[{"command":"EDL_DO_EDL"},{"command":"NO_OP","release_at":"NaN"}]})", 422,
         "commands[1]: release_at: 'NaN' is no instant"},
        {"POST", files, R"({"commands":[{"command":"NO_OP"},{"command":"EDL_DO_EDL"}]})", 409,
         "commands[1]: EDL_DO_EDL is hazardous"},
        {"POST", notes, R"({"text":"x","by":"Ada","sclk":"NaN"})", 422, "sclk: nan is not a finite number"},
        {"POST", alarms, R"({"channel":"speed_mps","action":"admire","by":"Ada"})", 422, "action: 'admire' is none of"},
        {"POST", alarms, R"({"channel":"speed_mps","action":"shelve","shelve_s":"Infinity","by":"Ada"})", 422,
         "shelve_s: inf is not a finite number"},
        {"POST", alarms, R"({"channel":"speed_mps","action":"shelve","shelve_s":-1,"by":"Ada"})", 422, "shelve_s: -1"},
        {"POST", rehearsals, R"({"scenario":"nominal","pace":"NaN"})", 422, "pace: nan is not a finite number"},
        {"POST", rehearsals, R"({"scenario":"nominal","pace":-2})", 422, "pace: -2 is neither 0"},
        {"POST", rehearsals, R"({"scenario":"nominal","seed":-1})", 422, "seed: -1 is not a whole number from 0"},
        {"POST", rehearsals, R"({"scenario":"moon","pace":1})", 422, "moon"},
        {"POST", rehearsals, R"({"fork":{"run":1,"at":"NaN"}})", 422, "fork.at: 'NaN' is no instant"},
        {"POST", rehearsals, R"({"scenario":"nominal","pace":1})", 409, "goes on"},
        {"POST", current, R"({"pace":"Infinity"})", 422, "pace: inf is not a finite number"},
        {"POST", current, R"({"pace":-3})", 422, "pace: -3 is neither 0"},
        {"POST", current, R"({"pause":"perhaps"})", 422, "pause: \\\"perhaps\\\" is not true or false"},
        {"POST", campaigns, R"({"scenario":"campaign","cases":-3})", 422, "cases: -3 is not a whole number"},
        {"POST", campaigns, R"({"scenario":"campaign","cases":1.5})", 422, "cases: 1.5 is not a whole number"},
        {"POST", forecasts, R"({"from":"nix"})", 422, "from: \\\"nix\\\" is not one of "},
        {"POST", forecasts, R"({"at":"NaN"})", 422, "'NaN' is no instant"},
    };
    RunningServer server{shipped_scenario("nominal"), 1.0};
    const auto post = [&](std::string_view target, std::string_view body) {
        return web_request(server.port(), "POST", target, body);
    };
    unsigned listens = 0;
    for (int i = 0; i < 3000 && listens != 202; ++i) {
        listens = post(commands, R"({"command":"NO_OP","dry_run":true})").status;
        if (listens != 202) std::this_thread::sleep_for(std::chrono::milliseconds{20});
    }
    for (const auto& row : table) {
        const auto reply = post(row.target, row.body);
        INFO(row.target << ' ' << row.body << " -> " << reply.body);
        CHECK(reply.status == row.status);
        CHECK_THAT(reply.body, Catch::Contains(std::string{R"("detail":")"}) && Catch::Contains(row.says));
        CHECK(reply.content_type == "application/problem+json");
    }
    CHECK_THAT(web_request(server.port(), "GET", "/api/v1/runs/latest/commands").body,
               Catch::StartsWith(R"({"commands":[])"));

    RunningServer idle;
    const Exchange without_run[] = {
        {"POST", commands, R"({"command":"NO_OP","release_at":"NaN"})", 422, "release_at: 'NaN' is no instant: "},
        {"POST", commands, R"({"command":"NO_OP"})", 409, "no run goes on"},
        {"POST", files, R"({"commands":[{"command":"NO_OP","service":"CD"}]})", 422, "commands[0]: unknown service"},
        {"POST", files, R"({"commands":[{"command":"NO_OP"}]})", 409, "no run goes on"},
        {"POST", current, R"({"pace":-3})", 422, "pace: -3 is neither 0"},
        {"POST", current, R"({"stop":false})", 422, "false asks for nothing"},
        {"POST", current, "{}", 422, "says nothing"},
        {"POST", current, R"({"pace":3})", 409, "no rehearsal goes on"},
    };
    for (const auto& row : without_run) {
        const auto reply = web_request(idle.port(), "POST", row.target, row.body);
        INFO(row.target << ' ' << row.body << " -> " << reply.body);
        CHECK(reply.status == row.status);
        CHECK_THAT(reply.body, Catch::Contains(row.says));
    }
}

TEST_CASE("bodies that are no command count as commands, too, until a client must wait", "[http][bounds][R63]") {
    RunningServer idle;
    unsigned status = 400;
    for (int i = 0; i < 2 * static_cast<int>(server::CommandRates::at_once) && status == 400; ++i)
        status = web_request(idle.port(), "POST",
                             i % 2 == 0 ? "/api/v1/runs/latest/commands" : "/api/v1/runs/latest/sequences", "no JSON")
                     .status;
    CHECK(status == 429);
}

TEST_CASE("a refused command, or command file, is a problem that has the members of its reply", "[http][R62]") {
    RunningServer server{shipped_scenario("nominal"), 1.0};
    const auto post = [&](const char* route, std::string_view body) {
        return web_request(server.port(), "POST", fmt::format("/api/v1/runs/latest/{}", route), body);
    };
    WebReply taken;
    for (int i = 0; i < 3000 && taken.status != 202; ++i) {
        taken = post("commands", R"({"command":"NO_OP"})");
        if (taken.status != 202) std::this_thread::sleep_for(std::chrono::milliseconds{20});
    }
    CHECK(taken.content_type == "application/json");
    v1::CommandReply accepted;
    REQUIRE(from_json(taken.body, accepted));
    CHECK_FALSE(accepted.has_detail());
    CHECK_FALSE(accepted.has_status());

    const auto check_problem = [](const WebReply& answer, const auto& reply, unsigned status, const char* title) {
        INFO(answer.body);
        CHECK(answer.status == status);
        CHECK(answer.content_type == "application/problem+json");
        CHECK_FALSE(reply.accepted());
        CHECK_FALSE(reply.reason().empty());
        CHECK(reply.type() == "about:blank");
        CHECK(reply.title() == title);
        CHECK(reply.status() == status);
        CHECK(reply.detail() == reply.reason());
        CHECK(reply.error() == reply.reason());
    };
    const auto hazardous = post("commands", R"({"command":"EDL_DO_EDL","request":"41"})");
    v1::CommandReply refused;
    REQUIRE(from_json(hazardous.body, refused));
    check_problem(hazardous, refused, 409, "Conflict");
    CHECK(refused.request() == 41);
    CHECK_THAT(refused.reason(), Catch::StartsWith("EDL_DO_EDL is hazardous"));
    CHECK_FALSE(refused.octets().empty());  // as far as the checks came
    CHECK(refused.preconditions_size() > 0);

    const auto unknown = post("commands", R"({"command":"NO_OP","service":"CD","request":"42","dry_run":true})");
    REQUIRE(from_json(unknown.body, refused));
    check_problem(unknown, refused, 422, "Unprocessable Content");
    CHECK(refused.request() == 42);
    CHECK(refused.dry_run());

    v1::SequenceReply file;
    const auto spoilt = post("sequences", R"({"commands":[{"command":"NO_OP"},{"command":"EDL_DO_EDL"}]})");
    REQUIRE(from_json(spoilt.body, file));
    check_problem(spoilt, file, 409, "Conflict");
    REQUIRE(file.commands_size() == 2);
    CHECK(file.commands(0).accepted());
    CHECK_FALSE(file.commands(1).has_detail());  // the file is the problem
    const auto malformed =
        post("sequences", R"({"commands":[{"command":"NO_OP"},{"command":"NO_OP","release_at":"NaN"}]})");
    REQUIRE(from_json(malformed.body, file));
    check_problem(malformed, file, 422, "Unprocessable Content");
    REQUIRE(file.commands_size() == 2);
    CHECK_FALSE(file.commands(0).octets().empty());
    CHECK_THAT(file.commands(1).reason(), Catch::StartsWith("release_at: 'NaN'"));
    const auto senseless = post("sequences", R"({"commands":[{"command":"NO_OP","priority":-1}]})");
    REQUIRE(from_json(senseless.body, file));
    check_problem(senseless, file, 422, "Unprocessable Content");
}

TEST_CASE("samples in Protobuf are those in JSON, bit for bit, in less than half the octets", "[http][R43]") {
    RunningServer server{shipped_scenario("nominal_auto"), 100.0};
    const auto ask = [&](const std::string& more) {
        return web_request(server.port(), "GET", "/api/v1/runs/1/channels?names=altitude_m,speed_mps" + more);
    };
    WebReply json, octets;
    for (int i = 0; i < 3000 && json.body.size() < 20'000; ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds{20});
        json = ask("");
    }
    CHECK(web_request(server.port(), "POST", "/api/v1/rehearsals/current", R"({"pause":true})").status == 202);
    v1::ChannelSeriesList list;
    for (int i = 0; i < 50; ++i) {  // until what was on its way has come
        octets = ask("&format=protobuf");
        json = ask("");
        if (ask("&format=protobuf").body == octets.body) break;
    }
    CHECK(octets.content_type == "application/x-protobuf");
    REQUIRE(from_json(json.body, list).ok());
    CHECK(list.channels(0).sclk_size() > 100);
    CHECK(list.SerializeAsString() == octets.body);
    CHECK(2 * octets.body.size() < json.body.size());
}

TEST_CASE("an event is found by its SCET, its ERT or its time from entry, and a page says in a header where the next "
          "begins",
          "[http][R43][R62]") {
    RunningServer server{shipped_scenario("nominal_auto"), 100.0};
    const auto ask = [&](const std::string& question) {
        return web_request(server.port(), "GET", "/api/v1/runs/1" + question);
    };
    v1::EventList events;
    for (int i = 0; i < 3000 && events.events_size() < 2; ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds{20});
        (void)from_json(ask("/events").body, events);
    }
    REQUIRE(events.events_size() >= 2);
    v1::RunState run;
    REQUIRE(from_json(ask("").body, run).ok());
    const auto& first = events.events(0);
    const auto scet = day_of_year_text(archive::correlation_of(run).scet_of(Sclk{first.event().sclk()}));
    v1::EventList found;
    REQUIRE(from_json(ask("/events?from=" + scet + "&to=" + scet).body, found).ok());
    REQUIRE(found.events_size() > 0);
    CHECK(found.events(0).SerializeAsString() == first.SerializeAsString());
    const auto from_entry = fmt::format("E{:+.6f}", first.event().sclk() - run.entry_sclk());
    const auto sent = Scet{archive::correlation_of(run).scet_of(Sclk{first.event().sclk()}).microseconds +
                           static_cast<std::int64_t>(run.light_time_s() * 1e6)};
    for (const auto& instant :
         {scet + "Z", scet + "%2B00:00", scet + "+00:00", "scet:" + scet, "ert:" + day_of_year_text(sent),
          "ert:" + day_of_year_text(sent) + "-00:00", from_entry}) {
        INFO(instant);
        REQUIRE(from_json(ask("/events?from=" + instant + "&to=" + instant).body, found).ok());
        REQUIRE(found.events_size() > 0);
        CHECK(found.events(0).seq() == first.seq());
    }

    for (const char* format : {"json", "csv", "jsonl"})
        CHECK(ask(std::string{"/events?limit=1&format="} + format).next_after == std::to_string(first.seq()));
    CHECK(ask("/timepoints?format=csv").next_after.empty());  // it has no pages
}

TEST_CASE("a rehearsal that cannot be is refused with what is wrong, and the next one begins", "[http][R45]") {
    RunningServer server;
    const auto post = [&](std::string_view body) {
        return web_request(server.port(), "POST", "/api/v1/rehearsals", std::string{body});
    };
    const auto unknown = post(R"({"scenario":"../etc/passwd","pace":1})");
    CHECK(unknown.status == 422);
    CHECK_THAT(unknown.body, Catch::Contains("there is none of this name"));
    const auto slow = post(R"({"scenario":"nominal","pace":0.5})");
    CHECK(slow.status == 422);
    CHECK_THAT(slow.body, Catch::Contains("pace"));
    CHECK(web_request(server.port(), "POST", "/api/v1/rehearsals/current", R"({"pause":true})").status == 409);
    CHECK(post(R"({"scenario":"nominal","pace":1})").status == 201);
}

TEST_CASE("what was acknowledged is durable: the command is in the archive when the reply comes", "[http][R43]") {
    RunningServer server{shipped_scenario("nominal"), 100.0};
    WebReply reply;
    for (int i = 0; i < 3000 && reply.status != 202; ++i) {
        reply = web_request(server.port(), "POST", "/api/v1/runs/latest/commands", R"({"command":"NO_OP"})");
        if (reply.status != 202) std::this_thread::sleep_for(std::chrono::milliseconds{20});
    }
    REQUIRE(reply.status == 202);
    auto reader = archive::Reader::open(server.archive(), tests::shipped_dictionary());
    REQUIRE(reader);
    const auto commands = reader->commands(archive::RunId{1});
    REQUIRE(commands);
    REQUIRE(commands->commands_size() == 1);
    CHECK(commands->commands(0).stages_size() >= 4);
}

namespace {

/// What the instructor did, once it is so much.
v1::InterventionList interventions_of(const RunningServer& server, int count) {
    v1::InterventionList told;
    for (int i = 0; i < 3000 && told.interventions_size() < count;
         ++i, std::this_thread::sleep_for(std::chrono::milliseconds{20})) {
        told.Clear();
        REQUIRE(from_json(web_request(server.port(), "GET", "/api/v1/runs/latest/interventions").body, told));
    }
    return told;
}

}  // namespace

TEST_CASE("an instructor breaks something in the rehearsal that goes on, and is told what cannot be",
          "[http][faults]") {
    RunningServer server;
    const auto control = [&](const std::string& inject) {
        return web_request(server.port(), "POST", "/api/v1/rehearsals/current",
                           fmt::format(R"({{"inject":{}}})", inject));
    };
    const char* const radar =
        R"({"device_fault":{"device":"DEVICE_RADAR","unit":"REDUNDANT_UNIT_A","kind":"DEVICE_FAULT_KIND_SILENT","duration_s":20}})";
    CHECK(control(radar).status == 409);  // none goes on
    REQUIRE(web_request(server.port(), "POST", "/api/v1/rehearsals", R"({"scenario":"nominal","pace":1})").status ==
            201);
    CHECK(control(radar).status == 202);
    CHECK(control(R"({"system_fault":{"duration_s":3}})").status == 202);
    CHECK(control(R"({"computer_reset":true})").status == 202);
    CHECK(web_request(server.port(), "POST", "/api/v1/rehearsals/current", R"({"run":1,"pace":2})").status == 202);
    const auto of_another =
        web_request(server.port(), "POST", "/api/v1/rehearsals/current", R"({"run":2,"stop":true})");
    CHECK(of_another.status == 422);
    CHECK_THAT(of_another.body, Catch::Contains("run 2 is not the one that goes on (1)"));
    const Exchange refused[] = {
        {"", "", R"({})", 422, "orbiter_outage, uhf_loss, wind_shift, air_shift, sensor_error or false_tone is wanted"},
        {"", "", R"({"computer_reset":false})", 422, "false asks for nothing"},
        {"", "", R"({"air_shift":{"duration_s":3,"fraction":7}})", 422, "air_shifts[0].fraction: 7"},
        {"", "", R"({"system_fault":{"duration_s":0}})", 422, "duration_s: 0"},
        {"", "", R"({"station_outage":{"duration_s":0}})", 422, "station_outages[0].duration_s: 0"},
        {"", "", R"({"station_outage":{"duration_s":3,"begin_before_entry_s":5}})", 422, "it begins now"},
        {"", "", R"({"system_fault":{"duration_s":3,"begin_before_entry_s":5}})", 422, "it begins now"},
        {"", "", R"({"device_fault":{"unit":"REDUNDANT_UNIT_A","kind":"DEVICE_FAULT_KIND_SILENT","duration_s":1}})",
         422, "device_fault.device: missing"},
        {"", "",
         R"({"device_fault":{"device":"DEVICE_IMU","unit":"REDUNDANT_UNIT_A","kind":"DEVICE_FAULT_KIND_REFUSES","duration_s":1}})",
         422, "not possible"},
        {"", "", R"({"device_fault":{"device":"DEVICE_IMU","unit":"C"}})", 422,
         "inject.device_fault.unit: \\\"C\\\" is not one of "},
    };
    for (const auto& row : refused) {
        const auto reply = control(row.body);
        INFO(row.body << " -> " << reply.body);
        CHECK(reply.status == row.status);
        CHECK_THAT(reply.body, Catch::Contains(row.says));
    }
    const auto told = interventions_of(server, 3);
    REQUIRE(told.interventions_size() == 3);
    CHECK(told.interventions(0).fault().device_fault().duration_s() == 20.0);
    CHECK(told.interventions(2).fault().computer_reset());
    v1::RunState state;
    REQUIRE(from_json(web_request(server.port(), "GET", "/api/v1/rehearsals/current").body, state));
    const double start_e_s = state.start_sclk() - state.entry_sclk();
    CHECK(told.interventions(0).e_s() >= start_e_s);
    CHECK(told.interventions(2).e_s() >= told.interventions(0).e_s());
    CHECK(told.interventions(2).e_s() < start_e_s + 60.0);
}

TEST_CASE("an instructor's note is kept with its instant, apart from the shift log and the stream, and what is none is "
          "refused",
          "[http][notes]") {
    RunningServer server;
    const auto note = [&](const std::string& body) {
        return web_request(server.port(), "POST", "/api/v1/rehearsals/current", fmt::format(R"({{"note":{}}})", body));
    };
    CHECK(note(R"({"text":"too early","by":"Ida"})").status == 409);  // none goes on
    REQUIRE(web_request(server.port(), "POST", "/api/v1/rehearsals", R"({"scenario":"nominal","pace":1})").status ==
            201);
    for (const auto& [body, says] :
         {std::pair{R"({"text":"x"})", "by:"}, std::pair{R"({"text":" ","by":"Ida"})", "the note is empty"}}) {
        const auto reply = note(body);
        INFO(body << " -> " << reply.body);
        CHECK(reply.status == 422);
        CHECK_THAT(reply.body, Catch::Contains(says));
    }
    REQUIRE(web_request(server.port(), "POST", "/api/v1/rehearsals/current", R"({"pause":true})").status == 202);
    CHECK(note(R"({"text":"nobody looks at <the> \"radar\"","by":"Ida"})").status == 202);
    const auto told = interventions_of(server, 1);
    REQUIRE(told.interventions_size() == 1);
    CHECK(told.interventions(0).note().text() == "nobody looks at <the> \"radar\"");
    CHECK(told.interventions(0).note().by() == "Ida");
    v1::NoteList log;
    REQUIRE(from_json(web_request(server.port(), "GET", "/api/v1/runs/latest/notes").body, log));
    CHECK(log.notes_size() == 0);
}

TEST_CASE("a rehearsal that the program was started with is in the audit, with the system's name of who started it",
          "[audit][http]") {
    RunningServer server{shipped_scenario("nominal"), 100.0};
    auto reader = archive::Reader::open(server.archive(), tests::shipped_dictionary());
    REQUIRE(reader);
    const auto entry = only_audited(*reader);
    CHECK(entry.who == server::this_user());
    CHECK(entry.from == "command line");
    CHECK(entry.action == "rehearsal");
    CHECK_THAT(entry.detail, Catch::StartsWith("serve --scenario nominal --seed 1"));
    CHECK(entry.outcome == "done");
}

TEST_CASE("what is answered as done is in the audit by then; while the disk refuses the answer comes all the same",
          "[audit][http][disk]") {
    FaultyDisk disk;
    RunningServer server;
    auto reader = archive::Reader::open(server.archive(), tests::shipped_dictionary());
    REQUIRE(reader);
    const auto pace = [&](int wanted) {
        return web_request(server.port(), "POST", "/api/v1/rehearsals/current", fmt::format(R"({{"pace":{}}})", wanted))
            .status;
    };
    REQUIRE(web_request(server.port(), "POST", "/api/v1/rehearsals", R"({"scenario":"nominal","pace":1})").status ==
            201);
    for (int wanted = 2; wanted < 12; ++wanted) {
        REQUIRE(pace(wanted) == 202);
        const auto entries = reader->audit(0, 100);
        REQUIRE(entries);
        REQUIRE(entries->size() == static_cast<std::size_t>(wanted));
        CHECK_THAT(entries->back().detail, Catch::Contains(fmt::format(R"({{"pace":{}}})", wanted)));
    }
    disk.fail_at(1, FaultyDisk::Fault::input_output, true);
    for (int i = 0; i < 3; ++i) CHECK(pace(20 + i) == 202);
    disk.mend();
    for (int i = 0; i < 3000 && reader->audit(0, 100).value().size() < 14; ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds{20});
    CHECK(reader->audit(0, 100)->size() == 14);
}

TEST_CASE("what is said while the disk refuses is answered at once, as taken and not yet stored, and is in the archive "
          "once the disk is well",
          "[http][disk]") {
    FaultyDisk disk;
    RunningServer server;
    const auto post = [&](const char* route, const std::string& body) {
        return web_request(server.port(), "POST", fmt::format("/api/v1/runs/latest/{}", route), body);
    };
    const auto stored = [&](const char* question, const char* words) {
        const auto body = web_request(server.port(), "GET", fmt::format("/api/v1/runs/1/{}", question)).body;
        return body.find(words) != std::string::npos;
    };
    REQUIRE(web_request(server.port(), "POST", "/api/v1/rehearsals", R"({"scenario":"nominal","pace":1})").status ==
            201);
    disk.fail_at(1, FaultyDisk::Fault::full, true);
    for (int i = 0; i < 2; ++i) {  // whether or not it is known already
        const auto note = post("notes", R"({"text":"the disk is full","by":"ada"})");
        CHECK(note.status == 503);
        CHECK_THAT(note.body, Catch::Contains("do not send it again"));
        CHECK(field(note, "Retry-After").empty());  // what was taken must not be sent again
        // What was not taken may be.
        const auto layout = web_request(server.port(), "PUT", "/api/v1/layouts/mine", R"({"view":"{}"})");
        CHECK(layout.status == 503);
        CHECK(field(layout, "Retry-After") == "5");
        const auto forecast = post("forecasts", R"({"cases":1})");
        CHECK(forecast.status == 503);
        CHECK(field(forecast, "Retry-After") == "5");
        const auto command = post("commands", R"({"command":"NO_OP","controller":"ada"})");
        CHECK(command.status == 202);
        CHECK_THAT(command.body, Catch::Contains("not in the archive yet"));
    }
    const auto sick = web_request(server.port(), "GET", "/healthz");
    disk.mend();
    for (int i = 0; i < 3'000 && !stored("notes", "the disk is full"); ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds{20});
    CHECK(stored("notes", "the disk is full"));
    CHECK(stored("commands", "NO_OP"));
    CHECK(sick.status == 503);
    CHECK(field(sick, "Retry-After") == "5");
    CHECK(post("notes", R"({"text":"and well again","by":"ada"})").status == 201);
}

TEST_CASE("a question that the disk keeps from its answer is the server's fault and not the asker's, and is answered "
          "once the disk is well",
          "[http][disk]") {
    FaultyDisk disk;
    RunningServer server{shipped_scenario("nominal"), 100.0};
    const auto status_of = [&](const char* question) {
        return web_request(server.port(), "GET", fmt::format("/api/v1/runs/1/{}", question)).status;
    };
    const auto comes = [&](unsigned status) {
        for (int i = 0; i < 3'000; ++i) {
            if (status_of("events") == status) return true;
            std::this_thread::sleep_for(std::chrono::milliseconds{20});
        }
        return false;
    };
    REQUIRE(comes(200));
    // What a question has read SQLite need not read again until something is committed.
    const auto last_seq = [&] {
        const auto body = web_request(server.port(), "GET", "/api/v1/runs/1").body;
        const auto at = body.find(R"("last_seq":)");
        return at == std::string::npos ? body : body.substr(at, body.find(',', at) - at);
    };
    const auto before = last_seq();
    for (int i = 0; i < 3'000 && last_seq() == before; ++i) std::this_thread::sleep_for(std::chrono::milliseconds{20});
    disk.fail_at(1, FaultyDisk::Fault::input_output, true);
    for (const char* question :
         {"events", "channels?names=altitude_m", "samples?names=altitude_m", "state", "report"}) {
        INFO(question);
        CHECK(status_of(question) == 500);
    }
    disk.mend();
    CHECK(comes(200));
    CHECK(status_of("events?level=LOUD") == 400);
}

TEST_CASE("a command file goes whole or not at all, and names the command that is refused", "[http][R44]") {
    RunningServer server{shipped_scenario("nominal"), 10.0};  // the run outlasts two thousand commands
    const auto post = [&](std::string_view body) {
        return web_request(server.port(), "POST", "/api/v1/runs/latest/sequences", body);
    };
    WebReply reply;
    for (int i = 0; i < 3000 && reply.status != 202; ++i) {
        reply = post(R"({"dry_run":true,"commands":[{"command":"NO_OP"},{"command":"NO_OP"}]})");
        if (reply.status != 202) std::this_thread::sleep_for(std::chrono::milliseconds{20});
    }
    CHECK_THAT(reply.body, Catch::StartsWith(R"({"accepted":true)") && Catch::Contains(R"("dry_run":true)"));
    const auto spoilt = post(R"({"commands":[{"command":"NO_OP"},{"command":"EDL_DO_EDL"}]})");
    CHECK(spoilt.status == 409);
    CHECK_THAT(spoilt.body, Catch::Contains("commands[1]: EDL_DO_EDL is hazardous"));
    CHECK_THAT(web_request(server.port(), "GET", "/api/v1/runs/latest/commands").body,
               Catch::StartsWith(R"({"commands":[])"));
    const auto taken = post(R"({"commands":[{"command":"NO_OP","request":"5"},{"command":"NO_OP","hold":true}]})");
    CHECK(taken.status == 202);
    CHECK_THAT(taken.body, Catch::Contains(R"("request":"5","command":"1")") && Catch::Contains(R"("command":"2")"));
    CHECK(post(R"({"commands":[]})").status == 400);
    CHECK_THAT(post(R"({"commands":[{"command":"NO_OP","dry_run":true}]})").body,
               Catch::Contains("commands[0]: dry_run"));
    // Nor is a part of one taken for which its sender has no places.
    std::string hundred = R"({"commands":[)";
    for (int i = 0; i < 100; ++i)
        hundred += i == 0 ? R"({"command":"NO_OP","hold":true})" : R"(,{"command":"NO_OP","hold":true})";
    hundred += "]}";
    for (int i = 0; i < 20; ++i) REQUIRE(post(hundred).status == 202);
    const auto over = post(hundred);
    CHECK(over.status == 409);
    CHECK_THAT(over.body, Catch::Contains("commands[4") &&
                              Catch::Contains("commands under way are yours: the places left are for others"));
    CHECK(post(R"({"commands":[{"command":"NO_OP","hold":true}]})").status == 202);
}

TEST_CASE(
    "a command that would break a constraint of the timeline is refused before it is sent, and the constraint is named",
    "[http][R19]") {
    RunningServer server{shipped_scenario("nominal"), 1.0};  // the run outlasts the analysis, however slow the build
    const auto& timeline = tests::shipped_dictionary().timeline;
    const auto row =
        std::ranges::find(timeline, "cruise_stage_separation", &dictionary::TimelineRow::name) - timeline.begin();
    const auto ask = [&](double desired_s, double minimum_s, bool dry_run) {
        const auto body = fmt::format(
            R"({{"command":"EDL_SET_TIMEPOINT_OFFSET","dry_run":{},"arguments":[{{"name":"timepoint","value":{}}},)"
            R"({{"name":"desired_offset_s","value":{}}},{{"name":"minimum_offset_s","value":{}}}]}})",
            dry_run, row, desired_s, minimum_s);
        return web_request(server.port(), "POST", "/api/v1/runs/latest/commands", body);
    };
    WebReply reply;
    for (int i = 0; i < 3000 && reply.status != 202; ++i) {  // a slow build is long in starting the run
        reply = ask(0.046875, 2.0, true);
        if (reply.status != 202) std::this_thread::sleep_for(std::chrono::milliseconds{20});
    }
    CHECK_THAT(reply.body, Catch::Contains("bounds of constraints.csv hold on the changed timeline"));
    const auto broken = ask(-19.953125, 0.0, false);  // at once behind the cutters, which need their two seconds
    INFO(broken.body);
    CHECK(broken.status == 409);
    CHECK_THAT(broken.body, Catch::Contains("breaks a constraint") && Catch::Contains("cruise_stage_separation") &&
                                Catch::Contains("constraints.csv:"));
}

TEST_CASE("when a change of the timeline is cancelled, what waits is looked at again with what remains, and its "
          "history says so",
          "[http][R19][R44]") {
    RunningServer server{shipped_scenario("nominal"), 1.0};
    const auto& timeline = tests::shipped_dictionary().timeline;
    const auto hold = [&](const char* timepoint, double desired_s, double minimum_s) {
        const auto row = std::ranges::find(timeline, timepoint, &dictionary::TimelineRow::name) - timeline.begin();
        const auto body = fmt::format(
            R"({{"command":"EDL_SET_TIMEPOINT_OFFSET","hold":true,"arguments":[{{"name":"timepoint","value":{}}},)"
            R"({{"name":"desired_offset_s","value":{}}},{{"name":"minimum_offset_s","value":{}}}]}})",
            row, desired_s, minimum_s);
        return web_request(server.port(), "POST", "/api/v1/runs/latest/commands", body);
    };
    const auto act = [&](const char* action, int number) {
        return web_request(server.port(), "POST", "/api/v1/runs/latest/commands",
                           fmt::format(R"({{"action":"{}","number":{}}})", action, number));
    };
    const auto released = [&](int number,
                              std::string_view says) {  // the newest word about when it leaves, once it says so
        std::string newest;
        for (int i = 0; i < 3000; ++i) {
            v1::CommandList list;
            REQUIRE(from_json(web_request(server.port(), "GET", "/api/v1/runs/latest/commands").body, list));
            if (list.commands_size() >= number)
                for (const auto& stage : list.commands(number - 1).stages())
                    if (stage.command_stage().stage() == v1::CommandStage::released)
                        newest = v1::CommandStage::Status_Name(stage.command_stage().status()) + ": " +
                                 stage.command_stage().evidence();
            if (newest.find(says) != std::string::npos) break;
            std::this_thread::sleep_for(std::chrono::milliseconds{20});
        }
        return newest;
    };
    WebReply reply;
    for (int i = 0; i < 3000 && reply.status != 202; ++i) {  // a slow build is long in starting the run
        reply = hold("detumble", -516.0, 0.0);
        if (reply.status != 202) std::this_thread::sleep_for(std::chrono::milliseconds{20});
    }
    REQUIRE(reply.status == 202);
    const auto later = hold("cruise_stage_separation", 6.046875, 2.0);  // as late only because the detumble is
    INFO(later.body);
    REQUIRE(later.status == 202);
    const auto other = hold("coolant_vent", -825.0, 0.0);  // for which neither matters
    INFO(other.body);
    REQUIRE(other.status == 202);
    CHECK_THAT(act("timeline refuted", 2).body, Catch::Contains("unknown action 'timeline refuted'"));
    REQUIRE(act("cancel", 1).status == 202);
    CHECK_THAT(released(2, "breaks a constraint"),
               Catch::StartsWith("failed: what it was analysed with has changed: ") &&
                   Catch::Contains("cruise_stage_separation:fired to detumble:triggered"));
    CHECK_THAT(released(3, "constraints.csv hold"),
               Catch::StartsWith("pending: ") && Catch::Contains("looked at again"));
}

TEST_CASE(
    "without accounts a browser is known by a cookie, and who asked a command cannot approve it under another name",
    "[http][access][R23]") {
    RunningServer server{shipped_scenario("two_persons"), 100.0};
    const auto port = server.port();
    const auto browser = [&] {
        const auto given = web_request(port, "GET", "/api/v1/session").set_cookie;
        CHECK_THAT(given, Catch::StartsWith("aeolis_browser=") && Catch::Contains("; HttpOnly; SameSite=Strict"));
        return Headers{{"Cookie", given.substr(0, given.find(';'))}};
    };
    const Headers first = browser(), second = browser(), none;
    CHECK(first[0].second != second[0].second);
    CHECK(web_request(port, "GET", "/api/v1/session", {}, first).set_cookie.empty());  // it stays the one that it is
    const auto ask = [&](const std::string& name, const Headers& from) {
        WebReply reply;
        for (int i = 0; i < 3000 && reply.status != 202; ++i) {
            reply = web_request(
                port, "POST", "/api/v1/runs/latest/commands",
                fmt::format(R"({{"command":"EDL_SET_PARAMETERS","from_solution":true,"controller":"{}"}})", name),
                from);
            if (reply.status != 202) std::this_thread::sleep_for(std::chrono::milliseconds{20});
        }
        return reply.status;
    };
    const auto approve = [&](int number, const std::string& name, const Headers& from) {
        return web_request(port, "POST", "/api/v1/runs/latest/commands",
                           fmt::format(R"({{"action":"approve","number":{},"controller":"{}"}})", number, name), from)
            .body;
    };
    REQUIRE(ask("ann", first) == 202);
    CHECK_THAT(web_request(port, "POST", "/api/v1/runs/latest/commands",
                           R"({"action":"approve","number":1,"controller":"ben","browser":"made up"})", second)
                   .body,
               Catch::Contains("browser: Cannot find field"));  // it is not for a client to say
    CHECK_THAT(approve(1, "ben", first), Catch::Contains("a second person approves it in a browser of their own"));
    CHECK_THAT(approve(1, "ben", second), Catch::Contains(R"("accepted":true)"));
    REQUIRE(ask("ann", none) == 202);
    CHECK_THAT(approve(2, "ben", none), Catch::Contains("a second person approves it in a browser of their own"));
    CHECK_THAT(approve(2, "ben", first), Catch::Contains(R"("accepted":true)"));  // a browser is another than a program
}

TEST_CASE("a command of a scenario's script that is refused in flight is in the run's history, with why",
          "[http][R44]") {
    auto scenario = shipped_scenario("nominal_auto");
    scenario.radio.tracking_passes = {
        {.station = "DSS-43", .begin_after_entry_s = -60.0, .end_after_entry_s = 3600.0}};  // after the script's time
    RunningServer server{scenario, 100.0};
    std::string commands;
    for (int i = 0; i < 3000 && commands.find("EDL_DO_EDL") == std::string::npos; ++i) {
        commands = web_request(server.port(), "GET", "/api/v1/runs/latest/commands").body;
        std::this_thread::sleep_for(std::chrono::milliseconds{20});
    }
    v1::CommandList list;
    REQUIRE(from_json(commands, list));
    REQUIRE(list.commands_size() == 2);
    CHECK(list.commands(0).name() == "EDL_SET_PARAMETERS");
    const auto& stage = list.commands(0).stages(0).command_stage();
    CHECK(stage.stage() == v1::CommandStage::queued);
    CHECK(stage.status() == v1::CommandStage::failed);
    CHECK_THAT(stage.evidence(),
               Catch::Contains("asked for by the scenario's script, refused: no station sees the vehicle"));
}

TEST_CASE("a page of another site, or a name bound to this address, gets nothing", "[http]") {
    RunningServer server;
    const auto status = [&](const Headers& headers) {
        return web_request(server.port(), "GET", "/api/v1/runs", "", headers).status;
    };
    CHECK(status({}) == 200);
    CHECK(status({{"Host", "localhost:8080"}, {"Origin", "http://localhost:8080"}}) == 200);
    CHECK(status({{"Host", "[::1]:8080"}, {"Origin", "http://[::1]:8080"}}) == 200);
    CHECK(status({{"Host", "localhost:8080"}, {"Origin", "http://localhost:5173"}}) == 403);
    CHECK(status({{"Origin", "https://evil.example"}}) == 403);
    CHECK(status({{"Origin", "null"}}) == 403);
    CHECK(status({{"Origin", "http://localhost.evil.example"}}) == 403);
    CHECK(status({{"Host", "evil.example"}}) == 403);
    CHECK(status({{"Host", "localhost"}}) == 200);
    CHECK(status({{"Host", "LocalHost:8080"}, {"Origin", "http://localhost:8080"}}) == 200);  // names have no case
    CHECK_FALSE(StreamClient{server.port(), "aeolis.v1.json", {{"Origin", "http://evil.example"}}}.open());
}

TEST_CASE("what is no HTTP, too long or cut off costs its own connection only", "[http]") {
    RunningServer server;
    const auto port = server.port();
    CHECK_THAT(raw_exchange(port, "this is not HTTP\r\n\r\n"), Catch::StartsWith("HTTP/1.1 400"));
    CHECK_THAT(raw_exchange(port, "GET / HTTP/1.1\r\nHost: localhost\r\nX: " + std::string(20'000, 'x') + "\r\n\r\n"),
               Catch::StartsWith("HTTP/1.1 431 ") && Catch::Contains("the header is longer than 16384 octets"));
    CHECK_THAT(raw_exchange(port, "GET /" + std::string(20'000, 'x') + " HTTP/1.1\r\nHost: localhost\r\n\r\n"),
               Catch::StartsWith("HTTP/1.1 414 ") && Catch::Contains("\"title\":\"URI Too Long\""));
    CHECK_THAT(
        raw_exchange(port, "POST /api/v1/rehearsals HTTP/1.1\r\nHost: localhost\r\nContent-Length: 2000000\r\n\r\n"),
        Catch::StartsWith("HTTP/1.1 413") && Catch::Contains("262144"));
    raw_exchange(port, "GET /api/v1/runs HTT");
    CHECK_THAT(raw_exchange(port, "GET /%zz HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n"),
               Catch::StartsWith("HTTP/1.1 400"));
    CHECK(web_request(port, "GET", "/healthz").status == 200);
}

TEST_CASE("the console's files are served, and nothing outside its folder", "[http][R45]") {
    RunningServer server;
    const auto port = server.port();
    CHECK(web_request(port, "GET", "/").status == 503);
    CHECK(field(web_request(port, "GET", "/"), "Retry-After") == "10");
    CHECK_THAT(web_request(port, "GET", "/").body, Catch::Contains("not built"));
    const auto web = server.archive().parent_path() / "web";
    std::filesystem::create_directories(web / "assets");
    std::ofstream{web / "index.html"} << "<!doctype html>console";
    std::ofstream{web / "assets/app-1a2b.js"} << "export {}";
    const auto page = web_request(port, "GET", "/");
    CHECK(page.status == 200);
    CHECK(page.content_type == "text/html; charset=utf-8");
    CHECK(page.cache_control == "no-cache");
    const auto script = web_request(port, "GET", "/assets/app-1a2b.js");
    CHECK(script.content_type == "text/javascript; charset=utf-8");
    CHECK_THAT(script.cache_control, Catch::Contains("immutable"));
    CHECK(web_request(port, "HEAD", "/").status == 200);
    for (const char* outside :
         {"/../a.db", "/%2e%2e/a.db", "/assets/../../a.db", "/..%2fa.db", "//etc/passwd.x", "/none.js"})
        CHECK(web_request(port, "GET", outside).status == 404);
}

TEST_CASE("the server gives the schema that it speaks, as files and as descriptors by which a message is read",
          "[http][R62]") {
    RunningServer server;
    v1::SchemaFileList list;
    REQUIRE(from_json(web_request(server.port(), "GET", "/api/v1/schema").body, list));
    CHECK(list.files_size() == 19);
    for (const auto& file : list.files()) {
        std::ifstream in{std::filesystem::path{AEOLIS_SOURCE_DIR "/schema"} / list.folder() / file};
        const auto given = web_request(server.port(), "GET", "/api/v1/schema/" + file);
        CHECK(given.body == std::string{std::istreambuf_iterator<char>{in}, {}});
    }
    google::protobuf::FileDescriptorSet set;
    REQUIRE(set.ParseFromString(web_request(server.port(), "GET", "/api/v1/schema/" + list.descriptor_set()).body));
    google::protobuf::DescriptorPool pool;  // knows nothing but what was given, each file after those it imports
    for (const auto& file : set.file()) CHECK(pool.BuildFile(file) != nullptr);
    const auto* item = pool.FindMessageTypeByName("aeolis.v1.Item");
    REQUIRE(item != nullptr);
    CHECK(item->field_count() == v1::Item::descriptor()->field_count());
    CHECK(web_request(server.port(), "GET", "/api/v1/schema/openapi.yaml").status == 404);
}

TEST_CASE("a second server on the port, or another address, is refused in one line", "[http]") {
    RunningServer server;
    server::ConsoleBackend::Settings settings;
    settings.web_server.port = server.port();
    settings.archive = server.archive().parent_path() / "other.db";
    const auto second = server::ConsoleBackend::open(settings, tests::shipped_dictionary());
    REQUIRE_FALSE(second);
    CHECK_THAT(second.error().message, Catch::Contains("in use"));
    CHECK_FALSE(std::filesystem::exists(settings.archive));
    settings.web_server.address = "0.0.0.0";
    CHECK_THAT(server::ConsoleBackend::open(settings, tests::shipped_dictionary()).error().message,
               Catch::Contains("loopback only"));
    settings.web_server.address = "127.0.0.1";
    settings.web_server.port = 0;
    settings.archive = server.archive();
    const auto same_archive = server::ConsoleBackend::open(settings, tests::shipped_dictionary());
    REQUIRE_FALSE(same_archive);
    CHECK(web_request(server.port(), "GET", "/healthz").status == 200);
}

}  // namespace server_http_test
