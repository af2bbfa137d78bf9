// SPDX-License-Identifier: Apache-2.0
#include "common/cfdp.hpp"

#include "common/bytes.hpp"
#include "common/crc.hpp"

#include <algorithm>
#include <array>

namespace aeolis::cfdp {
namespace {

constexpr std::size_t fixed_header_octets = 4;
constexpr std::size_t pdu_crc_octets = 2;
constexpr std::size_t data_field_octets_max = 65535;

template <typename... Cases>
struct Match : Cases... {
    using Cases::operator()...;
};

/// Takes fields from the front. After the first incomplete field, every field is zero and `ok` is false.
class Fields {
  public:
    explicit Fields(std::span<const std::uint8_t> octets) : rest_(octets) {}

    std::uint64_t number(std::size_t octets) {
        std::uint64_t value = 0;
        for (const std::uint8_t octet : take(octets)) value = (value << 8) | octet;
        return value;
    }
    std::uint8_t octet() { return static_cast<std::uint8_t>(number(1)); }
    std::uint32_t word() { return static_cast<std::uint32_t>(number(4)); }
    std::string_view text() {
        const auto octets = take(number(1));
        // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): octets seen as characters
        return {reinterpret_cast<const char*>(octets.data()), octets.size()};
    }
    std::span<const std::uint8_t> take(std::size_t octets) {
        if (octets > rest_.size()) {
            ok = false;
            rest_ = {};
            return {};
        }
        const auto taken = rest_.first(octets);
        rest_ = rest_.subspan(octets);
        return taken;
    }
    std::span<const std::uint8_t> rest() { return take(rest_.size()); }
    bool has(std::size_t octets) const { return octets <= rest_.size(); }

    bool ok = true;

  private:
    std::span<const std::uint8_t> rest_;
};

bool is_condition(unsigned code) {
    return code <= 11 || code >= 14;
}

Condition condition_in(std::uint8_t octet, bool& known) {
    known = known && is_condition(octet >> 4);
    return static_cast<Condition>(octet >> 4);
}

Parsed<Content> read_directive(Fields fields) {
    const std::uint8_t code = fields.octet();
    bool known = true;
    Content content;
    switch (code) {
    case static_cast<std::uint8_t>(Directive::metadata): {
        Metadata metadata;
        const std::uint8_t flags = fields.octet();
        metadata.closure_requested = (flags & 0x40) != 0;
        metadata.checksum = static_cast<Checksum>(flags & 0x0F);
        metadata.file_octets = fields.word();
        metadata.source_name = fields.text();
        metadata.destination_name = fields.text();
        content = metadata;  // options may follow (messages to users, filestore requests); all are ignored
        break;
    }
    case static_cast<std::uint8_t>(Directive::eof): {
        Eof eof;
        eof.condition = condition_in(fields.octet(), known);
        eof.checksum = fields.word();
        eof.file_octets = fields.word();
        content = eof;
        break;
    }
    case static_cast<std::uint8_t>(Directive::finished): {
        Finished finished;
        const std::uint8_t octet = fields.octet();
        finished.condition = condition_in(octet, known);
        finished.complete = (octet & 0x04) == 0;
        finished.file_status = octet & 0x03;
        content = finished;
        break;
    }
    case static_cast<std::uint8_t>(Directive::ack): {
        Ack ack;
        const unsigned of = fields.octet() >> 4;
        known = of == static_cast<unsigned>(Directive::eof) || of == static_cast<unsigned>(Directive::finished);
        ack.of = static_cast<Directive>(of);
        const std::uint8_t octet = fields.octet();
        ack.condition = condition_in(octet, known);
        ack.transaction_status = octet & 0x03;
        content = ack;
        break;
    }
    case static_cast<std::uint8_t>(Directive::nak): {
        Nak nak;
        nak.scope.start = fields.word();
        nak.scope.end = fields.word();
        known = nak.scope.start <= nak.scope.end;
        while (fields.has(8)) {
            const std::uint32_t start = fields.word();
            const Range range{start, fields.word()};
            known = known && range.start <= range.end;
            (void)nak.requests.try_push_back(range);
        }
        content = nak;
        break;
    }
    case static_cast<std::uint8_t>(Directive::prompt): content = Prompt{(fields.octet() & 0x80) != 0}; break;
    case static_cast<std::uint8_t>(Directive::keep_alive): content = KeepAlive{fields.word()}; break;
    default: return fields.ok ? Malformed::bad_field : Malformed::too_short;
    }
    if (!fields.ok) return Malformed::too_short;
    if (!known) return Malformed::bad_field;
    return content;
}

std::size_t content_octets(const Content& content) {
    return std::visit(Match{
                          [](const FileData& data) { return 4 + data.octets.size(); },
                          [](const Metadata& m) { return 8 + m.source_name.size() + m.destination_name.size(); },
                          [](const Eof&) { return std::size_t{10}; },
                          [](const Finished&) { return std::size_t{2}; },
                          [](const Ack&) { return std::size_t{3}; },
                          [](const Nak& nak) { return 9 + nak.requests.size() * 8; },
                          [](const Prompt&) { return std::size_t{2}; },
                          [](const KeepAlive&) { return std::size_t{5}; },
                      },
                      content);
}

void put_text(BitWriter& writer, std::string_view text) {
    AEOLIS_CHECK(text.size() <= 255);
    writer.put(text.size(), 8);
    for (const char each : text) writer.put(static_cast<unsigned char>(each), 8);
}

void put_directive(BitWriter& writer, Directive code) {
    writer.put(static_cast<std::uint8_t>(code), 8);
}
void put_condition(BitWriter& writer, Condition condition) {
    writer.put(static_cast<std::uint8_t>(condition), 4);
}

void put_content(BitWriter& writer, const Content& content) {
    std::visit(Match{
                   [&](const FileData& data) {
                       writer.put(data.offset, 32);
                       writer.put_octets(data.octets);
                   },
                   [&](const Metadata& metadata) {
                       put_directive(writer, Directive::metadata);
                       writer.put(0, 1);
                       writer.put(metadata.closure_requested, 1);
                       writer.put(0, 2);
                       writer.put(static_cast<std::uint8_t>(metadata.checksum), 4);
                       writer.put(metadata.file_octets, 32);
                       put_text(writer, metadata.source_name);
                       put_text(writer, metadata.destination_name);
                   },
                   [&](const Eof& eof) {
                       put_directive(writer, Directive::eof);
                       put_condition(writer, eof.condition);
                       writer.put(0, 4);
                       writer.put(eof.checksum, 32);
                       writer.put(eof.file_octets, 32);
                   },
                   [&](const Finished& finished) {
                       put_directive(writer, Directive::finished);
                       put_condition(writer, finished.condition);
                       writer.put(0, 1);
                       writer.put(!finished.complete, 1);
                       writer.put(finished.file_status, 2);
                   },
                   [&](const Ack& ack) {
                       put_directive(writer, Directive::ack);
                       writer.put(static_cast<std::uint8_t>(ack.of), 4);
                       writer.put(ack.of == Directive::finished, 4);  // directive subtype
                       put_condition(writer, ack.condition);
                       writer.put(0, 2);
                       writer.put(ack.transaction_status, 2);
                   },
                   [&](const Nak& nak) {
                       put_directive(writer, Directive::nak);
                       writer.put(nak.scope.start, 32);
                       writer.put(nak.scope.end, 32);
                       for (const Range& range : nak.requests) {
                           writer.put(range.start, 32);
                           writer.put(range.end, 32);
                       }
                   },
                   [&](const Prompt& prompt) {
                       put_directive(writer, Directive::prompt);
                       writer.put(prompt.keep_alive, 1);
                       writer.put(0, 7);
                   },
                   [&](const KeepAlive& progress) {
                       put_directive(writer, Directive::keep_alive);
                       writer.put(progress.progress_octets, 32);
                   },
               },
               content);
}

}  // namespace

Parsed<Pdu> read(std::span<const std::uint8_t> octets) {
    if (octets.size() < fixed_header_octets) return Malformed::too_short;
    const unsigned version = octets[0] >> 5;
    if (version > 1) return Malformed::other_version;
    const bool file_data = (octets[0] & 0x10) != 0;
    const bool large = (octets[0] & 0x01) != 0;
    const std::size_t length = (static_cast<std::size_t>(octets[1]) << 8) + octets[2];
    const bool segment_metadata = (octets[3] & 0x08) != 0;
    if (large || segment_metadata) return Malformed::bad_field;
    const std::size_t entity = ((octets[3] >> 4) & 7U) + std::size_t{1};
    const std::size_t sequence = (octets[3] & 7U) + std::size_t{1};
    const std::size_t header = fixed_header_octets + 2 * entity + sequence;
    if (octets.size() < header + length) return Malformed::too_short;
    if (octets.size() > header + length) return Malformed::too_long;

    Pdu pdu;
    pdu.header.toward_sender = (octets[0] & 0x08) != 0;
    pdu.header.unacknowledged = (octets[0] & 0x04) != 0;
    pdu.header.crc = (octets[0] & 0x02) != 0;
    Fields ids{octets.subspan(fixed_header_octets)};
    pdu.header.source = ids.number(entity);
    pdu.header.sequence = ids.number(sequence);
    pdu.header.destination = ids.number(entity);
    auto field = octets.subspan(header);
    if (pdu.header.crc) {
        if (field.size() < pdu_crc_octets) return Malformed::too_short;
        if (crc16(octets) != 0) return Malformed::bad_checksum;
        field = field.first(field.size() - pdu_crc_octets);
    }
    if (file_data) {
        if (field.size() < 4) return Malformed::too_short;
        const auto offset = static_cast<std::uint32_t>(read_bits(field, 0, 32));
        if (std::uint64_t{offset} + field.size() - 4 > 0xFFFFFFFF) return Malformed::bad_field;
        pdu.content = FileData{offset, field.subspan(4)};
        return pdu;
    }
    const auto directive = read_directive(Fields{field});
    if (!directive) return directive.why();
    pdu.content = *directive;
    return pdu;
}

std::size_t octets_of(const Pdu& pdu) {
    return written_header_octets + content_octets(pdu.content) + (pdu.header.crc ? pdu_crc_octets : 0);
}

std::size_t write(const Pdu& pdu, std::span<std::uint8_t> into) {
    const std::size_t size = octets_of(pdu);
    AEOLIS_CHECK(size <= into.size() && size - written_header_octets <= data_field_octets_max);
    AEOLIS_CHECK(pdu.header.source <= 0xFFFF && pdu.header.destination <= 0xFFFF && pdu.header.sequence <= 0xFFFFFFFF);
    const auto octets = into.first(size);
    std::fill(octets.begin(), octets.end(), std::uint8_t{0});
    BitWriter writer{octets};
    writer.put(1, 3);
    writer.put(std::holds_alternative<FileData>(pdu.content), 1);
    writer.put(pdu.header.toward_sender, 1);
    writer.put(pdu.header.unacknowledged, 1);
    writer.put(pdu.header.crc, 1);
    writer.put(0, 1);
    writer.put(size - written_header_octets, 16);
    writer.put(0, 1);
    writer.put(2 - 1, 3);
    writer.put(0, 1);
    writer.put(4 - 1, 3);
    writer.put(pdu.header.source, 16);
    writer.put(pdu.header.sequence, 32);
    writer.put(pdu.header.destination, 16);
    put_content(writer, pdu.content);
    if (pdu.header.crc) writer.put(crc16(octets.first(size - pdu_crc_octets)), 16);
    return size;
}

std::uint32_t modular_checksum(std::uint32_t offset, std::span<const std::uint8_t> octets) {
    // The sum of each of the four places by itself: they are put together once, not octet by octet.
    std::array<std::uint32_t, 4> sums{};
    for (; octets.size() >= sums.size(); octets = octets.subspan(sums.size()))
        for (std::size_t place = 0; place < sums.size(); ++place) sums[place] += octets[place];
    for (std::size_t place = 0; place < octets.size(); ++place) sums[place] += octets[place];
    std::uint32_t sum = 0;
    for (const std::uint32_t of_place : sums) sum += of_place << (24 - 8 * (offset++ % 4));
    return sum;
}

}  // namespace aeolis::cfdp
