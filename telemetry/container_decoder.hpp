// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "dictionaries/xtce/packet_model.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
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
    /// They are days of UTC and seconds of the day, not seconds that have passed: leap seconds are not counted.
    bool days_of_utc = false;
    bool leap_second = false;  ///< of those: within second 60, the last of its day
};

/// A value that stands in the packet and is not understood: of an encoding, a calibrator or a condition that is not
/// read, or whose bits its encoding has no meaning for. It is undefined, or its octets are given.
struct UnreadValue {
    std::size_t parameter = 0;  ///< in PacketModel::parameters
    unsigned line = 0;          ///< of what is not read
};

struct DecodedContents {
    std::string container;             ///< the most derived one that matches
    std::size_t container_index = 0;   ///< in PacketModel::containers
    std::vector<DecodedValue> values;  ///< in the order of the packet
    std::vector<UnreadValue> unread;
    std::optional<PacketTime> time;
    std::string problem;  ///< why the rest could not be read; empty: all was read
};

/// A number's name, and its place in the packet.
struct NamedPlace {
    std::string_view name;
    std::size_t position_bits = 0, bits = 0;
};
/// Whether two numbers are the counts of a clock and their binary fraction, by their names and places.
bool are_coarse_and_fine(const NamedPlace& coarse, const NamedPlace& fine);

/// Whether nothing but the end of a packet stands behind its last entry: zeros that fill its last octet, and perhaps
/// the right CRC-16 of the packet.
bool is_end_of_packet(std::span<const std::uint8_t> packet, std::size_t entries_end_bits);

/// Decodes packets of any mission into values by the containers of its XTCE file.
///
/// In       the octets of a packet, any octets      Out   values up to the end, or up to the first unreadable field and
///          the reason
/// Rule     begins with the root: a container that has no base and is part of no other. Continues with the derived
///          container whose restriction holds, and so on. Where several hold, one without a restriction gives way;
///          what is still several is not decoded further, nor is a packet that ends in an abstract container
/// Whole    a packet is decoded when all of its octets are: what is behind the last entry is a problem, unless
///          is_end_of_packet()
/// Time     the first absolute time, or a later one relative to it. Without one, two whole numbers right after the
///          primary header, with ...coarse... and ...fine... in their names, in any case, are the spacecraft's clock as
///          in CUC: counts and their binary fraction. [ccsds-301.0-b-4]
/// Limits   `values_max` values a packet; containers and types nested `depth_max` deep
/// Channels have a faster decoder of most containers: telemetry/container_plan.hpp
class ContainerDecoder {
  public:
    static constexpr std::size_t values_max = 65536;  ///< chosen: as many as the longest packet has octets
    static constexpr unsigned depth_max = 16;         ///< chosen

    /// The containers with which packets may begin. A container whose base is unknown is not among them: it would be
    /// taken for a packet of its own.
    static std::vector<std::size_t> roots_of(const dictionary::xtce::PacketModel& model);
    /// The root with this name or path; with an empty name, the only root. The Error names the roots there are.
    static Result<std::size_t> root_of(const dictionary::xtce::PacketModel& model, const std::string& name);

    /// `model` must outlive this. Nothing is decoded unless the model names a root, or roots_of() has exactly one.
    explicit ContainerDecoder(const dictionary::xtce::PacketModel& model);

    DecodedContents decode(std::span<const std::uint8_t> packet) const;

  private:
    const dictionary::xtce::PacketModel& model_;
    std::optional<std::size_t> root_;
    std::vector<std::vector<std::size_t>> derived_;  ///< by container
};

}  // namespace aeolis::telemetry
