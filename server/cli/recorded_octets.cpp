// SPDX-License-Identifier: Apache-2.0
#include "server/cli/recorded_octets.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>

namespace aeolis::server {
namespace {

constexpr std::size_t plain_piece_octets = 65536;
constexpr std::size_t window_octets = std::size_t{1} << 20U;  // of a file in memory
constexpr std::int64_t recorded_second_us = 1'000'000;
constexpr double bits_an_octet = 8.0;

/// Microseconds in which octets of a plain file came.
std::int64_t duration_us(std::size_t octets, const RecordedOctetsOptions& options) {
    if (!options.bits_per_second) return 0;
    return static_cast<std::int64_t>(static_cast<double>(octets) * bits_an_octet / *options.bits_per_second *
                                     recorded_second_us);
}

}  // namespace

Result<RecordedFile> RecordedFile::open(const std::filesystem::path& name) {
    RecordedFile opened;
    opened.file_ = ::open(name.c_str(), O_RDONLY | O_CLOEXEC);
    struct stat about{};
    if (opened.file_ < 0 || ::fstat(opened.file_, &about) != 0 || !S_ISREG(about.st_mode))
        return Error{name.string() + " cannot be read"};
    opened.size_ = static_cast<std::size_t>(about.st_size);
    return opened;
}

RecordedFile::RecordedFile(RecordedFile&& other) noexcept
    : file_(std::exchange(other.file_, -1)), size_(other.size_), window_(std::move(other.window_)), from_(other.from_) {
}

RecordedFile::~RecordedFile() {
    if (file_ >= 0) ::close(file_);
}

std::span<const std::uint8_t> RecordedFile::read(std::size_t at, std::size_t octets) {
    if (at < from_ || at + octets > from_ + window_.size()) fill(at, octets);
    if (at >= from_ + window_.size()) return {};
    const std::span<const std::uint8_t> held{window_};
    return held.subspan(at - from_, std::min(octets, from_ + window_.size() - at));
}

void RecordedFile::fill(std::size_t at, std::size_t octets) {
    window_.resize(std::max(octets, window_octets));
    from_ = at;
    std::size_t filled = 0;
    while (filled < window_.size()) {
        const auto got =
            ::pread(file_, window_.data() + filled, window_.size() - filled, static_cast<off_t>(at + filled));
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) break;
        filled += static_cast<std::size_t>(got);
    }
    window_.resize(filled);
}

Result<Recording> Recording::open(RecordedFile& file, const RecordedOctetsOptions& options, Ert start) {
    Recording recording{file, options, start};
    if (!pcap::File::is(file.read(0, 4))) return recording;
    if (options.start || options.bits_per_second)
        return Error{"a capture has times of its own: --start and --bits-per-second are for plain files"};
    const auto capture =
        pcap::File::open([&file](std::size_t at, std::size_t octets) { return file.read(at, octets); });
    if (!capture) return capture.error();
    recording.capture_ = *capture;
    return recording;
}

std::string Recording::each(const TakeRecordedPiece& take) const {
    RecordingCursor cursor{*this};
    while (const auto piece = cursor.next())
        if (!take(*piece)) return {};
    return cursor.unused();
}

RecordingCursor::RecordingCursor(const Recording& recording) : recording_(&recording), capture_(recording.capture_) {}

std::optional<RecordedPiece> RecordingCursor::next() {
    if (!capture_) return next_of_plain();
    const auto& ports = recording_->options_->ports;
    while (const auto datagram = capture_->next()) {
        if (!ports.empty() && std::ranges::find(ports, datagram->port) == ports.end()) {
            ++other_ports_;
            continue;
        }
        const bool told_apart = ports.size() > 1;
        if (datagram->stream && !told_apart && stream_port_.value_or(datagram->port) != datagram->port) {
            ++other_streams_;
            continue;
        }
        if (datagram->stream) stream_port_ = datagram->port;
        return RecordedPiece{datagram->ert, datagram->octets, !datagram->stream, datagram->port};
    }
    return {};
}

std::string RecordingCursor::unused() const {
    if (!capture_) return shrank_ ? "it grew shorter while it was read" : "";
    std::string words;
    if (capture_->others() > 0) words += fmt::format("; {} packets are no whole UDP over IPv4", capture_->others());
    if (other_ports_ > 0) words += fmt::format("; {} datagrams to other ports", other_ports_);
    if (other_streams_ > 0)
        words += fmt::format("; {} pieces of other streams than that to port {}; say which by {}", other_streams_,
                             *stream_port_, recording_->options_->select_by);
    if (capture_->cut()) words += "; the capture is cut off";
    return words.empty() ? words : words.substr(2);
}

std::optional<RecordedPiece> RecordingCursor::next_of_plain() {
    // With a rate in pieces of a tenth of a second: the time of each is that of its last octet.
    constexpr double piece_s = 0.1;
    const double rate = recording_->options_->bits_per_second.value_or(0.0) / bits_an_octet;
    const auto piece =
        rate > 0.0 ? static_cast<std::size_t>(std::clamp(rate * piece_s, 1.0, static_cast<double>(plain_piece_octets)))
                   : plain_piece_octets;
    const auto octets = recording_->file_->read(at_, piece);
    shrank_ = octets.empty() && at_ < recording_->file_->size();
    if (octets.empty()) return {};
    at_ += octets.size();
    const double passed_s = rate > 0.0 ? static_cast<double>(at_) / rate : 0.0;
    return RecordedPiece{{recording_->start_.microseconds + static_cast<std::int64_t>(passed_s * recorded_second_us)},
                         octets};
}

Result<RecordedFiles> RecordedFiles::open(const std::vector<std::filesystem::path>& names,
                                          const RecordedOctetsOptions& options, Ert start) {
    RecordedFiles opened;
    opened.files_.reserve(names.size());  // recordings refer to them
    for (const auto& name : names) {
        auto file = RecordedFile::open(name);
        if (!file) return file.error();
        opened.files_.push_back(std::move(*file));
        const Ert begun{start.microseconds + duration_us(opened.octets_, options)};
        auto recording = Recording::open(opened.files_.back(), options, begun);
        if (!recording) return Error{name.string() + ": " + recording.error().message};
        opened.octets_ += opened.files_.back().size();
        opened.recordings_.push_back(std::move(*recording));
    }
    return opened;
}

void RecordedPace::wait_for(Ert ert) {
    if (!waits()) return;
    if (!first_) {
        first_ = ert;
        started_ = std::chrono::steady_clock::now();
    }
    const double passed_s = static_cast<double>(ert.microseconds - first_->microseconds) / recorded_second_us;
    std::this_thread::sleep_until(started_ + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                                 std::chrono::duration<double>(passed_s / pace_)));
}

Result<void> check_rate(const RecordedOctetsOptions& options, const std::vector<std::filesystem::path>& files) {
    constexpr double years_max = 100.0, seconds_a_year = 31'557'600.0;  // chosen
    if (!options.bits_per_second) return {};
    if (!std::isfinite(*options.bits_per_second) || *options.bits_per_second <= 0.0)
        return Error{"--bits-per-second: must be a number above 0"};
    double octets = 0.0;
    for (const auto& file : files) {
        std::error_code error;
        const auto size = std::filesystem::file_size(file, error);
        if (!error) octets += static_cast<double>(size);
    }
    if (octets * bits_an_octet / *options.bits_per_second <= years_max * seconds_a_year) return {};
    return Error{fmt::format("--bits-per-second {:g}: {:.0f} octets would take more than {:.0f} years",
                             *options.bits_per_second, octets, years_max)};
}

}  // namespace aeolis::server
