// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/scenario.pb.h"
#include "server/procedures/procedure.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

// An instructor's plan as data: what is done to a landing, when, and what a good team does about it by when. And the
// rubric: what of all that is worth how much.
namespace aeolis::server::instruction {

/// What of a team is scored.
enum class Skill : std::uint8_t { detection, diagnosis, action, procedure, communication };
inline constexpr std::array skills{Skill::detection, Skill::diagnosis, Skill::action, Skill::procedure,
                                   Skill::communication};
std::string_view name_of(Skill skill);

/// Something that a good team does within a time.
struct Expectation {
    enum class Act : std::uint8_t {
        acknowledge,  ///< one of the alarms `names`, each a channel, a packet or a link
        note,         ///< a line of the log with one of the words `names`; without any, any line
        command,      ///< one of the commands `names` is sent and carried out
        no_command,   ///< none of the commands `names` is sent; without any, none at all
    };
    Skill of = Skill::detection;
    Act act = Act::note;
    std::vector<std::string> names;
    double within_s = 0.0;  ///< from the first sign on
};

/// A fault as a kind: what shows it, and what a good team does. Signs are events, tones, and alarms by name. The first of
/// them that is received starts the team's time; with none listed the fault's beginning does, as it is felt on Earth.
struct Handling {
    std::vector<std::string> signs;
    std::vector<Expectation> team;
};

struct Inject {
    std::string id;
    std::string title;
    std::string shows;                        ///< what the room can see of it, in words
    std::vector<procedures::Condition> when;  ///< all must hold, as the vehicle itself knows it; none: by hand
    double after_s = 0.0;                     ///< from then on
    v1::FaultInjection fault;
    Handling handling;  ///< empty: the rubric's of such a fault
};

struct InjectPlan {
    std::string id;  ///< the name of its file
    std::string title;
    std::string purpose;
    std::string source;
    std::string scenario;  ///< for which it was written; empty: any
    std::vector<Inject> injects;
};

/// What the rubric says of a kind of fault. A field not set fits any.
struct FaultHandling {
    v1::FaultInjection::FaultCase kind = v1::FaultInjection::FAULT_NOT_SET;
    std::optional<v1::Device> device;
    std::optional<v1::DeviceFaultKind> device_kind;
    Handling handling;
};

/// A line of the log that is wanted in any landing, after something was first heard live.
struct Call {
    std::string after;  ///< an event or a tone
    std::vector<std::string> words;
    double within_s = 0.0;
};

/// What is worth how much of 100 points.
struct Rubric {
    std::string id;
    std::string title;
    double landing_worth = 0.0;
    std::array<double, skills.size()> worth{};  ///< by Skill; with landing_worth 100 together
    double alarm_within_s = 0.0;                ///< an acknowledgement counts in full up to here
    double alarm_until_s = 0.0;                 ///< and not at all from here on
    double present_s = 0.0;                     ///< restraint counts for who did anything in this time before its end
    std::vector<Call> calls;
    std::vector<FaultHandling> faults;  ///< the first that fits counts

    /// How such a fault is handled; nothing is expected of one that the rubric does not have.
    const Handling& handling_of(const v1::FaultInjection& fault) const;
};

inline constexpr std::size_t injects_max = 100;      ///< as many faults as a run takes
inline constexpr std::size_t expectations_max = 20;  ///< of an inject; chosen
inline constexpr double within_s_max = 86'400.0;     ///< chosen: a day

/// The share of an act that came `after_s`: 1 within `within_s`, from there on down to 0 at `none_s`; none: 0.
double share_of(std::optional<double> after_s, double within_s, double none_s);

// ---- in words ----------------------------------------------------------------------------------------------------

std::string text_of(const v1::FaultInjection& fault);  ///< "pyro A silent, for 40 s"
std::string text_of(const Expectation& expectation);   ///< "acknowledges uhf_live within 60 s"
/// What a good team does, "detection: acknowledges …", by the inject's own words or the rubric's.
std::vector<std::string> team_texts(const Inject& inject, const Rubric& rubric);
/// "at E+1:30 vehicle, 2 s later"; empty: by hand.
std::string when_text(const Inject& inject, const dictionary::Dictionary& dictionary);

}  // namespace aeolis::server::instruction
