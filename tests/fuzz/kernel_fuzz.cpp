// SPDX-License-Identifier: Apache-2.0
// Text kernels as anyone may have left them: a kernel, or a fault that names the file; what is read gives finite times.
#include "telemetry/clock_kernel.hpp"

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace aeolis;
    const std::string text{data, data + size};
    const auto kernel = telemetry::TextKernel::parse(text, "k");
    if (!kernel) {
        if (!kernel.error().message.starts_with("k:")) std::abort();
        return 0;
    }
    const auto leaps = telemetry::LeapSeconds::read(*kernel);
    if (leaps)
        for (const double time_s : {-1.0e9, 0.0, 4.0e8, 1.0e20})
            if (const auto utc = leaps->utc_of_tdb(time_s)) (void)utc->text();
    const auto clock = telemetry::ClockKernel::read(*kernel);
    if (!clock) return 0;
    for (const double count : {0.0, 1.0, 397501174.5, 1.0e18}) {
        const auto time_s = clock->parallel_time_of(count);
        if (time_s && leaps) (void)clock->scet_of(count, *leaps);
        if (time_s) (void)clock->count_at(*time_s);
    }
    return 0;
}
