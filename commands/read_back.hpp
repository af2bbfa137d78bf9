// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"
#include "dictionaries/dictionary.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace aeolis::commands {

/// The packet in which flight reads back a command: it has a field of the same name and width for each argument. None
/// when the dictionary has no such packet, or the command no arguments.
const dictionary::Packet* read_back_packet(const dictionary::Dictionary& dictionary,
                                           const dictionary::Command& command);

/// A comparison of the sent arguments with those held on board, bit for bit.
struct ReadBack {
    struct Difference {
        std::string argument;
        std::string sent, held;  ///< in words; in hexadecimal when the numbers look alike
    };
    std::size_t compared = 0;
    std::vector<Difference> differences;
    Sclk held_at;  ///< SCLK of the report

    bool equal() const { return compared > 0 && differences.empty(); }
    std::string text() const;  ///< "all 16 arguments equal, bit for bit, at SCLK …", or the differences
};

/// `sent`: the telecommand packet; `held`: a decoded packet of read_back_packet() (length and CRC right).
ReadBack compare(const dictionary::Command& command, std::span<const std::uint8_t> sent,
                 const dictionary::Packet& report, std::span<const std::uint8_t> held);

}  // namespace aeolis::commands
