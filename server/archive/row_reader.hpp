// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/archive/records.hpp"
#include "server/archive/sqlite.hpp"

// Rows back to records: for each table the question (keys ?1 to ?2, at most ?3 rows, in order), and the record of the
// row that stands ready.
namespace aeolis::archive::row {

inline constexpr char unit_rows[] = "SELECT key, apid, packet, refusal, sclk, ert_us, (SELECT word FROM words WHERE "
                                    "kind = 'link' AND number = link), source, standing, sampled, octets"
                                    " FROM units WHERE key BETWEEN ?1 AND ?2 ORDER BY key LIMIT ?3";
/// The octets themselves stay in the row: column unit_octets_column.
UnitRecord unit(const sqlite::Statement& row);
inline constexpr int unit_octets_column = 10;

inline constexpr char event_rows[] = "SELECT key, unit, event, name, level, text, sclk, ert_us, source, duplicate"
                                     " FROM events WHERE key BETWEEN ?1 AND ?2 ORDER BY key LIMIT ?3";
EventRecord event(const sqlite::Statement& row);

/// Without its best tones, which have rows of their own.
inline constexpr char tone_rows[] =
    "SELECT t.key, start_us, end_us, t.tone, name, meaning, likelihood, runner_up, runner_up_likelihood, c_n0_dbhz,"
    " doppler_hz, locked, model, sclk, lock, spectrum FROM tones t JOIN tone_evidence e ON e.key = "
    "t.key"
    " WHERE t.key BETWEEN ?1 AND ?2 ORDER BY t.key LIMIT ?3";
ToneRecord tone(const sqlite::Statement& row);
inline constexpr char tone_likelihood_rows[] =
    "SELECT tone, likelihood FROM tone_likelihoods WHERE key = ?1 ORDER BY position";
ToneLikelihood tone_likelihood(const sqlite::Statement& row);

inline constexpr char stage_rows[] =
    "SELECT key, command, name, stage, status, evidence, at_us, arguments, count, held, needs_approval, asked_by"
    " FROM command_stages LEFT JOIN command_waits USING (key) WHERE key BETWEEN ?1 AND ?2 ORDER BY key LIMIT ?3";
StageRecord stage(const sqlite::Statement& row);

inline constexpr char firing_rows[] =
    "SELECT key, unit, timepoint, name, triggered_sclk, fired_sclk, verdict, source, duplicate"
    " FROM timepoint_firings WHERE key BETWEEN ?1 AND ?2 ORDER BY key LIMIT ?3";
FiringRecord firing(const sqlite::Statement& row);

/// Without its conditions, which have rows of their own.
inline constexpr char explanation_rows[] = "SELECT key, unit, sclk, decision, verdict, subject, text, source, duplicate"
                                           " FROM explanations WHERE key BETWEEN ?1 AND ?2 ORDER BY key LIMIT ?3";
ExplanationRecord explanation(const sqlite::Statement& row);
inline constexpr char condition_rows[] = "SELECT quantity, value, comparison, bound, holds"
                                         " FROM explanation_conditions WHERE key = ?1 ORDER BY position";
telemetry::Condition condition(const sqlite::Statement& row);

inline constexpr char link_rows[] = "SELECT c.key, (SELECT word FROM words WHERE kind = 'link' AND number = link), up, "
                                    "reason, ert_us, l.key IS NOT NULL"
                                    " FROM link_changes c LEFT JOIN link_losses l ON l.key = c.key WHERE c.key BETWEEN "
                                    "?1 AND ?2 ORDER BY c.key LIMIT ?3";
/// Of links that were lost some time in the run.
inline constexpr char lost_link_rows[] =
    "SELECT c.key, (SELECT word FROM words WHERE kind = 'link' AND number = link), up, reason, ert_us, l.key IS NOT "
    "NULL"
    " FROM link_changes c LEFT JOIN link_losses l ON l.key = c.key WHERE c.key BETWEEN ?1 AND ?2 AND link IN"
    " (SELECT link FROM link_changes JOIN link_losses USING (key) WHERE key BETWEEN ?1 >> 40 << 40 AND ?2) ORDER BY "
    "c.key LIMIT ?3";
LinkRecord link(const sqlite::Statement& row);

inline constexpr char alarm_rows[] = "SELECT key, unit, channel, severity, value, sclk, limit_text"
                                     " FROM alarms WHERE key BETWEEN ?1 AND ?2 ORDER BY key LIMIT ?3";
AlarmRecord alarm(const sqlite::Statement& row);

inline constexpr char staleness_rows[] = "SELECT key, packet, stale, silent_s, expected_s, reason, ert_us"
                                         " FROM staleness WHERE key BETWEEN ?1 AND ?2 ORDER BY key LIMIT ?3";
StalenessRecord staleness(const sqlite::Statement& row);

inline constexpr char alarm_action_rows[] = "SELECT key, alarm, action, note, author, at_us, until_us"
                                            " FROM alarm_actions WHERE key BETWEEN ?1 AND ?2 ORDER BY key LIMIT ?3";
AlarmActionRecord alarm_action(const sqlite::Statement& row);

inline constexpr char note_rows[] = "SELECT key, text, author, at_us, written, sclk"
                                    " FROM notes WHERE key BETWEEN ?1 AND ?2 ORDER BY key LIMIT ?3";
NoteRecord note(const sqlite::Statement& row);

}  // namespace aeolis::archive::row
