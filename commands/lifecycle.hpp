// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "commands/read_back.hpp"
#include "common/ids.hpp"
#include "common/time.hpp"
#include "dictionaries/dictionary.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace aeolis::commands {

enum class Stage : std::uint8_t { queued, authorised, released, radiated, received, accepted, executed, verified };
inline constexpr std::size_t stage_count = 8;
enum class Status : std::uint8_t { pending, ok, failed, unknown };
const char* name_of(Stage stage);
const char* name_of(Status status);

/// A stage's new status, with its evidence.
struct StageChange {
    Stage stage{};
    Status status{};
    std::string evidence;
    Ert at;
};

/// An event report with `opcode` and `count` among its arguments.
struct Answer {
    EvrId event;
    std::string event_name;  ///< "COMMAND_ACCEPTED"
    std::string text;        ///< in words; for a refusal it says why
    Opcode opcode;
    std::uint16_t count = 0;  ///< packet count of the telecommand that it answers
    Sclk sclk;                ///< time of the event on board
    Ert ert;                  ///< time of its receipt on Earth
};

/// The stages of one telecommand, each with its evidence.
///
/// In       reports of ground's own stages; answers; read-backs; Earth's clock
/// Out      changes, appended to `out`
/// Rules    A stage is ok only by evidence. `received` is observed when the vehicle reports the frame (CLCW), else
///          inferred from an answer, and the evidence says which. Silence beyond the window (of the dictionary, from
///          radiation) plus light time both ways is `unknown`: the answer may be lost, or arrive later with the
///          recording, and then still counts. A refusal, or a read-back that differs, is `failed`. `ok` never changes
///          again, except `released` of a command taken back before radiation. `failed` changes only when a later
///          read-back is equal.
/// Memory   a kilooctet
class CommandLifecycle {
  public:
    /// `read_back`: whether flight reads this command back, which decides `verified`; otherwise that stage does not
    /// exist. `command` must outlive this object.
    CommandLifecycle(const dictionary::Command& command, std::uint16_t count, double light_time_s, bool read_back);

    /// Notes that one of ground's own stages, queued … radiated, is done (ok) or failed, which ends the command.
    void ground_stage(Stage stage, Status status, std::string evidence, Ert at, std::vector<StageChange>& out);

    /// Notes the approval by a second person.
    void approved(std::string evidence, Ert at, std::vector<StageChange>& out);
    /// Notes that the command is authorised and waits on the ground.
    void await_release(std::string evidence, Ert at, std::vector<StageChange>& out);
    /// Notes that the uplink gave the command back before radiation. It waits on the ground again; `released` is
    /// pending.
    void taken_back(std::string evidence, Ert at, std::vector<StageChange>& out);
    /// Notes that the frame was radiated again: the windows restart.
    void radiated_again(std::string evidence, Ert at, std::vector<StageChange>& out);
    /// Notes a doubt about a radiated command that would not be sent now. The evidence says why its frame is not
    /// radiated again, or which assumption of its analysis no longer holds.
    void radiated_in_doubt(std::string evidence, Ert at, std::vector<StageChange>& out);
    /// Notes that the vehicle's frame receiver reports the frame: `received`, observed.
    void frame_taken(std::string evidence, Ert at, std::vector<StageChange>& out);
    /// Notes that no report will come: the vehicle may or may not have taken the frame.
    void frame_not_acknowledged(std::string evidence, Ert at, std::vector<StageChange>& out);

    void on(const Answer& answer, std::vector<StageChange>& out);
    void on(const ReadBack& read_back, Ert at, std::vector<StageChange>& out);
    void pass(Ert now, std::vector<StageChange>& out);

    Status status(Stage stage) const { return status_[static_cast<std::size_t>(stage)]; }
    bool exists(Stage stage) const;
    /// Whether every stage is ok or failed, so that nothing can change any more.
    bool finished() const;
    std::uint16_t count() const { return count_; }
    const dictionary::Command& command() const { return *command_; }

  private:
    void set(Stage stage, Status status, std::string evidence, Ert at, std::vector<StageChange>& out);
    void await_answers(Ert at, std::vector<StageChange>& out);
    void refused(const Answer& answer, std::vector<StageChange>& out);
    void infer_before(Stage stage, const Answer& answer, std::vector<StageChange>& out);
    void fail_after(Stage stage, const std::string& why, Ert at, std::vector<StageChange>& out);
    static std::optional<Stage> stage_named(const std::string& name);
    const dictionary::Verifier* verifier(Stage stage) const;
    double total_window_s(Stage stage) const;
    Ert deadline(Stage stage) const;

    const dictionary::Command* command_;
    std::uint16_t count_ = 0;
    double light_time_s_ = 0.0;
    bool read_back_ = false;
    std::array<Status, stage_count> status_{};
    std::optional<Ert> radiated_;
    std::optional<Sclk> executed_sclk_;
};

}  // namespace aeolis::commands
