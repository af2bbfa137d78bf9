// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/plan.pb.h"
#include "common/result.hpp"
#include "server/instruction/plan_reader.hpp"
#include "server/procedures/call_list.hpp"

#include <filesystem>
#include <string>

namespace aeolis::server::instruction {

/// What a mission has for rehearsals in its dictionary's folder: plans in `plans`, the library of injects
/// `injects.yaml`, `rubric.yaml`, and the standard calls `calls.yaml`. Read anew for each call.
class PlanLibrary {
  public:
    /// @param folder  the dictionary's; empty: there is neither. The dictionary must outlive this.
    PlanLibrary(std::filesystem::path folder, const dictionary::Dictionary& dictionary)
        : folder_(std::move(folder)), dictionary_(dictionary) {}

    /// All readable plans, by name, and the library; what breaks a rule is left out and logged.
    v1::PlanList list() const;
    /// The library's text; empty: there is none.
    std::string injects_text() const;
    /// The text of the plan of that name. The Error of an unknown name lists the existing ones.
    Result<v1::InstructorPlan> plan(const std::string& name) const;
    /// The mission's rubric; the Error says what is wrong with it, or that there is none.
    Result<Rubric> rubric() const;
    /// The mission's standard calls, none without a file; the Error says what is wrong with it, a line each.
    Result<procedures::CallList> calls() const;

  private:
    std::filesystem::path folder_;
    const dictionary::Dictionary& dictionary_;
};

/// The text of a file of YAML, cut off where it is too long to be read. An Error when there is no such file.
Result<std::string> text_of_file(const std::filesystem::path& file);
/// The files of YAML in a folder, by name.
std::vector<std::filesystem::path> yaml_files_in(const std::filesystem::path& folder);

}  // namespace aeolis::server::instruction
