// SPDX-License-Identifier: Apache-2.0
#include "flight/edl_comm/edl_comm.hpp"

#include "common/space_packet.hpp"
#include "telemetry/packet_stream.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/outbox.hpp"
#include "tests/support/radiated.hpp"

#include <algorithm>
#include <map>
#include <random>
#include <vector>

namespace flight_edl_comm_test {

using namespace aeolis;
using namespace aeolis::flight;

namespace {

constexpr NvmStatus roomy{0, 100'000'000};

Record record(Apid apid, std::uint16_t size = 20) {
    Record r{apid, Sclk{7.5}, size, {}};
    for (std::size_t i = 0; i < size; ++i) r.data[i] = static_cast<std::uint8_t>(i);
    return r;
}

Load load_with(double uhf_rate_bps) {
    Load load;
    load.uhf_rate_bps = uhf_rate_bps;
    return load;
}

struct Fixture {
    EdlComm comm;
    test::OutboxRecorder recorder{ModuleId::edl_comm};
    double now_s = 0.015625;

    explicit Fixture(double rate_bps = 8000.0) : comm(load_with(rate_bps)) { handle(roomy); }
    template <typename M>
    void handle(const M& message) {
        recorder.begin(ModuleId::edl_comm, Sclk{now_s});
        comm.on(message, recorder.out);
    }
    void tick() {
        recorder.bus->begin_cycle();
        now_s += seconds_per_tick;
        handle(ClockTick{Sclk{now_s}});
    }
};

}  // namespace

TEST_CASE("every record is sealed as a packet and appended to the recording", "[edl_comm][R29]") {
    Fixture f;
    f.handle(record(packet::GncImu::apid));
    f.handle(record(packet::GncImu::apid));
    const auto& nvm = f.recorder.bus->nvm;
    REQUIRE(nvm.size() == 2 * (20 + tm_overhead_octets));
    const auto first = read_tm_packet(nvm.span().first(20 + tm_overhead_octets));
    const auto second = read_tm_packet(nvm.span().subspan(20 + tm_overhead_octets));
    REQUIRE((first && second));
    CHECK(first->time == Sclk{7.5});
    CHECK(first->dictionary_id == dictionary_id);
    CHECK(second->primary.count == first->primary.count + 1);
}

TEST_CASE("what computer B says of itself has names of its own, what it says of the vehicle has none",
          "[edl_comm][R29]") {
    const auto recorded_as = [](Apid apid, String string) {
        Load load;
        load.string = string;
        EdlComm comm{load};
        test::OutboxRecorder recorder{ModuleId::edl_comm};
        comm.on(roomy, recorder.out);
        comm.on(record(apid), recorder.out);
        return read_tm_packet(recorder.bus->nvm.span())->primary.apid;
    };
    CHECK(recorded_as(packet::CommStatus::apid, String::a) == packet::CommStatus::apid);
    CHECK(recorded_as(packet::CommStatus::apid, String::b) == packet::CommStatusB::apid);
    CHECK(recorded_as(packet::SyncStatus::apid, String::b) == packet::SyncStatusB::apid);
    CHECK(recorded_as(packet::GncImu::apid, String::b) == packet::GncImu::apid);
}

TEST_CASE("what is radiated is what was recorded, bit for bit", "[edl_comm][R29]") {
    Fixture f;
    f.handle(record(packet::TimepointFired::apid));
    const std::vector<std::uint8_t> recorded(f.recorder.bus->nvm.begin(), f.recorder.bus->nvm.end());
    std::vector<std::uint8_t> radiated;
    for (int i = 0; i < 10; ++i) {
        f.tick();
        for (const auto& packet : test::packets_in_pltus(f.recorder.bus->uhf.span()))
            radiated.insert(radiated.end(), packet.begin(), packet.end());
    }
    CHECK(radiated == recorded);
}

TEST_CASE("the link is never given more than its rate", "[edl_comm][R30]") {
    Fixture f{8000.0};
    std::size_t radiated = 0;
    for (int cycle = 0; cycle < 64 * 20; ++cycle) {
        f.handle(record(packet::Explanation::apid, 100));
        f.tick();
        radiated += f.recorder.bus->uhf.size();
    }
    CHECK(radiated <= 20 * 1000 + pltu_octets_max);
    CHECK(radiated >= 19 * 1000);
}

TEST_CASE("frames of one computer count on, and hold as many packets as wait", "[edl_comm][R30]") {
    Fixture f{8000.0};
    telemetry::PltuReceiver ground;
    std::size_t frames = 0;
    for (int cycle = 0; cycle < 64 * 60; ++cycle) {
        f.handle(record(packet::Explanation::apid, 40));
        f.tick();
        ground.receive(f.recorder.bus->uhf.span());
        while (const auto received = ground.next()) {
            CHECK(received->frame.header.expedited);
            CHECK(received->frame.header.sequence == static_cast<std::uint8_t>(frames++));
        }
    }
    CHECK(ground.counters().missing_frames == 0);
    CHECK(frames == Approx(60.0 * 1000.0 / 256.0).epsilon(0.2));
}

TEST_CASE("events overtake channels when the link is slow", "[edl_comm][R30]") {
    Fixture f{8000.0};
    f.handle(PhaseChanged{EdlPhase::exo_atmospheric});
    for (int i = 0; i < 8; ++i) f.handle(record(packet::GncNavigation::apid, 120));
    f.handle(record(evr::COMMAND_ACCEPTED::apid, 4));
    while (f.recorder.bus->uhf.empty()) f.tick();
    const auto header = read_primary_header(test::packets_in_pltus(f.recorder.bus->uhf.span()).front());
    REQUIRE(header);
    CHECK(header->apid == evr::COMMAND_ACCEPTED::apid);
}

TEST_CASE("real time lost for want of room is never lost from the recording", "[edl_comm][R29][R30]") {
    Fixture f{8000.0};
    std::size_t recorded = 0;
    for (int i = 0; i < 400; ++i) {
        f.recorder.bus->begin_cycle();
        f.handle(record(packet::TimepointFired::apid, 30));
        recorded += f.recorder.bus->nvm.size();
    }
    CHECK(recorded == 400 * (30 + tm_overhead_octets));
}

TEST_CASE("when the recording is nearly full channels stop and events go on, and a tone says so",
          "[edl_comm][R29][R31]") {
    Fixture f;
    f.handle(NvmStatus{940'000, 1'000'000});
    f.recorder.bus->begin_cycle();
    f.handle(record(packet::GncImu::apid));
    CHECK(f.recorder.bus->nvm.empty());
    CHECK(f.recorder.events<evr::NVM_FULL>() == 1);
    const auto tones = f.recorder.sent<ToneRequest>();
    REQUIRE(tones.size() == 1);
    CHECK(tones.front().tone == tone::recording_fault);
    f.handle(record(packet::GncImu::apid));
    CHECK(f.recorder.sent<ToneRequest>().empty());
    CHECK(f.recorder.events<evr::NVM_FULL>() == 0);
    f.handle(record(evr::NVM_FULL::apid));
    CHECK_FALSE(f.recorder.bus->nvm.empty());
    CHECK(f.comm.unrecorded_packets() == 2);
}

TEST_CASE("which packets go to ground, and how many, follows the state of the vehicle", "[edl_comm][R30]") {
    const auto sent_in = [](EdlPhase phase, Apid apid) {
        Fixture f;
        f.handle(PhaseChanged{phase});
        std::size_t sent = 0;
        for (int i = 0; i < 64; ++i) {
            f.handle(record(apid));
            f.tick();
            sent += f.recorder.bus->uhf.size() / (20 + tm_overhead_octets);
        }
        return sent;
    };
    CHECK(sent_in(EdlPhase::late_cruise, packet::GncDescent::apid) == 0);
    CHECK(sent_in(EdlPhase::powered_descent, packet::GncDescent::apid) == 2);
    CHECK(sent_in(EdlPhase::landed, packet::GncDescent::apid) == 0);
    CHECK(sent_in(EdlPhase::range_control, packet::GncNavigation::apid) == 2);
    CHECK(sent_in(EdlPhase::powered_descent, packet::GncEntry::apid) == 0);
}

TEST_CASE("that the queue for the link is full is said once an episode", "[edl_comm][R30]") {
    Fixture f{800.0};
    int said = 0;
    const auto fill = [&] {
        for (std::size_t i = 0; i < RealtimeQueue::packets_max + 20; ++i) {
            f.handle(record(packet::TimepointFired::apid));
            said += f.recorder.events<evr::UHF_QUEUE_FULL>();
            f.recorder.bus->begin_cycle();
        }
    };
    fill();
    CHECK(said == 1);
    fill();
    CHECK(said == 1);
    while (f.comm.queue().waiting() > RealtimeQueue::packets_max / 2) f.tick();
    fill();
    CHECK(said == 2);
}

TEST_CASE("under any load and rate what is radiated keeps the rate, was recorded, and the counts add up",
          "[edl_comm][R29][R30]") {
    struct Kind {
        Apid apid;
        std::uint16_t size;
    };
    constexpr std::array kinds{Kind{packet::TimepointFired::apid, 19}, Kind{packet::Explanation::apid, 90},
                               Kind{packet::EdlStatus::apid, 20},      Kind{packet::GncImu::apid, 28},
                               Kind{packet::GncRadar::apid, 25},       Kind{packet::DataProduct::apid, 245}};
    for (unsigned seed = 1; seed <= 24; ++seed) {
        std::mt19937 random{seed};
        const double rate_bps = std::array{500.0, 2000.0, 8000.0, 64000.0}[seed % 4];
        INFO("seed " << seed << ", " << rate_bps << " bit/s");
        Fixture f{rate_bps};
        f.handle(PhaseChanged{EdlPhase::sky_crane});
        std::vector<std::vector<std::uint8_t>> recorded;
        std::map<Apid, std::size_t> last_of;  // index in the recording of the last radiated of each stream
        std::size_t chosen = 0;
        std::size_t sent = 0;
        double radiated_octets = 0.0;
        std::array<std::uint32_t, 128> since{};
        for (int cycle = 1; cycle <= 1500; ++cycle) {
            f.recorder.bus->begin_cycle();
            for (unsigned n = random() % (1 + seed); n > 0; --n) {
                const Kind& kind = kinds[random() % kinds.size()];
                f.handle(record(kind.apid, kind.size));
                const std::uint32_t every = every_in(planned(Plan::mission, kind.apid).every, EdlPhase::sky_crane);
                if (++since[kind.apid.value % 128] == every) {
                    since[kind.apid.value % 128] = 0;
                    ++chosen;
                }
            }
            telemetry::PacketStream appended{f.recorder.bus->nvm.span()};
            while (const auto packet = appended.next()) recorded.emplace_back(packet->begin(), packet->end());
            f.tick();
            radiated_octets += static_cast<double>(f.recorder.bus->uhf.size());
            // Never more than the rate, but for the frame that an idle link may have saved up for.
            REQUIRE(radiated_octets <=
                    cycle * rate_bps / 512.0 + pltu_overhead_octets + telemetry_packet_octets_max + rate_bps / 512.0);
            for (const auto& packet : test::packets_in_pltus(f.recorder.bus->uhf.span())) {
                ++sent;
                const Apid apid = read_primary_header(packet)->apid;
                const auto from =
                    recorded.begin() + static_cast<std::ptrdiff_t>(last_of.contains(apid) ? last_of[apid] + 1 : 0);
                const auto found = std::find_if(from, recorded.end(),
                                                [&](const auto& one) { return std::ranges::equal(one, packet); });
                REQUIRE(found != recorded.end());  // recorded, bit for bit, and in the stream's order
                last_of[apid] = static_cast<std::size_t>(found - recorded.begin());
            }
            const RealtimeQueue& queue = f.comm.queue();
            REQUIRE(chosen == sent + queue.waiting() + queue.dropped());
        }
        if (rate_bps <= 2000.0 && seed > 8) {
            // Far too much for the link: what is least important suffers, the rest does not.
            CHECK(f.comm.queue().dropped(TelemetryPriority::low) > 0);
        }
    }
}

TEST_CASE("the cycle never waits for the link: a record costs one packet of the queue and no more", "[edl_comm][R30]") {
    Fixture f{0.0};
    for (int i = 0; i < 5000; ++i) {
        f.recorder.bus->begin_cycle();
        f.handle(record(packet::TimepointFired::apid));
        CHECK(f.recorder.bus->nvm.size() == 20 + tm_overhead_octets);
        f.tick();
        REQUIRE(f.recorder.bus->uhf.empty());
    }
    CHECK(f.comm.queue().waiting() == RealtimeQueue::packets_max);
    CHECK(f.comm.queue().dropped(TelemetryPriority::first) >= 5000 - RealtimeQueue::packets_max);
}

TEST_CASE("each record has a CRC: any flipped bit is found when the recording is read back", "[edl_comm][R29]") {
    Fixture f;
    for (int i = 0; i < 6; ++i) f.handle(record(packet::GncImu::apid, static_cast<std::uint16_t>(20 + i)));
    const auto& nvm = f.recorder.bus->nvm;
    std::vector<std::uint8_t> recording(nvm.begin(), nvm.end());
    const auto sound_packets = [&] {
        telemetry::PacketStream stream{recording};
        std::size_t sound = 0;
        while (const auto packet = stream.next()) sound += read_tm_packet(*packet).has_value();
        return sound;
    };
    REQUIRE(sound_packets() == 6);
    for (std::size_t bit = 0; bit < recording.size() * 8; ++bit) {
        const auto mask = static_cast<std::uint8_t>(1U << (bit % 8));
        recording[bit / 8] ^= mask;
        CHECK(sound_packets() < 6);
        recording[bit / 8] ^= mask;
    }
}

TEST_CASE("the recording outlives a reset of the computer: what comes after stands behind what was there",
          "[edl_comm][R29]") {
    Fixture before;
    before.handle(record(packet::GncImu::apid));
    std::vector<std::uint8_t> recording(before.recorder.bus->nvm.begin(), before.recorder.bus->nvm.end());
    Fixture after;  // made anew, as a reset does; NVM tells it how far it is used
    after.handle(NvmStatus{static_cast<std::uint32_t>(recording.size()), 100'000'000});
    after.handle(record(packet::GncImu::apid));
    recording.insert(recording.end(), after.recorder.bus->nvm.begin(), after.recorder.bus->nvm.end());
    telemetry::PacketStream stream{recording};
    std::size_t sound = 0;
    while (const auto packet = stream.next()) sound += read_tm_packet(*packet).has_value();
    CHECK(sound == 2);
    CHECK(stream.unreadable_octets() == 0);
    // And it knows at once when the room it finds is nearly gone.
    after.handle(NvmStatus{999'000, 1'000'000});
    after.handle(record(packet::GncImu::apid));
    CHECK(after.recorder.events<evr::NVM_FULL>() == 1);
}

namespace {

Record firing(std::uint16_t timepoint) {
    Record r{packet::TimepointFired::apid, Sclk{7.5}, packet::TimepointFired::octets - tm_overhead_octets, {}};
    BitWriter writer{std::span{r.data}.first(r.size)};
    packet::TimepointFired{.timepoint = timepoint}.encode(writer);
    return r;
}

/// The recording's end, in a memory that keeps what it is given.
struct Closing : Fixture {
    std::vector<std::uint8_t> nvm;
    std::vector<ActionReply> answers;
    std::vector<ToneRequest> tones;

    /// A cycle: what is recorded in it is in NVM with the next.
    void cycle(const std::vector<Record>& records, std::uint32_t lag_octets = 0) {
        recorder.bus->begin_cycle();
        now_s += seconds_per_tick;
        handle(NvmStatus{static_cast<std::uint32_t>(nvm.size()) - lag_octets, 100'000'000});
        for (const Record& r : own_) handle(r);
        own_.clear();
        handle(ClockTick{Sclk{now_s}});
        for (const auto& reply : recorder.sent<ActionReply>()) answers.push_back(reply);
        for (const auto& tone : recorder.sent<ToneRequest>()) tones.push_back(tone);
        own_ = recorder.sent<Record>();
        for (const Record& r : records) handle(r);
        const auto octets = recorder.bus->nvm.span();
        nvm.insert(nvm.end(), octets.begin(), octets.end());
    }

  private:
    std::vector<Record> own_;  // a module outside the rate group hears itself in the next cycle
};

}  // namespace

TEST_CASE("the recording is closed when NVM holds it and the timeline is complete, and RECORDING_CLOSED is its end",
          "[edl_comm][R29][R50]") {
    Closing f;
    f.cycle({record(packet::GncImu::apid)});
    f.handle(CloseRecording{});
    f.cycle({record(packet::GncImu::apid)}, 5);  // NVM lags behind
    CHECK(f.answers.empty());
    f.cycle({record(packet::GncImu::apid)});
    REQUIRE(f.answers.size() == 1);
    CHECK(f.answers[0] == ActionReply{ReplyKind::recording, 0});
    for (int i = 0; i < 64; ++i) f.cycle({record(packet::GncImu::apid)});
    CHECK(f.tones.empty());  // the last timepoint has not fired

    f.cycle({firing(timepoint_count - 1)});
    for (int i = 0; i < 64; ++i) f.cycle({record(packet::GncImu::apid)});
    REQUIRE(f.tones.size() == 1);
    CHECK(f.tones[0].tone == tone::recording_closed);
    const std::size_t closed_octets = f.nvm.size();
    for (int i = 0; i < 64; ++i) f.cycle({record(packet::GncImu::apid), record(evr::TOUCHDOWN::apid)});
    CHECK(f.nvm.size() == closed_octets);
    CHECK(f.comm.unrecorded_packets() == 0);

    std::span<const std::uint8_t> last;
    bool as_flown = false;
    telemetry::PacketStream packets{f.nvm};
    while (const auto packet = packets.next()) {
        last = *packet;
        as_flown |= read_primary_header(last)->apid == packet::DataProduct::apid;
    }
    CHECK(as_flown);
    CHECK(read_primary_header(last)->apid == evr::RECORDING_CLOSED::apid);
    CHECK(read_bits(last, tm_data_offset_octets * 8, 16) == evr::RECORDING_CLOSED::id.value);
}

TEST_CASE("a recording that lost packets for want of room says that it is not closed as commanded", "[edl_comm][R50]") {
    Closing f;
    f.handle(NvmStatus{99'990'000, 100'000'000});
    f.handle(record(packet::GncImu::apid));
    f.handle(CloseRecording{});
    f.recorder.begin(ModuleId::edl_comm, Sclk{8.0});
    f.comm.on(NvmStatus{99'999'000, 100'000'000}, f.recorder.out);
    f.comm.on(ClockTick{Sclk{8.0}}, f.recorder.out);
    REQUIRE(f.recorder.sent<ActionReply>().size() == 1);
    CHECK(f.recorder.sent<ActionReply>()[0].evidence == Evidence::refused);
}

TEST_CASE("a record that no packet can hold is refused and reported", "[edl_comm][R4]") {
    Fixture f;
    Record impossible{packet::GncImu::apid, Sclk{7.5}, record_octets_max + 1, {}};
    f.handle(impossible);
    CHECK(f.recorder.bus->nvm.empty());
    CHECK(f.recorder.events<evr::UNEXPECTED_MESSAGE>() == 1);
}

}  // namespace flight_edl_comm_test
