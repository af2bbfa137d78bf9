// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"
#include "server/procedures/form_reader.hpp"

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace aeolis::server::procedures {

/// A procedure, or every rule that its text breaks, in the order of the text.
struct ReadProcedure {
    std::optional<Procedure> procedure;  ///< none when there are findings
    std::vector<TextFinding> findings;
};

/// Reads a procedure and checks it against the dictionary: all faults in one pass, each with its line and column.
///
/// @param text        YAML; docs/procedures.md has its form
/// @param file        its name in findings; without folder and ending it is the procedure's id
/// @param procedures  ids that a watchdog may name: those that lie beside it
///
/// Checked: names that the form does not have; missing parts; ids that stand twice; positions, channels, events,
/// commands, arguments, steps and procedures that do not exist; values of a wrong type, unit or range; arguments that
/// the encoder would refuse; a circle of branches; a step that is never reached; the limits of procedure.hpp.
ReadProcedure read_procedure(std::string_view text, const std::string& file, const dictionary::Dictionary& dictionary,
                             std::span<const std::string> procedures);
/// The same of a procedure that is followed: what its watchdogs begin may lie beside it no more.
ReadProcedure read_procedure(std::string_view text, const std::string& file, const dictionary::Dictionary& dictionary);

}  // namespace aeolis::server::procedures
