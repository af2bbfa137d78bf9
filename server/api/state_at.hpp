// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/run.pb.h"
#include "server/archive/reader.hpp"

#include <optional>

namespace aeolis::server {

/// A run as it stood at an instant: of every channel the newest value, of every link, command and alarm the newest
/// change, what had fired, the newest tone. None: now.
///
/// Cut      what has a time on board by that, up to `at`; what has one on Earth by what is seen of `at` there. Items of
///          the recording count at their own time: what was known then is the live items' part (source, duplicate)
/// Memory   an item a name
Result<v1::StateAt> state_at(archive::Reader& reader, archive::RunId run, const dictionary::Dictionary& dictionary,
                             std::optional<Sclk> at);

}  // namespace aeolis::server
