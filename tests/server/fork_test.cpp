// SPDX-License-Identifier: Apache-2.0
#include "server/archive/items.hpp"
#include "server/archive/reader.hpp"
#include "server/archive/run_differences.hpp"
#include "server/archive/sqlite.hpp"
#include "server/instruction/plan_library.hpp"
#include "server/rehearsal/again_of.hpp"
#include "server/scenario/scenario_text.hpp"
#include "tests/server/running_server.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <atomic>
#include <chrono>
#include <spdlog/spdlog.h>
#include <thread>

namespace server_fork_test {

using namespace aeolis;
using namespace aeolis::server;

namespace {

RehearsalRunner::Callbacks told_to(std::atomic<bool>& begun, std::string& failure) {
    RehearsalRunner::Callbacks callbacks;
    callbacks.on_begun = [&](Result<v1::RunState> state) {
        if (!state) failure = state.error().message;
        begun = true;
    };
    callbacks.on_state = [](const auto&) {};
    callbacks.on_clocks = [](const auto&) {};
    return callbacks;
}

void wait_for(const std::function<bool()>& done) {
    while (!done()) std::this_thread::sleep_for(std::chrono::milliseconds{1});
}

/// An archive of runs that are flown and forked.
class Runs {
  public:
    explicit Runs(const std::filesystem::path& copied_from = {}) {
        spdlog::set_level(spdlog::level::off);
        if (!copied_from.empty()) std::filesystem::copy_file(copied_from, file_);
    }

    /// Flies the landing of seed 7, and gives it a command, a fault and a note on the way.
    void fly() const {
        auto pipeline = opened();
        {
            std::atomic<bool> begun{false};
            std::string failure;
            RehearsalRunner runner{test::short_landing(), 7, 0.0, dictionary_, *pipeline, told_to(begun, failure)};
            wait_for([&] { return begun.load(); });
            v1::CommandRequest request;
            request.set_command("NO_OP");
            REQUIRE(runner.order(SendCommands{{request}, false, [](const auto&) {}}));
            InterveneRun fault;
            auto& device_fault = *fault.intervention.mutable_fault()->mutable_device_fault();
            device_fault.set_device(v1::DEVICE_IMU);
            device_fault.set_unit(v1::REDUNDANT_UNIT_A);
            device_fault.set_kind(v1::DEVICE_FAULT_KIND_DROPOUT);
            device_fault.set_duration_s(2.0);
            REQUIRE(runner.order(fault));
            wait_for([&] { return pipeline->figures().published_items > 2'000; });
            archive::NoteRecord note;
            note.text = "in the middle";
            note.by = "flight";
            note.ert = {reader().run(parent)->clock().scet_us()};
            std::atomic<bool> noted{false};
            REQUIRE(pipeline->annotate(parent, note, [&](const auto& kept) { noted = kept.ok(); }));
            archive::ProcedureActRecord begin;
            begin.ert = note.ert;
            begin.kind = archive::ProcedureActKind::begin;
            begin.procedure = "computer_reset";
            begin.text = *server::instruction::text_of_file(AEOLIS_SOURCE_DIR
                                                            "/dictionaries/msl/procedures/computer_reset.yaml");
            begin.position = "systems";
            begin.by = "flight";
            std::atomic<bool> begun_one{false};
            REQUIRE(pipeline->act(parent, begin,
                                  [&](const auto& acted) { begun_one = acted && acted->outcome.refused.empty(); }));
            archive::PositionActRecord seat;
            seat.ert = note.ert;
            seat.kind = archive::PositionActKind::take;
            seat.position = "systems";
            seat.by = "flight";
            std::atomic<bool> taken{false};
            REQUIRE(pipeline->act(parent, seat,
                                  [&](const auto& acted) { taken = acted && acted->outcome.refused.empty(); }));
            wait_for([&] { return noted.load() && begun_one.load() && taken.load(); });
            wait_for([&] { return runner.over(); });
            REQUIRE(failure.empty());
        }
    }

    archive::Reader reader() const { return std::move(archive::Reader::open(file_, dictionary_)).value(); }
    std::unique_ptr<PipelineThread> opened() const {
        auto archive = archive::Archive::open(file_);
        REQUIRE(archive);
        return std::make_unique<PipelineThread>(std::move(*archive), dictionary_, PipelineThread::Faults::give_up,
                                                [](const auto&) {});
    }

    /// Forks the parent and flies the fork to its end, after `meanwhile` while it waits at the fork. @return why not
    std::string fork(const std::string& at, std::uint64_t seed = 0,
                     const std::function<void(RehearsalRunner&)>& meanwhile = {}, archive::RunId of = parent) {
        v1::StartRehearsal request;
        request.mutable_fork()->set_run(of.value);
        request.mutable_fork()->set_at(at);
        request.mutable_fork()->set_seed(seed);
        request.mutable_fork()->set_paused(bool{meanwhile});
        auto from = reader();
        auto again = again_of(request, from);
        if (!again) return again.error().message;
        auto scenario = scenario_from_text(again->run.scenario_text, "its row");
        REQUIRE(scenario);
        auto pipeline = opened();
        std::atomic<bool> begun{false};
        std::string failure;
        RehearsalRunner runner{*scenario, std::move(*again), 0.0, dictionary_, *pipeline, told_to(begun, failure)};
        wait_for([&] { return begun.load(); });
        if (failure.empty() && meanwhile) {
            meanwhile(runner);
            REQUIRE(runner.order(PauseRun{false}));
        }
        wait_for([&] { return runner.over(); });
        return failure;
    }

    std::vector<std::string> items(archive::RunId run) const {
        auto from = reader();
        std::vector<std::string> items;
        for (;;) {
            const auto page = from.items(run, items.size(), archive::items_page_max);
            REQUIRE(page);
            if (page->items.empty()) return items;
            for (const auto& item : page->items) items.push_back(item.SerializeAsString());
        }
    }
    v1::RunDifferences differences(archive::RunId run, archive::RunId other) const {
        auto from = reader();
        auto found = archive::differences(from, dictionary_, run, other);
        REQUIRE(found);
        return *found;
    }
    void execute(const char* sql) {
        auto database = archive::sqlite::Database::open(file_.string(), archive::sqlite::Mode::read_write_create);
        REQUIRE(database);
        REQUIRE(database->execute(sql));
    }

    const std::filesystem::path& file() const { return file_; }

    static constexpr archive::RunId parent{1}, child{2};

  private:
    test::TemporaryFolder folder_;
    std::filesystem::path file_ = folder_ / "runs.db";
    const dictionary::Dictionary& dictionary_ = tests::shipped_dictionary();
};

/// The archive with the recorded landing, which is flown once for all who fork it.
class Recorded : public Runs {
  public:
    Recorded() : Runs{flown().file()} {}

  private:
    static const Runs& flown() {
        static const auto runs = [] {
            auto made = std::make_unique<Runs>();
            made->fly();
            return made;
        }();
        return *runs;
    }
};

const v1::EventDifference* named(const google::protobuf::RepeatedPtrField<v1::EventDifference>& all,
                                 const std::string& name) {
    const auto found = std::ranges::find(all, name, [](const auto& each) { return each.name(); });
    return found == all.end() ? nullptr : &*found;
}

}  // namespace

TEST_CASE("a fork to which nothing is done is its parent again, item by item, notes and all",
          "[fork][rehearsal][R60]") {
    Recorded recorded;
    CHECK(recorded.fork("E+3:10") == "");
    auto reader = recorded.reader();
    const auto parent = reader.run(Recorded::parent), child = reader.run(Recorded::child);
    REQUIRE(child);
    CHECK(child->forked_from().run() == 1);
    CHECK(child->forked_from().e_s() == 190.0);
    CHECK(child->state() == v1::RunState::finished);
    CHECK(child->outcome() == parent->outcome());
    CHECK(child->digest() == parent->digest());
    CHECK(recorded.items(Recorded::child) == recorded.items(Recorded::parent));
    CHECK(reader.position_acts(Recorded::child)->size() == 1);
    REQUIRE(reader.procedures(Recorded::child)->size() == 1);  // it is still carried out behind the fork
    CHECK(Ert{reader.procedures(Recorded::child)->front().ert_us()} >
          Ert{reader.procedure_acts(Recorded::child, 1)->front().ert_us() + 60'000'000});
    const auto found = recorded.differences(Recorded::child, Recorded::parent);
    CHECK(found.part_e_s() == 190.0);
    CHECK(found.events_size() == 0);
    CHECK(found.timepoints_size() == 0);
    CHECK(found.channels_size() == 0);
    CHECK(found.channels_equal() > 150);
}

TEST_CASE("what is done at a fork acts from there on, and the differences name it", "[fork][rehearsal][R60]") {
    Recorded recorded;
    const auto failure = recorded.fork("E+1:40", 0, [](RehearsalRunner& runner) {
        InterveneRun reset;
        reset.intervention.mutable_fault()->set_computer_reset(true);
        REQUIRE(runner.order(reset));
    });
    CHECK(failure == "");
    const auto before = recorded.items(Recorded::parent), after = recorded.items(Recorded::child);
    const auto parted = std::ranges::mismatch(before, after).in1 - before.begin();
    CHECK(parted > 2'000);
    CHECK(static_cast<std::size_t>(parted) < before.size());
    const auto found = recorded.differences(Recorded::parent, Recorded::child);
    CHECK(found.events_size() > 0);
    for (const auto& each : found.events()) CHECK(std::max(each.e_s(), each.other_e_s()) >= 100.0);
    REQUIRE(found.channels_size() > 10);
    CHECK(found.channels(0).from_e_s() >= 100.0);
}

TEST_CASE("a fork with a seed of its own meets other air, and the same until then", "[fork][rehearsal][R60]") {
    Recorded recorded;
    CHECK(recorded.fork("E-0:05", 12) == "");
    auto reader = recorded.reader();
    const auto child = reader.run(Recorded::child);
    REQUIRE(child);
    CHECK(child->forked_from().seed() == 12);
    CHECK(child->digest() != reader.run(Recorded::parent)->digest());
    const auto found = recorded.differences(Recorded::child, Recorded::parent);
    const auto* mortar = named(found.timepoints(), "parachute_deploy");
    REQUIRE(mortar != nullptr);
    CHECK(mortar->e_s() != mortar->other_e_s());
    for (const auto& channel : found.channels()) CHECK(channel.from_e_s() >= -5.0);

    SECTION("and is flown again as it was, as a run of its own") {
        auto again = reader.flown(Recorded::child);
        REQUIRE(again);
        CHECK(again->requests.size() == reader.flown(Recorded::parent)->requests.size() + 1);
    }
}

TEST_CASE("a fork knows nothing of what was written about its parent later, and can be forked itself",
          "[fork][rehearsal][R60]") {
    Recorded recorded;
    CHECK(recorded.fork("E-14:00", 12) == "");  // long before the note
    const auto items = recorded.items(Recorded::child);
    for (std::size_t i = 0; i < items.size(); ++i) {
        v1::Item item;
        REQUIRE(item.ParseFromString(items[i]));
        CHECK(item.seq() == i + 1);
        CHECK_FALSE(item.has_note());
    }
    CHECK(recorded.fork("E-14:00", 0, {}, Recorded::child) == "");
    CHECK(recorded.items(archive::RunId{3}) == items);
}

TEST_CASE("a fork whose parent does not come out the same ends there, and names the item that differs",
          "[fork][rehearsal][R60]") {
    Recorded recorded;
    recorded.execute("UPDATE events SET text = 'of another program' WHERE key = (SELECT min(key) FROM events)");
    const auto failure = recorded.fork("E+0:10");
    CHECK_THAT(failure, Catch::Contains("run 2: it could not be forked from run 1: run 1: flown again, item"));
    const auto child = recorded.reader().run(Recorded::child);
    REQUIRE(child);
    CHECK(child->state() == v1::RunState::finished);
    CHECK(child->outcome() == v1::Landing::stopped);
}

TEST_CASE("a fork that cannot be is refused in words", "[fork][rehearsal][R60]") {
    Recorded recorded;
    const auto refusal = [&](const v1::StartRehearsal& request) {
        auto reader = recorded.reader();
        const auto again = again_of(request, reader);
        return again ? std::string{} : again.error().message;
    };
    v1::StartRehearsal request;
    auto& fork = *request.mutable_fork();
    fork.set_at("E+1:00");
    CHECK(refusal(request) == "fork: no run 0");
    fork.set_run(9);
    CHECK(refusal(request) == "no run 9");
    fork.set_run(1);
    fork.set_at("");
    CHECK(refusal(request) == "fork.at: an instant of the run is wanted, like E+3:10");
    fork.set_at("soon");
    CHECK_THAT(refusal(request), Catch::StartsWith("fork.at: 'soon' is no instant"));
    fork.set_at("E-1:00:00");
    CHECK(refusal(request) == "fork.at: E-1:00:00 is before run 1 begins, at E-900 s");
    fork.set_at("1e300");
    CHECK_THAT(refusal(request), Catch::StartsWith("fork.at: 1e300 is after all that a run can hold"));
    fork.set_at("E+1:00");
    request.set_seed(3);
    CHECK(refusal(request) == "fork: the run has its scenario and its seed; leave them out");
    request.set_seed(0);
    request.set_continue_run(1);
    CHECK(refusal(request) == "fork and continue_run: one of them, not both");

    CHECK_THAT(recorded.fork("E+9:00:00"), Catch::StartsWith("fork.at: E+32400.0 s is after the record of run 1 ends"));
}

TEST_CASE("an instant by Earth's clock is when Earth has received so much", "[fork][R60]") {
    Recorded recorded;
    auto run = *recorded.reader().run(Recorded::parent);
    v1::Fork fork;
    fork.set_at("E+1:00");
    const auto by_vehicle = fork_point_of(fork, run);
    REQUIRE(by_vehicle);
    CHECK(by_vehicle->cycle == (900U + 60U) * 64U);
    run.set_light_time_s(830.0);
    const Scet then{archive::correlation_of(run).scet_of(Sclk{run.entry_sclk() + 60.0})};
    fork.set_at("ert:" + day_of_year_text(then));
    const auto by_earth = fork_point_of(fork, run);
    REQUIRE(by_earth);
    CHECK(by_earth->cycle == by_vehicle->cycle);
}

}  // namespace server_fork_test
