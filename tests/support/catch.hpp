// SPDX-License-Identifier: Apache-2.0
#pragma once

// Catch2 by the names of version 2: that version on Debian 12, version 3 on Debian 13.
#if __has_include(<catch2/catch_all.hpp>)
#include <catch2/catch_all.hpp>

#include <string>

using Catch::Approx;

namespace Catch {

using Matchers::EndsWith;
using Matchers::StartsWith;
using Matchers::VectorContains;

inline constexpr const char* list_names = "--list-tests --verbosity quiet";  ///< the option that prints only names

inline auto Contains(const std::string& text, CaseSensitive sensitive = CaseSensitive::Yes) {
    return Matchers::ContainsSubstring(text, sensitive);
}

}  // namespace Catch
#else
#include <catch2/catch.hpp>

namespace Catch {

inline constexpr const char* list_names = "--list-test-names-only";

}  // namespace Catch
#endif
