// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace aeolis {

/// Double Precision Array File, the container of SPICE's binary kernels [naif-daf].
///
/// Records of 1024 octets: the file record, records of summaries (each with its record of names), and numbers. An array
/// is found by its summary: numbers, integers, and the addresses of its first and last double, which count from 1.
struct DafArray {
    std::string name;
    std::vector<double> numbers;         ///< ND of them
    std::vector<std::int32_t> integers;  ///< NI of them, less the two addresses
    std::vector<double> data;
};

struct Daf {
    std::string kind;  ///< "SPK", "CK"
    std::vector<DafArray> arrays;
};

/// Reads a whole file, of either order of octets. Fails with what is wrong: another format, a summary or an address
/// beyond the file.
Result<Daf> read_daf(std::span<const std::uint8_t> file);

/// Writes a file of little-endian doubles. All arrays have as many numbers, and as many integers, as the first.
/// There are at most 25. @param program  up to 60 characters that say who wrote it
std::vector<std::uint8_t> write_daf(const Daf& daf, std::string_view program);

}  // namespace aeolis
