// SPDX-License-Identifier: Apache-2.0
#include "server/api/stream_hub.hpp"

#include "server/api/stream_session.hpp"
#include "server/base/json.hpp"

#include <algorithm>
#include <cmath>
#include <ranges>
#include <utility>

namespace aeolis::server {
namespace {

// Chosen: above this pace a client's rate also counts against the wall clock; at 100 × it would else receive 100 times
// as much.
constexpr double pace_without_further_thinning = 8.0;

constexpr std::size_t sessions_ahead = 4;  // chosen
constexpr double seconds_per_us = 1e-6;

/// The factor by which a client's intervals of vehicle time are longer at this pace.
float stretch_of(const v1::RunState& state) {
    return static_cast<float>(std::max(1.0, state.attained_pace() / pace_without_further_thinning));
}

/// Whether a sample at `time_s` begins a new interval after the previous sample.
bool begins_interval(double time_s, std::optional<double> previous_s, double interval_s) {
    return !previous_s || std::floor(time_s / interval_s) != std::floor(*previous_s / interval_s);
}

/// Calls `visit` with the place of each of the samples that is of the given channels, which ascend, until it returns
/// false. Where the ids ascend too, whole stretches of either that the other lacks are passed over.
template <typename Visit>
void each_chosen(const v1::Samples& samples, const std::vector<std::uint32_t>& channels, bool ascend, Visit visit) {
    const auto& ids = samples.ids();
    if (!ascend) {
        for (int i = 0; i < ids.size(); ++i)
            if (std::ranges::binary_search(channels, ids[i]) && !visit(i)) return;
        return;
    }
    auto id = ids.begin();
    auto channel = channels.begin();
    while (id != ids.end() && channel != channels.end()) {
        if (*id < *channel) {
            id = std::lower_bound(id, ids.end(), *channel);
        } else if (*channel < *id) {
            channel = std::lower_bound(channel, channels.end(), *id);
        } else {
            if (!visit(static_cast<int>(id - ids.begin()))) return;
            ++id;
            ++channel;
        }
    }
}

v1::Samples some_of(const v1::Samples& samples, const std::vector<std::uint32_t>& channels, bool ascend) {
    v1::Samples chosen;
    for (const auto& exact : samples.exact())
        if (std::ranges::binary_search(channels, exact.id())) *chosen.add_exact() = exact;
    each_chosen(samples, channels, ascend, [&](int i) {
        chosen.add_ids(samples.ids(i));
        chosen.add_values(samples.values(i));
        return true;
    });
    return chosen;
}

bool has_any(const v1::Samples& samples, const std::vector<std::uint32_t>& channels, bool ascend) {
    bool any = false;
    each_chosen(samples, channels, ascend, [&](int) {
        any = true;
        return false;
    });
    return any;
}

/// Tells packets apart by all of their channels, and their source, because packets of other missions share the channels
/// of their headers. (FNV-1a)
std::uint64_t packet_of(const v1::Samples& samples) {
    std::uint64_t hash = 14695981039346656037ULL;
    const auto add = [&](std::uint64_t value) { hash = (hash ^ value) * 1099511628211ULL; };
    add(static_cast<std::uint64_t>(samples.source()));
    for (const auto id : samples.ids()) add(id);
    return hash;
}

RatedItem rated(const ItemWithFacts& given, double interval_s) {
    const auto& [item, facts] = given;
    if (!item->has_samples() || interval_s <= 0.0) return {item, false, false, facts.ascend, facts.packet};
    const double now_s = interval_s * facts.stretch, before_s = interval_s * facts.previous_stretch;
    const bool due = begins_interval(facts.time_s, facts.previous_s, now_s);
    const bool whole =
        facts.previous_s ? begins_interval(*facts.previous_s, facts.before_previous_s, before_s) : facts.first;
    return {item, !due, !whole, facts.ascend, facts.packet};
}

std::vector<RatedItem> at_rate(std::span<const ItemWithFacts> items, double interval_s, bool packets) {
    std::vector<RatedItem> given;
    given.reserve(items.size());
    for (const auto& each : items) {
        const auto& item = *each.item;
        if (item.has_unit() && (!packets || item.unit().source() == v1::SOURCE_RECORDED)) continue;
        given.push_back(rated(each, interval_s));
    }
    return given;
}

/// The items with the first of each of these packets as thinned, and those packets removed; none: it has none of them.
std::optional<std::vector<RatedItem>> with_left_out(std::span<const RatedItem> items, LeftOutBefore& packets) {
    std::optional<std::vector<RatedItem>> changed;
    for (std::size_t i = 0; i < items.size() && !packets.empty(); ++i) {
        if (items[i].packet == 0 || std::erase(packets, items[i].packet) == 0) continue;
        if (!changed) changed.emplace(items.begin(), items.end());
        (*changed)[i].thinned = true;
    }
    return changed;
}

/// Adds what goes out to the batch, and what does not to its left_out.
void add_items(const StreamSelection& selection, std::span<const RatedItem> items, v1::Batch& batch) {
    std::uint64_t left_out_count = 0;
    for (const auto& [item, left_out, thinned, ascend, packet] : items) {
        if (left_out) {
            left_out_count += selection.all_channels || has_any(item->samples(), selection.channels, ascend) ? 1 : 0;
            continue;
        }
        if (!item->has_samples() || selection.all_channels) {
            *batch.add_items() = *item;
        } else {
            const auto& samples = item->samples();
            auto chosen = some_of(samples, selection.channels, ascend);
            if (chosen.ids_size() == 0) continue;
            chosen.set_sclk(samples.sclk());
            chosen.set_source(samples.source());
            chosen.set_sclk_by_reception(samples.sclk_by_reception());
            auto& added = *batch.add_items();
            added.set_seq(item->seq());
            added.set_ert_us(item->ert_us());
            *added.mutable_samples() = std::move(chosen);
        }
        if (item->has_samples()) batch.mutable_items()->rbegin()->mutable_samples()->set_thinned(thinned);
    }
    batch.set_left_out(batch.left_out() + left_out_count);
}

}  // namespace

Encoded encode(const v1::ServerMessage& message, StreamFormat format) {
    return std::make_shared<const std::string>(format == StreamFormat::json ? to_json(message)
                                                                            : message.SerializeAsString());
}

void select_items(const StreamSelection& selection, double interval_s, std::span<const ItemWithFacts> items,
                  v1::Batch& batch) {
    add_items(selection, at_rate(items, interval_s, selection.packets), batch);
}

SampleFacts SampleSpacing::next(const v1::Item& item, float stretch) {
    SampleFacts facts;
    if (!item.has_samples() || item.samples().ids_size() == 0) return facts;
    const auto& samples = item.samples();
    facts.time_s = by_ == RateBy::vehicle ? samples.sclk() : static_cast<double>(item.ert_us()) * seconds_per_us;
    facts.stretch = stretch;
    facts.first = from_start_;
    facts.ascend = std::ranges::is_sorted(samples.ids());
    const std::uint64_t packet = packet_of(samples);
    facts.packet = packet;
    const auto last = std::ranges::find(last_, packet, &Last::packet);
    if (last == last_.end()) {
        last_.push_back({packet, facts.time_s, std::nullopt, stretch});
        return facts;
    }
    facts.previous_s = last->time_s;
    facts.before_previous_s = last->previous_s;
    facts.previous_stretch = last->stretch;
    *last = {packet, facts.time_s, facts.previous_s, stretch};
    return facts;
}

void SampleSpacing::add_left_out(double interval_s, LeftOutBefore& packets) const {
    for (const auto& last : last_) {
        std::erase(packets, last.packet);
        if (interval_s > 0.0 && !begins_interval(last.time_s, last.previous_s, interval_s * last.stretch))
            packets.push_back(last.packet);
    }
}

StreamHub::StreamHub(std::uint16_t dictionary_id, Services services)
    : dictionary_id_(dictionary_id), services_(std::move(services)), spacing_(true, services_.rate_by) {}

void StreamHub::published(std::shared_ptr<const pipeline::PublishedBatch> batch) {
    if (batch->run.value != state_.run()) return;  // a run's state is published before its first batch
    figures.items += batch->last_seq - batch->first_seq + 1;
    last_seq_ = batch->last_seq;
    range_.reset();  // it points to items that may be removed
    if (!batch->built) {
        forget_items();
    } else {
        Held held{std::move(batch), {}};
        held.facts.reserve(held.batch->items.size());
        for (const auto& item : held.batch->items) held.facts.push_back(spacing_.next(item, stretch_of(state_)));
        held_items_ += held.batch->items.size();
        held_.push_back(std::move(held));
        while (held_items_ > items_max) {
            held_items_ -= held_.front().batch->items.size();
            held_.pop_front();
        }
    }
    wake_all();
}

void StreamHub::forget_items() {
    range_.reset();
    held_.clear();
    held_items_ = 0;
    spacing_ = SampleSpacing{last_seq_ == 0, services_.rate_by};
}

void StreamHub::run_state(v1::RunState state) {
    if (state.run() != state_.run()) {
        previous_run_state_ = std::move(state_);
        previous_run_state_.set_last_seq(last_seq_);
        previous_run_state_version_ = state_version_;
        last_seq_ = state.last_seq();  // of a finished run, from the archive; of a new one 0
        forget_items();
        cache_.clear();
        clocks_ = state.clocks();  // those of the run before are not this one's; the state tells of them
    }
    state_ = std::move(state);
    state_.set_last_seq(last_seq_);
    add_own(state_);
    ++state_version_;
    wake_all();
}

/// What this server knows of itself.
void StreamHub::add_own(v1::RunState& state) const {
    state.set_archive_fault(archive_fault_);
    state.set_follows(standing_.follows);
    state.set_origin_lost(standing_.origin_lost);
    state.set_unpublished(standing_.unpublished);
}

void StreamHub::archive_fault(std::string fault) {
    archive_fault_ = std::move(fault);
    add_own(state_);
    ++state_version_;
    wake_all();
}

void StreamHub::standing(Standing standing) {
    if (standing == standing_) return;
    standing_ = std::move(standing);
    add_own(state_);
    ++state_version_;
    wake_all();
}

std::optional<Ert> StreamHub::ert_now() const {
    return clocks_.has_ert_us() ? std::optional{Ert{clocks_.ert_us()}} : std::nullopt;
}

void StreamHub::clocks(v1::Clocks clocks) {
    clocks_ = std::move(clocks);
    ++clocks_version_;
    wake_all();
}

void StreamHub::add(StreamSession& session) {
    sessions_.push_back(&session);
    services_.want_items(true);
}

void StreamHub::check_clients() {
    for (auto* session : sessions_) session->check();
}

void StreamHub::remove(StreamSession& session) {
    std::erase(sessions_, &session);
    if (sessions_.empty()) services_.want_items(false);
}

std::size_t StreamHub::sessions_behind() const {
    return static_cast<std::size_t>(
        std::ranges::count_if(sessions_, [](const auto* session) { return session->behind(); }));
}

std::size_t StreamHub::sessions_replaying() const {
    return static_cast<std::size_t>(
        std::ranges::count_if(sessions_, [](const auto* session) { return session->replays(); }));
}

void StreamHub::wake_all() {
    for (std::size_t i = 0; i < sessions_.size(); ++i) {
        if (i + sessions_ahead < sessions_.size())
            __builtin_prefetch(sessions_[i + sessions_ahead]);  // sends evict the sessions from the cache
        sessions_[i]->wake();
    }
}

bool StreamHub::holds(archive::Sequence after) const {
    if (after >= last_seq_) return true;
    return !held_.empty() && held_.front().batch->first_seq <= after + 1;
}

const StreamHub::Range& StreamHub::range_after(archive::Sequence after, double interval_s, bool packets) {
    if (range_ && range_->after == after && range_->last_seq == last_seq_ && range_->interval_s == interval_s &&
        range_->packets == packets)
        return *range_;
    std::vector<ItemWithFacts> items;
    const auto last_of = [](const Held& held) { return held.batch->last_seq; };
    for (auto held = std::ranges::upper_bound(held_, after, {}, last_of);
         held != held_.end() && items.size() < message_items_max; ++held) {
        for (std::size_t i = 0; i < held->batch->items.size() && items.size() < message_items_max; ++i)
            if (held->batch->items[i].seq() > after) items.push_back({&held->batch->items[i], held->facts[i]});
    }
    return range_.emplace(Range{after, last_seq_, items.empty() ? last_seq_ : items.back().item->seq(), interval_s,
                                packets, at_rate(items, interval_s, packets)});
}

StreamHub::EncodedRange StreamHub::encoded_range(const StreamSelection& selection, archive::Sequence after,
                                                 archive::Sequence sent_through, std::uint64_t left_out,
                                                 LeftOutBefore& left_out_before) {
    if (!left_out_before.empty()) {
        const auto& range = range_after(after, selection.interval_s(), selection.packets);
        if (const auto items = with_left_out(range.items, left_out_before))
            return encode_range(selection, range, *items, sent_through, left_out);
    }
    for (const auto& cached : cache_ | std::views::reverse) {  // the newest is requested most
        if (cached.after == after && cached.sent_through == sent_through && cached.left_out == left_out &&
            cached.last_seq == last_seq_ && cached.clocks_version == clocks_version_ && cached.selection == selection) {
            ++figures.shared;
            return cached.encoded;
        }
    }
    const auto& range = range_after(after, selection.interval_s(), selection.packets);
    auto encoded = encode_range(selection, range, range.items, sent_through, left_out);
    cache_.push_back({selection, after, sent_through, last_seq_, left_out, clocks_version_, encoded});
    if (cache_.size() > shared_encodings) cache_.pop_front();
    return encoded;
}

StreamHub::EncodedRange StreamHub::encode_range(const StreamSelection& selection, const Range& range,
                                                std::span<const RatedItem> items, archive::Sequence sent_through,
                                                std::uint64_t left_out) {
    ++figures.encodings;
    EncodedRange encoded;
    encoded.through = range.through;
    v1::ServerMessage message;
    auto& batch = *message.mutable_batch();
    batch.set_left_out(left_out);
    add_items(selection, items, batch);
    encoded.left_out = batch.left_out();
    if (batch.items_size() == 0) return encoded;
    batch.set_run(state_.run());
    batch.set_after_seq(sent_through);
    batch.set_complete_through(encoded.through);
    *batch.mutable_clocks() = clocks_;
    encoded.message = encode(message, selection.format);
    return encoded;
}

Encoded StreamHub::encoded_state(StreamFormat format) {
    if (state_encoded_version_ != state_version_) {
        state_encoded_ = {};
        state_encoded_version_ = state_version_;
    }
    auto& encoded = state_encoded_[static_cast<std::size_t>(format)];
    if (!encoded) {
        v1::ServerMessage message;
        *message.mutable_run_state() = state_;
        encoded = encode(message, format);
    }
    return encoded;
}

}  // namespace aeolis::server
