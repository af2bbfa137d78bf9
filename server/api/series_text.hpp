// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/run.pb.h"

#include <string>

// Series as text. An exact answer has a million numbers, so it is written straight from the columns; memory is that of
// the text itself.
namespace aeolis::server {

/// JSON, the same as to_json() writes.
std::string series_json(const v1::ChannelSeriesList& list);
/// CSV, one row per sample, for spreadsheets and scripts.
std::string series_csv(const v1::ChannelSeriesList& list);

}  // namespace aeolis::server
