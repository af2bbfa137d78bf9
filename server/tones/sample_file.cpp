// SPDX-License-Identifier: Apache-2.0
#include "server/tones/sample_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <fcntl.h>
#include <fmt/format.h>
#include <numbers>
#include <unistd.h>

namespace aeolis::server {
namespace {

constexpr double noise_of_range = 1.0 / 16.0;  // chosen: integers clip at 16 deviations

}  // namespace

Result<SampleReader> SampleReader::open(const std::filesystem::path& file, SampleFormat format) {
    SampleRecording recording;
    recording.samples = file;
    recording.format = format;
    return open(recording);
}

Result<SampleReader> SampleReader::open(const SampleRecording& recording) {
    const std::filesystem::path& file = recording.samples;
    SampleReader reader{file, recording.format.value()};
    std::error_code error;
    const std::uint64_t all = std::filesystem::file_size(file, error);
    if (error) return Error{fmt::format("{}: {}", file.string(), error.message())};
    const std::uint64_t behind = all - std::min(all, recording.first_octet);
    const std::uint64_t octets = std::min(recording.octets.value_or(behind), behind);
    reader.stream_.open(file, std::ios::binary);
    if (!reader.stream_) return Error{fmt::format("{} cannot be read", file.string())};
    if (octets == 0) return Error{fmt::format("{} is empty", file.string())};
    reader.stream_.seekg(static_cast<std::streamoff>(recording.first_octet));
    reader.first_octet_ = recording.first_octet;
    reader.left_over_octets_ = octets % recording.format->octets_a_sample();
    reader.samples_ = octets / recording.format->octets_a_sample();
    auto missing = missing_samples(recording);
    if (!missing) return missing.error();
    reader.missing_ = std::move(*missing);
    for (const MissingSamples& each : reader.missing_) reader.missing_all_ += each.count;
    return reader;
}

Result<std::span<const std::complex<float>>> SampleReader::next(std::span<std::complex<float>> room) {
    if (!missing_.empty() && missing_.front().before_sample <= read_) {
        MissingSamples& gap = missing_.front();
        const auto zeros = room.first(static_cast<std::size_t>(std::min<std::uint64_t>(room.size(), gap.count)));
        std::ranges::fill(zeros, std::complex<float>{});
        gap.count -= zeros.size();
        if (gap.count == 0) missing_.erase(missing_.begin());
        return std::span<const std::complex<float>>{zeros};
    }
    const std::uint64_t end = missing_.empty() ? samples_ : std::min(samples_, missing_.front().before_sample);
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(room.size(), end - read_));
    octets_.resize(count * format_.octets_a_sample());
    if (!stream_.read(octets_.data(), static_cast<std::streamsize>(octets_.size())))
        return Error{fmt::format("{} ended after {} of {} samples", file_.string(), read_, samples_)};
    format_.decode(octets_, room.first(count));
    read_ += count;
    return std::span<const std::complex<float>>{room.first(count)};
}

std::uint64_t SampleReader::skip_hole() {
    if (!missing_.empty() && missing_.front().before_sample <= read_) {
        const std::uint64_t count = missing_.front().count;
        missing_.erase(missing_.begin());
        return count;
    }
    const std::size_t octets = format_.octets_a_sample();
    const int file = ::open(file_.c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0) return 0;
    const std::uint64_t at = first_octet_ + read_ * octets;
    const off_t stored = ::lseek(file, static_cast<off_t>(at), SEEK_DATA);
    const bool none_stored = stored < 0 && errno == ENXIO;
    ::close(file);
    if (stored < 0 && !none_stored) return 0;
    const std::uint64_t end = missing_.empty() ? samples_ : std::min(samples_, missing_.front().before_sample);
    const std::uint64_t hole = none_stored ? end - read_ : (static_cast<std::uint64_t>(stored) - at) / octets;
    const std::uint64_t skipped = std::min(hole, end - read_);
    read_ += skipped;
    stream_.seekg(static_cast<std::streamoff>(first_octet_ + read_ * octets));
    return skipped;
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
    const double scale =
        std::ldexp(noise_of_range * std::numbers::sqrt2, 8 * format_.part_octets - 1);  // 2048 for ci16
    octets_.clear();
    format_.encode(samples, scale, octets_);
    stream_.write(octets_.data(), static_cast<std::streamsize>(octets_.size()));
    return state();
}

Result<void> SampleWriter::close() {
    stream_.close();
    return state();
}

}  // namespace aeolis::server
