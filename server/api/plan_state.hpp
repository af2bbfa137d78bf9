// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/plan.pb.h"
#include "server/archive/reader.hpp"
#include "server/instruction/plan_library.hpp"

namespace aeolis::server {

/// The instructor's plan of a run, and what has become of each inject; without a name when it has none.
Result<v1::PlanState> plan_state(archive::Reader& reader, archive::RunId run, const dictionary::Dictionary& dictionary,
                                 const instruction::PlanLibrary& plans);

/// Every intervention in a run.
Result<std::vector<v1::Intervention>> all_interventions(archive::Reader& reader, archive::RunId run);

}  // namespace aeolis::server
