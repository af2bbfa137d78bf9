// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/archive/records.hpp"

#include "aeolis/v1/run.pb.h"

#include <cstdint>
#include <span>
#include <string>

namespace aeolis::archive {

/// A counter of a link, described once: its column of the table "link_totals" has the name of its field in
/// `v1::LinkCounters`.
struct LinkTotalColumn {
    const char* name;
    std::uint64_t (*of)(const LinkTotals& totals);
    void (*set)(v1::LinkCounters& counters, std::uint64_t number);
};

/// All counters, in the order of the table. Before them it has `run`, `link` and `octets_per_s`.
std::span<const LinkTotalColumn> link_total_columns();

/// The statement that creates the table.
std::string link_totals_table_sql();
/// Inserts a row, or replaces it: run, link, octets_per_s, then the counters.
std::string put_link_totals_sql();
/// The rows of run ?1 by link: link, octets_per_s, then the counters.
std::string link_totals_of_run_sql();

}  // namespace aeolis::archive
