// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"
#include "dictionaries/dictionary.hpp"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace aeolis::telemetry {

struct AlarmChange {
    ChannelId channel;
    dictionary::Severity severity{};  ///< none: cleared
    dictionary::Severity before{};
    double value = 0.0;
    Sclk sclk;
    std::string limit;  ///< the limit violated: "> 14.5 g", "= failed", "> 1.5 m/s in sky_crane"; empty when cleared
};
const char* name_of(dictionary::Severity severity);
/// "sky_crane" for a condition on one state of one channel; else the conditions in words.
std::string context_text(const dictionary::Dictionary& dictionary,
                         const std::vector<dictionary::Precondition>& context);
/// The first context that holds by the latest values; null: none holds, and the limits without a context apply. The
/// values are indexed by ChannelId.
const dictionary::ContextAlarms* context_in_force(const dictionary::Alarms& alarms,
                                                  const std::vector<std::optional<double>>& latest);
/// Whether an alarm of the channel, in any context, latches until it is reset.
bool latches(const dictionary::Alarms& alarms);

/// Detects when a channel enters or leaves alarm, and when the severity of its alarm changes.
///
/// In       samples of each channel in the order of reception, from one source only (real time, or the recording)
/// Out      changes, appended to `out`
/// Rule     A severity is raised when `min_violations` consecutive samples were at least that severe, and cleared when
///          `min_conformance` consecutive samples were less severe. [xtce-1.2] minViolations, minConformance. The
///          limits are those of the first context that holds by the latest values of the channels it compares, else
///          the defaults. Counting restarts when the context changes.
/// Memory   64 octets a channel, made at the start
class AlarmMonitor {
  public:
    /// The dictionary must outlive this.
    explicit AlarmMonitor(const dictionary::Dictionary& dictionary);

    void sample(ChannelId channel, double value, Sclk sclk, std::vector<AlarmChange>& out);

    dictionary::Severity severity(ChannelId channel) const;

  private:
    static constexpr std::size_t severities = 6;
    struct Level {
        std::uint32_t violations = 0,
                      conformances = 0;  ///< consecutive latest samples, at least this severe or less
        bool stands = false;
    };
    struct State {
        std::array<Level, severities> levels{};
        const dictionary::ContextAlarms* context = nullptr;  ///< none: the default limits
        dictionary::Severity now = dictionary::Severity::none;
    };
    const dictionary::Dictionary& dictionary_;
    std::vector<State> states_;
    std::vector<std::optional<double>> latest_;  ///< by channel
};

}  // namespace aeolis::telemetry
