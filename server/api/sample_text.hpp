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

/// Samples as lines of text for other programs: how `aeolis export` and GET /api/v1/runs/{run}/samples write them.
/// Either a line a sample, or, aligned, a line an instant with a column a channel.
///
/// In       samples in order of SCLK, those of one instant in one piece     Out   text: head(), append()…, finish()
/// Aligned  to a channel: its times; to a step: multiples of it by SCLK, each with news since the one before, so that a
///          silence makes no lines. Of each channel the newest value up to the line's time; none yet: nothing (CSV),
///          null (JSON)
/// Memory   a value a channel
class SampleText {
  public:
    static constexpr double align_s_min = 0.001, align_s_max = 86'400.0;  ///< ours

    struct Options {
        std::string format = "csv";  ///< or "jsonl"
        std::string align;           ///< one of the channels, or seconds; empty: a line a sample
    };
    /// @param channels  by name; empty: all, which cannot be aligned. Fails with the parameter's name.
    static Result<SampleText> make(const dictionary::Dictionary& dictionary, const std::vector<std::string>& channels,
                                   const Options& options);

    /// Lines say the seconds after it.
    void set_entry(Sclk entry) { entry_ = entry; }
    bool is_csv() const { return csv_; }
    std::string head() const;
    void append(std::string& text, std::span<const archive::ChannelValue> samples);
    void finish(std::string& text);

  private:
    SampleText(const dictionary::Dictionary& dictionary, bool csv);
    void append_sample(std::string& text, const archive::ChannelValue& sample) const;
    void append_aligned(std::string& text, const archive::ChannelValue& sample);
    void append_line(std::string& text, double sclk_s) const;

    struct Words {
        std::string name, unit;
    };
    bool csv_;
    std::vector<Words> words_;  ///< a channel each, as the format writes a text: names are whatever a dictionary says
    Sclk entry_{};
    std::vector<const dictionary::Channel*> columns_;  ///< of aligned lines; empty: a line a sample
    const dictionary::Channel* leader_ = nullptr;      ///< null: by step_s_
    double step_s_ = 0.0;
    std::vector<std::optional<double>> values_;  ///< a column each
    std::optional<double> line_s_;               ///< SCLK of a line that is not written yet
};

}  // namespace aeolis::server
