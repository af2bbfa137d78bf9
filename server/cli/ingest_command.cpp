// SPDX-License-Identifier: Apache-2.0
// aeolis ingest: what was recorded elsewhere becomes a run of the archive, by the road of a followed link.
#include "server/base/clock_watch.hpp"
#include "server/base/wall_clock.hpp"
#include "server/cli/commands.hpp"
#include "server/cli/ingest_delivery.hpp"
#include "server/cli/ingest_radio.hpp"
#include "server/cli/ingest_tones.hpp"
#include "server/cli/options.hpp"
#include "server/cli/recorded_octets.hpp"
#include "server/cli/useless_segments.hpp"
#include "server/cli/xtce_file.hpp"
#include "server/pipeline/pipeline_thread.hpp"
#include "telemetry/station/foreign_station.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>
#include <initializer_list>
#include <memory>
#include <optional>
#include <vector>

namespace aeolis::server {
namespace {

constexpr std::int64_t microseconds_a_second = 1'000'000;
constexpr std::size_t ingest_delivery_entries = 256;
constexpr std::size_t octets_between_checks = std::size_t{1} << 20U;

struct IngestOptions {
    std::vector<std::filesystem::path> files;
    std::filesystem::path archive;
    MissionXtce xtce;
    PacketStreamFormat format{};
    RecordedOctetsOptions octets{};     ///< of files of octets
    std::optional<std::uint16_t> port;  ///< of a capture's datagrams
    double pace = 0.0;                  ///< seconds of reception a second; 0: at once
    IngestTonesOptions tones;           ///< of a file of samples
    IngestRadioOptions radio;           ///< of our own mission's radio links
    std::filesystem::path dictionary = shipped("dictionaries/msl");
    CLI::App* command = nullptr;
};

// Sections of --help: options that not every kind of recording has.
constexpr const char *packets_section = "Of another mission's packets and frames",
                     *octets_section = "Of octets, another mission's or our own",
                     *radio_section = "Of our own mission's radio links", *samples_section = "Of samples",
                     *own_section = "Of our own mission, octets or samples";

/// Refuses what is said of other kinds of recordings.
Result<void> check_section(const CLI::App& command, std::initializer_list<std::string_view> others,
                           std::string_view why) {
    std::string given;
    for (const CLI::Option* option : command.get_options())
        if (std::ranges::find(others, option->get_group()) != others.end() && option->count() > 0)
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

/// Has the station recognise the layout of recordings, which are one stream, by their first octets.
Result<void> recognise(const std::vector<Recording>& recordings, telemetry::ForeignStation& station) {
    constexpr auto beginning_octets_max = telemetry::ForeignStation::beginning_octets_max;
    std::vector<std::uint8_t> beginning;
    for (const auto& recording : recordings) {
        if (beginning.size() >= beginning_octets_max) break;
        recording.each([&](const RecordedPiece& piece) {
            beginning.insert(beginning.end(), piece.octets.begin(), piece.octets.end());
            return beginning.size() < beginning_octets_max;
        });
    }
    return station.recognise(beginning, beginning.size() < beginning_octets_max);
}

/// Hands the pieces of a recording to the archive as a link does.
class Ingest {
  public:
    Ingest(const IngestOptions& options, telemetry::ForeignStation station, PipelineThread& pipeline)
        : options_(options), station_(std::move(station)), delivery_(pipeline), pace_(options.pace) {}

    Result<void> add(const Recording& recording, const std::string& name) {
        bool empty = true;
        const auto unused = recording.each([&](const RecordedPiece& piece) {
            empty = empty && piece.octets.empty();
            return take(piece);
        });
        if (!unused.empty()) delivery_.fault(name + ": " + unused);
        if (empty) delivery_.fault(name + ": no octets of a link are in it");
        if (station_.lost()) collect(station_.end(now_));  // the next recording begins with a packet
        return delivery_.hand_over();
    }

    /// Ends the stream and hands over the totals. False when it was not as it should be.
    Result<bool> finish() {
        collect(station_.end(now_));
        auto totals = station_.totals(now_);
        const auto faults = station_.ledger().faults_since(totals);
        fmt::print("{} packets of {} octets\n", packets_, totals.counters.octets);
        if (!faults.empty()) delivery_.fault(faults);
        if (const auto words = pointers_contradict(options_.format, totals.pointers); !words.empty())
            delivery_.fault(words);
        if (const auto stray = station_.stray_octets(); stray > 0)
            delivery_.fault(fmt::format("{} octets skipped that are neither good frames nor fill", stray));
        if (packets_ + totals.packets.idle_packets == 0)
            if (const auto words = nothing_found(options_.format, totals.counters, totals.packets,
                                                 station_.ledger().heard_sequences());
                !words.empty())
                delivery_.fault(words);
        delivery_.next.links.push_back(std::move(totals));
        if (auto done = delivery_.hand_over(); !done) return done.error();
        return delivery_.is_clean();
    }

  private:
    bool take(const RecordedPiece& piece) {
        pace_.wait_for(piece.ert);
        if (!began_) {
            began_ = true;
            delivery_.next.entries.emplace_back(
                telemetry::LinkState{telemetry::downlink_link, piece.ert, true, "recorded", false});
        }
        if (piece.ert.microseconds - passed_.microseconds >= microseconds_a_second) {
            passed_ = piece.ert;
            delivery_.next.entries.emplace_back(telemetry::EarthTime{piece.ert});
            delivery_.next.links.push_back(station_.totals(piece.ert));
        }
        now_ = piece.ert;
        telemetry::Downlink downlink;
        downlink.now = piece.ert;
        downlink.octets.push_back(
            {telemetry::downlink_link, piece.ert, {piece.octets.begin(), piece.octets.end()}, piece.datagram});
        collect(station_.receive(std::move(downlink)));
        unchecked_octets_ += piece.octets.size();
        if (unchecked_octets_ >= octets_between_checks) {
            unchecked_octets_ = 0;
            if (segments_.add(station_.totals(piece.ert).packets)) {
                delivery_.fault(
                    fmt::format("stopped: more than {} segments in a row are of no packet (zeros?); look at --format, "
                                "and whether this is the right file",
                                UselessSegments::in_a_row_max));
                return false;
            }
        }
        const bool due = delivery_.next.entries.size() >= ingest_delivery_entries || pace_.waits();
        return !due || delivery_.hand_over().ok();
    }

    void collect(telemetry::Received& received) {
        packets_ += received.packets.size();
        delivery_.next.add(std::move(received));
    }

    const IngestOptions& options_;
    telemetry::ForeignStation station_;
    IngestDelivery delivery_;
    RecordedPace pace_;
    Ert now_, passed_;
    std::uint64_t packets_ = 0;
    UselessSegments segments_;
    std::size_t unchecked_octets_ = 0;
    bool began_ = false;
};

/// A recording of X-band's samples, which is a run by itself.
int ingest_samples(const IngestOptions& options) {
    if (options.files.size() > 1) return failed("samples: one recording is a run, given by one file", 2);
    const auto checked = check_section(*options.command, {packets_section, octets_section, radio_section},
                                       "samples hold tones of our own mission, no packets and no frames");
    if (!checked) return failed(checked.error().message, 2);
    IngestTonesOptions tones = options.tones;
    tones.samples = options.files.front();
    tones.archive = options.archive;
    tones.dictionary = options.dictionary;
    tones.start = options.octets.start;
    tones.pace = options.pace;
    return ingest_tones(tones);
}

/// A recording of our own mission's radio links.
int ingest_links(const IngestOptions& options) {
    const auto checked = check_section(*options.command, {packets_section, samples_section},
                                       "--link names a radio link of our own mission, whose octets are PLTUs");
    if (!checked) return failed(checked.error().message, 2);
    IngestRadioOptions radio = options.radio;
    radio.files = options.files;
    radio.archive = options.archive;
    radio.shared.dictionary = options.dictionary;
    radio.octets = options.octets;
    radio.pace = options.pace;
    return ingest_radio(std::move(radio));
}

int ingest(const IngestOptions& options) {
    if (holds_samples(options.files.front())) return ingest_samples(options);
    if (!options.radio.links.empty()) return ingest_links(options);
    const auto section =
        check_section(*options.command, {samples_section, radio_section, own_section},
                      options.files.front().string() + " holds no samples (SigMF, or WAV), and no --link is given");
    if (!section) return failed(section.error().message, 2);
    if (options.xtce.empty()) return failed("--xtce is required: the mission's XTCE file; or --link, of our own", 2);
    if (const auto checked = check_format(options.format); !checked) return failed(checked.error().message, 2);
    if (const auto checked = check_rate(options.octets, options.files); !checked)
        return failed(checked.error().message, 2);
    Ert start = EarthClock{read_clocks}.now();
    if (options.octets.start) {
        const auto told = ert_from_text(*options.octets.start);
        if (!told)
            return failed("--start " + *options.octets.start + ": not a UTC time, such as 2012-219T05:10:47.4", 2);
        start = *told;
    }
    auto octets = options.octets;
    if (options.port) octets.ports = {*options.port};
    const auto files = RecordedFiles::open(options.files, octets, start);
    if (!files) return failed(files.error().message, 2);
    const auto& recordings = files->recordings();
    const auto& first = options.files.front();
    for (std::size_t i = 0; i < recordings.size(); ++i)
        if (options.port && !recordings[i].is_capture())
            return failed(
                fmt::format("--udp-port: selects datagrams of a capture, and {} is none", options.files[i].string()),
                2);
    if (files->octets() == 0) return failed(first.string() + ": no octets of a link are in it");
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
        "pcapng with the times of reception; or of our own mission octets of its radio links (--link), or SigMF and "
        "WAV with samples of its tones. Exit code 1 when anything was lost or not used");
    command.add_option("files", options->files, "recorded files, in the order of reception: one stream")->required();
    command.add_option("--archive", options->archive, "SQLite file that keeps everything")->required();
    command.add_option(
        "--start", options->octets.start,
        "of a plain file: when its first octet was received, UTC; if left out, now, or of our own mission the first "
        "packet's own time. Of samples: the first one, as the file says if left out");
    command.add_option("--pace", options->pace, "seconds of reception a second; 0: as fast as it goes")
        ->check(CLI::Validator{[](std::string& text) {
                                   return std::isfinite(std::strtod(text.c_str(), nullptr)) ? std::string{}
                                                                                            : "not a number: " + text;
                               },
                               ""})
        ->check(CLI::Range(0.0, 1.0e6))
        ->capture_default_str();
    options->command = &command;
    in_section(command, packets_section, [&] {
        add_mission_xtce(command, options->xtce, "the mission's XTCE file; may be given several times");
        add_stream_format(command, options->format);
        command.add_option("--udp-port", options->port, "of a capture: datagrams to this port only; all if left out");
    });
    in_section(command, octets_section, [&] {
        command.add_option("--bits-per-second", options->octets.bits_per_second,
                           "of a plain file: the rate at which it was received; all at once if left out");
    });
    in_section(command, own_section, [&] {
        command.add_option("--dictionary", options->dictionary, "directory of the dictionary of our own mission")
            ->capture_default_str();
    });
    in_section(command, radio_section, [&] {
        command.add_option("--link", options->radio.links,
                           "the link that the octets are of, such as uhf_live or relay; of a capture of several given "
                           "again and again, with the port of each: uhf_live=4200");
        command.add_option("--scenario", options->radio.scenario,
                           "file or name of the scenario whose entry, clocks and light time hold; without it nobody "
                           "knows when entry is, and the clock is the dictionary's");
        command.add_option("--scenarios", options->radio.shared.scenarios, "directory of the scenarios")
            ->capture_default_str();
    });
    in_section(command, samples_section, [&] {
        auto& tones = options->tones;
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
