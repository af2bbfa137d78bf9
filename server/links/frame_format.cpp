// SPDX-License-Identifier: Apache-2.0
#include "server/links/frame_format.hpp"

#include "common/crc.hpp"
#include "common/randomiser.hpp"

#include <algorithm>
#include <cstdlib>
#include <fmt/format.h>
#include <numeric>
#include <vector>

namespace aeolis::server {
namespace {

using telemetry::DownlinkFormat;

telemetry::FrameHints hints_of(const PacketStreamFormat& format) {
    telemetry::FrameHints hints;
    hints.frame_octets = format.frame_octets;
    hints.suffix_octets = format.check_octets;
    hints.coded = format.coded;
    hints.check_symbols = format.check_symbols;
    hints.interleave = format.interleave;
    hints.basis = format.basis;
    hints.crc = format.crc;
    hints.randomised = format.randomised;
    hints.agreed = format.agreed;
    hints.virtual_channel = format.virtual_channel;
    return hints;
}

/// The layout as far as it is told, for frames that are not recognised.
telemetry::FrameStream told(const PacketStreamFormat& format) {
    telemetry::FrameStream stream;
    stream.frame_octets = format.frame_octets.value_or(stream.frame_octets);
    stream.suffix_octets = format.check_octets.value_or(0);
    if (format.coded.value_or(false) && format.check_symbols && format.interleave) {
        stream.code = telemetry::ReedSolomonCode{*format.check_symbols, *format.interleave,
                                                 format.basis.value_or(telemetry::ReedSolomonCode::Basis::dual)};
        stream.suffix_octets = stream.code->check_octets();
        stream.frame_octets = format.frame_octets.value_or(stream.code->data_octets_max());
    }
    stream.randomised = format.randomised.value_or(false);
    stream.agreed = format.agreed;
    stream.agreed.crc = format.crc.value_or(true);
    stream.virtual_channel = format.virtual_channel;
    return stream;
}

/// What is told of a Reed–Solomon code and contradicts itself.
Result<void> check_code(const PacketStreamFormat& format) {
    if (!format.coded.value_or(false)) return {};
    if (format.check_octets) return Error{"--check-symbols skips what --reed-solomon uses: say one of them"};
    if (!format.frame_octets || !format.check_symbols || !format.interleave) return {};
    const telemetry::ReedSolomonCode code{*format.check_symbols, *format.interleave};
    if (code.fits(*format.frame_octets + code.check_octets())) return {};
    return Error{fmt::format("--frame-octets {}: Reed-Solomon codeblocks interleaved {} hold {} octets of a frame at "
                             "most, and a multiple of {}",
                             *format.frame_octets, *format.interleave, code.data_octets_max(), *format.interleave)};
}

/// Options about properties that only AOS frames have, as given.
std::string aos_options(const PacketStreamFormat& format) {
    std::string given;
    if (format.agreed.control_field) given += ", --control-field";
    if (format.agreed.header_error_control) given += ", --header-error-control";
    if (format.agreed.insert_octets > 0) given += ", --insert-octets";
    return given;
}

/// Options about frames of any kind, as given.
std::string frame_options(const PacketStreamFormat& format) {
    std::string given;
    if (format.frame_octets) given += ", --frame-octets";
    if (format.check_octets) given += ", --check-symbols";
    if (format.coded) given += ", --reed-solomon";
    if (format.randomised) given += ", --randomised";
    if (format.crc) given += ", --fecf";
    if (format.virtual_channel) given += ", --virtual-channel";
    return given + aos_options(format);
}

Error refusal_of(const std::string& given, const std::string& why) {
    return Error{given.substr(2) + ": " + why};
}

Result<telemetry::FrameStream> cadu_stream(const PacketStreamFormat& format, std::span<const std::uint8_t> beginning,
                                           bool ended) {
    const auto found = telemetry::recognise_cadus(beginning, hints_of(format), ended);
    const bool is_tm = found && found->kind == telemetry::FrameStream::Kind::tm;
    if (const auto given = aos_options(format); is_tm && !given.empty())
        return refusal_of(given, "of AOS frames only, and these are TM frames");
    if (found) return *found;
    if (!telemetry::find_marker(beginning, 0))
        return Error{"no sync marker 1ACFFC1D, at any bit, inverted or not: these are no CADUs"};
    if (!telemetry::cadu_frame_octets(beginning))
        return Error{format.frame_octets
                         ? "behind the only sync marker 1ACFFC1D stands no frame as it is told"
                         : "no two sync markers 1ACFFC1D, at any bit, inverted or not: say --frame-octets"};
    const auto distance = *telemetry::cadu_frame_octets(beginning);
    const auto agreed = format.frame_octets.value_or(0) + format.check_octets.value_or(0);
    if (format.frame_octets && (distance < agreed || (format.check_octets && distance != agreed)))
        return Error{fmt::format("{} octets stand between sync markers: --frame-octets{} of {} are not right", distance,
                                 format.check_octets ? " and --check-symbols" : "", agreed)};
    return Error{"no layout reads these frames: say what is agreed (--frame-octets, --reed-solomon, --check-symbols, "
                 "--randomised, --fecf, --insert-octets, …)"};
}

/// Whether frames that stand every `distance` octets end with a right CRC-16, most of the first three; none: too few.
std::optional<bool> has_crc(std::span<const std::uint8_t> octets, std::size_t distance,
                            const telemetry::FrameStream& stream, bool ended) {
    constexpr std::size_t frames_wanted = 3;
    std::size_t frames = 0, right = 0;
    for (; frames < frames_wanted && octets.size() >= distance; ++frames, octets = octets.subspan(distance)) {
        const auto unit = octets.subspan(stream.prefix_octets, stream.frame_octets + stream.suffix_octets);
        std::vector<std::uint8_t> plain{unit.begin(), unit.end()};
        if (stream.randomised) randomise_tm(plain);
        if (stream.code) telemetry::correct_codeblock(*stream.code, plain);
        plain.resize(stream.frame_octets);
        right += crc16(plain) == 0 ? 1 : 0;
    }
    if (frames < frames_wanted && !ended) return std::nullopt;
    return 2 * right > frames;
}

/// TM or AOS frames without markers.
Result<telemetry::FrameStream> bare_stream(const PacketStreamFormat& format, DownlinkFormat kind,
                                           std::span<const std::uint8_t> beginning, bool ended) {
    auto stream = told(format);
    stream.kind = kind == DownlinkFormat::tm ? telemetry::FrameStream::Kind::tm : telemetry::FrameStream::Kind::aos;
    stream.marker = false;
    stream.prefix_octets = format.skip;
    if (format.coded.value_or(false) && !stream.code)
        return Error{"frames without sync markers: say --reed-solomon 223 or 239, and --interleave"};
    if ((format.frame_octets || stream.code) && format.crc) return stream;
    if (format.frame_octets || stream.code) {
        const auto crc = has_crc(beginning, format.skip + stream.frame_octets + stream.suffix_octets, stream, ended);
        if (!crc) return Error{"too few frames have come to tell whether they end with a CRC-16: say --fecf"};
        stream.agreed.crc = *crc;
        return stream;
    }
    const auto found = telemetry::crc_frame_octets(beginning, format.skip, ended);
    if (!found) return Error{"frames of no length end with a right CRC-16: say --frame-octets"};
    stream.frame_octets = *found;
    return stream;
}

std::string words_of_code(const telemetry::FrameStream& stream) {
    using telemetry::ReedSolomonCode;
    if (stream.code)
        return fmt::format(", in Reed-Solomon (255,{}) codeblocks interleaved {}, {} basis",
                           ReedSolomonCode::word_symbols_max - stream.code->check_symbols, stream.code->interleave,
                           stream.code->basis == ReedSolomonCode::Basis::dual ? "dual" : "conventional");
    return stream.suffix_octets > 0 ? fmt::format(", {} check symbols behind each", stream.suffix_octets) : "";
}

std::string words_of_markers(const telemetry::BitAlignment& alignment) {
    return fmt::format(", behind sync markers{}{}",
                       alignment.shift > 0
                           ? fmt::format(" shifted by {} bit{}", alignment.shift, alignment.shift == 1 ? "" : "s")
                           : "",
                       alignment.inverted ? ", inverted" : "");
}

std::string words_of(const telemetry::FrameStream& stream) {
    return fmt::format("{} frames of {} octets{}{}{}{}", stream.kind == telemetry::FrameStream::Kind::tm ? "TM" : "AOS",
                       stream.frame_octets, stream.agreed.crc ? " with a CRC-16" : " without a CRC-16",
                       words_of_code(stream), stream.randomised ? ", randomised" : "",
                       stream.marker ? words_of_markers(stream.alignment) : "");
}

}  // namespace

Result<void> check_format(const PacketStreamFormat& format) {
    const auto kind = telemetry::downlink_format(format.name);
    if (!kind) return Error{"there is no format '" + format.name + "': packets, tm, aos, cadu or pltu"};
    if (format.skip > 0 && (*kind == DownlinkFormat::cadu || *kind == DownlinkFormat::pltu))
        return refusal_of(", --skip", "of --format packets, tm and aos only: others begin at a marker");
    const bool frames = *kind != DownlinkFormat::packets && *kind != DownlinkFormat::pltu;
    if (const auto given = frame_options(format); !frames && !given.empty())
        return refusal_of(given, "of --format tm, aos and cadu only, and this is --format " + format.name);
    if (const auto given = aos_options(format); *kind == DownlinkFormat::tm && !given.empty())
        return refusal_of(given, "of AOS frames only, and this is --format tm");
    return check_code(format);
}

Result<telemetry::RecognisedSource> packet_source(const PacketStreamFormat& format,
                                                  std::span<const std::uint8_t> beginning, bool ended) {
    using telemetry::PacketSource, telemetry::RecognisedSource;
    if (const auto checked = check_format(format); !checked) return checked.error();
    const auto kind = telemetry::downlink_format(format.name);
    if (*kind == DownlinkFormat::packets) return RecognisedSource{PacketSource::of_packets(format.skip), {}};
    if (*kind == DownlinkFormat::pltu) return RecognisedSource{PacketSource::of_pltus(), {}};
    const auto frames = *kind == DownlinkFormat::cadu ? cadu_stream(format, beginning, ended)
                                                      : bare_stream(format, *kind, beginning, ended);
    if (!frames) return frames.error();
    return RecognisedSource{PacketSource::of_frames(*frames), words_of(*frames)};
}

telemetry::ForeignStation::Recognise recognise_by(const PacketStreamFormat& format) {
    return [format](std::span<const std::uint8_t> beginning, bool ended) {
        return packet_source(format, beginning, ended);
    };
}

std::string nothing_found(const PacketStreamFormat& format, const telemetry::LinkCounters& link,
                          const telemetry::PacketCounters& packets, bool counted) {
    if (link.frames > 0 && format.virtual_channel && !counted)
        return fmt::format("no frame is of virtual channel {}: look at --virtual-channel", *format.virtual_channel);
    if (link.frames == 0 && link.bad_header > 0 && format.agreed.header_error_control)
        return fmt::format("no header is right by its error control: look at --header-error-control and --format {}",
                           format.name);
    if (link.frames + packets.packets + packets.idle_packets + packets.encapsulation_packets > 0) return {};
    return fmt::format("nothing that is {} was found: look at --format {}, and whether this is the right file",
                       format.name == "packets" ? "a packet" : "a frame", format.name);
}

std::string pointers_contradict(const PacketStreamFormat& format, const telemetry::PointerVerdicts& pointers) {
    constexpr std::uint64_t often = 3;  // chosen: a damaged frame or two tell nothing of the options
    if (pointers.contradicted < often || pointers.contradicted <= pointers.agreed) return {};
    constexpr int control_field_octets = 4, crc_octets = 2;
    const auto most = std::ranges::max_element(pointers.shifts);
    const auto shifted = std::accumulate(pointers.shifts.begin(), pointers.shifts.end(), std::uint64_t{0});
    const int shift =
        2 * *most > shifted
            ? std::abs(static_cast<int>(most - pointers.shifts.begin()) - telemetry::PointerVerdicts::shift_max)
            : 0;
    const bool aos = format.name != "tm";
    std::string options = aos ? "--control-field, --fecf, --insert-octets and --header-error-control"
                              : "--fecf, --check-symbols and --frame-octets";
    if (shift == crc_octets) options = "--fecf";
    if (shift == control_field_octets && aos) options = "--control-field";
    if (shift == control_field_octets + crc_octets && aos) options = "--control-field and --fecf";
    return fmt::format(
        "{} first header pointers contradict the packets before them, {} agree: the frames' data are not "
        "where they are looked for; look at {}",
        pointers.contradicted, pointers.agreed, options);
}

bool needs_beginning(const PacketStreamFormat& format) {
    const auto kind = telemetry::downlink_format(format.name);
    return kind && *kind != DownlinkFormat::packets && *kind != DownlinkFormat::pltu;
}

}  // namespace aeolis::server
