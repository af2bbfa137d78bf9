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

/// Receives the files in which the recording comes down (CFDP class 2), and asks for what of them is missing.
///
/// In       PDUs as they come, over any orbiter, in any order; Earth's clock; whether a bent pipe is up
/// Out      each file, once, when all of it is here and its checksum holds; PLTUs for the rover
/// Rule     what is missing is asked for when the end of a file is announced, and again each time that an answer is
///          overdue: both light times and 30 s (ours). Without a bent pipe once, until something has come again
/// Memory   at most `files_under_way_max` files of `file_octets_max` that are not whole; of whole ones some octets
/// Faults   what is no PDU, or is of no file of this vehicle, is counted. A file that failed is forgotten, and received
///          anew: the rover sends again what was not delivered. When too many are under way the one longest silent is
///          forgotten
class RecordingReceiver {
  public:
    using OnFile = std::function<void(std::span<const std::uint8_t>)>;

    static constexpr std::uint32_t file_octets_max = 4U << 20;  ///< ours: sixteen times what the rover puts into one
    static constexpr std::size_t files_under_way_max = 64;      ///< ours: twice what it has open at once

    explicit RecordingReceiver(double light_time_s) : light_time_s_(light_time_s) {}

    void receive(std::span<const std::uint8_t> pdu, Ert now, const OnFile& on_file);
    void pass(Ert now, bool bent_pipe_up);
    std::vector<std::vector<std::uint8_t>> take_pltus() { return std::exchange(pltus_, {}); }

    std::uint64_t received_octets() const;  ///< of the recording, each counted once
    std::size_t files_whole() const;
    std::size_t files_under_way() const { return files_.size() - files_whole(); }
    std::uint64_t asked() const { return asked_; }  ///< PDUs that asked for something again
    std::uint64_t refused() const;  ///< what was no PDU, belonged to no file, or contradicted what is known of one

  private:
    static constexpr std::size_t files_max = 4096;  ///< ours: of 256 KiB each a gigabyte

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
