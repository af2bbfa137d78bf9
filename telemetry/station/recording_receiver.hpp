// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"
#include "telemetry/cfdp_receiver.hpp"

#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <utility>
#include <vector>

namespace aeolis::telemetry {

/// Receives the recording's files (CFDP class 2), and requests their missing parts.
///
/// In       PDUs as received, over any orbiter, in any order; Earth's clock; whether a bent pipe is up
/// Out      each file, once, when it is complete and its checksum right; PLTUs for the rover
/// Rule     missing parts are requested when a file's end is announced, and again when an answer is overdue: after both
///          light times and 30 s (our assumption). Without a bent pipe only once, until something is received again
/// Memory   at most `files_under_way_max` incomplete files of `file_octets_max`; some octets for each complete one
/// Faults   octets that are not a PDU, or of no file of this vehicle, are counted. A failed file is forgotten and
///          received anew: the rover resends what was not delivered. When too many are under way, the longest silent is
///          forgotten
class RecordingReceiver {
  public:
    using OnFile = std::function<void(std::span<const std::uint8_t>)>;

    static constexpr std::uint32_t file_octets_max = 4U << 20;  ///< chosen: sixteen times the rover's largest
    static constexpr std::size_t files_under_way_max = 64;      ///< chosen: twice what the rover has open at once

    explicit RecordingReceiver(double light_time_s) : light_time_s_(light_time_s) {}

    void receive(std::span<const std::uint8_t> pdu, Ert now, const OnFile& on_file);
    void pass(Ert now, bool bent_pipe_up);
    std::vector<std::vector<std::uint8_t>> take_pltus() { return std::exchange(pltus_, {}); }

    std::uint64_t received_octets() const;  ///< of the recording, each counted once
    std::size_t files_whole() const;
    /// Whether all of the recording is here: the file that the rover names its last, and each one before it.
    bool whole() const;
    std::size_t files_under_way() const { return files_.size() - files_whole(); }
    std::uint64_t asked() const { return asked_; }  ///< PDUs that requested something
    std::uint64_t refused() const;                  ///< octets that are no PDU, belong to no file, or contradict one

  private:
    static constexpr std::size_t files_max = 4096;  ///< chosen: at 256 KiB each, a gigabyte

    static bool fits(const cfdp::Pdu& pdu);
    struct File {
        CfdpReceiver receiver;
        std::vector<std::uint8_t> octets{};
        bool given_out = false;
        Ert heard{};
    };
    using FileName = std::pair<std::uint64_t, std::uint64_t>;  ///< source, sequence

    File* file_of(const cfdp::Header& header);
    void forget_the_most_silent();
    void answer(File& file);

    double light_time_s_;
    std::map<FileName, File> files_;
    std::vector<std::vector<std::uint8_t>> pltus_;
    Ert heard_, asked_at_;
    std::uint64_t asked_ = 0, refused_ = 0;
    std::uint16_t packet_count_ = 0;
    std::uint8_t frame_sequence_ = 0;
};

}  // namespace aeolis::telemetry
