// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/ids.hpp"
#include "common/time.hpp"
#include "flight/kernel/message.hpp"
#include "generated/dictionary_flight.hpp"

#include <array>
#include <cstdint>
#include <optional>

// Tables that the autocoder makes of timeline.csv, anchors.csv and tones.csv for the timeline. R11, R12, R20
namespace aeolis::flight {

class ActionContext;
using Action = void (*)(ActionContext&);

/// A row of the timeline as written in the sheet. Commands change copies of the offsets, never this row.
struct TimepointSpec {
    const char* name = "";
    std::optional<AnchorId> anchor;  ///< none: the desired offset is from the previous timepoint
    MaybeOffset desired_offset_s;
    MaybeOffset minimum_offset_s;  ///< from the previous timepoint
    Action action = nullptr;       ///< nullptr: none
    std::optional<double> reply_timeout_s;
    std::optional<TimepointId> backtrack;
    bool essential = false;
    std::optional<ToneId> tone;
    Action event = nullptr;           ///< function that announces the row's event; nullptr: none
    std::optional<ModuleId> owner{};  ///< the module that the action may command; none: unspecified, as in tests. R5
};

/// A row of the anchors. Parents precede their children: one sweep computes all times.
struct AnchorSpec {
    const char* name = "";
    std::optional<AnchorId> parent;  ///< none: the root, at zero
    MaybeOffset offset_s;
};

struct ToneSpec {
    std::uint8_t set = 0;  ///< 0 prime, 1 Second Chance, 2 spare
    std::int16_t priority = 0;
    double expires_s = 0.0;
    std::optional<ToneId> supersedes;
    std::optional<ToneId> second_chance;  ///< of a prime tone: the Second Chance tone with the same meaning. R35
};

extern const std::array<TimepointSpec, timepoint_count> timeline_specs;
extern const std::array<AnchorSpec, anchor_count> anchor_specs;
extern const std::array<ToneSpec, 256> tone_specs;

}  // namespace aeolis::flight
