// SPDX-License-Identifier: Apache-2.0
#include "server/tones/sample_file.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <numbers>

namespace aeolis::server {
namespace {

static_assert(std::endian::native == std::endian::little, "sample files are little-endian");

constexpr double noise_in_ci16 = 2000.0 * std::numbers::sqrt2;  // chosen: clips at 16 deviations

}  // namespace

Result<SampleFormat> sample_format(std::string_view name) {
    if (name == "cf32") return SampleFormat::cf32;
    if (name == "ci16") return SampleFormat::ci16;
    return Error{fmt::format("there is no sample format '{}': cf32 or ci16", name)};
}

std::size_t octets_a_sample(SampleFormat format) {
    return format == SampleFormat::cf32 ? 2 * sizeof(float) : 2 * sizeof(std::int16_t);
}

Result<SampleReader> SampleReader::open(const std::filesystem::path& file, SampleFormat format) {
    SampleReader reader{file, format};
    std::error_code error;
    const std::uint64_t octets = std::filesystem::file_size(file, error);
    if (error) return Error{fmt::format("{}: {}", file.string(), error.message())};
    reader.stream_.open(file, std::ios::binary);
    if (!reader.stream_) return Error{fmt::format("{} cannot be read", file.string())};
    if (octets == 0) return Error{fmt::format("{} is empty", file.string())};
    reader.left_over_octets_ = octets % octets_a_sample(format);
    reader.samples_ = octets / octets_a_sample(format);
    return reader;
}

Result<std::span<const std::complex<float>>> SampleReader::next(std::span<std::complex<float>> room) {
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(room.size(), samples_ - read_));
    octets_.resize(count * octets_a_sample(format_));
    if (!stream_.read(octets_.data(), static_cast<std::streamsize>(octets_.size())))
        return Error{fmt::format("{} ended after {} of {} samples", file_.string(), read_, samples_)};
    for (std::size_t i = 0; i < count; ++i) {
        if (format_ == SampleFormat::cf32) {
            float parts[2];
            std::memcpy(parts, octets_.data() + i * sizeof parts, sizeof parts);
            room[i] = {parts[0], parts[1]};
        } else {
            std::int16_t parts[2];
            std::memcpy(parts, octets_.data() + i * sizeof parts, sizeof parts);
            room[i] = {static_cast<float>(parts[0]), static_cast<float>(parts[1])};
        }
    }
    read_ += count;
    return std::span<const std::complex<float>>{room.first(count)};
}

Result<SampleWriter> SampleWriter::open(const std::filesystem::path& file, SampleFormat format) {
    SampleWriter writer{file, format};
    writer.stream_.open(file, std::ios::binary);
    if (auto opened = writer.state(); !opened) return opened.error();
    return writer;
}

Result<void> SampleWriter::state() const {
    if (!stream_) return Error{fmt::format("{} cannot be written", file_.string())};
    return {};
}

Result<void> SampleWriter::add(std::span<const std::complex<float>> samples) {
    octets_.resize(samples.size() * octets_a_sample(format_));
    for (std::size_t i = 0; i < samples.size(); ++i) {
        if (format_ == SampleFormat::cf32) {
            const float parts[2]{samples[i].real(), samples[i].imag()};
            std::memcpy(octets_.data() + i * sizeof parts, parts, sizeof parts);
        } else {
            const auto to_integer = [](float part) {
                return static_cast<std::int16_t>(
                    std::lround(std::clamp(static_cast<double>(part) * noise_in_ci16, -32768.0, 32767.0)));
            };
            const std::int16_t parts[2]{to_integer(samples[i].real()), to_integer(samples[i].imag())};
            std::memcpy(octets_.data() + i * sizeof parts, parts, sizeof parts);
        }
    }
    stream_.write(octets_.data(), static_cast<std::streamsize>(octets_.size()));
    return state();
}

Result<void> SampleWriter::close() {
    stream_.close();
    return state();
}

}  // namespace aeolis::server
