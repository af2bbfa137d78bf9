#include "common/bytes.hpp"
#include "common/space_packet.hpp"
#include "dictionaries/xtce/packet_model.hpp"
#include "server/cli/commands.hpp"
#include "server/cli/shipped_paths.hpp"
#include "telemetry/container_decoder.hpp"
#include "telemetry/packet_source.hpp"

#include <fmt/format.h>
#include <fstream>
#include <map>
#include <set>
#include <vector>

namespace aeolis::server {
namespace {

constexpr std::size_t piece_octets = std::size_t{1} << 20U;
constexpr std::uintmax_t xtce_octets_max = std::uintmax_t{256} << 20U; // ours
constexpr std::size_t findings_shown_max = 200;                         // ours: a person reads no more

/// The text of the XTCE file.
Result<std::string> text_of_file(const std::filesystem::path& path) {
    std::error_code error;
    const auto size = std::filesystem::file_size(path, error);
    std::ifstream in{path, std::ios::binary};
    if (error || !in) return Error{path.string() + " cannot be read"};
    if (size > xtce_octets_max) return Error{path.string() + " is larger than " + std::to_string(xtce_octets_max) + " octets"};
    return std::string{std::istreambuf_iterator<char>{in}, {}};
}

/// How the frames of the file are, from what was said and from its first octets.
Result<telemetry::FrameStream> frames_of(const DecodeOptions& options, telemetry::DownlinkFormat format,
                                         std::span<const std::uint8_t> beginning) {
    telemetry::FrameStream stream;
    if (format == telemetry::DownlinkFormat::cadu) {
        const auto found = telemetry::recognise_cadus(beginning);
        if (!found && !options.frame_octets)
            return Error{"no two sync markers 1ACFFC1D in " + options.packets.string() + ": say --frame-octets"};
        if (found) stream = *found;
    } else {
        stream.kind = format == telemetry::DownlinkFormat::tm ? telemetry::FrameStream::Kind::tm : telemetry::FrameStream::Kind::aos;
        stream.marker = false;
        stream.prefix_octets = options.skip;
        const auto found = telemetry::crc_frame_octets(beginning, options.skip);
        if (!found && !options.frame_octets)
            return Error{"frames of no length end with a right CRC-16: say --frame-octets"};
        stream.agreed.crc = found.has_value();
        stream.frame_octets = found.value_or(stream.frame_octets);
    }
    if (options.frame_octets && *options.frame_octets != stream.frame_octets) {
        stream.frame_octets = *options.frame_octets;
        stream.suffix_octets = 0;
    }
    return stream;
}

Result<telemetry::PacketSource> source_of(const DecodeOptions& options, telemetry::DownlinkFormat format,
                                          std::span<const std::uint8_t> beginning) {
    if (format == telemetry::DownlinkFormat::packets) return telemetry::PacketSource::of_packets(options.skip);
    if (format == telemetry::DownlinkFormat::pltu) return telemetry::PacketSource::of_pltus();
    const auto frames = frames_of(options, format, beginning);
    if (!frames) return frames.error();
    return telemetry::PacketSource::of_frames(*frames);
}

std::string csv_cell(const std::string& text) {
    if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
    std::string cell = "\"";
    for (const char c : text) {
        cell += c;
        if (c == '"') cell += c;
    }
    return cell + '"';
}

/// What is printed: a row a packet, or in the end a line a container.
class Printed {
  public:
    explicit Printed(const telemetry::ContainerDecoder& decoder, bool csv) : decoder_(decoder), csv_(csv) {
        if (csv_) fmt::print("index,apid,count,time,values\n");
    }

    void add(std::span<const std::uint8_t> packet) {
        const auto apid = read_bits(packet, 5, 11);
        const auto contents = decoder_.decode(packet);
        ++kinds_[{apid, contents.container}];
        if (!contents.problem.empty()) ++problems_[contents.problem];
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

  private:
    void print_row(std::span<const std::uint8_t> packet, std::uint64_t apid, const telemetry::DecodedContents& contents) {
        fmt::print("{},{},{},{}", index_, apid, read_bits(packet, 18, 14),
                   contents.time_s ? telemetry::datum_text(*contents.time_s) : std::string{});
        for (const auto& value : contents.values)
            fmt::print(",{}", csv_cell(value.name + "=" + telemetry::datum_text(value.raw) + "|" +
                                       telemetry::datum_text(value.calibrated)));
        fmt::print("\n");
    }

    const telemetry::ContainerDecoder& decoder_;
    bool csv_;
    std::uint64_t index_ = 0;
    std::map<std::pair<std::uint64_t, std::string>, std::uint64_t> kinds_;
    std::map<std::string, std::uint64_t> problems_;
};

void print_findings(const std::vector<dictionary::Finding>& findings) {
    for (std::size_t i = 0; i < findings.size() && i < findings_shown_max; ++i)
        fmt::print(stderr, "{}:{}: {}\n", findings[i].file, findings[i].line, findings[i].message);
    if (findings.size() > findings_shown_max)
        fmt::print(stderr, "and {} more\n", findings.size() - findings_shown_max);
}

/// What of the file was not decoded; true when there is nothing of that kind.
bool print_losses(const telemetry::PacketSource& source, const Printed& printed) {
    const auto link = source.link();
    const auto packets = source.packets();
    if (link.octets > 0)
        fmt::print(stderr, "frames: {} good, {} with a wrong CRC, {} with a wrong header, {} missing in {} gaps; {} octets skipped\n",
                   link.frames, link.bad_crc, link.bad_header, link.missing_frames, link.gaps, link.skipped_octets);
    fmt::print(stderr, "packets: {}, {} idle, {} cut off; {} octets unreadable\n", packets.packets, packets.idle_packets,
               packets.cut_packets, packets.unreadable_octets);
    for (const auto& [problem, count] : printed.problems()) fmt::print(stderr, "{} packets: {}\n", count, problem);
    return link.bad_crc + link.bad_header + link.missing_frames + packets.cut_packets + packets.unreadable_octets == 0 &&
           printed.problems().empty();
}

} // namespace

int decode(const DecodeOptions& options) {
    const auto format = telemetry::downlink_format(options.format);
    if (!format) return failed("there is no format '" + options.format + "': packets, tm, aos, cadu or pltu", 2);
    const auto text = text_of_file(options.xtce);
    if (!text) return failed(text.error().message, 2);
    std::vector<dictionary::Finding> all;
    dictionary::Findings findings{options.xtce.string(), all};
    const auto model = dictionary::xtce::read_packet_model(*text, findings);
    print_findings(all);
    if (!model) return 1;

    std::ifstream in{options.packets, std::ios::binary};
    std::vector<std::uint8_t> piece(piece_octets);
    const auto read_piece = [&] {
        // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): a stream reads characters
        in.read(reinterpret_cast<char*>(piece.data()), static_cast<std::streamsize>(piece.size()));
        return std::span<const std::uint8_t>{piece}.first(static_cast<std::size_t>(in.gcount()));
    };
    if (!in || std::filesystem::is_directory(options.packets)) return failed(options.packets.string() + " cannot be read", 2);
    auto octets = read_piece();
    auto source = source_of(options, *format, octets);
    if (!source) return failed(source.error().message, 2);

    const telemetry::ContainerDecoder decoder{*model};
    Printed printed{decoder, options.csv};
    const auto take = [&] {
        while (const auto packet = source->next()) printed.add(*packet);
    };
    for (; !octets.empty(); octets = read_piece()) {
        source->receive(octets);
        take();
    }
    source->end();
    take();
    printed.print_kinds();
    return print_losses(*source, printed) ? 0 : 1;
}

} // namespace aeolis::server
