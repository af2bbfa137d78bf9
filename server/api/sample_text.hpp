#pragma once

#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"
#include "server/archive/reader.hpp"

#include <span>
#include <string>
#include <string_view>

namespace aeolis::server {

/// Samples as rows of text for other programs: how `aeolis export` and GET /api/v1/runs/{run}/samples write them.
enum class RowFormat : std::uint8_t { csv, jsonl };

/// "csv" or "jsonl".
Result<RowFormat> row_format(std::string_view name);
/// What stands before all rows.
std::string_view head_of(RowFormat format);
/// A line a sample: SCLK, seconds after entry, channel, value, unit, link. JSON has no infinities: they are texts.
void append_rows(std::string& text, RowFormat format, std::span<const archive::ChannelValue> samples, Sclk entry,
                 const dictionary::Dictionary& dictionary);

} // namespace aeolis::server
