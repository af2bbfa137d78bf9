// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"
#include "server/campaign/case_table.hpp"
#include "server/cli/long_work.hpp"
#include "server/cli/shipped_paths.hpp"
#include "simulation/scenario.hpp"

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <string>

namespace aeolis::server {

/// How the cases of a study are flown and kept: one results file for each scenario that it flies.
struct StudyOptions {
    std::uint64_t cases = 0, seed = 1;
    unsigned jobs = 0;  ///< 0: one for each processor
    std::filesystem::path folder = "run-data";
};
void add_study(CLI::App& command, StudyOptions& options);

/// Dictionary and scenario for many cases. The Error names the scenario.
Result<FlightInputs> study_inputs(const SharedOptions& shared, const std::string& scenario);

/// All cases of a results file. The Error names the file.
Result<campaign::CaseTable> table_of(const std::filesystem::path& file);

/// Flies what is missing of a scenario's cases, and reads all of them.
Result<campaign::CaseTable> cases_flown(const StudyOptions& options, const simulation::Scenario& scenario,
                                        const dictionary::Dictionary& dictionary, ProgressLine& line);

}  // namespace aeolis::server
