#include "server/gateway/timeline_check.hpp"

#include "commands/encoder.hpp"
#include "commands/timeline_change.hpp"
#include "dictionaries/analysis/timeline_analysis.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace aeolis::server {
namespace {

bool failed(const v1::CommandHistory& command) {
    // That it could not be verified does not undo it.
    return std::ranges::any_of(command.stages(), [](const v1::Item& item) {
        return item.command_stage().status() == "failed" && item.command_stage().stage() != "verified";
    });
}

std::vector<std::uint8_t> octets_of(std::string_view hex) {
    std::vector<std::uint8_t> octets;
    const auto digit = [](char c) { return static_cast<unsigned>(c <= '9' ? c - '0' : c - 'a' + 10); };
    for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
        octets.push_back(static_cast<std::uint8_t>(digit(hex[i]) << 4U | digit(hex[i + 1])));
    return octets;
}

std::string text_of(const dictionary::Dictionary& dictionary, const dictionary::ConstraintRow& row) {
    return fmt::format("{} to {} (constraints.csv:{})", moment_text(dictionary, row.from), moment_text(dictionary, row.to), row.line);
}

Result<std::string> analyse(const dictionary::Dictionary& changed) {
    const auto analysis = dictionary::analyse_timeline(changed);
    if (!analysis.contradiction.empty() || !analysis.admits_schedule)
        return Error{"the changed timeline cannot be flown: its offsets contradict what constraints.csv gives (aeolis timeline analyse)"};
    for (const auto& bound : analysis.bounds) {
        if (bound.proof == dictionary::Proof::proven) continue;
        const auto& row = changed.constraints[bound.constraint];
        const auto limit = bound.is_minimum ? row.minimum_s : row.maximum_s;
        return Error{fmt::format("the changed timeline breaks a constraint: {}, {} {} s, {}: {}", text_of(changed, row),
                                 bound.is_minimum ? "at least" : "at most", limit.value_or(0.0),
                                 bound.slack_s ? fmt::format("missed by {:.3f} s", -*bound.slack_s) : "without a bound",
                                 row.note.empty() ? row.source : row.note)};
    }
    return fmt::format("all {} bounds of constraints.csv hold on the changed timeline", analysis.bounds.size());
}

} // namespace

bool changes_timeline(const v1::CommandRequest& request) {
    return request.action().empty() && commands::changes_offsets(request.command());
}

Result<std::string> TimelineCheck::check(const v1::CommandList& before, std::span<const v1::CommandRequest> asked) {
    auto changed = dictionary_;
    std::string key;
    for (const auto& command : before.commands()) {
        if (!commands::changes_offsets(command.name()) || failed(command)) continue;
        const auto* const known = dictionary_.command(command.name());
        const auto arguments = known == nullptr ? Error{"unknown"} : commands::decode(*known, octets_of(command.octets()));
        if (!arguments) continue; // of another dictionary
        commands::apply_offsets(changed, command.name(), *arguments);
        key += command.octets() + ' ';
    }
    for (const auto& request : asked) {
        const auto* const known = dictionary_.command(request.command());
        if (known == nullptr || !changes_timeline(request)) continue;
        std::vector<commands::NamedValue> given;
        for (const auto& argument : request.arguments())
            given.push_back({argument.name(), argument.value()});
        const auto packet = commands::encode(*known, given, 0);
        if (!packet) continue; // the gateway refuses it, and says why
        const auto arguments = commands::decode(*known, *packet); // with defaults
        if (!arguments) return arguments.error();
        commands::apply_offsets(changed, request.command(), *arguments);
        key += request.command() + commands::arguments_text(*arguments) + ' ';
    }
    const std::scoped_lock lock{mutex_};
    if (key == last_key_) return last_;
    last_ = analyse(changed);
    last_key_ = key;
    return last_;
}

} // namespace aeolis::server
