// SPDX-License-Identifier: Apache-2.0
#include "flight/timeline/change_guard.hpp"

#include "generated/dictionary_flight.hpp"

namespace aeolis::flight {
namespace {

/// The timeline on board, in the form that the rule reads.
class OnBoard {
  public:
    OnBoard(const Timeline& timeline, std::span<const ConstraintSpec> constraints)
        : timeline_(timeline), constraints_(constraints) {}

    std::size_t rows() const { return timeline_.rows().size(); }
    timeline::Offsets offsets(std::size_t row) const { return timeline_.offsets(row); }
    std::optional<double> reply_timeout_s(std::size_t row) const { return timeline_.rows()[row].reply_timeout_s; }
    bool is_essential(std::size_t row) const { return timeline_.rows()[row].essential; }
    std::size_t anchors() const { return timeline_.anchors().size(); }
    std::optional<AnchorId> parent(std::size_t anchor) const { return timeline_.anchors()[anchor].parent; }
    MaybeOffset anchor_offset_s(std::size_t anchor) const { return timeline_.anchor_offset_s(anchor); }
    /// An anchor that the design leaves undefined is GNC's, except entry, which ground sets.
    bool is_decided_in_flight(std::size_t anchor) const {
        const AnchorSpec& spec = timeline_.anchors()[anchor];
        return spec.parent && !spec.offset_s && anchor != anchor::entry.value;
    }
    std::span<const ConstraintSpec> constraints() const { return constraints_; }

  private:
    const Timeline& timeline_;
    std::span<const ConstraintSpec> constraints_;
};

}  // namespace

void ChangeGuard::watch(const Timeline& timeline, std::span<const Firing> firings) {
    for (const Firing& firing : firings) {
        known_.triggered[firing.timepoint.value] = firing.triggered;
        known_.fired[firing.timepoint.value] = firing.fired;
    }
    if (const auto waiting = timeline.waiting()) known_.triggered[timeline.current().value] = waiting->triggered;
}

std::optional<timeline::Unsafe> ChangeGuard::judge(const Timeline& timeline, const timeline::Change& change, Sclk now) {
    before_ = after_ = known_;
    const timeline::Standing standing{.now = now,
                                      .current = timeline.current().value,
                                      .waiting = timeline.waiting().has_value(),
                                      .previous_fired = timeline.previous_fired()};
    return timeline::unsafe_change(OnBoard{timeline, constraints_}, change, standing, before_, after_);
}

}  // namespace aeolis::flight
