// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/what_if.pb.h"
#include "server/archive/reader.hpp"

namespace aeolis::archive {

/// Lays one run over another, from where they part: events and timepoints that one has and the other has not, or has at
/// another time, and channels whose values differ. Both are taken as far as they are known, live and recorded.
///
/// Times    seconds from each run's own entry. Events are paired by name and count
/// Memory   of channels, a minute of both runs
/// Faults   an Error: no such run, another dictionary, or the reader was stopped
Result<v1::RunDifferences> differences(Reader& reader, const dictionary::Dictionary& dictionary, RunId run,
                                       RunId other);

}  // namespace aeolis::archive
