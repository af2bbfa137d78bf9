// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/run.pb.h"
#include "common/result.hpp"
#include "simulation/scenario.hpp"

#include <filesystem>
#include <string>

namespace aeolis::server {

/// The scenarios that ship: the *.textproto files of one directory, read anew each time, named by their file.
class ScenarioLibrary {
  public:
    explicit ScenarioLibrary(std::filesystem::path directory) : directory_(std::move(directory)) {}

    /// Those that can be read, by name; one that cannot is left out and logged.
    v1::ScenarioList list() const;
    /// Names the ones that exist when there is none of this name.
    Result<simulation::Scenario> scenario(const std::string& name) const;

  private:
    std::filesystem::path directory_;
};

}  // namespace aeolis::server
