// SPDX-License-Identifier: Apache-2.0
// aeolis ingest: what was recorded elsewhere becomes a run of the archive, by the road of a followed link.
#include "server/base/clock_watch.hpp"
#include "server/base/pcap.hpp"
#include "server/base/wall_clock.hpp"
#include "server/cli/commands.hpp"
#include "server/cli/ingest_tones.hpp"
#include "server/cli/options.hpp"
#include "server/cli/useless_segments.hpp"
#include "server/cli/xtce_file.hpp"
#include "server/pipeline/pipeline_thread.hpp"
#include "telemetry/station/foreign_station.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <fcntl.h>
#include <fmt/format.h>
#include <functional>
#include <memory>
#include <optional>
#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>
#include <vector>

namespace aeolis::server {
namespace {

constexpr std::size_t plain_piece_octets = 65536;
constexpr std::size_t window_octets = std::size_t{1} << 20U;  // of a file in memory
constexpr std::int64_t microseconds_a_second = 1'000'000;
constexpr double bits_an_octet = 8.0;
constexpr std::size_t ingest_delivery_entries = 256;

struct IngestOptions {
    std::vector<std::filesystem::path> files;
    std::filesystem::path archive;
    MissionXtce xtce;
    PacketStreamFormat format{};
    std::optional<std::uint16_t> port;      ///< of a capture's datagrams
    std::optional<std::string> start;       ///< UTC at which the first octet was received
    std::optional<double> bits_per_second;  ///< at which the octets came
    double pace = 0.0;                      ///< seconds of reception a second; 0: at once
    IngestTonesOptions tones;               ///< of a file of samples
    CLI::App* command = nullptr;
};

// Sections of --help: options that only one kind of recording has.
constexpr const char *packets_section = "Of packets and frames", *samples_section = "Of samples";

/// Refuses what is said of the other kind of recording.
Result<void> check_section(const CLI::App& command, std::string_view other, std::string_view why) {
    std::string given;
    for (const CLI::Option* option : command.get_options())
        if (option->get_group() == other && option->count() > 0)
            given += (given.empty() ? "" : ", ") + option->get_name();
    if (given.empty()) return {};
    return Error{fmt::format("{}: {}", given, why)};
}

/// Puts the options that `add` adds into a section.
template <typename Add>
void in_section(CLI::App& command, const char* section, Add add) {
    const auto before = command.get_options();
    add();
    for (CLI::Option* option : command.get_options())
        if (std::ranges::find(before, option) == before.end()) option->group(section);
}

/// A file that is read as its octets are needed. One that grows shorter meanwhile has an end there.
class RecordedFile {
  public:
    static Result<RecordedFile> open(const std::filesystem::path& name) {
        RecordedFile opened;
        opened.file_ = ::open(name.c_str(), O_RDONLY | O_CLOEXEC);
        struct stat about{};
        if (opened.file_ < 0 || ::fstat(opened.file_, &about) != 0 || !S_ISREG(about.st_mode))
            return Error{name.string() + " cannot be read"};
        opened.size_ = static_cast<std::size_t>(about.st_size);
        return opened;
    }
    RecordedFile(RecordedFile&& other) noexcept
        : file_(std::exchange(other.file_, -1)), size_(other.size_), window_(std::move(other.window_)),
          from_(other.from_) {}
    RecordedFile& operator=(RecordedFile&&) = delete;
    ~RecordedFile() {
        if (file_ >= 0) ::close(file_);
    }

    std::size_t size() const { return size_; }
    /// As pcap::Source has it.
    std::span<const std::uint8_t> read(std::size_t at, std::size_t octets) {
        if (at < from_ || at + octets > from_ + window_.size()) fill(at, octets);
        if (at >= from_ + window_.size()) return {};
        const std::span<const std::uint8_t> held{window_};
        return held.subspan(at - from_, std::min(octets, from_ + window_.size() - at));
    }

  private:
    RecordedFile() = default;
    void fill(std::size_t at, std::size_t octets) {
        window_.resize(std::max(octets, window_octets));
        from_ = at;
        std::size_t filled = 0;
        while (filled < window_.size()) {
            const auto got =
                ::pread(file_, window_.data() + filled, window_.size() - filled, static_cast<off_t>(at + filled));
            if (got < 0 && errno == EINTR) continue;
            if (got <= 0) break;
            filled += static_cast<std::size_t>(got);
        }
        window_.resize(filled);
    }

    int file_ = -1;
    std::size_t size_ = 0;
    std::vector<std::uint8_t> window_;  ///< octets of the file from from_ on
    std::size_t from_ = 0;
};

struct Piece {
    Ert ert;
    std::span<const std::uint8_t> octets;
    bool datagram = false;
};
using TakePiece = std::function<bool(const Piece&)>;  ///< false: no more are wanted

/// What a recorded file holds, in order.
class Recording {
  public:
    /// `file` must outlive this.
    static Result<Recording> open(RecordedFile& file, const IngestOptions& options, Ert start) {
        Recording recording{file, options, start};
        if (!pcap::File::is(file.read(0, 4))) return recording;
        if (options.start || options.bits_per_second)
            return Error{"a capture has times of its own: --start and --bits-per-second are for plain files"};
        const auto capture =
            pcap::File::open([&file](std::size_t at, std::size_t octets) { return file.read(at, octets); });
        if (!capture) return capture.error();
        recording.capture_ = *capture;
        return recording;
    }

    /// Gives each piece to `take`. @return what of a capture was not used, in words; empty: nothing
    std::string each(const TakePiece& take) const {
        if (!capture_) return each_of_plain(take);
        auto capture = *capture_;
        std::uint64_t other_ports = 0, other_streams = 0;
        std::optional<std::uint16_t> stream_port;
        while (const auto datagram = capture.next()) {
            if (options_->port && datagram->port != *options_->port) {
                ++other_ports;
                continue;
            }
            if (datagram->stream && stream_port.value_or(datagram->port) != datagram->port) {
                ++other_streams;
                continue;
            }
            if (datagram->stream) stream_port = datagram->port;
            if (!take({datagram->ert, datagram->octets, !datagram->stream})) return {};
        }
        std::string words;
        if (capture.others() > 0) words += fmt::format("; {} packets are no whole UDP over IPv4", capture.others());
        if (other_ports > 0) words += fmt::format("; {} datagrams to other ports", other_ports);
        if (other_streams > 0)
            words += fmt::format("; {} pieces of other streams than that to port {}; say which by --udp-port",
                                 other_streams, *stream_port);
        if (capture.cut()) words += "; the capture is cut off";
        return words.empty() ? words : words.substr(2);
    }

  private:
    Recording(RecordedFile& file, const IngestOptions& options, Ert start)
        : file_(&file), options_(&options), start_(start) {}

    std::string each_of_plain(const TakePiece& take) const {
        // With a rate in pieces of a tenth of a second: the time of each is that of its last octet.
        constexpr double piece_s = 0.1;
        const double rate = options_->bits_per_second.value_or(0.0) / bits_an_octet;
        const auto piece =
            rate > 0.0
                ? static_cast<std::size_t>(std::clamp(rate * piece_s, 1.0, static_cast<double>(plain_piece_octets)))
                : plain_piece_octets;
        for (std::size_t at = 0;;) {
            const auto octets = file_->read(at, piece);
            if (octets.empty()) return at < file_->size() ? "it grew shorter while it was read" : "";
            at += octets.size();
            const double passed_s = rate > 0.0 ? static_cast<double>(at) / rate : 0.0;
            const Ert ert{start_.microseconds + static_cast<std::int64_t>(passed_s * microseconds_a_second)};
            if (!take({ert, octets, false})) return {};
        }
    }

    RecordedFile* file_;
    const IngestOptions* options_;
    Ert start_;
    std::optional<pcap::File> capture_;
};

/// Has the station recognise the layout of recordings, which are one stream, by their first octets.
Result<void> recognise(const std::vector<Recording>& recordings, telemetry::ForeignStation& station) {
    constexpr auto beginning_octets_max = telemetry::ForeignStation::beginning_octets_max;
    std::vector<std::uint8_t> beginning;
    for (const auto& recording : recordings) {
        if (beginning.size() >= beginning_octets_max) break;
        recording.each([&](const Piece& piece) {
            beginning.insert(beginning.end(), piece.octets.begin(), piece.octets.end());
            return beginning.size() < beginning_octets_max;
        });
    }
    return station.recognise(beginning, beginning.size() < beginning_octets_max);
}

/// Microseconds in which octets of a plain file came.
std::int64_t duration_us(std::size_t octets, const IngestOptions& options) {
    if (!options.bits_per_second) return 0;
    return static_cast<std::int64_t>(static_cast<double>(octets) * bits_an_octet / *options.bits_per_second *
                                     microseconds_a_second);
}

/// Whether times of reception are in range at the rate that is told.
Result<void> check_rate(const IngestOptions& options) {
    constexpr double years_max = 100.0, seconds_a_year = 31'557'600.0;  // chosen
    if (!options.bits_per_second) return {};
    if (!std::isfinite(*options.bits_per_second) || *options.bits_per_second <= 0.0)
        return Error{"--bits-per-second: must be a number above 0"};
    double octets = 0.0;
    for (const auto& file : options.files) {
        std::error_code error;
        const auto size = std::filesystem::file_size(file, error);
        if (!error) octets += static_cast<double>(size);
    }
    if (octets * bits_an_octet / *options.bits_per_second <= years_max * seconds_a_year) return {};
    return Error{fmt::format("--bits-per-second {:g}: {:.0f} octets would take more than {:.0f} years",
                             *options.bits_per_second, octets, years_max)};
}

/// Hands the pieces of a recording to the archive as a link does.
class Ingest {
  public:
    Ingest(const IngestOptions& options, telemetry::ForeignStation station, PipelineThread& pipeline)
        : options_(options), station_(std::move(station)), pipeline_(pipeline) {}

    Result<void> add(const Recording& recording, const std::string& name) {
        bool empty = true;
        const auto unused = recording.each([&](const Piece& piece) {
            empty = empty && piece.octets.empty();
            return take(piece);
        });
        if (!unused.empty()) fault(name + ": " + unused);
        if (empty) fault(name + ": no octets of a link are in it");
        if (station_.lost()) collect(station_.end(now_));  // the next recording begins with a packet
        return hand_over();
    }

    /// Ends the stream and hands over the totals. False when it was not as it should be.
    Result<bool> finish() {
        collect(station_.end(now_));
        auto totals = station_.totals(now_);
        const auto faults = station_.ledger().faults_since(totals);
        fmt::print("{} packets of {} octets\n", packets_, totals.counters.octets);
        if (!faults.empty()) fault(faults);
        if (const auto stray = station_.stray_octets(); stray > 0)
            fault(fmt::format("{} octets skipped that are neither good frames nor fill", stray));
        if (packets_ + totals.packets.idle_packets == 0)
            if (const auto words = nothing_found(options_.format, totals.counters, totals.packets,
                                                 station_.ledger().heard_sequences());
                !words.empty())
                fault(words);
        delivery_.links.push_back(std::move(totals));
        if (auto done = hand_over(); !done) return done.error();
        return faults_ == 0;
    }

  private:
    void fault(const std::string& words) {
        ++faults_;
        fmt::print(stderr, "{}\n", words);
    }

    bool take(const Piece& piece) {
        wait_for(piece.ert);
        if (!began_) {
            began_ = true;
            delivery_.entries.emplace_back(
                telemetry::LinkState{telemetry::downlink_link, piece.ert, true, "recorded", false});
        }
        if (piece.ert.microseconds - passed_.microseconds >= microseconds_a_second) {
            passed_ = piece.ert;
            delivery_.entries.emplace_back(telemetry::EarthTime{piece.ert});
            delivery_.links.push_back(station_.totals(piece.ert));
        }
        now_ = piece.ert;
        telemetry::Downlink downlink;
        downlink.now = piece.ert;
        downlink.octets.push_back(
            {telemetry::downlink_link, piece.ert, {piece.octets.begin(), piece.octets.end()}, piece.datagram});
        collect(station_.receive(std::move(downlink)));
        unchecked_octets_ += piece.octets.size();
        if (unchecked_octets_ >= window_octets) {
            unchecked_octets_ = 0;
            if (segments_.add(station_.totals(piece.ert).packets)) {
                fault(
                    fmt::format("stopped: more than {} segments in a row are of no packet (zeros?); look at --format, "
                                "and whether this is the right file",
                                UselessSegments::in_a_row_max));
                return false;
            }
        }
        const bool due = delivery_.entries.size() >= ingest_delivery_entries || options_.pace > 0.0;
        return !due || hand_over().ok();
    }

    void collect(telemetry::Received& received) {
        packets_ += received.packets.size();
        delivery_.add(std::move(received));
    }

    Result<void> hand_over() {
        if (pipeline_.deliver(std::exchange(delivery_, {}))) return {};
        return Error{pipeline_.fault()};
    }

    /// Waits until it is the piece's turn at the pace.
    void wait_for(Ert ert) {
        if (options_.pace <= 0.0) return;
        if (!began_) {
            first_ = ert;
            started_ = std::chrono::steady_clock::now();
        }
        const double passed_s = static_cast<double>(ert.microseconds - first_.microseconds) / microseconds_a_second;
        std::this_thread::sleep_until(started_ + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                                     std::chrono::duration<double>(passed_s / options_.pace)));
    }

    const IngestOptions& options_;
    telemetry::ForeignStation station_;
    PipelineThread& pipeline_;
    Delivery delivery_;
    Ert now_, passed_, first_;
    std::chrono::steady_clock::time_point started_;
    std::uint64_t packets_ = 0, faults_ = 0;
    UselessSegments segments_;
    std::size_t unchecked_octets_ = 0;
    bool began_ = false;
};

/// A recording of X-band's samples, which is a run by itself.
int ingest_samples(const IngestOptions& options) {
    if (options.files.size() > 1) return failed("samples: one recording is a run, given by one file", 2);
    const auto checked = check_section(*options.command, packets_section,
                                       "samples hold tones of our own mission, no packets and no frames");
    if (!checked) return failed(checked.error().message, 2);
    IngestTonesOptions tones = options.tones;
    tones.samples = options.files.front();
    tones.archive = options.archive;
    tones.start = options.start;
    tones.pace = options.pace;
    return ingest_tones(tones);
}

int ingest(const IngestOptions& options) {
    if (holds_samples(options.files.front())) return ingest_samples(options);
    const auto section = check_section(*options.command, samples_section,
                                       options.files.front().string() + " holds no samples (SigMF, or WAV)");
    if (!section) return failed(section.error().message, 2);
    if (options.xtce.empty()) return failed("--xtce is required: the mission's XTCE file", 2);
    if (!telemetry::downlink_format(options.format.name))
        return failed(packet_source(options.format, {}, true).error().message, 2);
    if (const auto checked = check_rate(options); !checked) return failed(checked.error().message, 2);
    Ert start = EarthClock{read_clocks}.now();
    if (options.start) {
        const auto told = ert_from_text(*options.start);
        if (!told) return failed("--start " + *options.start + ": not a UTC time, such as 2012-219T05:10:47.4", 2);
        start = *told;
    }
    std::vector<RecordedFile> files;
    files.reserve(options.files.size());  // recordings refer to them
    std::vector<Recording> recordings;
    std::size_t before = 0;  // octets of the files before
    for (const auto& name : options.files) {
        auto file = RecordedFile::open(name);
        if (!file) return failed(file.error().message, 2);
        files.push_back(std::move(*file));
        const Ert begun{start.microseconds + duration_us(before, options)};
        auto recording = Recording::open(files.back(), options, begun);
        if (!recording) return failed(name.string() + ": " + recording.error().message, 2);
        before += files.back().size();
        recordings.push_back(*recording);
    }
    const auto& first = options.files.front();
    if (before == 0) return failed(first.string() + ": no octets of a link are in it");
    telemetry::ForeignStation station{recognise_by(options.format)};
    if (const auto recognised = recognise(recordings, station); !recognised)
        return failed(first.string() + ": " + recognised.error().message, 2);
    if (const auto layout = station.take_layout(); !layout.empty())
        fmt::print(stderr, "{}: taken for {}\n", first.string(), layout);
    auto xtce = read_xtce(options.xtce);
    if (!xtce) return xtce.exit_code;
    const telemetry::OtherMission mission{std::move(*xtce.model), xtce.id, std::move(xtce.time)};
    auto archive = archive::Archive::open(options.archive);
    if (!archive) return failed(archive.error().message);
    PipelineThread pipeline{std::move(*archive), mission.dictionary(), PipelineThread::Faults::give_up,
                            pipeline::Publish{}, &mission};
    pipeline.want_items(false);
    archive::RunStart run_start;
    run_start.scenario = run_start.venue = "downlink";
    run_start.title = fmt::format("{}, {} by {}", options.files.front().filename().string(), options.format.name,
                                  options.xtce.text());
    run_start.pace = 1.0;
    run_start.started = wall_clock_text();
    const auto run = pipeline.begin(run_start);
    if (!run) return failed(run.error().message);
    fmt::print("run {}\n", run->value);
    Ingest ingest{options, std::move(station), pipeline};
    std::optional<Error> broken;
    for (std::size_t i = 0; i < recordings.size() && !broken; ++i)
        if (auto added = ingest.add(recordings[i], options.files[i].string()); !added) broken = added.error();
    const auto right = ingest.finish();
    const auto finished = pipeline.finish(
        {archive::Outcome::stopped, broken ? broken->message : "the recording ended", "", wall_clock_text()});
    if (broken) return failed(broken->message);
    if (!right) return failed(right.error().message);
    if (!finished) return failed(finished.error().message);
    if (pipeline.not_decoded() > 0) fmt::print(stderr, "{} packets not decoded\n", pipeline.not_decoded());
    return *right && pipeline.not_decoded() == 0 ? 0 : 1;
}

}  // namespace

void add_ingest_command(CLI::App& program, int& exit_code) {
    const auto options = std::make_shared<IngestOptions>();
    auto& command = *program.add_subcommand(
        "ingest",
        "reads recorded files of a mission into a run of the archive, like a followed link: plain octets, or pcap and "
        "pcapng with the times of reception; or SigMF and WAV with samples of our own mission's tones. Exit code 1 "
        "when anything was lost or not used");
    command.add_option("files", options->files, "recorded files, in the order of reception: one stream")->required();
    command.add_option("--archive", options->archive, "SQLite file that keeps everything")->required();
    command.add_option(
        "--start", options->start,
        "of a plain file: when its first octet was received, UTC; now if left out. Of samples: the first one, as the "
        "file says if left out");
    command.add_option("--pace", options->pace, "seconds of reception a second; 0: as fast as it goes")
        ->check(CLI::Range(0.0, 1.0e6))
        ->capture_default_str();
    options->command = &command;
    in_section(command, packets_section, [&] {
        add_mission_xtce(command, options->xtce, "the mission's XTCE file; may be given several times");
        add_stream_format(command, options->format);
        command.add_option("--udp-port", options->port, "of a capture: datagrams to this port only; all if left out");
        command.add_option("--bits-per-second", options->bits_per_second,
                           "of a plain file: the rate at which it was received; all at once if left out");
    });
    in_section(command, samples_section, [&] {
        auto& tones = options->tones;
        command.add_option("--dictionary", tones.dictionary, "directory of the dictionary that names the tones")
            ->capture_default_str();
        command.add_option("--predict", tones.predict, "CSV of the Doppler that was removed before sampling");
        command.add_option("--expected", tones.expected, "CSV of a Doppler that is still in them");
        command.add_option("--at", tones.at_s, "the first sample's time on the scale of those files, in seconds")
            ->capture_default_str();
        command.add_option("--exclude", tones.excluded_hz, "lines to leave out, in Hz; 0 is a DC block")
            ->delimiter(',');
    });
    command.callback([options, &exit_code] { exit_code = ingest(*options); });
}

}  // namespace aeolis::server
