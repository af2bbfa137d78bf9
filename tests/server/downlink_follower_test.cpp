// SPDX-License-Identifier: Apache-2.0
// aeolis serve --downlink: another mission's octets over real sockets, and what the API then says of them.
#include "common/proximity_frame.hpp"
#include "dictionaries/xtce/packet_model.hpp"
#include "server/access/this_user.hpp"
#include "server/base/pcap.hpp"
#include "server/links/downlink_follower.hpp"
#include "server/net/console_backend.hpp"
#include "server/pipeline/derivation.hpp"
#include "telemetry/other_mission.hpp"
#include "tests/server/audited.hpp"
#include "tests/server/small_mission.hpp"
#include "tests/server/web_client.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/octets.hpp"

#include <arpa/inet.h>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <functional>
#include <iterator>
#include <netinet/in.h>
#include <poll.h>
#include <random>
#include <spdlog/spdlog.h>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>

namespace server_downlink_follower_test {

using namespace aeolis;
using namespace aeolis::server;
using namespace aeolis::test;

namespace {

using Octets = std::vector<std::uint8_t>;

/// A mission of one packet: header, clock, a number, a label and a list as long as the packet says.
constexpr const char* small_xtce = R"(<SpaceSystem name="Small"><TelemetryMetaData><ParameterTypeSet>
<IntegerParameterType name="u5"><IntegerDataEncoding sizeInBits="5"/></IntegerParameterType>
<IntegerParameterType name="u11"><IntegerDataEncoding sizeInBits="11"/></IntegerParameterType>
<IntegerParameterType name="u32"><IntegerDataEncoding sizeInBits="32"/></IntegerParameterType>
<IntegerParameterType name="u16"><IntegerDataEncoding sizeInBits="16"/></IntegerParameterType>
<IntegerParameterType name="u8"><IntegerDataEncoding sizeInBits="8"/></IntegerParameterType>
<FloatParameterType name="volts"><UnitSet><Unit>V</Unit></UnitSet><IntegerDataEncoding sizeInBits="16"><DefaultCalibrator>
<PolynomialCalibrator><Term coefficient="0.5" exponent="1"/></PolynomialCalibrator></DefaultCalibrator></IntegerDataEncoding></FloatParameterType>
<EnumeratedParameterType name="mode_t"><IntegerDataEncoding sizeInBits="8"/><EnumerationList><Enumeration value="2" label="ON"/></EnumerationList></EnumeratedParameterType>
</ParameterTypeSet><ParameterSet>
<Parameter name="first" parameterTypeRef="u5"/><Parameter name="apid" parameterTypeRef="u11"/><Parameter name="rest" parameterTypeRef="u32"/>
<Parameter name="COARSE" parameterTypeRef="u32"/><Parameter name="FINE" parameterTypeRef="u16"/>
<Parameter name="BUS_VOLTAGE" parameterTypeRef="volts"/><Parameter name="MODE" parameterTypeRef="mode_t"/>
<Parameter name="N" parameterTypeRef="u8"/><Parameter name="LIST" parameterTypeRef="u8"/>
</ParameterSet><ContainerSet>
<SequenceContainer name="Header" abstract="true"><EntryList><ParameterRefEntry parameterRef="first"/><ParameterRefEntry parameterRef="apid"/>
<ParameterRefEntry parameterRef="rest"/><ParameterRefEntry parameterRef="COARSE"/><ParameterRefEntry parameterRef="FINE"/></EntryList></SequenceContainer>
<SequenceContainer name="Power"><EntryList><ParameterRefEntry parameterRef="BUS_VOLTAGE"/><ParameterRefEntry parameterRef="MODE"/>
<ParameterRefEntry parameterRef="N"/><ParameterRefEntry parameterRef="LIST"><RepeatEntry><Count><DynamicValue><ParameterInstanceRef parameterRef="N"/>
</DynamicValue></Count></RepeatEntry></ParameterRefEntry></EntryList>
<BaseContainer containerRef="Header"><RestrictionCriteria><Comparison parameterRef="apid" value="77"/></RestrictionCriteria></BaseContainer></SequenceContainer>
</ContainerSet></TelemetryMetaData></SpaceSystem>)";

Octets power_packet(std::uint16_t count, std::uint32_t coarse, std::uint16_t raw_volts, unsigned apid = 77) {
    Octets packet{static_cast<std::uint8_t>(0x08 | apid >> 8),
                  static_cast<std::uint8_t>(apid),
                  static_cast<std::uint8_t>(0xC0 | count >> 8),
                  static_cast<std::uint8_t>(count),
                  0,
                  0};
    for (int shift = 24; shift >= 0; shift -= 8) packet.push_back(static_cast<std::uint8_t>(coarse >> shift));
    packet.insert(packet.end(), {0x80, 0x00, static_cast<std::uint8_t>(raw_volts >> 8),
                                 static_cast<std::uint8_t>(raw_volts), 2, 3, 7, 8, 9});
    packet[5] = static_cast<std::uint8_t>(packet.size() - 7);
    return packet;
}

Octets in_pltu(const Octets& packet, std::uint8_t sequence) {
    Octets pltu(pltu_octets_max);
    pltu.resize(write_pltu({.spacecraft = 9, .sequence = sequence}, packet, pltu));
    return pltu;
}

std::unique_ptr<telemetry::OtherMission> mission_of(const std::string& xtce) {
    std::vector<dictionary::Finding> findings;
    dictionary::Findings into{"m.xml", findings};
    auto model = dictionary::xtce::read_packet_model(xtce, into);
    REQUIRE(model);
    CHECK(findings.empty());
    return std::make_unique<telemetry::OtherMission>(std::move(*model), std::uint16_t{4711});
}

/// What sends: a listener that gives each connection what it is told to.
class Sender {
  public:
    Sender() : listener_(::socket(AF_INET, SOCK_STREAM, 0)) {
        sockaddr_in any{};
        any.sin_family = AF_INET;
        any.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        socklen_t size = sizeof any;
        REQUIRE(::bind(listener_, reinterpret_cast<sockaddr*>(&any), size) == 0);
        REQUIRE(::listen(listener_, 4) == 0);
        REQUIRE(::getsockname(listener_, reinterpret_cast<sockaddr*>(&any), &size) == 0);
        port = ntohs(any.sin_port);
    }
    ~Sender() { ::close(listener_); }
    Sender(const Sender&) = delete;
    Sender& operator=(const Sender&) = delete;

    /// Sends the octets in pieces of odd sizes to the next that connects, and closes.
    void give(const Octets& octets) {
        pollfd watched{listener_, POLLIN, 0};
        REQUIRE(::poll(&watched, 1, 10'000) == 1);
        const int connection = ::accept(listener_, nullptr, nullptr);
        REQUIRE(connection >= 0);
        std::size_t piece = 1;
        for (std::size_t at = 0; at < octets.size(); at += piece, piece = piece % 977 + 6) {
            const std::size_t size = std::min(piece, octets.size() - at);
            REQUIRE(::send(connection, octets.data() + at, size, MSG_NOSIGNAL) == static_cast<ssize_t>(size));
            if (piece < 20) std::this_thread::sleep_for(std::chrono::milliseconds{1});
        }
        ::close(connection);
    }
    std::uint16_t port = 0;

  private:
    int listener_;
};

/// `aeolis serve --downlink` in this process.
class Follower {
  public:
    Follower(const telemetry::OtherMission& mission, const std::string& address, PacketStreamFormat format,
             ReadClocks clocks = read_clocks) {
        spdlog::set_level(spdlog::level::off);
        ConsoleBackend::Settings settings;
        settings.web_server.port = 0;
        settings.archive = folder_ / "a.db";
        settings.scenarios = AEOLIS_SOURCE_DIR "/simulation/scenarios";
        settings.web = folder_ / "web";
        settings.other = &mission;
        settings.clocks = std::move(clocks);
        auto backend = ConsoleBackend::open(settings, mission.dictionary());
        REQUIRE(backend);
        backend_ = std::move(*backend);
        DownlinkFollower::Settings follow;
        follow.address = *DownlinkAddress::parse(address);
        follow.format = std::move(format);
        follow.xtce = "m.xml";
        follow.retry_first = std::chrono::milliseconds{10};
        follow.retry_max = std::chrono::milliseconds{40};
        REQUIRE(backend_->follow(follow));
        network_ = std::thread{[this] { backend_->run(); }};
    }
    ~Follower() {
        backend_->stop();
        network_.join();
        backend_.reset();
        spdlog::set_level(spdlog::level::err);
    }
    Follower(const Follower&) = delete;
    Follower& operator=(const Follower&) = delete;

    std::string ask(const std::string& target) const {
        return web_request(backend_->port(), "GET", "/api/v1" + target).body;
    }
    /// The answer once it says so; else the last one.
    std::string ask_until(const std::string& target, const std::function<bool(const std::string&)>& says) const {
        std::string answer;
        for (int i = 0; i < 400; ++i) {
            answer = ask(target);
            if (says(answer)) break;
            std::this_thread::sleep_for(std::chrono::milliseconds{25});
        }
        return answer;
    }
    std::uint16_t port() const { return backend_->port(); }
    std::filesystem::path archive() const { return folder_ / "a.db"; }
    std::uint16_t downlink_port() const { return backend_->downlink_port(); }

  private:
    TemporaryFolder folder_;
    std::unique_ptr<ConsoleBackend> backend_;
    std::thread network_;
};

std::size_t count_of(const std::string& text, const std::string& part) {
    std::size_t count = 0;
    for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; at += part.size()) ++count;
    return count;
}

void send_datagram(std::uint16_t port, const Octets& octets) {
    const int socket = ::socket(AF_INET, SOCK_DGRAM, 0);
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    to.sin_port = htons(port);
    REQUIRE(::sendto(socket, octets.data(), octets.size(), 0, reinterpret_cast<sockaddr*>(&to), sizeof to) ==
            static_cast<ssize_t>(octets.size()));
    ::close(socket);
}

}  // namespace

TEST_CASE("packets in frames with garbage between, over TCP in odd pieces, are a run that the API shows",
          "[server][downlink]") {
    const auto mission = mission_of(small_xtce);
    Sender sender;
    Follower follower{
        *mission, "tcp://127.0.0.1:" + std::to_string(sender.port), {.name = "pltu", .skip = 0, .frame_octets = {}}};
    Octets stream;
    std::mt19937 random{11};
    for (std::uint16_t i = 0; i < 200; ++i) {
        for (int n = static_cast<int>(random() % 40); n > 0; --n) stream.push_back(static_cast<std::uint8_t>(random()));
        const auto pltu =
            in_pltu(power_packet(i, 1000U + i, static_cast<std::uint16_t>(2 * i)), static_cast<std::uint8_t>(i));
        stream.insert(stream.end(), pltu.begin(), pltu.end());
    }
    sender.give(stream);
    const auto values = follower.ask_until("/runs/1/channels?names=BUS_VOLTAGE&format=csv",
                                           [](const std::string& text) { return count_of(text, "\n") == 201; });
    CHECK(values.starts_with(
        "channel,unit,sclk_s,value,source\nBUS_VOLTAGE,V,1000.5,0,realtime\nBUS_VOLTAGE,V,1001.5,1,realtime\n"));
    CHECK(values.ends_with("BUS_VOLTAGE,V,1199.5,199,realtime\n"));
    CHECK(count_of(follower.ask("/runs/1/channels?names=LIST%5B2%5D&format=csv"), ",9,realtime") == 200);
    CHECK(count_of(follower.ask("/runs/1/channels?names=MODE&format=csv"), ",2,realtime") == 200);

    const auto packets = follower.ask("/runs/1/packets?apid=77&limit=3");
    CHECK_THAT(packets, Catch::Contains("\"name\":\"Power\""));
    CHECK_THAT(packets, Catch::Contains("\"link\":\"downlink\""));
    CHECK_THAT(packets, Catch::Contains("\"name\":\"MODE\",\"text\":\"ON\""));
    CHECK_THAT(packets, Catch::Contains("\"name\":\"LIST[2]\",\"text\":\"9\""));
    const auto words = follower.ask("/dictionary");
    CHECK_THAT(words, Catch::Contains("\"mission\":\"Small\""));
    CHECK_THAT(words, Catch::Contains("\"name\":\"BUS_VOLTAGE\""));
    CHECK_THAT(follower.ask("/runs/1"), Catch::Contains("\"venue\":\"downlink\"") && Catch::Contains("pltu by m.xml"));
    CHECK_THAT(follower.ask("/runs/1/state"), Catch::Contains("\"BUS_VOLTAGE\""));
    CHECK(follower.ask("/runs/1/raw?format=bin") == std::string(stream.begin(), stream.end()));
    CHECK_THAT(follower.ask("/runs/1/raw?link=relay"),
               Catch::Contains("no octets of 'relay'; it has those of downlink"));
    CHECK_THAT(follower.ask("/runs/1/raw?format=csv"), Catch::Contains("'csv' is neither bin nor pcap"));
    CHECK_THAT(follower.ask("/runs/1/raw?from=yesterday"), Catch::Contains("'yesterday' is no instant"));
    CHECK_THAT(follower.ask("/runs/1/prediction"),
               Catch::Contains("\"state\":\"none\"") && Catch::Contains("run 1 has no scenario: it follows another"));
}

TEST_CASE("a link that drops is connected again, and nothing that came is lost or doubled", "[server][downlink]") {
    const auto mission = mission_of(small_xtce);
    Sender sender;
    Follower follower{
        *mission, "tcp://127.0.0.1:" + std::to_string(sender.port), {.name = "packets", .skip = 2, .frame_octets = {}}};
    const auto prefixed = [](std::uint16_t i) {
        Octets octets{0xFF, 0xFF};
        const auto packet = power_packet(i, i, i);
        octets.insert(octets.end(), packet.begin(), packet.end());
        return octets;
    };
    auto first = prefixed(1), second = prefixed(2), third = prefixed(3);
    first.insert(first.end(), second.begin(), second.begin() + 9);  // the link drops within the second
    sender.give(first);
    second.insert(second.end(), {0, 0, 0xEE, 0xEE, 0xEE, 0xEE, 0xEE, 0xEE, 0xEE});  // and here no packet begins
    sender.give(second);
    sender.give(third);
    const auto says_all = [](const std::string& text) { return count_of(text, "\"Power\"") == 3; };
    CHECK(count_of(follower.ask_until("/runs/1/packets", says_all), "\"hex\"") == 3);
    CHECK(follower.ask("/runs/1/channels?names=BUS_VOLTAGE&format=csv") ==
          "channel,unit,sclk_s,value,source\nBUS_VOLTAGE,V,1.5,0.5,realtime\nBUS_VOLTAGE,V,2.5,1,realtime\nBUS_VOLTAGE,"
          "V,3.5,1.5,realtime\n");
}

TEST_CASE("the situation goes with the link: listening while packets come, and what was the last one when it breaks",
          "[server][downlink][situation]") {
    const auto mission = mission_of(small_xtce);
    Sender sender;
    Follower follower{
        *mission, "tcp://127.0.0.1:" + std::to_string(sender.port), {.name = "packets", .skip = 0, .frame_octets = {}}};
    CHECK_THAT(follower.ask_until("/runs/1/state",
                                  [](const std::string& text) { return count_of(text, "Nothing comes yet") > 0; }),
               Catch::Contains("Nothing comes yet"));
    sender.give(power_packet(1, 10, 4));  // and the connection breaks
    const auto lost = follower.ask_until(
        "/runs/1/state", [](const std::string& text) { return count_of(text, "the last packet came at") > 0; });
    CHECK_THAT(lost, Catch::Contains("Nothing comes now: the last packet came at 20"));
    CHECK(count_of(lost, "Nothing comes yet") == 0);
}

TEST_CASE("each datagram stands for itself: garbage and packets of nobody are kept and named, the next is read",
          "[server][downlink]") {
    const auto mission = mission_of(small_xtce);
    Follower follower{*mission, "udp://127.0.0.1:0", {.name = "packets", .skip = 0, .frame_octets = {}}};
    const auto port = follower.downlink_port();
    REQUIRE(port != 0);
    send_datagram(port, power_packet(1, 10, 4));
    send_datagram(port, Octets(200, 0xEE));
    send_datagram(port, {});
    Octets cut = power_packet(2, 11, 6);
    cut.resize(cut.size() - 3);
    send_datagram(port, cut);
    send_datagram(port, power_packet(3, 12, 6, 99));
    Octets two = power_packet(4, 13, 8);
    const auto last = power_packet(5, 14, 10);
    two.insert(two.end(), last.begin(), last.end());
    send_datagram(port, two);
    const auto packets =
        follower.ask_until("/runs/1/packets", [](const std::string& text) { return count_of(text, "\"Power\"") == 3; });
    const auto captured = follower.ask("/runs/1/raw");
    const std::vector<std::uint8_t> capture{captured.begin(), captured.end()};
    auto kept = pcap::File::open(capture);
    REQUIRE(kept);
    for (const Octets& sent : {power_packet(1, 10, 4), Octets(200, 0xEE), cut, power_packet(3, 12, 6, 99), two}) {
        const auto datagram = kept->next();
        REQUIRE(datagram);
        CHECK(Octets(datagram->octets.begin(), datagram->octets.end()) == sent);
    }
    CHECK_FALSE(kept->next());
    CHECK(follower.ask("/runs/1/raw?of=packets&format=bin").size() ==
          3 * power_packet(1, 10, 4).size() + power_packet(3, 12, 6, 99).size());
    for (const char* of : {"octets", "packets"}) {
        const auto unknown = web_request(follower.port(), "GET", std::string{"/api/v1/runs/1/raw?link=relay&of="} + of);
        CHECK(unknown.status == 400);
        CHECK_THAT(unknown.body, Catch::Contains("'relay'"));
    }
    CHECK(count_of(packets, "\"Power\"") == 3);
    CHECK(count_of(packets, "\"hex\"") == 4);
    CHECK_THAT(packets, Catch::Contains("not decoded: no container describes it: Header is abstract"));
    CHECK(follower.ask("/runs/1/channels?names=BUS_VOLTAGE&format=csv") ==
          "channel,unit,sclk_s,value,source\nBUS_VOLTAGE,V,10.5,2,realtime\nBUS_VOLTAGE,V,13.5,4,realtime\nBUS_VOLTAGE,"
          "V,14.5,5,realtime\n");
}

TEST_CASE(
    "a short datagram of frames without markers is a bad one, and no other is lost, also while the frames are not "
    "yet recognised",
    "[server][downlink]") {
    const auto mission = mission_of(small_xtce);
    Follower follower{*mission, "udp://127.0.0.1:0", {.name = "tm", .skip = 0, .frame_octets = {}}};
    for (std::uint16_t i = 0; i < 12; ++i) {
        const auto packet = power_packet(i, 10U + i, 4);
        TransferFrame frame;
        frame.spacecraft = 76;
        frame.count = i;
        frame.first_header_pointer = 0;
        frame.data = packet;
        Octets octets(6 + packet.size() + 2);
        write_tm_frame(frame, static_cast<std::uint8_t>(i), true, octets);
        if (i == 3 || i == 7) octets.resize(octets.size() - 5);
        send_datagram(follower.downlink_port(), octets);
    }
    const auto told = follower.ask_until(
        "/runs/1/proof", [](const std::string& text) { return text.find("\"frames\":\"10\"") != std::string::npos; });
    CHECK_THAT(told, Catch::Contains("\"frames\":\"10\"") && Catch::Contains("\"bad_datagrams\":\"2\"") &&
                         Catch::Contains("\"cut_frames\":\"2\""));
}

TEST_CASE("a followed link has totals: what was lost, repeated, late, cut and bad is counted over all connections",
          "[server][downlink][R54]") {
    const auto mission = mission_of(small_xtce);
    Sender sender;
    Follower tcp{*mission, "tcp://127.0.0.1:" + std::to_string(sender.port), {.name = "packets"}};
    Octets first;
    for (const std::uint16_t count : {1, 2, 5, 4, 4, 6}) {
        const auto packet = power_packet(count, count, count);
        first.insert(first.end(), packet.begin(), packet.end());
    }
    const auto half = power_packet(7, 7, 7);
    first.insert(first.end(), half.begin(), half.begin() + 8);
    sender.give(first);
    sender.give(power_packet(8, 8, 8));
    const auto told = tcp.ask_until(
        "/runs/1/proof", [](const std::string& text) { return text.find("\"packets\":\"7\"") != std::string::npos; });
    CHECK_THAT(told, Catch::Contains("\"link\":\"downlink\"") && Catch::Contains("\"cut_packets\":\"1\"") &&
                         Catch::Contains("\"unreadable_octets\":\"8\""));
    CHECK_THAT(told, Catch::Contains("\"name\":\"APID 77\"") && Catch::Contains("\"received\":\"7\"") &&
                         Catch::Contains("\"missing\":\"1\"") && Catch::Contains("\"repeated\":\"1\"") &&
                         Catch::Contains("\"late\":\"1\""));
    const auto metrics = web_request(tcp.port(), "GET", "/metrics").body;
    CHECK_THAT(metrics, Catch::Contains("aeolis_link_faults_total{link=\"downlink\",kind=\"cut_packets\"} 1\n"));
    CHECK_THAT(metrics,
               Catch::Contains(
                   "aeolis_sequence_total{link=\"downlink\",of=\"packets\",sequence=\"APID 77\",kind=\"late\"} 1\n"));

    Follower udp{*mission, "udp://127.0.0.1:0", {.name = "packets"}};
    send_datagram(udp.downlink_port(), Octets(200, 0xEE));
    Octets cut = power_packet(2, 11, 6);
    cut.resize(cut.size() - 3);
    send_datagram(udp.downlink_port(), cut);
    send_datagram(udp.downlink_port(), power_packet(3, 12, 6));
    CHECK_THAT(
        udp.ask_until("/runs/1/proof",
                      [](const std::string& text) { return text.find("\"packets\":\"1\"") != std::string::npos; }),
        Catch::Contains("\"bad_datagrams\":\"2\"") && Catch::Contains("\"cut_packets\":\"2\""));
}

TEST_CASE("who follows a downlink rehearses nothing, and says so", "[server][downlink]") {
    const auto mission = mission_of(small_xtce);
    Follower follower{*mission, "udp://127.0.0.1:0", {.name = "packets", .skip = 0, .frame_octets = {}}};
    const auto reply = web_request(follower.port(), "POST", "/api/v1/rehearsals", R"({"scenario":"nominal"})");
    CHECK(reply.status >= 400);
    CHECK_THAT(reply.body, Catch::Contains("follows the downlink of another mission"));
}

TEST_CASE("while the system's clock is set back and forth under a run, Earth received times go on evenly; each jump is "
          "in the shift log, the audit and the metrics",
          "[server][downlink][clock]") {
    const auto mission = mission_of(small_xtce);
    std::atomic<std::int64_t> moved_us{0};
    Follower follower{*mission, "udp://127.0.0.1:0", {.name = "packets", .skip = 0, .frame_octets = {}}, [&moved_us] {
                          auto reading = read_clocks();
                          reading.system_us += moved_us;
                          return reading;
                      }};
    const auto notes = [](std::size_t wanted) {
        return [wanted](const std::string& text) { return count_of(text, "jumped") >= wanted; };
    };
    send_datagram(follower.downlink_port(), power_packet(1, 1001, 1));
    follower.ask_until("/runs/1/packets", [](const std::string& text) { return count_of(text, "\"hex\"") == 1; });
    moved_us = -3'600'000'000;
    CHECK_THAT(follower.ask_until("/runs/1/notes", notes(1)),
               Catch::Contains("jumped 3600.000 s back") && Catch::Contains("\"by\":\"server\"") &&
                   Catch::Contains("Earth received times of this run do not follow it"));
    send_datagram(follower.downlink_port(), power_packet(2, 1002, 1));
    follower.ask_until("/runs/1/packets", [](const std::string& text) { return count_of(text, "\"hex\"") == 2; });
    moved_us = 7'200'000'000;
    CHECK_THAT(follower.ask_until("/runs/1/notes", notes(2)), Catch::Contains("jumped 10800.000 s forward"));
    send_datagram(follower.downlink_port(), power_packet(3, 1003, 1));
    follower.ask_until("/runs/1/packets", [](const std::string& text) { return count_of(text, "\"hex\"") == 3; });
    const auto metrics = web_request(follower.port(), "GET", "/metrics").body;
    CHECK_THAT(metrics, Catch::Contains("aeolis_clock_jumps_total 2\naeolis") ||
                            Catch::Contains("aeolis_clock_jumps_total 2\n#"));

    auto reader = archive::Reader::open(follower.archive(), mission->dictionary(), mission.get());
    REQUIRE(reader);
    CHECK(std::ranges::count(reader->audit(0, 100).value(), "clock", &archive::AuditEntry::action) == 2);
    const auto page = reader->items(archive::RunId{1}, 0, 1000);
    REQUIRE(page);
    auto database = archive::sqlite::Database::open(follower.archive().string(), archive::sqlite::Mode::read_only);
    REQUIRE(database);
    CHECK(database->integer_of("SELECT count(*) FROM packets").value() == 3);
    CHECK(
        database
            ->integer_of("SELECT count(*) FROM (SELECT ert_us, lag(ert_us) OVER (ORDER BY key) AS before FROM packets)"
                         " WHERE ert_us < before")
            .value() == 0);
    CHECK(database->integer_of("SELECT max(ert_us) - min(ert_us) FROM packets").value() < 60'000'000);
}

/// Packets with a clock of whole seconds and a number (APID 1), and without a time: a whole number and a text (APID 2).
constexpr const char* odd_xtce = R"(<SpaceSystem name="Odd"><TelemetryMetaData><ParameterTypeSet>
<IntegerParameterType name="u5"><IntegerDataEncoding sizeInBits="5"/></IntegerParameterType>
<IntegerParameterType name="u11"><IntegerDataEncoding sizeInBits="11"/></IntegerParameterType>
<IntegerParameterType name="u16"><IntegerDataEncoding sizeInBits="16"/></IntegerParameterType>
<IntegerParameterType name="u32"><IntegerDataEncoding sizeInBits="32"/></IntegerParameterType>
<IntegerParameterType name="u64"><IntegerDataEncoding sizeInBits="64"/></IntegerParameterType>
<FloatParameterType name="f32"><FloatDataEncoding sizeInBits="32"/></FloatParameterType>
<StringParameterType name="latin"><StringDataEncoding encoding="ISO-8859-1"><SizeInBits><Fixed><FixedValue>24</FixedValue></Fixed></SizeInBits></StringDataEncoding></StringParameterType>
</ParameterTypeSet><ParameterSet>
<Parameter name="first" parameterTypeRef="u5"/><Parameter name="apid" parameterTypeRef="u11"/><Parameter name="rest" parameterTypeRef="u32"/>
<Parameter name="COARSE" parameterTypeRef="u32"/><Parameter name="FINE" parameterTypeRef="u16"/><Parameter name="X" parameterTypeRef="f32"/>
<Parameter name="BIG" parameterTypeRef="u64"/><Parameter name="NAME" parameterTypeRef="latin"/>
</ParameterSet><ContainerSet>
<SequenceContainer name="Header" abstract="true"><EntryList><ParameterRefEntry parameterRef="first"/><ParameterRefEntry parameterRef="apid"/>
<ParameterRefEntry parameterRef="rest"/></EntryList></SequenceContainer>
<SequenceContainer name="Timed"><EntryList><ParameterRefEntry parameterRef="COARSE"/><ParameterRefEntry parameterRef="FINE"/>
<ParameterRefEntry parameterRef="X"/></EntryList><BaseContainer containerRef="Header"><RestrictionCriteria>
<Comparison parameterRef="apid" value="1"/></RestrictionCriteria></BaseContainer></SequenceContainer>
<SequenceContainer name="Bare"><EntryList><ParameterRefEntry parameterRef="BIG"/><ParameterRefEntry parameterRef="NAME"/></EntryList>
<BaseContainer containerRef="Header"><RestrictionCriteria><Comparison parameterRef="apid" value="2"/></RestrictionCriteria></BaseContainer></SequenceContainer>
</ContainerSet></TelemetryMetaData></SpaceSystem>)";

Octets packet_of(std::uint8_t apid, const std::string& data) {
    Octets packet{0, apid, 0xC0, 0, 0, 0};
    const auto octets = hex(data);
    packet.insert(packet.end(), octets.begin(), octets.end());
    packet[5] = static_cast<std::uint8_t>(packet.size() - 7);
    return packet;
}

TEST_CASE(
    "of a followed mission the newest is what was received last, undefined is a sample, and texts and 64-bit numbers "
    "are exact, in channels, state, export and stream; a clock that restarts, and packets without one, are told",
    "[server][downlink][R53][R54]") {
    const auto mission = mission_of(odd_xtce);
    Follower follower{*mission, "udp://127.0.0.1:0", {.name = "packets", .skip = 0, .frame_octets = {}}};
    const auto link =
        follower.ask_until("/runs/1/items", [](const std::string& text) { return count_of(text, "\"link\"") > 0; });
    CHECK_THAT(link, Catch::Contains("listening, no packet has come yet") && !Catch::Contains("\"up\":true"));
    std::size_t sent = 0;
    const auto send = [&](const Octets& packet) {
        send_datagram(follower.downlink_port(), packet);
        ++sent;
        follower.ask_until("/runs/1/packets",
                           [&](const std::string& text) { return count_of(text, "\"hex\"") == sent; });
    };
    constexpr const char *one = "3f800000", *two = "40000000", *three = "40400000", *four = "40800000",
                         *nan = "7fc00000";
    for (const char* x : {one, two, three}) send(packet_of(1, "00001388 0000" + std::string(x)));  // 5000 s
    send(packet_of(2, "0020000000000001 c4d641"));
    send(packet_of(1, std::string("00000007 0000") + nan));
    send(packet_of(1, std::string("00000008 0000") + four));
    send(packet_of(2, "ffffffffffffffff 204142"));
    send(packet_of(1, std::string("00000009 0000") + nan));

    const auto x = follower.ask("/runs/1/channels?names=X");
    CHECK_THAT(x, Catch::Contains("\"samples\":\"4\"") && Catch::Contains("\"sclk\":[7,8,9,5000,5000,5000]") &&
                      Catch::Contains("\"value\":[null,4,null,1,2,3]") &&
                      Catch::Contains("\"newest\":{\"sclk\":9,\"value\":null"));
    CHECK_THAT(follower.ask("/runs/1/channels?names=X&format=csv"),
               Catch::Contains("X,,7,,realtime\nX,,8,4,realtime\nX,,9,,"));
    CHECK_THAT(follower.ask("/runs/1/channels?names=BIG,NAME"),
               Catch::Contains("\"value\":[\"18446744073709551615\",\"9007199254740993\"]") &&
                   Catch::Contains("\"value\":[\" AB\",\"ÄÖA\"]") && Catch::Contains("\"sclk_by_reception\":true"));
    const auto state_of = [&](const std::string& at) {
        const auto state = follower.ask("/runs/1/state" + at);
        const auto begin = state.find("\"name\":\"X\"");
        return state.substr(begin, state.find('}', begin) - begin);
    };
    CHECK_THAT(state_of(""), Catch::Contains("\"sclk\":[9],\"value\":[null]"));
    CHECK_THAT(state_of("?at=6000"),
               Catch::Contains("\"sclk\":[9],\"value\":[null]"));  // received last of those up to then
    CHECK_THAT(state_of("?at=8"), Catch::Contains("\"sclk\":[8],\"value\":[4]"));
    CHECK_THAT(follower.ask("/runs/1/state"), Catch::Contains("\"value\":[\"18446744073709551615\"]"));
    CHECK_THAT(follower.ask("/runs/1/samples?names=X,BIG&align=X"),
               Catch::Contains("sclk,e_s,X,BIG\n7,,,\n8,,4,") && Catch::Contains("\n9,,,"));
    const auto items = follower.ask("/runs/1/items");
    CHECK_THAT(items, Catch::Contains("\"exact\":[{\"id\"") && Catch::Contains("\"text\":\"9007199254740993\"") &&
                          Catch::Contains("\"NaN\"") && Catch::Contains("packets come"));
    CHECK_THAT(follower.ask("/runs/1/notes"),
               Catch::Contains("packet Bare holds no time: its samples stand at their reception") &&
                   Catch::Contains("the clock of packet Timed went back from 5000 s to 7 s") &&
                   Catch::Contains("\"by\":\"ground\""));
    const auto verified = pipeline::verify(follower.archive(), {}, mission->dictionary(), mission.get(),
                                           follower.archive().parent_path());
    REQUIRE(verified);
    CHECK(verified->faults.empty());
}

TEST_CASE("a downlink that the program was started to follow is in the audit, with who started it",
          "[server][downlink][audit]") {
    const auto mission = mission_of(small_xtce);
    Follower follower{*mission, "udp://127.0.0.1:0", {.name = "packets", .skip = 0, .frame_octets = {}}};
    auto reader = archive::Reader::open(follower.archive(), mission->dictionary(), mission.get());
    REQUIRE(reader);
    const auto entry = only_audited(*reader);
    CHECK(entry.who == this_user());
    CHECK(entry.from == "command line");
    CHECK(entry.action == "downlink");
    CHECK_THAT(entry.detail, Catch::StartsWith("serve --downlink udp://127.0.0.1") && Catch::EndsWith("--xtce m.xml"));
    CHECK(entry.outcome == "done");
}

TEST_CASE("an instrument's own packets over TCP give its published values through the API", "[server][downlink]") {
    const std::filesystem::path suda = AEOLIS_SOURCE_DIR "/../shared/data/packets/suda";
    if (!std::filesystem::exists(suda / "expected.csv")) {
        std::printf("SKIPPED: the instrument's packets are not beside the project (../shared/data)\n");
        return;
    }
    const auto text_of = [&](const char* name) {
        std::ifstream in{suda / name, std::ios::binary};
        return std::string{std::istreambuf_iterator<char>{in}, {}};
    };
    const auto mission = mission_of(text_of("suda_combined_science_definition.xml"));
    const std::string file = text_of("sciData_2022_130_17_41_53.spl");
    std::istringstream expected{text_of("expected.csv")};
    std::size_t packets = 0;
    for (std::string line; std::getline(expected, line);)
        if (line.find(",SHCOARSE,") != std::string::npos) ++packets;
    REQUIRE(packets > 0);
    Sender sender;
    Follower follower{
        *mission, "tcp://127.0.0.1:" + std::to_string(sender.port), {.name = "packets", .skip = 4, .frame_octets = {}}};
    sender.give({file.begin(), file.end()});
    const auto rows = follower.ask_until("/runs/1/packets",
                                         [&](const std::string& text) { return count_of(text, "\"hex\"") == packets; });
    CHECK(count_of(rows, "\"hex\"") == packets);
    CHECK(count_of(rows, "not decoded") == 0);
    CHECK_THAT(rows, Catch::Contains("\"name\":\"SHCOARSE\",\"text\":\"389900330\""));
    CHECK_THAT(follower.ask("/runs/1/channels?names=IDX__SCIFETCHTIME32&format=csv"),
               Catch::Contains(",350845307,realtime"));
}

TEST_CASE("addresses that cannot be are refused in one line", "[server][downlink]") {
    for (const char* text :
         {"", "tcp://", "tcp://host", "tcp://:1", "tcp://h:0", "tcp://h:65536", "http://h:1", "tcp://h:1x"}) {
        INFO(text);
        CHECK_FALSE(DownlinkAddress::parse(text));
    }
    CHECK(DownlinkAddress::parse("tcp://[::1]:5000")->host == "::1");
    CHECK(DownlinkAddress::parse("tcp://[::1]:5000")->text() == "tcp://[::1]:5000");
    CHECK(DownlinkAddress::parse("udp://0.0.0.0:0")->udp);
}

}  // namespace server_downlink_follower_test
