// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "telemetry/link_counters.hpp"
#include "telemetry/packet_source.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace aeolis::telemetry {

/// Totals of a link since the start of the run.
struct LinkTotals {
    std::string link;
    LinkCounters counters;
    double octets_per_s = 0.0;
    PacketCounters packets{};
    std::uint64_t bad_datagrams = 0;  ///< that hold anything but whole packets
    std::vector<SequenceTotals> sequences{};
    PointerVerdicts pointers{};  ///< of frames; not in the archive
};

/// Adds later totals of the same link.
void merge(LinkTotals& into, LinkTotals later);

/// Totals of a followed link over all connections of a run, good and bad.
///
/// In       each piece of octets, the sources that read them
/// Out      totals for archive, metrics and console, none of which ever falls; a line of what went wrong since the last
///          line
/// Memory   the first `sequences_named_max` sequences by name; all others are counted in one row "others"
class LinkLedger {
  public:
    explicit LinkLedger(std::string link) : link_(std::move(link)) {}

    void received(Ert ert, std::size_t octets);
    /// Octets of a stream whose layout was not found.
    void unread(std::size_t octets) { ended_.skipped_octets += octets; }
    void bad_datagram() { ++bad_datagrams_; }
    /// Adds the counters of a source that has ended.
    void end(const PacketSource& source);

    /// The totals, including those of `source` if there is one, with only those sequences that changed since the last
    /// call.
    LinkTotals totals(const PacketSource* source, Ert now);
    /// Whether the totals changed since the last call.
    bool changed(const LinkTotals& totals);
    /// Lists the faults since the last such line: "2 frames with a wrong CRC, 1 bad datagram"; empty: nothing.
    std::string faults_since(const LinkTotals& totals);
    /// Whether ended sources had frames or packets with a count.
    bool heard_sequences() const;

  private:
    struct Sequence {
        SequenceCounters ended, told;
    };
    using Key = std::pair<bool, std::string>;  ///< of packets; name
    Key row_of(Key name);

    std::string link_;
    RateMeter rate_;
    std::uint64_t octets_ = 0, bad_datagrams_ = 0;
    LinkCounters ended_;
    PacketCounters ended_packets_;
    PointerVerdicts ended_pointers_;
    std::map<Key, Sequence> sequences_;  ///< `sequences_named_max` and the others of frames and of packets
    std::optional<LinkTotals> last_;
    std::vector<std::uint64_t> logged_;
};

}  // namespace aeolis::telemetry
