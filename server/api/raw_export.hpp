// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/archive/reader.hpp"

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace aeolis::server {

/// Writes the octets of links as received, good and bad, or the packets found in them, for `aeolis export --raw` and
/// GET /api/v1/runs/{run}/raw.
///
/// Formats  bin: the octets alone, of one link; pcap: each piece or packet with its time, a UDP port a link
/// Memory   a page
class RawExport {
  public:
    /// Fails on an unknown format, and when the run has nothing of the requested kind.
    static Result<RawExport> begin(archive::Reader& reader, archive::RunId run, archive::RawQuery query,
                                   const std::string& format);

    std::string head() const;
    /// The next page, perhaps empty; none at the end.
    Result<std::optional<std::string>> page(archive::Reader& reader);
    bool done() const { return done_; }
    bool is_pcap() const { return pcap_; }
    /// Octets of the requested links that are no longer kept, because newer ones took their place.
    std::uint64_t octets_removed() const { return octets_removed_; }

  private:
    archive::RunId run_;
    archive::RawQuery query_;
    bool pcap_ = false, done_ = false;
    std::vector<std::string> links_;  ///< in the order of their ports
    std::set<std::string> streams_;   ///< of them: whose octets are pieces of a stream
    std::uint64_t octets_removed_ = 0;
    std::optional<archive::RawPiece> after_;
};

}  // namespace aeolis::server
