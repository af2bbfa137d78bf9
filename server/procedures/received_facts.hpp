// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/ids.hpp"
#include "common/time.hpp"

#include <optional>
#include <unordered_map>

namespace aeolis::server::procedures {

/// A live sample of a channel as it reached Earth.
struct ChannelSample {
    ChannelId channel;
    std::optional<double> value;  ///< none: undefined on board
    Ert received;
};
struct EventReceived {
    EvrId event;
    Ert received;
};
/// When the vehicle is predicted to enter, and how far it is.
struct EntryPrediction {
    Scet entry;
    double light_time_s = 0.0;
};

/// The newest of what a run's ground has received, so that a procedure begun later knows it too.
///
/// In      live samples and events in the order of their receipt. What a recording brings later is of the past and is
///         not given here
/// Memory  by the dictionary: a sample for each channel, a time for each event
class ReceivedFacts {
  public:
    void on(const ChannelSample& sample) { latest_[sample.channel] = sample; }
    void on(const EventReceived& event) { events_[event.event] = event.received; }
    void predict(const EntryPrediction& prediction) { prediction_ = prediction; }

    const std::unordered_map<ChannelId, ChannelSample>& latest() const { return latest_; }
    /// By event: its last receipt.
    const std::unordered_map<EvrId, Ert>& events() const { return events_; }
    const std::optional<EntryPrediction>& prediction() const { return prediction_; }

  private:
    std::unordered_map<ChannelId, ChannelSample> latest_;
    std::unordered_map<EvrId, Ert> events_;
    std::optional<EntryPrediction> prediction_;
};

}  // namespace aeolis::server::procedures
