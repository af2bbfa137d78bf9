// SPDX-License-Identifier: Apache-2.0
#include "telemetry/frame_receiver.hpp"

#include "common/crc.hpp"
#include "common/randomiser.hpp"
#include "telemetry/packet_extractor.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <string>

namespace aeolis::telemetry {
namespace {

constexpr std::ptrdiff_t header_octets = 6;
constexpr std::size_t shortest_frame_octets = 9;  // a header, a CRC and one octet

// Chosen: a marker that should be there, before a frame that is known to be right by its code or CRC.
constexpr unsigned wrong_marker_bits_max = 4;

/// How well a layout reads a stream.
struct Agreement {
    std::uint64_t frames = 0;
    std::uint64_t unread = 0;  ///< that stand behind a marker, or after another
    /// The number of whole packets less those that the stream's own frames contradict: with check symbols read as data,
    /// a packet ends where no frame says that the next begins.
    std::int64_t packets = 0;
};

Agreement agreement_of(const FrameStream& stream, std::span<const std::uint8_t> octets) {
    FrameReceiver receiver{stream};
    receiver.receive(octets);
    std::map<std::uint32_t, PacketExtractor> channels;
    while (const auto received = receiver.next()) {
        PacketExtractor& channel = channels[received->frame.spacecraft * 64U + received->frame.virtual_channel];
        channel.add(received->frame, received->place);
        while (channel.next()) {
        }
    }
    PacketCounters sum;
    std::uint64_t held = 0;  // no pointer contradicts them yet
    for (const auto& [id, channel] : channels) {
        sum += channel.counters();
        held += channel.held_packets();
    }
    const auto read = sum.packets + sum.idle_packets + sum.encapsulation_packets + held;
    const auto against = sum.cut_packets + (sum.unreadable_octets > 0 ? 1 : 0);
    const auto link = receiver.counters();
    return {link.frames, link.bad_crc + link.bad_header + link.uncorrectable_frames,
            static_cast<std::int64_t>(read) - static_cast<std::int64_t>(against)};
}

template <typename T, std::size_t size>
std::vector<T> known_or(const std::optional<T>& known, const std::array<T, size>& possible) {
    return known ? std::vector<T>{*known} : std::vector<T>(possible.begin(), possible.end());
}

/// The codeblocks of `length` octets behind the first markers.
std::vector<std::vector<std::uint8_t>> first_codeblocks(std::span<const std::uint8_t> octets, std::size_t length) {
    constexpr std::size_t blocks_max = 32;  // chosen: among as many, some are correctable where a code is of use
    std::vector<std::vector<std::uint8_t>> blocks;
    const std::size_t unit = attached_sync_marker.size() + length;
    for (std::size_t from = 0; blocks.size() < blocks_max;) {
        const auto found = find_marker(octets, from);
        if (!found || octets.size() < found->octet + unit + 1) {
            if (found && found->alignment.shift == 0 && octets.size() == found->octet + unit)
                align(octets, found->octet + attached_sync_marker.size(), length, found->alignment,
                      blocks.emplace_back());
            break;
        }
        align(octets, found->octet + attached_sync_marker.size(), length, found->alignment, blocks.emplace_back());
        from = found->octet + unit;
    }
    return blocks;
}

/// How many codeblocks are of a code: one without errors leaves no doubt, and so counts twice. Fill without a code is
/// near a code word, of which the frame's header then is the error: where that would be corrected, nothing is told.
std::size_t agreement_with(const ReedSolomonCode& code, bool randomised,
                           std::span<const std::vector<std::uint8_t>> blocks) {
    std::size_t agreement = 0;
    std::vector<std::uint8_t> sent, block;
    for (const auto& received : blocks) {
        sent = received;
        if (randomised) randomise_tm(sent);
        block = sent;
        const auto found = correct_codeblock(code, block);
        const bool header_is_right = std::equal(sent.begin(), sent.begin() + header_octets, block.begin());
        if (found.uncorrectable_words == 0 && header_is_right) agreement += found.symbols == 0 ? 2 : 1;
    }
    return agreement;
}

/// The code that most of the first codeblocks are of; of two that hold, the one with more check symbols, since a word
/// of it is a word of the other, too. Whether it is randomised remains open: the sequence may be a word itself.
std::optional<ReedSolomonCode> code_of(std::span<const std::uint8_t> octets, std::size_t length,
                                       const FrameHints& known) {
    using Basis = ReedSolomonCode::Basis;
    constexpr std::array<std::size_t, 2> check_symbols{32, 16};
    constexpr std::array<std::size_t, 6> interleaves{1, 2, 3, 4, 5, 8};
    const auto blocks = first_codeblocks(octets, length);
    std::optional<ReedSolomonCode> best;
    std::size_t most = 1;
    for (const std::size_t symbols : check_symbols)  // all: a told 16 must not hide that they are of 32
        for (const std::size_t interleave : known_or(known.interleave, interleaves))
            for (const Basis basis : known_or(known.basis, std::array{Basis::dual, Basis::conventional}))
                for (const bool randomised : known_or(known.randomised, std::array{false, true})) {
                    const ReedSolomonCode code{symbols, interleave, basis};
                    if (!code.fits(length) ||
                        (known.frame_octets && *known.frame_octets + code.check_octets() != length))
                        continue;
                    const std::size_t agreement = agreement_with(code, randomised, blocks);
                    if (agreement <= most) continue;
                    best = code;
                    most = agreement;
                }
    return best;
}

/// The code that is known as a whole, without a codeblock to be seen.
std::optional<ReedSolomonCode> code_told(const FrameHints& known) {
    if (!known.check_symbols || !known.interleave) return std::nullopt;
    return ReedSolomonCode{*known.check_symbols, *known.interleave, known.basis.value_or(ReedSolomonCode::Basis::dual)};
}

/// Where one marker stands alone: the frame of known length behind it.
std::optional<MarkerSpacing> only_frame(std::span<const std::uint8_t> octets, const FrameHints& known) {
    const auto code = code_told(known);
    if (!known.frame_octets && !code) return std::nullopt;
    const std::size_t suffix = code ? code->check_octets() : known.suffix_octets.value_or(0);
    const auto found = find_marker(octets, 0);
    if (!found) return std::nullopt;
    return MarkerSpacing{known.frame_octets.value_or(code ? code->data_octets_max() : 0) + suffix, found->alignment};
}

/// The layouts that frames of `length` octets between two markers may have.
std::vector<FrameStream> layouts_of(std::size_t length, bool crc, const std::optional<ReedSolomonCode>& code,
                                    const FrameHints& known) {
    // Reed-Solomon: 32 or 16 check symbols a code word, 1 to 8 code words interleaved. [ccsds-131.0-b-5]
    constexpr std::array<std::size_t, 10> check_symbols{0, 16, 32, 48, 64, 80, 96, 128, 160, 256};
    std::vector<FrameStream> layouts;
    for (std::size_t symbols : known_or(known.suffix_octets, check_symbols)) {
        if (known.frame_octets && length >= *known.frame_octets && !known.suffix_octets)
            symbols = length - *known.frame_octets;
        if (length < symbols + shortest_frame_octets) continue;
        if (known.frame_octets && *known.frame_octets + symbols != length) continue;
        for (const bool randomised : known_or(known.randomised, std::array{false, true}))
            for (const auto kind : {FrameStream::Kind::tm, FrameStream::Kind::aos}) {
                FrameStream stream;
                stream.kind = kind;
                stream.frame_octets = length - symbols;
                stream.suffix_octets = symbols;
                stream.code = code;
                stream.randomised = randomised;
                stream.agreed = known.agreed;
                stream.agreed.crc = crc;
                stream.virtual_channel = known.virtual_channel;
                layouts.push_back(stream);
            }
        if (known.frame_octets) break;
    }
    return layouts;
}

}  // namespace

FrameReceiver::FrameReceiver(const FrameStream& stream)
    : stream_(stream), alignment_(stream.alignment), found_(stream.alignment) {
    AEOLIS_CHECK(stream.frame_octets >= shortest_frame_octets && stream.frame_octets <= transfer_frame_octets_max);
    AEOLIS_CHECK(!stream.code || (stream.code->check_octets() == stream.suffix_octets &&
                                  stream.code->fits(stream.frame_octets + stream.suffix_octets)));
}

void FrameReceiver::receive(std::span<const std::uint8_t> octets) {
    window_.add(octets);
    counters_.octets += octets.size();
}

void FrameReceiver::skip(std::size_t octets) {
    stray_.skipped(window_.rest().first(octets));
    window_.use(octets);
    counters_.skipped_octets += octets;
}

void FrameReceiver::end() {
    while (next()) {
    }
    const auto rest = window_.rest();
    if (!rest.empty() && (!stream_.marker || marker_errors(rest, found_) == 0)) ++counters_.cut_frames;
    // Bits behind the last frame that fill its last octet are not stray.
    if (expected_ && alignment_.shift > 0 && rest.size() == 1) {
        window_.use(1);
        ++counters_.skipped_octets;
    }
    skip(window_.rest().size());
}

bool FrameReceiver::end_datagram() {
    if (stream_.marker || window_.rest().empty()) return true;
    ++counters_.cut_frames;
    skip(window_.rest().size());
    return false;
}

std::size_t FrameReceiver::unit_octets() const {
    return (stream_.marker ? attached_sync_marker.size() : stream_.prefix_octets) + stream_.frame_octets +
           stream_.suffix_octets;
}

/// Skips to where a frame may begin. Returns false when more octets are needed to find such a place.
bool FrameReceiver::at_unit() {
    if (!stream_.marker) return true;
    damaged_marker_ = false;
    const std::size_t begun = attached_sync_marker.size();
    if (expected_) {
        if (window_.rest().size() <= begun) return false;
        const unsigned errors = marker_errors(window_.rest(), alignment_);
        found_ = alignment_;
        damaged_marker_ = errors > 0;
        if (errors <= (checked() ? wrong_marker_bits_max : 0)) return true;
        expected_ = damaged_marker_ = false;
    }
    const auto found = find_marker(window_.rest(), 0);
    skip(found ? found->octet : window_.rest().size() - std::min(window_.rest().size(), begun));
    if (found) found_ = found->alignment;
    return found.has_value();
}

/// Whether it takes more octets to read what is in front.
bool FrameReceiver::waits_for_octets() const {
    const std::size_t of_shift = found_.shift > 0 ? 1 : 0;
    const bool must_be_followed = found_ != alignment_ && !checked();
    const std::size_t behind = must_be_followed ? attached_sync_marker.size() : 0;
    return window_.rest().size() < unit_octets() + behind + of_shift;
}

/// Reads the frame in front with the suffix behind it.
Parsed<TransferFrame> FrameReceiver::read_unit() {
    const auto rest = window_.rest();
    correction_ = {};
    if (found_ != alignment_ && !checked() && marker_errors(rest.subspan(unit_octets()), found_) > 0)
        return Malformed::bad_field;
    align(rest, stream_.marker ? attached_sync_marker.size() : stream_.prefix_octets,
          stream_.frame_octets + stream_.suffix_octets, found_, block_);
    if (stream_.randomised) randomise_tm(block_);
    if (stream_.code) correction_ = correct_codeblock(*stream_.code, block_);
    if (correction_.uncorrectable_words > 0 && !stream_.agreed.crc) return Malformed::bad_checksum;
    const auto octets_of_frame = std::span{block_}.first(stream_.frame_octets);
    auto frame = stream_.kind == FrameStream::Kind::tm ? read_tm_frame(octets_of_frame, stream_.agreed)
                                                       : read_aos_frame(octets_of_frame, stream_.agreed);
    // Of data that are not packets no pointer shows whether octets are a frame at all.
    if (frame && !frame->packets && !checked()) return Malformed::bad_field;
    return frame;
}

void FrameReceiver::count_good(const TransferFrame& frame) {
    if (found_ != alignment_ && counters_.frames > 0) ++counters_.slips;
    alignment_ = found_;
    expected_ = true;
    ++counters_.frames;
    stray_.frame();
    if (correction_.symbols > 0) ++counters_.corrected_frames;
    counters_.corrected_symbols += correction_.symbols;
    if (frame.corrected_symbols > 0) ++counters_.corrected_headers;
    if (!frame.packets) ++counters_.other_data_frames;
}

void FrameReceiver::count_unread(Malformed why) {
    if (correction_.uncorrectable_words > 0)
        ++counters_.uncorrectable_frames;
    else
        ++(why == Malformed::bad_checksum ? counters_.bad_crc : counters_.bad_header);
}

std::optional<FrameReceiver::Received> FrameReceiver::next() {
    while (at_unit()) {
        if (waits_for_octets()) return std::nullopt;
        const auto frame = read_unit();
        if (!frame && damaged_marker_) {  // another marker may stand here, at another bit
            expected_ = false;
            continue;
        }
        expected_ = false;
        if (!frame) {
            count_unread(frame.why());
            skip(stream_.marker ? attached_sync_marker.size() : unit_octets());
            continue;
        }
        window_.use(unit_octets());
        count_good(*frame);
        if (stream_.virtual_channel && frame->virtual_channel != *stream_.virtual_channel) continue;
        const ChannelNumber channel = channel_number(*frame);
        FrameOrder& order =
            orders_.at(channel, [&](ChannelNumber, const FrameOrder&) { ++counters_.forgotten_channels; });
        const auto placed = order.place(frame->count, frame->count_modulus,
                                        std::span{block_}.first(stream_.frame_octets), sequences_.of(channel));
        if (placed.place != FramePlace::repeated) return Received{*frame, placed.place};
    }
    return std::nullopt;
}

LinkCounters FrameReceiver::counters() const {
    LinkCounters sum = counters_;
    for (const auto& [channel, counted] : sequences_.rows()) sum += counted;
    sum += sequences_.others();
    return sum;
}

std::vector<SequenceTotals> FrameReceiver::sequences() const {
    std::vector<SequenceTotals> totals;
    for (const auto& [channel, counted] : sequences_.rows())
        totals.push_back({"spacecraft " + std::to_string(channel / virtual_channels_max) + ", virtual channel " +
                              std::to_string(channel % virtual_channels_max),
                          false, counted});
    if (sequences_.others().received > 0) totals.push_back({other_sequences, false, sequences_.others()});
    return totals;
}

std::optional<MarkerSpacing> marker_spacing(std::span<const std::uint8_t> octets) {
    constexpr std::size_t markers_seen_max = 1000, alignments = 16;
    constexpr std::size_t least = attached_sync_marker.size() + shortest_frame_octets;
    constexpr std::size_t most = attached_sync_marker.size() + transfer_frame_octets_max;
    struct Seen {
        std::size_t times = 0;
        BitAlignment first;
    };
    std::map<std::size_t, Seen> distances;
    std::array<std::optional<std::size_t>, alignments> last;
    auto found = find_marker(octets, 0);
    for (std::size_t seen = 0; found && seen < markers_seen_max; ++seen) {
        auto& before = last.at(found->alignment.shift * 2 + (found->alignment.inverted ? 1 : 0));
        if (before && found->octet - *before >= least && found->octet - *before <= most) {
            auto& distance = distances[found->octet - *before];
            if (distance.times++ == 0) distance.first = found->alignment;
        }
        before = found->octet;
        found = find_marker(octets, found->octet + 1);
    }
    const auto best = std::ranges::max_element(distances, {}, [](const auto& each) { return each.second.times; });
    if (best == distances.end()) return std::nullopt;
    return MarkerSpacing{best->first - attached_sync_marker.size(), best->second.first};
}

std::optional<std::size_t> cadu_frame_octets(std::span<const std::uint8_t> octets) {
    const auto spacing = marker_spacing(octets);
    return spacing ? std::optional{spacing->octets} : std::nullopt;
}

std::optional<FrameStream> recognise_cadus(std::span<const std::uint8_t> octets, const FrameHints& known, bool ended) {
    constexpr std::size_t looked_at_octets = std::size_t{1} << 20U;
    octets = octets.first(std::min(octets.size(), looked_at_octets));
    auto spacing = marker_spacing(octets);
    if (!spacing && ended) spacing = only_frame(octets, known);
    if (!spacing) return std::nullopt;
    const std::size_t length = spacing->octets;
    FrameHints hints = known;
    std::optional<ReedSolomonCode> code;
    if (known.coded.value_or(!known.suffix_octets)) {
        code = code_of(octets, length, known);
        if (code && known.check_symbols && code->check_symbols != *known.check_symbols) return std::nullopt;
        if (!code && known.coded) code = code_told(known);
        if (known.coded && (!code || !code->fits(length))) return std::nullopt;
        if (code) hints.suffix_octets = code->check_octets();
    }
    std::optional<FrameStream> best;
    Agreement most;
    for (const bool crc : known_or(known.crc, std::array{true, false})) {
        for (auto stream : layouts_of(length, crc, code, hints)) {
            stream.alignment = spacing->alignment;
            const auto agreement = agreement_of(stream, octets);
            if (agreement.frames == 0 || (best && agreement.packets <= most.packets)) continue;
            best = stream;
            most = agreement;
        }
        // Right CRCs leave no doubt. One alone does, unless there can be no more: it may be chance.
        const auto possible = octets.size() / (length + attached_sync_marker.size());
        if (best && (most.frames > 1 || possible <= 2)) break;
    }
    // Without a code and a CRC any octets are a frame now and then.
    if (best && !best->code && (!best->agreed.crc || most.frames == 1) && most.frames < most.unread)
        return std::nullopt;
    return best && (ended || most.frames >= frames_to_agree) ? best : std::nullopt;
}

std::optional<std::size_t> crc_frame_octets(std::span<const std::uint8_t> octets, std::size_t prefix_octets,
                                            bool ended) {
    constexpr std::size_t frames_wanted = 3;
    if (octets.size() <= prefix_octets) return std::nullopt;
    const auto first = octets.subspan(prefix_octets);
    const std::size_t most = std::min(first.size(), transfer_frame_octets_max);
    if (most < shortest_frame_octets) return std::nullopt;
    std::uint16_t crc = crc16(first.first(shortest_frame_octets - 1));
    for (std::size_t size = shortest_frame_octets; size <= most; ++size) {
        crc = crc16(first.subspan(size - 1, 1), crc);
        if (crc != 0) continue;
        std::size_t right = 1;
        auto rest = first.subspan(size);
        while (right < frames_wanted && rest.size() >= prefix_octets + size &&
               crc16(rest.subspan(prefix_octets, size)) == 0) {
            ++right;
            rest = rest.subspan(prefix_octets + size);
        }
        if (right == frames_wanted || (ended && rest.empty())) return size;
    }
    return std::nullopt;
}

}  // namespace aeolis::telemetry
