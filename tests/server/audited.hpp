// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/archive/reader.hpp"
#include "tests/support/catch.hpp"

#include <chrono>
#include <thread>

namespace aeolis::test {

/// Waits for the only entry in the audit of a server in which one action was carried out.
inline archive::AuditEntry only_audited(archive::Reader& reader) {
    std::vector<archive::AuditEntry> entries;
    for (int i = 0; i < 3000 && entries.empty(); ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds{20});
        if (auto read = reader.audit(0, 10)) entries = std::move(*read);
    }
    REQUIRE(entries.size() == 1);
    return entries[0];
}

}  // namespace aeolis::test
