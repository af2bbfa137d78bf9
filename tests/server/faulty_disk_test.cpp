// What the archive promises, on a disk that loses power or fails at any moment.
#include "tests/server/faulty_disk.hpp"
#include "server/archive/reader.hpp"
#include "server/archive/sqlite.hpp"
#include "server/pipeline/derivation.hpp"
#include "server/pipeline/pipeline.hpp"
#include "server/rehearsal/rehearsal.hpp"
#include "tests/server/running_server.hpp"
#include "tests/server/small_mission.hpp"

#include <random>

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
        std::vector<simulation::ReceivedPacket> packets;
        std::vector<simulation::ReceivedTone> tones;
        std::vector<simulation::LinkState> links;
        std::vector<archive::StageRecord> stages;
    };
    std::vector<Step> steps;
};

/// From before the first timepoint until so many packets have come, some of each step's cycles together.
Flown fly(std::size_t packets, std::size_t cycles_a_step) {
    auto scenario = shipped_scenario("nominal_auto");
    scenario.start_before_entry_s = 620.0; // UHF begins at 600
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
    std::vector<std::string> items; ///< item i + 1
};

/// Stores the landing until it ends or the disk fails; now and then another connection folds the WAL into the file.
void store(const Flown& flown, const std::filesystem::path& file, Published& published) {
    auto archive = Archive::open(file);
    if (!archive) return;
    auto other = archive::sqlite::Database::open(file.string(), archive::sqlite::Mode::read_write_create);
    Pipeline pipeline{*archive, tests::shipped_dictionary()};
    pipeline.on_publish([&](const auto& batch) {
        for (const auto& item : batch->items)
            published.items.push_back(item.SerializeAsString());
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
        if (++count % 16 == 0 && other) (void)other->execute(count % 64 == 0 ? "PRAGMA wal_checkpoint(TRUNCATE)" : "PRAGMA wal_checkpoint").ok();
    }
    published.finished = pipeline.finish({"stopped", "", "d", ""}).ok();
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
                REQUIRE(state->state() == "finished");
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
    for (const auto& fault : verified->faults)
        FAIL_CHECK(fault);
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

} // namespace

TEST_CASE("a power cut takes back nothing that was published, and leaves the archive whole", "[archive][pipeline][disk][R43]") {
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
            run("PRAGMA journal_mode = WAL; CREATE TABLE IF NOT EXISTS t(x); DELETE FROM t; PRAGMA wal_checkpoint(TRUNCATE)");
            run(synchronous);
            for (int i = 0; i < 10; ++i)
                run("INSERT INTO t VALUES (1)");
            disk.leave(folder / "after", 1);
        }
        auto left = archive::sqlite::Database::open((folder / "after/t.db").string(), archive::sqlite::Mode::read_write_create);
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
    Life(FaultyDisk& disk, const std::filesystem::path& folder) : disk_(disk), folder_(folder), file_(folder / "a.db") {}

    void live() {
        const auto dictionary = small_dictionary();
        std::optional<Archive> archive;
        insist([&]() -> Result<void> {
            auto opened = Archive::open(file_);
            if (!opened) return opened.error();
            archive.emplace(std::move(*opened));
            return {};
        });
        Pipeline pipeline{*archive, dictionary};
        pipeline.on_publish([&](const auto& batch) {
            for (const auto& item : batch->items)
                published_.push_back(item.SerializeAsString());
        });
        archive::RunId run;
        insist([&]() -> Result<void> {
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
            insist([&] { return pipeline.commit(); });
            // Who asks meanwhile gets all that was published, or an error in words.
            insist([&]() -> Result<void> {
                if (!reader) {
                    auto opened = Reader::open(file_, dictionary);
                    if (!opened) return opened.error();
                    reader.emplace(std::move(*opened));
                }
                return read_back(*reader, run);
            });
        }
        insist([&] { return pipeline.finish({"touchdown", "", "d", ""}); });
        insist([&] { return read_back(*reader, run); });
        reader.reset();
        archive.reset(); // folds the WAL into the file; what fails of that is made up for at the next start
        disk_.mend();
        auto again = Reader::open(file_, dictionary);
        REQUIRE(again.ok());
        REQUIRE(read_back(*again, run).ok());
        const auto verified = pipeline::verify(file_, {}, dictionary, nullptr, folder_);
        REQUIRE(verified.ok());
        REQUIRE(verified->faults == std::vector<std::string>{});
    }

  private:
    static simulation::ReceivedPacket live_packet(std::uint16_t i) {
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
    void insist(Step step) {
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

} // namespace

TEST_CASE("whichever operation of the disk fails, it is said, nothing published is lost, and it goes on when the disk is well",
          "[archive][pipeline][disk][R43]") {
    fail_each(FaultyDisk::Fault::input_output, false, 1, 23);
    fail_each(FaultyDisk::Fault::input_output, true, 2, 23);
    fail_each(FaultyDisk::Fault::full, true, 1, 11);
}

TEST_CASE("the n-th operation of the disk fails, for every n", "[.long][archive][pipeline][disk]") {
    for (const bool lasting : {false, true})
        for (const auto fault : {FaultyDisk::Fault::input_output, FaultyDisk::Fault::full})
            fail_each(fault, lasting, 1, 1);
}
