// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/findings.hpp"

#include <optional>
#include <string_view>
#include <vector>

// Readers of the mission's spreadsheets, each with the rules of its rows.
// None when a sheet cannot be read at all. Otherwise every row is returned, even with findings, so that a reference to
// it is not reported as dangling too.
namespace aeolis::dictionary {

inline constexpr std::size_t timepoints_max = 1000;   ///< chosen: ten times the landing's; numbers fit the command's
                                                      ///< range
inline constexpr std::size_t anchors_max = 100;       ///< chosen
inline constexpr std::size_t parameters_max = 1000;   ///< chosen
inline constexpr std::size_t constraints_max = 1000;  ///< chosen: ten times the landing's
inline constexpr std::size_t tones_count = 256;       ///< R31

/// Reads anchors.csv, in topological order: parents before children, otherwise as in the file. R12
std::optional<std::vector<AnchorRow>> read_anchors(std::string_view text, Findings& findings);

/// Reads tones.csv, by id. Every prime tone NAME has a Second Chance tone sc_NAME. R31, R35
std::optional<std::vector<ToneRow>> read_tones(std::string_view text, Findings& findings);

/// Reads mfsk.csv: each number of the waveform once, by its name and in its unit.
/// Tones are orthogonal over a symbol, and no odd harmonic of one coincides with another.
std::optional<MfskWaveform> read_mfsk(std::string_view text, Findings& findings);

/// Reads parameters.csv in the order of the file: a parameter's id is its row.
std::optional<std::vector<ParameterRow>> read_parameters(std::string_view text, Findings& findings);

/// Reads clock_correlation.csv, by valid_from.
/// Versions and times rise, and rates are plausible for a clock. Where one row follows another, both give the same SCET
/// except for leap seconds and the error of a clock.
std::optional<std::vector<ClockRow>> read_clock_correlation(std::string_view text, Findings& findings);

/// Reads predicted_anchors.csv: the time of each anchor in the design, in seconds from entry.
/// `anchors` null: their file could not be read, so names are not checked.
std::optional<std::vector<std::optional<double>>>
read_predicted_anchors(std::string_view text, const std::vector<AnchorRow>* anchors, Findings& findings);

/// Everything that a timeline may refer to.
/// A null pointer: its own file could not be read, so it is not checked.
struct TimelineContext {
    struct DeclaredEvent {
        std::string name;
        bool has_arguments = false;
    };
    const std::vector<AnchorRow>* anchors = nullptr;
    const std::vector<ToneRow>* tones = nullptr;
    const std::vector<DeclaredEvent>* events = nullptr;
};

/// Reads timeline.csv in the order of the file, which is the order of firing. R11, R13, R20
std::optional<std::vector<TimelineRow>> read_timeline(std::string_view text, const TimelineContext& context,
                                                      Findings& findings);

/// Everything that a constraint may refer to.
/// A null pointer: its own file could not be read, so it is not checked.
struct ConstraintContext {
    const std::vector<TimelineRow>* timeline = nullptr;
    const std::vector<AnchorRow>* anchors = nullptr;
};

/// Reads constraints.csv, in the order of the file.
/// A moment is NAME (of a timepoint: its firing as `from`, its triggering as `to`), NAME:triggered, NAME:fired,
/// NAME:anchor or do_edl. R19
std::optional<std::vector<ConstraintRow>> read_constraints(std::string_view text, const ConstraintContext& context,
                                                           Findings& findings);

}  // namespace aeolis::dictionary
