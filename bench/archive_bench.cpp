// SPDX-License-Identifier: Apache-2.0
// Measures the archive.
//
//   append   its cost over bare SQLite with the same table, index, batch and synchronous=FULL
//   landing  a landing's telemetry from packet to durable row
//   read     a plot of ten million samples
//   size     octets a sample
//   start    on an archive that was closed, or whose writer was killed

#include "bench/must.hpp"
#include "common/bytes.hpp"
#include "server/archive/archive.hpp"
#include "server/archive/reader.hpp"
#include "server/archive/sqlite.hpp"
#include "server/pipeline/pipeline.hpp"
#include "server/pipeline/segment_builder.hpp"
#include "tests/support/packet_model_of.hpp"
#include "tests/support/temporary_folder.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fcntl.h>
#include <filesystem>
#include <functional>
#include <random>
#include <sqlite3.h>
#include <sys/wait.h>
#include <unistd.h>

using namespace aeolis;
using archive::RunId;
using archive::Sequence;
using bench::must;

namespace {

constexpr std::size_t packet_octets = 256;
constexpr std::size_t batch_packets = 4096;  // as `aeolis rehearse` commits
constexpr std::size_t stored_packets = 49 * batch_packets;
constexpr std::size_t fields = 30;
constexpr Apid apid{0x40};

double wall_s() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}
double cpu_s() {
    timespec time{};
    ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}
struct Cost {
    double wall = 0.0, cpu = 0.0;
};
template <typename Work>
Cost cost_of(Work work) {
    const double wall = wall_s(), cpu = cpu_s();
    work();
    return {wall_s() - wall, cpu_s() - cpu};
}
/// A packet of floats, each a channel. Thirty have the shape of the wideband load.
dictionary::Dictionary wideband(std::size_t channels = fields) {
    dictionary::Dictionary d;
    d.mission = "BENCH";
    d.id = 1;
    dictionary::Type type;
    type.kind = dictionary::ValueKind::real;
    type.encoding = dictionary::Encoding::ieee754;
    type.bits = 32;
    dictionary::Packet packet;
    packet.name = "Wideband";
    packet.apid = apid;
    packet.octets = static_cast<unsigned>(tm_overhead_octets + 4 * channels);
    for (std::size_t i = 0; i < channels; ++i) {
        const ChannelId id{static_cast<std::uint16_t>(i)};
        const auto name = "wideband_" + std::to_string(i);
        d.channels.push_back({id, name, name, "", type});
        packet.fields.push_back(
            {name, type, id, static_cast<unsigned>((tm_data_offset_octets + 4 * i) * 8), std::nullopt});
    }
    d.packets = {packet};
    d.model = tests::packet_model_of(d);
    return d;
}

Cost raw_append(const std::filesystem::path& file, const std::vector<std::uint8_t>& octets) {
    sqlite3* database = nullptr;
    must(sqlite3_open(file.c_str(), &database) == SQLITE_OK, "open");
    const auto run = [&](const char* sql) { must(sqlite3_exec(database, sql, nullptr, nullptr, nullptr) == 0, sql); };
    run("PRAGMA page_size=16384; PRAGMA journal_mode=WAL; PRAGMA synchronous=FULL; PRAGMA wal_autocheckpoint=1000; "
        "PRAGMA cache_size=-16000;"
        "CREATE TABLE packets (key INTEGER PRIMARY KEY, run INTEGER NOT NULL, apid INTEGER NOT NULL, packet INTEGER,"
        " sclk REAL NOT NULL, ert_us INTEGER NOT NULL, link INTEGER NOT NULL, source INTEGER NOT NULL,"
        " standing INTEGER NOT NULL, sampled INTEGER NOT NULL, refusal TEXT, octets BLOB NOT NULL) STRICT;"
        "CREATE INDEX packets_by_time ON packets (run, apid, source, sclk);");
    sqlite3_stmt* insert = nullptr;
    must(sqlite3_prepare_v2(database, "INSERT INTO packets VALUES (?,?,?,?,?,?,?,?,?,?,?,?)", -1, &insert, nullptr) ==
             0,
         "prepare");
    const Cost cost = cost_of([&] {
        for (std::size_t i = 0; i < stored_packets; ++i) {
            if (i % batch_packets == 0) run("BEGIN IMMEDIATE");
            sqlite3_bind_int64(insert, 1, static_cast<std::int64_t>((1ULL << 40U) + i + 1));
            for (const auto& [column, value] : {std::pair{2, 1}, {3, 64}, {4, 0}, {7, 1}, {8, 1}, {9, 0}, {10, 0}})
                sqlite3_bind_int64(insert, column, value);
            sqlite3_bind_double(insert, 5, static_cast<double>(i) / 64.0);
            sqlite3_bind_int64(insert, 6, static_cast<std::int64_t>(i) * 15'625);
            sqlite3_bind_blob(insert, 12, octets.data(), static_cast<int>(octets.size()), SQLITE_STATIC);
            must(sqlite3_step(insert) == SQLITE_DONE, "insert");
            sqlite3_reset(insert);
            if (i % batch_packets == batch_packets - 1) run("COMMIT");
        }
    });
    sqlite3_finalize(insert);
    sqlite3_close(database);
    return cost;
}

Cost archive_append(const std::filesystem::path& file, const std::vector<std::uint8_t>& octets) {
    auto opened = archive::Archive::open(file);
    must(opened.ok(), "Archive::open");
    const auto run = opened->begin_run({}, wideband());
    must(run.ok(), "begin_run");
    return cost_of([&] {
        archive::Batch batch;
        for (std::size_t i = 0; i < stored_packets; ++i) {
            archive::PacketRecord record;
            record.seq = i + 1;
            record.apid = apid;
            record.packet = std::uint16_t{0};
            record.sclk = Sclk{static_cast<double>(i) / 64.0};
            record.ert = Ert{static_cast<std::int64_t>(i) * 15'625};
            record.link = "uhf_live";
            record.source = archive::Source::realtime;
            record.octets = {batch.octets.size(), octets.size()};
            batch.octets.insert(batch.octets.end(), octets.begin(), octets.end());
            batch.packets.push_back(std::move(record));
            batch.last_seq = i + 1;
            if (i % batch_packets != batch_packets - 1) continue;
            must(opened->append(*run, batch).ok(), "append");
            batch.clear();
        }
    });
}

constexpr std::size_t landing_packets = 100'000;

/// Packets made beforehand, so that only the ground's work is measured.
std::vector<telemetry::ReceivedPacket> landing() {
    std::vector<telemetry::ReceivedPacket> packets(landing_packets);
    for (std::size_t i = 0; i < landing_packets; ++i) {
        std::vector<std::uint8_t> octets(tm_overhead_octets + 4 * fields);
        BitWriter bits{std::span<std::uint8_t>(octets).subspan(tm_data_offset_octets)};
        for (std::size_t f = 0; f < fields; ++f)
            bits.put_float(static_cast<float>(std::sin(static_cast<double>(i * (f + 1)) * 1e-4)));
        seal_tm_packet(octets, apid, static_cast<std::uint16_t>(i & 0x3FFFU), Sclk{static_cast<double>(i) / 64.0}, 1);
        packets[i] = {telemetry::relay_link, Ert{static_cast<std::int64_t>(i)}, std::move(octets)};
    }
    return packets;
}

Cost store_landing(const std::filesystem::path& file, const dictionary::Dictionary& dictionary,
                   const std::vector<telemetry::ReceivedPacket>& packets, bool items, bool finished = true) {
    auto opened = archive::Archive::open(file);
    must(opened.ok(), "Archive::open");
    pipeline::Pipeline pipeline(*opened, dictionary);
    pipeline.want_items(items);
    must(pipeline.begin({}).ok(), "begin");
    return cost_of([&] {
        for (const auto& packet : packets) {
            must(pipeline.accept(packet).ok(), "accept");
            must(pipeline.commit_if_full().ok(), "commit");
        }
        must(finished ? pipeline.finish({}).ok() : pipeline.commit().ok(), "finish");
    });
}

double median_ms(const std::function<void()>& work) {
    std::vector<double> times;
    for (int i = 0; i < 15; ++i) times.push_back(1e3 * cost_of(work).cpu);
    std::nth_element(times.begin(), times.begin() + 7, times.end());
    return times[7];
}

constexpr std::size_t long_samples = 10'000'000;

/// Stores segments and pyramid only, as a finished run leaves them: one packet with two changing channels.
void store_long(const std::filesystem::path& file, const dictionary::Dictionary& dictionary) {
    auto opened = archive::Archive::open(file);
    must(opened.ok(), "Archive::open");
    const auto run = opened->begin_run({}, dictionary);
    must(run.ok(), "begin_run");
    const archive::PacketColumns columns(dictionary);
    pipeline::SegmentBuilder builder(columns);
    std::mt19937 random(1);
    std::vector<float> noisy(1U << 20U), smooth(noisy.size());
    for (std::size_t i = 0; i < noisy.size(); ++i) {
        const double t_s = static_cast<double>(i) / 64.0;
        noisy[i] =
            static_cast<float>(3000.0 + 500.0 * std::sin(t_s * 0.01) + static_cast<double>(random() % 1024) * 1e-3);
        smooth[i] = static_cast<float>(2.0 + std::cos(t_s * 0.1));
    }
    archive::Batch batch;
    for (std::size_t i = 0; i < long_samples; ++i) {
        const std::array<double, 2> values{noisy[i % noisy.size()], smooth[i % smooth.size()]};
        builder.add(0, archive::Source::realtime, i + 1, Sclk{static_cast<double>(i) / 64.0}, values, batch);
        if (batch.segments.size() < 64) continue;
        must(opened->append(*run, batch).ok(), "append");
        batch.clear();
    }
    builder.seal(batch);
    batch.end = archive::RunEnd{};
    must(opened->append(*run, batch).ok(), "append");
}

/// Stores ten million samples in packets of `fields`, then is ended by kill -9 in the middle of the run.
void store_until_killed(const std::filesystem::path& file, const dictionary::Dictionary& dictionary) {
    const pid_t child = ::fork();
    must(child >= 0, "fork");
    if (child == 0) {
        auto opened = archive::Archive::open(file);
        must(opened.ok(), "Archive::open");
        pipeline::Pipeline pipeline(*opened, dictionary);
        pipeline.want_items(false);
        must(pipeline.begin({}).ok(), "begin");
        auto packets = landing();
        for (std::size_t i = 0; i <= long_samples / fields; ++i) {
            auto& octets = packets[i % packets.size()].octets;
            seal_tm_packet(octets, apid, static_cast<std::uint16_t>(i & 0x3FFFU), Sclk{static_cast<double>(i) / 64.0},
                           1);
            must(pipeline.accept(packets[i % packets.size()]).ok(), "accept");
            must(pipeline.commit_if_full().ok(), "commit");
        }
        must(pipeline.commit().ok(), "commit");
        ::raise(SIGKILL);
    }
    int status = 0;
    must(::waitpid(child, &status, 0) == child && WIFSIGNALED(status), "the killed writer");
}

/// Measures a start: the writer, then a reader, up to its first answer. Returns the median of five, each on a copy,
/// because opening repairs what a killed writer has left. Closing is not included.
double reopening_ms(const std::filesystem::path& file, const dictionary::Dictionary& dictionary,
                    std::size_t interrupted) {
    std::vector<double> times;
    const auto copy = file.string() + "-copy";
    for (int i = 0; i < 5; ++i) {
        for (const char* suffix : {"", "-wal"})
            if (std::filesystem::exists(file.string() + suffix))
                std::filesystem::copy_file(file.string() + suffix, copy + suffix,
                                           std::filesystem::copy_options::overwrite_existing);
        const double start = wall_s();
        auto writer = archive::Archive::open(copy);
        must(writer.ok() && writer->interrupted().size() == interrupted, "Archive::open");
        auto reader = archive::Reader::open(copy, dictionary);
        must(reader.ok() && reader->runs().ok(), "Reader::open");
        times.push_back(1e3 * (wall_s() - start));
    }
    std::nth_element(times.begin(), times.begin() + 2, times.end());
    return times[2];
}

/// Octets of the pages that hold samples, for each value of a channel.
double octets_of_samples(const std::filesystem::path& file) {
    auto database = archive::sqlite::Database::open(file.string(), archive::sqlite::Mode::read_only);
    must(database.ok(), "open");
    const auto octets =
        database->integer_of("SELECT sum(pgsize) FROM dbstat WHERE name IN ('segments', 'segments_by_position',"
                             " 'segment_columns', 'pyramid', 'pyramid_columns')");
    const auto samples = database->integer_of(
        "SELECT sum(s.samples) FROM segment_columns c JOIN segments s ON s.segment = c.key / 65536");
    must(octets.ok() && samples.ok(), "dbstat");
    return static_cast<double>(*octets) / static_cast<double>(*samples);
}

/// The median of some tries, each with the file out of the kernel's cache and a new connection.
double first_touch_ms(const std::filesystem::path& file, const dictionary::Dictionary& dictionary,
                      const archive::SeriesQuery& query) {
    std::vector<double> times;
    for (int i = 0; i < 9; ++i) {
        auto reader = archive::Reader::open(file, dictionary);
        must(reader.ok(), "Reader::open");
        const int descriptor = ::open(file.c_str(), O_RDONLY);
        must(descriptor >= 0 && ::fdatasync(descriptor) == 0, "open");
        must(::posix_fadvise(descriptor, 0, 0, POSIX_FADV_DONTNEED) == 0, "fadvise");
        ::close(descriptor);
        times.push_back(1e3 * cost_of([&] { must(reader->series(RunId{1}, query).ok(), "series"); }).wall);
    }
    std::nth_element(times.begin(), times.begin() + 4, times.end());
    return times[4];
}

}  // namespace

int main() {
    const test::TemporaryFolder folder;
    const std::vector<std::uint8_t> octets(packet_octets, 0x5A);
    // By turns, the best of each, because the disk is shared.
    Cost raw{1e9, 1e9}, ours{1e9, 1e9};
    for (int i = 0; i < 4; ++i) {
        const auto better = [](Cost a, Cost b) { return Cost{std::min(a.wall, b.wall), std::min(a.cpu, b.cpu)}; };
        raw = better(raw, raw_append(folder.path() / ("raw" + std::to_string(i)), octets));
        ours = better(ours, archive_append(folder.path() / ("ours" + std::to_string(i)), octets));
    }
    const double ratio = raw.wall / ours.wall;
    std::printf("append of 256-octet packets, %zu a commit, FULL\n", batch_packets);
    std::printf("  limit, raw SQLite  %9.0f rows/s  %5.2f us of CPU a row\n", stored_packets / raw.wall,
                1e6 * raw.cpu / stored_packets);
    std::printf("  archive            %9.0f rows/s  %5.2f us of CPU a row\n", stored_packets / ours.wall,
                1e6 * ours.cpu / stored_packets);
    std::printf("  ratio %.2f of the rate (goal 0.8), %.2f of the CPU (goal 1.25)\n", ratio, ours.cpu / raw.cpu);

    const auto dictionary = wideband();
    const auto packets = landing();
    const auto quiet = store_landing(folder / "landing", dictionary, packets, false);
    const auto watched = store_landing(folder / "watched", dictionary, packets, true);
    const auto size = std::filesystem::file_size(folder / "landing");
    std::printf("%zu packets of %zu channels, from octets to durable rows and segments\n", landing_packets, fields);
    std::printf(
        "  nobody follows     %9.0f packets/s  %.2f s (goal 3 s for the landing), %.1f octets a sample in all\n",
        landing_packets / quiet.wall, quiet.wall,
        static_cast<double>(size) / static_cast<double>(landing_packets * fields));
    std::printf("  items published    %9.0f packets/s  %.2f s\n", landing_packets / watched.wall, watched.wall);

    (void)store_landing(folder / "open", dictionary, packets, false, false);
    auto open = archive::Reader::open(folder / "open", dictionary);
    must(open.ok(), "Reader::open");
    const archive::SeriesQuery all{{"wideband_7"}, {}, 2000},
        newest{{"wideband_7"}, {(landing_packets - 3840) / 64.0, {}}, 2000};
    std::printf("  of a run that goes on, its open end from raw packets: all %.2f ms, the last minute %.2f ms of CPU\n",
                median_ms([&] { must(open->series(RunId{1}, all).ok(), "open thinned"); }),
                median_ms([&] { must(open->series(RunId{1}, newest).ok(), "open newest"); }));

    bool met = ratio >= 0.8 && ours.cpu <= 1.25 * raw.cpu && quiet.wall <= 3.0;
    const auto goal = [&](const char* what, double figure, double limit, const char* unit) {
        std::printf("  %-58s %7.3f %s, limit %.2f: ratio %.2f\n", what, figure, unit, limit, figure / limit);
        met = met && figure <= limit;
    };
    const auto file = folder / "long";
    const auto two = wideband(2);
    store_long(file, two);
    std::printf("one channel of %zu samples, with noise in its last bits; %.2f octets a sample\n", long_samples,
                octets_of_samples(file));
    auto reader = archive::Reader::open(file, two);
    must(reader.ok(), "Reader::open");
    const double middle_s = 0.37 * long_samples / 64.0;
    const archive::SclkRange part{middle_s, middle_s + 1e5 / 64.0};
    const archive::SeriesQuery exact{{"wideband_0"}, part, {}}, some{{"wideband_0"}, part, 2000},
        whole{{"wideband_0"}, {}, 2000};
    const auto ask = [&](const archive::SeriesQuery& query) { must(reader->series(RunId{1}, query).ok(), "series"); };
    goal("100 000 of them exactly, CPU, hot", median_ms([&] { ask(exact); }), 2.5, "ms");
    goal("100 000 of them thinned to 2000, CPU, hot", median_ms([&] { ask(some); }), 0.1, "ms");
    goal("all of them thinned to 2000, CPU, hot", median_ms([&] { ask(whole); }), 0.1, "ms");
    goal("100 000 of them thinned to 2000, wall, first touch", first_touch_ms(file, two, some), 2.0, "ms");
    goal("all of them thinned to 2000, wall, first touch", first_touch_ms(file, two, whole), 2.0, "ms");

    const auto killed = folder / "killed";
    store_until_killed(killed, dictionary);
    const double log_mb = static_cast<double>(std::filesystem::file_size(killed.string() + "-wal")) * 1e-6;
    std::printf("opening an archive of %zu samples, for writing and for reading, up to the list of its runs\n",
                long_samples);
    goal("after a clean end, wall", reopening_ms(file, two, 0), 10.0, "ms");
    std::printf("  its writer killed: a log of %.1f MB\n", log_mb);
    goal("after kill -9, wall", reopening_ms(killed, dictionary, 1), 100.0, "ms");

    const auto flown = folder / "nominal_auto";
    const auto command =
        std::string(AEOLIS_SOURCE_DIR "/build/release/aeolis rehearse --scenario nominal_auto --archive ") +
        flown.string();
    must(std::system((command + " >/dev/null").c_str()) == 0, command.c_str());
    std::printf("a recorded landing, %.1f MB in all\n", static_cast<double>(std::filesystem::file_size(flown)) * 1e-6);
    goal("its samples: segments, their columns, the pyramid", octets_of_samples(flown), 4.0, "octets a sample");
    return met ? 0 : 1;
}
