// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"
#include "dictionaries/dictionary.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace aeolis::commands {

/// The packet in which flight reports what it holds after this command: it has a field for each of its arguments, of
/// the same name and width. None when the dictionary has none, or the command no arguments.
const dictionary::Packet* read_back_packet(const dictionary::Dictionary& dictionary,
                                           const dictionary::Command& command);

/// Sent against held, bit for bit.
struct ReadBack {
    struct Difference {
        std::string argument;
        std::string sent, held;  ///< in words, or hexadecimal when the numbers look alike
    };
    std::size_t compared = 0;
    std::vector<Difference> differences;
    Sclk held_at;  ///< SCLK of the report

    bool equal() const { return compared > 0 && differences.empty(); }
    std::string text() const;  ///< "all 16 arguments equal, bit for bit, at SCLK …", or which differ
};

/// `sent`: the telecommand packet; `held`: a packet of read_back_packet() that has been decoded (length and CRC right).
ReadBack compare(const dictionary::Command& command, std::span<const std::uint8_t> sent,
                 const dictionary::Packet& report, std::span<const std::uint8_t> held);

}  // namespace aeolis::commands
