// SPDX-License-Identifier: Apache-2.0
#include "commands/lifecycle.hpp"

#include "commands/number.hpp"
#include "common/check.hpp"

#include <algorithm>

namespace aeolis::commands {
namespace {

// Time for an answer when the dictionary gives no window. Our assumption: the read-back report comes every 10 s.
constexpr double answer_window_s = 10.0;
constexpr double read_back_window_s = 30.0;

constexpr std::array ground_stages{Stage::queued, Stage::authorised, Stage::released, Stage::radiated};

std::size_t index_of(Stage stage) {
    return static_cast<std::size_t>(stage);
}

Ert later(Ert time, double by_s) {
    return {time.microseconds + static_cast<std::int64_t>(by_s * 1.0e6)};
}

std::string seconds_text(double seconds) {
    return shortest_text(seconds) + " s";
}

std::string evidence_of(const Answer& answer) {
    return answer.event_name + " at SCLK " + text_of(answer.sclk) + (answer.text.empty() ? "" : ": " + answer.text);
}

}  // namespace

const char* name_of(Stage stage) {
    switch (stage) {
    case Stage::queued: return "queued";
    case Stage::authorised: return "authorised";
    case Stage::released: return "released";
    case Stage::radiated: return "radiated";
    case Stage::received: return "received";
    case Stage::accepted: return "accepted";
    case Stage::executed: return "executed";
    case Stage::verified: return "verified";
    }
    return "";
}

const char* name_of(Status status) {
    switch (status) {
    case Status::pending: return "pending";
    case Status::ok: return "ok";
    case Status::failed: return "failed";
    case Status::unknown: return "unknown";
    }
    return "";
}

CommandLifecycle::CommandLifecycle(const dictionary::Command& command, std::uint16_t count, double light_time_s,
                                   bool read_back)
    : command_(&command), count_(count), light_time_s_(light_time_s), read_back_(read_back) {}

bool CommandLifecycle::exists(Stage stage) const {
    return stage != Stage::verified || read_back_ || verifier(Stage::verified) != nullptr;
}

bool CommandLifecycle::finished() const {
    for (std::size_t i = 0; i < stage_count; ++i)
        if (exists(static_cast<Stage>(i)) && status_[i] != Status::ok && status_[i] != Status::failed) return false;
    return true;
}

void CommandLifecycle::ground_stage(Stage stage, Status status, std::string evidence, Ert at,
                                    std::vector<StageChange>& out) {
    AEOLIS_CHECK(std::find(ground_stages.begin(), ground_stages.end(), stage) != ground_stages.end());
    AEOLIS_CHECK(status == Status::ok || status == Status::failed);
    set(stage, status, std::move(evidence), at, out);
    if (status == Status::failed) {
        fail_after(stage, std::string{"never left Earth: not "} + name_of(stage), at, out);
    } else if (stage == Stage::radiated && !radiated_) {
        radiated_ = at;
        await_answers(at, out);
    }
}

void CommandLifecycle::approved(std::string evidence, Ert at, std::vector<StageChange>& out) {
    out.push_back({Stage::authorised, Status::ok, std::move(evidence), at});
}

void CommandLifecycle::await_release(std::string evidence, Ert at, std::vector<StageChange>& out) {
    set(Stage::released, Status::pending, std::move(evidence), at, out);
}

void CommandLifecycle::taken_back(std::string evidence, Ert at, std::vector<StageChange>& out) {
    AEOLIS_CHECK(status(Stage::released) == Status::ok && !radiated_.has_value());
    status_[index_of(Stage::released)] = Status::pending;
    out.push_back({Stage::released, Status::pending, std::move(evidence), at});
}

void CommandLifecycle::radiated_again(std::string evidence, Ert at, std::vector<StageChange>& out) {
    AEOLIS_CHECK(radiated_.has_value());
    radiated_ = at;
    out.push_back({Stage::radiated, Status::ok, std::move(evidence), at});
}

void CommandLifecycle::radiated_in_doubt(std::string evidence, Ert at, std::vector<StageChange>& out) {
    AEOLIS_CHECK(radiated_.has_value());
    out.push_back({Stage::radiated, Status::ok, std::move(evidence), at});
}

void CommandLifecycle::frame_taken(std::string evidence, Ert at, std::vector<StageChange>& out) {
    set(Stage::received, Status::ok, std::move(evidence), at, out);
}

void CommandLifecycle::frame_not_acknowledged(std::string evidence, Ert at, std::vector<StageChange>& out) {
    set(Stage::received, Status::unknown, std::move(evidence), at, out);
}

/// States what each later stage waits for, or that nothing will ever show it.
void CommandLifecycle::await_answers(Ert at, std::vector<StageChange>& out) {
    set(Stage::received, Status::pending, "no answer yet; the command is there after " + seconds_text(light_time_s_),
        at, out);
    for (const Stage stage : {Stage::accepted, Stage::executed, Stage::verified}) {
        if (!exists(stage)) continue;
        if (verifier(stage) == nullptr && !(stage == Stage::verified && read_back_))
            set(stage, Status::unknown, "the dictionary names no event that would show it", at, out);
        else
            set(stage, Status::pending, "awaited until " + day_of_year_text(deadline(stage)), at, out);
    }
}

void CommandLifecycle::on(const Answer& answer, std::vector<StageChange>& out) {
    if (answer.opcode != command_->opcode || answer.count != count_) return;
    for (const dictionary::Verifier& way : command_->verifiers) {
        const auto stage = stage_named(way.stage);
        if (stage && answer.event == way.event) {
            infer_before(*stage, answer, out);
            set(*stage, Status::ok, evidence_of(answer), answer.ert, out);
            if (*stage == Stage::executed && !executed_sclk_) executed_sclk_ = answer.sclk;
            return;
        }
    }
    const auto refuses = [&](const auto& way) { return way.failure_event && *way.failure_event == answer.event; };
    if (std::any_of(command_->verifiers.begin(), command_->verifiers.end(), refuses)) refused(answer, out);
}

/// An accepted command can still be refused by the module that executes it.
void CommandLifecycle::refused(const Answer& answer, std::vector<StageChange>& out) {
    const Stage failed = status(Stage::accepted) == Status::ok ? Stage::executed : Stage::accepted;
    if (status(failed) == Status::ok) return;
    infer_before(Stage::accepted, answer, out);
    set(failed, Status::failed, evidence_of(answer), answer.ert, out);
    fail_after(failed, "because it was refused on board", answer.ert, out);
}

void CommandLifecycle::on(const ReadBack& read_back, Ert at, std::vector<StageChange>& out) {
    // A report from before the execution says nothing about this command.
    if (!exists(Stage::verified) || !executed_sclk_ || read_back.held_at < *executed_sclk_) return;
    set(Stage::verified, read_back.equal() ? Status::ok : Status::failed, "read back: " + read_back.text(), at, out);
}

void CommandLifecycle::pass(Ert now, std::vector<StageChange>& out) {
    if (!radiated_) return;
    for (const Stage stage : {Stage::received, Stage::accepted, Stage::executed, Stage::verified}) {
        if (!exists(stage) || status(stage) != Status::pending || now <= deadline(stage)) continue;
        const bool report = stage == Stage::verified && verifier(stage) == nullptr;
        set(stage, Status::unknown,
            std::string{report ? "no report of what is held" : "no answer"} + " within " +
                seconds_text(total_window_s(stage)) +
                (light_time_s_ > 0.0 ? " + light time there and back, 2 x " + seconds_text(light_time_s_) : ""),
            now, out);
    }
}

void CommandLifecycle::set(Stage stage, Status status, std::string evidence, Ert at, std::vector<StageChange>& out) {
    Status& now = status_[index_of(stage)];
    // Flight may need a cycle or two to hold what it executed, so a later equal report still counts.
    const bool may_recover = stage == Stage::verified && status == Status::ok;
    if (now == Status::ok || (now == Status::failed && !may_recover)) return;
    if (now == status && status != Status::pending) return;
    now = status;
    out.push_back({stage, status, std::move(evidence), at});
}

/// An answer about `stage` shows that the command got that far, even when earlier answers were lost.
void CommandLifecycle::infer_before(Stage stage, const Answer& answer, std::vector<StageChange>& out) {
    for (const Stage before : {Stage::received, Stage::accepted, Stage::executed})
        if (before < stage)
            set(before, Status::ok, "inferred from " + evidence_of(answer) + "; not observed itself", answer.ert, out);
}

void CommandLifecycle::fail_after(Stage stage, const std::string& why, Ert at, std::vector<StageChange>& out) {
    for (std::size_t i = index_of(stage) + 1; i < stage_count; ++i) {
        const auto after = static_cast<Stage>(i);
        if (exists(after)) set(after, Status::failed, std::string{"not "} + name_of(after) + ", " + why, at, out);
    }
}

std::optional<Stage> CommandLifecycle::stage_named(const std::string& name) {
    for (const Stage stage : {Stage::received, Stage::accepted, Stage::executed, Stage::verified})
        if (name == name_of(stage)) return stage;
    return std::nullopt;
}

const dictionary::Verifier* CommandLifecycle::verifier(Stage stage) const {
    for (const dictionary::Verifier& way : command_->verifiers)
        if (way.stage == name_of(stage)) return &way;
    return nullptr;
}

double CommandLifecycle::total_window_s(Stage stage) const {
    const dictionary::Verifier* way = verifier(stage);
    if (stage == Stage::received && way == nullptr) return total_window_s(Stage::accepted);
    if (stage == Stage::verified && way == nullptr) return total_window_s(Stage::executed) + read_back_window_s;
    return way != nullptr && way->window_s > 0.0 ? way->window_s : answer_window_s;
}

Ert CommandLifecycle::deadline(Stage stage) const {
    AEOLIS_CHECK(radiated_.has_value());
    return later(*radiated_, total_window_s(stage) + 2.0 * light_time_s_);
}

}  // namespace aeolis::commands
