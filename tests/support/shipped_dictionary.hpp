// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"
#include "tests/support/catch.hpp"

namespace aeolis::tests {

/// The dictionary in dictionaries/msl, loaded once.
inline const dictionary::Dictionary& shipped_dictionary() {
    static const auto loaded = dictionary::load(AEOLIS_SOURCE_DIR "/dictionaries/msl");
    for (const auto& finding : loaded.findings) UNSCOPED_INFO(finding.text());
    REQUIRE(loaded.dictionary);
    return *loaded.dictionary;
}

}  // namespace aeolis::tests
