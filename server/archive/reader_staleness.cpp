// SPDX-License-Identifier: Apache-2.0
#include "server/archive/reader_state.hpp"
#include "telemetry/staleness.hpp"

#include <optional>

namespace aeolis::archive {
namespace {

constexpr char times_sql[] = "SELECT packet, sclk, source FROM packets WHERE key BETWEEN ?1 AND ?2 AND sampled = 1 AND "
                             "EXISTS (SELECT 1 FROM recordings"
                             " WHERE run = ?3 AND recorded > 0) ORDER BY packet, sclk";

/// The stretches of one packet, whose times are added in order. Between two that came live the recording may not be
/// down yet, and the link's plan counts.
class Stretches {
  public:
    struct After {
        double live_s = 0.0, recorded_s = 0.0;
    };
    Stretches(v1::PacketStaleness& packet, After after, double first_s)
        : packet_(&packet), after_(after), last_s_(first_s) {}

    void add(double sclk_s, bool recorded) {
        const double after_s = recorded || last_recorded_ ? after_.recorded_s : after_.live_s;
        if (sclk_s - last_s_ > after_s) stale_from(last_s_ + after_s).set_to_sclk(sclk_s);
        last_s_ = sclk_s;
        last_recorded_ = recorded;
    }
    /// After the last packet none has come.
    void end() { stale_from(last_s_ + (last_recorded_ ? after_.recorded_s : after_.live_s)); }

  private:
    v1::StaleStretch& stale_from(double sclk_s) {
        auto& stretch = *packet_->add_stretches();
        stretch.set_from_sclk(sclk_s);
        return stretch;
    }

    v1::PacketStaleness* packet_;
    After after_;
    double last_s_;
    bool last_recorded_ = false;
};

}  // namespace

Result<v1::RecordedStaleness> Reader::recorded_staleness(RunId run) {
    const auto instant = state_->instant(run);
    if (!instant) return instant.error();
    if (auto same = state_->same_dictionary(instant->run); !same) return same.error();
    v1::RecordedStaleness report;
    auto rows = state_->query(times_sql);
    if (!rows) return rows.error();
    (*rows)->bind(1, item_key(run, 0)).bind(2, item_key(run, sequence_max)).bind(3, std::int64_t{run.value});
    std::optional<Stretches> stretches;
    std::int64_t of = -1;
    for (;;) {
        const auto found = (*rows)->step();
        if (!found) return found.error();
        if (!*found) break;
        const double sclk_s = (*rows)->real(1);
        if (const auto packet = (*rows)->integer(0); packet != of) {
            if (stretches) stretches->end();
            stretches.reset();
            of = packet;
            const auto index = static_cast<std::size_t>(packet);
            const auto live_s = telemetry::stale_after_s(state_->dictionary, index);
            if (const auto after_s = telemetry::stale_in_recording_after_s(state_->dictionary, index);
                after_s && live_s) {
                auto& added = *report.add_packets();
                added.set_packet(state_->dictionary.packets[index].name);
                added.set_stale_after_s(*after_s);
                stretches.emplace(added, Stretches::After{*live_s, *after_s}, sclk_s);
            }
        }
        if (stretches) stretches->add(sclk_s, (*rows)->integer(2) == static_cast<std::int64_t>(Source::recorded));
    }
    if (stretches) stretches->end();
    return report;
}

}  // namespace aeolis::archive
