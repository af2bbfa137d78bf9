#pragma once

#include "common/time.hpp"
#include "dictionaries/dictionary.hpp"

#include <array>
#include <string>
#include <vector>

namespace aeolis::telemetry {

struct AlarmChange {
    ChannelId channel;
    dictionary::Severity severity{}; ///< none: cleared
    dictionary::Severity before{};
    double value = 0.0;
    Sclk sclk;
    std::string limit; ///< what the value broke: "> 14.5 g", "= failed"; empty when cleared
};
const char* name_of(dictionary::Severity severity);

/// Tells when a channel goes into, out of, or from one to another severity of alarm.
///
/// In       samples of each channel in the order of SCLK, one source only (real time, or the recording)
/// Out      changes, appended to `out`
/// Rule     a severity stands when the last `min_violations` samples all were at least that severe; one sample within
///          the limits clears. [xtce-1.2] MinViolations
/// Memory   32 octets a channel, made at the start
class AlarmMonitor {
  public:
    /// The dictionary must outlive this.
    explicit AlarmMonitor(const dictionary::Dictionary& dictionary);

    void sample(ChannelId channel, double value, Sclk sclk, std::vector<AlarmChange>& out);

    dictionary::Severity severity(ChannelId channel) const;

  private:
    static constexpr std::size_t severities = 6;
    struct State {
        std::array<std::uint32_t, severities> in_a_row{}; ///< samples at least this severe, up to the last
        dictionary::Severity now = dictionary::Severity::none;
    };
    const dictionary::Dictionary& dictionary_;
    std::vector<State> states_;
};

} // namespace aeolis::telemetry
