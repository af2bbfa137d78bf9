// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/procedures.pb.h"
#include "dictionaries/dictionary.hpp"
#include "server/procedures/execution.hpp"

// Procedures in the words of the schema.
namespace aeolis::pipeline {

/// A procedure as it stands, but for its number and who began it.
v1::ProcedureStatus status_of(const server::procedures::Execution& execution, const dictionary::Dictionary& dictionary);

/// A procedure before anybody begins it, without its file's text: all steps wait, and no condition has evidence.
v1::ProcedureForm form_of(const server::procedures::Procedure& procedure, const dictionary::Dictionary& dictionary);

}  // namespace aeolis::pipeline
