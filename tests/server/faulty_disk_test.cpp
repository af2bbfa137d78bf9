// SPDX-License-Identifier: Apache-2.0
// What the archive promises, on a disk that loses power or fails at any moment.
#include "server/archive/reader.hpp"
#include "server/archive/sqlite.hpp"
#include "server/pipeline/derivation.hpp"
#include "server/pipeline/pipeline.hpp"
#include "server/rehearsal/rehearsal.hpp"
#include "tests/server/archive/faulty_disk.hpp"
#include "tests/server/running_server.hpp"
#include "tests/server/small_mission.hpp"
#include "tests/server/web_client.hpp"
#include "tests/support/slept_time.hpp"

#include "server/base/json.hpp"

#include <fstream>
#include <future>
#include <random>

namespace server_faulty_disk_test {

using namespace aeolis;
using namespace aeolis::test;
using archive::Archive;
using archive::Reader;
using archive::Sequence;
using pipeline::Pipeline;

namespace {

/// What a landing sends home, a step a commit.
struct Flown {
    archive::RunStart start;
    struct Step {
        std::vector<telemetry::ReceivedPacket> packets;
        std::vector<telemetry::ReceivedTone> tones;
        std::vector<telemetry::LinkState> links;
        std::vector<archive::StageRecord> stages;
    };
    std::vector<Step> steps;
};

/// From before the first timepoint until so many packets have come, some of each step's cycles together.
Flown fly(std::size_t packets, std::size_t cycles_a_step) {
    auto scenario = shipped_scenario("nominal_auto");
    scenario.start_before_entry_s = 620.0;  // UHF begins at 600
    scenario.commands[0].send_before_entry_s = 615.0;
    scenario.commands[1].send_before_entry_s = 610.0;
    scenario.radio.tones_from_samples = false;
    server::Rehearsal rehearsal{scenario, 3, 0, tests::shipped_dictionary()};
    Flown flown{rehearsal.run_start(1.0), {}};
    for (std::size_t received = 0; received < packets && !rehearsal.finished();) {
        Flown::Step step;
        for (std::size_t i = 0; i < cycles_a_step; ++i) {
            const auto& report = rehearsal.step();
            const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
            append(step.packets, report.packets);
            append(step.tones, report.tones);
            append(step.links, report.links);
            append(step.stages, rehearsal.take_stages());
            received += report.packets.size();
        }
        if (!step.packets.empty() || !step.tones.empty() || !step.links.empty() || !step.stages.empty())
            flown.steps.push_back(std::move(step));
    }
    return flown;
}

/// What was acknowledged.
struct Published {
    std::optional<archive::RunId> run;
    bool finished = false;
    std::vector<std::string> items;  ///< item i + 1
};

/// Stores the landing until it ends or the disk fails; now and then another connection folds the WAL into the file.
void store(const Flown& flown, const std::filesystem::path& file, Published& published) {
    auto archive = Archive::open(file);
    if (!archive) return;
    auto other = archive::sqlite::Database::open(file.string(), archive::sqlite::Mode::read_write_create);
    Pipeline pipeline{*archive, tests::shipped_dictionary()};
    pipeline.on_publish([&](const auto& batch) {
        for (const auto& item : batch->items) published.items.push_back(item.SerializeAsString());
    });
    if (const auto run = pipeline.begin(flown.start); run)
        published.run = *run;
    else
        return;
    std::size_t count = 0;
    for (const auto& step : flown.steps) {
        for (const auto& each : step.links)
            if (!pipeline.accept(each)) return;
        for (const auto& each : step.packets)
            if (!pipeline.accept(each)) return;
        for (const auto& each : step.tones)
            if (!pipeline.accept(each)) return;
        for (const auto& each : step.stages)
            if (!pipeline.accept(each)) return;
        if (!pipeline.commit()) return;
        if (++count % 16 == 0 && other)
            (void)other->execute(count % 64 == 0 ? "PRAGMA wal_checkpoint(TRUNCATE)" : "PRAGMA wal_checkpoint").ok();
    }
    published.finished = pipeline.finish({archive::Outcome::stopped, "", "d", ""}).ok();
}

/// Everything that was acknowledged is in the archive, which is whole and can be written on.
void check_kept(const std::filesystem::path& file, const Published& published, const std::filesystem::path& scratch) {
    const auto& dictionary = tests::shipped_dictionary();
    {
        auto archive = Archive::open(file);
        REQUIRE(archive.ok());
        auto reader = Reader::open(file, dictionary);
        REQUIRE(reader.ok());
        if (published.run) {
            const auto state = reader->run(*published.run);
            REQUIRE(state.ok());
            if (published.finished)
                REQUIRE(state->state() == v1::RunState::finished);
            else
                REQUIRE(state->last_seq() >= published.items.size());
            Sequence after = 0;
            while (after < published.items.size()) {
                const auto page = reader->items(*published.run, after, archive::items_page_max);
                REQUIRE(page.ok());
                REQUIRE_FALSE(page->items.empty());
                for (const auto& item : page->items) {
                    REQUIRE(item.seq() == after + 1);
                    if (after < published.items.size()) REQUIRE(item.SerializeAsString() == published.items[after]);
                    ++after;
                }
            }
        }
        REQUIRE(archive->begin_run({}, dictionary).ok());
    }
    const auto verified = pipeline::verify(file, {}, dictionary, nullptr, scratch);
    REQUIRE(verified.ok());
    for (const auto& fault : verified->faults) FAIL_CHECK(fault);
}

void cut_power(int times, std::size_t packets) {
    const Flown flown = fly(packets, 64);
    std::uint64_t changes = 0;
    {
        TemporaryFolder folder;
        FaultyDisk disk;
        Published published;
        store(flown, folder / "a.db", published);
        REQUIRE(published.finished);
        changes = disk.changes();
    }
    std::mt19937_64 random{1};
    for (int i = 0; i < times; ++i) {
        // One in eight within the first changes: the file, its schema and the run are made there.
        const std::uint64_t at = 1 + random() % (i % 8 == 0 ? 200 : changes);
        INFO("power cut " << i << " at change " << at << " of " << changes);
        TemporaryFolder folder;
        std::filesystem::create_directory(folder / "after");
        Published published;
        {
            FaultyDisk disk;
            disk.cut_power_at(at);
            store(flown, folder / "a.db", published);
            REQUIRE(disk.power_is_cut());
            disk.leave(folder / "after", random());
        }
        check_kept(folder / "after/a.db", published, folder / "");
    }
}

}  // namespace

TEST_CASE("a power cut takes back nothing that was published, and leaves the archive whole",
          "[archive][pipeline][disk][R43]") {
    cut_power(20, 600);
}

TEST_CASE("two hundred power cuts take back nothing that was published", "[.long][archive][pipeline][disk]") {
    cut_power(200, 3'000);
}

TEST_CASE("a disk that loses what was not synced is told from one that keeps it", "[disk]") {
    TemporaryFolder folder;
    std::filesystem::create_directory(folder / "after");
    const auto rows_after = [&](const char* synchronous) {
        const auto file = folder / "t.db";
        {
            FaultyDisk disk;
            auto database = archive::sqlite::Database::open(file.string(), archive::sqlite::Mode::read_write_create);
            const auto run = [&](const char* sql) { REQUIRE(database->execute(sql).ok()); };
            run("PRAGMA journal_mode = WAL; CREATE TABLE IF NOT EXISTS t(x); DELETE FROM t; PRAGMA "
                "wal_checkpoint(TRUNCATE)");
            run(synchronous);
            for (int i = 0; i < 10; ++i) run("INSERT INTO t VALUES (1)");
            disk.leave(folder / "after", 1);
        }
        auto left =
            archive::sqlite::Database::open((folder / "after/t.db").string(), archive::sqlite::Mode::read_write_create);
        return *left->integer_of("SELECT count(*) FROM t");
    };
    CHECK(rows_after("PRAGMA synchronous = NORMAL") < 10);
    std::filesystem::remove_all(folder / "after");
    std::filesystem::create_directory(folder / "after");
    CHECK(rows_after("PRAGMA synchronous = FULL") == 10);
}

namespace {

/// Does what a ground does in its life on a disk on which the n-th operation fails. Each step that fails says so with
/// the file's name; then the disk is mended and the same step is asked for again.
class Life {
  public:
    Life(FaultyDisk& disk, const std::filesystem::path& folder)
        : disk_(disk), folder_(folder), file_(folder / "a.db") {}

    void live() {
        const auto dictionary = small_dictionary();
        std::optional<Archive> archive;
        retry_on_mended_disk([&]() -> Result<void> {
            auto opened = Archive::open(file_);
            if (!opened) return opened.error();
            archive.emplace(std::move(*opened));
            return {};
        });
        Pipeline pipeline{*archive, dictionary};
        pipeline.on_publish([&](const auto& batch) {
            for (const auto& item : batch->items) published_.push_back(item.SerializeAsString());
        });
        archive::RunId run;
        retry_on_mended_disk([&]() -> Result<void> {
            auto begun = pipeline.begin({});
            if (!begun) return begun.error();
            run = *begun;
            return {};
        });
        std::optional<Reader> reader;
        for (std::uint16_t i = 0; i < 1'200; ++i) {
            REQUIRE(pipeline.accept(live_packet(i)).ok());
            if (i % 400 == 17) REQUIRE(pipeline.accept(test::live(mortar_packet(i, 1000.0 + i, 405.0F))).ok());
            if (i % 300 != 299) continue;
            retry_on_mended_disk([&] { return pipeline.commit(); });
            // Who asks meanwhile gets all that was published, or an error in words.
            retry_on_mended_disk([&]() -> Result<void> {
                if (!reader) {
                    auto opened = Reader::open(file_, dictionary);
                    if (!opened) return opened.error();
                    reader.emplace(std::move(*opened));
                }
                return read_back(*reader, run);
            });
        }
        retry_on_mended_disk([&] { return pipeline.finish({archive::Outcome::touchdown, "", "d", ""}); });
        retry_on_mended_disk([&] { return read_back(*reader, run); });
        reader.reset();
        archive.reset();  // folds the WAL into the file; what fails of that is made up for at the next start
        disk_.mend();
        auto again = Reader::open(file_, dictionary);
        REQUIRE(again.ok());
        REQUIRE(read_back(*again, run).ok());
        const auto verified = pipeline::verify(file_, {}, dictionary, nullptr, folder_);
        REQUIRE(verified.ok());
        REQUIRE(verified->faults == std::vector<std::string>{});
    }

  private:
    static telemetry::ReceivedPacket live_packet(std::uint16_t i) {
        return test::live(navigation_packet(i, 1000.0 + i / 64.0, static_cast<float>(i), 5000.0F));
    }

    Result<void> read_back(Reader& reader, archive::RunId run) {
        auto page = reader.items(run, 0, archive::items_page_max);
        if (!page) return page.error();
        REQUIRE(page->items.size() == published_.size());
        for (std::size_t i = 0; i < published_.size(); ++i)
            REQUIRE(page->items[i].SerializeAsString() == published_[i]);
        return {};
    }

    template <typename Step>
    void retry_on_mended_disk(Step step) {
        const std::size_t before = published_.size();
        auto done = step();
        if (!done) {
            INFO(done.error().message);
            REQUIRE_THAT(done.error().message, Catch::Contains("a.db"));
            REQUIRE(published_.size() == before);
            disk_.mend();
            done = step();
        }
        if (!done) INFO("after the disk was mended: " << done.error().message);
        REQUIRE(done.ok());
    }

    FaultyDisk& disk_;
    std::filesystem::path folder_, file_;
    std::vector<std::string> published_;
};

/// n = first, first + stride, … until a life goes by untouched.
void fail_each(FaultyDisk::Fault fault, bool lasting, std::uint64_t first, std::uint64_t stride) {
    for (std::uint64_t nth = first;; nth += stride) {
        INFO("operation " << nth << " fails" << (lasting ? ", and all after it" : ""));
        TemporaryFolder folder;
        FaultyDisk disk;
        disk.fail_at(nth, fault, lasting);
        Life{disk, folder / ""}.live();
        if (disk.failed() == 0) return;
    }
}

}  // namespace

TEST_CASE("whichever operation of the disk fails, it is said, nothing published is lost, and it goes on when the disk "
          "is well",
          "[archive][pipeline][disk][R43]") {
    fail_each(FaultyDisk::Fault::input_output, false, 1, 23);
    fail_each(FaultyDisk::Fault::input_output, true, 2, 23);
    fail_each(FaultyDisk::Fault::full, true, 1, 11);
    fail_each(FaultyDisk::Fault::read_only, true, 1, 23);
}

TEST_CASE("the n-th operation of the disk fails, for every n", "[.long][archive][pipeline][disk]") {
    for (const bool lasting : {false, true})
        for (const auto fault :
             {FaultyDisk::Fault::input_output, FaultyDisk::Fault::full, FaultyDisk::Fault::read_only})
            fail_each(fault, lasting, 1, 1);
}

namespace {

/// A console that watches a landing of its own at a pace; what it is told of the archive.
class Watch {
  public:
    explicit Watch(RunningServer& server) : server_(server), client_(server.port(), "aeolis.v1.protobuf") {
        v1::ClientMessage message;
        message.mutable_subscribe()->set_all_channels(true);
        client_.send(message.SerializeAsString(), true);
    }

    /// Reads until `condition`; holds every item to the one before.
    template <typename Condition>
    void read_until(Condition condition) {
        while (!condition()) {
            const auto payload = client_.receive();
            REQUIRE(payload);
            v1::ServerMessage message;
            REQUIRE(message.ParseFromString(*payload));
            if (message.has_run_state()) fault = message.run_state().archive_fault();
            if (!message.has_batch()) continue;
            e_s = message.batch().clocks().e_s();
            for (const auto& item : message.batch().items()) REQUIRE(item.seq() == ++last);
        }
    }
    unsigned health() const { return web_request(server_.port(), "GET", "/healthz").status; }

    double e_s = -1e9;
    std::string fault;
    Sequence last = 0;

  private:
    RunningServer& server_;
    StreamClient client_;
};

simulation::Scenario from_uhf_on() {
    auto scenario = shipped_scenario("nominal_auto");
    scenario.start_before_entry_s = 600.0;
    scenario.commands[0].send_before_entry_s = 595.0;
    scenario.commands[1].send_before_entry_s = 590.0;
    return scenario;
}

/// Something happens to the disk in flight: that is said, the landing goes on, and afterwards all is stored.
template <typename Harm, typename Mend>
void harm_and_mend(const char* words, Harm harm, Mend mend) {
    FaultyDisk disk;
    std::filesystem::path file;
    Sequence last = 0;
    TemporaryFolder copies;
    {
        RunningServer server{from_uhf_on(), 60.0};
        file = server.archive();
        Watch watch{server};
        watch.read_until([&] { return watch.last > 200; });
        const double before_s = watch.e_s;
        harm(disk, file);
        watch.read_until([&] { return !watch.fault.empty(); });
        CHECK_THAT(watch.fault, Catch::Contains(file.string()) && Catch::Contains(words));
        mend(watch);
        watch.read_until([&] { return watch.e_s > before_s; });  // the landing goes on
        watch.read_until([&] { return watch.fault.empty(); });
        CHECK(watch.health() == 200);
        const Sequence mended = watch.last;
        watch.read_until([&] { return watch.last > mended + 200; });
        last = watch.last;
        // What a question gets, from the routes as from the file.
        const auto latest = web_request(server.port(), "GET", "/api/v1/runs/1/events?limit=10000");
        CHECK(latest.status == 200);
        auto reader = Reader::open(file, tests::shipped_dictionary());
        REQUIRE(reader.ok());
        CHECK(reader->last_seq(archive::RunId{1}).value() >= last);
        reader = Error{"closed"};
        server.restart();  // a clean end
        const auto verified = pipeline::verify(file, {}, tests::shipped_dictionary(), nullptr, copies / "");
        REQUIRE(verified.ok());
        CHECK(verified->faults == std::vector<std::string>{});
        CHECK(verified->runs == 1);
    }
}

}  // namespace

TEST_CASE("while the disk is full the console is told, the landing goes on, and when there is room all of it is stored",
          "[archive][disk][stream][R43]") {
    FaultyDisk* full = nullptr;
    harm_and_mend(
        "full", [&](FaultyDisk& disk, const auto&) { (full = &disk)->fail_at(1, FaultyDisk::Fault::full, true); },
        [&](Watch& watch) {
            CHECK(watch.health() == 503);
            const double full_s = watch.e_s;
            watch.read_until([&] { return watch.e_s > full_s + 60.0; });  // far more than the queue of deliveries holds
            CHECK(watch.health() == 503);
            full->mend();
        });
}

TEST_CASE("while the disk is read-only the console is told, the landing goes on, and when it can be written all of it "
          "is stored",
          "[archive][disk][stream][R43]") {
    FaultyDisk* read_only = nullptr;
    harm_and_mend(
        "readonly",
        [&](FaultyDisk& disk, const auto&) { (read_only = &disk)->fail_at(1, FaultyDisk::Fault::read_only, true); },
        [&](Watch& watch) {
            CHECK(watch.health() == 503);
            read_only->mend();
        });
}

TEST_CASE("a server that is asked to end while the disk is full ends soon, and the run can be continued",
          "[archive][disk][R43]") {
    FaultyDisk disk;
    RunningServer server{from_uhf_on(), 60.0};
    {
        Watch watch{server};
        watch.read_until([&] { return watch.last > 200; });
        disk.fail_at(1, FaultyDisk::Fault::full, true);
        watch.read_until([&] { return !watch.fault.empty(); });
    }
    std::promise<void> ended;
    std::thread rescue{[&, over = ended.get_future()] {  // so that a server which waits for the disk ends at all
        if (over.wait_for(std::chrono::seconds{40}) == std::future_status::timeout) disk.mend();
    }};
    const tests::SleptTime time;
    server.end();
    CHECK(time.passed() < std::chrono::seconds{20});  // four tries, half a second apart
    ended.set_value();
    rescue.join();
    disk.mend();
    server.restart();
    CHECK_THAT(web_request(server.port(), "GET", "/api/v1/runs/1").body, Catch::Contains(R"("state":"interrupted")"));
}

TEST_CASE("an archive that is removed while it is written is put back with all that was in it",
          "[archive][disk][stream][R43]") {
    const auto nothing = [](Watch&) {};
    SECTION("all of its files") {
        harm_and_mend(
            "was removed",
            [](auto&, const std::filesystem::path& file) {
                for (const char* suffix : {"", "-wal", "-shm"}) std::filesystem::remove(file.string() + suffix);
            },
            nothing);
    }
    SECTION("its log") {
        harm_and_mend(
            "was removed",
            [](auto&, const std::filesystem::path& file) { std::filesystem::remove(file.string() + "-wal"); }, nothing);
    }
}

TEST_CASE("who waits for an answer while the disk refuses is told so, also when others wait before it",
          "[disk][gateway]") {
    FaultyDisk disk;
    TemporaryFolder folder;
    const auto dictionary = small_dictionary();
    server::PipelineThread pipeline{
        std::move(Archive::open(folder / "a.db")).value(), dictionary, server::PipelineThread::Faults::hold, {}};
    REQUIRE(pipeline.begin({}).ok());
    disk.fail_at(1, FaultyDisk::Fault::full, true);
    const std::vector<std::uint8_t> octets(60'000, 0x55);  // no packet of ours: kept as it is
    for (int i = 0; i < 2'000 && !pipeline.blocked(); ++i) {
        server::Delivery delivery;
        delivery.entries.emplace_back(telemetry::ReceivedPacket{telemetry::relay_link, Ert{i}, octets});
        REQUIRE(pipeline.deliver(std::move(delivery)));
        while (pipeline.figures().waiting > 8 && !pipeline.blocked())
            std::this_thread::sleep_for(std::chrono::milliseconds{1});
    }
    REQUIRE(pipeline.blocked());
    std::promise<std::string> told;
    auto answer = told.get_future();
    server::Delivery command;
    command.answers.emplace_back([&](const std::string& fault) { told.set_value(fault); });
    REQUIRE(pipeline.deliver(std::move(command)));
    REQUIRE(answer.wait_for(std::chrono::seconds{30}) == std::future_status::ready);
    CHECK_THAT(answer.get(), Catch::Contains("full"));
    disk.mend();
    CHECK(pipeline.finish({}).ok());
}

TEST_CASE("another file in the archive's place is left alone, and the archive is put back when it is gone",
          "[archive][disk]") {
    TemporaryFolder folder;
    const auto file = folder / "a.db";
    const auto dictionary = small_dictionary();
    auto archive = std::move(Archive::open(file)).value();
    Pipeline pipeline{archive, dictionary};
    const auto run = pipeline.begin({});
    REQUIRE(run.ok());
    REQUIRE(pipeline.accept(live(mortar_packet(0, 1000.0, 405.0F))).ok());
    REQUIRE(pipeline.commit().ok());
    std::filesystem::rename(file, folder / "moved.db");
    std::ofstream{file} << "not ours";
    REQUIRE(pipeline.accept(live(mortar_packet(1, 1001.0, 405.0F))).ok());
    const auto refused = pipeline.commit();
    REQUIRE_FALSE(refused.ok());
    CHECK_THAT(refused.error().message, Catch::Contains("a.db was replaced by another file"));
    CHECK(std::filesystem::file_size(file) == 8);
    std::filesystem::remove(file);
    CHECK_FALSE(pipeline.commit().ok());  // says that it was removed
    REQUIRE(pipeline.commit().ok());
    REQUIRE(pipeline.finish({}).ok());
    CHECK(Reader::open(file, dictionary)->events(*run, {})->events_size() == 2);
    CHECK(pipeline::verify(file, {}, dictionary, nullptr, folder / "")->faults.empty());
}

}  // namespace server_faulty_disk_test
