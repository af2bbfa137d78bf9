// SPDX-License-Identifier: Apache-2.0
#include "server/procedures/step_order.hpp"

#include <algorithm>
#include <iterator>

namespace aeolis::server::procedures {

std::vector<Target> ways_on(const std::vector<Step>& body, std::size_t step) {
    const Step& from = body[step];
    std::vector<Target> ways;
    if (!from.choices.empty()) {
        ways.reserve(from.choices.size());
        for (const Choice& choice : from.choices) ways.push_back(choice.target);
    } else if (from.next) {
        ways.push_back(*from.next);
    } else if (step + 1 < body.size()) {
        ways.push_back({Target::Kind::step, step + 1});
    } else {
        ways.push_back({Target::Kind::confirmation, 0});
    }
    return ways;
}

StepOrder follow(const std::vector<Step>& body) {
    enum class Seen { no, open, done };
    struct At {
        std::size_t step;
        std::vector<Target> ways;
        std::size_t taken = 0;
    };
    StepOrder order;
    if (body.empty()) return order;
    std::vector<Seen> seen(body.size(), Seen::no);
    std::vector<At> path;
    const auto enter = [&](std::size_t step) {
        seen[step] = Seen::open;
        path.push_back({step, ways_on(body, step)});
    };
    enter(0);
    while (!path.empty()) {
        At& at = path.back();
        if (at.taken == at.ways.size()) {
            seen[at.step] = Seen::done;
            path.pop_back();
            continue;
        }
        const Target way = at.ways[at.taken++];
        if (way.kind != Target::Kind::step || seen[way.step] == Seen::done) continue;
        if (seen[way.step] == Seen::no) {
            enter(way.step);
            continue;
        }
        auto& circle = order.circles.emplace_back();
        const auto first = std::ranges::find(path, way.step, &At::step);
        std::ranges::transform(first, path.end(), std::back_inserter(circle), &At::step);
        circle.push_back(way.step);
    }
    for (std::size_t step = 0; step < body.size(); ++step)
        if (seen[step] == Seen::no) order.unreachable.push_back(step);
    return order;
}

}  // namespace aeolis::server::procedures
