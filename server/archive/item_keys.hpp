// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace aeolis::archive {

/// SQL for the key of every item of a run, samples too; ?1, ?2: the first and the last key. `schema` ("main.") prefixes
/// the names of tables.
std::string item_keys_sql(const std::string& schema = {});

}  // namespace aeolis::archive
