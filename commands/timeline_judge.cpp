// SPDX-License-Identifier: Apache-2.0
#include "commands/timeline_judge.hpp"

#include "dictionaries/analysis/timeline_analysis.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace aeolis::commands {
namespace {

using timeline::Moment;
using timeline::Unsafe;

// Names in the dictionary: flight's reports about its timeline, and the bounds that both judges use.
constexpr std::string_view status_packet = "TimelineStatus", firing_packet = "TimepointFired";
constexpr double waiting_reply = 2.0;  // TimepointState
constexpr std::string_view anchor_report_end = "_anchor_sclk";
constexpr std::string_view entry_moved_max = "entry_moved_max_s", begin_margin = "do_edl_margin_s";

std::optional<std::size_t> index_of(const dictionary::Dictionary& dictionary, const dictionary::Packet* packet) {
    if (packet == nullptr) return std::nullopt;
    return static_cast<std::size_t>(packet - dictionary.packets.data());
}

/// The value of a field that the packet's definition may lack.
std::optional<double> value_of(const dictionary::Decoded& packet, std::optional<std::size_t> field) {
    return field ? packet.value[*field] : std::nullopt;
}

}  // namespace

/// The timeline as ground knows it, in the form that the rule reads.
class TimelineJudge::Plan {
  public:
    explicit Plan(const TimelineJudge& judge) : judge_(judge) {}

    std::size_t rows() const { return judge_.offsets_.size(); }
    timeline::Offsets offsets(std::size_t row) const { return judge_.offsets_[row]; }
    std::optional<double> reply_timeout_s(std::size_t row) const {
        return judge_.dictionary_->timeline[row].reply_timeout_s;
    }
    bool is_essential(std::size_t row) const { return judge_.dictionary_->timeline[row].essential; }
    std::size_t anchors() const { return judge_.anchor_offsets_.size(); }
    std::optional<AnchorId> parent(std::size_t anchor) const { return judge_.dictionary_->anchors[anchor].parent; }
    MaybeOffset anchor_offset_s(std::size_t anchor) const { return judge_.anchor_offsets_[anchor]; }
    bool is_decided_in_flight(std::size_t anchor) const { return judge_.is_decided_in_flight(anchor); }
    const auto& constraints() const { return judge_.dictionary_->constraints; }

  private:
    const TimelineJudge& judge_;
};

TimelineJudge::TimelineJudge(const dictionary::Dictionary& dictionary)
    : dictionary_(&dictionary), status_(status_fields()), firing_(firing_fields()) {
    if (dictionary.timeline.size() > timeline::rows_max || dictionary.anchors.size() > timeline::anchors_max) return;
    for (const auto& row : dictionary.timeline) offsets_.push_back(timeline::offsets_of(row));
    for (const auto& anchor : dictionary.anchors) {
        anchor_offsets_.push_back(anchor.offset_s);
        if (anchor.name == "entry") entry_ = anchor.id;
    }
}

TimelineJudge::StatusFields TimelineJudge::status_fields() const {
    StatusFields fields;
    const auto* packet = dictionary_->packet(status_packet);
    fields.packet = index_of(*dictionary_, packet);
    if (packet == nullptr) return fields;
    fields.current = field_index(*packet, "timepoint_index");
    fields.state = field_index(*packet, "timepoint_state");
    fields.next_minimum = field_index(*packet, "next_minimum_sclk");
    for (const auto& anchor : dictionary_->anchors) {
        if (!anchor.parent || dictionary_->anchors[anchor.parent->value].parent) continue;
        if (const auto field = field_index(*packet, anchor.name + std::string{anchor_report_end}))
            fields.anchors.emplace_back(anchor.id, *field);
    }
    return fields;
}

TimelineJudge::FiringFields TimelineJudge::firing_fields() const {
    const auto* packet = dictionary_->packet(firing_packet);
    if (packet == nullptr) return {};
    return {index_of(*dictionary_, packet), field_index(*packet, "timepoint"), field_index(*packet, "triggered_sclk"),
            field_index(*packet, "fired_sclk")};
}

bool TimelineJudge::is_decided_in_flight(std::size_t anchor) const {
    const auto& row = dictionary_->anchors[anchor];
    return row.parent && !row.offset_s && row.id != entry_;
}

void TimelineJudge::hear(const dictionary::Decoded& packet) {
    if (offsets_.empty()) return;
    if (packet.packet == status_.packet) hear_status(packet);
    if (packet.packet == firing_.packet) hear_firing(packet);
}

void TimelineJudge::hear_status(const dictionary::Decoded& packet) {
    const auto current = value_of(packet, status_.current);
    if (!current || !(*current >= 0.0 && *current <= static_cast<double>(offsets_.size()))) return;
    standing_.now = packet.header.time;
    standing_.current = static_cast<std::size_t>(*current);
    standing_.waiting = value_of(packet, status_.state) == waiting_reply && standing_.current < offsets_.size();
    if (standing_.waiting && !known_.triggered[standing_.current].defined())
        known_.triggered[standing_.current] = standing_.now;
    const auto minimum_sclk = value_of(packet, status_.next_minimum);
    if (minimum_sclk && standing_.current < offsets_.size())
        if (const auto& minimum_s = offsets_[standing_.current].minimum_s)
            standing_.previous_fired = Sclk{*minimum_sclk - *minimum_s};
    for (const auto& [anchor, field] : status_.anchors)
        if (const auto& sclk = packet.value[field]) anchor_offsets_[anchor.value] = *sclk;
}

void TimelineJudge::hear_firing(const dictionary::Decoded& packet) {
    const auto row = value_of(packet, firing_.timepoint), began = value_of(packet, firing_.triggered),
               ended = value_of(packet, firing_.fired);
    if (!row || !began || !ended || !(*row >= 0.0 && *row < static_cast<double>(offsets_.size()))) return;
    const auto id = static_cast<std::size_t>(*row);
    known_.triggered[id] = Sclk{*began};
    known_.fired[id] = Sclk{*ended};
    const auto& [anchor, desired_s, minimum_s, may_be_late] = offsets_[id];
    if (!may_be_late && anchor && desired_s && is_decided_in_flight(anchor->value) && !anchor_offsets_[anchor->value])
        anchor_offsets_[anchor->value] = *began - *desired_s;
    if (id < standing_.current) return;
    standing_ = {.now = std::max(standing_.now, Sclk{*ended}),
                 .current = id + 1,
                 .waiting = false,
                 .previous_fired = Sclk{*ended}};
}

void TimelineJudge::make(const timeline::Change& change) {
    if (const auto* of_timepoint = std::get_if<timeline::TimepointChange>(&change)) {
        if (of_timepoint->id.value >= offsets_.size()) return;
        offsets_[of_timepoint->id.value].desired_s = of_timepoint->desired_s;
        offsets_[of_timepoint->id.value].minimum_s = of_timepoint->minimum_s;
    } else if (const auto& of_anchor = std::get<timeline::AnchorChange>(change);
               of_anchor.id.value < anchor_offsets_.size()) {
        anchor_offsets_[of_anchor.id.value] = of_anchor.offset_s;
    }
}

void TimelineJudge::advance(Sclk to) {
    const bool begun = standing_.previous_fired.defined();
    if (begun && standing_.now < to) {
        timeline::Times ahead = known_;
        const Plan plan{*this};
        timeline::project(plan, standing_, timeline::Replies::at_once, nullptr, ahead);
        for (std::size_t& row = standing_.current; row < plan.rows(); ++row) {
            const auto& anchor = offsets_[row].anchor;
            const bool undecided = anchor && !anchor_offsets_[anchor->value];
            const auto& fires = ahead.fired[row].get();
            if (undecided || !fires || *fires >= to) break;
            known_.triggered[row] = ahead.triggered[row];
            known_.fired[row] = standing_.previous_fired = ahead.fired[row];
            standing_.waiting = false;
        }
    }
    standing_.now = std::max(standing_.now, to);
}

std::optional<Unsafe> TimelineJudge::judge(const timeline::Change& change, std::optional<Sclk> navigated_entry,
                                           std::optional<Sclk> arrives) const {
    if (offsets_.empty()) return std::nullopt;
    if (const auto* anchor = std::get_if<timeline::AnchorChange>(&change)) {
        if (is_decided_in_flight(anchor->id.value))
            return Unsafe{Unsafe::Why::decided_in_flight, Moment::of_anchor(anchor->id)};
        const auto most_s = parameter(entry_moved_max);
        if (anchor->id == entry_ && navigated_entry && anchor->offset_s && most_s)
            if (auto unsafe = timeline::unsafe_entry(anchor->id, Sclk{*anchor->offset_s}, *navigated_entry, *most_s))
                return unsafe;
    }
    if (!arrives) return std::nullopt;
    TimelineJudge then = *this;
    then.assume_entry(navigated_entry);
    then.advance(at_resolution(*arrives, 64));
    timeline::Times before = then.known_, after = then.known_;
    return timeline::unsafe_change(Plan{then}, change, then.standing_, before, after);
}

std::optional<double> TimelineJudge::begins_late_s(std::optional<Sclk> navigated_entry,
                                                   std::optional<Sclk> arrives) const {
    const auto margin_s = parameter(begin_margin);
    if (offsets_.empty() || !arrives || !margin_s) return std::nullopt;
    TimelineJudge then = *this;
    then.assume_entry(navigated_entry);
    if (!entry_ || !then.anchor_offsets_[entry_->value]) return std::nullopt;
    const Plan plan{then};
    timeline::Times times;
    timeline::project(plan, {.now = *arrives}, timeline::Replies::at_once, nullptr, times);
    const auto latest = timeline::latest_begin(
        plan.rows(), [&](std::size_t row) { return plan.offsets(row); },
        [&](std::size_t row) { return plan.reply_timeout_s(row); },
        [&](AnchorId anchor) { return times.anchors[anchor.value]; });
    if (!latest.defined() || *arrives < *latest.get() - *margin_s) return std::nullopt;
    return *arrives - (*latest.get() - *margin_s);
}

std::optional<double> TimelineJudge::parameter(std::string_view name) const {
    const auto& all = dictionary_->parameters;
    const auto found = std::ranges::find(all, name, &dictionary::ParameterRow::name);
    return found == all.end() ? std::nullopt : std::optional{found->default_value};
}

void TimelineJudge::assume_entry(std::optional<Sclk> navigated) {
    if (entry_ && navigated && !anchor_offsets_[entry_->value]) anchor_offsets_[entry_->value] = navigated->seconds;
}

std::string TimelineJudge::text(const Unsafe& unsafe) const {
    const std::string name = unsafe.what.kind == Moment::Kind::anchor ? dictionary_->anchors[unsafe.what.index].name
                                                                      : dictionary_->timeline[unsafe.what.index].name;
    const auto broken = [&](std::string_view how) {
        const auto& row = dictionary_->constraints[*unsafe.constraint];
        return fmt::format("{} would come {:.3f} s too {} after {} (constraints.csv:{}): {}", name, unsafe.by_s, how,
                           moment_text(*dictionary_, row.from), row.line, row.note.empty() ? row.source : row.note);
    };
    switch (unsafe.why) {
    case Unsafe::Why::decided_in_flight:
        return fmt::format("the anchor {} is decided in flight: no command moves it", name);
    case Unsafe::Why::not_navigated:
        return fmt::format("{} would be {:.3f} s {} than ground's navigation solution has it", name,
                           std::abs(unsafe.by_s), unsafe.by_s > 0.0 ? "later" : "earlier");
    case Unsafe::Why::triggered_already:
        return fmt::format("{} will have been triggered when the command arrives", name);
    case Unsafe::Why::overdue:
        return fmt::format("{} would be overdue by {:.3f} s when the command arrives, and fire at once", name,
                           unsafe.by_s);
    case Unsafe::Why::burst:
        return fmt::format("more than {} timepoints that the plan has apart would fire within a second, {} the last",
                           timeline::burst_rows_max, name);
    case Unsafe::Why::too_soon: return broken("soon");
    case Unsafe::Why::too_late: return broken("late");
    }
    return {};
}

}  // namespace aeolis::commands
