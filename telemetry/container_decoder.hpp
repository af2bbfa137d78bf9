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

/// A parameter's value. The first alternative: undefined.
using Datum = std::variant<std::monostate, std::uint64_t, std::int64_t, double, std::string, std::vector<std::uint8_t>>;

/// "undefined", a number in the fewest digits that read back the same, text unchanged, octets in hexadecimal.
std::string datum_text(const Datum& datum);

struct DecodedValue {
    std::string name;  ///< "ATTITUDE.q[2]": includes members and elements of aggregates and arrays
    Datum raw;
    Datum calibrated;               ///< a label when the type has labels
    std::size_t position_bits = 0;  ///< from the first octet of the packet
    std::size_t bits = 0;
    std::size_t parameter = 0;  ///< in PacketModel::parameters
};

/// The time of a packet's creation.
struct PacketTime {
    double seconds = 0.0;  ///< since `epoch`, or counts of the spacecraft's clock
    std::string epoch;     ///< as the file names it: "UNIX"; empty: not named
};

struct DecodedContents {
    std::string container;             ///< the most derived one that matches
    std::size_t container_index = 0;   ///< in PacketModel::containers
    std::vector<DecodedValue> values;  ///< in the order of the packet
    std::optional<PacketTime> time;
    std::string problem;  ///< why the rest could not be read; empty: all was read
};

/// Decodes packets of any mission into values by the containers of its XTCE file.
///
/// In       the octets of a packet, any octets      Out   values up to the end, or up to the first unreadable field and
///          the reason
/// Rule     begins with a container that has no base and is part of no other, and continues with the first derived
///          container whose restriction holds, and so on
/// Time     the first absolute time, or a later one relative to it. Without one, two whole numbers right after the
///          primary header, with ...coarse... and ...fine... in their names, in any case, are the spacecraft's clock as
///          in CUC: counts and their binary fraction. [ccsds-301.0-b-4]
/// Limits   `values_max` values a packet; containers and types nested `depth_max` deep
/// Our own packets have a faster decoder: telemetry/decommutator.hpp
class ContainerDecoder {
  public:
    static constexpr std::size_t values_max = 65536;  ///< chosen: as many as the longest packet has octets
    static constexpr unsigned depth_max = 16;         ///< chosen

    /// `model` must outlive this.
    explicit ContainerDecoder(const dictionary::xtce::PacketModel& model);

    DecodedContents decode(std::span<const std::uint8_t> packet) const;

  private:
    const dictionary::xtce::PacketModel& model_;
    std::vector<std::size_t> roots_;
    std::vector<std::vector<std::size_t>> derived_;  ///< by container
};

}  // namespace aeolis::telemetry
