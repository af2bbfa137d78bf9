// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/gnc/quantities.hpp"
#include "generated/dictionary_flight.hpp"

#include <cstdint>
#include <span>

namespace aeolis::flight {

// Conditions behind a decision; deciders outside GNC use the same functions.
using gnc::above;
using gnc::at_least;
using gnc::at_most;
using gnc::below;
using gnc::is;
using gnc::names;

/// The packet that explains a decision by its conditions, at most four. R38
packet::Explanation explanation(Decision decision, ExplanationVerdict verdict, std::uint16_t subject,
                                std::span<const gnc::Condition> conditions, std::uint16_t suppressed = 0);

}  // namespace aeolis::flight
