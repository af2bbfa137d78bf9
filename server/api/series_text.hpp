// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/run.pb.h"

#include <string>

// Series as text. An exact answer has a million numbers: it is written straight from the columns, in the memory of the
// text itself.
namespace aeolis::server {

/// As to_json() has it.
std::string series_json(const v1::ChannelSeriesList& list);
/// A row a sample; the reader of a spreadsheet or of a script wants no JSON.
std::string series_csv(const v1::ChannelSeriesList& list);

}  // namespace aeolis::server
