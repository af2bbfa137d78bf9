// SPDX-License-Identifier: Apache-2.0
#include "server/api/state_at.hpp"

#include "server/archive/items.hpp"

#include <map>
#include <set>
#include <string>

namespace aeolis::server {
namespace {

constexpr std::size_t commands_of_state_max = 1'000;  // chosen: with a stage each, 0.5 MB as JSON

/// The newest item by name.
template <typename Name>
using Newest = std::map<Name, v1::Item>;

struct Cut {
    std::optional<Sclk> on_board;
    std::optional<Ert> on_earth;

    bool leaves_out(double sclk_s) const { return on_board && sclk_s > on_board->seconds; }
    bool leaves_out(const v1::Item& item) const { return on_earth && item.ert_us() > on_earth->microseconds; }
};

struct Stand {
    Newest<std::string> links, alarms, timepoints;
    Newest<std::uint64_t> commands;
    std::set<std::uint64_t> commands_left_out;
    std::optional<v1::Item> tone, situation;

    void take_command(const v1::Item& item) {
        const auto number = item.command_stage().command();
        if (commands_left_out.contains(number)) return;
        commands.insert_or_assign(number, item);
        if (commands.size() <= commands_of_state_max) return;
        commands_left_out.insert(commands.begin()->first);
        commands.erase(commands.begin());
    }

    void take(const v1::Item& item, const Cut& cut) {
        switch (item.item_case()) {
        case v1::Item::kLink:
            if (!cut.leaves_out(item)) links.insert_or_assign(item.link().link(), item);
            return;
        case v1::Item::kCommandStage:
            if (!cut.leaves_out(item)) take_command(item);
            return;
        case v1::Item::kAlarm:
            if (!cut.leaves_out(item.alarm().sclk()))
                alarms.insert_or_assign("channel " + std::to_string(item.alarm().channel()), item);
            return;
        case v1::Item::kStaleness:
            if (!cut.leaves_out(item)) alarms.insert_or_assign("packet " + item.staleness().packet(), item);
            return;
        case v1::Item::kTimepoint:  // each fires once; the live report comes first
            if (!cut.leaves_out(item.timepoint().fired_sclk())) timepoints.try_emplace(item.timepoint().name(), item);
            return;
        case v1::Item::kTone:
            if (!cut.leaves_out(item)) tone = item;
            return;
        case v1::Item::kSituation:
            if (!cut.leaves_out(item)) situation = item;
            return;
        default: return;
        }
    }
};

bool stands(const v1::Item& alarm) {
    return alarm.has_staleness() ? alarm.staleness().missing() : alarm.alarm().severity() != v1::Alarm::none;
}

}  // namespace

Result<v1::StateAt> state_at(archive::Reader& reader, archive::RunId run, const dictionary::Dictionary& dictionary,
                             std::optional<Sclk> at) {
    const auto values = reader.latest(run, at);
    if (!values) return values.error();
    const auto state = reader.run(run);
    if (!state) return state.error();
    const auto cut = at ? Cut{at, archive::ert_of(*state, *at)} : Cut{};
    Stand stand;
    for (archive::Sequence after = 0;;) {
        auto page = reader.items(run, after, archive::items_page_max,
                                 {.samples = false, .packets = false, .procedures = false});
        if (!page) return page.error();
        for (const auto& item : page->items) stand.take(item, cut);
        if (!page->more) break;
        after = page->complete_through;
    }
    v1::StateAt answer;
    for (const auto& value : *values) {
        const auto& channel = dictionary.channels[value.channel.value];
        auto& series = *answer.add_channels();
        series.set_id(channel.id.value);
        series.set_name(channel.name);
        series.set_unit(channel.type.unit);
        series.set_samples(1);
        series.add_sclk(value.sclk.seconds);
        series.add_value(value.value);
        series.add_source(static_cast<v1::Source>(value.source));
        if (needs_text(channel.type)) {
            auto& text = *series.add_text();
            if (value.text) text.set_text(*value.text);
        }
    }
    for (auto& [name, item] : stand.links) {
        if (item.link().lost()) *answer.add_alarms() = item;  // by the link's name, as in the list of alarms
        *answer.add_links() = std::move(item);
    }
    for (auto& [name, item] : stand.timepoints) *answer.add_timepoints() = std::move(item);
    for (auto& [name, item] : stand.commands) *answer.add_commands() = std::move(item);
    answer.set_commands_left_out(stand.commands_left_out.size());
    for (auto& [name, item] : stand.alarms)
        if (stands(item)) *answer.add_alarms() = std::move(item);
    auto procedures = reader.procedures(run, cut.on_earth);
    if (!procedures) return procedures.error();
    for (auto& item : *procedures) *answer.add_procedures() = std::move(item);
    auto position_act = reader.newest_position_act(run, cut.on_earth);
    if (!position_act) return position_act.error();
    if (*position_act) *answer.mutable_position_act() = std::move(**position_act);
    if (stand.tone) *answer.mutable_tone() = std::move(*stand.tone);
    if (stand.situation) *answer.mutable_situation() = std::move(*stand.situation);
    return answer;
}

}  // namespace aeolis::server
