// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/archive/records.hpp"

#include <cstdint>

// A packet on the other path, real time or recording: found by APID, SCLK and packet count, compared by octets. The
// station's own packets have no other path.
namespace aeolis::archive {

enum class PathComparison : std::uint8_t { identical = 0, differs = 1, absent = 2, not_decoded = 3, of_ground = 4 };

/// The verdict's name (one of `verdicts`). Until the whole recording is down, nothing counts as missing in it.
const char* name_of(PathComparison found, Source source, bool recording_complete);

/// SQL expression that gives a PathComparison for the row of `packets` with alias u.
inline constexpr char path_comparison_sql[] =
    "CASE WHEN u.packet IS NULL THEN 3"
    " WHEN u.link = (SELECT number FROM words WHERE kind = 'link' AND word = 'station') THEN 4 ELSE coalesce("
    "(SELECT o.octets <> u.octets FROM packets o WHERE o.run = u.run AND o.apid = u.apid AND o.source = 3 - u.source"
    " AND o.sclk = u.sclk AND o.packet IS NOT NULL AND substr(o.octets, 3, 2) = substr(u.octets, 3, 2)"
    " ORDER BY 1 LIMIT 1), 2) END";

}  // namespace aeolis::archive
