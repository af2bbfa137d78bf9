// SPDX-License-Identifier: Apache-2.0
#include "server/scenario/scenario_library.hpp"

#include "server/scenario/scenario_text.hpp"

#include <algorithm>
#include <spdlog/spdlog.h>
#include <vector>

namespace aeolis::server {
namespace {

constexpr const char* extension = ".textproto";

std::vector<std::string> names_in(const std::filesystem::path& directory) {
    std::vector<std::string> names;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator{directory, error})
        if (entry.path().extension() == extension) names.push_back(entry.path().stem().string());
    std::ranges::sort(names);
    return names;
}

}  // namespace

v1::ScenarioList ScenarioLibrary::list() const {
    v1::ScenarioList list;
    for (const auto& name : names_in(directory_)) {
        const auto read = scenario_from_file(directory_ / (name + extension));
        if (!read) {
            spdlog::warn("scenario left out: {}", read.error().message);
            continue;
        }
        auto& entry = *list.add_scenarios();
        entry.set_name(name);
        entry.set_title(read->title);
    }
    return list;
}

Result<simulation::Scenario> ScenarioLibrary::scenario(const std::string& name) const {
    // The name may come from a client: it is looked up in the list and never made a path.
    const auto names = names_in(directory_);
    if (std::ranges::binary_search(names, name)) return scenario_from_file(directory_ / (name + extension));
    std::string known;
    for (const auto& each : names) known += (known.empty() ? "" : ", ") + each;
    return Error{"scenario '" + name + "': there is none of this name; there are: " + known};
}

}  // namespace aeolis::server
