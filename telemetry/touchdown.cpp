// SPDX-License-Identifier: Apache-2.0
#include "telemetry/touchdown.hpp"

#include "common/entry_time.hpp"
#include "telemetry/port.hpp"
#include "telemetry/text.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <utility>

namespace aeolis::telemetry {
namespace {

using StepState = TouchdownStep::State;

/// From entry, or SCLK where nobody knows when that was.
std::string time_text(const TouchdownFacts& facts, Sclk sclk) {
    return facts.entry == Sclk{} ? fmt::format("SCLK {:.1f}", sclk.seconds)
                                 : from_entry_tenths_text(sclk - facts.entry);
}

void add_step(TouchdownJudgement& judged, std::string_view name, StepState state, std::string words,
              std::optional<Sclk> since = {}) {
    judged.steps.push_back({std::string{name}, state, std::move(words), since});
}

void add_told_step(const TouchdownFacts& facts, std::vector<TouchdownFacts::Report> told, TouchdownJudgement& judged) {
    constexpr std::string_view name = "touchdown told by the vehicle";
    std::ranges::stable_sort(told, {}, &TouchdownFacts::Report::sclk);
    const auto& first = told.front();
    const auto when = [&](Sclk sclk) { return time_text(facts, sclk); };
    if (facts.flag && facts.flag->value == 0.0 && facts.flag->sclk - first.sclk > touchdown_gap_s)
        return add_step(judged, name, StepState::contradicted,
                        fmt::format("{} at {}, but {} is 0 at {}", first.words, when(first.sclk), facts.flag_name,
                                    when(facts.flag->sclk)),
                        first.sclk);
    std::string words;
    for (const auto& each : told) words += (words.empty() ? "" : ", ") + each.words;
    add_step(judged, name, StepState::done, fmt::format("{}: {}", when(first.sclk), words), first.sclk);
}

/// The silence of UHF that goes on now.
const TouchdownFacts::Silence* silent_now(const TouchdownFacts& facts) {
    const auto found = std::ranges::find_if(facts.silences, [&](const auto& each) {
        return each.from <= facts.now && (!each.to || *each.to >= facts.now);
    });
    return found == facts.silences.end() ? nullptr : &*found;
}

bool is_still(const TouchdownFacts::RoverImu& told) {
    return told.rate_rps <= still_rate_max_rps &&
           std::abs(told.force_mps2 - still_weight_mps2) <= still_weight_within_mps2;
}

void add_still_step(const TouchdownFacts& facts, Sclk since, TouchdownJudgement& judged) {
    const auto name = fmt::format("rover's own IMU still for {:.0f} s", still_s);
    if (!facts.rover_imu_known)
        return add_step(judged, name, StepState::never,
                        fmt::format("this mission sends no {} and {}", rover_rate_channel, rover_force_channel));
    const auto when = [&](Sclk sclk) { return time_text(facts, sclk); };
    const auto values = [](const TouchdownFacts::RoverImu& told) {
        return fmt::format("{} {:.4f}, {} {:.2f}", rover_rate_channel, told.rate_rps, rover_force_channel,
                           told.force_mps2);
    };
    bool still = false;
    Sclk from = since;  // of stillness
    const TouchdownFacts::RoverImu* last = nullptr;
    for (const auto& told : facts.rover_imu) {
        if (told.sclk <= since) continue;
        const bool goes_on = still && told.sclk - last->sclk <= touchdown_gap_s;
        still = is_still(told);
        if (!still || !goes_on) from = told.sclk;
        last = &told;
        if (still && told.sclk - from >= still_s)
            return add_step(judged, name, StepState::done,
                            fmt::format("{}: still since {}, now {}", when(told.sclk), when(from), values(told)),
                            told.sclk);
    }
    const auto* silent = silent_now(facts);
    const auto because = [&] {
        return silent != nullptr ? fmt::format(": no UHF since {}: {}", when(silent->from), silent->words) : "";
    };
    if (last == nullptr)
        return add_step(
            judged, name, StepState::unknown,
            fmt::format("not known: {} has told nothing since touchdown at {}", rover_rate_channel, when(since)) +
                because());
    const std::string still_for = span_text(last->sclk - from);
    if (facts.now - last->sclk > touchdown_gap_s)
        return add_step(judged, name, StepState::unknown,
                        fmt::format("not known: {} has told nothing since {}; it had been still for {}",
                                    rover_rate_channel, when(last->sclk), still_for) +
                            because());
    if (!still)
        return add_step(judged, name, StepState::waiting,
                        fmt::format("moves at {}: {}; still is at most {} rad/s and {} ± {} m/s2", when(last->sclk),
                                    values(*last), still_rate_max_rps, still_weight_mps2, still_weight_within_mps2));
    add_step(judged, name, StepState::waiting, fmt::format("{} of {:.0f} s since {}", still_for, still_s, when(from)));
}

void add_uhf_step(const TouchdownFacts& facts, Sclk since, TouchdownJudgement& judged) {
    const auto name = fmt::format("UHF came for {:.0f} s without a break after it", touchdown_uhf_s);
    const auto when = [&](Sclk sclk) { return time_text(facts, sclk); };
    const auto silent_between = [&](Sclk from, Sclk to) {
        return std::ranges::any_of(facts.silences,
                                   [&](const auto& each) { return each.from < to && (!each.to || *each.to > from); });
    };
    std::optional<Sclk> from, before;
    for (const Sclk sclk : facts.live) {
        if (sclk <= since) continue;
        if (!before || sclk - *before > touchdown_gap_s || silent_between(*before, sclk)) from = sclk;
        before = sclk;
        if (sclk - *from >= touchdown_uhf_s)
            return add_step(judged, name, StepState::done,
                            fmt::format("{}: {} came over {} without a break since {}", when(sclk), facts.live_name,
                                        uhf_live_link.name, when(*from)),
                            sclk);
    }
    const auto* silent = silent_now(facts);
    const auto since_words = [&](std::string_view otherwise, Sclk at) {
        return silent != nullptr ? fmt::format("{}: {}", when(silent->from), silent->words)
                                 : fmt::format("{}{}", otherwise, when(at));
    };
    if (!before)
        return add_step(judged, name, StepState::unknown,
                        "not known: no UHF since " + since_words("touchdown at ", since));
    if (silent != nullptr || facts.now - *before > touchdown_gap_s)
        return add_step(judged, name, StepState::unknown,
                        fmt::format("not known: no UHF since {}; {} had come without a break", since_words("", *before),
                                    span_text(*before - *from)));
    add_step(judged, name, StepState::waiting,
             fmt::format("{} of {:.0f} s since {}", span_text(*before - *from), touchdown_uhf_s, when(*from)));
}

TouchdownVerdict verdict_of(const std::vector<TouchdownStep>& steps) {
    if (steps.front().state == StepState::contradicted) return TouchdownVerdict::contradicted;
    const bool all =
        std::ranges::all_of(steps, [](const TouchdownStep& step) { return step.state == StepState::done; });
    return all ? TouchdownVerdict::confirmed : TouchdownVerdict::reported;
}

}  // namespace

TouchdownJudgement judge_touchdown(const TouchdownFacts& facts) {
    TouchdownJudgement judged;
    if (facts.told.empty()) return judged;
    add_told_step(facts, facts.told, judged);
    judged.sclk = *judged.steps.front().since;
    add_still_step(facts, judged.sclk, judged);
    add_uhf_step(facts, judged.sclk, judged);
    judged.verdict = verdict_of(judged.steps);
    return judged;
}

}  // namespace aeolis::telemetry
