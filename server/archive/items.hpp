// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/items.pb.h"
#include "aeolis/v1/run.pb.h"
#include "dictionaries/dictionary.hpp"
#include "server/archive/records.hpp"

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

// Converts records to the schema's items. Publishing and reading back use the same functions, so that a client cannot
// tell the two apart.
namespace aeolis::archive {

/// The name of an undecoded packet is the reason. Without a dictionary (another was used to record the run) it is
/// empty.
v1::Item to_item(const PacketRecord& record, const dictionary::Dictionary* dictionary);
/// @param values  one per channel; NaN is left out
v1::Item to_item(const SampleRecord& record, std::span<const ChannelId> channels, std::span<const double> values);
v1::Item to_item(const EventRecord& record);
v1::Item to_item(const ToneRecord& record);
v1::Item to_item(const StageRecord& record);
v1::Item to_item(const FiringRecord& record);
v1::Item to_item(const ExplanationRecord& record);
v1::Item to_item(const LinkRecord& record);
v1::Item to_item(const AlarmRecord& record);
/// Without a dictionary the packet has no name.
v1::Item to_item(const StalenessRecord& record, const dictionary::Dictionary* dictionary);
v1::Item to_item(const SituationRecord& record);
v1::Item to_item(const AlarmActionRecord& record);
v1::Item to_item(const NoteRecord& record);
v1::Item to_item(const ProcedureActRecord& record);
v1::Item to_item(const ProcedureStatusRecord& record);
v1::Item to_item(const PositionActRecord& record);
/// Converts a record of any kind that has a table.
template <typename Record>
v1::Item item_of(const Record& record, const dictionary::Dictionary* dictionary) {
    if constexpr (requires { to_item(record, dictionary); })
        return to_item(record, dictionary);
    else
        return to_item(record);
}

/// Reads a command's octets from pairs of lower-case hexadecimal digits.
std::vector<std::uint8_t> octets_of_hex(std::string_view hex);

v1::ClockReply to_reply(const ClockCorrelation& clock);
v1::ForkOrigin to_reply(const ForkPoint& fork);
ClockCorrelation correlation_of(const v1::RunState& run);
/// When on Earth the event on board at `at` is received, by the run's clock correlation and light time. A time too far
/// away for a date compares as before or after everything.
Ert ert_of(const v1::RunState& run, Sclk at);
/// The inverse of ert_of(): the time on board that is received at `ert`. Not rounded to a tick.
Sclk sclk_at_ert(const v1::RunState& run, Ert ert);

inline v1::Item to_item(const Annotation& annotation) {
    return std::visit([](const auto& record) { return to_item(record); }, annotation);
}

}  // namespace aeolis::archive
