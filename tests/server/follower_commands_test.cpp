// SPDX-License-Identifier: Apache-2.0
#include "aeolis/v1/stream.pb.h"
#include "server/access/account_file.hpp"
#include "server/access/secrets.hpp"
#include "server/base/json.hpp"
#include "server/cluster/engine.hpp"
#include "server/cluster/request_sender.hpp"
#include "server/cluster/run_messages.hpp"
#include "tests/server/cluster/nats_server.hpp"
#include "tests/server/running_server.hpp"
#include "tests/server/web_client.hpp"

#include <atomic>
#include <fmt/format.h>
#include <fstream>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <regex>
#include <set>

// People at a follower, who command by its origin.
namespace server_follower_commands_test {

using namespace aeolis;
using namespace aeolis::server;
using namespace aeolis::test;
using namespace std::chrono_literals;
using tests::NatsServer;

namespace {

constexpr const char* password = "a password of my own";

template <typename Condition>
bool comes(Condition condition) {
    const auto until = std::chrono::steady_clock::now() + 60s;
    while (!condition()) {
        if (std::chrono::steady_clock::now() > until) return false;
        std::this_thread::sleep_for(20ms);
    }
    return true;
}

struct Person {
    const char* user;
    const char* role;
};

void write_people(const std::filesystem::path& file, std::initializer_list<Person> people) {
    static const auto hash = password_hash(password);
    v1::AccountFile accounts;
    for (const auto& person : people) {
        auto& account = *accounts.add_accounts();
        account.set_user(person.user);
        account.set_role(person.role);
        account.set_password_hash(hash);
    }
    REQUIRE(write_accounts(file, accounts));
}

/// `aeolis serve` in this process.
class Server {
  public:
    Server(ConsoleBackend::Settings settings, const std::optional<simulation::Scenario>& scenario)
        : accounts(settings.accounts) {
        spdlog::set_level(spdlog::level::off);
        settings.scenarios = shipped_scenarios;
        settings.dictionary = AEOLIS_SOURCE_DIR "/dictionaries/msl";
        settings.web = settings.archive.parent_path() / "web";
        const bool opened = comes([&] {
            auto backend = ConsoleBackend::open(settings, tests::shipped_dictionary());
            if (!backend) fault_ = backend.error().message;
            if (backend) backend_ = std::move(*backend);
            return backend_ != nullptr;  // until the origin has said that it is there
        });
        INFO(fault_);
        REQUIRE(opened);
        if (scenario) backend_->start({*scenario, 1, 1.0});
        network_ = std::thread{[this] { backend_->run(); }};
    }
    ~Server() {
        backend_->stop();
        network_.join();
    }
    Headers as(const std::string& user) {
        auto& known = as_[user];
        if (known.empty()) {
            const auto reply = web_request(port(), "POST", "/api/v1/session",
                                           fmt::format(R"({{"user":"{}","password":"{}"}})", user, password));
            REQUIRE(reply.status == 201);
            known = {{"Cookie", reply.set_cookie.substr(0, reply.set_cookie.find(';'))}};
        }
        return known;
    }
    WebReply ask(const std::string& user, const char* method, const std::string& path, const std::string& body = {}) {
        return web_request(port(), method, path, body, as(user));
    }
    double figure(const std::string& name) {
        const auto text = ask("admin", "GET", "/metrics").body;
        const auto at = text.find("\n" + name + " ");
        return at == std::string::npos ? -1.0 : std::stod(text.substr(at + name.size() + 2));
    }
    std::uint16_t port() const { return backend_->port(); }

    const std::filesystem::path accounts;

  private:
    std::string fault_;
    std::unique_ptr<ConsoleBackend> backend_;
    std::thread network_;
    std::map<std::string, Headers> as_;
};

/// An origin that flies, and a follower whose key it lists. "olga" is a director at the follower only, "guest" has no
/// account at the origin, "dora" is a director at both.
struct Site {
    TemporaryFolder folder;
    NatsServer engine;
    std::string seed = new_signing_seed();
    ConsoleBackend::Settings of_origin;
    std::unique_ptr<Server> origin, follower;

    explicit Site(const char* role = "controller") {
        ConsoleBackend::Settings of_follower;
        of_origin.archive = folder / "origin.db";
        of_origin.accounts = folder / "origin.json";
        of_origin.publish_to.url = engine.url();
        write_people(
            of_origin.accounts,
            {{"admin", "administrator"}, {"nina", "controller"}, {"olga", "controller"}, {"dora", "director"}});
        list(role);
        origin = std::make_unique<Server>(of_origin, shipped_scenario("nominal"));
        of_follower.archive = folder / "follower.db";
        of_follower.accounts = folder / "follower.json";
        of_follower.follow_by.url = engine.url();
        of_follower.follower_key = folder / "key";
        write_people(of_follower.accounts, {{"admin", "administrator"},
                                            {"nina", "controller"},
                                            {"olga", "director"},
                                            {"dora", "director"},
                                            {"guest", "controller"},
                                            {"otto", "observer"}});
        std::ofstream{of_follower.follower_key} << hexadecimal(seed) << '\n';
        std::filesystem::permissions(of_follower.follower_key, std::filesystem::perms::owner_read);
        follower = std::make_unique<Server>(of_follower, std::nullopt);
        REQUIRE(comes([&] { return command("nina", R"({"command":"NO_OP"})").status == 202; }));  // it has begun
    }
    void list(const char* role) {
        auto accounts = read_accounts(folder / "origin.json");
        REQUIRE(accounts);
        accounts->clear_followers();
        if (role != nullptr) {
            auto& listed = *accounts->add_followers();
            listed.set_name("site_b");
            listed.set_key(hexadecimal(public_key_of(seed)));
            listed.set_role(role);
        }
        REQUIRE(write_accounts(folder / "origin.json", *accounts));
    }
    WebReply command(const std::string& user, const std::string& body) {
        return follower->ask(user, "POST", "/api/v1/runs/latest/commands", body);
    }
    std::string commands(Server& server) { return server.ask("admin", "GET", "/api/v1/runs/1/commands").body; }
};

std::size_t times(const std::string& text, const std::string& word) {
    std::size_t found = 0;
    for (auto at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++found;
    return found;
}

}  // namespace

TEST_CASE("a command from a follower is its person's at the origin, and its fate comes back by the stream",
          "[cluster][http][R61]") {
    if (!NatsServer::present()) return;
    Site site;
    auto &origin = site.origin, &follower = site.follower;
    SECTION("by HTTP: the origin's audit has who asked, and where") {
        CHECK(comes([&] {
            const auto told = site.commands(*follower);
            return told.find("no arming needed, by nina") != std::string::npos &&
                   told.find(R"("stage":"executed","status":"ok")") != std::string::npos &&
                   told == site.commands(*origin);
        }));
        const auto audit = origin->ask("admin", "GET", "/api/v1/audit").body;
        CHECK_THAT(audit, Catch::Contains("\"nina\"") && Catch::Contains("follower site_b, 127.0.0.1"));
        CHECK(origin->figure("aeolis_follower_requests_total") >= 1.0);
        CHECK(origin->figure("aeolis_follower_requests_refused_total") == 0.0);
    }
    SECTION("by the stream of a console") {
        StreamClient console{follower->port(), "aeolis.v1.json", follower->as("nina")};
        REQUIRE(console.open());
        console.send(R"({"command":{"request":77,"run":1,"command":"NO_OP"}})", false);
        std::optional<v1::CommandReply> reply;
        while (!reply) {
            const auto text = console.receive();
            REQUIRE(text);
            v1::ServerMessage message;
            REQUIRE(from_json(*text, message));
            if (message.has_command_reply()) reply = message.command_reply();
        }
        CHECK(reply->request() == 77);
        CHECK(reply->accepted());
        CHECK(reply->reason().empty());
    }
    SECTION("acts on procedures go the same way, and come back with what follows from them") {
        const std::string procedures = "/api/v1/runs/1/procedures";
        const auto begun = follower->ask("nina", "POST", procedures,
                                         R"({"procedure":"day_after","position":"gnc","by":"somebody else"})");
        CHECK(begun.status == 201);
        CHECK_THAT(begun.body, Catch::Contains("\"begun_by\":\"nina (gnc)\""));
        CHECK(follower
                  ->ask("nina", "POST", procedures + "/1/acts",
                        R"({"kind":"hold","position":"gnc","reason":"site B waits"})")
                  .status == 201);
        CHECK(comes([&] {
            return follower->ask("nina", "GET", procedures).body.find("nina (gnc): site B waits") != std::string::npos;
        }));
    }
    SECTION("positions are taken the same way, and bind whoever is elsewhere") {
        const std::string positions = "/api/v1/runs/1/positions";
        CHECK(follower->ask("nina", "POST", positions, R"({"kind":"take","position":"command"})").status == 201);
        CHECK(comes(
            [&] { return follower->ask("nina", "GET", positions).body.find("\"by\":\"nina\"") != std::string::npos; }));
    }
    SECTION("notes go the same way, and a program's token counts as its account") {
        CHECK(follower->ask("nina", "POST", "/api/v1/runs/1/notes", R"({"text":"from site B"})").status == 201);
        CHECK(comes([&] {
            return follower->ask("nina", "GET", "/api/v1/runs/1/notes").body.find("from site B") != std::string::npos;
        }));
        const auto token =
            follower->ask("admin", "POST", "/api/v1/tokens", R"({"name":"script","role":"controller","owner":"nina"})");
        REQUIRE(token.status == 201);
        v1::Token made;
        REQUIRE(from_json(token.body, made));
        CHECK(web_request(follower->port(), "POST", "/api/v1/runs/1/commands", R"({"command":"NO_OP"})",
                          {{"Authorization", "Bearer " + made.token()}})
                  .status == 202);
    }
    SECTION("what is the origin's alone stays there") {
        const auto refused = follower->ask("dora", "POST", "/api/v1/rehearsals", R"({"scenario":"nominal"})");
        CHECK(refused.status == 409);
        const auto forecast = follower->ask("dora", "POST", "/api/v1/runs/1/forecasts", R"({"from":"telemetry"})");
        CHECK(forecast.status == 409);  // it would be kept at the origin, and nobody here could read it
        CHECK_THAT(refused.body, Catch::Contains("runs are begun there"));
    }
}

TEST_CASE("who asks at a follower may do what account, follower and origin all allow, and no more",
          "[cluster][access][http][R61]") {
    if (!NatsServer::present()) return;
    const auto hazardous = R"({"command":"EDL_DO_EDL","dry_run":false})";
    const auto refused = [](const WebReply& reply, const char* why) {
        INFO(reply.status << ' ' << reply.body);
        CHECK(reply.status == 403);
        CHECK_THAT(reply.body, Catch::Contains(why));
    };
    {
        Site site;
        refused(site.command("otto", R"({"command":"NO_OP"})"), "needs the right to command");
        refused(site.command("guest", R"({"command":"NO_OP"})"), "'guest' has no account here");
        refused(site.command("olga", hazardous), "olga is controller");
        refused(site.command("dora", hazardous), "dora is controller");  // as the follower's role says
        // Changes of the list count at once.
        site.list(nullptr);
        refused(site.command("nina", R"({"command":"NO_OP"})"), "none of this server's followers");
        CHECK(site.origin->figure("aeolis_follower_requests_refused_total") == 1.0);
        site.list("controller");
        CHECK(site.command("nina", R"({"command":"NO_OP"})").status == 202);
    }
    Site site{"director"};
    refused(site.command("olga", hazardous), "olga is controller");
    CHECK(site.command("dora", hazardous).status != 403);
}

TEST_CASE("a request that was overheard is no command when it comes again, also to a server that started anew",
          "[cluster][access][R61]") {
    if (!NatsServer::present()) return;
    Site site;
    cluster::EngineAddress address;
    address.url = site.engine.url();
    auto spy = cluster::Engine::connect(address, "spy");
    REQUIRE(spy);
    auto heard = spy->listen("aeolis.requests.>");
    REQUIRE(heard);
    std::optional<cluster::PlainMessage> overheard;
    REQUIRE(comes([&] {
        REQUIRE(site.command("nina", R"({"command":"NO_OP"})").status == 202);
        const auto came = heard->next(1s);
        if (came && *came) overheard = **came;
        return overheard.has_value();
    }));
    const auto sent = times(site.commands(*site.origin), "\"NO_OP\"");
    const auto to = cluster::Engine::own_subject();
    auto answers = spy->listen(to);
    REQUIRE(answers);
    const auto answer_to = [&](const std::string& octets) {
        REQUIRE(spy->send(overheard->subject, octets, to));
        const auto came = answers->next(10s);
        REQUIRE(came);
        REQUIRE(*came);
        v1::RequestAnswer answer;
        REQUIRE(answer.ParseFromString((*came)->octets));
        return answer;
    };
    CHECK_THAT(answer_to(overheard->octets).body(), Catch::Contains("taken before"));
    auto forged = overheard->octets;
    forged[40] = static_cast<char>(forged[40] ^ 1);
    CHECK(answer_to(forged).status() == 403);
    CHECK(answer_to("no request").status() == 403);
    CHECK(site.origin->figure("aeolis_follower_requests_refused_total") == 3.0);
    CHECK(times(site.commands(*site.origin), "\"NO_OP\"") == sent);
    site.origin.reset();
    site.origin = std::make_unique<Server>(site.of_origin, std::nullopt);
    CHECK(comes([&] {  // once it listens
        REQUIRE(spy->send(overheard->subject, overheard->octets, to));
        const auto came = answers->next(1s);
        v1::RequestAnswer answer;
        return came && *came && answer.ParseFromString((*came)->octets) &&
               answer.body().find("before this server started") != std::string::npos;
    }));
}

TEST_CASE("a follower that has not heard its origin says so, and asks nothing that would be refused",
          "[cluster][access][R61]") {
    if (!NatsServer::present()) return;
    NatsServer engine;
    cluster::EngineAddress address;
    address.url = engine.url();
    auto spy = cluster::Engine::connect(address, "spy");
    REQUIRE(spy);
    auto requests = spy->listen(cluster::subject_of_requests("origin"));
    REQUIRE(requests);
    std::atomic<bool> heard = false;
    cluster::RequestSender sender{{address, "origin", new_signing_seed(), [&] {
                                       return heard ? cluster::RequestSender::Origin{"its process", 1}
                                                    : cluster::RequestSender::Origin{};
                                   }}};
    const auto ask = [&](std::chrono::seconds within) {
        auto answer = std::make_shared<std::promise<v1::RequestAnswer>>();
        auto given = answer->get_future();
        sender.ask({}, [answer](v1::RequestAnswer reply) { answer->set_value(std::move(reply)); });
        return given.wait_for(within) == std::future_status::ready ? std::optional{given.get()} : std::nullopt;
    };
    const auto answer = ask(60s);
    REQUIRE(answer);
    CHECK(answer->status() == 503);
    CHECK_THAT(answer->body(), Catch::Contains("has not been heard here yet"));
    heard = true;
    CHECK_FALSE(ask(0s));  // nobody answers
    const auto came = requests->next(60s);
    REQUIRE(came);
    REQUIRE(*came);
    v1::SignedRequest message;
    v1::FollowerRequest request;
    REQUIRE(message.ParseFromString((*came)->octets));
    REQUIRE(request.ParseFromString(message.request()));
    CHECK(request.publisher() == "its process");  // the first that was sent
}

TEST_CASE("a run is fetched by the token of an instructor, and any other is refused in a line",
          "[cluster][access][R61]") {
    if (!NatsServer::present()) return;
    Site site;
    REQUIRE(comes([&] { return site.origin->figure("aeolis_publishing_waiting_items") == 0.0; }));
    cluster::EngineAddress administrator;
    administrator.url = site.engine.url();
    auto engine = cluster::Engine::connect(administrator, "administrator");
    REQUIRE(engine);
    REQUIRE(engine->clear(cluster::run_stream, cluster::all_runs));
    const auto token_of = [&](const char* role) {
        const auto reply = site.origin->ask("admin", "POST", "/api/v1/tokens",
                                            fmt::format(R"({{"name":"{0}_site","role":"{0}"}})", role));
        INFO(reply.body);
        REQUIRE(reply.status == 201);
        v1::Token made;
        REQUIRE(from_json(reply.body, made));
        return made.token();
    };
    const auto late = [&](const std::string& token) {
        ConsoleBackend::Settings settings;
        settings.archive = site.folder / "late.db";
        settings.accounts = site.folder / "late.json";
        settings.follow_by.url = site.engine.url();
        settings.snapshots.server = fmt::format("http://127.0.0.1:{}", site.origin->port());
        settings.snapshots.token = token;
        return std::make_unique<Server>(settings, std::nullopt);
    };
    write_people(site.folder / "late.json", {{"admin", "administrator"}});
    for (const auto& [token, says] : {std::pair{std::string{}, "it answers 401: log in first"},
                                      std::pair{std::string{"no token of it"}, "it answers 401: log in first"},
                                      std::pair{token_of("director"), "this needs the right to instruct"}}) {
        const auto server = late(token);
        const auto told = [&] { return server->ask("admin", "GET", "/healthz").body; };
        INFO(told());
        CHECK(comes([&] { return told().find(says) != std::string::npos; }));
        CHECK(server->figure("aeolis_following_fetch_fault") == 1.0);
        CHECK(server->figure("aeolis_followed_fetched_steps_total") == 0.0);
    }
    CHECK_THAT(site.origin->ask("admin", "GET", "/api/v1/audit").body, Catch::Contains("/runs/1/rows"));
    const auto server = late(token_of("instructor"));
    CHECK(comes([&] {
        return server->figure("aeolis_followed_fetched_steps_total") > 0.0 &&
               server->figure("aeolis_following_behind_items") == 0.0;
    }));
    CHECK(server->figure("aeolis_following_fetch_fault") == 0.0);
    CHECK_THAT(server->ask("admin", "GET", "/api/v1/runs/1").body, Catch::Contains("\"scenario\":\"nominal\""));
}

TEST_CASE("each metric that the cluster's alert rules and dashboard name is one that an origin or a follower has",
          "[cluster][monitoring][R61]") {
    if (!NatsServer::present()) return;
    Site site;
    std::set<std::string> known;
    const auto add_names = [](const std::string& text, const char* pattern, std::set<std::string>& names) {
        const std::regex name{pattern};
        for (std::sregex_iterator found{text.begin(), text.end(), name}, end; found != end; ++found)
            names.insert((*found)[1]);
    };
    for (auto* server : {&*site.origin, &*site.follower})
        add_names(server->ask("admin", "GET", "/metrics").body, "# HELP (aeolis_[a-z0-9_]+) ", known);
    for (const char* file : {"aeolis-cluster-alerts.yml", "aeolis-cluster-dashboard.json"}) {
        std::ifstream in{std::filesystem::path{AEOLIS_SOURCE_DIR "/setup/monitoring"} / file};
        std::set<std::string> named;
        add_names({std::istreambuf_iterator<char>{in}, {}}, "(aeolis_[a-z0-9_]+)", named);
        CHECK(named.size() >= 5);
        for (const auto& name : named) {
            INFO(file << " names " << name);
            CHECK(known.contains(name));
        }
    }
}

}  // namespace server_follower_commands_test
