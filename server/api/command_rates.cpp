// SPDX-License-Identifier: Apache-2.0
#include "server/api/command_rates.hpp"

#include <algorithm>
#include <cmath>

namespace aeolis::server {

std::optional<std::chrono::seconds> CommandRates::take(const std::string& client, std::size_t commands,
                                                       Clock::time_point now) {
    if (clients_.size() >= clients_max && !clients_.contains(client))
        std::erase_if(clients_, [&](const auto& each) { return left_at(each.second, now) >= at_once; });
    const bool room = clients_.size() < clients_max || clients_.contains(client);
    auto& allowance = clients_.try_emplace(room ? client : "", Allowance{at_once, now}).first->second;
    const double left = left_at(allowance, now);
    const auto wanted = static_cast<double>(commands);
    if (wanted > left)
        return std::chrono::seconds{
            static_cast<std::int64_t>(std::ceil((std::min(wanted, at_once) - left) / each_second))};
    allowance = {left - wanted, now};
    return std::nullopt;
}

double CommandRates::left_at(const Allowance& allowance, Clock::time_point now) {
    const double passed_s = std::chrono::duration<double>(now - allowance.at).count();
    return std::min(at_once, allowance.left + passed_s * each_second);
}

}  // namespace aeolis::server
