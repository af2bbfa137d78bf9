// SPDX-License-Identifier: Apache-2.0
#include "server/access/access.hpp"
#include "server/access/account_file.hpp"
#include "server/access/network.hpp"
#include "server/access/secrets.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/shipped_dictionary.hpp"
#include "tests/support/temporary_folder.hpp"

#include <fmt/format.h>
#include <fstream>
#include <sys/stat.h>

namespace access_access_test {

using namespace aeolis;
using namespace aeolis::server;

namespace {

/// Accounts with an administrator who has chosen a password, and a clock that the test sets.
struct Accounts {
    static constexpr const char* password = "a password of my own";
    test::TemporaryFolder folder;
    std::filesystem::path file = folder / "accounts.json";
    Access::Clock::time_point now = Access::Clock::now();
    std::chrono::hours clock_is_ahead{0};  ///< of the system, which somebody sets
    std::unique_ptr<Access> access;

    Accounts() {
        open();
        const auto first = log_in("administrator", access->first_password());
        REQUIRE(first);
        v1::UserChange change;
        change.set_password(password);
        change.set_current_password(access->first_password());
        REQUIRE(access->change_user(first->who, "administrator", change));
    }
    void open() {
        auto opened = Access::open({.file = file,
                                    .now = [this] { return now + clock_is_ahead; },
                                    .uptime = [this] { return Access::Uptime::time_point{now.time_since_epoch()}; }});
        REQUIRE(opened);
        access = std::move(*opened);
    }
    Result<Access::LoggedIn> log_in(const std::string& user, const std::string& with,
                                    const std::string& from = "127.0.0.1") {
        v1::LogIn asked;
        asked.set_user(user);
        asked.set_password(with);
        return access->log_in(asked, from);
    }
    Operator who(const std::string& secret) {
        return access->identify({"theme=dark; aeolis_session=" + secret, "", "127.0.0.1"});
    }
    void add(const std::string& user, const std::string& role) {
        v1::NewUser wanted;
        wanted.set_user(user);
        wanted.set_role(role);
        wanted.set_password("given by another");
        REQUIRE(access->add_user(wanted));
    }
};

}  // namespace

TEST_CASE("the first start makes one way in, which only lets its owner choose a password", "[access]") {
    Accounts accounts;
    CHECK(accounts.log_in("administrator", accounts.access->first_password()).error().message ==
          "user or password is wrong");
    const auto in = accounts.log_in("administrator", Accounts::password);
    REQUIRE(in);
    const auto who = accounts.who(in->secret);
    CHECK(who.user == "administrator");
    CHECK(may(who, Right::administer));
    struct stat file{};
    REQUIRE(::stat(accounts.file.c_str(), &file) == 0);
    CHECK((file.st_mode & 0777) == 0600);
    accounts.open();  // a second start finds its accounts, and no session
    CHECK(accounts.access->first_password().empty());
    CHECK_FALSE(accounts.who(in->secret).role);
}

namespace {
constexpr int changes_each = 10;  // by either process
}

TEST_CASE("part of a test: another process that changes the accounts", "[.part]") {
    const auto file = test::variable("AEOLIS_TEST_ACCOUNTS");
    REQUIRE_FALSE(file.empty());
    for (int i = 0; i < changes_each; ++i) {
        const AccountsLock lock{file};
        auto all = read_accounts(file);
        REQUIRE(all);
        auto& account = *all->add_accounts();
        account.set_user(fmt::format("child-{}", i));
        account.set_role("observer");
        REQUIRE(write_accounts(file, *all));
    }
}

TEST_CASE("who changes the accounts waits until another process has done so, and loses nothing of it", "[access]") {
    Accounts accounts;
    auto other = test::ChildProcess::part("part of a test: another process that changes the accounts",
                                          {{"AEOLIS_TEST_ACCOUNTS", accounts.file.string()}});
    for (int i = 0; i < changes_each; ++i) {
        v1::NewToken wanted;
        wanted.set_owner("administrator");
        wanted.set_name(fmt::format("token-{}", i));
        wanted.set_role("observer");
        CHECK(accounts.access->add_token(wanted));
    }
    CHECK(other.ended_within() == 0);
    const auto all = read_accounts(accounts.file);
    REQUIRE(all);
    CHECK(all->accounts_size() == 1 + changes_each);
    CHECK(all->tokens_size() == changes_each);
}

TEST_CASE("without accounts browsers are told apart, and all programs without a cookie are one", "[access]") {
    auto access = Access::open({});
    REQUIRE(access);
    const auto browser = [&](const std::string& cookie) {
        return (*access)->identify({cookie, "", "127.0.0.1"}).browser;
    };
    CHECK(browser("aeolis_browser=one") != browser("aeolis_browser=two"));
    CHECK(browser("theme=dark; aeolis_browser=one") == browser("aeolis_browser=one"));
    CHECK_THAT(browser("aeolis_browser=one"),
               !Catch::Contains("one"));  // what the audit and the archive keep lets nobody in its place
    CHECK(browser("") == no_browser);
    CHECK(browser("aeolis_session=one") == no_browser);
}

TEST_CASE("no password and no secret stands in the file of accounts", "[access]") {
    Accounts accounts;
    v1::NewToken wanted;
    wanted.set_owner("administrator");
    wanted.set_name("exporter");
    wanted.set_role("observer");
    const auto token = accounts.access->add_token(wanted);
    REQUIRE(token);
    std::ifstream in{accounts.file};
    const std::string text{std::istreambuf_iterator<char>{in}, {}};
    CHECK_THAT(text, Catch::Contains("$argon2id$"));
    CHECK_THAT(text, !Catch::Contains(Accounts::password) && !Catch::Contains(token->token()));
}

TEST_CASE("who guesses waits, longer each time, and the right password does not help until then", "[access]") {
    Accounts accounts;
    for (unsigned i = 0; i < Access::tries_of_user; ++i)
        CHECK(accounts.log_in("administrator", "a wrong password").error().message == "user or password is wrong");
    CHECK_THAT(accounts.log_in("administrator", Accounts::password).error().message, Catch::Contains("wait 30 s"));
    CHECK(accounts.log_in("administrator", Accounts::password, "192.0.2.7"));  // from elsewhere its owner gets in
    accounts.now += std::chrono::seconds{31};
    CHECK_FALSE(accounts.log_in("administrator", "a wrong password"));
    CHECK_THAT(accounts.log_in("administrator", Accounts::password).error().message, Catch::Contains("wait 60 s"));
    accounts.now += std::chrono::seconds{61};
    CHECK(accounts.log_in("administrator", Accounts::password));
}

TEST_CASE("a system clock that is set ends no log-in and no lock-out, and prolongs none", "[access][R62]") {
    Accounts accounts;
    const auto shift = accounts.log_in("administrator", Accounts::password);
    REQUIRE(shift);
    for (unsigned i = 0; i < Access::tries_of_user; ++i)
        CHECK_FALSE(accounts.log_in("administrator", "a wrong password", "192.0.2.7"));
    for (const int ahead_h : {48, -48, 1, 0}) {
        accounts.clock_is_ahead = std::chrono::hours{ahead_h};
        CHECK(accounts.who(shift->secret).role);
        CHECK(accounts.access->locked_out("administrator", "192.0.2.7") == Access::first_lock_out);
    }
    accounts.clock_is_ahead = std::chrono::hours{-48};
    accounts.now += Access::first_lock_out;
    CHECK(accounts.access->locked_out("administrator", "192.0.2.7").count() == 0);
    accounts.now += Access::session_length;
    CHECK_FALSE(accounts.who(shift->secret).role);
}

TEST_CASE("who guesses from another address of the same /64 waits as well", "[access]") {
    CHECK(network_of("2001:db8:1:2:3:4:5:6") == "2001:db8:1:2::/64");
    CHECK(network_of("2001:db8:1:2::7") == "2001:db8:1:2::/64");
    CHECK(network_of("fe80::1%eth0") == "fe80::/64");
    CHECK(network_of("192.0.2.7") == "192.0.2.7");
    CHECK(network_of("unknown") == "unknown");
    Accounts accounts;
    for (unsigned i = 0; i < Access::tries_of_user; ++i)
        CHECK(accounts.log_in("administrator", "a wrong password", fmt::format("2001:db8:1:2::{:x}", i + 1))
                  .error()
                  .message == "user or password is wrong");
    CHECK_THAT(accounts.log_in("administrator", Accounts::password, "2001:db8:1:2:ffff::1").error().message,
               Catch::Contains("wait 30 s"));
    CHECK(accounts.log_in("administrator", Accounts::password, "2001:db8:1:3::1"));
}

TEST_CASE("wrong passwords of long ago are forgotten, and one user's many log-ins end no other's", "[access]") {
    Accounts accounts;
    for (unsigned round = 0; round < 3; ++round) {
        for (unsigned i = 0; i + 1 < Access::tries_of_user; ++i)
            CHECK_FALSE(accounts.log_in("administrator", "a wrong password"));
        accounts.now += Access::longest_lock_out + std::chrono::seconds{1};
    }
    CHECK_FALSE(accounts.log_in("administrator", "a wrong password"));
    const auto first = accounts.log_in("administrator", Accounts::password);
    REQUIRE(first);
    accounts.add("carl", "controller");
    const auto carl = accounts.log_in("carl", "given by another");
    for (std::size_t i = 0; i < Access::sessions_of_user_max; ++i) {
        accounts.now += std::chrono::seconds{1};
        REQUIRE(accounts.log_in("carl", "given by another"));
    }
    CHECK_FALSE(accounts.who(carl->secret).role);  // their own oldest
    CHECK(accounts.who(first->secret).role);
}

TEST_CASE("a log-in ends after a shift, by logging out, with its user, and when its password is changed elsewhere",
          "[access]") {
    Accounts accounts;
    accounts.add("dina", "director");
    const auto administrator = accounts.log_in("administrator", Accounts::password)->who;
    const auto shift = accounts.log_in("dina", "given by another");
    REQUIRE(shift);
    CHECK(accounts.who(shift->secret).choose_password);
    CHECK_FALSE(may(accounts.who(shift->secret), Right::watch));
    accounts.now += Access::session_length + std::chrono::seconds{1};
    CHECK_FALSE(accounts.who(shift->secret).role);

    const auto out = accounts.log_in("dina", "given by another");
    accounts.access->log_out(accounts.who(out->secret));
    CHECK_FALSE(accounts.who(out->secret).role);

    const auto before = accounts.log_in("dina", "given by another");
    v1::UserChange change;
    change.set_password("given once more by another");
    REQUIRE(accounts.access->change_user(administrator, "dina", change));
    CHECK_FALSE(accounts.who(before->secret).role);

    const auto last = accounts.log_in("dina", "given once more by another");
    REQUIRE(last);
    REQUIRE(accounts.access->remove_user("dina"));
    CHECK_FALSE(accounts.who(last->secret).role);
}

TEST_CASE("nobody raises their own role, changes another's account, or takes the last administrator away", "[access]") {
    Accounts accounts;
    accounts.add("carl", "controller");
    const auto administrator = accounts.log_in("administrator", Accounts::password)->who;
    const auto carl = accounts.log_in("carl", "given by another")->who;
    v1::UserChange change;
    change.set_role("director");
    CHECK_THAT(accounts.access->change_user(carl, "carl", change).error().message,
               Catch::Contains("nobody changes their own"));
    CHECK_THAT(accounts.access->change_user(carl, "administrator", change).error().message,
               Catch::Contains("only an administrator"));
    CHECK_THAT(accounts.access->change_user(administrator, "administrator", change).error().message,
               Catch::Contains("nobody changes their own"));
    CHECK(accounts.access->remove_user("administrator").error().message == "one administrator must remain");
    change.set_role("pope");
    CHECK_THAT(accounts.access->change_user(administrator, "carl", change).error().message, Catch::Contains("'pope'"));
    change.set_role("");
    change.set_password("short");
    CHECK_THAT(accounts.access->change_user(administrator, "carl", change).error().message,
               Catch::Contains("12 to 128"));
    change.set_password("long enough, but whose?");
    change.set_current_password("a wrong password");
    CHECK_THAT(accounts.access->change_user(carl, "carl", change).error().message,
               Catch::StartsWith("current_password"));
    CHECK_THAT(accounts.access->remove_user("nobody").error().message, Catch::Contains("'nobody'"));
}

TEST_CASE("an administrator says which commands an account or a program may send, and nobody says it of themselves",
          "[access]") {
    Accounts accounts;
    accounts.add("dina", "director");
    const auto administrator = accounts.log_in("administrator", Accounts::password)->who;
    const auto dina = accounts.log_in("dina", "given by another");
    REQUIRE(dina);
    v1::UserChange change;
    change.add_commands("NO_OP");
    const auto changed = accounts.access->change_user(administrator, "dina", change);
    REQUIRE(changed);
    CHECK(changed->commands_size() == 1);
    CHECK(changed->role() == "director");                                             // as it was
    CHECK(accounts.who(dina->secret).commands == std::vector<std::string>{"NO_OP"});  // at once, and the log-in goes on
    CHECK_THAT(accounts.access->change_user(dina->who, "dina", change).error().message,
               Catch::StartsWith("commands: nobody changes their own"));
    v1::UserChange other_role;
    other_role.set_role("controller");
    REQUIRE(accounts.access->change_user(administrator, "dina", other_role));
    CHECK(accounts.who(dina->secret).commands.size() == 1);
    change.set_all_commands(true);
    CHECK_THAT(accounts.access->change_user(administrator, "dina", change).error().message,
               Catch::Contains("one of them, not both"));
    change.clear_commands();
    CHECK_THAT(accounts.access->change_user(dina->who, "dina", change).error().message,
               Catch::StartsWith("commands: nobody changes their own"));
    REQUIRE(accounts.access->change_user(administrator, "dina", change));
    CHECK(accounts.who(dina->secret).commands.empty());

    v1::NewToken wanted;
    wanted.set_owner("administrator");
    wanted.set_name("ping");
    wanted.set_role("controller");
    wanted.add_commands("NO_OP");
    const auto token = accounts.access->add_token(wanted);
    REQUIRE(token);
    CHECK(token->commands_size() == 1);
    CHECK(accounts.access->identify({"", "Bearer " + token->token(), "127.0.0.1"}).commands ==
          std::vector<std::string>{"NO_OP"});
    accounts.open();  // as the file has it
    CHECK(accounts.access->tokens().tokens(0).commands(0) == "NO_OP");
}

TEST_CASE("a token lets a program in with its role, until it expires or is taken away", "[access]") {
    Accounts accounts;
    v1::NewToken wanted;
    wanted.set_owner("administrator");
    wanted.set_name("exporter");
    wanted.set_role("observer");
    wanted.set_days(3);
    const auto token = accounts.access->add_token(wanted);
    REQUIRE(token);
    const auto who = [&] { return accounts.access->identify({"", "Bearer " + token->token(), "127.0.0.1"}); };
    CHECK(who().user == "token exporter");
    CHECK(may(who(), Right::watch));
    CHECK_FALSE(may(who(), Right::command));
    CHECK_FALSE(accounts.access->identify({"", "Bearer " + token->token() + "x", ""}).role);
    CHECK_FALSE(accounts.access->identify({"", "Basic " + token->token(), ""}).role);
    CHECK(accounts.access->add_token(wanted).error().message == "there is a token 'exporter' already");
    accounts.now += std::chrono::hours{24 * 3} + std::chrono::seconds{1};
    CHECK_FALSE(who().role);
    CHECK(accounts.access->remove_token("exporter"));
    CHECK_FALSE(accounts.access->remove_token("exporter"));
}

TEST_CASE("a token counts as its owner: never more than the owner may, and gone with the owner", "[access][R63]") {
    Accounts accounts;
    accounts.add("ada", "director");
    v1::NewToken wanted;
    wanted.set_name("robot");
    wanted.set_role("director");
    CHECK(accounts.access->add_token(wanted).error().message == "owner: there is no user ''");
    wanted.set_owner("nobody");
    CHECK(accounts.access->add_token(wanted).error().message == "owner: there is no user 'nobody'");
    wanted.set_owner("ada");
    wanted.set_role("administrator");
    CHECK(accounts.access->add_token(wanted).error().message ==
          "role: administrator is more than that of its owner ada, director");
    wanted.set_role("director");
    const auto token = accounts.access->add_token(wanted);
    REQUIRE(token);
    CHECK(token->owner() == "ada");
    const auto who = [&] { return accounts.access->identify({"", "Bearer " + token->token(), "127.0.0.1"}); };
    CHECK(person_of(who()) == "ada");
    CHECK(who().user == "token robot");
    CHECK(may(who(), Right::hazardous));
    const auto administrator = accounts.log_in("administrator", Accounts::password);
    REQUIRE(administrator);
    v1::UserChange change;
    change.set_role("observer");
    REQUIRE(accounts.access->change_user(administrator->who, "ada", change));
    CHECK_FALSE(may(who(), Right::command));
    CHECK(may(who(), Right::watch));

    v1::UserChange limited;
    limited.set_role("director");
    limited.add_commands("NO_OP");
    limited.add_commands("EDL_DUMP_PARAMETERS");
    REQUIRE(accounts.access->change_user(administrator->who, "ada", limited));
    CHECK(who().commands == std::vector<std::string>{"NO_OP", "EDL_DUMP_PARAMETERS"});  // as ada herself
    for (const char* const command : {"NO_OP", "EDL_DO_EDL"}) {
        wanted.set_name(command[0] == 'N' ? "ping" : "lander");
        wanted.clear_commands();
        wanted.add_commands(command);
        const auto other = accounts.access->add_token(wanted);
        REQUIRE(other);
        const auto program = accounts.access->identify({"", "Bearer " + other->token(), "127.0.0.1"});
        CHECK(may(program, Right::watch));
        CHECK(may(program, Right::command) == (wanted.name() == "ping"));  // nothing is left for the lander to send
        CHECK(program.commands.size() == (wanted.name() == "ping" ? 1U : 0U));
    }
    REQUIRE(accounts.access->remove_user("ada"));
    CHECK_FALSE(who().role);
    CHECK(accounts.access->tokens().tokens().empty());
}

TEST_CASE("a server takes over what another program changed in the file, and keeps what it has when that is spoilt",
          "[access]") {
    Accounts accounts;
    auto changed = *read_accounts(accounts.file);
    const auto password = reset_account(changed, "helper");
    auto touch = [&, n = 0]() mutable {
        std::filesystem::last_write_time(accounts.file,
                                         std::filesystem::file_time_type::clock::now() + std::chrono::seconds{++n});
    };
    REQUIRE(write_accounts(accounts.file, changed));
    touch();
    CHECK(accounts.log_in("helper", password));
    std::ofstream{accounts.file} << R"({"accounts": [{"user": "x", "role": "pope"}]})";
    touch();
    CHECK(accounts.log_in("helper", password));
    const auto opened = Access::open({.file = accounts.file});
    REQUIRE_FALSE(opened);
    CHECK_THAT(opened.error().message, Catch::Contains("accounts.json") && Catch::Contains("'pope'"));
}

TEST_CASE("without accounts everybody may do all but administer", "[access]") {
    const auto access = Access::open({});
    REQUIRE(access);
    const auto who = (*access)->identify({"aeolis_session=x", "Bearer y", "127.0.0.1"});
    for (const Right right : rights) CHECK(may(who, right) == (right != Right::administer));
    CHECK_FALSE((*access)->log_in({}, ""));
    CHECK_FALSE((*access)->add_token({}));
}

TEST_CASE("names of users and tokens are plain", "[access]") {
    for (const char* good : {"a", "dina.k", "ops-2", "x_y", "abcdefghijklmnopqrstuvwxyz012345"})
        CHECK(check_name(good));
    for (const char* bad : {"", "A", "2x", "a b", "a/b", "<b>", "ü", "abcdefghijklmnopqrstuvwxyz0123456", "-a"})
        CHECK_FALSE(check_name(bad));
}

TEST_CASE("a password's hash matches that password only, and no hash matches nothing", "[access]") {
    const auto hash = password_hash("correct horse battery");
    CHECK(password_matches(hash, "correct horse battery"));
    CHECK_FALSE(password_matches(hash, "correct horse batterx"));
    CHECK_FALSE(password_matches("", ""));
    CHECK_FALSE(password_matches("$argon2id$nonsense", "x"));
    CHECK(new_secret() != new_secret());
    CHECK(new_secret().size() == 43);
    CHECK(secret_hash("abc") ==
          "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");  // FIPS 180-4, example B.1
}

}  // namespace access_access_test
