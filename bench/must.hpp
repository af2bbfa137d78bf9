// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cerrno>
#include <cstdio>
#include <cstdlib>

namespace aeolis::bench {

/// Ends the benchmark with exit code 1 and "PROGRAM: WHAT failed" unless `done`.
inline void must(bool done, const char* what) {
    if (done) return;
    std::fprintf(stderr, "%s: %s failed\n", program_invocation_short_name, what);
    std::exit(1);
}

}  // namespace aeolis::bench
