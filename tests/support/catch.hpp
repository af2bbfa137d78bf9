// SPDX-License-Identifier: Apache-2.0
#pragma once

// Catch2 by one name: version 2 of Debian 12, version 3 of newer systems.
#if __has_include(<catch2/catch_all.hpp>)
#include <catch2/catch_all.hpp>
#else
#include <catch2/catch.hpp>
#endif
