// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/run.pb.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace aeolis::server {

enum class SeriesFormat : std::uint8_t { json, csv, protobuf };

/// The text of a list of series, written straight from the columns, a megabyte at a time, because an exact answer may
/// have millions of numbers.
///
/// json      v1::ChannelSeriesList, the same as to_json() writes
/// csv       one row per sample, for spreadsheets and scripts
/// protobuf  v1::ChannelSeriesList; a series is one part
class SeriesText {
  public:
    explicit SeriesText(SeriesFormat format) : format_(format) {}

    std::string head() const;
    /// Begins the next series.
    void begin(v1::ChannelSeries series);
    /// Appends the next part of the series; false: that was the last.
    bool append(std::string& text);
    std::string tail() const;

  private:
    bool append_json(std::string& text);
    bool append_csv(std::string& text);
    SeriesFormat format_;
    v1::ChannelSeries series_;
    bool first_ = true;  ///< the first of the list
    int column_ = 0, next_ = 0;
};

/// The whole text.
std::string series_text(SeriesFormat format, v1::ChannelSeriesList list);

}  // namespace aeolis::server
