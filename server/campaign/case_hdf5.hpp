// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "server/campaign/case_table.hpp"

#include <cstdint>
#include <string>

namespace aeolis::server::campaign {

/// Of whom the table is: attributes of the file.
struct TableOrigin {
    std::string scenario;
    std::uint64_t seed = 0;
};

/// The octets of an HDF5 file with the table, the same for the same table.
///
/// The root has the attributes `scenario` and `seed`. In the group `cases` each column is a dataset with a
/// value a case, in the order of the CSV: `number` (whole numbers), `outcome` (UTF-8, padded with zeros), and each
/// quantity by its name (64-bit floats; NaN: the case has none). An Error names what HDF5 refused.
Result<std::string> hdf5_of(const CaseTable& table, const TableOrigin& origin);

}  // namespace aeolis::server::campaign
