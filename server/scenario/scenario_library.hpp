// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/run.pb.h"
#include "common/result.hpp"
#include "simulation/scenario.hpp"

#include <filesystem>
#include <string>

namespace aeolis::server {

/// The shipped scenarios: the *.textproto files of one directory, named by file, read anew for each call.
class ScenarioLibrary {
  public:
    explicit ScenarioLibrary(std::filesystem::path directory) : directory_(std::move(directory)) {}

    /// All readable scenarios, by name; an unreadable one is left out and logged.
    v1::ScenarioList list() const;
    /// The scenario of that name. The Error of an unknown name lists the existing ones.
    Result<simulation::Scenario> scenario(const std::string& name) const;

  private:
    std::filesystem::path directory_;
};

}  // namespace aeolis::server
