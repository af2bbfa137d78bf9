#include "flight/edl_comm/edl_comm.hpp"

#include "common/space_packet.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/outbox.hpp"

#include <algorithm>
#include <vector>

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

TEST_CASE("what is radiated is what was recorded, bit for bit", "[edl_comm][R29]") {
    Fixture f;
    f.handle(record(packet::TimepointFired::apid));
    const std::vector<std::uint8_t> recorded(f.recorder.bus->nvm.begin(), f.recorder.bus->nvm.end());
    std::vector<std::uint8_t> radiated;
    for (int i = 0; i < 10; ++i) {
        f.tick();
        radiated.insert(radiated.end(), f.recorder.bus->uhf.begin(), f.recorder.bus->uhf.end());
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
    CHECK(radiated <= 20 * 1000 + tm_overhead_octets + record_octets_max + 16);
    CHECK(radiated >= 19 * 1000);
}

TEST_CASE("events overtake channels when the link is slow", "[edl_comm][R30]") {
    Fixture f{8000.0};
    f.handle(PhaseChanged{EdlPhase::exo_atmospheric});
    for (int i = 0; i < 8; ++i) f.handle(record(packet::GncNavigation::apid, 120));
    f.handle(record(evr::COMMAND_ACCEPTED::apid, 4));
    while (f.recorder.bus->uhf.empty()) f.tick();
    const auto header = read_primary_header(f.recorder.bus->uhf.span());
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

TEST_CASE("when the recording is nearly full channels stop and events go on", "[edl_comm][R29]") {
    Fixture f;
    f.handle(NvmStatus{940'000, 1'000'000});
    f.recorder.bus->begin_cycle();
    f.handle(record(packet::GncImu::apid));
    CHECK(f.recorder.bus->nvm.empty());
    CHECK(f.recorder.events<evr::NVM_FULL>() == 1);
    f.handle(record(packet::GncImu::apid));
    CHECK(f.recorder.events<evr::NVM_FULL>() == 0);
    f.handle(record(evr::NVM_FULL::apid));
    CHECK_FALSE(f.recorder.bus->nvm.empty());
    CHECK(f.comm.unrecorded_packets() == 2);
}

TEST_CASE("which packets go to ground follows the phase", "[edl_comm][telemetry_plan][R30]") {
    CHECK(realtime_every(Plan::mission, EdlPhase::late_cruise, packet::GncDescent::apid) == 0);
    CHECK(realtime_every(Plan::mission, EdlPhase::powered_descent, packet::GncDescent::apid) > 0);
    CHECK(realtime_every(Plan::mission, EdlPhase::powered_descent, packet::GncEntry::apid) == 0);
}
