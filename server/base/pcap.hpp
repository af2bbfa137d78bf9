// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "common/time.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace aeolis::server {

/// Files of captured packets (pcap, not pcapng), as tcpdump and tshark write and read them.
///
/// Written  link type 101 (raw IP): each piece of octets as a UDP datagram over IPv4, from 192.0.2.1 to 192.0.2.2, with
///          the time of its reception to the microsecond, UTC. `tshark -d udp.port==4200,ccsds` reads space packets
/// Read     link types 101 and 228 (IPv4), 1 (Ethernet, with VLAN tags), 113 (Linux cooked); either order of octets,
///          microseconds or nanoseconds. The data of UDP over IPv4; everything else is counted
namespace pcap {

inline constexpr std::uint16_t first_port = 4200;  ///< chosen; a further link has the next
inline constexpr std::size_t datagram_octets_max = 65507;

std::string head();
/// The records of `octets`; more than a datagram holds are several.
void append(std::string& to, Ert ert, std::uint16_t port, std::span<const std::uint8_t> octets);

struct Datagram {
    Ert ert;
    std::uint16_t port = 0;  ///< to which it was sent
    std::span<const std::uint8_t> octets;
};

/// Reads a whole file that is in memory.
class File {
  public:
    /// Whether a file begins as one of these.
    static bool is(std::span<const std::uint8_t> octets);
    /// Fails for pcapng, for another link type, and for what is no capture. `octets` must outlive this.
    static Result<File> open(std::span<const std::uint8_t> octets);

    /// The next datagram; none at the end.
    std::optional<Datagram> next();
    std::uint64_t others() const { return others_; }  ///< packets that are no whole UDP over IPv4
    bool cut() const { return cut_; }                 ///< the last record is not whole

  private:
    std::uint32_t number(std::size_t at, std::size_t octets) const;

    std::span<const std::uint8_t> octets_;
    std::size_t at_ = 0;
    bool swapped_ = false, nanoseconds_ = false, cut_ = false;
    std::uint32_t link_type_ = 0;
    std::uint64_t others_ = 0;
};

}  // namespace pcap
}  // namespace aeolis::server
