// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/run.pb.h"
#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"
#include "server/archive/records.hpp"
#include "telemetry/alarm_desk.hpp"

#include <span>
#include <string>

// What people add to a run, checked: notes, and what they do about alarms.
namespace aeolis::server {

inline constexpr std::size_t note_octets_max = 4'000;  ///< a page of text
inline constexpr std::size_t author_octets_max = 100;  ///< a name
inline constexpr double shelve_s_max = 24.0 * 3600.0;  ///< ours: what a shift has shelved its next one sees again

/// Whether it can be a note: an Error names the field that is wrong.
Result<void> check_note(const std::string& text, const std::string& by);

/// An Error names the field that is wrong. Texts are kept as they are and never interpreted.
/// @param by   who says so
/// @param now  on Earth, by the run's clock
Result<archive::NoteRecord> note_of(const v1::NoteRequest& request, const std::string& by, Ert now);
/// @param links  names of those that the archive knows: each may be an alarm
Result<archive::AlarmActionRecord> alarm_action_of(const v1::AlarmRequest& request,
                                                   const dictionary::Dictionary& dictionary,
                                                   std::span<const std::string> links, const std::string& by, Ert now);

}  // namespace aeolis::server
