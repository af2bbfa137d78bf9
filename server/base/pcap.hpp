// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "common/time.hpp"

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace aeolis::server {

/// Files of captured packets, as tcpdump, tshark and Wireshark write and read them.
///
/// Written  pcap, link type 101 (raw IP): each piece of octets as a UDP datagram over IPv4, from 192.0.2.1 to
///          192.0.2.2, with the UTC time of its reception to the microsecond. Datagrams are sent from the port that
///          they are sent to, pieces of a stream from stream_port. `tshark -d udp.port==4200,ccsds` reads space packets
/// Read     pcap and pcapng, either order of octets, any resolution of time; link types 101, 12 and 228 (IPv4), 1
///          (Ethernet, with VLAN tags), 113 and 276 (Linux cooked). The data of UDP over IPv4; all else is counted
namespace pcap {

inline constexpr std::uint16_t first_port = 4200;   ///< chosen; a further link has the next
inline constexpr std::uint16_t stream_port = 4199;  ///< chosen: pieces of a stream are sent from it
inline constexpr std::size_t datagram_octets_max = 65507;

std::string head();
/// Appends `octets` as records; more than a datagram holds become several. `stream`: they are a piece of a stream,
/// which their port of origin says.
void append(std::string& to, Ert ert, std::uint16_t port, std::span<const std::uint8_t> octets, bool stream = false);

struct Datagram {
    Ert ert;
    std::uint16_t port = 0;  ///< to which it was sent
    std::span<const std::uint8_t> octets;
    bool stream = false;  ///< a piece of a stream, as append() marks it
};

/// Reads octets of a file from `at` on: as many as requested, or fewer at its end. They are valid until the next call.
using Source = std::function<std::span<const std::uint8_t>(std::size_t at, std::size_t octets)>;

class File {
  public:
    /// Whether a file begins like a capture.
    static bool is(std::span<const std::uint8_t> beginning);
    /// Fails for a file that is not a capture, and for a pcap file of another link type.
    static Result<File> open(Source source);
    static Result<File> open(std::span<const std::uint8_t> octets);  ///< which must outlive this

    /// The next datagram, valid until the next call; none at the end.
    std::optional<Datagram> next();
    std::uint64_t others() const { return others_; }  ///< packets other than whole UDP over IPv4 with a time
    bool cut() const { return cut_; }                 ///< the file ends within a record, or is damaged there

  private:
    struct Interface {
        std::uint32_t link_type = 0;
        std::uint64_t units_a_second = 1'000'000;
        std::int64_t offset_s = 0;
    };
    struct Captured {
        Ert ert;
        std::uint32_t link_type = 0;
        std::span<const std::uint8_t> packet;
    };
    explicit File(Source source) : source_(std::move(source)) {}
    std::uint64_t number(std::span<const std::uint8_t> octets) const;
    std::optional<Captured> next_of_pcap();
    std::optional<Captured> next_of_pcapng();
    void add_interface(std::span<const std::uint8_t> body);
    static Ert ert_of(std::uint64_t units, const Interface& by);

    Source source_;
    std::size_t at_ = 0;
    bool next_generation_ = false;  ///< pcapng
    bool swapped_ = false, cut_ = false;
    std::vector<Interface> interfaces_;  ///< of pcap one
    std::uint64_t others_ = 0;
};

}  // namespace pcap
}  // namespace aeolis::server
