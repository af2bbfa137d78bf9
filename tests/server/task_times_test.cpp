// SPDX-License-Identifier: Apache-2.0
#include "server/venue/task_times.hpp"

#include "tests/support/catch.hpp"

#include <algorithm>
#include <random>
#include <vector>

namespace server_task_times_test {

using namespace aeolis::server;

TEST_CASE("least, mean and worst are exact, and 99.9 % within a tenth", "[venue][R8]") {
    std::mt19937_64 random{3};
    std::lognormal_distribution<double> durations{8.0, 1.5};
    Durations measured;
    std::vector<double> all;
    for (int i = 0; i < 50000; ++i) {
        const auto ns = static_cast<std::uint64_t>(durations(random)) + 1;
        measured.add(ns);
        all.push_back(static_cast<double>(ns) * 1.0e-3);
    }
    std::sort(all.begin(), all.end());
    double sum = 0.0;
    for (const double us : all) sum += us;
    CHECK(measured.least_us() == Approx(all.front()));
    CHECK(measured.worst_us() == Approx(all.back()));
    CHECK(measured.mean_us() == Approx(sum / 50000));
    const double p999 = all[50000 - 51];
    CHECK(measured.p999_us() >= p999);
    CHECK(measured.p999_us() <= p999 * 1.13);
}

TEST_CASE("a task whose messages cost alike is even; one dear type among cheap ones shows", "[venue][R8]") {
    TaskTimes times;
    CHECK(unevenness(times) == 1.0);
    times.by_message[0].add(1000);
    times.by_message[1].add(1000);
    CHECK(unevenness(times) == Approx(1.0));
    times.by_message[2].add(10000);
    CHECK(unevenness(times) == Approx(10.0 / 4.0));
}

}  // namespace server_task_times_test
