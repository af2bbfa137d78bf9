// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"
#include "dictionaries/dictionary.hpp"
#include "server/procedures/procedure.hpp"
#include "server/procedures/received_facts.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

namespace aeolis::server::procedures {

/// The instant on Earth's clock.
Ert instant_of(const EntryTime& time, const EntryPrediction& prediction);

enum class Verdict : std::uint8_t { holds, does_not_hold, not_known };
std::string_view name_of(Verdict verdict);

/// Whether a condition holds, and by what.
struct ConditionState {
    Verdict verdict = Verdict::not_known;
    std::string evidence;  ///< "altitude_m is 4987.25 m, received 2012-219T05:14:02.100"
    bool operator==(const ConditionState&) const = default;
};

/// Whether every condition is known to hold; of none, yes.
bool all_hold(const std::vector<ConditionState>& states);

/// Judges conditions by what Earth has received, and by nothing else.
///
/// In      live samples and events in the order of their receipt, the predicted entry, Earth's clock. What a recording
///         brings later is of the past and is not given here
/// Out     a verdict for each condition. A channel that was never heard, is undefined on board, or whose last value is
///         older than commands::stale_after_s is *not known*: neither true nor false
/// For     "for 3 s" is counted from receipt to receipt: it holds once the samples of 3 s, none of them more than
///         stale_after_s apart, all compare so
/// Memory  by its conditions: nothing grows with what is received
class ConditionWatch {
  public:
    explicit ConditionWatch(const dictionary::Dictionary& dictionary) : dictionary_(&dictionary) {}

    /// Adds a condition, before anything is received. @return its number
    std::size_t add(const Condition& condition);

    /// Takes what was received before, once all conditions are added. "For 3 s" counts from the newest of it.
    void know(const ReceivedFacts& before);

    /// @return whether a condition asks for this channel
    bool on(const ChannelSample& sample);
    /// @return whether a condition asks for this event
    bool on(const EventReceived& event);
    void predict(const EntryPrediction& prediction) { prediction_ = prediction; }
    const std::optional<EntryPrediction>& prediction() const { return prediction_; }
    /// Earth's clock; an earlier time than before changes nothing.
    void pass(Ert now);
    Ert now() const { return now_; }

    /// @param since  what was received counts from here; none: from the beginning
    ConditionState judge(std::size_t condition, std::optional<Ert> since) const;

  private:
    /// The newest of a channel, and since when each comparison has held without a gap.
    struct Newest {
        std::optional<double> value;
        Ert received;
    };
    struct Watched {
        Condition condition;
        std::optional<Ert> held_since;  ///< of a channel: receipt of the first of the samples in a row that compare so
    };
    ConditionState judge_channel(const Watched& watched, const ChannelCondition& condition,
                                 std::optional<Ert> since) const;
    ConditionState judge_event(const EventCondition& condition, std::optional<Ert> since) const;
    ConditionState judge_time(const TimeCondition& condition) const;

    const dictionary::Dictionary* dictionary_;
    std::vector<Watched> watched_;
    std::unordered_map<ChannelId, std::vector<std::size_t>> by_channel_;
    std::unordered_map<ChannelId, Newest> heard_;           ///< of the channels in conditions
    std::unordered_map<EvrId, std::optional<Ert>> events_;  ///< of the events in conditions: the last receipt
    std::optional<EntryPrediction> prediction_;
    Ert now_;
};

}  // namespace aeolis::server::procedures
