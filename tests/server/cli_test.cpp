// SPDX-License-Identifier: Apache-2.0
#include "aeolis/v1/run.pb.h"
#include "commands/parameter_table.hpp"
#include "flight/load.hpp"
#include "server/archive/sqlite.hpp"
#include "server/base/json.hpp"
#include "server/base/pcap.hpp"
#include "tests/server/running_server.hpp"
#include "tests/server/web_client.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/mission_copy.hpp"
#include "tests/support/shipped_dictionary.hpp"
#include "tests/support/temporary_folder.hpp"

#include <algorithm>
#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http.hpp>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <google/protobuf/struct.pb.h>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <thread>
#include <unistd.h>
#include <utility>
#include <vector>

namespace server_cli_test {

using aeolis::test::program;
using aeolis::test::run;

// The program as people start it: what it says, on one line, and how it ends.
TEST_CASE("a command file is sent to a server by the program, whole or not at all, a line a command",
          "[cli][http][R44]") {
    if (program().empty()) return;
    aeolis::test::RunningServer server{aeolis::test::shipped_scenario("nominal"), 1.0};
    const aeolis::test::TemporaryFolder folder;
    const auto send = [&](const std::string& file, const std::string& options) {
        std::ofstream{folder / "commands.json"} << file;
        return run(program(), fmt::format("send --server http://127.0.0.1:{} --file '{}' {}", server.port(),
                                          (folder / "commands.json").string(), options));
    };
    const auto count = [&] {
        const auto list = aeolis::test::web_request(server.port(), "GET", "/api/v1/runs/latest/commands").body;
        std::size_t commands = 0;
        for (auto at = list.find("\"octets\""); at != std::string::npos; at = list.find("\"octets\"", at + 1))
            ++commands;
        return commands;
    };
    const std::string good =
        R"({"commands":[{"command":"NO_OP"},{"command":"EDL_SET_PARAMETERS","from_solution":true,"hold":true}]})";
    aeolis::test::Ended tried;
    for (int i = 0; i < 3000 && tried.code != 0; ++i)  // until the run has begun
        tried = send(good, "--dry-run");
    INFO(tried.text);
    CHECK_THAT(tried.text, Catch::Contains("1  NO_OP  would be taken, ") && Catch::Contains("at the vehicle 2012-") &&
                               Catch::Contains("to be there before ") &&
                               Catch::Contains("a dry run: nothing was sent"));
    CHECK(count() == 0);
    const auto spoilt = send(R"({"commands":[{"command":"NO_OP"},{"command":"EDL_DO_EDL"}]})", "");
    CHECK(spoilt.code == 1);
    CHECK_THAT(spoilt.text, Catch::Contains("2  EDL_DO_EDL  refused: ") &&
                                Catch::Contains("nothing was sent: commands[1]: EDL_DO_EDL is hazardous"));
    CHECK(count() == 0);
    const auto sent = send(good, "--by ann");
    CHECK(sent.code == 0);
    CHECK_THAT(sent.text,
               Catch::Contains("1  NO_OP  is command 1") && Catch::Contains("2  EDL_SET_PARAMETERS  is command 2"));
    CHECK(count() == 2);
    CHECK(send(good, "--by ann --id again").code == 0);
    const auto again = send(good, "--by ann --id again");
    CHECK(again.code == 0);
    CHECK_THAT(again.text, Catch::Contains("1  NO_OP  is command 3 already: not sent again; "));
    CHECK(count() == 4);
    const auto wrong = send(good, "--run 77");
    CHECK(wrong.code == 1);
    CHECK_THAT(wrong.text, Catch::Contains("77"));
}

TEST_CASE("a command file whose answer is lost, or is none of ours, may have been taken, and how to send it again is "
          "said",
          "[cli][http][R44]") {
    namespace asio = boost::asio;
    namespace http = boost::beast::http;
    if (program().empty()) return;
    const aeolis::test::TemporaryFolder folder;
    std::ofstream{folder / "commands.json"} << R"({"commands":[{"command":"NO_OP"}]})";
    const auto send_to_one_that_says = [&](const std::string& answer, const std::string& options) {
        asio::io_context io;
        asio::ip::tcp::acceptor acceptor{io, asio::ip::tcp::endpoint{asio::ip::make_address("127.0.0.1"), 0}};
        std::thread other{[&] {
            boost::system::error_code ignored;
            asio::ip::tcp::socket socket{io};
            acceptor.accept(socket, ignored);
            boost::beast::flat_buffer buffer;
            http::request<http::string_body> request;
            http::read(socket, buffer, request, ignored);
            asio::write(socket, asio::buffer(answer), ignored);
        }};
        const auto ended =
            run(program(), fmt::format("send --server http://127.0.0.1:{} --run 7 --file '{}' {}",
                                       acceptor.local_endpoint().port(), (folder / "commands.json").string(), options));
        asio::ip::tcp::socket nobody{io};  // in case that the program asked for nothing
        boost::system::error_code ignored;
        nobody.connect(acceptor.local_endpoint(), ignored);
        nobody.close(ignored);
        other.join();
        return ended;
    };
    const std::string page = "HTTP/1.1 502 Bad Gateway\r\nContent-Length: 6\r\n\r\n<html>";
    for (const auto& [answer, says] : {std::pair<std::string, const char*>{"", "no answer: "},
                                       {page.substr(0, 50), "no answer: "},
                                       {page, "the answer (502) is not one of Aeolis"}}) {
        const auto ended = send_to_one_that_says(answer, "--id mine");
        INFO(answer << " -> " << ended.code << ": " << ended.text);
        CHECK(ended.code == 3);
        CHECK_THAT(ended.text, Catch::Contains(says) &&
                                   Catch::Contains("it is not known whether the commands were taken") &&
                                   Catch::Contains("send the file again with --id mine; "));
        CHECK(std::count(ended.text.begin(), ended.text.end(), '\n') == 1);
    }
    const auto tried = send_to_one_that_says("", "--dry-run");
    CHECK(tried.code == 1);
    CHECK_THAT(tried.text, Catch::Contains("nothing was sent"));
    const auto refused =
        send_to_one_that_says("HTTP/1.1 400 Bad Request\r\nContent-Length: 15\r\n\r\n{\"error\":\"bad\"}", "");
    CHECK(refused.code == 1);
    CHECK_THAT(refused.text, Catch::Contains("refused (400): bad"));
}

TEST_CASE("bad use of the program is answered in one line that names it, with exit code 2", "[cli]") {
    if (program().empty()) return;
    const std::array<std::pair<const char*, const char*>, 25> table{{
        {"frob", "there is no command 'frob'"},
        {"--frob", "there is no option '--frob'"},
        {"timeline frob", "there is no command 'timeline frob'"},
        {"timeline analyse /nope", "/nope"},
        {"archive frob", "there is no command 'archive frob'"},
        {"archive prune --archive /nope", "--run or --keep must name the runs, not both"},
        {"archive samples --run 1", "--out is required"},
        {"export --archive /nope", "--run is required"},
        {"export --run 1 --format xml", "xml not in {csv,jsonl,bin,pcap}"},
        {"export --run 1 --csv --format jsonl", "excludes"},
        {"tones", "subcommand"},
        {"reconstruct --archive /nope", "--run is required"},
        {"rehearse --scenario nominal_auto --seed -1", "not a whole number of at most 15 digits: -1"},
        {"rehearse", "--scenario"},
        {"campaign --scenario campaign", "--cases"},
        {"campaign --scenario campaign --cases 0", "--cases: Value 0 not in range"},
        {"serve --pace 0.5", "neither 0 nor within 1 … 1000: 0.5"},
        {"serve --listen nowhere", "expected ADDRESS:PORT"},
        {"dictionary check /nope", "/nope"},
        {"decode --packets /dev/null", "--xtce"},
        {"send", "--file is required"},
        {"send --file /nope", "--file /nope: it cannot be read"},
        {"send --file /dev/null", "--file /dev/null: "},
        {"decode --xtce /nope --packets /dev/null", "/nope cannot be read"},
        {"decode --xtce /dev/null --packets /dev/null --format frob", "there is no format 'frob'"},
    }};
    for (const auto& [arguments, says] : table) {
        const auto ended = run(program(), arguments);
        INFO(arguments << " -> " << ended.code << ": " << ended.text);
        CHECK(ended.code == 2);
        CHECK_THAT(ended.text, Catch::Contains(says));
        CHECK(std::count(ended.text.begin(), ended.text.end(), '\n') == 1);
    }
}

TEST_CASE("an action of the timeline that flight does not have is told by row, column and the nearest name",
          "[cli][R40]") {
    if (program().empty()) return;
    const aeolis::tests::MissionCopy mission;
    std::string text = mission.text("timeline.csv");
    const auto at = text.find(",vent_coolant,");
    REQUIRE(at != std::string::npos);
    text.replace(at, 14, ",vent_colant,");
    mission.write("timeline.csv", text);
    const auto checked = run(program(), "dictionary check '" + mission.path().string() + "'");
    CHECK(checked.code == 1);
    CHECK(checked.text ==
          fmt::format("timeline.csv:{}: timepoint 'coolant_vent', column action: the flight software has "
                      "no action 'vent_colant'; the nearest name is 'vent_coolant'\n",
                      aeolis::tests::line_at(text, at)));
}

TEST_CASE("each option of serve stands in an environment variable of its name, and the command line counts before it",
          "[cli]") {
    if (program().empty()) return;
    const auto said = run(program(), "serve --help").text;
    for (const char* option : {"scenario", "seed", "pace", "downlink", "xtce", "format", "skip", "frame-octets",
                               "dictionary", "scenarios", "log-level", "listen"}) {
        std::string variable = fmt::format("AEOLIS_{}", option);
        for (char& c : variable) c = c == '-' ? '_' : static_cast<char>(std::toupper(c));
        CHECK_THAT(said, Catch::Contains("(Env:" + variable + ")"));
    }
    CHECK_THAT(said, !Catch::Contains("AEOLIS_CONFIG"));
    CHECK_THAT(run("env", fmt::format("AEOLIS_PACE=0.5 '{}' serve", program())).text,
               Catch::Contains("neither 0 nor within 1 … 1000: 0.5"));
    CHECK_THAT(run("env", fmt::format("AEOLIS_PACE=0.5 '{}' serve --pace 0.7", program())).text,
               Catch::Contains("1000: 0.7"));
    // As if it were typed, with what it needs.
    CHECK_THAT(run("env", fmt::format("AEOLIS_SEED=many '{}' serve", program())).text,
               Catch::Contains("--seed") && Catch::Contains("many"));
    CHECK(run("env", fmt::format("AEOLIS_PACE= '{}' serve --help", program())).code == 0);  // as good as unset
}

TEST_CASE(
    "with log-format=json, by command line, environment or file, each line that the server prints is an object, of "
    "wrong options too",
    "[cli][operation]") {
    if (program().empty()) return;
    const aeolis::test::TemporaryFolder folder;
    const auto settings = folder / "aeolis.conf", wrong = folder / "wrong.conf";
    std::ofstream{settings} << "log-format=json\n";
    std::ofstream{wrong} << "log-format=json\nlog-levell=info\n";
    std::ofstream{folder / "notes.txt"} << std::string(5000, 'x');
    const auto serve = fmt::format("'{}' serve --archive '{}' ", program(), (folder / "a.db").string());
    for (const auto& line : {
             serve + "--log-format json --listen nonsense",
             serve + "--log-format=json --nonsense 1",
             serve + "--log-format json --pace 0.5",
             serve + "--log-format json --scenario none_of_this_name",
             serve + "--log-format json --dictionary /nonexistent",
             serve + "--log-format json --archive '" + (folder / "notes.txt").string() + "'",
             serve + "--config '" + settings.string() + "' --listen 0.0.0.0:0",
             serve + "--config '" + wrong.string() + "'",
             "AEOLIS_LOG_FORMAT=json " + serve + "--listen nowhere",
             serve + "--log-format json --accounts '" + (folder / "accounts.json").string() +
                 "' --listen 127.0.0.1:0 --scenario nominal --pace 1000 & server=$!; sleep 1; kill -TERM $server; wait "
                 "$server",
         }) {
        std::ofstream{folder / "line.sh"} << line << '\n';
        const auto ended = run("sh", "'" + (folder / "line.sh").string() + "'");
        INFO(line << " -> " << ended.code << ": " << ended.text);
        CHECK(!ended.text.empty());
        std::istringstream lines{ended.text};
        for (std::string each; std::getline(lines, each);) {
            google::protobuf::Struct object;
            INFO(each);
            REQUIRE(aeolis::server::from_json(each, object));
            for (const char* field : {"time", "level", "message"}) CHECK(object.fields().contains(field));
        }
    }
}

TEST_CASE("a settings file may name several hosts with commas between, and a path with blanks and commas",
          "[cli][http]") {
    if (program().empty()) return;
    using aeolis::test::web_request;
    const aeolis::test::TemporaryFolder folder;
    const auto archive = folder / "the archive, of today" / "a.db";
    const auto settings = folder / "aeolis.conf";
    std::ofstream{settings} << "# ours\nlisten=127.0.0.1:0\nhost=first.example,second.example\narchive="
                            << archive.string() << '\n';
    const auto output = folder / "said";
    aeolis::test::ChildProcess server{{program(), "serve", "--config", settings.string()}, output};
    const auto said = [&] {
        std::ifstream in{output};
        return std::string{std::istreambuf_iterator<char>{in}, {}};
    };
    const auto says = [&](const char* words) {
        for (int tries = 0; tries < 6000 && said().find(words) == std::string::npos; ++tries) {
            if (!server.running()) break;
            std::this_thread::sleep_for(std::chrono::milliseconds{10});
        }
        INFO(said());
        CHECK_THAT(said(), Catch::Contains(words));
    };
    says("end with Ctrl-C");
    unsigned port = 0;
    const auto address = said();
    const auto at = address.find("Aeolis is at ");
    REQUIRE(at != std::string::npos);
    REQUIRE(std::sscanf(address.c_str() + at, "Aeolis is at http://127.0.0.1:%u/", &port) == 1);
    const auto status = [&](const char* host) {
        return web_request(static_cast<std::uint16_t>(port), "GET", "/healthz", {}, {{"Host", host}}).status;
    };
    CHECK(status("first.example") == 200);
    CHECK(status("second.example") == 200);
    CHECK(status("third.example") == 403);
    CHECK(std::filesystem::exists(archive));
    // SIGHUP reads the log level again, and a level that is none leaves the one of before.
    std::ofstream{settings, std::ios::app} << "log-level=loud\n";
    server.signal(SIGHUP);
    says("asked to read certificate, accounts and log level again");
    says("log-level: 'loud' is none of debug, info, warn, error; it stays");
    CHECK(status("first.example") == 200);
    server.signal(SIGTERM);
    CHECK(server.ended_within() == 0);
    CHECK_THAT(said(), Catch::Contains("asked to end: ending"));
}

TEST_CASE("the program forecasts from any moment, side by side with what is assumed, and refuses the rest in one line",
          "[cli][shadow]") {
    if (program().empty()) return;
    const std::string landing = "forecast --scenario nominal_auto --cases 2 --at ";
    const auto lost = run(program(), landing + R"(E+420 --fault '{"computer_reset": true}')");
    CHECK(lost.code == 0);
    CHECK_THAT(lost.text, Catch::StartsWith("from the truth of nominal_auto, seed 1, at E+420.0 s: 2 cases"));
    CHECK_THAT(lost.text, Catch::Contains("case by case: within limits in both 0, only without 2"));
    CHECK_THAT(lost.text, Catch::Contains("\nwith, case 1: impact: ") && Catch::Contains(" (2 cases)\n"));
    const auto json = run(program(), landing + "E+420 --json");
    google::protobuf::Struct object;
    REQUIRE(aeolis::server::from_json(json.text, object));
    CHECK(object.fields().at("from").string_value() == "truth");
    CHECK(object.fields().at("without").struct_value().fields().at("cases").number_value() == 2.0);
    CHECK_FALSE(object.fields().contains("with"));

    const std::array<std::tuple<std::string, int, const char*>, 7> refused{{
        {"E+-420", 2, "--at: 'E+-420' is not seconds from entry, like E-600 or E+200"},
        {"420", 2, "--at: '420' is not seconds from entry"},
        {"E-9000", 1, "--at E-9000: nominal_auto begins at E-"},
        {"E+900", 1, "the landing of nominal_auto with seed 1 is over by then: touchdown"},
        {"E+420 --command NO_OPS", 1, "NO_OPS is refused: unknown command 'NO_OPS'"},
        {"E+420 --command 'NO_OP {'", 2, "--command NO_OP: "},
        {R"(E+420 --fault '{"gremlin": true}')", 2, "gremlin"},
    }};
    for (const auto& [arguments, code, says] : refused) {
        const auto ended = run(program(), landing + arguments);
        INFO(arguments << " -> " << ended.code << ": " << ended.text);
        CHECK(ended.code == code);
        CHECK_THAT(ended.text, Catch::Contains(says));
        CHECK(std::count(ended.text.begin(), ended.text.end(), '\n') == 1);
    }
}

TEST_CASE("the entry reference is a table of falling speed, with every row a number", "[cli][R27]") {
    if (program().empty()) return;
    const auto ended = run(program(), "entry reference --scenario od137");
    REQUIRE(ended.code == 0);
    std::istringstream lines{ended.text};
    std::string line;
    std::getline(lines, line);
    CHECK(line == "velocity_mps,range_to_go_m,drag_mps2,altitude_rate_mps,d_range_d_drag_s2,d_range_d_altitude_rate_s,"
                  "d_range_d_lift_to_drag_m,lift_to_drag");
    double last_mps = 0.0, farthest_m = 0.0;
    int rows = 0;
    for (; std::getline(lines, line); ++rows) {
        double velocity_mps = 0.0, range_m = 0.0, drag_mps2 = 0.0;
        REQUIRE(std::sscanf(line.c_str(), "%lf,%lf,%lf", &velocity_mps, &range_m, &drag_mps2) == 3);
        CHECK(std::count(line.begin(), line.end(), ',') == 7);
        CHECK(velocity_mps > last_mps);
        CHECK(range_m > farthest_m);
        last_mps = velocity_mps;
        farthest_m = range_m;
    }
    CHECK(rows == static_cast<int>(aeolis::flight::EntryReference{}.rows.size()));
}

TEST_CASE("a landing's archive is verified, exported, backed up, tabulated and pruned by the program",
          "[cli][archive][R43]") {
    if (program().empty()) return;
    const auto folder = std::filesystem::temp_directory_path() / ("aeolis-archive-" + std::to_string(getpid()));
    std::filesystem::create_directories(folder);
    const auto in = [&](const char* name) { return (folder / name).string(); };
    const auto says = [&](const std::string& arguments, const char* text) {
        const auto ended = run(program(), arguments);
        INFO(arguments << " -> " << ended.code << ": " << ended.text.substr(0, 2000));
        CHECK(ended.code == 0);
        CHECK_THAT(ended.text, Catch::Contains(text));
        return ended.text;
    };
    REQUIRE(run(program(), "rehearse --scenario nominal_auto --archive " + in("a.db")).code == 0);
    says("archive backup --archive " + in("a.db") + " --out " + in("b.db"), "all of ");
    says("archive verify --archive " + in("b.db"), "nothing wrong");
    says("archive compare --archive " + in("a.db") + " --with " + in("b.db"), "the same ");
    const auto rows = says("export --run 1 --channel altitude_m speed_mps --csv --archive " + in("b.db"),
                           "sclk,e_s,channel,value,unit,source\n");
    const auto objects = says("export --run 1 --channel altitude_m speed_mps --format jsonl --archive " + in("b.db"),
                              R"("channel":"altitude_m")");
    CHECK(std::count(rows.begin(), rows.end(), '\n') == std::count(objects.begin(), objects.end(), '\n') + 1);
    for (const char* names : {"--channel altitude_m --channel speed_mps", "--channel altitude_m,speed_mps",
                              "--channels altitude_m,speed_mps --format csv"})
        CHECK(run(program(), fmt::format("export --run 1 {} --archive {}", names, in("b.db"))).text == rows);
    const auto aligned = says("export --run 1 --channel altitude_m speed_mps --align 1 --archive " + in("b.db"),
                              "sclk,e_s,altitude_m,speed_mps\n");
    CHECK(std::count(aligned.begin(), aligned.end(), '\n') > 100);
    says("archive samples --run 1 --channel altitude_m speed_mps --archive " + in("b.db") + " --out " +
             in("samples.db"),
         (std::to_string(std::count(objects.begin(), objects.end(), '\n')) + " samples of run 1").c_str());
    says("archive rebuild --archive " + in("b.db"), "run 1: rebuilt from its packets");
    CHECK(run(program(), "export --run 1 --channel altitude_m speed_mps --archive " + in("b.db")).text == rows);
    says("archive prune --keep 0 --archive " + in("b.db"), "1 of 1 runs would be removed; --yes removes them");
    says("archive prune --keep 0 --yes --archive " + in("b.db"), "1 of 1 runs removed");
    says("archive vacuum --archive " + in("b.db"), "octets, before");
    CHECK(run(program(), "export --run 1 --archive " + in("b.db")).code == 1);
    std::filesystem::remove_all(folder);
}

TEST_CASE("the program rebuilds a landing's path from its archive", "[cli][archive][R52]") {
    if (program().empty()) return;
    const aeolis::test::TemporaryFolder folder;
    const auto in = [&](const char* name) { return (folder / name).string(); };
    REQUIRE(run(program(), "rehearse --scenario nominal_auto --archive " + in("a.db")).code == 0);
    const std::string of = "reconstruct --run 1 --archive " + in("a.db");
    const auto rebuilt = run(program(), of + " --out " + in("path.csv"));
    INFO(rebuilt.text);
    CHECK(rebuilt.code == 0);
    for (const char* words : {"ImuTable", "most in a second", "TOUCHDOWN", " 0 missing and filled, 0 gaps"})
        CHECK_THAT(rebuilt.text, Catch::Contains(words));
    CHECK_THAT(rebuilt.text, !Catch::Contains("does not cover"));
    std::ifstream path{in("path.csv")};
    std::string line;
    REQUIRE(std::getline(path, line));
    CHECK_THAT(line, Catch::StartsWith("e_s,sclk,p_x_m,"));
    REQUIRE(std::getline(path, line));
    CHECK_THAT(line, Catch::StartsWith("-2"));
    int rows = 1;
    while (std::getline(path, line)) ++rows;
    CHECK(rows > 8 * 440);

    CHECK_THAT(rebuilt.text, Catch::Contains("density by drag") && Catch::Contains("(last known)"));

    // The place of the rover, as a rehearsal's score has it: the path is known better by it.
    CHECK_THAT(rebuilt.text, Catch::Contains("--site says where the rover stands"));
    const auto sited = run(program(), of + " --site -4.652140 137.471081 3391148");
    INFO(sited.text);
    CHECK(sited.code == 0);
    CHECK_THAT(sited.text, !Catch::Contains("--site says"));

    // One line each, and nothing is written.
    const std::array<std::tuple<std::string, int, std::string>, 9> refused{{
        {of + " --out " + in("path.csv"), 1, "path.csv is there already"},
        {of + " --out " + in("no/path.oem"), 1, "cannot be written: there is no folder"},
        {of + " --out " + in("path.txt"), 2, "ends neither in .csv nor in .oem, .aem, .bsp, .bc or .tsc"},
        {of + " --site 4 5", 2, "--site"},
        {of + " --site-sigma 3", 2, "--site-sigma requires --site"},
        {of + " --site -4.6 12.0 3391148", 1, "the landing site is 6"},
        {of + " --site -4.652140 137.471081 3391.148", 1, "km from where the path ends"},
        {"reconstruct --run 2 --archive " + in("a.db"), 1, "reconstruct: no run 2"},
        {"reconstruct --run 1 --archive " + in("b.db"), 1, "b.db: unable to open database file"},
    }};
    for (const auto& [arguments, code, says] : refused) {
        const auto ended = run(program(), arguments);
        INFO(arguments << " -> " << ended.code << ": " << ended.text);
        CHECK(ended.code == code);
        CHECK_THAT(ended.text, Catch::Contains(says));
        CHECK(std::count(ended.text.begin(), ended.text.end(), '\n') == 1);
    }
}

TEST_CASE("a rebuilt path leaves in each format of the field, and lies on itself when it is laid over its run",
          "[cli][archive][spice][R52]") {
    if (program().empty()) return;
    const aeolis::test::TemporaryFolder folder;
    const auto in = [&](const std::string& name) { return (folder.path() / name).string(); };
    REQUIRE(run(program(), "rehearse --scenario nominal_auto --archive " + in("a.db")).code == 0);
    const std::string of = " --run 1 --archive " + in("a.db");
    const std::array<std::pair<const char*, const char*>, 5> formats{{{"oem", "CCSDS_OEM_VERS = 2.0"},
                                                                      {"aem", "CCSDS_AEM_VERS = 2.0"},
                                                                      {"bsp", "DAF/SPK"},
                                                                      {"bc", "DAF/CK"},
                                                                      {"tsc", "KPL/SCLK"}}};
    const auto text_of = [](const std::string& file) {
        std::ifstream from{file, std::ios::binary};
        return std::string{std::istreambuf_iterator<char>{from}, {}};
    };
    for (const auto& [ending, begins] : formats) {
        const std::string file = in(std::string{"path."} + ending);
        const auto made = run(program(), "reconstruct" + of + " --out " + file);
        INFO(made.text);
        CHECK(made.code == 0);
        CHECK_THAT(text_of(file), Catch::StartsWith(begins));
    }
    CHECK_THAT(run(program(), "reconstruct" + of + " --out " + in("clock.tsc")).text,
               Catch::Contains("The run's clock is in "));

    // The path over itself: what is left is a kernel's own interpolation. What flight navigated is off by its errors.
    for (const char* file : {"path.oem", "path.bsp"}) {
        const auto over = run(program(), "overlay --rebuilt" + of + " --with " + in(file));
        INFO(over.text);
        CHECK(over.code == 0);
        CHECK_THAT(over.text, Catch::Contains("Apart: 0.0 m root mean square"));
        CHECK_THAT(over.text, Catch::Contains("TOUCHDOWN"));
        const auto flown = run(program(), "overlay" + of + " --with " + in(file) + " --out " + in(file) + ".csv");
        INFO(flown.text);
        CHECK(flown.code == 0);
        CHECK_THAT(flown.text, !Catch::Contains("Apart: 0.0 m") && Catch::Contains("BACKSHELL_SEPARATION"));
        CHECK_THAT(text_of(in(file) + ".csv"), Catch::StartsWith("e_s,sclk,up_m,along_m,right_m,speed_mps\n"));
    }

    const std::string oem = text_of(in("path.oem"));
    const auto spoilt = [&](const char* name, const std::string& from, const std::string& to) {
        std::string text = oem;
        for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
            text.replace(at, from.size(), to);
        std::ofstream{in(name), std::ios::binary} << text;
        return in(name);
    };
    const auto first_row = oem.find("\n2012-");
    REQUIRE(first_row != std::string::npos);
    const auto number_at = oem.find(' ', first_row);
    const auto first_number = oem.substr(number_at, oem.find(' ', number_at + 1) - number_at);
    std::ofstream{in("cut.bsp"), std::ios::binary} << text_of(in("path.bsp")).substr(0, 3000);
    const std::array<std::tuple<std::string, int, std::string>, 12> refused{{
        {spoilt("earth.oem", "= MARS", "= EARTH"), 1, "but: MSL about EARTH in EME2000"},
        {spoilt("frame.oem", "= EME2000", "= ITRF97"), 1, "but: MSL about MARS in ITRF97"},
        {spoilt("later.oem", "2012-08-06T", "2022-08-06T"), 1, "no instant is in both"},
        {spoilt("text.oem", first_number, " nan451.5"), 1, "is no number"},
        {spoilt("centre.oem", "CENTER_NAME", "COMMENT"), 1, "the segment has no CENTER_NAME"},
        {in("cut.bsp"), 1, "cut.bsp: "},
        {in("path.aem"), 1, "the message begins with CCSDS_AEM_VERS, not CCSDS_OEM_VERS"},
        {in("path.bc"), 1, "is a kernel of the kind CK, not SPK"},
        {in("path.tsc"), 1, "path.tsc: "},
        {in("none.oem"), 1, "none.oem is not there"},
        {folder.path().string(), 1, "is a folder, not a trajectory"},
        {in("path.oem") + " --out " + in("path.bsp"), 1, "path.bsp is there already"},
    }};
    for (const auto& [with, code, says] : refused) {
        const auto ended = run(program(), "overlay" + of + " --with " + with);
        INFO(with << " -> " << ended.code << ": " << ended.text);
        CHECK(ended.code == code);
        CHECK_THAT(ended.text, Catch::Contains(says));
        CHECK(std::count(ended.text.begin(), ended.text.end(), '\n') == 1);
    }
    // One of another day is laid over from entry to entry.
    const auto later = run(program(), "overlay --rebuilt --by-entry" + of + " --with " + in("later.oem"));
    INFO(later.text);
    CHECK(later.code == 0);
    CHECK_THAT(later.text, Catch::Contains("from entry to entry") && Catch::Contains("Apart: "));
}

TEST_CASE("each question in SQL of docs/archive.md is answered on a landing that was flown", "[cli][archive][R43]") {
    if (program().empty()) return;
    const aeolis::test::TemporaryFolder folder;
    const auto archive = (folder / "a.db").string();
    REQUIRE(run(program(), "rehearse --scenario nominal_auto --archive " + archive).code == 0);
    auto database = aeolis::archive::sqlite::Database::open(archive, aeolis::archive::sqlite::Mode::read_only);
    REQUIRE(database.ok());
    std::ifstream page{AEOLIS_SOURCE_DIR "/docs/archive.md"};
    const std::string text{std::istreambuf_iterator<char>{page}, {}};
    std::size_t questions = 0;
    for (auto at = text.find("```sql\n"); at != std::string::npos; at = text.find("```sql\n", at)) {
        const auto begin = at + std::string_view{"```sql\n"}.size();
        at = text.find("\n```", begin);
        std::istringstream block{text.substr(begin, at - begin)};
        for (std::string question; std::getline(block, question, ';');) {
            if (question.find_first_not_of(" \n") == std::string::npos) continue;
            ++questions;
            INFO(question);
            auto statement = database->prepare(question.c_str());
            REQUIRE(statement.ok());
            const auto row = statement->step();
            REQUIRE(row.ok());
            // Nobody wrote a note, acted on a procedure or took a position, nothing waited for a person, and every live
            // unit is as it was recorded.
            const bool of_people = question.find("shift_log") != std::string::npos ||
                                   question.find("procedure_log") != std::string::npos ||
                                   question.find("position_log") != std::string::npos ||
                                   question.find("command_wait_log") != std::string::npos;
            CHECK(*row == !(of_people || question.find("r.octets <> u.octets") != std::string::npos));
        }
    }
    CHECK(questions >= 12);
}

TEST_CASE(
    "a landing is reported as it was flown, each timepoint and event by plan, tone, UHF and recording, which agree",
    "[cli][archive][R41][R43]") {
    if (program().empty()) return;
    const auto folder = std::filesystem::temp_directory_path() / ("aeolis-report-" + std::to_string(getpid()));
    std::filesystem::create_directories(folder);
    const std::string archive = (folder / "a.db").string();
    REQUIRE(run(program(), "rehearse --scenario nominal_auto --archive " + archive).code == 0);
    const auto printed = run(program(), "report --run 1 --archive " + archive);
    CHECK(printed.code == 0);
    CHECK_THAT(printed.text, Catch::Contains("nominal_auto, seed 1, touchdown"));
    CHECK_THAT(printed.text, Catch::Contains("0 differ, 0 are missing in it, 0 wait for it"));
    CHECK_THAT(printed.text, Catch::Contains("Command 2 EDL_DO_EDL"));
    CHECK_THAT(printed.text, Catch::Contains("  landing       30.0 of 30.0  touchdown"));

    aeolis::v1::AsFlownReport report;
    const auto json = run(program(), "report --json --run 1 --archive " + archive);
    const auto parsed = aeolis::server::from_json(json.text, report);
    INFO((parsed ? std::string{} : parsed.error().message));
    REQUIRE(parsed);
    CHECK(report.run().outcome() == aeolis::v1::Landing::touchdown);
    CHECK(report.proof().recording_complete());
    CHECK(report.silences_size() > 0);
    int by_tone = 0, live = 0, predicted = 0;
    for (const auto& row : report.timepoints()) {
        INFO(row.name());
        CHECK(row.has_recorded_e_s());
        if (row.has_realtime_e_s()) CHECK(row.realtime_e_s() == row.recorded_e_s());
        if (row.has_planned_e_s() && row.planned_e_s() > -900.0)
            CHECK(row.recorded_e_s() == Approx(row.planned_e_s()).margin(1.0));
        // The design's landing, from the entry that the vehicle kept to: seconds off once drag and winds have had their
        // say.
        if (row.has_predicted_e_s())
            CHECK(row.recorded_e_s() == Approx(row.predicted_e_s()).margin(row.has_planned_e_s() ? 1.0 : 15.0));
        predicted += row.has_predicted_e_s() ? 1 : 0;
        if (row.has_tone_e_s()) CHECK(std::abs(row.tone_e_s() - row.recorded_e_s()) < 15.0);
        if (row.has_margin_s()) CHECK(row.margin_s() > -1.0 / 64.0);
        by_tone += row.has_tone_e_s() ? 1 : 0;
        live += row.has_realtime_e_s() ? 1 : 0;
    }
    CHECK(by_tone > 10);
    CHECK(live > 20);
    std::map<std::string, const aeolis::v1::AsFlownEvent*> events;
    double last_e_s = -1.0e9;
    for (const auto& event : report.events()) {
        INFO(event.name());
        CHECK(events.emplace(event.name(), &event).second);  // no name twice
        if (event.name().starts_with("seen_by_doppler")) {   // made on ground: the vehicle has not recorded it
            CHECK(event.has_realtime_e_s());
            CHECK_FALSE(event.has_recorded_e_s());
            CHECK(event.realtime_e_s() >= last_e_s);
            last_e_s = event.realtime_e_s();
            continue;
        }
        CHECK(event.has_recorded_e_s());
        if (event.has_realtime_e_s()) CHECK(event.realtime_e_s() == event.recorded_e_s());
        CHECK(event.recorded_e_s() >= last_e_s);
        CHECK_FALSE(event.text().empty());
        last_e_s = event.recorded_e_s();
    }
    for (const char* name :
         {"guidance_start", "bank_reversal_1", "bank_reversal_2", "bank_reversal_3", "peak_deceleration",
          "heading_alignment", "sufr_start", "radar_lock", "powered_approach_start", "constant_velocity_start",
          "constant_deceleration_start", "sky_crane_start", "touchdown", "flyaway_end"}) {
        INFO(name);
        REQUIRE(events.contains(name));
        CHECK_THAT(printed.text, Catch::Contains(std::string{"\n"} + name + " "));
    }
    CHECK(events.count("parachute_deploy") == 1);  // GNC's word; the timepoint of that name reports nothing itself
    CHECK(events.count("bridle_cut") == 0);        // the timepoint's own
    CHECK(events.at("touchdown")->predicted_e_s() == 431.47);
    CHECK(std::abs(events.at("touchdown")->recorded_e_s() - 431.47) < 15.0);
    const auto csv = run(program(), "report --csv --run 1 --archive " + archive).text;
    CHECK_THAT(csv, Catch::StartsWith("of,name,planned_e_s,predicted_e_s,tone_e_s,realtime_e_s,recorded_e_s,margin_s,"
                                      "tone,verdict,text\ntimepoint,") &&
                        Catch::Contains("\nevent,touchdown,,431.470000,"));
    CHECK(std::count(csv.begin(), csv.end(), '\n') == 1 + report.timepoints_size() + report.events_size());
    const auto why = run(program(), "report --explanations --run 1 --archive " + archive);
    CHECK(why.code == 0);
    std::istringstream decisions{why.text};
    double before_e_s = -1.0e9;
    for (std::string line; std::getline(decisions, line);) {
        INFO(line);
        double e_s = 0.0;
        REQUIRE(std::sscanf(line.c_str(), " E%lf ", &e_s) == 1);
        CHECK(e_s >= before_e_s);
        // Names are words; a command has its mnemonic.
        if (line.find("  command ") == std::string::npos) CHECK(line.find('_') == std::string::npos);
        before_e_s = e_s;
    }
    for (const char* text : {"EDL_DO_EDL accepted: parameters received: yes; ", "parachute deploy decided: speed ",
                             "bank reversal 1 decided: crossrange ", "GNC mode changed to range control: "})
        CHECK_THAT(why.text, Catch::Contains(text));
    CHECK(predicted >= report.timepoints_size() - 1);  // not the first: it counts from "do edl"
    CHECK(report.run().clock().version() == 1);
    CHECK(report.run().clock().scet() == "2012-219T05:10:47.400");
    CHECK_THAT(run(program(), "report --run 9 --archive " + archive).text, Catch::Contains("no run 9"));
    std::filesystem::remove_all(folder);
}

TEST_CASE("the truth of a landing is written in even rows to where it stands", "[cli]") {
    if (program().empty()) return;
    const auto file = std::filesystem::temp_directory_path() / ("aeolis-truth-" + std::to_string(getpid()) + ".csv");
    REQUIRE(run(program(), "rehearse --scenario gnc_alone --truth " + file.string()).code == 0);
    std::ifstream rows{file};
    std::string line;
    std::getline(rows, line);
    CHECK(line.rfind("e_s,altitude_m,speed_mps,flight_path_deg,", 0) == 0);
    const auto commas = std::count(line.begin(), line.end(), ',');
    CHECK(commas == 13);
    double before_s = 0.0, e_s = 0.0, altitude_m = 0.0, speed_mps = 0.0;
    for (int row = 0; std::getline(rows, line); ++row, before_s = e_s) {
        REQUIRE(std::sscanf(line.c_str(), "%lf,%lf,%lf", &e_s, &altitude_m, &speed_mps) == 3);
        CHECK(std::count(line.begin(), line.end(), ',') == commas);
        if (row > 0) CHECK(e_s - before_s == Approx(1.0 / 16.0).margin(1e-5));
    }
    CHECK(altitude_m < 1000.0);  // the stage, on its way off
    std::filesystem::remove(file);
}

TEST_CASE("what cannot be done is answered in one line, with exit code 1", "[cli]") {
    if (program().empty()) return;
    const aeolis::test::TemporaryFolder folder;
    std::ofstream{folder / "commands.json"} << R"({"commands":[{"command":"NO_OP"}]})";
    const std::string nobody = "send --server http://127.0.0.1:1 --file '" + (folder / "commands.json").string() + "'";
    const std::string no_url = "send --server ftp://host --file '" + (folder / "commands.json").string() + "'";
    for (const auto& [arguments, says] : std::array<std::pair<const char*, const char*>, 10>{{
             {"rehearse --scenario no_such", "no_such"},
             {"entry reference --scenario no_such", "no_such"},
             {"rehearse --scenario gnc_alone --truth /nope/truth.csv", "/nope/truth.csv"},
             {"rehearse --scenario " AEOLIS_SOURCE_DIR
              "/simulation/scenarios/od137.textproto --truth " AEOLIS_SOURCE_DIR
              "/simulation/scenarios/../scenarios/od137.textproto",
              "would be overwritten"},
             {"rehearse --scenario nominal_auto --archive /dev/null", "/dev/null"},
             {"campaign --scenario campaign --cases 2 --results /dev/null", "/dev/null"},
             {"campaign --scenario performance --cases 2", "performance: test_venue: "},
             {"serve --listen 192.0.2.1:0 --archive /dev/null", "loopback only"},
             {nobody.c_str(), "http://127.0.0.1:1: no connection: "},
             {no_url.c_str(), "--server ftp://host: expected http://HOST:PORT or https://HOST:PORT"},
         }}) {
        const auto ended = run(program(), arguments);
        INFO(arguments << " -> " << ended.code << ": " << ended.text);
        CHECK(ended.code == 1);
        CHECK_THAT(ended.text, Catch::Contains(says));
        CHECK(std::count(ended.text.begin(), ended.text.end(), '\n') == 1);
    }
}

TEST_CASE("the program proves the shipped timeline, and shows what two versions differ in",
          "[cli][timeline][R19][R20]") {
    if (program().empty()) return;
    const std::filesystem::path shipped = std::filesystem::path{AEOLIS_SOURCE_DIR} / "dictionaries/msl";
    const auto proven = run(program(), "timeline analyse '" + shipped.string() + "'");
    CHECK(proven.code == 0);
    CHECK_THAT(proven.text, Catch::Contains("bounds are proven"));
    CHECK(run(program(), "timeline diff '" + shipped.string() + "' '" + shipped.string() + "'").code == 0);

    const auto other = std::filesystem::temp_directory_path() / ("aeolis_cli_" + std::to_string(getpid()));
    std::filesystem::copy(shipped, other);
    std::string text;
    {
        std::ifstream csv{shipped / "timeline.csv"};
        text.assign(std::istreambuf_iterator<char>{csv}, {});
    }
    const std::string row = "uhf_start,entry,-800,";
    REQUIRE(text.find(row) != std::string::npos);
    std::ofstream{other / "timeline.csv"} << text.replace(text.find(row), row.size(), "uhf_start,entry,-790,");
    const auto changed = run(program(), "timeline diff '" + shipped.string() + "' '" + other.string() + "'");
    std::filesystem::remove_all(other);
    CHECK(changed.code == 1);
    CHECK_THAT(changed.text, Catch::Contains("desired_offset_s: -800 -> -790"));
}

// Times count for the program as it is built to be used, not for one that sanitizers watch.
TEST_CASE("in the venue performance a whole landing keeps every budget of time and stack",
          "[.long][cli][R8][R36][R37]") {
    if (program().empty()) return;
    const auto ended = run(program(), "rehearse --scenario performance --seed 1 --json");
    INFO(ended.text);
    REQUIRE(ended.code == 0);
    google::protobuf::Struct report;
    REQUIRE(aeolis::server::from_json(ended.text, report));
    CHECK(report.fields().at("outcome").string_value() == "touchdown");
    const auto& together = report.fields().at("all_tasks").struct_value().fields();
    CHECK(together.at("worst_us").number_value() <= together.at("cycle_us").number_value());
    for (const auto& value : report.fields().at("tasks").list_value().values()) {
        const auto& task = value.struct_value().fields();
        INFO(task.at("task").string_value());
        CHECK(task.at("p999_us").number_value() <= task.at("budget_us").number_value());
        CHECK(task.at("stack_octets").number_value() <= task.at("stack_bound_octets").number_value());
    }
}

TEST_CASE("the program writes the command file that changes parameters, with the CRC that flight wants",
          "[cli][parameters][R25][R48]") {
    if (program().empty()) return;
    const aeolis::test::TemporaryFolder folder;
    const auto crc_after = [](std::initializer_list<std::pair<std::string, double>> changes) {
        aeolis::commands::ParameterTable table{aeolis::tests::shipped_dictionary()};
        for (const auto& [name, value] : changes)
            REQUIRE(table.set(std::ranges::find(aeolis::tests::shipped_dictionary().parameters, name,
                                                &aeolis::dictionary::ParameterRow::name)
                                  ->id,
                              value));
        return fmt::format("\"parameter_crc\", \"value\": {}}}", table.crc());
    };
    const auto first = run(program(), "parameters --table 1 guidance_gain=4.25 constant_velocity_mps=31");
    INFO(first.text);
    CHECK(first.code == 0);
    CHECK_THAT(first.text, Catch::StartsWith("{\"commands\": [\n  {\"command\": \"EDL_DISCARD_PARAMETERS\"},\n") &&
                               Catch::Contains("\"value\", \"value\": 4.25}") &&
                               Catch::Contains("\"parameter_changes\", \"value\": 2}") &&
                               Catch::Contains(crc_after({{"guidance_gain", 4.25}, {"constant_velocity_mps", 31.0}})));
    std::ofstream{folder / "first.json"} << first.text;
    const auto second =
        run(program(), "parameters --table 2 --after '" + (folder / "first.json").string() + "' guidance_gain=5");
    CHECK(second.code == 0);
    CHECK_THAT(second.text, Catch::Contains(crc_after({{"constant_velocity_mps", 31.0}})));  // 5 as built
    // The vehicle of a scenario may be loaded with others.
    std::ofstream{folder / "other.textproto"} << "name: \"other\"\nlike: \"nominal\"\n"
                                                 "parameters { name: \"constant_velocity_mps\" value: 31 }\n";
    const auto other = run(program(), "parameters --table 1 --scenario '" + (folder / "other.textproto").string() +
                                          "' guidance_gain=4.25");
    CHECK(other.code == 0);
    CHECK_THAT(other.text, Catch::Contains(crc_after({{"guidance_gain", 4.25}, {"constant_velocity_mps", 31.0}})));
    // What it is loaded with goes by the rows of flight's own dictionary.
    std::filesystem::copy(AEOLIS_SOURCE_DIR "/dictionaries/msl", folder / "dictionary");
    std::ofstream{folder / "dictionary" / "parameters.csv", std::ios::app}
        << "one_more,0,0,1,build,1,Fixed: of another build,[chosen]\n";
    const auto foreign =
        run(program(), "parameters --table 1 --dictionary '" + (folder / "dictionary").string() + "' --scenario '" +
                           (folder / "other.textproto").string() + "' guidance_gain=4.25");
    CHECK(foreign.code == 2);
    CHECK_THAT(foreign.text, Catch::Contains("is not the one that flight was built from"));
    const std::vector<std::pair<std::string, std::string>> wrong{
        {"--scenario /nope.textproto guidance_gain=4", "--scenario /nope.textproto: cannot be opened"},
        {"guidance_gain=400", "guidance_gain: 400 is outside 1 to 10"},
        {"guidance_gian=4", "parameters.csv has no parameter 'guidance_gian'"},
        {"guidance_gain=4 guidance_gain=5", "named twice"},
        {"guidance_gain=1 constant_velocity_mps=31", "the changes together are too large"},
        {"guidance_gain=four", "the value is no number"},
        {"guidance_gain", "a change is NAME=VALUE"},
        {"entry_moved_max_s=5", "entry_moved_max_s is fixed when flight is built"},
        {"--after /nope guidance_gain=4", "--after /nope: it cannot be read"}};
    for (const auto& [arguments, why] : wrong) {
        const auto told = run(program(), "parameters --table 3 " + arguments);
        INFO(told.text);
        CHECK(told.code == 2);
        CHECK_THAT(told.text, Catch::Contains(why));
    }
}

TEST_CASE("the explanations in docs are those that the program prints", "[release][cli][explanation][R38]") {
    if (program().empty()) return;
    const aeolis::test::TemporaryFolder folder;
    const std::string archive = "'" + (folder / "landing.db").string() + "'";
    REQUIRE(run(program(), "rehearse --scenario nominal_auto --seed 1 --archive " + archive).code == 0);
    const auto printed = run(program(), "report --explanations --run 1 --archive " + archive);
    REQUIRE(printed.code == 0);
    const std::string page = AEOLIS_SOURCE_DIR "/docs/explanations.md";
    std::ostringstream read;
    read << std::ifstream{page}.rdbuf();
    std::string text = read.str();
    const std::string fence = "```text\n";
    const auto begin = text.find(fence) + fence.size(), end = text.find("```", begin);
    REQUIRE(end != std::string::npos);
    // To renew the page: AEOLIS_RENEW_EXPLANATIONS=1
    if (std::getenv("AEOLIS_RENEW_EXPLANATIONS") != nullptr)
        std::ofstream{page} << text.replace(begin, end - begin, printed.text);
    else
        CHECK(text.substr(begin, end - begin) == printed.text);
}

}  // namespace server_cli_test
