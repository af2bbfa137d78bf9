// SPDX-License-Identifier: Apache-2.0
#include "telemetry/sequence_table.hpp"
#include "tests/support/catch.hpp"

namespace telemetry_sequence_table_test {

using namespace aeolis::telemetry;

TEST_CASE("sequences beyond those that are told by name are counted in one row, and none is forgotten",
          "[telemetry][R54]") {
    SequenceTable<std::size_t> table;
    for (int round = 0; round < 2; ++round)
        for (std::size_t key = 0; key < sequences_named_max + 100; ++key) ++table.of(key).received;
    CHECK(table.rows().size() == sequences_named_max);
    CHECK(table.rows().at(0).received == 2);
    CHECK(table.rows().at(sequences_named_max - 1).received == 2);
    CHECK(table.others().received == 200);
}

}  // namespace telemetry_sequence_table_test
