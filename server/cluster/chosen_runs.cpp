// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/chosen_runs.hpp"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <limits>
#include <optional>
#include <string_view>

namespace aeolis::server::cluster {
namespace {

std::optional<std::uint32_t> run_number(std::string_view text) {
    std::uint32_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc{} || end != text.data() + text.size() || number == 0) return std::nullopt;
    return number;
}

}  // namespace

Result<ChosenRuns> ChosenRuns::parse(const std::string& text) {
    ChosenRuns chosen;
    chosen.text_ = text;
    std::string_view rest = text;
    for (bool more = true; more;) {
        const auto comma = rest.find(',');
        const auto part = rest.substr(0, comma);
        more = comma != std::string_view::npos;
        rest = more ? rest.substr(comma + 1) : std::string_view{};
        const auto dash = part.find('-');
        const auto first = run_number(part.substr(0, dash));
        const auto last = dash == std::string_view::npos ? first
                          : dash + 1 == part.size()      ? std::optional{std::numeric_limits<std::uint32_t>::max()}
                                                         : run_number(part.substr(dash + 1));
        if (!first || !last || *last < *first)
            return Error{fmt::format("'{}': numbers of runs are wanted, such as 3,5-8,12-", text)};
        chosen.ranges_.emplace_back(*first, *last);
    }
    return chosen;
}

bool ChosenRuns::has(archive::RunId run) const {
    return ranges_.empty() || std::ranges::any_of(ranges_, [run](const auto& range) {
               return range.first <= run.value && run.value <= range.second;
           });
}

}  // namespace aeolis::server::cluster
