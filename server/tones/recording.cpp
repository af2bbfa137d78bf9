// SPDX-License-Identifier: Apache-2.0
#include "server/tones/recording.hpp"

#include "server/base/json.hpp"
#include "server/base/json_object.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <google/protobuf/struct.pb.h>

namespace aeolis::server {
namespace {

using google::protobuf::Struct;
using google::protobuf::Value;

constexpr std::uint64_t meta_octets_max = 16'000'000;  // chosen
constexpr std::size_t chunks_max = 1000;               // of a WAV file before its samples; chosen
constexpr double clock_error_most = 600e-6;            // that the receiver corrects
constexpr double clock_unsure_s = 0.01;                // of a stated time; chosen
constexpr double missing_s_max = 86'400.0;             // chosen

Error error_of(const std::filesystem::path& file, const std::string& what) {
    return Error{fmt::format("{}: {}", file.string(), what)};
}

const Value* field(const Struct& object, const std::string& name) {
    const auto found = object.fields().find(name);
    return found == object.fields().end() ? nullptr : &found->second;
}

std::optional<double> number(const Struct& object, const std::string& name) {
    const Value* value = field(object, name);
    if (value == nullptr || !value->has_number_value() || !std::isfinite(value->number_value())) return std::nullopt;
    return value->number_value();
}

std::string text(const Struct& object, const std::string& name) {
    const Value* value = field(object, name);
    return value != nullptr && value->has_string_value() ? value->string_value() : std::string{};
}

/// A count of octets or samples; none when absent, an error when it is none.
Result<std::uint64_t> count_in(const std::filesystem::path& file, const Struct& object, const std::string& name) {
    const Value* value = field(object, name);
    if (value == nullptr) return std::uint64_t{0};
    const double told = value->has_number_value() ? value->number_value() : -1.0;
    if (!(told >= 0.0 && told < 9e15 && told == std::floor(told)))
        return error_of(file, fmt::format("{} is no count", name));
    return static_cast<std::uint64_t>(told);
}

/// A UTC time; digits beyond a microsecond are dropped.
std::optional<Ert> time_in(std::string text) {
    const std::size_t point = text.find('.');
    if (point == std::string::npos) return ert_from_text(text);
    const std::size_t end = std::min(text.find_first_not_of("0123456789", point + 1), text.size());
    if (end > point + 7) text.erase(point + 7, end - point - 7);
    return ert_from_text(text);
}

/// What `captures` say: where the first begins, when and at what frequency each was received.
///
/// @param offset  core:offset, from which samples are counted
/// @param end     octets of the file of samples, without trailing ones
Result<void> read_captures(const std::filesystem::path& meta, const Value& captures, std::uint64_t offset,
                           std::uint64_t end, SampleRecording& recording) {
    int number_of = 0;
    std::uint64_t first = 0, before = 0;
    const std::size_t octets_a_sample = recording.format->octets_a_sample();
    for (const Value& each : captures.list_value().values()) {
        ++number_of;
        const auto refused = [&](const std::string& what) {
            return error_of(meta, fmt::format("capture {} {}", number_of, what));
        };
        if (!each.has_struct_value()) return refused("is no object");
        const Struct& capture = each.struct_value();
        const auto header = count_in(meta, capture, "core:header_bytes");
        if (!header) return header.error();
        const auto counted = count_in(meta, capture, "core:sample_start");
        if (!counted) return counted.error();
        if (*counted < offset)
            return refused(fmt::format("begins at sample {}, before core:offset, {}", *counted, offset));
        const std::uint64_t start = *counted - offset;
        const auto frequency = number(capture, "core:frequency");
        if (!frequency && field(capture, "core:frequency") != nullptr)
            return refused("has a core:frequency that is no number");
        const std::string datetime = text(capture, "core:datetime");
        const auto time = time_in(datetime);
        if (!time && field(capture, "core:datetime") != nullptr)
            return refused(fmt::format("has a core:datetime that is no UTC time: '{}'", datetime));
        if (number_of == 1) {
            recording.first_octet = *header + start * octets_a_sample;
            recording.frequency_hz = frequency;
            recording.datetime = datetime;
            first = before = start;
            if (time) recording.captures.push_back({0, *time, number_of});
            continue;
        }
        if (*header > 0) return refused("has a header amid the samples; split the recording");
        if (start < before) return refused("begins before the one before it");
        if (start > 0 && recording.first_octet + (start - first) * octets_a_sample > end)
            return refused(fmt::format("begins at sample {}, behind the end of {}", *counted,
                                       recording.samples.filename().string()));
        before = start;
        if (time) recording.captures.push_back({start - first, *time, number_of});
        if (frequency && recording.frequency_hz && *frequency != *recording.frequency_hz)
            recording.told.push_back(fmt::format("{}: capture {} is at {} Hz, not at {} Hz; it is read as if it were",
                                                 meta.string(), number_of, *frequency, *recording.frequency_hz));
        if (!recording.frequency_hz) recording.frequency_hz = frequency;
    }
    return {};
}

Result<SampleRecording> look_at_sigmf(const std::filesystem::path& meta, std::filesystem::path data) {
    std::error_code ignored;
    const std::uint64_t size = std::filesystem::file_size(meta, ignored);
    std::ifstream stream{meta, std::ios::binary};
    if (ignored || !stream) return error_of(meta, "cannot be read");
    if (size > meta_octets_max) return error_of(meta, "is too long for SigMF metadata");
    const std::string json{std::istreambuf_iterator<char>{stream}, {}};
    Struct document;
    if (!from_json(json, document)) return error_of(meta, "is not SigMF metadata: no JSON object");
    const Value* global_value = field(document, "global");
    if (global_value == nullptr || !global_value->has_struct_value())
        return error_of(meta, "is not SigMF metadata: there is no 'global'");
    const Struct& global = global_value->struct_value();

    SampleRecording recording;
    recording.kind = "SigMF";
    if (const std::string dataset = text(global, "core:dataset"); !dataset.empty()) {
        if (std::filesystem::path{dataset}.filename() != std::filesystem::path{dataset})
            return error_of(meta, "core:dataset is not the name of a file beside it");
        data = meta.parent_path() / dataset;
    }
    recording.samples = data;
    const std::string datatype = text(global, "core:datatype");
    if (datatype.empty()) return error_of(meta, "core:datatype is missing");
    const auto format = sample_format(datatype);
    if (!format) return error_of(meta, "core:datatype: " + format.error().message);
    recording.format = *format;
    recording.rate_hz = number(global, "core:sample_rate");
    if (!recording.rate_hz && field(global, "core:sample_rate") != nullptr)
        return error_of(meta, "core:sample_rate is no number");
    if (const auto channels = number(global, "core:num_channels"); channels && *channels != 1.0)
        return error_of(meta, fmt::format("has {} channels; one is needed", *channels));

    std::uint64_t trailing = 0;
    if (const auto counted = count_in(meta, global, "core:trailing_bytes"); !counted)
        return counted.error();
    else
        trailing = *counted;
    const std::uint64_t octets = std::filesystem::file_size(data, ignored);
    if (ignored) return error_of(data, ignored.message());
    const auto offset = count_in(meta, global, "core:offset");
    if (!offset) return offset.error();
    recording.said_by = meta;
    if (const Value* captures = field(document, "captures"); captures != nullptr && captures->has_list_value())
        if (const auto read = read_captures(meta, *captures, *offset, octets - std::min(octets, trailing), recording);
            !read)
            return read.error();
    if (octets < recording.first_octet + trailing)
        return error_of(data, fmt::format("has {} octets, fewer than its headers", octets));
    recording.octets = octets - recording.first_octet - trailing;
    return recording;
}

std::uint32_t little(const char* octets, int count) {
    std::uint32_t value = 0;
    for (int i = count - 1; i >= 0; --i) value = value << 8U | static_cast<unsigned char>(octets[i]);
    return value;
}

/// @param stream  behind the RIFF header
Result<SampleRecording> look_at_wav(const std::filesystem::path& file, std::ifstream& stream, bool is_rf64) {
    std::error_code ignored;
    const std::uint64_t size = std::filesystem::file_size(file, ignored);
    SampleRecording recording;
    recording.samples = file;
    recording.kind = is_rf64 ? "WAV (RF64)" : "WAV";
    std::optional<std::uint64_t> long_octets;
    std::uint64_t at = 12;
    for (std::size_t chunk = 0; chunk < chunks_max; ++chunk) {
        std::array<char, 8> head{};
        stream.clear();
        stream.seekg(static_cast<std::streamoff>(at));
        if (!stream.read(head.data(), head.size()))
            return error_of(file, "is WAV without samples: it has no data chunk");
        const std::string name{head.data(), 4};
        const std::uint32_t octets = little(head.data() + 4, 4);
        at += head.size();
        if (name == "ds64") {
            std::array<char, 16> sizes{};
            if (octets < sizes.size() || !stream.read(sizes.data(), sizes.size()))
                return error_of(file, "is WAV whose ds64 chunk is cut off");
            long_octets = little(sizes.data() + 8, 4) | std::uint64_t{little(sizes.data() + 12, 4)} << 32U;
        } else if (name == "fmt ") {
            std::array<char, 40> fields{};
            if (octets < 16 || !stream.read(fields.data(), std::min<std::streamsize>(octets, 40)))
                return error_of(file, "is WAV whose fmt chunk is cut off");
            std::uint32_t code = little(fields.data(), 2);
            const std::uint32_t channels = little(fields.data() + 2, 2), bits = little(fields.data() + 14, 2);
            if (code == 0xfffe && octets >= 26) code = little(fields.data() + 24, 2);
            recording.rate_hz = little(fields.data() + 4, 4);
            if (channels == 1) return error_of(file, "is WAV of one channel, audio; in-phase and quadrature need two");
            if (channels != 2) return error_of(file, fmt::format("is WAV of {} channels; two are needed", channels));
            const bool integer = code == 1 && (bits == 8 || bits == 16 || bits == 24 || bits == 32);
            const bool floating = code == 3 && (bits == 32 || bits == 64);
            if (!integer && !floating)
                return error_of(
                    file, fmt::format("is WAV of encoding {} with {} bits; PCM or floats are needed", code, bits));
            recording.format = SampleFormat{floating    ? SampleFormat::Kind::floating
                                            : bits == 8 ? SampleFormat::Kind::offset
                                                        : SampleFormat::Kind::integer,
                                            static_cast<int>(bits / 8), false};
            if (little(fields.data() + 12, 2) != recording.format->octets_a_sample())
                return error_of(file, "is WAV whose samples have gaps between them");
        } else if (name == "data") {
            if (!recording.format) return error_of(file, "is WAV whose data come before their format");
            recording.first_octet = at;
            const std::uint64_t present = size - at;
            std::uint64_t told = octets == 0xffffffffU && long_octets ? *long_octets : octets;
            // A recorder that was stopped leaves 0 or the greatest number there.
            if (told == 0 || told == 0xffffffffU) told = present;
            if (told > present)
                recording.told.push_back(
                    fmt::format("{}: is truncated: {} of {} octets", file.string(), present, told));
            recording.octets = std::min(told, present);
            return recording;
        }
        at += octets + (octets & 1U);
    }
    return error_of(file, "is WAV without samples: it has no data chunk");
}

/// A kind of file that is known by its first octets, and holds no samples that are read here.
struct Known {
    std::string_view magic, kind;
};
constexpr std::array known_files{Known{"fLaC", "FLAC audio"},
                                 Known{"OggS", "Ogg audio"},
                                 Known{"ID3\x03", "MP3 audio"},
                                 Known{"ID3\x04", "MP3 audio"},
                                 Known{"FORM", "AIFF audio"},
                                 Known{"RIFX", "WAV of big-endian octets"},
                                 Known{"caff", "CAF audio"},
                                 Known{".snd", "Sun audio"},
                                 Known{"\x1f\x8b\x08", "a gzip archive"},
                                 Known{"\x28\xb5\x2f\xfd", "a Zstandard archive"},
                                 Known{"\xfd"
                                       "7zXZ",
                                       "an xz archive"},
                                 Known{"BZh9", "a bzip2 archive"},
                                 Known{"PK\x03\x04", "a zip archive"},
                                 Known{"\x89HDF", "HDF5"},
                                 Known{"SIMPLE  =", "FITS"},
                                 Known{"SQLite format 3", "an SQLite database"},
                                 Known{"\xd4\xc3\xb2\xa1", "a pcap capture"},
                                 Known{"\x0a\x0d\x0d\x0a", "a pcapng capture"},
                                 Known{"\x89PNG", "a PNG picture"},
                                 Known{"%PDF", "a PDF document"},
                                 Known{"\x7f"
                                       "ELF",
                                       "a program"},
                                 Known{"<?xml", "XML"}};

}  // namespace

Result<SampleRecording> look_at_recording(const std::filesystem::path& file) {
    std::error_code ignored;
    if (std::filesystem::is_directory(file, ignored)) return error_of(file, "is a folder");
    std::filesystem::path meta = file, data = file;
    if (file.extension() == ".sigmf-meta") return look_at_sigmf(file, data.replace_extension(".sigmf-data"));
    if (file.extension() == ".sigmf-data") {
        meta.replace_extension(".sigmf-meta");
        if (std::filesystem::exists(meta, ignored)) return look_at_sigmf(meta, file);
        return error_of(file, fmt::format("{} is missing beside it", meta.filename().string()));
    }
    if (file.extension() == ".sigmf") return error_of(file, "is a SigMF archive; unpack it with tar");
    std::ifstream stream{file, std::ios::binary};
    if (!stream)
        return error_of(file, std::filesystem::exists(file, ignored) ? "cannot be read" : "there is no such file");
    std::string head(512, '\0');
    stream.read(head.data(), static_cast<std::streamsize>(head.size()));
    head.resize(static_cast<std::size_t>(stream.gcount()));
    if (head.size() >= 12 && head.substr(8, 4) == "WAVE" && (head.starts_with("RIFF") || head.starts_with("RF64")))
        return look_at_wav(file, stream, head.starts_with("RF64"));
    for (const Known& known : known_files)
        if (head.starts_with(known.magic)) return error_of(file, fmt::format("is {}, not complex samples", known.kind));
    if (head.size() >= 262 && head.substr(257, 5) == "ustar") return error_of(file, "is a tar archive; unpack it");
    if (head.find("core:datatype") != std::string::npos)
        return error_of(file, "is SigMF metadata; name it .sigmf-meta");
    SampleRecording recording;
    recording.samples = file;
    return recording;
}

Result<std::vector<MissingSamples>> missing_samples(const SampleRecording& recording) {
    std::vector<MissingSamples> missing;
    if (!recording.rate_hz) return missing;
    const double rate_hz = *recording.rate_hz;
    const auto whole = [](Ert time) { return time.microseconds % 1'000'000 == 0; };
    for (std::size_t i = 1; i < recording.captures.size(); ++i) {
        const CaptureTime &capture = recording.captures[i], &before = recording.captures[i - 1];
        const auto refused = [&](const std::string& what) {
            return error_of(recording.said_by, fmt::format("capture {} {}", capture.number, what));
        };
        const double apart_s = static_cast<double>(capture.time.microseconds - before.time.microseconds) * 1e-6;
        const double received_s = static_cast<double>(capture.first_sample - before.first_sample) / rate_hz;
        const double unsure_s =
            clock_error_most * received_s + (whole(capture.time) || whole(before.time) ? 1.0 : clock_unsure_s);
        const double gap_s = apart_s - received_s;
        if (gap_s < -unsure_s)
            return refused(
                fmt::format("is {:.3f} s earlier than the samples before it end; split the recording", -gap_s));
        if (gap_s > missing_s_max)
            return refused(fmt::format("is {:.0f} s after the samples before it; split the recording", gap_s));
        if (gap_s > unsure_s)
            missing.push_back({capture.first_sample, static_cast<std::uint64_t>(std::llround(gap_s * rate_hz))});
    }
    return missing;
}

std::string sigmf_meta(const SampleFormat& format, double rate_hz, double frequency_hz,
                       const std::string& description) {
    return fmt::format("{{\n  \"global\": {{\n    \"core:datatype\": \"{}\",\n    \"core:sample_rate\": {},\n"
                       "    \"core:version\": \"1.0.0\",\n    \"core:description\": {},\n"
                       "    \"core:recorder\": \"aeolis tones simulate\"\n  }},\n"
                       "  \"captures\": [{{\"core:sample_start\": 0, \"core:frequency\": {}}}],\n"
                       "  \"annotations\": []\n}}\n",
                       format.name(), rate_hz, json_text(description), frequency_hz);
}

}  // namespace aeolis::server
