// SPDX-License-Identifier: Apache-2.0
#include "server/archive/row_reader.hpp"

#include "server/archive/schema.hpp"

#include <algorithm>
#include <limits>

namespace aeolis::archive::row {

namespace {

Sequence seq(const sqlite::Statement& row) {
    return sequence_of(row.integer(0));
}
Source source(const sqlite::Statement& row, int column) {
    return static_cast<Source>(row.integer(column));
}
std::string text(const sqlite::Statement& row, int column) {
    return std::string(row.text(column));
}
/// NULL stands for NaN.
double number(const sqlite::Statement& row, int column) {
    return row.is_null(column) ? std::numeric_limits<double>::quiet_NaN() : row.real(column);
}
std::optional<ToneId> maybe_tone(const sqlite::Statement& row, int column) {
    if (row.is_null(column)) return {};
    return ToneId{static_cast<std::uint8_t>(row.integer(column))};
}

}  // namespace

UnitRecord unit(const sqlite::Statement& row) {
    UnitRecord record;
    record.seq = seq(row);
    record.apid = Apid{static_cast<std::uint16_t>(row.integer(1))};
    if (!row.is_null(2)) record.packet = static_cast<std::uint16_t>(row.integer(2));
    record.refusal = text(row, 3);
    record.sclk = Sclk{row.real(4)};
    record.ert = Ert{row.integer(5)};
    record.link = text(row, 6);
    record.source = source(row, 7);
    record.standing = static_cast<telemetry::Standing>(row.integer(8));
    record.sampled = row.integer(9) != 0;
    record.octets = {0, row.octets(unit_octets_column).size()};
    return record;
}

EventRecord event(const sqlite::Statement& row) {
    return {seq(row),
            static_cast<Sequence>(row.integer(1)),
            EvrId{static_cast<std::uint16_t>(row.integer(2))},
            text(row, 3),
            text(row, 4),
            text(row, 5),
            Sclk{row.real(6)},
            Ert{row.integer(7)},
            source(row, 8),
            row.integer(9) != 0};
}

ToneRecord tone(const sqlite::Statement& row) {
    ToneRecord record;
    record.seq = seq(row);
    record.start = Ert{row.integer(1)};
    record.end = Ert{row.integer(2)};
    record.tone = maybe_tone(row, 3);
    record.name = text(row, 4);
    record.meaning = text(row, 5);
    record.likelihood = row.real(6);
    record.runner_up = maybe_tone(row, 7);
    record.runner_up_likelihood = row.real(8);
    record.c_n0_dbhz = row.real(9);
    record.doppler_hz = row.real(10);
    record.locked = row.integer(11) != 0;
    record.model = text(row, 12);
    record.sclk = Sclk{row.real(13)};
    record.lock = text(row, 14);
    if (const auto octets = row.octets(15); octets.size() == ToneSpectrum{}.size())
        std::ranges::copy(octets, record.spectrum.emplace().begin());
    return record;
}

ToneLikelihood tone_likelihood(const sqlite::Statement& row) {
    return {static_cast<std::uint8_t>(row.integer(0)), row.real(1)};
}

StageRecord stage(const sqlite::Statement& row) {
    return {seq(row),
            static_cast<std::uint64_t>(row.integer(1)),
            text(row, 2),
            text(row, 3),
            text(row, 4),
            text(row, 5),
            Ert{row.integer(6)},
            text(row, 7),
            static_cast<std::uint32_t>(row.integer(8)),
            {},
            row.integer(9) != 0,  // none is 0
            row.integer(10) != 0,
            text(row, 11)};
}

FiringRecord firing(const sqlite::Statement& row) {
    return {seq(row),
            static_cast<Sequence>(row.integer(1)),
            TimepointId{static_cast<std::uint16_t>(row.integer(2))},
            text(row, 3),
            text(row, 6),
            Sclk{row.real(4)},
            Sclk{row.real(5)},
            source(row, 7),
            row.integer(8) != 0};
}

ExplanationRecord explanation(const sqlite::Statement& row) {
    ExplanationRecord record;
    record.seq = seq(row);
    record.unit = static_cast<Sequence>(row.integer(1));
    record.sclk = Sclk{row.real(2)};
    record.explanation.decision = text(row, 3);
    record.explanation.verdict = text(row, 4);
    record.explanation.subject = text(row, 5);
    record.explanation.text = text(row, 6);
    record.source = source(row, 7);
    record.duplicate = row.integer(8) != 0;
    return record;
}

telemetry::Condition condition(const sqlite::Statement& row) {
    return {text(row, 0), number(row, 1), text(row, 2), number(row, 3), row.integer(4) != 0};
}

LinkRecord link(const sqlite::Statement& row) {
    return {seq(row), text(row, 1), row.integer(2) != 0, text(row, 3), Ert{row.integer(4)}, row.integer(5) != 0};
}

AlarmRecord alarm(const sqlite::Statement& row) {
    return {seq(row),
            static_cast<Sequence>(row.integer(1)),
            ChannelId{static_cast<std::uint16_t>(row.integer(2))},
            text(row, 3),
            number(row, 4),
            Sclk{row.real(5)},
            text(row, 6)};
}

StalenessRecord staleness(const sqlite::Statement& row) {
    return {seq(row),
            static_cast<std::uint16_t>(row.integer(1)),
            row.integer(2) != 0,
            row.real(3),
            row.real(4),
            text(row, 5),
            Ert{row.integer(6)}};
}

AlarmActionRecord alarm_action(const sqlite::Statement& row) {
    return {seq(row), text(row, 1), text(row, 2), text(row, 3), text(row, 4), Ert{row.integer(5)}, Ert{row.integer(6)}};
}

NoteRecord note(const sqlite::Statement& row) {
    return {seq(row),     text(row, 1),
            text(row, 2), Ert{row.integer(3)},
            text(row, 4), row.is_null(5) ? std::nullopt : std::optional(row.real(5))};
}

}  // namespace aeolis::archive::row
