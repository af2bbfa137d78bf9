// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/archive/records.hpp"
#include "telemetry/packet_source.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace aeolis::server {

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
    void end(const telemetry::PacketSource& source);

    /// The totals with those of `source`, if there is one. Of sequences only those that changed since the last call.
    archive::LinkTotals totals(const telemetry::PacketSource* source, Ert now);
    /// Whether the totals changed since the last call.
    bool changed(const archive::LinkTotals& totals);
    /// What went wrong since the last such line, such as "2 frames with a wrong CRC, 1 bad datagram"; empty: nothing.
    std::string faults_since(const archive::LinkTotals& totals);

  private:
    struct Sequence {
        telemetry::SequenceCounters ended, told;
    };
    using Key = std::pair<bool, std::string>;  ///< of packets; name
    Key row_of(Key name);

    std::string link_;
    telemetry::RateMeter rate_;
    std::uint64_t octets_ = 0, bad_datagrams_ = 0;
    telemetry::LinkCounters ended_;
    telemetry::PacketCounters ended_packets_;
    std::map<Key, Sequence> sequences_;  ///< `sequences_named_max` and the others of frames and of packets
    std::optional<archive::LinkTotals> last_;
    std::vector<std::uint64_t> logged_;
};

}  // namespace aeolis::server
