// SPDX-License-Identifier: Apache-2.0
#include "commands/parameter_table.hpp"
#include "common/proximity_frame.hpp"
#include "common/space_packet.hpp"
#include "common/tm_frame.hpp"
#include "server/archive/reader.hpp"
#include "server/base/json.hpp"
#include "server/base/pcap.hpp"
#include "server/scenario/scenario_text.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/kernels.hpp"
#include "tests/support/reed_solomon_encoder.hpp"
#include "tests/support/shipped_dictionary.hpp"
#include "tests/support/temporary_folder.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <google/protobuf/struct.pb.h>
#include <iterator>
#include <random>
#include <sstream>
#include <string>
#include <unistd.h>
#include <utility>
#include <vector>

namespace server_recorded_files_cli_test {

using aeolis::test::program;
using aeolis::test::run;

// What was recorded elsewhere, decoded and ingested by the program as people start it.
TEST_CASE("decode prints a row a packet of our own, whatever carried it, and says what it could not decode",
          "[cli][decode]") {
    using namespace aeolis;
    if (program().empty()) return;
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
    const auto write_text = [&](const char* name, const std::string& text) {
        return write(name, {text.begin(), text.end()});
    };
    const std::string leaps = write_text("leaps.tls", tests::leap_second_kernel);
    const std::string clock = write_text("clock.tsc", "\\begindata\n" + tests::landing_clock);
    const auto timed = run(program(), xtce + bare + " --lsk " + leaps + " --sclk " + clock);
    INFO(timed.text);
    CHECK(timed.code == 0);
    CHECK_THAT(timed.text, Catch::Contains("0,16,7,2012-219T05:10:47.900,packet_version"));
    for (const auto& [arguments, says] :
         {std::pair{" --sclk " + clock, std::string{"--sclk requires --lsk"}},
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

TEST_CASE("decode ends with 1 and says what it left, and asks where the file leaves open how packets begin",
          "[cli][decode][R55]") {
    if (program().empty()) return;
    const aeolis::test::TemporaryFolder folder;
    const auto write = [&](const char* name, const std::string& text) {
        std::ofstream{folder / name, std::ios::binary} << text;
        return "'" + (folder / name).string() + "'";
    };
    const std::string number =
        "<IntegerParameterType name='u16'><IntegerDataEncoding sizeInBits='16'/></IntegerParameterType>"
        "<IntegerParameterType name='u48'><IntegerDataEncoding sizeInBits='48'/></IntegerParameterType>";
    const auto mission = [&](const std::string& containers) {
        return "<SpaceSystem name='T'><TelemetryMetaData><ParameterTypeSet>" + number +
               "</ParameterTypeSet><ParameterSet><Parameter name='H' parameterTypeRef='u48'/><Parameter name='W' "
               "parameterTypeRef='u16'/></ParameterSet><ContainerSet>" +
               containers + "</ContainerSet></TelemetryMetaData></SpaceSystem>";
    };
    const auto container = [](const std::string& name) {
        return "<SequenceContainer name='" + name +
               "'><EntryList><ParameterRefEntry parameterRef='H'/><ParameterRefEntry parameterRef='W'/></EntryList>"
               "</SequenceContainer>";
    };
    using namespace std::string_literals;
    const std::string one = write("one.xml", mission(container("P")));
    const std::string two = write("two.xml", mission(container("P") + container("Q")));
    std::string digits = mission(container("P"));
    digits.replace(digits.find("sizeInBits='16'"), 15, "sizeInBits='16' encoding='BCD'");
    const std::string coded = write("coded.xml", digits);
    const std::string no_digit = write("no_digit", "\x01\x23\xC0\x00\x00\x01\x00\x0A"s);
    const std::string right = write("right", "\x01\x23\xC0\x00\x00\x01\x00\x07"s);
    const std::string longer = write("longer", "\x01\x23\xC0\x00\x00\x03\x00\x07\x00\x00"s);
    const std::string segments = write("segments", "\x01\x23\x40\x00\x00\x00\x00\x01\x23\x80\x01\x00\x00\x07"s);
    const std::string half = write("half", "\x01\x23\x40\x00\x00\x01\x00\x07"s);
    const std::string other = write("other", "\xE9\x03\xFF\x01\x23\xC0\x00\x00\x01\x00\x07"s);
    const std::string idle = write("idle", "\xE0\x07\xFF\xC0\x00\x00\x00\x00"s);
    const std::string zeros = write("zeros", std::string(5000, '\0')), empty = write("empty", ""),
                      text = write("text", "this is no telemetry, but a text of some lines"s);
    struct Case {
        std::string arguments;
        int code;
        const char* says;
    };
    for (const auto& [arguments, code, says] :
         {Case{one + " --packets " + right, 0, "0,291,0,,H=1253056708609|1253056708609,W=7|7"},
          Case{coded + " --packets " + right, 0, ",W=7|7"},
          Case{coded + " --packets " + no_digit, 1, "1 values of W are not read (line 1)"},
          Case{one + " --packets " + longer, 1, "1 packets: 16 bits are behind the last entry of P"},
          Case{one + " --packets " + segments, 0, ",W=7|7"},
          Case{one + " --packets " + half, 1, "1 segments without the rest"},
          Case{one + " --packets " + other, 1, "1 encapsulation packets not decoded"},
          Case{one + " --packets " + idle, 0, "packets: 0, 2 idle"},
          Case{one + " --packets " + empty, 1, "empty is empty"},
          Case{one + " --format pltu --packets " + zeros, 1,
               "skipped: 5000 octets that are neither good frames nor fill"},
          Case{one + " --format pltu --packets " + text, 1, "nothing that is a frame was found: look at --format pltu"},
          Case{one + " --format cadu --frame-octets 20 --packets " + text, 2, "no sync marker 1ACFFC1D"},
          Case{one + " --packets " + text, 1, "nothing that is a packet was found: look at --format packets"},
          Case{one + " --time W:milliseconds --packets " + right, 0, "0,291,0,0.007,"},
          Case{one + " --time W:cuc --packets " + right, 1, "--time W: in 1 packets it is not in that form"},
          Case{one + " --fecf yes --virtual-channel 3 --packets " + right, 2,
               "--fecf, --virtual-channel: of --format tm, aos and cadu only, and this is --format packets"},
          Case{one + " --format pltu --skip 4 --packets " + right, 2, "--skip: of --format packets, tm and aos only"},
          Case{one + " --format tm --insert-octets 2 --packets " + right, 2, "--insert-octets: of AOS frames only"},
          Case{two + " --packets " + right, 2, "say with which one packets begin: /T/P, /T/Q"},
          Case{two + " --root Q --packets " + right, 0, ",W=7|7"},
          Case{two + " --root R --packets " + right, 2, "no packet begins with a container 'R'"}}) {
        const auto ended = run(program(), "decode --csv --xtce " + arguments);
        INFO(arguments << " -> " << ended.code << ": " << ended.text);
        CHECK(ended.code == code);
        CHECK_THAT(ended.text, Catch::Contains(says));
    }
}

TEST_CASE("decode corrects what Reed-Solomon codeblocks hold, says how much, and refuses what contradicts the stream",
          "[cli][decode][R54]") {
    if (program().empty()) return;
    using namespace aeolis;
    const aeolis::test::TemporaryFolder folder;
    const auto write = [&](const char* name, const std::string& text) {
        std::ofstream{folder / name, std::ios::binary} << text;
        return "'" + (folder / name).string() + "'";
    };
    const std::string mission = write(
        "one.xml",
        "<SpaceSystem name='T'><TelemetryMetaData><ParameterTypeSet>"
        "<IntegerParameterType name='u16'><IntegerDataEncoding sizeInBits='16'/></IntegerParameterType>"
        "<IntegerParameterType name='u48'><IntegerDataEncoding sizeInBits='48'/></IntegerParameterType>"
        "</ParameterTypeSet><ParameterSet><Parameter name='H' parameterTypeRef='u48'/><Parameter name='W' "
        "parameterTypeRef='u16'/></ParameterSet><ContainerSet><SequenceContainer name='P'><EntryList>"
        "<ParameterRefEntry parameterRef='H'/><ParameterRefEntry parameterRef='W'/></EntryList></SequenceContainer>"
        "</ContainerSet></TelemetryMetaData></SpaceSystem>");
    constexpr std::size_t packets_a_frame = 26, frame_octets = 6 + packets_a_frame * 8;
    std::mt19937 random{1};
    unsigned count = 0;
    const telemetry::ReedSolomonCode code{.check_symbols = 32, .interleave = 1};
    const auto stream_with = [&](std::size_t wrong_symbols) {
        std::string stream;
        count = 0;
        for (unsigned i = 0; i < 20; ++i) {
            std::vector<std::uint8_t> data;
            for (std::size_t packet = 0; packet < packets_a_frame; ++packet, ++count)
                for (const unsigned octet : {0x01U, 0x23U, 0xC0U | (count >> 8U), count & 0xFFU, 0U, 1U,
                                             static_cast<unsigned>(random() % 256), count & 0xFFU})
                    data.push_back(static_cast<std::uint8_t>(octet));
            TransferFrame frame;
            frame.spacecraft = 76;
            frame.count = i;
            frame.first_header_pointer = 0;
            frame.data = data;
            std::vector<std::uint8_t> octets(frame_octets);
            write_tm_frame(frame, static_cast<std::uint8_t>(i), false, octets);
            auto block = test::codeblock_of(octets, code);
            for (std::size_t at = 0; i == 9 && at < wrong_symbols; ++at) block[10 + at * 3] ^= 0x42;
            stream.append(attached_sync_marker.begin(), attached_sync_marker.end());
            stream.append(block.begin(), block.end());
        }
        return stream;
    };
    const std::string clean = write("clean", stream_with(0)), wrong = write("wrong", stream_with(16)),
                      lost = write("lost", stream_with(17)),
                      behind = write("behind", stream_with(0) + std::string(100, 'x'));
    struct Case {
        std::string arguments;
        int code;
        const char* says;
    };
    for (const auto& [arguments, expected, says] :
         {Case{clean, 0,
               "taken for TM frames of 214 octets without a CRC-16, in Reed-Solomon (255,223) codeblocks interleaved "
               "1, dual basis, behind sync markers"},
          Case{wrong, 0, "Reed-Solomon: 1 frames corrected, 16 symbols; 0 frames uncorrectable"},
          Case{wrong + " --reed-solomon 223 --interleave 1 --basis dual", 0, "520 packets   APID  291"},
          Case{behind, 1, "skipped: 100 octets that are neither good frames nor fill"},
          Case{clean + " --virtual-channel 5", 1, "no frame is of virtual channel 5: look at --virtual-channel"},
          Case{lost, 1, "Reed-Solomon: 0 frames corrected, 0 symbols; 1 frames uncorrectable"},
          Case{clean + " --check-symbols 32", 0, "32 check symbols behind each"},
          Case{clean + " --reed-solomon no --frame-octets 214", 0, "32 check symbols behind each"},
          Case{wrong + " --reed-solomon 239", 2, "no layout reads these frames"},
          Case{wrong + " --reed-solomon 223 --check-symbols 32", 2, "say one of them"},
          Case{wrong + " --reed-solomon 223 --interleave 1 --frame-octets 224", 2,
               "hold 223 octets of a frame at most"},
          Case{wrong + " --frame-octets 214 --check-symbols 16", 2,
               "246 octets stand between sync markers: --frame-octets and --check-symbols of 230 are not right"},
          Case{wrong + " --frame-octets 300", 2, "--frame-octets of 300 are not right"},
          Case{wrong + " --interleave 6", 2, "--interleave"},
          Case{wrong + " --interleave 5", 2, "--interleave requires --reed-solomon"}}) {
        const auto ended = run(program(), "decode --xtce " + mission + " --format cadu --packets " + arguments);
        INFO(arguments << " -> " << ended.code << ": " << ended.text);
        CHECK(ended.code == expected);
        CHECK_THAT(ended.text, Catch::Contains(says));
    }
}

TEST_CASE("a sparse file of 100 GB is told in one line, and what is stored behind a hole is read",
          "[cli][decode][R54]") {
    if (program().empty()) return;
    using namespace aeolis;
    const aeolis::test::TemporaryFolder folder;
    const auto path = [&](const char* name) { return "'" + (folder / name).string() + "'"; };
    std::ofstream{folder / "m.xml"}
        << "<SpaceSystem name='T'><TelemetryMetaData><ParameterTypeSet><IntegerParameterType name='u64'>"
           "<IntegerDataEncoding sizeInBits='64'/></IntegerParameterType></ParameterTypeSet><ParameterSet>"
           "<Parameter name='H' parameterTypeRef='u64'/></ParameterSet><ContainerSet><SequenceContainer name='P'>"
           "<EntryList><ParameterRefEntry parameterRef='H'/></EntryList></SequenceContainer></ContainerSet>"
           "</TelemetryMetaData></SpaceSystem>";
    const auto grow = [&](const char* name, std::uintmax_t octets) {
        std::error_code error;
        std::ofstream{folder / name, std::ios::app | std::ios::binary};
        std::filesystem::resize_file(folder / name, octets, error);
        return !error;  // not every file system has such files
    };
    constexpr std::uintmax_t large = 100'000'000'000U;
    if (!grow("zeros.bin", large)) return;
    for (const std::string& command :
         {"decode --packets " + path("zeros.bin"), "ingest --archive " + path("a.db") + " " + path("zeros.bin")}) {
        const auto ended = run(program(), command + " --format packets --xtce " + path("m.xml"));
        INFO(ended.text);
        CHECK(ended.code == 1);
        CHECK_THAT(ended.text, Catch::Contains("more than 100000 segments in a row are of no packet"));
    }
    const auto put = [&](std::uint8_t sequence) {
        const std::vector<std::uint8_t> packet{0x01, 0x23, 0xC0, sequence, 0, 1, 0, sequence};
        std::vector<std::uint8_t> pltu(pltu_octets_max);
        pltu.resize(write_pltu({.spacecraft = 9, .sequence = sequence}, packet, pltu));
        std::ofstream out{folder / "holes.bin", std::ios::app | std::ios::binary};
        out.write(reinterpret_cast<const char*>(pltu.data()), static_cast<std::streamsize>(pltu.size()));
    };
    put(0);
    REQUIRE(grow("holes.bin", large + 12'345));
    put(1);
    const auto read =
        run(program(), "decode --format pltu --packets " + path("holes.bin") + " --xtce " + path("m.xml"));
    INFO(read.text);
    CHECK(read.code == 1);
    CHECK_THAT(read.text, Catch::Contains("         2 packets") && Catch::Contains("that the file does not store"));
}

TEST_CASE("a recorded capture becomes a run, and what is exported of it is what was ingested", "[cli][ingest][R55]") {
    if (program().empty()) return;
    using namespace aeolis;
    const aeolis::test::TemporaryFolder folder;
    const auto write = [&](const char* name, const std::string& text) {
        std::ofstream{folder / name, std::ios::binary} << text;
        return "'" + (folder / name).string() + "'";
    };
    const std::string mission = write(
        "one.xml",
        "<SpaceSystem name='T'><TelemetryMetaData><ParameterTypeSet>"
        "<IntegerParameterType name='u16'><IntegerDataEncoding sizeInBits='16'/></IntegerParameterType>"
        "<IntegerParameterType name='u48'><IntegerDataEncoding sizeInBits='48'/></IntegerParameterType>"
        "</ParameterTypeSet><ParameterSet><Parameter name='H' parameterTypeRef='u48'/><Parameter name='W' "
        "parameterTypeRef='u16'/></ParameterSet><ContainerSet><SequenceContainer name='P'><EntryList>"
        "<ParameterRefEntry parameterRef='H'/><ParameterRefEntry parameterRef='W'/></EntryList></SequenceContainer>"
        "</ContainerSet></TelemetryMetaData></SpaceSystem>");
    std::string capture = server::pcap::head(), plain;
    for (unsigned i = 0; i < 300; ++i) {
        const std::vector<std::uint8_t> packet{0x01,
                                               0x23,
                                               static_cast<std::uint8_t>(0xC0 | i >> 8U),
                                               static_cast<std::uint8_t>(i),
                                               0,
                                               1,
                                               0,
                                               static_cast<std::uint8_t>(i)};
        server::pcap::append(capture, Ert{397'500'000'000'000 + i * 100'000}, 5000, packet);
        plain.append(packet.begin(), packet.end());
    }
    const std::vector<std::uint8_t> bad{0xEE, 0xEE, 0xEE, 0xEE, 0xEE, 0xEE, 0xEE};
    std::string damaged = capture;
    server::pcap::append(damaged, Ert{397'500'040'000'000}, 5000, bad);
    server::pcap::append(damaged, Ert{397'500'040'000'000}, 5001, bad);
    const std::string whole = write("whole.pcap", capture), hurt = write("hurt.pcap", damaged),
                      stream = write("plain", plain), newer = write("newer", "\x0A\x0D\x0D\x0A and so on");
    const std::string archive = "'" + (folder / "a.db").string() + "'";
    const auto ingest = [&](const std::string& arguments) {
        return run(program(), "ingest --archive " + archive + " --xtce " + mission + " " + arguments);
    };
    const auto first = ingest(whole);
    INFO(first.text);
    CHECK(first.code == 0);
    CHECK_THAT(first.text, Catch::Contains("run 1") && Catch::Contains("300 packets of 2400 octets"));
    const auto second = ingest(hurt + " --udp-port 5000");
    INFO(second.text);
    CHECK(second.code == 1);
    CHECK_THAT(second.text, Catch::Contains("1 bad datagrams") && Catch::Contains("1 datagrams to other ports"));
    const auto third = ingest(stream + " --start 2012-219T05:10:00 --bits-per-second 1920");
    INFO(third.text);
    CHECK(third.code == 0);
    // In two files, cut within a packet: one stream, whose times go on.
    const auto halves = ingest(write("half1", plain.substr(0, 1203)) + " " + write("half2", plain.substr(1203)) +
                               " --start 2012-219T05:10:00 --bits-per-second 1920");
    INFO(halves.text);
    CHECK(halves.code == 0);
    CHECK_THAT(halves.text, Catch::Contains("run 4") && Catch::Contains("300 packets of 2400 octets"));
    for (const auto& [arguments, code, says] :
         {std::tuple{write("empty", ""), 1, "no octets of a link are in it"},
          {stream + " " + write("empty", ""), 1, "empty: no octets of a link are in it"},
          {write("zeros", std::string(5000, '\0')) + " --format pltu", 1, "nothing that is a frame was found"},
          {stream + " --bits-per-second nan", 2, "--bits-per-second: must be a number above 0"},
          {stream + " --bits-per-second inf", 2, "--bits-per-second: must be a number above 0"},
          {stream + " --bits-per-second -1", 2, "--bits-per-second"},
          {stream + " --bits-per-second 1e-300", 2, "would take more than 100 years"}}) {
        const auto ended = ingest(arguments);
        INFO(arguments << " -> " << ended.code << ": " << ended.text);
        CHECK(ended.code == code);
        CHECK_THAT(ended.text, Catch::Contains(says));
    }
    const std::string abstract = write(
        "abstract.xml",
        "<SpaceSystem name='T'><TelemetryMetaData><ParameterTypeSet>"
        "<IntegerParameterType name='u48'><IntegerDataEncoding sizeInBits='48'/></IntegerParameterType>"
        "</ParameterTypeSet><ParameterSet><Parameter name='H' parameterTypeRef='u48'/></ParameterSet><ContainerSet>"
        "<SequenceContainer name='P' abstract='true'><EntryList><ParameterRefEntry parameterRef='H'/></EntryList>"
        "</SequenceContainer></ContainerSet></TelemetryMetaData></SpaceSystem>");
    const auto not_decoded = run(program(), "ingest --archive " + archive + " --xtce " + abstract + " " + stream);
    INFO(not_decoded.text);
    CHECK(not_decoded.code == 1);
    CHECK_THAT(not_decoded.text, Catch::Contains("300 packets not decoded"));
    const auto refused = ingest(newer);
    CHECK(refused.code == 2);
    CHECK_THAT(refused.text, Catch::Contains("pcapng file is cut off or damaged"));
    CHECK_THAT(ingest(whole + " --start 2012-219T05:10:00").text, Catch::Contains("times of its own"));

    const auto exported = [&](const std::string& arguments) {
        const auto out = folder / "out";
        std::filesystem::remove(out);
        const auto ended =
            run(program(), "export --archive " + archive + " --out '" + out.string() + "' --run " + arguments);
        INFO(arguments << " -> " << ended.code << ": " << ended.text);
        CHECK(ended.code == 0);
        std::ifstream in{out, std::ios::binary};
        return std::string{std::istreambuf_iterator<char>{in}, {}};
    };
    CHECK(exported("1 --raw") == plain);
    CHECK(exported("1 --packets --format bin") == plain);
    CHECK(exported("2 --raw") == plain + std::string(bad.begin(), bad.end()));
    const auto second_of_it = exported("3 --raw --from 2012-219T05:10:05 --to 2012-219T05:10:06");
    CHECK_FALSE(second_of_it.empty());
    CHECK(second_of_it.size() <= 300);  // 240 octets a second, in pieces of up to a quarter
    CHECK(plain.find(second_of_it) != std::string::npos);
    auto same = capture;  // but for the port
    for (std::size_t at = 24; at < same.size(); at += 16 + 36) same.replace(at + 36, 4, "\x10\x68\x10\x68");
    CHECK(exported("1 --raw --format pcap") == same);
    CHECK(exported("4 --raw") == plain);
    CHECK(exported("4 --packets --format bin") == plain);
    const auto late = exported("4 --raw --from 2012-219T05:10:07 --to 2012-219T05:10:08");
    CHECK((!late.empty() && plain.find(late) != std::string::npos));
    // Of a stream the pieces end anywhere: exported as a capture they are marked, and make the same stream again.
    const auto again = ingest(write("again.pcap", exported("3 --raw --format pcap")));
    INFO(again.text);
    CHECK(again.code == 0);
    CHECK_THAT(again.text, Catch::Contains("300 packets of 2400 octets"));
    std::string two = exported("3 --raw --format pcap");
    server::pcap::append(two, Ert{397'500'099'000'000}, 4201, bad, true);
    const auto other = ingest(write("two.pcap", two));
    CHECK(other.code == 1);
    CHECK_THAT(other.text,
               Catch::Contains("1 pieces of other streams than that to port 4200; say which by --udp-port") &&
                   Catch::Contains("300 packets of 2400 octets"));
    const auto no_packets = run(program(), "export --archive " + archive + " --run 1 --packets --link relay");
    INFO(no_packets.text);
    CHECK(no_packets.code == 1);
    CHECK_THAT(no_packets.text, Catch::Contains("link: run 1 has no packets of 'relay'; it has octets of downlink"));
    const auto no_link = run(program(), "export --archive " + archive + " --run 1 --raw --link relay");
    CHECK(no_link.code == 1);
    CHECK_THAT(no_link.text, Catch::Contains("no octets of 'relay'"));
    CHECK(run(program(), "export --archive " + archive + " --run 1 --format pcap").code == 2);
}

namespace {

/// What an archive's run 1 has of radio links, but for the times of reception.
struct HeardByRadio {
    std::string packets;                              ///< their octets, of each link
    std::vector<std::string> values, events, counts;  ///< those of ground's own station left out
};
HeardByRadio heard_by_radio(const std::filesystem::path& archive, const std::vector<std::string>& links) {
    HeardByRadio heard;
    auto reader = std::move(aeolis::archive::Reader::open(archive, aeolis::tests::shipped_dictionary())).value();
    const auto& channels = aeolis::tests::shipped_dictionary().channels;
    const aeolis::archive::RunId run_id{1};
    for (const auto& link : links) {
        std::optional<aeolis::archive::RawPiece> after;
        for (bool last = false; !last;) {
            const auto page = reader.raw(run_id, {.packets = true, .link = link}, after);
            REQUIRE(page);
            last = page->last;
            for (const auto& piece : page->pieces) heard.packets.append(piece.octets.begin(), piece.octets.end());
            if (!page->pieces.empty()) after = page->pieces.back();
        }
    }
    REQUIRE(reader.each_sample(run_id, {}, {}, [&](auto samples) -> aeolis::Result<void> {
        for (const auto& each : samples) {
            const auto& alias = std::ranges::find(channels, each.channel, &aeolis::dictionary::Channel::id)->alias;
            if (alias.starts_with("STA-")) continue;
            heard.values.push_back(
                fmt::format("{} {} {} {}", alias, each.sclk.seconds, each.value, each.text.value_or("")));
        }
        return {};
    }));
    aeolis::archive::EventQuery query;
    query.duplicates = true;
    do {
        const auto page = reader.events(run_id, query);
        REQUIRE(page);
        for (const auto& item : page->events())
            if (item.has_event() && item.event().name() != "SEEN_BY_DOPPLER")
                heard.events.push_back(
                    fmt::format("{} {} {}", item.event().sclk(), item.event().name(), item.event().text()));
        query.after = page->next_after();
    } while (query.after != 0);
    auto proof = reader.proof(run_id);
    REQUIRE(proof);
    for (auto& each : *proof->mutable_counters()) {
        each.clear_octets_per_s();
        if (std::ranges::find(links, each.link()) != links.end()) heard.counts.push_back(each.ShortDebugString());
    }
    for (auto* list : {&heard.values, &heard.events, &heard.counts}) std::ranges::sort(*list);
    return heard;
}

/// The first rows in which the lists differ; empty: they do not.
std::string first_difference(const std::vector<std::string>& found, const std::vector<std::string>& expected) {
    const auto [a, b] = std::ranges::mismatch(found, expected);
    const auto row = [](const auto& list, auto at) { return at == list.end() ? "none" : *at; };
    return a == found.end() && b == expected.end() ? ""
                                                   : fmt::format("{} of {} rows, not {} of {}", row(found, a),
                                                                 found.size(), row(expected, b), expected.size());
}

}  // namespace

TEST_CASE("the octets of a landing's radio link become a run with the packets, values, events and counts of the "
          "landing's own",
          "[cli][ingest][R55]") {
    if (program().empty()) return;
    const aeolis::test::TemporaryFolder folder;
    const auto path = [&](const char* name) { return " '" + (folder / name).string() + "'"; };
    const auto call = [&](const std::string& arguments, int code = 0) {
        const auto ended = run(program(), arguments);
        INFO(arguments << " -> " << ended.code << ": " << ended.text);
        CHECK(ended.code == code);
        return ended.text;
    };
    std::ofstream{folder / "s.textproto"} << aeolis::server::scenario_to_text(aeolis::test::short_landing());
    call("rehearse --seed 4 --scenario" + path("s.textproto") + " --archive" + path("a.db"));
    call("export --run 1 --raw --format pcap --archive" + path("a.db") + " --out" + path("all.pcap"));
    call("export --run 1 --raw --link uhf_live --archive" + path("a.db") + " --out" + path("u.bin"));
    const std::string ingest = "ingest --scenario" + path("s.textproto") + " --archive";
    // Until tones begin, X-band brings the same telemetry; after landing the recording on board comes.
    const auto said = call(ingest + path("b.db") + path("all.pcap") +
                               " --link relay=4200 --link uhf_live=4201 --link x_band_telemetry=4202",
                           1);
    CHECK_THAT(said, Catch::Contains("run 1\n") && Catch::Contains("x_band_telemetry: ") &&
                         Catch::Contains("frames missing"));  // in the blackout
    call(ingest + path("c.db") + path("u.bin") + " --link uhf_live --bits-per-second 8000", 1);
    const std::vector<std::string> links{"relay", "uhf_live", "x_band_telemetry"};
    const auto own = heard_by_radio(folder / "a.db", links);
    CHECK(own.packets.size() > 100'000);
    CHECK(own.values.size() > 10'000);
    CHECK(own.events.size() > 50);
    CHECK(own.counts.size() == 3);
    const auto whole = heard_by_radio(folder / "b.db", links);
    CHECK((whole.packets == own.packets));
    CHECK(first_difference(whole.values, own.values) == "");
    CHECK(first_difference(whole.events, own.events) == "");
    CHECK(first_difference(whole.counts, own.counts) == "");
    const auto of_uhf = heard_by_radio(folder / "a.db", {"uhf_live"}),
               plain = heard_by_radio(folder / "c.db", {"uhf_live"});
    CHECK((plain.packets == of_uhf.packets));
    CHECK(first_difference(plain.counts, of_uhf.counts) == "");
    CHECK(std::ranges::includes(own.values, plain.values));
    // What was ingested is exported again.
    call("export --run 1 --raw --link uhf_live --archive" + path("b.db") + " --out" + path("again.bin"));
    const auto text_of = [&](const char* name) {
        std::ifstream in{folder / name, std::ios::binary};
        return std::string{std::istreambuf_iterator<char>{in}, {}};
    };
    CHECK((text_of("again.bin") == text_of("u.bin")));
    for (const auto& [arguments, code, says] :
         {std::tuple{std::string{"--link x_band"}, 2, "it has samples"},
          {"--link downlink", 2, "our own mission has uhf_live"},
          {"--link uhf_live=0", 2, "'0' is no UDP port"},
          {"--link uhf_live=1 --link relay", 2, "of several each needs its port"},
          {"--link uhf_live=1 --link uhf_live=2", 2, "given before"},
          {"--link uhf_live --format pltu --xtce x.xml", 2, "--xtce, --format: --link names a radio link"},
          {"--link uhf_live --at 3", 2, "--at: --link names a radio link"},
          {"--link uhf_live --start 2012-219T05:10:00", 2, "times of its own"},
          {"--link uhf_live --scenario no_such", 2, "no_such"},
          {"--link uhf_live=4300", 1, "no packet of our own mission is in it"}})
        CHECK_THAT(call("ingest " + arguments + " --archive" + path("d.db") + path("all.pcap"), code),
                   Catch::Contains(says));
    std::ofstream{folder / "noise.bin"} << std::string(50'000, 'x');
    CHECK_THAT(call("ingest --link uhf_live --archive" + path("d.db") + path("noise.bin"), 1),
               Catch::Contains("no packet of our own mission is in it"));
    CHECK_THAT(call(ingest + path("d.db") + path("u.bin") + " --link uhf_live=4200 --link relay=4201", 2),
               Catch::Contains("u.bin: not a capture, so of one link"));
    CHECK_THAT(call(ingest + path("d.db") + path("u.bin") + " --link uhf_live=4200", 2),
               Catch::Contains("u.bin: not a capture, so without ports"));
    CHECK_FALSE(std::filesystem::exists(folder / "d.db"));
    CHECK_THAT(call(ingest + path("d.db") + path("all.pcap") + " --link uhf_live", 1),
               Catch::Contains("say which by --link NAME=PORT"));
    // Without a scenario nobody knows when entry is, and no time of reception is in the file.
    CHECK_THAT(call("ingest --link uhf_live --archive" + path("e.db") + path("u.bin"), 1),
               Catch::Contains("by the first packet's own time"));
    CHECK_THAT(call("export --run 1 --channel altitude_m --from E+0 --archive" + path("e.db"), 2),
               Catch::Contains("counts from entry, and nobody knows"));
    const auto lines = call("export --run 1 --channel altitude_m --archive" + path("e.db"));
    CHECK(lines.size() > 1000);
    CHECK_THAT(call("report --run 1 --archive" + path("e.db")), !Catch::Contains("E+39"));  // SCLK begins so
    // A frame damaged on the way, and the end cut off.
    auto damaged = text_of("u.bin");
    for (std::size_t at = 20'000; at < 20'020; ++at) damaged[at] = static_cast<char>(~damaged[at]);
    std::ofstream{folder / "hurt.bin", std::ios::binary} << damaged.substr(0, damaged.size() / 2);
    CHECK_THAT(call("ingest --link uhf_live --archive" + path("d.db") + path("hurt.bin"), 1),
               Catch::Contains("uhf_live: ") && Catch::Contains("frames missing"));
}

TEST_CASE("a landing's samples and their predict are made together, and decode reads the tones out of them",
          "[cli][tones][R31]") {
    if (program().empty()) return;
    const auto directory = std::filesystem::temp_directory_path() / ("aeolis_tones_cli_" + std::to_string(getpid()));
    std::filesystem::create_directories(directory);
    const std::string samples = " '" + (directory / "s.cf32").string() + "' ",
                      predict = " '" + (directory / "p.csv").string() + "' ";
    const std::string simulate =
        "tones simulate --scenario nominal_auto --case 3 --from 60 --length 70 --out" + samples;
    const auto made = run(program(), simulate + "--predict-out" + predict);
    INFO(made.text);
    REQUIRE(made.code == 0);
    const auto decoded = run(program(), "tones decode --rate 16384 --format cf32 --start 60 --json --samples" +
                                            samples + "--predict" + predict);
    INFO(decoded.text);
    CHECK(decoded.code == 0);
    int symbols = 0;
    std::istringstream lines{decoded.text};
    for (std::string line; std::getline(lines, line); ++symbols) {
        google::protobuf::Struct symbol;
        REQUIRE(aeolis::server::from_json(line, symbol));
        CHECK(symbol.fields().at("tone").has_number_value());
        CHECK(std::abs(symbol.fields().at("doppler_hz").number_value()) > 100e3);  // the predict is put back
        CHECK(symbol.fields().at("spectrum_db").list_value().values_size() == 128);
    }
    CHECK(symbols >= 3);
    CHECK(run(program(), simulate + "--predict-out" + predict + "--predict" + predict).code == 2);
    CHECK(run(program(), simulate).code == 2);  // some hundreds of kilohertz are outside of the samples
    std::filesystem::remove_all(directory);
}

TEST_CASE("a fixed oscillator's Doppler is removed from SigMF samples, and options that contradict a file are told",
          "[cli][tones][R56]") {
    if (program().empty()) return;
    const aeolis::test::TemporaryFolder folder;
    std::ofstream{folder / "tones.csv"} << "start_s,tone\n3,17\n13,200\n23,99\n";
    std::ofstream{folder / "doppler.csv"} << "time_s,doppler_hz\n0,-5000\n20,4000\n40,6000\n";
    const auto path = [&](const char* name) { return " '" + (folder / name).string() + "'"; };
    const auto made = run(program(), "tones simulate --tones" + path("tones.csv") + " --doppler" + path("doppler.csv") +
                                         " --c-n0 24 --length 40 --format ci16_be --out" + path("s.sigmf-meta"));
    INFO(made.text);
    REQUIRE(made.code == 0);
    const std::string decode = "tones decode --samples" + path("s.sigmf-data");
    const auto found =
        run(program(), decode + " --expected" + path("doppler.csv") + " --carrier" + path("carrier.csv"));
    INFO(found.text);
    CHECK(found.code == 0);
    for (const char* tone : {"tone 17 ", "tone 200 ", "tone 99 "}) CHECK_THAT(found.text, Catch::Contains(tone));
    CHECK_THAT(found.text, Catch::Contains("SigMF, ci16_be at 16384 Hz"));
    std::ifstream carrier{folder / "carrier.csv"};
    std::string line;
    int rows = 0;
    while (std::getline(carrier, line)) ++rows;
    CHECK(rows > 300);

    const auto other = run(program(), decode + " --rate 8192 --format cf32 --expected" + path("doppler.csv"));
    CHECK(other.code == 1);
    CHECK_THAT(other.text, Catch::Contains("as --rate says") && Catch::Contains("as --format says") &&
                               Catch::Contains("tone 200 "));
    // In-phase and quadrature exchanged, the carrier moves against the Doppler.
    std::ofstream{folder / "against.csv"} << "time_s,doppler_hz\n0,5000\n20,-4000\n40,-6000\n";
    const auto exchanged = run(program(), decode + " --expected" + path("against.csv"));
    CHECK(exchanged.code == 1);
    CHECK_THAT(exchanged.text, Catch::Contains("in-phase and quadrature are exchanged"));
    const auto still = run(program(), decode + " --predict" + path("doppler.csv"));
    CHECK(still.code == 1);
    CHECK_THAT(still.text, Catch::Contains("give it by --expected"));
    std::ofstream{folder / "raw.cf32"} << std::string(80000, 'x');
    CHECK_THAT(run(program(), "tones decode --samples" + path("raw.cf32")).text, Catch::Contains("give --format"));
}

TEST_CASE("tones behind a gap between two SigMF captures come out at their times, and a rate wrong by 1000 ppm is told",
          "[cli][ingest][tones][R56]") {
    if (program().empty()) return;
    const aeolis::test::TemporaryFolder folder;
    std::ofstream{folder / "tones.csv"} << "start_s,tone\n3,17\n27,200\n";
    const auto path = [&](const char* name) { return " '" + (folder / name).string() + "'"; };
    const auto made = run(program(), "tones simulate --tones" + path("tones.csv") +
                                         " --c-n0 28 --length 45 --rate 8192 --out" + path("s.cf32"));
    INFO(made.text);
    REQUIRE(made.code == 0);
    std::filesystem::rename(folder / "s.cf32", folder / "s.sigmf-data");
    const auto meta = [&](const std::string& rate, const std::string& more) {
        std::ofstream{folder / "s.sigmf-meta"}
            << R"({"global": {"core:datatype": "cf32_le", "core:sample_rate": )" << rate
            << R"(}, "captures": [{"core:sample_start": 0, "core:frequency": 8.4e9,)"
            << R"( "core:datetime": "2026-11-30T00:00:00Z"})" << more << R"(], "annotations": []})";
    };
    // 20 s are stored, and then 500 s are missing.
    meta("8192", R"(, {"core:sample_start": 163840, "core:datetime": "2026-11-30T00:08:40Z"})");
    const auto decoded = run(program(), "tones decode --json --samples" + path("s.sigmf-meta"));
    INFO(decoded.text);
    CHECK(decoded.code == 0);
    CHECK_THAT(decoded.text, Catch::Contains(R"({"start_s":3.000,"tone":17,)") &&
                                 Catch::Contains(R"({"start_s":527.000,"tone":200,)") &&
                                 Catch::Contains(" s without usable samples"));
    const std::string archive = "--archive" + path("passes.db");
    const auto taken = run(program(), "ingest " + archive + path("s.sigmf-meta"));
    INFO(taken.text);
    CHECK(taken.code == 0);
    CHECK_THAT(taken.text, Catch::Contains("2 tones, 0 erasures") && Catch::Contains("500.0 s without usable samples"));
    const auto carrier = run(program(), "export " + archive + " --run 1 --channel STA-0006");
    CHECK_THAT(carrier.text, Catch::Contains(",530.") && !Catch::Contains(",40."));  // seconds from the first sample

    meta("8192", R"(, {"core:sample_start": 163840, "core:datetime": "2026-11-30T00:00:10Z"})");
    for (const std::string& command :
         {"tones decode --samples" + path("s.sigmf-meta"), "ingest " + archive + path("s.sigmf-meta")}) {
        const auto back = run(program(), command);
        CHECK(back.code == 1);
        CHECK_THAT(back.text, Catch::Contains("s.sigmf-meta: capture 2 is 10.000 s earlier"));
    }
    meta("8200", "");
    const auto slow = run(program(), "tones decode --samples" + path("s.sigmf-meta"));
    INFO(slow.text);
    CHECK(slow.code == 1);
    CHECK_THAT(slow.text, Catch::Contains("is 8200 Hz its rate, to 600 ppm?"));
}

TEST_CASE("a pass recorded elsewhere becomes a run with its tones, carrier, spectra and link, from SigMF as from WAV",
          "[cli][ingest][tones][R55]") {
    if (program().empty()) return;
    const aeolis::test::TemporaryFolder folder;
    std::ofstream{folder / "tones.csv"} << "start_s,tone\n3,17\n13,200\n23,99\n";
    const auto path = [&](const char* name) { return " '" + (folder / name).string() + "'"; };
    const auto made =
        run(program(), "tones simulate --tones" + path("tones.csv") +
                           " --c-n0 24 --length 40 --format ci16 --rate 8192 --out" + path("s.sigmf-meta"));
    INFO(made.text);
    REQUIRE(made.code == 0);
    const std::string archive = "--archive" + path("passes.db");
    const auto taken = run(program(), "ingest " + archive + " --start 2012-219T05:10:00" + path("s.sigmf-data"));
    INFO(taken.text);
    CHECK(taken.code == 0);
    CHECK_THAT(taken.text,
               Catch::Contains("run 1\n") && Catch::Contains("3 tones, 0 erasures") && Catch::Contains(" 40 spectra"));
    const auto carrier = run(program(), "export " + archive + " --run 1 --channel STA-0006");
    CHECK(carrier.code == 0);
    CHECK(std::ranges::count(carrier.text, '\n') > 250);
    // What ground measured was not received.
    CHECK(run(program(), "export " + archive + " --run 1 --packets --link station --format bin").code == 1);
    // Each kind of recording refuses the other's options by their names.
    const auto of_packets = run(program(), "ingest " + archive + " --xtce x.xml --format tm --fecf yes --udp-port 5" +
                                               path("s.sigmf-data"));
    CHECK(of_packets.code == 2);
    CHECK_THAT(of_packets.text, Catch::Contains("--xtce, --format, --fecf, --udp-port: samples hold tones of our own "
                                                "mission, no packets and no frames"));
    const auto of_samples =
        run(program(), "ingest " + archive + " --xtce x.xml --at 3 --predict p.csv --exclude 0" + path("tones.csv"));
    CHECK(of_samples.code == 2);
    CHECK_THAT(of_samples.text, Catch::Contains("--predict, --at, --exclude:") && Catch::Contains("holds no samples"));
    CHECK(run(program(), "ingest " + archive + path("s.sigmf-data") + path("s.sigmf-data")).code == 2);
    CHECK(run(program(), "ingest " + archive + " --start yesterday" + path("s.sigmf-data")).code == 2);
    // These are no samples, and of packets the mission is missing.
    CHECK(run(program(), "ingest " + archive + path("tones.csv")).code == 2);

    // A carrier that bears no tone, as audio seems to have one: the run ends as decoding does.
    const auto bare =
        run(program(), "tones simulate --length 40 --c-n0 30 --format ci16 --rate 8192 --out" + path("b.sigmf-meta"));
    INFO(bare.text);
    REQUIRE(bare.code == 0);
    for (const std::string& command :
         {"ingest " + archive + path("b.sigmf-meta"), "tones decode --samples" + path("b.sigmf-data")}) {
        const auto ended = run(program(), command);
        CHECK(ended.code == 1);
        CHECK_THAT(ended.text, Catch::Contains("and no tone on it; is 8192 Hz its rate, to 600 ppm?"));
    }

    const auto silent = run(program(), "tones simulate --tones" + path("tones.csv") +
                                           " --c-n0 0 --length 30 --format ci16 --out" + path("n.sigmf-meta"));
    REQUIRE(silent.code == 0);
    const auto nothing = run(program(), "ingest " + archive + path("n.sigmf-meta"));
    CHECK(nothing.code == 1);
    CHECK_THAT(nothing.text,
               Catch::Contains("0 tones, 0 erasures, 0 estimates") && Catch::Contains("no carrier was heard"));
}

}  // namespace server_recorded_files_cli_test
