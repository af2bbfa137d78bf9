// SPDX-License-Identifier: Apache-2.0
#include "server/api/touchdown.hpp"

#include "server/archive/items.hpp"
#include "server/rehearsal/nominal_flight.hpp"
#include "server/scenario/scenario_text.hpp"
#include "telemetry/port.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <numbers>

namespace aeolis::server {
namespace {

using Report = v1::TouchdownReport;
using telemetry::TouchdownFacts;

Report report_of(const telemetry::TouchdownJudgement& judged) {
    using telemetry::TouchdownVerdict, telemetry::TouchdownStep;
    static_assert(static_cast<int>(TouchdownVerdict::contradicted) == Report::contradicted &&
                  static_cast<int>(TouchdownStep::State::contradicted) == v1::TouchdownStep::contradicted);
    Report report;
    if (judged.verdict == TouchdownVerdict::untold) return report;
    report.set_verdict(static_cast<Report::Verdict>(judged.verdict));
    report.set_sclk(judged.sclk.seconds);
    for (const TouchdownStep& each : judged.steps) {
        auto& step = *report.add_steps();
        step.set_name(each.name);
        step.set_state(static_cast<v1::TouchdownStep::State>(each.state));
        step.set_words(each.words);
        if (each.since) step.set_sclk(each.since->seconds);
    }
    return report;
}

/// Reads the facts of one run up to one instant.
class FactsReader {
  public:
    FactsReader(archive::Reader& reader, archive::RunId run, const dictionary::Dictionary& dictionary,
                std::optional<Sclk> at, bool recorded)
        : reader_(reader), run_(run), dictionary_(dictionary), at_(at), recorded_(recorded) {}

    Result<void> add_timepoint(std::optional<Ert> now, TouchdownFacts& facts) {
        const auto list = reader_.timepoints(run_, {.at = at_, .now = now, .recorded = recorded_});
        if (!list) return list.error();
        for (const auto& row : list->timepoints()) {
            if (row.name() != telemetry::touchdown_timepoint || row.heard_by().empty()) continue;
            const bool live = row.heard_by() == "uhf", tone = row.heard_by() == "tone";
            const double sclk_s = tone ? row.triggered_sclk() : live ? row.realtime_sclk() : row.recorded_sclk();
            facts.told.push_back({Sclk{sclk_s}, fmt::format("timepoint {} by {}", row.name(),
                                                            tone   ? "tone"
                                                            : live ? "UHF"
                                                                   : "the recording")});
        }
        return {};
    }

    Result<void> add_event(TouchdownFacts& facts) {
        const auto list = reader_.events(run_, {range(), {}, std::string{telemetry::touchdown_event}});
        if (!list) return list.error();
        for (const auto& item : list->events()) {
            const auto& event = item.event();
            const bool live = event.source() == v1::SOURCE_REALTIME;
            if (event.name() != telemetry::touchdown_event || (!live && !recorded_)) continue;
            facts.told.push_back(
                {Sclk{event.sclk()}, fmt::format("event {} by {}", event.name(), live ? "UHF" : "the recording")});
            break;
        }
        return {};
    }

    Result<void> add_samples(TouchdownFacts& facts) {
        facts.flag_name = telemetry::touchdown_flag;
        facts.live_name = telemetry::touchdown_live;
        std::optional<Sclk> raised;
        const auto done = each({telemetry::touchdown_flag, telemetry::touchdown_live}, range(),
                               [&](const auto& name, const auto& sample) {
                                   if (name == telemetry::touchdown_live) {
                                       if (sample.source == archive::Source::realtime)
                                           facts.live.push_back(sample.sclk);
                                       return;
                                   }
                                   if (sample.value == 0.0) raised.reset();
                                   if (sample.value != 0.0 && !raised) raised = sample.sclk;
                                   facts.flag = TouchdownFacts::Flag{sample.sclk, sample.value};
                               });
        if (raised)
            facts.told.push_back({*raised, fmt::format("{} is {:.0f}", telemetry::touchdown_flag, facts.flag->value)});
        return done;
    }

    /// One value of a pair is no sample: both are in one packet.
    Result<void> add_rover_imu(Sclk since, TouchdownFacts& facts) {
        facts.rover_imu_known = dictionary_.channel(telemetry::rover_rate_channel) != nullptr &&
                                dictionary_.channel(telemetry::rover_force_channel) != nullptr;
        if (!facts.rover_imu_known) return {};
        struct Pair {
            std::optional<double> rate, force;
        };
        std::map<Sclk, Pair> told;
        const auto done = each({telemetry::rover_rate_channel, telemetry::rover_force_channel},
                               {since.seconds, range().to_s}, [&](const auto& name, const auto& sample) {
                                   auto& pair = told[sample.sclk];
                                   (name == telemetry::rover_rate_channel ? pair.rate : pair.force) = sample.value;
                               });
        for (const auto& [sclk, pair] : told)
            if (pair.rate && pair.force) facts.rover_imu.push_back({sclk, *pair.rate, *pair.force});
        return done;
    }

    Result<void> add_silences(TouchdownFacts& facts) {
        const auto silences = reader_.silences(run_);
        if (!silences) return silences.error();
        for (const auto& silence : *silences) {
            const Sclk from{facts.entry.seconds + silence.from_e_s()};
            if (silence.link() != telemetry::uhf_live_link.name || (at_ && from > *at_)) continue;
            auto& known = facts.silences.emplace_back();
            known.from = from;
            known.words = silence.reason().empty() ? "silent" : silence.reason();
            if (!silence.has_to_e_s()) continue;
            const Sclk to{facts.entry.seconds + silence.to_e_s()};
            if (!at_ || to <= *at_) known.to = to;
        }
        return {};
    }

    /// Figures and place from the samples just before the touchdown.
    Result<void> add_figures(const v1::RunState& state, Report& report) {
        const Sclk touchdown{report.sclk()};
        std::map<std::string, archive::ChannelValue> then;
        std::vector<std::string_view> names{position_channels.begin(), position_channels.end()};
        for (const auto& each : touchdown_channels) names.push_back(each.channel);
        names.push_back(velocity_doubt_channel);
        const auto done = each(names, {touchdown.seconds - touchdown_close_s, touchdown.seconds},
                               [&](const auto& name, const auto& sample) { then[name] = sample; });
        if (!done) return done;
        for (const auto& [name, channel] : touchdown_channels) {
            auto& figure = *report.add_figures();
            figure.set_name(std::string{name});
            figure.set_channel(std::string{channel});
            const auto* known = dictionary_.channel(channel);
            if (known != nullptr) figure.set_unit(known->type.unit);
            const auto found = then.find(std::string{channel});
            if (found == then.end()) continue;
            figure.set_value(found->second.value);
            figure.set_before_s(touchdown - found->second.sclk);
        }
        add_place(state, then, report);
        return {};
    }

  private:
    archive::SclkRange range() const { return {{}, at_ ? std::optional{at_->seconds} : std::nullopt}; }

    /// Passes the defined samples that count, by time, to `take` with the channel's name.
    Result<void> each(const std::vector<std::string_view>& wanted, const archive::SclkRange& range, auto take) {
        std::vector<std::string> names;
        for (const auto name : wanted)
            if (dictionary_.channel(name) != nullptr) names.emplace_back(name);
        if (names.empty()) return {};  // none would be all
        return reader_.each_sample(run_, names, range, [&](auto samples) -> Result<void> {
            for (const auto& sample : samples)
                if (!std::isnan(sample.value) && (recorded_ || sample.source == archive::Source::realtime))
                    take(dictionary_.channels[sample.channel.value].name, sample);
            return {};
        });
    }

    void add_place(const v1::RunState& state, const std::map<std::string, archive::ChannelValue>& then,
                   Report& report) {
        const auto target = [&](std::string_view name) {
            const auto found =
                std::ranges::find_if(state.solution(), [&](const auto& each) { return each.name() == name; });
            return found == state.solution().end() ? std::optional<double>{} : std::optional{found->value()};
        };
        const auto latitude = target(target_arguments[0]), longitude = target(target_arguments[1]),
                   radius = target(target_arguments[2]);
        if (!latitude || !longitude || !radius) return report.set_place_unknown("no target in the ground's solution");
        std::array<double, 3> position{};
        for (std::size_t i = 0; i < position.size(); ++i) {
            const auto found = then.find(std::string{position_channels[i]});
            if (found == then.end())
                return report.set_place_unknown(
                    fmt::format("navigation did not come within {:.0f} s", touchdown_close_s));
            position[i] = found->second.value;
        }
        *report.mutable_place() = place_over_ground(position, *latitude, *longitude, *radius);
        const auto doubt = then.find(std::string{velocity_doubt_channel});
        report.mutable_place()->set_rests_on(
            place_rests_on(doubt == then.end() ? std::nullopt : std::optional{doubt->second.value}));
        const auto text = reader_.scenario_text(run_);
        if (!text) return;  // of another mission, or of an older dictionary
        const auto scenario = scenario_from_text(*text, fmt::format("the scenario of run {}", run_.value));
        const auto aimed = scenario ? ellipse_of(expected_scenario(*scenario)) : std::nullopt;
        if (!aimed) return;
        v1::TargetEllipse ellipse;
        ellipse.set_major_m(aimed->major_m);
        ellipse.set_minor_m(aimed->minor_m);
        ellipse.set_azimuth_deg(aimed->azimuth_deg);
        report.mutable_place()->set_inside_ellipse(is_inside(report.place(), ellipse));
    }

    archive::Reader& reader_;
    archive::RunId run_;
    const dictionary::Dictionary& dictionary_;
    std::optional<Sclk> at_;
    bool recorded_;
};

constexpr double radians(double degrees) {
    return degrees * std::numbers::pi / 180.0;
}

}  // namespace

v1::TouchdownPlace place_over_ground(const std::array<double, 3>& p_MoB_M, double latitude_deg, double longitude_deg,
                                     double radius_m) {
    const double sin_lat = std::sin(radians(latitude_deg)), cos_lat = std::cos(radians(latitude_deg)),
                 sin_lon = std::sin(radians(longitude_deg)), cos_lon = std::cos(radians(longitude_deg));
    const auto& [x, y, z] = p_MoB_M;
    const double east_m = -sin_lon * x + cos_lon * y,
                 north_m = -sin_lat * cos_lon * x - sin_lat * sin_lon * y + cos_lat * z,
                 up_m = cos_lat * cos_lon * x + cos_lat * sin_lon * y + sin_lat * z;
    const double across_m = std::hypot(east_m, north_m);
    const double arc = across_m == 0.0 ? 0.0 : std::atan2(across_m, up_m) * radius_m / across_m;
    v1::TouchdownPlace place;
    place.set_east_m(east_m * arc);
    place.set_north_m(north_m * arc);
    return place;
}

std::string place_rests_on(std::optional<double> velocity_doubt_mps) {
    std::string words =
        "the entry solution from ground, carried on by the IMU; radar corrects height and velocity, not "
        "the place. Its uncertainty is not known: no channel and no solution holds it";
    if (velocity_doubt_mps && *velocity_doubt_mps > 0.0)
        words +=
            fmt::format("; for a silence of the IMU velocity may have been off by {:.2f} m/s", *velocity_doubt_mps);
    return words;
}

bool is_inside(const v1::TouchdownPlace& place, const v1::TargetEllipse& ellipse) {
    const double sin = std::sin(radians(ellipse.azimuth_deg())), cos = std::cos(radians(ellipse.azimuth_deg()));
    const double along_m = place.east_m() * sin + place.north_m() * cos,
                 across_m = place.east_m() * cos - place.north_m() * sin;
    return std::hypot(2.0 * along_m / ellipse.major_m(), 2.0 * across_m / ellipse.minor_m()) <= 1.0;
}

Result<v1::TouchdownReport> touchdown(archive::Reader& reader, archive::RunId run,
                                      const dictionary::Dictionary& dictionary, std::optional<Sclk> at,
                                      std::optional<Ert> now, bool recorded) {
    const auto state = reader.run(run);
    if (!state) return state.error();
    TouchdownFacts facts;
    FactsReader of{reader, run, dictionary, at, recorded};
    if (auto done = of.add_timepoint(now, facts); !done) return done.error();
    if (auto done = of.add_event(facts); !done) return done.error();
    if (auto done = of.add_samples(facts); !done) return done.error();
    if (facts.told.empty()) return v1::TouchdownReport{};
    facts.entry = Sclk{state->entry_sclk()};
    const Sclk first = std::ranges::min(facts.told, {}, &TouchdownFacts::Report::sclk).sclk;
    if (auto done = of.add_rover_imu(first, facts); !done) return done.error();
    if (auto done = of.add_silences(facts); !done) return done.error();
    const auto newest = now ? Result<Ert>{*now} : reader.newest_ert(run);
    if (!newest) return newest.error();
    facts.now = at ? *at : archive::sclk_at_ert(*state, *newest);
    auto report = report_of(telemetry::judge_touchdown(facts));
    if (auto done = of.add_figures(*state, report); !done) return done.error();
    return report;
}

}  // namespace aeolis::server
