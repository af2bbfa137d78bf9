// SPDX-License-Identifier: Apache-2.0
#include "server/archive/expression.hpp"
#include "server/archive/packet_samples.hpp"
#include "server/archive/reader.hpp"
#include "server/archive/sample_origins.hpp"
#include "server/archive/sample_query.hpp"
#include "server/archive/schema.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace aeolis::archive {

namespace {

constexpr std::size_t exact_samples_of_all_max = 1'000'000;  ///< chosen: 55 MB as JSON; an origin or gap counts as one
constexpr std::size_t window_samples = 100'000;              ///< chosen: read at once; at most four times as many
constexpr std::size_t page_samples = 10'000;                 ///< chosen: likewise for one page, a megabyte of text

constexpr char sealed_span_sql[] = "SELECT min(first_sclk), max(last_sclk), sum(samples) FROM segments WHERE run = ?1";
constexpr char packet_span_sql[] =
    "SELECT min(sclk), max(sclk), count(*) FROM packets WHERE key BETWEEN ?1 AND ?2 AND sampled = 1";

Result<std::vector<const dictionary::Channel*>> find_channels(const dictionary::Dictionary& dictionary,
                                                              const std::vector<std::string>& names) {
    if (names.empty()) return Error{"no channel is named"};
    if (names.size() > channels_max)
        return Error{std::to_string(names.size()) + " channels are named; at most " + std::to_string(channels_max)};
    std::vector<const dictionary::Channel*> channels;
    for (const auto& name : names) {
        const auto* channel = dictionary.channel(name);
        if (channel == nullptr) return Error{"no channel '" + name + "'"};
        channels.push_back(channel);
    }
    return channels;
}

/// Removes repeats: a channel may be given by name and by alias.
std::vector<const dictionary::Channel*> without_repeats(const std::vector<const dictionary::Channel*>& channels) {
    std::vector<const dictionary::Channel*> once;
    for (const auto* channel : channels)
        if (std::ranges::find(once, channel) == once.end()) once.push_back(channel);
    return once;
}

void write(v1::ChannelSeries& series, std::span<const Sample> samples) {
    const auto count = static_cast<int>(samples.size());
    series.mutable_sclk()->Resize(count, 0.0);
    series.mutable_value()->Resize(count, 0.0);
    series.mutable_source()->Resize(count, 0);
    double* sclk_s = series.mutable_sclk()->mutable_data();
    double* value = series.mutable_value()->mutable_data();
    int* source = series.mutable_source()->mutable_data();
    for (const Sample& sample : samples) {
        *sclk_s++ = sample.sclk_s;
        *value++ = sample.value;
        *source++ = static_cast<int>(sample.source);
    }
}

Result<void> check_exact(std::size_t samples, const dictionary::Channel& channel) {
    if (samples <= exact_samples_max) return {};
    return Error{"the range holds some " + std::to_string(samples) + " samples of '" + channel.name + "'; at most " +
                 std::to_string(exact_samples_max) + " are given exactly: ask for points, or less"};
}

void write(const ChannelValue& sample, v1::ChannelSeries& series) {
    series.add_sclk(sample.sclk.seconds);
    series.add_value(sample.value);
    series.add_source(static_cast<v1::Source>(sample.source));
    auto& text = *series.add_text();
    if (sample.text) text.set_text(*sample.text);
}

/// Adds the newest sample in real time.
Result<void> add_newest(Reader::State& reader, const RunInfo& run, ChannelId channel, v1::ChannelSeries& series) {
    Newest newest(reader.dictionary.channels.size());
    for (const auto place : reader.columns.places(channel))
        if (auto done = note_newest(reader, run, place.packet, Source::realtime,
                                    std::numeric_limits<double>::infinity(), newest);
            !done)
            return done;
    const auto& found = newest[channel.value];
    if (!found) return {};
    auto& added = *series.mutable_newest();
    added.set_sclk(found->sclk.seconds);
    added.set_value(found->value);
    if (found->text) added.set_text(*found->text);
    added.set_ert_us(found->ert.microseconds);
    added.set_sclk_by_reception(found->sclk_by_reception);
    return {};
}

/// The series of a channel that needs_text(). Texts have no least and largest: thinned, the series has the last ones.
Result<v1::ChannelSeries> text_series(Reader::State& reader, const RunInfo& run, const dictionary::Channel& channel,
                                      const ClosedRange& range, const SeriesQuery& query, v1::ChannelSeries series) {
    const auto samples = text_samples(reader, run, channel.id, range, query.source);
    if (!samples) return samples.error();
    series.set_samples(static_cast<std::uint64_t>(
        std::ranges::count_if(*samples, [](const ChannelValue& sample) { return sample.text.has_value(); })));
    const std::size_t left_out = query.points && samples->size() > *query.points ? samples->size() - *query.points : 0;
    series.set_thinned(left_out > 0);
    for (const ChannelValue& sample : std::span{*samples}.subspan(left_out)) write(sample, series);
    return series;
}

Result<v1::ChannelSeries> one_series(Reader::State& reader, const RunInfo& run, const dictionary::Channel& channel,
                                     const ClosedRange& range, const SeriesQuery& query) {
    const auto& points = query.points;
    v1::ChannelSeries series;
    series.set_id(channel.id.value);
    series.set_name(channel.name);
    series.set_unit(channel.type.unit);
    if (reader.other != nullptr && !query.range.to_s)
        if (auto done = add_newest(reader, run, channel.id, series); !done) return done.error();
    if (needs_text(channel.type)) return text_series(reader, run, channel, range, query, std::move(series));
    const auto sources = find_sample_sources(reader, run, channel.id, range, query.source);
    if (!sources) return sources.error();
    const std::size_t count = sources->samples_at_most;
    if (points && count > *points) {
        const auto thinned = thinned_samples(reader, *sources, *points);
        if (!thinned) return thinned.error();
        series.set_samples(thinned->samples);
        series.set_thinned(thinned->points.size() < thinned->samples);
        write(series, thinned->points);
        return series;
    }
    if (auto fits = check_exact(count, channel); !fits) return fits.error();
    const auto samples = exact_samples(reader, *sources);
    if (!samples) return samples.error();
    series.set_samples(static_cast<std::uint64_t>(
        std::ranges::count_if(*samples, [](const Sample& sample) { return !std::isnan(sample.value); })));
    write(series, *samples);
    return series;
}

Result<std::span<const Sample>> samples_of(Reader::State& reader, const RunInfo& run, ChannelId channel,
                                           const ClosedRange& range) {
    const auto sources = find_sample_sources(reader, run, channel, range);
    if (!sources) return sources.error();
    return exact_samples(reader, *sources);
}

Result<ClosedRange> range_of(const SeriesQuery& query) {
    if (query.points && (*query.points < 2 || *query.points > thinned_points_max))
        return Error{"points " + std::to_string(*query.points) + " is not 2 … " + std::to_string(thinned_points_max)};
    return closed(query.range);
}

/// First to last sample of a run, and the number of packets with samples. A reversed range: none.
struct SampleSpan {
    ClosedRange range{1.0, 0.0};
    std::uint64_t samples = 0;
};
Result<SampleSpan> sample_span(Reader::State& reader, const RunInfo& run) {
    SampleSpan span;
    const auto add = [&](const sqlite::Statement& row) {
        if (row.is_null(0)) return;
        const bool first = span.samples == 0;
        span.range.from_s = first ? row.real(0) : std::min(span.range.from_s, row.real(0));
        span.range.to_s = first ? row.real(1) : std::max(span.range.to_s, row.real(1));
        span.samples += static_cast<std::uint64_t>(row.integer(2));
    };
    auto sealed = reader.query(sealed_span_sql);
    if (!sealed) return sealed.error();
    (*sealed)->bind(1, std::int64_t{run.run.value});
    if (auto found = (*sealed)->step(); !found) return found.error();
    add(**sealed);
    if (run.finished) return span;
    auto packets = reader.query(packet_span_sql);
    if (!packets) return packets.error();
    (*packets)->bind(1, item_key(run.run, 0)).bind(2, item_key(run.run, sequence_max));
    if (auto found = (*packets)->step(); !found) return found.error();
    add(**packets);
    return span;
}

/// What a query of series asks for, looked up.
struct SeriesScope {
    ClosedRange range;
    RunInfo run;
    std::vector<const dictionary::Channel*> channels;  ///< each once
};
Result<SeriesScope> scope_of(Reader::State& reader, RunId run, const SeriesQuery& query) {
    const auto range = range_of(query);
    if (!range) return range.error();
    const auto instant = reader.instant(run);
    if (!instant) return instant.error();
    if (auto same = reader.same_dictionary(instant->run); !same) return same.error();
    const auto channels = find_channels(reader.dictionary, query.channels);
    if (!channels) return channels.error();
    return SeriesScope{*range, instant->run, without_repeats(*channels)};
}

}  // namespace

Result<Reader::SeriesSize> Reader::series_size(RunId run, const SeriesQuery& query) {
    const auto scope = scope_of(*state_, run, query);
    if (!scope) return scope.error();
    SeriesSize size;
    for (const auto* channel : scope->channels) {
        const auto sources = find_sample_sources(*state_, scope->run, channel->id, scope->range, query.source);
        if (!sources) return sources.error();
        const std::size_t count = sources->samples_at_most;
        if (!query.points)
            if (auto fits = check_exact(count, *channel); !fits) return fits.error();
        size.channels.push_back(channel->name);
        size.samples += query.points ? std::min(count, *query.points) : count;
    }
    return size;
}

Result<v1::ChannelSeriesList> Reader::series(RunId run, const SeriesQuery& query) {
    const auto scope = scope_of(*state_, run, query);
    if (!scope) return scope.error();
    v1::ChannelSeriesList list;
    std::size_t given = 0;
    for (const auto* channel : scope->channels) {
        auto series = one_series(*state_, scope->run, *channel, scope->range, query);
        if (!series) return series.error();
        if (query.provenance)
            if (auto done =
                    add_origins(*state_, scope->run, channel->id, query.range, scope->range, query.source, *series);
                !done)
                return done.error();
        given += static_cast<std::size_t>(series->sclk_size()) + static_cast<std::size_t>(series->origins_size()) +
                 static_cast<std::size_t>(series->gaps_size());
        if (given > exact_samples_of_all_max)
            return Error{"the channels have more than " + std::to_string(exact_samples_of_all_max) +
                         (query.provenance ? " samples, origins and gaps" : " samples") +
                         " in the range: ask for points, or less; aeolis export gives any number"};
        *list.add_channels() = std::move(series).value();
    }
    return list;
}

namespace {

/// Collects values at ascending times: all, or the minimum and maximum of each of equal intervals.
class Thinning {
  public:
    /// @param points  none: all values; an Error when they exceed an exact answer's limit
    Thinning(ClosedRange range, std::optional<std::size_t> points)
        : range_(range), intervals_(points ? *points / 2 : 0) {}

    Result<void> add(const Sample& sample) {
        const bool defined = !std::isnan(sample.value);
        if (defined) ++count_;
        if (intervals_ > 0 && !defined) return {};
        if (intervals_ == 0) {
            if (all_.size() >= exact_samples_max)
                return Error{"the range holds more than " + std::to_string(exact_samples_max) +
                             " values: ask for points, or less"};
            all_.push_back(sample);
            return {};
        }
        const double part = (sample.sclk_s - range_.from_s) / std::max(range_.to_s - range_.from_s, seconds_per_tick);
        const auto interval =
            std::min(static_cast<std::size_t>(part * static_cast<double>(intervals_)), intervals_ - 1);
        if (interval != interval_ || !least_) flush();
        interval_ = interval;
        if (!least_ || sample.value < least_->value) least_ = sample;
        if (!largest_ || sample.value > largest_->value) largest_ = sample;
        return {};
    }
    /// The result. Call after the last value.
    std::span<const Sample> points() {
        flush();
        return all_;
    }
    std::uint64_t count() const { return count_; }

  private:
    void flush() {
        if (!least_) return;
        const bool least_first = least_->sclk_s <= largest_->sclk_s;
        all_.push_back(least_first ? *least_ : *largest_);
        const bool one = least_->sclk_s == largest_->sclk_s && least_->value == largest_->value;
        if (!one) all_.push_back(least_first ? *largest_ : *least_);
        least_.reset();
        largest_.reset();
    }
    ClosedRange range_;
    std::size_t intervals_, interval_ = 0;
    std::uint64_t count_ = 0;
    std::optional<Sample> least_, largest_;  ///< of the present interval
    std::vector<Sample> all_;
};

}  // namespace

Result<v1::ChannelSeries> Reader::derived(RunId run, const std::string& text, const SclkRange& asked,
                                          std::optional<std::size_t> points) {
    auto expression = Expression::parse(text);
    if (!expression) return expression.error();
    if (points && (*points < 2 || *points > thinned_points_max))
        return Error{"points " + std::to_string(*points) + " is not 2 … " + std::to_string(thinned_points_max)};
    const auto range = closed(asked);
    if (!range) return range.error();
    const auto& names = expression->channels();
    const auto channels = find_channels(state_->dictionary, names);
    if (!channels) return channels.error();
    ClosedRange within = *range;
    {
        const auto instant = state_->instant(run);
        if (!instant) return instant.error();
        const auto span = sample_span(*state_, instant->run);
        if (!span) return span.error();
        within = {std::max(within.from_s, span->range.from_s), std::min(within.to_s, span->range.to_s)};
    }
    // Within one instant the first channel's sample comes last: by then all others are known.
    const std::vector<std::string> in_order(names.rbegin(), names.rend());
    std::vector<std::optional<double>> known(names.size());
    std::vector<double> values(names.size());
    Thinning thinning(within, points);
    const auto take = [&](std::span<const ChannelValue> samples) -> Result<void> {
        for (const ChannelValue& sample : samples) {
            for (std::size_t i = 0; i < names.size(); ++i)
                if ((*channels)[i]->id == sample.channel) known[i] = sample.value;
            if (sample.channel != channels->front()->id ||
                std::ranges::any_of(known, [](const auto& value) { return !value; }))
                continue;
            std::ranges::transform(known, values.begin(), [](const auto& value) { return *value; });
            const bool defined = std::ranges::none_of(values, [](double value) { return std::isnan(value); });
            const double value = defined ? expression->value(values) : std::numeric_limits<double>::quiet_NaN();
            if (auto done = thinning.add({sample.sclk.seconds, value, sample.source}); !done) return done;
        }
        return {};
    };
    if (auto done = each_sample(run, in_order, asked, take); !done) return done.error();
    v1::ChannelSeries series;
    series.set_name(text);
    const auto given = thinning.points();
    series.set_samples(thinning.count());
    series.set_thinned(given.size() < thinning.count());
    write(series, given);
    return series;
}

namespace {

/// Reads the samples of a range in windows of about `wanted` samples.
class SampleWindows {
  public:
    static Result<SampleWindows> of(Reader::State& reader, RunId run, const std::vector<std::string>& channels,
                                    const SclkRange& asked, std::size_t wanted,
                                    const std::optional<SampleCursor>& after = {});

    bool at_end() const { return cursor_.from_s > cursor_.to_s; }
    const SampleCursor& cursor() const { return cursor_; }  ///< of the next window
    /// Reads the next window, in order of SCLK; it may be empty.
    Result<void> next(std::vector<ChannelValue>& samples);

  private:
    SampleWindows(Reader::State& reader, const RunInfo& run, std::size_t wanted)
        : reader_(&reader), run_(run), wanted_(wanted) {}
    Result<void> add_samples(const dictionary::Channel& channel, const ClosedRange& window,
                             std::vector<ChannelValue>& samples);

    Reader::State* reader_;
    RunInfo run_;
    std::size_t wanted_;
    std::vector<const dictionary::Channel*> channels_;
    SampleCursor cursor_;  ///< its width is first estimated, then adapted
};

Result<SampleWindows> SampleWindows::of(Reader::State& reader, RunId run, const std::vector<std::string>& channels,
                                        const SclkRange& asked, std::size_t wanted,
                                        const std::optional<SampleCursor>& after) {
    const auto range = closed(asked);
    if (!range) return range.error();
    const auto info = reader.info(run);
    if (!info) return info.error();
    if (auto same = reader.same_dictionary(*info); !same) return same.error();
    SampleWindows windows(reader, *info, wanted);
    if (channels.empty()) {
        for (const auto& channel : reader.dictionary.channels)
            if (!reader.columns.places(channel.id).empty()) windows.channels_.push_back(&channel);
    } else {
        auto found = find_channels(reader.dictionary, channels);
        if (!found) return found.error();
        windows.channels_ = without_repeats(*found);
    }
    if (after) {
        windows.cursor_ = *after;
        return windows;
    }
    const auto span = sample_span(reader, *info);
    if (!span) return span.error();
    windows.cursor_ = {std::max(range->from_s, span->range.from_s), std::min(range->to_s, span->range.to_s),
                       (span->range.to_s - span->range.from_s) * static_cast<double>(wanted) /
                           static_cast<double>(std::max<std::uint64_t>(1, span->samples * windows.channels_.size()))};
    return windows;
}

Result<void> SampleWindows::add_samples(const dictionary::Channel& channel, const ClosedRange& window,
                                        std::vector<ChannelValue>& samples) {
    if (needs_text(channel.type)) {
        auto found = text_samples(*reader_, run_, channel.id, window);
        if (!found) return found.error();
        std::ranges::move(*found, std::back_inserter(samples));
        return {};
    }
    const auto found = samples_of(*reader_, run_, channel.id, window);
    if (!found) return found.error();
    for (const Sample& sample : *found)
        samples.push_back({channel.id, sample.value, Sclk{sample.sclk_s}, sample.source});
    return {};
}

Result<void> SampleWindows::next(std::vector<ChannelValue>& samples) {
    auto& [from_s, to_s, width_s] = cursor_;
    for (;;) {
        const double next_s = std::max(from_s + width_s, std::nextafter(from_s, to_s + 1.0));
        const ClosedRange window{from_s, std::min(to_s, std::nextafter(next_s, from_s))};
        samples.clear();
        bool whole = true;
        for (const auto* channel : channels_) {
            if (auto done = add_samples(*channel, window, samples); !done) return done;
            whole = samples.size() <= 4 * wanted_ || window.from_s == window.to_s;
            if (!whole) break;
        }
        if (!whole) {
            width_s /= 2.0;
            continue;
        }
        std::ranges::stable_sort(samples, {}, [](const ChannelValue& sample) { return sample.sclk.seconds; });
        if (samples.size() < wanted_ / 4) width_s = std::max(2.0 * width_s, std::nextafter(0.0, 1.0));
        from_s = next_s;
        return {};
    }
}

}  // namespace

Result<void> Reader::each_sample(RunId run, const std::vector<std::string>& channels, const SclkRange& asked,
                                 const TakeSamples& take) {
    auto snapshot = sqlite::Transaction::begin_read(state_->database);
    if (!snapshot) return snapshot.error();
    auto windows = SampleWindows::of(*state_, run, channels, asked, window_samples);
    if (!windows) return windows.error();
    std::vector<ChannelValue> samples;
    while (!windows->at_end()) {
        if (auto done = windows->next(samples); !done) return done;
        if (samples.empty()) continue;
        if (auto done = take(samples); !done) return done;
    }
    return {};
}

Result<SamplePage> Reader::sample_page(RunId run, const std::vector<std::string>& channels, const SclkRange& asked,
                                       const std::optional<SampleCursor>& after) {
    auto snapshot = sqlite::Transaction::begin_read(state_->database);
    if (!snapshot) return snapshot.error();
    auto windows = SampleWindows::of(*state_, run, channels, asked, page_samples, after);
    if (!windows) return windows.error();
    SamplePage page;
    while (!windows->at_end() && page.samples.empty())
        if (auto done = windows->next(page.samples); !done) return done.error();
    if (!windows->at_end()) page.next = windows->cursor();
    return page;
}

Result<std::vector<ChannelValue>> Reader::latest(RunId run, std::optional<Sclk> at) {
    const auto range = closed({{}, at ? std::optional(at->seconds) : std::nullopt});
    if (!range) return range.error();
    const auto instant = state_->instant(run);
    if (!instant) return instant.error();
    if (auto same = state_->same_dictionary(instant->run); !same) return same.error();
    Newest newest(state_->dictionary.channels.size());
    for (std::size_t packet = 0; packet < state_->columns.packets(); ++packet)
        for (const Source source : {Source::realtime, Source::recorded})
            if (auto done = note_newest(*state_, instant->run, packet, source, range->to_s, newest); !done)
                return done.error();
    std::vector<ChannelValue> answer;
    for (auto& value : newest)
        if (value) answer.push_back(std::move(*value));
    return answer;
}

}  // namespace aeolis::archive
