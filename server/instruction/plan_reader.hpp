// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/plan.pb.h"
#include "common/result.hpp"
#include "server/instruction/inject_plan.hpp"

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace aeolis::server::instruction {

/// Whether a fault can be injected at all; the Error names what is wrong with it.
using CheckFault = std::function<Result<void>(const v1::FaultInjection&)>;

/// A plan, or every rule that its text breaks, in the order of the text.
struct ReadPlan {
    std::optional<InjectPlan> plan;  ///< none when there are findings
    std::vector<procedures::TextFinding> findings;

    std::string findings_text() const;  ///< a line each
};

/// Injects that plans use by name; without triggers.
struct ReadLibrary {
    std::optional<std::vector<Inject>> injects;  ///< none when there are findings
    std::vector<procedures::TextFinding> findings;
};

/// Reads the library. All as for a plan.
ReadLibrary read_library(std::string_view text, const std::string& file, const dictionary::Dictionary& dictionary,
                         const CheckFault& check);

/// Reads an instructor's plan and checks it against the dictionary: all faults in one pass, each with its line and
/// column.
///
/// @param text     YAML; docs/rehearsals.md has its form
/// @param file     its name in findings; with an ending, the name before it is the plan's id
/// @param library  injects that it may use
/// @param check    of each fault
///
/// Checked: names that the form does not have; missing parts; ids that stand twice; channels, events and commands that
/// do not exist; faults that cannot be; a team that shall send a command and shall send none of it at the same time;
/// the limits of inject_plan.hpp.
ReadPlan read_plan(std::string_view text, const std::string& file, const dictionary::Dictionary& dictionary,
                   const std::vector<Inject>& library, const CheckFault& check);
/// Reads a plan as it was kept with a run, with the library of then. Its faults were checked when it was given.
ReadPlan read_plan(const v1::InstructorPlan& kept, const dictionary::Dictionary& dictionary);

/// Reads the rubric, in the same way.
struct ReadRubric {
    std::optional<Rubric> rubric;
    std::vector<procedures::TextFinding> findings;
};
ReadRubric read_rubric(std::string_view text, const std::string& file, const dictionary::Dictionary& dictionary);

}  // namespace aeolis::server::instruction
