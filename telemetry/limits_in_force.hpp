// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"
#include "dictionaries/dictionary.hpp"

#include <optional>
#include <vector>

namespace aeolis::telemetry {

/// The limits of a channel from an instant on.
struct LimitStretch {
    std::optional<Sclk> from;                            ///< none: from the beginning
    const dictionary::ContextAlarms* context = nullptr;  ///< null: the limits without a context
};

/// Finds which alarm limits of each channel were in force when, by the rule of AlarmMonitor.
///
/// In       samples of the channels in decided_by(), by time
/// Out      the stretches of each channel whose limits have contexts; neighbours differ
/// Memory   a stretch a change; the dictionary must outlive this
class LimitsInForce {
  public:
    explicit LimitsInForce(const dictionary::Dictionary& dictionary);

    /// The channels that the contexts compare, by number.
    const std::vector<ChannelId>& decided_by() const { return decided_by_; }

    /// Takes a sample. NaN stands for undefined on board, and decides nothing.
    void sample(ChannelId channel, double value, Sclk sclk);

    struct OfChannel {
        ChannelId channel;
        std::vector<LimitStretch> stretches;  ///< one at least
    };
    const std::vector<OfChannel>& channels() const { return channels_; }

  private:
    const dictionary::Dictionary& dictionary_;
    std::vector<ChannelId> decided_by_;
    std::vector<OfChannel> channels_;
    std::vector<std::optional<double>> latest_;  ///< by channel
};

}  // namespace aeolis::telemetry
