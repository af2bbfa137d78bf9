// SPDX-License-Identifier: Apache-2.0
#include "server/scenario/loaded_parameters.hpp"

#include "commands/number.hpp"
#include "generated/parameter_names.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace aeolis::server {

Result<flight::Parameters> parameters_of(const v1::Scenario& message) {
    flight::Parameters parameters;
    std::array<bool, flight::parameter_count> named{};
    for (int i = 0; i < message.parameters_size(); ++i) {
        const v1::LoadedParameter& row = message.parameters(i);
        const std::string field = fmt::format("parameters[{}]", i);
        const auto found = std::ranges::find(flight::parameter_names, row.name());
        if (found == flight::parameter_names.end())
            return Error{fmt::format("{}.name: parameters.csv has no parameter '{}'", field, row.name())};
        const auto id = static_cast<std::size_t>(found - flight::parameter_names.begin());
        const flight::ParameterSpec& spec = flight::parameter_specs[id];
        if (spec.member == nullptr)
            return Error{fmt::format("{}.name: {} is fixed when flight is built", field, row.name())};
        if (std::exchange(named[id], true)) return Error{fmt::format("{}.name: {} is named twice", field, row.name())};
        if (!(row.value() >= spec.min && row.value() <= spec.max))
            return Error{fmt::format("{}.value: {} {} is outside {} … {}", field, row.name(),
                                     commands::shortest_text(row.value()), commands::shortest_text(spec.min),
                                     commands::shortest_text(spec.max))};
        parameters.*spec.member = row.value();
    }
    return parameters;
}

std::vector<std::pair<ParameterId, double>> loaded_parameters(const flight::Parameters& parameters) {
    std::vector<std::pair<ParameterId, double>> loaded;
    const flight::Parameters defaults;
    for (std::uint16_t id = 0; id < flight::parameter_count; ++id)
        if (const auto member = flight::parameter_specs[id].member;
            member != nullptr && parameters.*member != defaults.*member)
            loaded.emplace_back(ParameterId{id}, parameters.*member);
    return loaded;
}

void write_parameters(const flight::Parameters& parameters, v1::Scenario& message) {
    for (const auto& [id, value] : loaded_parameters(parameters)) {
        auto& row = *message.add_parameters();
        row.set_name(std::string{flight::parameter_names[id.value]});
        row.set_value(value);
    }
}

}  // namespace aeolis::server
