// SPDX-License-Identifier: Apache-2.0
#include "common/crc.hpp"
#include "common/randomiser.hpp"
#include "telemetry/frame_receiver.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/octets.hpp"
#include "tests/support/reed_solomon_encoder.hpp"

#include <algorithm>

namespace telemetry_frame_receiver_test {

using namespace aeolis;
using namespace aeolis::telemetry;

namespace {

using Octets = std::vector<std::uint8_t>;
constexpr std::size_t length = 120;

Octets frame_octets(FrameStream::Kind kind, unsigned count, std::mt19937& random, std::size_t octets_of_it = length,
                    bool crc = true) {
    const bool tm = kind == FrameStream::Kind::tm;
    const auto data = test::random_octets(random, octets_of_it - (tm ? 6 : 8) - (crc ? 2 : 0));
    TransferFrame frame;
    frame.spacecraft = 76;
    frame.virtual_channel = static_cast<std::uint8_t>(count % 2);
    frame.count = count / 2;
    frame.data = data;
    Octets octets(octets_of_it);
    if (tm)
        write_tm_frame(frame, static_cast<std::uint8_t>(count), crc, octets);
    else
        write_aos_frame(frame, crc, octets);
    return octets;
}

void append(Octets& to, std::span<const std::uint8_t> octets) {
    to.insert(to.end(), octets.begin(), octets.end());
}

std::size_t frames_in(FrameReceiver& receiver, std::span<const std::uint8_t> stream, std::mt19937& random) {
    std::size_t frames = 0;
    while (!stream.empty()) {
        const std::size_t now = std::min<std::size_t>(1 + random() % 300, stream.size());
        receiver.receive(stream.first(now));
        stream = stream.subspan(now);
        while (receiver.next()) ++frames;
    }
    receiver.end();
    return frames;
}

}  // namespace

TEST_CASE("CADUs are found between any octets, randomised or not, TM or AOS", "[telemetry]") {
    std::mt19937 random{1};
    for (const auto kind : {FrameStream::Kind::tm, FrameStream::Kind::aos})
        for (const bool randomised : {false, true}) {
            Octets stream;
            for (unsigned i = 0; i < 600; ++i) {
                append(stream, test::random_octets(random, random() % 30));
                Octets frame = frame_octets(kind, i, random);
                if (randomised) randomise_tm(frame);
                append(stream, attached_sync_marker);
                append(stream, frame);
            }
            FrameReceiver receiver{{.kind = kind, .frame_octets = length, .randomised = randomised}};
            CHECK(frames_in(receiver, stream, random) == 600);
            CHECK(receiver.counters().gaps == 0);
            CHECK(receiver.counters().octets == receiver.counters().skipped_octets + 600 * (length + 4));
        }
}

TEST_CASE("a damaged CADU is counted and missed in its virtual channel; the next one is found", "[telemetry]") {
    std::mt19937 random{2};
    Octets stream;
    for (unsigned i = 0; i < 100; ++i) {
        Octets frame = frame_octets(FrameStream::Kind::tm, i, random);
        if (i == 50) frame[60] ^= 0x10;
        if (i == 60) frame.erase(frame.begin() + 30, frame.begin() + 40);
        append(stream, attached_sync_marker);
        append(stream, frame);
    }
    FrameReceiver receiver{{.frame_octets = length}};
    CHECK(frames_in(receiver, stream, random) == 98);
    CHECK(receiver.counters().bad_crc == 2);
    CHECK(receiver.counters().missing_frames == 2);
}

TEST_CASE("frames without marker stand one after another, each behind its prefix", "[telemetry]") {
    std::mt19937 random{3};
    Octets stream;
    for (unsigned i = 0; i < 100; ++i) {
        append(stream, test::hex("60f06060"));
        append(stream, frame_octets(FrameStream::Kind::aos, i, random));
    }
    stream[4 + 10] ^= 1;
    FrameReceiver receiver{
        {.kind = FrameStream::Kind::aos, .frame_octets = length, .marker = false, .prefix_octets = 4}};
    CHECK(frames_in(receiver, stream, random) == 99);
    CHECK(receiver.counters().bad_crc == 1);
}

TEST_CASE("the length of frames is found from the markers, and from the CRC where there are none", "[telemetry]") {
    std::mt19937 random{4};
    Octets cadus = test::random_octets(random, 17), bare;
    for (unsigned i = 0; i < 20; ++i) {
        const Octets frame = frame_octets(FrameStream::Kind::tm, i, random);
        append(cadus, attached_sync_marker);
        append(cadus, frame);
        append(bare, test::hex("0102"));
        append(bare, frame);
    }
    CHECK(cadu_frame_octets(cadus) == length);
    CHECK_FALSE(cadu_frame_octets(std::span{cadus}.first(100)));
    CHECK(crc_frame_octets(bare, 2, false) == length);
    CHECK(crc_frame_octets(std::span{bare}.first(length + 2), 2, true) == length);
    CHECK_FALSE(crc_frame_octets(std::span{bare}.first(length + 2), 2, false));  // more may come
    CHECK_FALSE(crc_frame_octets(std::span{bare}.first(length), 2, true));
}

TEST_CASE("a chance CRC is not taken for a frame, and a stream that goes on is believed after some frames",
          "[telemetry][R55]") {
    std::mt19937 random{5};
    for (int round = 0; round < 40; ++round) {
        const Octets noise = test::random_octets(random, 60'000);  // with a right CRC at about one length
        CHECK_FALSE(crc_frame_octets(noise, 0, true));
    }
    Octets cadus;
    for (unsigned i = 0; i < 20; ++i) {
        append(cadus, attached_sync_marker);
        append(cadus, frame_octets(FrameStream::Kind::tm, i, random));
        const auto found = recognise_cadus(cadus, {}, false);
        CHECK(found.has_value() == (i + 1 >= frames_to_agree));
        if (i > 0) CHECK(recognise_cadus(cadus, {}, true));
    }
}

TEST_CASE("an insert zone, a control field and a header's error control are stepped over where they are agreed",
          "[telemetry][R55]") {
    const Octets data = test::hex("00112233445566778899aabb");
    for (const bool control_field : {false, true})
        for (const std::uint8_t insert : {0, 2, 5})
            for (const bool error_control : {false, true}) {
                CAPTURE(control_field, insert, error_control);
                Octets octets(6);
                octets[0] = 0x40;
                if (error_control) append(octets, test::hex("1cc1"));
                append(octets, Octets(insert, 0xEE));
                append(octets, test::hex("0003"));  // the pointer
                append(octets, data);
                if (control_field) append(octets, test::hex("01020304"));
                const auto frame = read_aos_frame(octets, {.crc = false,
                                                           .control_field = control_field,
                                                           .header_error_control = error_control,
                                                           .insert_octets = insert});
                REQUIRE(frame);
                CHECK(frame->first_header_pointer == 3);
                CHECK(test::copy_of(frame->data) == data);
                CHECK(frame->control_field.has_value() == control_field);
            }
}

TEST_CASE(
    "frames whose data are not packets are good ones, and counted by that name, if a CRC says that they are frames",
    "[telemetry][frames][R55]") {
    std::mt19937 random{21};
    Octets stream;
    for (unsigned i = 0; i < 13; ++i) {
        Octets octets = frame_octets(FrameStream::Kind::tm, i, random);
        octets[4] |= 0x40U;
        const auto crc = crc16(std::span{octets}.first(length - 2));
        octets[length - 2] = static_cast<std::uint8_t>(crc >> 8);
        octets[length - 1] = static_cast<std::uint8_t>(crc & 0xFF);
        append(stream, octets);
    }
    FrameStream layout{.frame_octets = length, .marker = false};
    FrameReceiver receiver{layout};
    CHECK(frames_in(receiver, stream, random) == 13);
    CHECK(receiver.counters().frames == 13);
    CHECK(receiver.counters().other_data_frames == 13);
    CHECK(receiver.counters().bad_header == 0);
    CHECK(receiver.counters().skipped_octets == 0);
    layout.agreed.crc = false;
    FrameReceiver without{layout};
    CHECK(frames_in(without, stream, random) == 0);
    CHECK(without.counters().bad_header == 13);
}

TEST_CASE("AOS headers are corrected by their error control, counted, and no channel is made of a damaged one",
          "[telemetry][frames][R55]") {
    std::mt19937 random{22};
    for (const bool crc : {true, false}) {
        CAPTURE(crc);
        Octets stream;
        for (unsigned i = 0; i < 60; ++i) {
            Octets octets = test::hex("5345000000 40ba72 07ff");  // spacecraft 77, virtual channel 5
            octets[4] = static_cast<std::uint8_t>(i);
            append(octets, test::random_octets(random, length - octets.size() - 2));
            const auto word = crc16(octets);
            append(octets, Octets{static_cast<std::uint8_t>(word >> 8), static_cast<std::uint8_t>(word & 0xFF)});
            if (i % 10 == 3) octets[1] ^= 0x02U;  // virtual channel
            if (i % 10 == 5) octets[0] ^= 0x11U;  // spacecraft: two symbols
            if (i % 10 == 7) octets[0] ^= 0x11U, octets[1] ^= 0x11U;
            append(stream, octets);
        }
        FrameReceiver receiver{{.kind = FrameStream::Kind::aos,
                                .frame_octets = length,
                                .marker = false,
                                .agreed = {.crc = crc, .header_error_control = true}}};
        CHECK(frames_in(receiver, stream, random) == 54);
        CHECK(receiver.counters().corrected_headers == 12);
        CHECK(receiver.counters().bad_header == 6);
        REQUIRE(receiver.sequences().size() == 1);
        CHECK(receiver.sequences()[0].name == "spacecraft 77, virtual channel 5");
    }
}

TEST_CASE("repeated frames are counted and not given out, and frames of another virtual channel when one is asked for",
          "[telemetry][R55]") {
    std::mt19937 random{6};
    Octets stream;
    for (unsigned i = 0; i < 40; ++i) {
        const Octets frame = frame_octets(FrameStream::Kind::aos, i, random);
        for (unsigned copy = 0; copy < 1 + i % 3; ++copy) {
            append(stream, attached_sync_marker);
            append(stream, frame);
        }
    }
    FrameReceiver receiver{{.kind = FrameStream::Kind::aos, .frame_octets = length}};
    CHECK(frames_in(receiver, stream, random) == 40);
    CHECK(receiver.counters().repeated_frames == 39);
    FrameReceiver one{{.kind = FrameStream::Kind::aos, .frame_octets = length, .virtual_channel = 1}};
    CHECK(frames_in(one, stream, random) == 20);
}

namespace {

/// CADUs of Reed–Solomon codeblocks of one virtual channel.
std::vector<Octets> coded_cadus(const FrameStream& stream, unsigned frames, std::mt19937& random) {
    std::vector<Octets> cadus;
    for (unsigned i = 0; i < frames; ++i) {
        const Octets frame = frame_octets(stream.kind, 2 * i, random, stream.frame_octets, stream.agreed.crc);
        Octets block = test::codeblock_of(frame, *stream.code);
        if (stream.randomised) randomise_tm(block);
        cadus.push_back(test::copy_of(attached_sync_marker));
        append(cadus.back(), block);
    }
    return cadus;
}

Octets joined(const std::vector<Octets>& pieces) {
    Octets stream;
    for (const Octets& piece : pieces) append(stream, piece);
    return stream;
}

std::vector<Octets> data_of(const FrameStream& stream, std::span<const std::uint8_t> octets, LinkCounters& counters) {
    FrameReceiver receiver{stream};
    receiver.receive(octets);
    std::vector<Octets> data;
    while (const auto received = receiver.next()) data.push_back(test::copy_of(received->frame.data));
    receiver.end();
    counters = receiver.counters();
    return data;
}

FrameStream coded(const ReedSolomonCode& code, std::size_t frame_octets, bool randomised, bool crc) {
    FrameStream stream;
    stream.frame_octets = frame_octets;
    stream.code = code;
    stream.suffix_octets = code.check_octets();
    stream.randomised = randomised;
    stream.agreed.crc = crc;
    return stream;
}

}  // namespace

TEST_CASE("CADUs of 65 frames with one wrong bit in 16 of them come out as the clean ones, and what code they have is "
          "found by trying",
          "[telemetry][R54]") {
    std::mt19937 random{7};
    for (const std::size_t symbols : {32U, 16U})
        for (const std::size_t interleave : {1U, 2U, 3U, 4U, 5U, 8U})
            for (const auto basis : {ReedSolomonCode::Basis::dual, ReedSolomonCode::Basis::conventional}) {
                const std::size_t shorter = random() % 2 * 37;
                const bool randomised = random() % 2 == 0, crc = random() % 2 == 0;
                const ReedSolomonCode code{symbols, interleave, basis};
                const auto sent = coded(code, code.data_octets_max() - shorter * interleave, randomised, crc);
                auto cadus = coded_cadus(sent, 65, random);
                const auto clean = joined(cadus);
                std::vector<std::size_t> places(65);
                for (std::size_t i = 0; i < places.size(); ++i) places[i] = i;
                std::ranges::shuffle(places, random);
                for (std::size_t i = 0; i < 16; ++i) {
                    Octets& cadu = cadus[places[i]];
                    cadu[4 + random() % (cadu.size() - 4)] ^= static_cast<std::uint8_t>(1U << random() % 8);
                }
                const auto damaged = joined(cadus);
                INFO(symbols << " check symbols, interleaved " << interleave << ", dual "
                             << (basis == ReedSolomonCode::Basis::dual) << ", randomised " << randomised << ", CRC "
                             << crc);
                const auto found = recognise_cadus(damaged, {}, true);
                REQUIRE(found);
                CHECK(found->code == code);
                CHECK(found->randomised == randomised);
                CHECK(found->agreed.crc == crc);
                CHECK(found->frame_octets == sent.frame_octets);
                LinkCounters counted, none;
                const auto frames = data_of(*found, damaged, counted);
                REQUIRE(frames.size() == 65);
                CHECK(frames == data_of(sent, clean, none));
                CHECK(counted.corrected_frames == 16);
                CHECK(counted.corrected_symbols == 16);
                CHECK(none.corrected_frames == 0);
            }
}

TEST_CASE("a frame that its code cannot correct is counted and not read, unless its own CRC is right",
          "[telemetry][R54]") {
    std::mt19937 random{8};
    for (const bool crc : {true, false}) {
        const ReedSolomonCode code{.check_symbols = 32, .interleave = 2};
        const auto sent = coded(code, 300, true, crc);
        auto cadus = coded_cadus(sent, 20, random);
        LinkCounters counted;
        const auto clean = data_of(sent, joined(cadus), counted);
        for (std::size_t i = 0; i < 20; ++i) {
            cadus[7][4 + 2 * i] ^= 0x21;         // in the frame
            cadus[12][4 + 300 + 2 * i] ^= 0x21;  // in the check symbols alone
        }
        auto left = clean;
        if (!crc) left.erase(left.begin() + 12);
        left.erase(left.begin() + 7);
        CHECK(data_of(sent, joined(cadus), counted) == left);
        CHECK(counted.uncorrectable_frames == (crc ? 1 : 2));
        CHECK(counted.bad_crc == 0);
        CHECK(counted.missing_frames == (crc ? 1 : 2));
    }
}

TEST_CASE("frames of nothing but fill are taken for no code that they are not of", "[telemetry][R54]") {
    // Not coded at all: a few symbols of a header before zeros are within the reach of the code word of zeros.
    Octets stream;
    for (unsigned i = 0; i < 20; ++i) {
        const Octets zeros(1275 - 8);
        TransferFrame frame;
        frame.spacecraft = 76;
        frame.count = i;
        frame.first_header_pointer = only_idle_data;
        frame.data = zeros;
        Octets octets(1275);
        write_tm_frame(frame, static_cast<std::uint8_t>(i), true, octets);
        append(stream, attached_sync_marker);
        append(stream, octets);
    }
    const auto found = recognise_cadus(stream, {}, true);
    REQUIRE(found);
    CHECK_FALSE(found->code);
    CHECK(found->frame_octets == 1275);
}

namespace {

using Bits = std::vector<bool>;

void append_bits(Bits& to, std::span<const std::uint8_t> octets) {
    for (const std::uint8_t octet : octets)
        for (int bit = 7; bit >= 0; --bit) to.push_back((octet >> bit & 1) != 0);
}

Octets octets_of(const Bits& bits) {
    Octets octets((bits.size() + 7) / 8);
    for (std::size_t i = 0; i < bits.size(); ++i)
        octets[i / 8] |= static_cast<std::uint8_t>((bits[i] ? 0x80U : 0U) >> i % 8);
    return octets;
}

/// CADUs of plain frames of two virtual channels.
std::vector<Octets> plain_cadus(unsigned frames, bool crc, std::mt19937& random) {
    std::vector<Octets> cadus;
    for (unsigned i = 0; i < frames; ++i) {
        cadus.push_back(test::copy_of(attached_sync_marker));
        append(cadus.back(), frame_octets(FrameStream::Kind::tm, i, random, length, crc));
    }
    return cadus;
}

}  // namespace

TEST_CASE("CADUs that begin at any bit, inverted or not, are found, recognised and read as those that do not",
          "[telemetry][R54]") {
    std::mt19937 random{10};
    for (const bool crc : {true, false})
        for (unsigned shift = 0; shift < 8; ++shift)
            for (const bool inverted : {false, true}) {
                const auto cadus = plain_cadus(20, crc, random);
                Bits bits(shift);
                for (const Octets& cadu : cadus) append_bits(bits, cadu);
                if (inverted) bits.flip();
                const Octets stream = octets_of(bits);
                INFO("shifted by " << shift << ", inverted " << inverted << ", CRC " << crc);
                const auto found = recognise_cadus(stream, {.crc = crc}, true);
                REQUIRE(found);
                CHECK(found->alignment == BitAlignment{shift, inverted});
                FrameStream plain = *found;
                plain.alignment = {};
                LinkCounters counted, none;
                const auto frames = data_of(*found, stream, counted);
                CHECK(frames == data_of(plain, joined(cadus), none));
                CHECK(frames.size() == 20);
                CHECK(counted.slips == 0);
                FrameReceiver receiver{*found};
                std::size_t single = 0;
                for (const std::uint8_t octet : stream) {
                    receiver.receive({&octet, 1});
                    while (receiver.next()) ++single;
                }
                CHECK(single == 20);
            }
}

TEST_CASE("where bits are lost or added, or all are inverted from there on, the frames behind are found again",
          "[telemetry][R54]") {
    std::mt19937 random{11};
    for (int round = 0; round < 60; ++round) {
        const bool coded_frames = round % 3 == 0, crc = round % 3 != 1;
        const FrameStream sent = coded_frames
                                     ? coded({.check_symbols = 32, .interleave = 1}, length, round % 2 == 0, crc)
                                     : FrameStream{.frame_octets = length, .agreed = {.crc = crc}};
        const auto cadus = coded_frames ? coded_cadus(sent, 30, random) : plain_cadus(30, crc, random);
        Bits bits;
        for (const Octets& cadu : cadus) append_bits(bits, cadu);
        const std::size_t cadu_bits = cadus[0].size() * 8;
        const std::size_t at = 15 * cadu_bits + 40 + random() % (cadu_bits - 80);  // within a frame
        const int slip = static_cast<int>(random() % 15) - 7;
        if (slip < 0)
            bits.erase(bits.begin() + static_cast<std::ptrdiff_t>(at),
                       bits.begin() + static_cast<std::ptrdiff_t>(at) - slip);
        for (int i = 0; i < slip; ++i) bits.insert(bits.begin() + static_cast<std::ptrdiff_t>(at), random() % 2 != 0);
        const bool inverts = random() % 2 == 0;
        if (inverts)
            for (std::size_t i = at; i < bits.size(); ++i) bits[i] = !bits[i];
        FrameReceiver receiver{sent};
        const Octets stream = octets_of(bits);
        INFO("round " << round << ": slip of " << slip << " bits, inverts " << inverts << ", CRC " << crc << ", coded "
                      << coded_frames);
        const std::size_t frames = frames_in(receiver, stream, random);
        CHECK(frames >= 28);  // without a check the damaged frame counts, and a marker before its time is missed
        if (crc || coded_frames) CHECK(receiver.counters().missing_frames <= 2);
        CHECK(receiver.counters().slips == (slip != 0 || inverts ? 1 : 0));
    }
}

TEST_CASE("a marker at another bit is not believed for itself, and one with wrong bits only before a good frame",
          "[telemetry][R54]") {
    std::mt19937 random{12};
    for (const bool crc : {true, false}) {
        auto cadus = plain_cadus(20, crc, random);
        // In the data of a frame whose own marker is lost: markers of another alignment, of which none follows.
        Bits other(3);
        append_bits(other, attached_sync_marker);
        other.flip();
        const Octets false_marker = octets_of(other);
        std::ranges::copy(false_marker, cadus[9].begin() + 40);
        cadus[9][0] ^= 0xFF;
        cadus[9][1] ^= 0xFF;
        FrameReceiver receiver{{.frame_octets = length, .agreed = {.crc = crc}}};
        CHECK(frames_in(receiver, joined(cadus), random) == 19);
        CHECK(receiver.counters().slips == 0);
        CHECK(receiver.counters().missing_frames == 1);
        auto wrong = plain_cadus(20, crc, random);
        wrong[5][1] ^= 0x11;
        wrong[6][3] ^= 0x80;
        FrameReceiver tolerant{{.frame_octets = length, .agreed = {.crc = crc}}};
        CHECK(frames_in(tolerant, joined(wrong), random) == (crc ? 20 : 18));
    }
}

TEST_CASE("a datagram ends the frame where there is no marker, and a short one is cut and loses no other",
          "[telemetry]") {
    std::mt19937 random{11};
    for (const bool marker : {false, true}) {
        FrameReceiver receiver{{.frame_octets = length, .marker = marker}};
        std::size_t frames = 0, bad = 0;
        for (unsigned i = 0; i < 20; ++i) {
            Octets datagram;
            if (marker) append(datagram, attached_sync_marker);
            append(datagram, frame_octets(FrameStream::Kind::tm, i, random));
            if (i == 3) datagram.resize(50);
            receiver.receive(datagram);
            while (receiver.next()) ++frames;
            bad += receiver.end_datagram() ? 0 : 1;
        }
        CHECK(frames == 19);
        CHECK(bad == (marker ? 0 : 1));
        CHECK(receiver.counters().cut_frames == bad);
    }
}

TEST_CASE(
    "no layout is told of sync markers with anything but frames between, and a single frame is read as it is told",
    "[telemetry][R55]") {
    std::mt19937 random{12};
    for (int round = 0; round < 20; ++round) {
        Octets noise;
        for (int i = 0; i < 20; ++i) {
            append(noise, attached_sync_marker);
            append(noise, test::random_octets(random, 200));
        }
        CHECK_FALSE(recognise_cadus(noise, {}, true));
    }
    Octets one = test::random_octets(random, 30);
    append(one, attached_sync_marker);
    append(one, frame_octets(FrameStream::Kind::aos, 1, random));
    CHECK_FALSE(recognise_cadus(one, {}, true));
    CHECK_FALSE(recognise_cadus(one, {.frame_octets = length}, false));
    const auto found = recognise_cadus(one, {.frame_octets = length}, true);
    REQUIRE(found);
    CHECK(found->kind == FrameStream::Kind::aos);
    CHECK(found->agreed.crc);
    CHECK_FALSE(recognise_cadus(test::random_octets(random, 500), {.frame_octets = length}, true));
}

TEST_CASE("octets between and behind frames are stray, but for the bits that fill the last octet", "[telemetry][R55]") {
    std::mt19937 random{13};
    Octets stream;
    for (unsigned i = 0; i < 5; ++i) {
        append(stream, attached_sync_marker);
        append(stream, frame_octets(FrameStream::Kind::tm, i, random));
    }
    Octets shifted(stream.size() + 1);
    for (std::size_t i = 0; i < shifted.size(); ++i) {
        const unsigned before = i > 0 ? stream[i - 1] : 0U, here = i < stream.size() ? stream[i] : 0U;
        shifted[i] = static_cast<std::uint8_t>(before << 5U | here >> 3U);
    }
    const auto stray = [&](const Octets& octets, const BitAlignment& alignment) {
        FrameReceiver receiver{{.frame_octets = length, .alignment = alignment}};
        CHECK(frames_in(receiver, octets, random) == 5);
        CHECK(receiver.counters().octets == receiver.counters().skipped_octets + 5 * (length + 4));
        return receiver.stray_octets();
    };
    CHECK(stray(stream, {}) == 0);
    CHECK(stray(shifted, {.shift = 3}) == 0);
    append(stream, Octets(40, 0));
    CHECK(stray(stream, {}) == 40);
}

}  // namespace telemetry_frame_receiver_test
