// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/limits.pb.h"
#include "server/archive/reader.hpp"

namespace aeolis::server {

inline constexpr std::size_t limit_stretches_max = 10'000;  ///< chosen, 2 MB as JSON: a landing has some ten

/// The alarm limits that were in force during a run, by the samples received. Fails when they changed more often than
/// limit_stretches_max.
/// @param recorded  whether samples that only the recording has count as well
Result<v1::LimitsInForce> limits_in_force(archive::Reader& reader, archive::RunId run,
                                          const dictionary::Dictionary& dictionary, bool recorded);

}  // namespace aeolis::server
