// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/kernel/outbox.hpp"
#include "flight/kernel/parameter_parts.hpp"
#include "flight/load.hpp"
#include "flight/timeline/timepoint.hpp"

#include <optional>
#include <span>

namespace aeolis::flight {

/// Chooses the tone that the X-band transmitter sends.
///
/// In      ToneRequest, PhaseChanged, StandBy, ParameterPart, ClockTick (64 Hz)
/// Out     the transmitter's tone; ToneSelected; Explanation; ToneStatus
/// Memory  64 outstanding requests; when full the least important is dropped and reported (MFSK_REQUESTS_FULL)
/// Rule    the most important request first; among equals, the newest. A request older than its tone's age limit is
///         dropped, and so is one that a newer event supersedes (tones.csv: supersedes). R31
/// Why     each drop, and each choice between several requests, is explained by its values: age and limit, the tone
///         that superseded it, or, without room, both priorities. R38
/// Backup  in Second Chance each request is for the tone with the same meaning in its own set. R35
/// Pause   with no request outstanding, the carrier is sent without a tone, and after heartbeat_after_s of that the
///         heartbeat of the phase, if the phase has one (tones.csv: heartbeat_PHASE). R31
class ToneSelector {
  public:
    explicit ToneSelector(const Load& load, std::span<const ToneSpec> tones = tone_specs)
        : parameters_(load.parameters), tones_(tones), role_(load.role) {}

    void on(const ToneRequest& request, Outbox& out);
    void on(const PhaseChanged& change, Outbox& out);
    void on(const ClockTick& tick, Outbox& out);
    void on(const StandBy& stand_by, Outbox& out);
    void on(const ParameterPart& part, Outbox& out);

  private:
    struct Sending {
        ToneId tone;
        Sclk started;
    };

    void send(const ToneRequest& request, Outbox& out);
    std::optional<ToneId> own(ToneId tone) const;
    void drop_expired(Sclk now, Outbox& out);
    void drop_overtaken(ToneId overtaken, ToneId by, Outbox& out);
    void refuse_or_make_room(const ToneRequest& request, Outbox& out);
    void explain_choice(const ToneRequest& chosen, Outbox& out) const;
    std::size_t most_important() const;
    std::size_t least_important() const;
    std::int16_t priority(ToneId tone) const { return tones_[tone.value].priority; }
    double expires_s(ToneId tone) const { return tones_[tone.value].expires_s; }

    ReceivedParameters parameters_;
    std::span<const ToneSpec> tones_;
    Role role_;
    FixedVector<ToneRequest, 64> outstanding_;
    std::optional<Sending> sending_;
    std::optional<ToneId> heartbeat_;  ///< of the phase, in the set of this computer
    Sclk quiet_since_;                 ///< when the last tone ended
    bool silent_ = false;
};

}  // namespace aeolis::flight
