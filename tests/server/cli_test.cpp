#include "aeolis/v1/run.pb.h"
#include "common/proximity_frame.hpp"
#include "common/space_packet.hpp"
#include "flight/load.hpp"
#include "server/api/json.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/kernels.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <google/protobuf/struct.pb.h>
#include <iostream>
#include <memory>
#include <sstream>
#include <string>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>

// The program as people start it: what it says, on one line, and how it ends.
namespace {

struct Ended {
    int code = -1;
    std::string text; ///< of both streams
};

Ended run(const std::string& program, const std::string& arguments) {
    std::FILE* pipe = popen(("'" + program + "' " + arguments + " 2>&1 </dev/null").c_str(), "r");
    REQUIRE(pipe != nullptr);
    Ended ended;
    std::array<char, 4096> chunk{};
    for (std::size_t read = 0; (read = std::fread(chunk.data(), 1, chunk.size(), pipe)) > 0;)
        ended.text.append(chunk.data(), read);
    const int status = pclose(pipe);
    ended.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return ended;
}

/// Built beside the tests, by another build type: ./test says where.
const char* program() {
    const char* given = std::getenv("AEOLIS_PROGRAM");
    if (given == nullptr) std::cout << "SKIPPED: AEOLIS_PROGRAM does not name the program to try\n";
    return given;
}

} // namespace

TEST_CASE("bad use of the program is answered in one line that names it, with exit code 2", "[cli]") {
    if (program() == nullptr) return;
    const std::array<std::pair<const char*, const char*>, 20> table{{
        {"frob", "there is no command 'frob'"},
        {"--frob", "there is no option '--frob'"},
        {"timeline frob", "there is no command 'timeline frob'"},
        {"timeline analyse /nope", "/nope"},
        {"archive frob", "there is no command 'archive frob'"},
        {"archive prune --archive /nope", "either --run or --keep says which runs go"},
        {"archive samples --run 1", "--out is required"},
        {"export --archive /nope", "--run is required"},
        {"export --run 1 --format xml", "xml not in {csv,jsonl}"},
        {"tones", "subcommand"},
        {"rehearse --scenario nominal_auto --seed -1", "not a whole number of at most 15 digits: -1"},
        {"rehearse", "--scenario"},
        {"campaign --scenario campaign", "--cases"},
        {"campaign --scenario campaign --cases 0", "--cases: Value 0 not in range"},
        {"serve --pace 0.5", "neither 0 nor within 1 … 1000: 0.5"},
        {"serve --listen nowhere", "ADDRESS:PORT is wanted"},
        {"dictionary check /nope", "/nope"},
        {"decode --packets /dev/null", "--xtce"},
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

TEST_CASE("the entry reference is a table of falling speed, with every row a number", "[cli][R27]") {
    if (program() == nullptr) return;
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

TEST_CASE("a landing's archive is verified, exported, backed up, tabulated and pruned by the program", "[cli][archive][R43]") {
    if (program() == nullptr) return;
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
    const auto rows = says("export --run 1 --channels altitude_m,speed_mps --archive " + in("b.db"), "sclk,e_s,channel,value,unit,source\n");
    const auto objects = says("export --run 1 --channels altitude_m,speed_mps --format jsonl --archive " + in("b.db"), R"("channel":"altitude_m")");
    CHECK(std::count(rows.begin(), rows.end(), '\n') == std::count(objects.begin(), objects.end(), '\n') + 1);
    const auto aligned = says("export --run 1 --channels altitude_m,speed_mps --align 1 --archive " + in("b.db"), "sclk,e_s,altitude_m,speed_mps\n");
    CHECK(std::count(aligned.begin(), aligned.end(), '\n') > 100);
    says("archive samples --run 1 --channels altitude_m,speed_mps --archive " + in("b.db") + " --out " + in("samples.db"),
         (std::to_string(std::count(objects.begin(), objects.end(), '\n')) + " samples of run 1").c_str());
    says("archive rebuild --archive " + in("b.db"), "run 1: made again from its units");
    CHECK(run(program(), "export --run 1 --channels altitude_m,speed_mps --archive " + in("b.db")).text == rows);
    says("archive prune --keep 0 --archive " + in("b.db"), "1 of 1 runs would go; --yes takes them away");
    says("archive prune --keep 0 --yes --archive " + in("b.db"), "1 of 1 runs are gone");
    says("archive vacuum --archive " + in("b.db"), "octets, before");
    CHECK(run(program(), "export --run 1 --archive " + in("b.db")).code == 1);
    std::filesystem::remove_all(folder);
}

TEST_CASE("a landing is reported as it was flown, each timepoint by plan, tone, UHF and recording, which agree",
          "[cli][archive][R41][R43]") {
    if (program() == nullptr) return;
    const auto folder = std::filesystem::temp_directory_path() / ("aeolis-report-" + std::to_string(getpid()));
    std::filesystem::create_directories(folder);
    const std::string archive = (folder / "a.db").string();
    REQUIRE(run(program(), "rehearse --scenario nominal_auto --archive " + archive).code == 0);
    const auto printed = run(program(), "report --run 1 --archive " + archive);
    CHECK(printed.code == 0);
    CHECK_THAT(printed.text, Catch::Contains("nominal_auto, seed 1, touchdown"));
    CHECK_THAT(printed.text, Catch::Contains("0 differ, 0 are missing in it, 0 wait for it"));
    CHECK_THAT(printed.text, Catch::Contains("Command 2 EDL_DO_EDL"));

    aeolis::v1::AsFlownReport report;
    const auto json = run(program(), "report --json --run 1 --archive " + archive);
    const auto parsed = aeolis::server::from_json(json.text, report);
    INFO((parsed ? std::string{} : parsed.error().message));
    REQUIRE(parsed);
    CHECK(report.run().outcome() == "touchdown");
    CHECK(report.proof().recording_complete());
    CHECK(report.silences_size() > 0);
    int by_tone = 0, live = 0, predicted = 0;
    for (const auto& row : report.timepoints()) {
        INFO(row.name());
        CHECK(row.has_recorded_e_s());
        if (row.has_realtime_e_s()) CHECK(row.realtime_e_s() == row.recorded_e_s());
        if (row.has_planned_e_s() && row.planned_e_s() > -900.0) CHECK(row.recorded_e_s() == Approx(row.planned_e_s()).margin(1.0));
        // The design's landing, from the entry that the vehicle kept to: seconds off once drag and winds have had their say.
        if (row.has_predicted_e_s()) CHECK(row.recorded_e_s() == Approx(row.predicted_e_s()).margin(row.has_planned_e_s() ? 1.0 : 15.0));
        predicted += row.has_predicted_e_s() ? 1 : 0;
        if (row.has_tone_e_s()) CHECK(std::abs(row.tone_e_s() - row.recorded_e_s()) < 15.0);
        if (row.has_margin_s()) CHECK(row.margin_s() > -1.0 / 64.0);
        by_tone += row.has_tone_e_s() ? 1 : 0;
        live += row.has_realtime_e_s() ? 1 : 0;
    }
    CHECK(by_tone > 10);
    CHECK(live > 20);
    CHECK(predicted >= report.timepoints_size() - 1); // not the first: it counts from "do edl"
    CHECK(report.run().clock().version() == 1);
    CHECK(report.run().clock().scet() == "2012-219T05:10:47.400");
    CHECK_THAT(run(program(), "report --run 9 --archive " + archive).text, Catch::Contains("no run 9"));
    std::filesystem::remove_all(folder);
}

TEST_CASE("the truth of a landing is written in even rows to where it stands", "[cli]") {
    if (program() == nullptr) return;
    const auto file = std::filesystem::temp_directory_path() / ("aeolis-truth-" + std::to_string(getpid()) + ".csv");
    REQUIRE(run(program(), "rehearse --scenario gnc_alone --truth " + file.string()).code == 0);
    std::ifstream rows{file};
    std::string line;
    std::getline(rows, line);
    CHECK(line.rfind("e_s,altitude_m,speed_mps,flight_path_deg,", 0) == 0);
    double before_s = 0.0, e_s = 0.0, altitude_m = 0.0, speed_mps = 0.0;
    for (int row = 0; std::getline(rows, line); ++row, before_s = e_s) {
        REQUIRE(std::sscanf(line.c_str(), "%lf,%lf,%lf", &e_s, &altitude_m, &speed_mps) == 3);
        CHECK(std::count(line.begin(), line.end(), ',') == 12);
        if (row > 0) CHECK(e_s - before_s == Approx(1.0 / 16.0).margin(1e-5));
    }
    CHECK(altitude_m < 1000.0); // the stage, on its way off
    std::filesystem::remove(file);
}

TEST_CASE("what cannot be done is answered in one line, with exit code 1", "[cli]") {
    if (program() == nullptr) return;
    for (const auto& [arguments, says] : std::array<std::pair<const char*, const char*>, 8>{{
             {"rehearse --scenario no_such", "no_such"},
             {"entry reference --scenario no_such", "no_such"},
             {"rehearse --scenario gnc_alone --truth /nope/truth.csv", "/nope/truth.csv"},
             {"rehearse --scenario " AEOLIS_SOURCE_DIR "/simulation/scenarios/od137.textproto --truth " AEOLIS_SOURCE_DIR
              "/simulation/scenarios/../scenarios/od137.textproto",
              "would be overwritten"},
             {"rehearse --scenario nominal_auto --archive /dev/null", "/dev/null"},
             {"campaign --scenario campaign --cases 2 --results /dev/null", "/dev/null"},
             {"campaign --scenario performance --cases 2", "performance: test_venue: "},
             {"serve --listen 192.0.2.1:0 --archive /dev/null", "loopback only"},
         }}) {
        const auto ended = run(program(), arguments);
        INFO(arguments << " -> " << ended.code << ": " << ended.text);
        CHECK(ended.code == 1);
        CHECK_THAT(ended.text, Catch::Contains(says));
        CHECK(std::count(ended.text.begin(), ended.text.end(), '\n') == 1);
    }
}

TEST_CASE("the program proves the shipped timeline, and shows what two versions differ in", "[cli][timeline][R19][R20]") {
    if (program() == nullptr) return;
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
TEST_CASE("in the venue performance a whole landing keeps every budget of time and stack", "[.long][cli][R8][R36][R37]") {
    if (program() == nullptr) return;
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

TEST_CASE("decode prints a row a packet of our own, whatever carried it, and says what it could not decode", "[cli][decode]") {
    using namespace aeolis;
    if (program() == nullptr) return;
    const auto directory = std::filesystem::temp_directory_path() / ("aeolis_decode_" + std::to_string(getpid()));
    std::filesystem::create_directories(directory);
    const auto& ours = tests::shipped_dictionary();
    const dictionary::Packet* kind = ours.packet("EdlStatus");
    REQUIRE(kind != nullptr);
    std::vector<std::uint8_t> packet(kind->octets), pltu(pltu_octets_max);
    seal_tm_packet(packet, kind->apid, 7, Sclk{397501174.5}, ours.id);
    pltu.resize(write_pltu({.spacecraft = 76}, packet, pltu));
    const auto write = [&](const char* name, const std::vector<std::uint8_t>& octets) {
        std::ofstream{directory / name, std::ios::binary}.write(reinterpret_cast<const char*>(octets.data()),
                                                                static_cast<std::streamsize>(octets.size()));
        return "'" + (directory / name).string() + "'";
    };
    const std::string xtce = "decode --xtce '" AEOLIS_SOURCE_DIR "/dictionaries/msl/msl.xml' --csv --packets ";
    const std::string bare = write("bare", packet), framed = write("framed", pltu);
    for (const std::string& arguments : {xtce + bare, xtce + framed + " --format pltu"}) {
        const auto ended = run(program(), arguments);
        INFO(ended.text);
        CHECK(ended.code == 0);
        CHECK_THAT(ended.text, Catch::Contains("index,apid,count,time,values\n0,16,7,397501174.5,packet_version=0|0,"));
        CHECK_THAT(ended.text, Catch::Contains(",sclk_coarse=397501174|397501174,"));
    }
    const auto write_text = [&](const char* name, const std::string& text) { return write(name, {text.begin(), text.end()}); };
    const std::string leaps = write_text("leaps.tls", tests::leap_second_kernel);
    const std::string clock = write_text("clock.tsc", "\\begindata\n" + tests::landing_clock);
    const auto timed = run(program(), xtce + bare + " --lsk " + leaps + " --sclk " + clock);
    INFO(timed.text);
    CHECK(timed.code == 0);
    CHECK_THAT(timed.text, Catch::Contains("0,16,7,2012-219T05:10:47.900,packet_version"));
    for (const auto& [arguments, says] : {std::pair{" --sclk " + clock, std::string{"--sclk requires --lsk"}},
                                          {" --lsk " + clock, "clock.tsc: it says no DELTET/DELTA_T_A"},
                                          {" --lsk " + leaps + " --sclk " + leaps, "leaps.tls: it says no SCLK_DATA_TYPE_"},
                                          {" --lsk " + bare, "bare:1: it has no line \\begindata"},
                                          {" --lsk " + leaps + " --sclk " + clock + " --partition 2", "--partition 2: "}}) {
        const auto ended = run(program(), xtce + bare + arguments);
        INFO(arguments << ": " << ended.text);
        CHECK(ended.code == 2);
        CHECK_THAT(ended.text, Catch::Contains(says));
    }
    pltu[20] ^= 1;
    const auto damaged = run(program(), xtce + write("damaged", pltu) + " --format pltu");
    CHECK(damaged.code == 1);
    CHECK_THAT(damaged.text, Catch::Contains("1 with a wrong CRC"));
    std::filesystem::remove_all(directory);
}

TEST_CASE("a landing's samples and their predict are made together, and decode reads the tones out of them", "[cli][tones][R31]") {
    if (program() == nullptr) return;
    const auto directory = std::filesystem::temp_directory_path() / ("aeolis_tones_cli_" + std::to_string(getpid()));
    std::filesystem::create_directories(directory);
    const std::string samples = " '" + (directory / "s.cf32").string() + "' ", predict = " '" + (directory / "p.csv").string() + "' ";
    const std::string simulate = "tones simulate --scenario nominal_auto --case 3 --from 60 --length 70 --out" + samples;
    const auto made = run(program(), simulate + "--predict-out" + predict);
    INFO(made.text);
    REQUIRE(made.code == 0);
    const auto decoded = run(program(), "tones decode --rate 16384 --format cf32 --start 60 --json --samples" + samples + "--predict" + predict);
    INFO(decoded.text);
    CHECK(decoded.code == 0);
    int symbols = 0;
    std::istringstream lines{decoded.text};
    for (std::string line; std::getline(lines, line); ++symbols) {
        google::protobuf::Struct symbol;
        REQUIRE(aeolis::server::from_json(line, symbol));
        CHECK(symbol.fields().at("tone").has_number_value());
        CHECK(std::abs(symbol.fields().at("doppler_hz").number_value()) > 100e3); // the predict is put back
        CHECK(symbol.fields().at("spectrum_db").list_value().values_size() == 128);
    }
    CHECK(symbols >= 3);
    CHECK(run(program(), simulate + "--predict-out" + predict + "--predict" + predict).code == 2);
    CHECK(run(program(), simulate).code == 2); // some hundreds of kilohertz are outside of the samples
    std::filesystem::remove_all(directory);
}
