// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/alarms.pb.h"
#include "aeolis/v1/positions.pb.h"
#include "aeolis/v1/procedures.pb.h"
#include "aeolis/v1/run.pb.h"
#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"
#include "server/archive/records.hpp"
#include "server/procedures/call_list.hpp"
#include "telemetry/alarm_register.hpp"

#include <span>
#include <string>

// Checks what people add to a run: notes, actions on alarms, acts on procedures and on positions.
namespace aeolis::server {

inline constexpr std::size_t note_octets_max = 4'000;  ///< a page of text
inline constexpr std::size_t author_octets_max = 100;  ///< a name
inline constexpr double shelve_s_max = 24.0 * 3600.0;  ///< chosen: an alarm shelved by one shift returns in the next

/// Checks a note. The Error names the field at fault.
Result<void> check_note(const std::string& text, const std::string& by);

/// Makes a note record. The Error names the field at fault. Texts are stored unchanged and never interpreted.
/// @param by   the author
/// @param now  time on Earth by the run's clock
Result<archive::NoteRecord> note_of(const v1::NoteRequest& request, const std::string& by, Ert now);
/// Makes the record of a standard call: the position, what it says, and what is given with it.
Result<archive::NoteRecord> call_of(const v1::NoteRequest& request, const procedures::CallList& calls,
                                    const std::string& by, Ert now);
/// Makes the record of a line that reads a call back.
/// @param called  the call
Result<archive::NoteRecord> read_back_of(const v1::NoteRequest& request, const v1::Note& called, const std::string& by,
                                         Ert now);
/// Makes an alarm action record.
/// @param links  names of the links in the archive: each may be an alarm
Result<archive::AlarmActionRecord> alarm_action_of(const v1::AlarmRequest& request,
                                                   const dictionary::Dictionary& dictionary,
                                                   std::span<const std::string> links, const std::string& by, Ert now);

/// Makes the record of the act that begins a procedure.
/// @param text  the procedure's file
Result<archive::ProcedureActRecord> procedure_act_of(const v1::ProcedureBeginRequest& request, std::string text,
                                                     const std::string& by, Ert now);
/// Makes the record of an act on a procedure. Whether it has a place now is another question.
/// @param number  of the procedure in the run
Result<archive::ProcedureActRecord> procedure_act_of(const v1::ProcedureActRequest& request, std::uint32_t number,
                                                     const std::string& by, Ert now);
/// Makes the record of an act on a position, without the board behind it.
Result<archive::PositionActRecord> position_act_of(const v1::PositionActRequest& request, const std::string& by,
                                                   Ert now);

}  // namespace aeolis::server
