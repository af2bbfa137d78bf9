// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/rehearsal/rehearsal.hpp"

#include <string>

namespace aeolis::server {

/// A landing as `aeolis rehearse` prints it.
///
/// json   the object of docs/architecture.md, on one line; a non-finite number is null
/// table  the same for people
std::string landing_json(const Rehearsal& rehearsal, double wall_s);
std::string landing_table(const Rehearsal& rehearsal, double wall_s);

}  // namespace aeolis::server
