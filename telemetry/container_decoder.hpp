// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/xtce/packet_model.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace aeolis::telemetry {

/// What a parameter says. The first alternative: undefined.
using Datum = std::variant<std::monostate, std::uint64_t, std::int64_t, double, std::string, std::vector<std::uint8_t>>;

/// "undefined", a number in the fewest digits that read back the same, text as it is, octets in hexadecimal.
std::string datum_text(const Datum& datum);

struct DecodedValue {
    std::string name;  ///< "ATTITUDE.q[2]": members and elements of what is composed
    Datum raw;
    Datum calibrated;               ///< a label where the type has labels
    std::size_t position_bits = 0;  ///< from the first octet of the packet
    std::size_t bits = 0;
    std::size_t parameter = 0;  ///< in PacketModel::parameters
};

/// When a packet was made.
struct PacketTime {
    double seconds = 0.0;  ///< since `epoch`, or counts of the spacecraft's clock
    std::string epoch;     ///< as the file names it: "UNIX"; empty: it does not
};

struct DecodedContents {
    std::string container;             ///< the last one that fits
    std::size_t container_index = 0;   ///< in PacketModel::containers
    std::vector<DecodedValue> values;  ///< in the order of the packet
    std::optional<PacketTime> time;
    std::string problem;  ///< why it could not be read to its end; empty: it could
};

/// Packets of any mission to values, by the containers of its XTCE file.
///
/// In       the octets of a packet, any octets      Out   values up to the end, or up to what cannot be read and why
/// Rule     begins with a container that has no base and is part of no other, and goes on with the first container
///          derived from it whose restriction holds, and so on
/// Time     the first absolute time, or a later one that counts from it. Where there is none: two whole numbers right
///          behind the primary header, named ...coarse... and ...fine... in any case, are the spacecraft's clock as CUC
///          has it: counts and their binary fraction. [ccsds-301.0-b-4]
/// Limits   `values_max` values a packet; containers and types nested `depth_max` deep
/// Our own packets have a faster way: telemetry/decommutator.hpp
class ContainerDecoder {
  public:
    static constexpr std::size_t values_max = 65536;  ///< ours: as many as the longest packet has octets
    static constexpr unsigned depth_max = 16;         ///< ours

    /// `model` must outlive this.
    explicit ContainerDecoder(const dictionary::xtce::PacketModel& model);

    DecodedContents decode(std::span<const std::uint8_t> packet) const;

  private:
    const dictionary::xtce::PacketModel& model_;
    std::vector<std::size_t> roots_;
    std::vector<std::vector<std::size_t>> derived_;  ///< by container
};

}  // namespace aeolis::telemetry
