// SPDX-License-Identifier: Apache-2.0
#include "server/archive/sample_origins.hpp"

#include "server/archive/path_comparison.hpp"
#include "telemetry/staleness.hpp"
#include "telemetry/station/silence_classifier.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace aeolis::archive {

namespace {

// Uses the index on time; another mission's containers may have any APID.
constexpr char of_packet_sql[] =
    " FROM packets u WHERE u.run = ?1 AND u.apid = ?2 AND u.source = ?3 AND u.sclk BETWEEN ?4 AND ?5"
    " AND u.packet = ?6 AND u.sampled = 1 ORDER BY u.sclk, u.key";
constexpr char of_container_sql[] =
    " FROM packets u WHERE u.run = ?1 AND ?2 IS NOT NULL AND u.source = ?3 AND u.sclk BETWEEN ?4 AND ?5"
    " AND u.packet = ?6 AND u.sampled = 1 ORDER BY u.sclk, u.key";
const std::string presence_columns = std::string("SELECT u.sclk, u.link, u.octets, ") + path_comparison_sql;
const std::string presences_of_packet_sql = presence_columns + of_packet_sql;
const std::string presences_of_container_sql = presence_columns + of_container_sql;

/// A packet with the channel, whether or not its value is defined.
struct PacketPresence {
    double sclk_s = 0.0;
    std::int64_t link = 0;
    Source source{};
    PathComparison comparison{};
    bool defined = false;

    bool of_one_origin_with(const PacketPresence& other) const {
        return link == other.link && source == other.source && comparison == other.comparison;
    }
};

Result<void> read_presences(Reader::State& reader, const RunInfo& run, PacketColumns::Place place, Source source,
                            const ClosedRange& range, std::vector<PacketPresence>& presences) {
    const Apid apid = reader.dictionary.packets[place.packet].apid;
    auto rows = reader.query(
        (apid == telemetry::OtherMission::unrestricted_apid ? presences_of_container_sql : presences_of_packet_sql)
            .c_str());
    if (!rows) return rows.error();
    auto& row = **rows;
    row.bind(1, std::int64_t{run.run.value})
        .bind(2, std::int64_t{apid.value})
        .bind(3, static_cast<std::int64_t>(source))
        .bind(4, range.from_s)
        .bind(5, range.to_s)
        .bind(6, std::int64_t{place.packet});
    for (;;) {
        auto found = row.step();
        if (!found) return found.error();
        if (!*found) return {};
        if (presences.size() == exact_samples_max)
            return Error{"the range holds more than " + std::to_string(exact_samples_max) +
                         " packets of the channel: ask for less, or without provenance"};
        if (!reader.decode(row.octets(2), place.packet)) continue;
        const bool defined = reader.columns.defined(reader.decoded, place.column);
        presences.push_back(
            {row.real(0), row.integer(1), source, static_cast<PathComparison>(row.integer(3)), defined});
    }
}

Result<std::map<std::int64_t, std::string>> link_names(Reader::State& reader) {
    std::map<std::int64_t, std::string> names;
    auto rows = reader.query("SELECT number, word FROM words WHERE kind = 'link'");
    if (!rows) return rows.error();
    for (;;) {
        auto found = (*rows)->step();
        if (!found) return found.error();
        if (!*found) return names;
        names.emplace((*rows)->integer(0), (*rows)->text(1));
    }
}

/// How long a gap between two packets with the channel may be.
double longest_interval_s(const dictionary::Dictionary& dictionary, const std::vector<PacketColumns::Place>& places) {
    double longest_s = 0.0;
    for (const auto place : places) {
        const auto after_s = telemetry::stale_after_s(dictionary, place.packet);
        if (!after_s) return std::numeric_limits<double>::infinity();
        longest_s = std::max(longest_s, *after_s);
    }
    return longest_s;
}

/// A link's silence in SCLK.
struct Outage {
    double from_s, to_s;
    std::string words;
};
/// Whether the plan has the other link bring live telemetry meanwhile: X-band in cruise, UHF from then on.
bool hands_over(const v1::Silence& silence) {
    if (!silence.has_of()) return false;
    return silence.of() == v1::LinkChange::not_begun ||
           (silence.link() == telemetry::x_band_telemetry_link.name && silence.of() == v1::LinkChange::switched_off);
}
Result<std::vector<Outage>> live_outages(Reader::State& reader, const RunInfo& run) {
    const auto silences = reader.silences(run.run);
    if (!silences) return silences.error();
    std::vector<Outage> outages;
    for (const v1::Silence& silence : *silences) {
        if (!telemetry::is_live_telemetry(silence.link()) || hands_over(silence)) continue;
        const double to_e_s = silence.has_to_e_s() ? silence.to_e_s() : std::numeric_limits<double>::infinity();
        outages.push_back({run.entry.seconds + silence.from_e_s(), run.entry.seconds + to_e_s,
                           silence.link() + ": " + silence.reason()});
    }
    return outages;
}

/// The reason of the outage that covers most of the gap.
std::string reason_of(const std::vector<Outage>& outages, double from_s, double to_s) {
    double most_s = 0.0;
    std::string words;
    for (const Outage& outage : outages) {
        const double within_s = std::min(outage.to_s, to_s) - std::max(outage.from_s, from_s);
        if (within_s <= most_s) continue;
        most_s = within_s;
        words = outage.words;
    }
    return words;
}

}  // namespace

Result<void> add_origins(Reader::State& reader, const RunInfo& run, ChannelId channel, const SclkRange& asked,
                         const ClosedRange& range, std::optional<Source> only, v1::ChannelSeries& series) {
    const auto& places = reader.columns.places(channel);
    std::vector<PacketPresence> presences;
    for (const auto place : places)
        for (const Source source : {Source::realtime, Source::recorded})  // the series' order within one instant
            if (!only || *only == source)
                if (auto done = read_presences(reader, run, place, source, range, presences); !done) return done;
    std::ranges::stable_sort(presences, {}, &PacketPresence::sclk_s);
    const auto names = link_names(reader);
    if (!names) return names.error();
    const auto complete = reader.recording_complete(run.run);
    if (!complete) return complete.error();
    // The outages of the live link do not explain gaps of the recording.
    const auto outages =
        only == Source::recorded ? Result<std::vector<Outage>>{std::vector<Outage>{}} : live_outages(reader, run);
    if (!outages) return outages.error();

    const double longest_s = longest_interval_s(reader.dictionary, places);
    std::optional<double> last_s = asked.from_s;  ///< of the last defined sample
    bool undefined = false;                       ///< a sample since then was undefined
    const auto come_to = [&](double sclk_s) {
        if (last_s && (undefined || sclk_s - *last_s > longest_s)) {
            auto& gap = *series.add_gaps();
            gap.set_from_sclk(*last_s);
            gap.set_to_sclk(sclk_s);
            gap.set_reason(undefined ? "undefined on board" : reason_of(*outages, *last_s, sclk_s));
        }
        last_s = sclk_s;
        undefined = false;
    };
    const PacketPresence* before = nullptr;
    for (const PacketPresence& each : presences) {
        if (!each.defined) {
            undefined = true;
            continue;
        }
        come_to(each.sclk_s);
        if (before == nullptr || !each.of_one_origin_with(*before)) {
            auto& origin = *series.add_origins();
            origin.set_from_sclk(each.sclk_s);
            origin.set_source(static_cast<v1::Source>(each.source));
            if (const auto name = names->find(each.link); name != names->end()) origin.set_link(name->second);
            origin.set_verdict(name_of(each.comparison, each.source, *complete));
        }
        auto& origin = *series.mutable_origins(series.origins_size() - 1);
        origin.set_to_sclk(each.sclk_s);
        origin.set_samples(origin.samples() + 1);
        before = &each;
    }
    if (asked.to_s && *asked.to_s < std::numeric_limits<double>::infinity()) come_to(*asked.to_s);
    return {};
}

}  // namespace aeolis::archive
