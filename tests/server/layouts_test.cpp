// SPDX-License-Identifier: Apache-2.0
#include "aeolis/v1/layout.pb.h"
#include "server/archive/layouts.hpp"
#include "server/base/json.hpp"
#include "tests/server/archive/faulty_disk.hpp"
#include "tests/server/audited.hpp"
#include "tests/server/running_server.hpp"
#include "tests/server/web_client.hpp"

#include <fmt/format.h>

namespace server_layouts_test {

using namespace aeolis;
using namespace aeolis::test;

namespace {

WebReply put(const RunningServer& server, const std::string& name, const std::string& body,
             const Headers& headers = {}) {
    return web_request(server.port(), "PUT", "/api/v1/layouts/" + name, body, headers);
}

v1::LayoutList listed(const RunningServer& server, const Headers& headers = {}) {
    v1::LayoutList list;
    REQUIRE(server::from_json(web_request(server.port(), "GET", "/api/v1/layouts", {}, headers).body, list));
    return list;
}

Headers log_in(const RunningServer& server, const std::string& user, const std::string& password) {
    const auto reply = web_request(server.port(), "POST", "/api/v1/session",
                                   R"({"user":")" + user + R"(","password":")" + password + "\"}");
    REQUIRE(reply.status == 201);
    return {{"Cookie", reply.set_cookie.substr(0, reply.set_cookie.find(';'))}};
}

Headers with_own_password(const RunningServer& server, const std::string& user, const std::string& given) {
    auto headers = log_in(server, user, given);
    REQUIRE(web_request(server.port(), "PATCH", "/api/v1/users/" + user,
                        R"({"password":"a password of my own","current_password":")" + given + "\"}", headers)
                .status == 200);
    return headers;
}

}  // namespace

TEST_CASE("without accounts a layout is everyone's: saved, listed, removed, and in the audit", "[layouts][http]") {
    RunningServer server;
    CHECK(listed(server).layouts_max() == archive::layouts_max);
    const auto saved = put(server, "Entry%202", R"({"view":"data=links&channels=mach"})");
    CHECK(saved.status == 200);
    CHECK_THAT(saved.body, Catch::Contains(R"("name":"Entry 2","view":"data=links&channels=mach","saved":"20)"));
    auto reader = archive::Reader::open(server.archive(), tests::shipped_dictionary());
    REQUIRE(reader);
    const auto entry = only_audited(*reader);
    CHECK(entry.action == "layout");
    CHECK(entry.detail == R"(PUT /api/v1/layouts/Entry 2 {"view":"data=links&channels=mach"})");
    CHECK(entry.outcome == "done");
    CHECK(put(server, "Approach", "{}").status == 200);
    const auto list = listed(server);
    REQUIRE(list.layouts_size() == 2);
    CHECK(list.layouts(0).name() != list.layouts(1).name());
    const auto& of_entry = list.layouts(list.layouts(0).name() == "Approach" ? 1 : 0);
    CHECK(of_entry.view() == "data=links&channels=mach");
    CHECK(web_request(server.port(), "DELETE", "/api/v1/layouts/Approach").status == 204);
    CHECK(web_request(server.port(), "DELETE", "/api/v1/layouts/Approach").status == 404);
    CHECK(listed(server).layouts_size() == 1);
}

TEST_CASE("a layout that is not one is refused with its reason, and nothing is kept of it", "[layouts][http][bounds]") {
    RunningServer server;
    const auto refused = [&](const std::string& name, const std::string& body, unsigned status, const char* why) {
        const auto reply = put(server, name, body);
        INFO(name << ' ' << body.substr(0, 60) << " -> " << reply.body);
        CHECK(reply.status == status);
        CHECK_THAT(reply.body, Catch::Contains(why));
    };
    refused("a", "{", 400, "error");
    refused("a", R"({"vew":""})", 400, "vew");
    refused("a", R"({"view":7})", 400, "view");
    refused("a", R"({"name":"b","view":""})", 422, "name: another");
    refused("a", R"({"view":"two words"})", 422, "view: the query");
    refused("a", R"({"view":")" + std::string(archive::layout_view_octets_max + 1, 'x') + "\"}", 422, "at most 2048");
    refused(std::string(archive::layout_name_octets_max + 1, 'x'), "{}", 422, "name: 1 to 40");
    refused("%3Cb%3E", "{}", 422, "name: 1 to 40");
    refused("%ff", "{}", 422, "name: 1 to 40");
    refused("a%2Fb", "{}", 422, "name: 1 to 40");
    CHECK(web_request(server.port(), "DELETE", "/api/v1/layouts/%ff").status == 404);
    CHECK(web_request(server.port(), "POST", "/api/v1/layouts/a", "{}").status == 405);
    CHECK(listed(server).layouts_size() == 0);
    for (std::size_t i = 0; i < archive::layouts_max; ++i)
        REQUIRE(put(server, fmt::format("l{}", i), "{}").status == 200);
    refused("more", "{}", 409, "there are 32 layouts");
    CHECK(put(server, "l0", R"({"view":"data=links"})").status == 200);
}

TEST_CASE("with accounts each person has layouts of their own", "[layouts][access][http]") {
    RunningServer server{RunningServer::WithAccounts{}};
    const auto administrator = with_own_password(server, "administrator", server.first_password());
    REQUIRE(web_request(server.port(), "POST", "/api/v1/users",
                        R"({"user":"olga","role":"observer","password":"given by another"})", administrator)
                .status == 201);
    const auto olga = with_own_password(server, "olga", "given by another");
    CHECK(put(server, "mine", R"({"view":"data=links"})", olga).status == 200);
    CHECK(put(server, "mine", R"({"view":"data=users"})", administrator).status == 200);
    CHECK(listed(server, olga).layouts(0).view() == "data=links");
    CHECK(web_request(server.port(), "DELETE", "/api/v1/layouts/mine", {}, administrator).status == 204);
    CHECK(listed(server, olga).layouts_size() == 1);
    CHECK(put(server, "mine", "{}").status == 401);
}

TEST_CASE("a layout that the disk refuses is answered so, and the earlier one stays", "[layouts][http][disk]") {
    FaultyDisk disk;
    RunningServer server;
    REQUIRE(put(server, "mine", R"({"view":"data=links"})").status == 200);
    disk.fail_at(1, FaultyDisk::Fault::input_output, true);
    const auto refused = put(server, "mine", R"({"view":"data=packets"})");
    CHECK(refused.status == 503);
    CHECK_THAT(refused.body, Catch::Contains("nothing was changed"));
    disk.mend();
    CHECK(listed(server).layouts(0).view() == "data=links");
}

}  // namespace server_layouts_test
