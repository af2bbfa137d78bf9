// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/findings.hpp"

#include <optional>
#include <string_view>
#include <vector>

// The mission's spreadsheets, each with the rules of its rows. None when a sheet cannot be read at all; otherwise every
// row is there, also those with findings, so that a reference to one is not called dangling as well.
namespace aeolis::dictionary {

inline constexpr std::size_t timepoints_max = 1000;  ///< ours: ten times the landing's; numbers fit the command's range
inline constexpr std::size_t anchors_max = 100;      ///< ours
inline constexpr std::size_t parameters_max = 1000;  ///< ours
inline constexpr std::size_t constraints_max = 1000;  ///< ours: ten times the landing's
inline constexpr std::size_t tones_count = 256;       ///< R31

/// In topological order: parents before children, else as in the file. R12
std::optional<std::vector<AnchorRow>> read_anchors(std::string_view text, Findings& findings);

/// By id. Every prime tone NAME has a Second Chance tone sc_NAME. R31, R35
std::optional<std::vector<ToneRow>> read_tones(std::string_view text, Findings& findings);

/// Each number of the waveform once, under its name and in its unit; tones orthogonal over a symbol, and no odd
/// harmonic of one falls on another.
std::optional<MfskWaveform> read_mfsk(std::string_view text, Findings& findings);

std::optional<std::vector<ParameterRow>> read_parameters(std::string_view text, Findings& findings);

/// clock_correlation.csv, by valid_from: versions and times rise, rates are those of a clock, and where one row follows
/// another both give the same SCET but for leap seconds and what a clock is off by.
std::optional<std::vector<ClockRow>> read_clock_correlation(std::string_view text, Findings& findings);

/// predicted_anchors.csv, by anchor: when each comes in the design, in seconds from entry. `anchors` null: unknown
/// because their file could not be read, so names are not checked.
std::optional<std::vector<std::optional<double>>>
read_predicted_anchors(std::string_view text, const std::vector<AnchorRow>* anchors, Findings& findings);

/// What a timeline may refer to; a null pointer: unknown because its own file could not be read, so not checked.
struct TimelineContext {
    struct DeclaredEvent {
        std::string name;
        bool has_arguments = false;
    };
    const std::vector<AnchorRow>* anchors = nullptr;
    const std::vector<ToneRow>* tones = nullptr;
    const std::vector<DeclaredEvent>* events = nullptr;
};

/// In the order of the file, which is the order of firing. R11, R13, R20
std::optional<std::vector<TimelineRow>> read_timeline(std::string_view text, const TimelineContext& context,
                                                      Findings& findings);

/// What a constraint may speak of; a null pointer: unknown because its own file could not be read, so not checked.
struct ConstraintContext {
    const std::vector<TimelineRow>* timeline = nullptr;
    const std::vector<AnchorRow>* anchors = nullptr;
};

/// In the order of the file. A moment is NAME (a timepoint: its firing as `from`, its triggering as `to`),
/// NAME:triggered, NAME:fired, NAME:anchor or do_edl. R19
std::optional<std::vector<ConstraintRow>> read_constraints(std::string_view text, const ConstraintContext& context,
                                                           Findings& findings);

}  // namespace aeolis::dictionary
