// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/lists.pb.h"
#include "aeolis/v1/run.pb.h"
#include "server/archive/reader.hpp"

#include <optional>

namespace aeolis::server {

/// The state of a run at an instant: the newest value of every channel, the newest change of every link, command and
/// alarm, the timepoints that had fired, and the newest tone. `at` none: now.
///
/// Cut      items with a time on board: up to `at`. Items with a time on Earth: up to when `at` is seen there. Items of
///          the recording count at their own time; the live items among them (source, duplicate) are what was known
///          then
/// Memory   one item per name
Result<v1::StateAt> state_at(archive::Reader& reader, archive::RunId run, const dictionary::Dictionary& dictionary,
                             std::optional<Sclk> at);

}  // namespace aeolis::server
