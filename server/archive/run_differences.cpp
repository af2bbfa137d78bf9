// SPDX-License-Identifier: Apache-2.0
#include "server/archive/run_differences.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace aeolis::archive {
namespace {

constexpr double window_s = 60.0;               // of channels compared at a time
constexpr double span_max_s = 14.0 * 86'400.0;  // chosen: twice the longest rehearsal
constexpr double same_time_s = 0.5 * seconds_per_tick;

/// Seconds from entry at which the runs part: where one is forked from the other, or both from a third.
std::optional<double> part_e_s(const v1::RunState& run, const v1::RunState& other) {
    const bool child = run.has_forked_from() && run.forked_from().run() == other.run();
    const bool parent = other.has_forked_from() && other.forked_from().run() == run.run();
    if (child) return run.forked_from().e_s();
    if (parent) return other.forked_from().e_s();
    if (run.has_forked_from() && other.has_forked_from() && run.forked_from().run() == other.forked_from().run())
        return std::min(run.forked_from().e_s(), other.forked_from().e_s());
    return std::nullopt;
}

struct Happened {
    double e_s = 0.0;
    std::string text;
};
using Key = std::pair<std::string, std::size_t>;  ///< a name, and its how many-eth

Result<std::map<Key, Happened>> events_of(Reader& reader, const v1::RunState& run, double from_e_s) {
    std::vector<std::pair<std::string, Happened>> all;
    EventQuery query;
    query.range.from_s = run.entry_sclk() + from_e_s;
    query.limit = rows_page_max;
    for (;;) {
        const auto page = reader.events(RunId{static_cast<std::uint32_t>(run.run())}, query);
        if (!page) return page.error();
        for (const auto& item : page->events())
            all.push_back({item.event().name(), {item.event().sclk() - run.entry_sclk(), item.event().text()}});
        if (page->next_after() == 0) break;
        query.after = page->next_after();
    }
    // In the order in which they happened: the recording tells of some later.
    std::ranges::stable_sort(all, {}, [](const auto& event) { return event.second.e_s; });
    std::map<std::string, std::size_t> seen;
    std::map<Key, Happened> by_key;
    for (auto& [name, event] : all) by_key.emplace(Key{name, ++seen[name]}, std::move(event));
    return by_key;
}

Result<std::map<Key, Happened>> timepoints_of(Reader& reader, const v1::RunState& run, double from_e_s) {
    const auto list = reader.timepoints(RunId{static_cast<std::uint32_t>(run.run())});
    if (!list) return list.error();
    std::map<Key, Happened> by_key;
    for (const auto& row : list->timepoints()) {
        if (!row.has_recorded_sclk() && !row.has_realtime_sclk()) continue;
        const double e_s = (row.has_recorded_sclk() ? row.recorded_sclk() : row.realtime_sclk()) - run.entry_sclk();
        if (e_s >= from_e_s) by_key.emplace(Key{row.name(), 1}, Happened{e_s, row.verdict()});
    }
    return by_key;
}

void add_differences(const std::map<Key, Happened>& one, const std::map<Key, Happened>& other,
                     google::protobuf::RepeatedPtrField<v1::EventDifference>& differences) {
    std::set<Key> keys;
    for (const auto* side : {&one, &other})
        for (const auto& [key, event] : *side) keys.insert(key);
    std::vector<std::pair<double, v1::EventDifference>> found;
    for (const auto& key : keys) {
        const auto a = one.find(key), b = other.find(key);
        const bool here = a != one.end(), there = b != other.end();
        if (here && there && std::abs(a->second.e_s - b->second.e_s) < seconds_per_tick &&
            a->second.text == b->second.text)
            continue;
        v1::EventDifference difference;
        difference.set_name(key.first);
        difference.set_occurrence(static_cast<std::uint32_t>(key.second));
        if (here) {
            difference.set_e_s(a->second.e_s);
            difference.set_text(a->second.text);
        }
        if (there) {
            difference.set_other_e_s(b->second.e_s);
            difference.set_other_text(b->second.text);
        }
        found.emplace_back(std::min(here ? a->second.e_s : b->second.e_s, there ? b->second.e_s : a->second.e_s),
                           std::move(difference));
    }
    std::ranges::stable_sort(found, {}, [](const auto& each) { return each.first; });
    for (auto& [e_s, difference] : found) *differences.Add() = std::move(difference);
}

struct Sample {
    double e_s = 0.0, value = 0.0;
    std::optional<std::string> text;

    bool same_as(const Sample& other) const {
        return text == other.text && (value == other.value || (std::isnan(value) && std::isnan(other.value)));
    }
};
using Samples = std::map<std::uint32_t, std::vector<Sample>>;  // by channel

Result<Samples> samples_of(Reader& reader, const v1::RunState& run, double from_e_s) {
    Samples samples;
    const double from_s = run.entry_sclk() + from_e_s;
    const SclkRange range{from_s, from_s + window_s};
    const auto read = reader.each_sample(RunId{static_cast<std::uint32_t>(run.run())}, {}, range,
                                         [&](std::span<const ChannelValue> values) -> Result<void> {
                                             for (const auto& each : values)
                                                 if (each.sclk.seconds < from_s + window_s)
                                                     samples[each.channel.value].push_back(
                                                         {each.sclk.seconds - run.entry_sclk(), each.value, each.text});
                                             return {};
                                         });
    if (!read) return read.error();
    return samples;
}

struct ChannelFound {
    double from_e_s = 0.0;
    double largest = 0.0, largest_e_s = 0.0;
    std::uint64_t differing = 0, compared = 0, only_one = 0;
};

/// Adds what differs in a window; both sides in the order of time.
void compare(const std::vector<Sample>& one, const std::vector<Sample>& other, ChannelFound& found) {
    const auto differs_at = [&](double e_s) {
        if (found.differing + found.only_one == 0) found.from_e_s = e_s;
    };
    for (auto a = one.begin(), b = other.begin(); a != one.end() || b != other.end();) {
        const bool first_only = b == other.end() || (a != one.end() && a->e_s < b->e_s - same_time_s);
        if (first_only || a == one.end() || b->e_s < a->e_s - same_time_s) {
            differs_at(first_only ? a->e_s : b->e_s);
            ++found.only_one;
            ++(first_only ? a : b);
            continue;
        }
        ++found.compared;
        if (!a->same_as(*b)) {
            differs_at(a->e_s);
            ++found.differing;
            const double by = std::abs(a->value - b->value);
            if (by > found.largest) {
                found.largest = by;
                found.largest_e_s = a->e_s;
            }
        }
        ++a;
        ++b;
    }
}

/// Seconds from entry at which the newest sample of a run stands.
Result<double> end_e_s(Reader& reader, const v1::RunState& run) {
    const auto latest = reader.latest(RunId{static_cast<std::uint32_t>(run.run())}, std::nullopt);
    if (!latest) return latest.error();
    double end_s = run.start_sclk();
    for (const auto& value : *latest) end_s = std::max(end_s, value.sclk.seconds);
    return end_s - run.entry_sclk();
}

Result<void> add_channels(Reader& reader, const dictionary::Dictionary& dictionary, double from_e_s,
                          v1::RunDifferences& told) {
    static const std::vector<Sample> none;
    const auto end = end_e_s(reader, told.run()), other_end = end_e_s(reader, told.other());
    if (!end) return end.error();
    if (!other_end) return other_end.error();
    const double until_e_s = std::min(*end, *other_end);
    if (until_e_s - from_e_s > span_max_s)
        return Error{"the runs have samples over more than 14 days from where they part: too many to be compared"};
    told.set_channels_until_e_s(until_e_s);
    const auto cut = [&](std::vector<Sample> samples) {
        std::erase_if(samples, [&](const Sample& each) { return each.e_s > until_e_s + same_time_s; });
        return samples;
    };
    std::map<std::uint32_t, ChannelFound> found;
    for (double e_s = from_e_s; e_s <= until_e_s; e_s += window_s) {
        const auto one = samples_of(reader, told.run(), e_s), other = samples_of(reader, told.other(), e_s);
        if (!one) return one.error();
        if (!other) return other.error();
        std::set<std::uint32_t> channels;
        for (const auto* side : {&*one, &*other})
            for (const auto& [channel, samples] : *side) channels.insert(channel);
        for (const auto channel : channels) {
            const auto a = one->find(channel), b = other->find(channel);
            compare(a == one->end() ? none : cut(a->second), b == other->end() ? none : cut(b->second), found[channel]);
        }
    }
    for (const auto& [channel, each] : found) {
        if (each.differing + each.only_one == 0) {
            told.set_channels_equal(told.channels_equal() + 1);
            continue;
        }
        auto& difference = *told.add_channels();
        difference.set_channel(dictionary.channels[channel].name);
        difference.set_from_e_s(each.from_e_s);
        difference.set_samples(each.compared);
        difference.set_differing(each.differing);
        difference.set_only_in_one(each.only_one);
        if (each.largest > 0.0) {
            difference.set_largest(each.largest);
            difference.set_largest_e_s(each.largest_e_s);
        }
    }
    std::ranges::stable_sort(*told.mutable_channels(), {},
                             [](const v1::ChannelDifference& each) { return each.from_e_s(); });
    return {};
}

}  // namespace

Result<v1::RunDifferences> differences(Reader& reader, const dictionary::Dictionary& dictionary, RunId run,
                                       RunId other) {
    v1::RunDifferences told;
    const auto one = reader.run(run), second = reader.run(other);
    if (!one) return one.error();
    if (!second) return second.error();
    for (const auto* each : {&*one, &*second})
        if (each->entry_sclk() == 0.0)
            return Error{"runs are compared from entry, and nobody knows when run " + std::to_string(each->run()) +
                         " has it"};
    *told.mutable_run() = *one;
    *told.mutable_other() = *second;
    const auto part = part_e_s(*one, *second);
    if (part) told.set_part_e_s(*part);
    const double from_e_s =
        part.value_or(std::min(one->start_sclk() - one->entry_sclk(), second->start_sclk() - second->entry_sclk()));
    const auto events = events_of(reader, *one, from_e_s), other_events = events_of(reader, *second, from_e_s);
    if (!events) return events.error();
    if (!other_events) return other_events.error();
    add_differences(*events, *other_events, *told.mutable_events());
    const auto rows = timepoints_of(reader, *one, from_e_s), other_rows = timepoints_of(reader, *second, from_e_s);
    if (!rows) return rows.error();
    if (!other_rows) return other_rows.error();
    add_differences(*rows, *other_rows, *told.mutable_timepoints());
    if (auto added = add_channels(reader, dictionary, from_e_s, told); !added) return added.error();
    return told;
}

}  // namespace aeolis::archive
