// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"
#include "server/archive/reader.hpp"

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace aeolis::server {

/// Writes samples as text, as `aeolis export` and GET /api/v1/runs/{run}/samples do: one line per sample or, aligned,
/// one line per instant with one column per channel.
///
/// In       samples in order of SCLK, those of one instant in one call     Out   text: head(), append()…, finish()
/// Aligned  to a channel: lines at its times. To a step: lines at multiples of the step in SCLK, each only when there
///          was a new sample since the line before, so that a silence makes no lines. Each column holds the newest
///          value up to the line's time; before the first value it is empty (CSV) or null (JSON)
/// Memory   one value per channel
class SampleText {
  public:
    static constexpr double align_s_min = 0.001, align_s_max = 86'400.0;  ///< chosen

    struct Options {
        std::string format = "csv";  ///< or "jsonl"
        std::string align;           ///< a channel among those written, or seconds; empty: a line per sample
    };
    /// @param channels  names; empty: all, which cannot be aligned. The Error names the parameter at fault.
    static Result<SampleText> make(const dictionary::Dictionary& dictionary, const std::vector<std::string>& channels,
                                   const Options& options);

    /// Adds to each line the seconds since entry.
    /// 0: not known, as for a followed mission; e_s is then empty.
    void set_entry(Sclk entry) { entry_ = entry; }
    bool is_csv() const { return csv_; }
    std::string head() const;
    void append(std::string& text, std::span<const archive::ChannelValue> samples);
    void finish(std::string& text);

  private:
    SampleText(const dictionary::Dictionary& dictionary, bool csv);
    std::string e_text(double sclk_s) const;
    void append_sample(std::string& text, const archive::ChannelValue& sample) const;
    void append_aligned(std::string& text, const archive::ChannelValue& sample);
    void append_line(std::string& text, double sclk_s) const;

    struct Words {
        std::string name, unit;
    };
    bool csv_;
    std::vector<Words> words_;  ///< per channel, escaped for the format: a dictionary's names may hold any character
    Sclk entry_{};
    std::vector<const dictionary::Channel*> columns_;  ///< of aligned lines; empty: a line per sample
    const dictionary::Channel* leader_ = nullptr;      ///< the channel aligned to; null: step_s_
    double step_s_ = 0.0;
    std::vector<std::optional<std::string>> values_;  ///< per column, as text of the format
    std::optional<double> line_s_;                    ///< SCLK of the line not yet written
};

}  // namespace aeolis::server
