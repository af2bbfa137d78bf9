// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/items.pb.h"
#include "aeolis/v1/run.pb.h"
#include "aeolis/v1/score.pb.h"
#include "common/time.hpp"
#include "dictionaries/dictionary.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

// What people did in a rehearsal, and what they did it about: read from the items of the run. Times are seconds from
// entry of the signal received on Earth then.
namespace aeolis::server {

struct Acknowledged {
    double after_s = 0.0;
    std::string by;
};
struct RaisedAlarm {
    std::string name, limit;
    double e_s = 0.0;
    std::optional<Acknowledged> acknowledged{};
};

/// Each alarm from its raising, or its raising again, to the first acknowledgement.
class RaisedAlarms {
  public:
    std::vector<RaisedAlarm> all;  ///< in their order

    void take_raised(const std::string& name, std::string limit, double e_s);
    void take_inside(const std::string& name) { inside_.insert(name); }
    void take_acknowledged(const v1::AlarmAction& action, double e_s);

  private:
    std::map<std::string, std::size_t> open_;  ///< outside its limits, or not acknowledged yet: its place in `all`
    std::set<std::string> inside_;
};

struct CommandOutcome {
    enum class How : std::uint8_t { done, failed, cancelled, not_known };
    std::string name;
    std::uint64_t number = 0;
    std::optional<double> e_s{};
    How how = How::not_known;
    std::string why{};
    std::optional<std::string> sender{};  ///< who signed it; none: the scenario's script
};

/// Something that a person did.
struct PersonsAct {
    enum class Kind : std::uint8_t { alarm, command, note, procedure, position };
    Kind kind = Kind::note;
    double e_s = 0.0;
    std::string by;
    std::string deed;   ///< "sent NO_OP"
    std::string about;  ///< the alarm's or the command's name, the note's text; else empty
    /// A command that failed or was cancelled; a line that reads a call back, and says nothing itself.
    bool without_effect = false;

    std::string words() const;  ///< "Ann: sent NO_OP"
    v1::ScoreAct told() const;
};

struct ScoreActs {
    RaisedAlarms raised;
    std::vector<CommandOutcome> commands;                 ///< of people and of the script
    std::vector<PersonsAct> acts;                         ///< by time
    std::map<std::string, std::vector<double>> heard;     ///< events and tones that were received live, by name
    std::map<std::string, std::vector<double>> on_board;  ///< events, when the vehicle reported them, live or recorded
};

/// @param alarms  changes of alarms and actions on them, in their order
/// @param room    acts on procedures and on positions
/// @param heard   event reports and tones; what only the recording brought does not count as heard
/// @param end     of the run, on Earth: what people did from then on, while they looked back, does not count
ScoreActs acts_of(const v1::AsFlownReport& report, const std::vector<v1::Item>& alarms,
                  const std::vector<v1::Item>& room, const std::vector<v1::Item>& heard, std::optional<Ert> end,
                  const dictionary::Dictionary& dictionary);

/// "PYRO_CONTROLLER_SILENT" as "pyro controller silent".
std::string in_words(std::string name);

}  // namespace aeolis::server
