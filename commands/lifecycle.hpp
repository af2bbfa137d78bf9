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

/// What is now known of one stage, and by what.
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
    std::string text;        ///< as people read it; for a refusal it says why
    Opcode opcode;
    std::uint16_t count = 0;  ///< packet count of the telecommand that it answers
    Sclk sclk;                ///< when it happened on board
    Ert ert;                  ///< when Earth learnt of it
};

/// One telecommand on its way, stage by stage, each with its evidence.
///
/// In       notices of ground's own stages; answers; read-backs; time passing (Earth's clock)
/// Out      changes, appended to `out`
/// Rules    a stage is ok only by evidence. `received` is observed when the vehicle reports the frame (CLCW), else
///          inferred from an answer, and says so. Silence until the window (of the dictionary, from radiation) plus
///          light time both ways is `unknown`, with words: the answer may be lost, or come later with the recording; it
///          then still counts. A refusal, or a read-back that differs, is `failed`. Ok never changes again, but for
///          `released` of what is taken back before it was radiated; failed only when a later read-back is equal.
/// Memory   a kilooctet
class CommandLifecycle {
  public:
    /// `read_back`: flight reports what it holds after this command, which decides `verified`; else that stage does not
    /// exist for it. The command must outlive this.
    CommandLifecycle(const dictionary::Command& command, std::uint16_t count, double light_time_s, bool read_back);

    /// One of ground's own stages, queued … radiated, was done (ok) or failed, which ends the command.
    void ground_stage(Stage stage, Status status, std::string evidence, Ert at, std::vector<StageChange>& out);

    /// A second person has approved it.
    void approved(std::string evidence, Ert at, std::vector<StageChange>& out);
    /// It may be sent, and waits on the ground.
    void await_release(std::string evidence, Ert at, std::vector<StageChange>& out);
    /// The uplink has given it back before it was radiated: it waits on the ground again, and `released` with it.
    void taken_back(std::string evidence, Ert at, std::vector<StageChange>& out);
    /// Its frame went out once more: the windows begin anew.
    void radiated_again(std::string evidence, Ert at, std::vector<StageChange>& out);
    /// It has left, and would not any more: why its frame does not go out once more, or what it was judged by no longer
    /// holds.
    void radiated_in_doubt(std::string evidence, Ert at, std::vector<StageChange>& out);
    /// The vehicle's receiver of frames reports that it took the frame: `received`, observed.
    void frame_taken(std::string evidence, Ert at, std::vector<StageChange>& out);
    /// No report will tell: the vehicle may have taken it or not.
    void frame_not_acknowledged(std::string evidence, Ert at, std::vector<StageChange>& out);

    void on(const Answer& answer, std::vector<StageChange>& out);
    void on(const ReadBack& read_back, Ert at, std::vector<StageChange>& out);
    void pass(Ert now, std::vector<StageChange>& out);

    Status status(Stage stage) const { return status_[static_cast<std::size_t>(stage)]; }
    bool exists(Stage stage) const;
    /// Nothing can change any more: every stage is ok or failed.
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
