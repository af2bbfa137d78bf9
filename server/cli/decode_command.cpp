// SPDX-License-Identifier: Apache-2.0
#include "common/bytes.hpp"
#include "common/space_packet.hpp"
#include "dictionaries/xtce/packet_model.hpp"
#include "server/base/csv_text.hpp"
#include "server/cli/commands.hpp"
#include "server/cli/options.hpp"
#include "server/cli/shipped_paths.hpp"
#include "server/cli/useless_segments.hpp"
#include "server/cli/xtce_file.hpp"
#include "telemetry/container_decoder.hpp"
#include "telemetry/packet_source.hpp"
#include "telemetry/packet_time.hpp"

#include <algorithm>
#include <cerrno>
#include <fcntl.h>
#include <fmt/format.h>
#include <fstream>
#include <map>
#include <memory>
#include <set>
#include <unistd.h>
#include <vector>

namespace aeolis::server {
namespace {

struct DecodeOptions {
    MissionXtce xtce;
    std::filesystem::path packets;
    PacketStreamFormat format{};
    std::optional<std::filesystem::path> clock_kernel,
        leap_seconds;                      ///< SPICE text kernels: both, or the leap seconds alone
    std::optional<std::size_t> partition;  ///< of the clock
    bool csv = false;
};

constexpr std::size_t piece_octets = std::size_t{1} << 20U;

Result<telemetry::TextKernel> text_kernel(const std::filesystem::path& path) {
    const auto text = text_of_file(path);
    if (!text) return text.error();
    return telemetry::TextKernel::parse(*text, path.string());
}

Result<telemetry::TimeKernels> time_kernels(const DecodeOptions& options) {
    telemetry::TimeKernels kernels;
    kernels.partition = options.partition;
    if (options.leap_seconds) {
        const auto text = text_kernel(*options.leap_seconds);
        if (!text) return text.error();
        auto leaps = telemetry::LeapSeconds::read(*text);
        if (!leaps) return leaps.error();
        kernels.leaps = std::move(*leaps);
    }
    if (options.clock_kernel) {
        const auto text = text_kernel(*options.clock_kernel);
        if (!text) return text.error();
        auto clock = telemetry::ClockKernel::read(*text);
        if (!clock) return clock.error();
        if (options.partition && (*options.partition == 0 || *options.partition > clock->partitions()))
            return Error{fmt::format("--partition {}: {} has {}, from 1", *options.partition,
                                     options.clock_kernel->string(), clock->partitions())};
        kernels.clock = std::move(*clock);
    }
    return kernels;
}

constexpr std::size_t lines_max = 100;  // chosen: nobody reads more

/// Prints packets, one row each, or at the end a summary with one line per container.
class Printed {
  public:
    /// @param time  where packets hold their time; none: as the decoder finds it
    Printed(const dictionary::xtce::PacketModel& model, const telemetry::ContainerDecoder& decoder,
            const telemetry::TimeKernels& kernels, const std::optional<telemetry::TimeSource>& time, bool csv)
        : model_(model), decoder_(decoder), kernels_(kernels), time_(time), csv_(csv) {
        if (csv_) fmt::print("index,apid,count,time,values\n");
    }

    void add(std::span<const std::uint8_t> packet) {
        const auto apid = read_bits(packet, 5, 11);
        auto contents = decoder_.decode(packet);
        if (time_) {
            contents.time = time_->time_in(contents.values);
            const bool defined = time_->is_defined_in(contents.values);
            ++(contents.time ? timed_ : defined ? other_form_ : untimed_);
        }
        ++kinds_[{apid, contents.container}];
        if (!contents.problem.empty()) note(contents.problem);
        for (const auto& value : contents.unread) ++unread_[{value.parameter, value.line}];
        if (csv_) print_row(packet, apid, contents);
        ++index_;
    }

    void print_kinds() const {
        if (csv_) return;
        for (const auto& [kind, packets] : kinds_)
            fmt::print("{:>10} packets   APID {:>4}   {}\n", packets, kind.first, kind.second);
    }
    std::uint64_t packets() const { return index_; }
    const std::map<std::string, std::uint64_t>& problems() const { return problems_; }
    /// Prints, for each parameter, how many of its values are not read; true when there are none.
    bool print_unread() const {
        std::size_t lines = 0;
        for (const auto& [where, values] : unread_)
            if (++lines <= lines_max)
                fmt::print(stderr, "{} values of {} are not read (line {})\n", values,
                           model_.parameters[where.first].name, where.second);
        if (lines > lines_max) fmt::print(stderr, "values of {} more parameters are not read\n", lines - lines_max);
        return unread_.empty();
    }

    /// Prints in how many packets the parameter of --time is no time; true when there are none.
    bool print_times() const {
        if (!time_) return true;
        const std::string wanted = "--time " + time_->name + time_->member;
        if (other_form_ > 0)
            fmt::print(stderr, "{}: in {} packets it is not in that form, and they have no time\n", wanted,
                       other_form_);
        if (timed_ + other_form_ == 0 && untimed_ > 0)
            fmt::print(stderr, "{}: none of {} packets holds it, and they have no time\n", wanted, untimed_);
        return other_form_ == 0 && (timed_ > 0 || untimed_ == 0);
    }

  private:
    /// Counts a problem. Some texts name a place in the packet and so may all differ.
    void note(const std::string& problem) {
        const bool room = problems_.size() < problems_max || problems_.contains(problem);
        ++problems_[room ? problem : "other problems"];
    }
    void print_row(std::span<const std::uint8_t> packet, std::uint64_t apid,
                   const telemetry::DecodedContents& contents) {
        fmt::print("{},{},{},{}", index_, apid, read_bits(packet, 18, 14),
                   contents.time ? telemetry::time_text(*contents.time, kernels_) : std::string{});
        for (const auto& value : contents.values)
            fmt::print(",{}", csv_text(value.name + "=" + telemetry::datum_text(value.raw) + "|" +
                                       telemetry::datum_text(value.calibrated)));
        fmt::print("\n");
    }

    const dictionary::xtce::PacketModel& model_;
    const telemetry::ContainerDecoder& decoder_;
    const telemetry::TimeKernels& kernels_;
    const std::optional<telemetry::TimeSource>& time_;
    bool csv_;
    std::uint64_t index_ = 0;
    std::uint64_t timed_ = 0, other_form_ = 0, untimed_ = 0;  ///< packets, by what --time finds in them
    std::map<std::pair<std::uint64_t, std::string>, std::uint64_t> kinds_;
    static constexpr std::size_t problems_max = 50;  ///< chosen: nobody reads more
    std::map<std::string, std::uint64_t> problems_;
    std::map<std::pair<std::size_t, unsigned>, std::uint64_t> unread_;  ///< by parameter and line
};

/// Prints the virtual channels, and what packet counts are not in order.
void print_sequences(const telemetry::PacketSource& source) {
    std::size_t lines = 0, left = 0;
    for (const auto& [name, packets, counted] : source.sequences()) {
        if (packets && counted.missing + counted.repeated + counted.late + counted.restarts == 0) continue;
        if (lines == lines_max) {
            ++left;
            continue;
        }
        ++lines;
        fmt::print(stderr, "{}: {} {}, {} missing in {} gaps, {} repeated, {} late, {} restarts\n", name,
                   counted.received, packets ? "packets" : "frames", counted.missing, counted.gaps, counted.repeated,
                   counted.late, counted.restarts);
    }
    if (left > 0) fmt::print(stderr, "{} more virtual channels and packet ids\n", left);
}

/// Prints the losses in the file; true when there are none.
bool print_losses(const telemetry::PacketSource& source, const Printed& printed, const PacketStreamFormat& format) {
    const auto link = source.link();
    const auto packets = source.packets();
    if (link.octets > 0)
        fmt::print(stderr,
                   "frames: {} good, {} with a wrong CRC, {} with a wrong header, {} missing in {} gaps, {} repeated, "
                   "{} late, "
                   "{} restarts, {} cut off; {} octets skipped\n",
                   link.frames, link.bad_crc, link.bad_header, link.missing_frames, link.gaps, link.repeated_frames,
                   link.late_frames, link.restarts, link.cut_frames, link.skipped_octets);
    if (link.slips > 0)
        fmt::print(stderr, "bits: {} frames began at another bit than the one before, or with another polarity\n",
                   link.slips);
    if (link.other_data_frames > 0)
        fmt::print(stderr, "data: {} frames hold data that are not packets, as their synchronisation flag says\n",
                   link.other_data_frames);
    if (link.corrected_headers > 0)
        fmt::print(stderr, "headers: {} frames corrected by their header's error control\n", link.corrected_headers);
    if (link.corrected_frames + link.uncorrectable_frames > 0)
        fmt::print(stderr, "Reed-Solomon: {} frames corrected, {} symbols; {} frames uncorrectable\n",
                   link.corrected_frames, link.corrected_symbols, link.uncorrectable_frames);
    fmt::print(
        stderr,
        "packets: {}, {} idle, {} encapsulation packets not decoded, {} cut off, {} segments without the rest; {} "
        "octets unreadable\n",
        packets.packets, packets.idle_packets, packets.encapsulation_packets, packets.cut_packets,
        packets.lost_segments, packets.unreadable_octets);
    if (link.forgotten_channels > 0)
        fmt::print(stderr, "virtual channels: {} more than are followed at a time were forgotten\n",
                   link.forgotten_channels);
    if (source.stray_octets() > 0)
        fmt::print(stderr, "skipped: {} octets that are neither good frames nor fill\n", source.stray_octets());
    if (const auto words = pointers_contradict(format, source.pointers()); !words.empty())
        fmt::print(stderr, "{}\n", words);
    print_sequences(source);
    for (const auto& [problem, count] : printed.problems()) fmt::print(stderr, "{} packets: {}\n", count, problem);
    const bool all_read = printed.print_unread(), all_times = printed.print_times();
    return link.bad_crc + link.bad_header + link.uncorrectable_frames + link.missing_frames + link.cut_frames +
                   link.other_data_frames + packets.encapsulation_packets + packets.cut_packets +
                   packets.lost_segments + packets.unreadable_octets + source.stray_octets() ==
               0 &&
           printed.problems().empty() && all_read && all_times;
}

/// How many octets from `at` on a sparse file does not store.
std::uint64_t hole_octets(const std::filesystem::path& name, std::uint64_t at) {
    const int file = ::open(name.c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0) return 0;
    off_t stored = ::lseek(file, static_cast<off_t>(at), SEEK_DATA);
    if (stored < 0 && errno == ENXIO) stored = ::lseek(file, 0, SEEK_END);
    ::close(file);
    return stored > static_cast<off_t>(at) ? static_cast<std::uint64_t>(stored) - at : 0;
}

/// Prints any mission's packets by its XTCE file; returns 0 when every octet was decoded.
int decode(const DecodeOptions& options) {
    if (const auto checked = check_format(options.format); !checked) return failed(checked.error().message, 2);
    const auto kernels = time_kernels(options);
    if (!kernels) return failed(kernels.error().message, 2);
    const auto xtce = read_xtce(options.xtce);
    if (!xtce) return xtce.exit_code;
    const auto& model = xtce.model;

    std::ifstream in{options.packets, std::ios::binary};
    std::vector<std::uint8_t> piece(piece_octets);
    const auto read_piece = [&] {
        // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): a stream reads characters
        in.read(reinterpret_cast<char*>(piece.data()), static_cast<std::streamsize>(piece.size()));
        return std::span<const std::uint8_t>{piece}.first(static_cast<std::size_t>(in.gcount()));
    };
    if (!in || std::filesystem::is_directory(options.packets))
        return failed(options.packets.string() + " cannot be read", 2);
    auto octets = read_piece();
    if (octets.empty()) return failed(options.packets.string() + " is empty");
    auto recognised = packet_source(options.format, octets, octets.size() < piece_octets);
    if (!recognised) return failed(options.packets.string() + ": " + recognised.error().message, 2);
    auto& source = recognised->source;
    if (!recognised->layout.empty()) fmt::print(stderr, "taken for {}\n", recognised->layout);

    const telemetry::ContainerDecoder decoder{*model};
    Printed printed{*model, decoder, *kernels, xtce.time, options.csv};
    const auto take = [&] {
        while (const auto packet = source.next()) printed.add(*packet);
    };
    // No frame that begins at a sync marker lies in a hole: but for a piece at either end of it, it is passed over.
    const bool by_marker = options.format.name == "pltu" || options.format.name == "cadu";
    UselessSegments segments;
    std::uint64_t at = 0, in_holes = 0;
    std::string stopped;
    for (; !octets.empty() && stopped.empty(); octets = read_piece()) {
        source.receive(octets);
        take();
        at += octets.size();
        if (segments.add(source.packets()))
            stopped = fmt::format("stopped at octet {}: more than {} segments in a row are of no packet (zeros?); look "
                                  "at --format, and whether this is the right file",
                                  at, UselessSegments::in_a_row_max);
        if (!by_marker || std::ranges::any_of(octets, [](std::uint8_t octet) { return octet != 0; })) continue;
        const std::uint64_t hole = hole_octets(options.packets, at);
        if (hole <= 2 * piece_octets) continue;
        in_holes += hole - piece_octets;
        at += hole - piece_octets;
        in.seekg(static_cast<std::streamoff>(at));
    }
    source.end();
    take();
    printed.print_kinds();
    const bool all_decoded = print_losses(source, printed, options.format) && in_holes == 0;
    if (in_holes > 0) fmt::print(stderr, "holes: {} octets that the file does not store were passed over\n", in_holes);
    if (!stopped.empty()) return failed(options.packets.string() + ": " + stopped);
    if (const auto words = nothing_found(options.format, source.link(), source.packets(), !source.sequences().empty());
        !words.empty())
        return failed(options.packets.string() + ": " + words);
    return all_decoded ? 0 : 1;
}

}  // namespace

void add_decode_command(CLI::App& program, int& exit_code) {
    const auto options = std::make_shared<DecodeOptions>();
    auto& command = *program.add_subcommand(
        "decode",
        "decodes any mission's packets by its XTCE file; exit code 1 when anything but idle data was not decoded");
    add_mission_xtce(command, options->xtce, "the mission's XTCE file, version 1.0 to 1.3; may be given several times")
        ->required();
    command.add_option("--packets", options->packets, "file of packets or frames")->required();
    add_stream_format(command, options->format);
    auto* leap_seconds =
        command.add_option("--lsk", options->leap_seconds,
                           "leap seconds (SPICE text kernel): turns times since GPS, TAI, J2000 or a date into UTC");
    auto* clock_kernel =
        command
            .add_option("--sclk", options->clock_kernel,
                        "the spacecraft's clock (SPICE text kernel, type 1): turns packets' time into SCET, "
                        "UTC as 2012-219T05:17:57.123")
            ->needs(leap_seconds);
    command
        .add_option("--partition", options->partition,
                    "partition of the clock; the first that holds the count if left out")
        ->check(whole_number())
        ->needs(clock_kernel);
    command.add_flag(
        "--csv", options->csv,
        "print a row per packet: index, APID, count, time, then NAME=RAW|CALIBRATED for each value. Time is "
        "the first absolute time in the packet, seconds since its epoch (UNIX, and with --lsk others: as UTC). If the "
        "XTCE file "
        "has none, it is the two numbers behind the primary header if their names contain 'coarse' "
        "and 'fine': counts and their binary fraction (CUC). Otherwise it is empty");
    command.callback([options, &exit_code] { exit_code = decode(*options); });
}

}  // namespace aeolis::server
