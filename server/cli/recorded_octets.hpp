// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "common/time.hpp"
#include "server/base/pcap.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

// Recorded octets of links, as `aeolis ingest` reads them.
namespace aeolis::server {

/// What is said of recorded octets beside them.
struct RecordedOctetsOptions {
    std::vector<std::uint16_t> ports{};       ///< of a capture's datagrams; empty: all
    std::optional<std::string> start{};       ///< UTC at which the first octet of plain files was received
    std::optional<double> bits_per_second{};  ///< at which the octets of plain files came
    std::string select_by = "--udp-port";     ///< the option that selects among a capture's streams
};

/// A file that is read as its octets are needed. One that grows shorter meanwhile has an end there.
class RecordedFile {
  public:
    static Result<RecordedFile> open(const std::filesystem::path& name);
    RecordedFile(RecordedFile&& other) noexcept;
    RecordedFile& operator=(RecordedFile&&) = delete;
    ~RecordedFile();

    std::size_t size() const { return size_; }
    /// As pcap::Source has it.
    std::span<const std::uint8_t> read(std::size_t at, std::size_t octets);

  private:
    RecordedFile() = default;
    void fill(std::size_t at, std::size_t octets);

    int file_ = -1;
    std::size_t size_ = 0;
    std::vector<std::uint8_t> window_;  ///< octets of the file from from_ on
    std::size_t from_ = 0;
};

struct RecordedPiece {
    Ert ert;
    std::span<const std::uint8_t> octets;
    bool datagram = false;
    std::uint16_t port = 0;  ///< of a capture's
};
using TakeRecordedPiece = std::function<bool(const RecordedPiece&)>;  ///< false: no more are wanted

class RecordingCursor;

/// What a recorded file holds, in order.
class Recording {
  public:
    /// `file` and `options` must outlive this. `start`: when the first octet of a plain file was received.
    static Result<Recording> open(RecordedFile& file, const RecordedOctetsOptions& options, Ert start);

    bool is_capture() const { return capture_.has_value(); }
    /// Gives each piece to `take`. @return what of a capture was not used, in words; empty: nothing
    std::string each(const TakeRecordedPiece& take) const;

  private:
    Recording(RecordedFile& file, const RecordedOctetsOptions& options, Ert start)
        : file_(&file), options_(&options), start_(start) {}
    friend class RecordingCursor;

    RecordedFile* file_;
    const RecordedOctetsOptions* options_;
    Ert start_;
    std::optional<pcap::File> capture_;
};

/// A walk through a recording, which must outlive it. One of them at a time for each file.
class RecordingCursor {
  public:
    explicit RecordingCursor(const Recording& recording);
    /// The next piece, valid until the next call; none at the end.
    std::optional<RecordedPiece> next();
    /// What has not been used so far, in words; empty: nothing.
    std::string unused() const;

  private:
    std::optional<RecordedPiece> next_of_plain();

    const Recording* recording_;
    std::optional<pcap::File> capture_;
    std::uint64_t other_ports_ = 0, other_streams_ = 0;
    std::optional<std::uint16_t> stream_port_;
    std::size_t at_ = 0;   ///< in a plain file
    bool shrank_ = false;  ///< a plain file, while it was read
};

/// Files that were recorded one after the other.
class RecordedFiles {
  public:
    /// Opens them; `start`: when the first octet of plain files was received.
    static Result<RecordedFiles> open(const std::vector<std::filesystem::path>& names,
                                      const RecordedOctetsOptions& options, Ert start);
    const std::vector<Recording>& recordings() const { return recordings_; }
    std::size_t octets() const { return octets_; }

  private:
    std::vector<RecordedFile> files_;
    std::vector<Recording> recordings_;
    std::size_t octets_ = 0;
};

/// Waits as long as the reception of a recording took.
class RecordedPace {
  public:
    /// `pace`: seconds of reception a second; 0: it never waits.
    explicit RecordedPace(double pace) : pace_(pace) {}
    bool waits() const { return pace_ > 0.0; }
    /// Waits until it is the turn of what was received at `ert`.
    void wait_for(Ert ert);

  private:
    double pace_;
    std::optional<Ert> first_;
    std::chrono::steady_clock::time_point started_;
};

/// Whether times of reception are in range at the rate that is told.
Result<void> check_rate(const RecordedOctetsOptions& options, const std::vector<std::filesystem::path>& files);

}  // namespace aeolis::server
