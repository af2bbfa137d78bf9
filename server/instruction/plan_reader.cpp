// SPDX-License-Identifier: Apache-2.0
#include "server/instruction/plan_reader.hpp"

#include "server/instruction/team_reader.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace aeolis::server::instruction {
namespace {

using Kind = YamlNode::Kind;

constexpr double wind_mps_max = 1'000.0;           ///< what a scenario takes is less
constexpr double sensor_off_max = 1'000.0;         ///< the same
constexpr double duration_s_max = 7.0 * 86'400.0;  ///< chosen: no fault lasts longer than a week

class PlanReader : public TeamReader {
  public:
    PlanReader(const std::string& file, const dictionary::Dictionary& dictionary, const std::vector<Inject>& library,
               const CheckFault& check)
        : TeamReader(file, dictionary), library_(library), check_(check) {}

    ReadPlan read(std::string_view text);
    ReadLibrary read_library(std::string_view text);

  private:
    double duration_s(const YamlNode& node, std::string_view name);
    double part(const YamlNode& node, std::string_view name, double least, double most, std::string_view unit);
    /// A value of an enumeration; 0 when it is missing or unknown.
    int enumerated(const YamlNode& node, std::string_view name, const google::protobuf::EnumDescriptor& all,
                   std::string_view prefix);
    void device_fault(const YamlNode& node, v1::DeviceFault& fault);
    void uhf_loss(const YamlNode& node, v1::UhfLoss& loss);
    void wind_shift(const YamlNode& node, v1::WindShift& shift);
    void air_shift(const YamlNode& node, v1::AirShift& shift);
    void sensor_error(const YamlNode& node, v1::SensorError& error);
    void false_tone(const YamlNode& node, v1::FalseTone& tone);
    v1::FaultInjection fault(const YamlNode& node);
    std::vector<Inject> injects(const YamlNode& root, bool of_plan);
    Inject inject(const YamlNode& node, bool of_plan);
    Inject used(const YamlNode& node);
    void trigger(const YamlNode& node, Inject& inject);
    void check_contradiction(const Inject& inject, const YamlNode& node);
    void check_against_others(const InjectPlan& plan, const YamlNode& list);

    const std::vector<Inject>& library_;
    const CheckFault& check_;
};

double PlanReader::part(const YamlNode& node, std::string_view name, double least, double most, std::string_view unit) {
    const YamlNode* given = node.member(name);
    return given == nullptr ? 0.0 : number(*given, name, least, most, unit).value_or(0.0);
}

double PlanReader::duration_s(const YamlNode& node, std::string_view name) {
    return part(node, name, 0.0, duration_s_max, " s");
}

void PlanReader::uhf_loss(const YamlNode& node, v1::UhfLoss& loss) {
    static constexpr std::array must{std::string_view{"fraction"}, std::string_view{"duration_s"}};
    if (!table(node, "a loss of UHF", must, {})) return;
    loss.set_fraction(part(node, "fraction", 0.0, 1.0, ""));
    loss.set_duration_s(duration_s(node, "duration_s"));
}

void PlanReader::wind_shift(const YamlNode& node, v1::WindShift& shift) {
    static constexpr std::array must{std::string_view{"east_mps"}, std::string_view{"north_mps"},
                                     std::string_view{"duration_s"}};
    if (!table(node, "a shift of the wind", must, {})) return;
    shift.set_east_mps(part(node, "east_mps", -wind_mps_max, wind_mps_max, " m/s"));
    shift.set_north_mps(part(node, "north_mps", -wind_mps_max, wind_mps_max, " m/s"));
    shift.set_duration_s(duration_s(node, "duration_s"));
}

void PlanReader::air_shift(const YamlNode& node, v1::AirShift& shift) {
    static constexpr std::array must{std::string_view{"fraction"}, std::string_view{"duration_s"}};
    if (!table(node, "a shift of the air", must, {})) return;
    shift.set_fraction(part(node, "fraction", -1.0, 1.0, ""));
    shift.set_duration_s(duration_s(node, "duration_s"));
}

void PlanReader::sensor_error(const YamlNode& node, v1::SensorError& error) {
    static constexpr std::array must{std::string_view{"device"}, std::string_view{"unit"},
                                     std::string_view{"duration_s"}};
    static constexpr std::array may{std::string_view{"off_by"}, std::string_view{"grows_per_s"}};
    if (!table(node, "an error of a sensor", must, may)) return;
    error.set_device(static_cast<v1::Device>(enumerated(node, "device", *v1::Device_descriptor(), "DEVICE_")));
    error.set_unit(
        static_cast<v1::RedundantUnit>(enumerated(node, "unit", *v1::RedundantUnit_descriptor(), "REDUNDANT_UNIT_")));
    error.set_off_by(part(node, "off_by", -sensor_off_max, sensor_off_max, ""));
    error.set_grows_per_s(part(node, "grows_per_s", -sensor_off_max, sensor_off_max, ""));
    error.set_duration_s(duration_s(node, "duration_s"));
    if (error.off_by() == 0.0 && error.grows_per_s() == 0.0)
        add(node.mark, "an error of a sensor has 'off_by' or 'grows_per_s', which is not 0");
}

void PlanReader::false_tone(const YamlNode& node, v1::FalseTone& tone) {
    static constexpr std::array must{std::string_view{"tone"}, std::string_view{"duration_s"}};
    if (!table(node, "a false tone", must, {})) return;
    if (const YamlNode* given = node.member("tone")) {
        const std::string name = words(*given, "tone");
        const auto row = std::ranges::find(dictionary_.tones, name, &dictionary::ToneRow::name);
        if (row != dictionary_.tones.end() && row->set != dictionary::ToneSet::spare)
            tone.set_tone(row->id.value);
        else if (!name.empty())
            add(given->mark, procedures::unknown_name(name, "tone", dictionary_.tones,
                                                      [](const auto& one) { return std::string_view{one.name}; }));
    }
    tone.set_duration_s(duration_s(node, "duration_s"));
}

int PlanReader::enumerated(const YamlNode& node, std::string_view name, const google::protobuf::EnumDescriptor& all,
                           std::string_view prefix) {
    const YamlNode* given = node.member(name);
    return given == nullptr ? 0 : enumerator(*given, name, all, prefix).value_or(0);
}

void PlanReader::device_fault(const YamlNode& node, v1::DeviceFault& fault) {
    static constexpr std::array must{std::string_view{"device"}, std::string_view{"unit"}, std::string_view{"kind"},
                                     std::string_view{"duration_s"}};
    static constexpr std::array may{std::string_view{"late_s"}};
    if (!table(node, "a fault of a device", must, may)) return;
    fault.set_device(static_cast<v1::Device>(enumerated(node, "device", *v1::Device_descriptor(), "DEVICE_")));
    fault.set_unit(
        static_cast<v1::RedundantUnit>(enumerated(node, "unit", *v1::RedundantUnit_descriptor(), "REDUNDANT_UNIT_")));
    fault.set_kind(static_cast<v1::DeviceFaultKind>(
        enumerated(node, "kind", *v1::DeviceFaultKind_descriptor(), "DEVICE_FAULT_KIND_")));
    fault.set_duration_s(duration_s(node, "duration_s"));
    const YamlNode* late = node.member("late_s");
    if (late == nullptr) return;
    fault.set_late_s(duration_s(node, "late_s"));
    if (fault.kind() != v1::DEVICE_FAULT_KIND_LATE) add(late->mark, "'late_s' stands beside 'kind: late' only");
}

v1::FaultInjection PlanReader::fault(const YamlNode& node) {
    v1::FaultInjection read;
    const auto before = findings_.size();
    if (node.member("device") != nullptr) {
        device_fault(node, *read.mutable_device_fault());
    } else {
        static constexpr std::array kinds{std::string_view{"station_outage_s"}, std::string_view{"orbiter_outage_s"},
                                          std::string_view{"system_fault_s"},   std::string_view{"computer_reset"},
                                          std::string_view{"uhf_loss"},         std::string_view{"wind_shift"},
                                          std::string_view{"air_shift"},        std::string_view{"sensor_error"},
                                          std::string_view{"false_tone"}};
        if (!table(node, "a fault", {}, kinds)) return read;
        if (node.keys.size() != 1)
            add(node.mark, "a fault is one of these: device, station_outage_s, orbiter_outage_s, system_fault_s, "
                           "computer_reset, uhf_loss, wind_shift, air_shift, sensor_error, false_tone");
        else if (node.member("station_outage_s") != nullptr)
            read.mutable_station_outage()->set_duration_s(duration_s(node, "station_outage_s"));
        else if (node.member("orbiter_outage_s") != nullptr)
            read.mutable_orbiter_outage()->set_duration_s(duration_s(node, "orbiter_outage_s"));
        else if (const YamlNode* loss = node.member("uhf_loss"))
            uhf_loss(*loss, *read.mutable_uhf_loss());
        else if (const YamlNode* shift = node.member("wind_shift"))
            wind_shift(*shift, *read.mutable_wind_shift());
        else if (const YamlNode* air = node.member("air_shift"))
            air_shift(*air, *read.mutable_air_shift());
        else if (const YamlNode* sensor = node.member("sensor_error"))
            sensor_error(*sensor, *read.mutable_sensor_error());
        else if (const YamlNode* tone = node.member("false_tone"))
            false_tone(*tone, *read.mutable_false_tone());
        else if (node.member("system_fault_s") != nullptr)
            read.mutable_system_fault()->set_duration_s(duration_s(node, "system_fault_s"));
        else if (const YamlNode* reset = node.member("computer_reset"))
            read.set_computer_reset(yes_or_no(*reset, "computer_reset").value_or(true));
    }
    if (findings_.size() == before && check_)
        if (const auto possible = check_(read); !possible) add(node.mark, possible.error().message);
    return read;
}

/// The commands that are wanted and unwanted at once.
void PlanReader::check_contradiction(const Inject& inject, const YamlNode& node) {
    using Act = Expectation::Act;
    for (const auto& wanted : inject.handling.team)
        for (const auto& unwanted : inject.handling.team) {
            if (wanted.act != Act::command || unwanted.act != Act::no_command) continue;
            const bool all_unwanted =
                unwanted.names.empty() || std::ranges::all_of(wanted.names, [&](const auto& name) {
                    return std::ranges::find(unwanted.names, name) != unwanted.names.end();
                });
            if (all_unwanted)
                add(node.mark,
                    fmt::format("inject '{}': its team {}, and {}", inject.id, text_of(wanted), text_of(unwanted)));
        }
}

/// When an inject is due, by the clock alone; none: something else decides.
std::optional<double> due_e_s(const Inject& inject) {
    if (inject.when.size() != 1) return std::nullopt;
    const auto* time = std::get_if<procedures::TimeCondition>(&inject.when.front());
    if (time == nullptr || time->from.where != procedures::EntryTime::Where::vehicle) return std::nullopt;
    return time->from.e_s + inject.after_s;
}

/// Whether two faults are of one unit at once.
bool same_unit_at_once(const Inject& a, const Inject& b, double apart_s) {
    if (!a.fault.has_device_fault() || !b.fault.has_device_fault()) return false;
    const auto &of_a = a.fault.device_fault(), &of_b = b.fault.device_fault();
    return of_a.device() == of_b.device() && of_a.unit() == of_b.unit() &&
           (apart_s >= 0.0 ? apart_s < of_a.duration_s() : -apart_s < of_b.duration_s());
}

/// Whether a command that one team shall send falls into a time in which another shall send none.
bool forbids(const Inject& none, const Inject& some, double apart_s) {
    using Act = Expectation::Act;
    for (const auto& unwanted : none.handling.team)
        for (const auto& wanted : some.handling.team)
            if (unwanted.act == Act::no_command && wanted.act == Act::command && apart_s >= 0.0 &&
                apart_s + wanted.within_s <= unwanted.within_s &&
                (unwanted.names.empty() || std::ranges::all_of(wanted.names, [&](const auto& name) {
                     return std::ranges::find(unwanted.names, name) != unwanted.names.end();
                 })))
                return true;
    return false;
}

/// Injects at fixed times that cannot both be.
void PlanReader::check_against_others(const InjectPlan& plan, const YamlNode& list) {
    for (std::size_t i = 0; i < plan.injects.size(); ++i)
        for (std::size_t k = 0; k < i; ++k) {
            const Inject &later = plan.injects[i], &before = plan.injects[k];
            const auto at = due_e_s(later), at_before = due_e_s(before);
            if (!at || !at_before) continue;
            const double apart_s = *at - *at_before;
            const auto mark = list.items[i].mark;
            if (same_unit_at_once(before, later, apart_s))
                add(mark, fmt::format("injects '{}' and '{}' are faults of one unit at once", before.id, later.id));
            if (forbids(before, later, apart_s) || forbids(later, before, -apart_s))
                add(mark, fmt::format("injects '{}' and '{}': of one a command is wanted while the other forbids it",
                                      before.id, later.id));
        }
}

/// The inject of the library that `use` names, or nothing.
Inject PlanReader::used(const YamlNode& node) {
    const YamlNode* use = node.member("use");
    if (use == nullptr) return {};
    const std::string name = words(*use, "'use'");
    const auto known = std::ranges::find(library_, name, &Inject::id);
    if (known != library_.end()) return *known;
    if (!name.empty())
        add(use->mark, procedures::unknown_name(name, "inject of the library", library_,
                                                [](const Inject& each) -> std::string_view { return each.id; }));
    return {};
}

void PlanReader::trigger(const YamlNode& node, Inject& inject) {
    if (const YamlNode* when = node.member("when")) {
        if (when->kind != Kind::scalar)
            inject.when = conditions(when);
        else if (words(*when, "'when'") != "by hand")
            add(when->mark, "'when' is 'by hand', or a list of conditions");
    }
    if (const YamlNode* after = node.member("after_s")) {
        inject.after_s = number(*after, "after_s", 0.0, within_s_max, " s").value_or(0.0);
        if (inject.when.empty()) add(after->mark, "what is injected by hand has no 'after_s'");
    }
}

Inject PlanReader::inject(const YamlNode& node, bool of_plan) {
    static constexpr std::array must{std::string_view{"inject"}, std::string_view{"when"}};
    static constexpr std::array must_in_library{std::string_view{"inject"}};
    static constexpr std::array may{std::string_view{"title"}, std::string_view{"fault"}, std::string_view{"shows"},
                                    std::string_view{"signs"}, std::string_view{"team"},  std::string_view{"after_s"},
                                    std::string_view{"use"}};
    constexpr std::size_t may_in_library = 5;
    Inject read;
    if (!(of_plan ? table(node, "an inject", must, may)
                  : table(node, "an inject", must_in_library, std::span{may}.first(may_in_library))))
        return read;
    read = used(node);
    if (const YamlNode* name = node.member("inject")) read.id = id(*name, "inject");
    for (const std::string_view part : {"title", "fault"})
        if (node.member(part) == nullptr && node.member("use") == nullptr)
            add(node.mark, fmt::format("an inject lacks '{}'{}", part, of_plan ? ", or 'use' of one that has it" : ""));
    if (node.member("title") != nullptr) read.title = words(node, "title", "the title of an inject");
    if (node.member("shows") != nullptr) read.shows = words(node, "shows", "what shows of an inject");
    trigger(node, read);
    if (const YamlNode* given = node.member("fault")) read.fault = fault(*given);
    if (node.member("team") != nullptr || node.member("signs") != nullptr) read.handling = handling(node);
    if (read.handling.team.empty() && node.member("team") != nullptr)
        add(node.member("team")->mark,
            "a team that shall do nothing: leave 'team' out, and the rubric says what it does");
    if (read.handling.team.empty() && !read.handling.signs.empty())
        add(node.member("signs")->mark, "'signs' stands beside a 'team'; without one the rubric says both");
    check_contradiction(read, node);
    return read;
}

std::vector<Inject> PlanReader::injects(const YamlNode& root, bool of_plan) {
    std::vector<Inject> all;
    const YamlNode* given = root.member("injects");
    for (const YamlNode& item : list(given, "'injects'", injects_max)) all.push_back(inject(item, of_plan));
    if (given != nullptr && given->kind == Kind::sequence && given->items.empty())
        add(given->mark, "'injects' has no inject");
    return all;
}

ReadPlan PlanReader::read(std::string_view text) {
    static constexpr std::array must{std::string_view{"plan"}, std::string_view{"title"}, std::string_view{"purpose"},
                                     std::string_view{"source"}, std::string_view{"injects"}};
    static constexpr std::array may{std::string_view{"scenario"}};
    auto document = procedures::read_yaml(text, file_);
    findings_ = std::move(document.findings);
    InjectPlan plan;
    if (document.root && table(*document.root, "a plan", must, may)) {
        const YamlNode& root = *document.root;
        plan.id = id_of_file(root, "plan");
        plan.title = words(root, "title", "'title'");
        plan.purpose = words(root, "purpose", "'purpose'");
        plan.source = words(root, "source", "'source'");
        plan.scenario = words(root, "scenario", "'scenario'");
        plan.injects = injects(root, true);
        if (findings_.empty()) check_against_others(plan, *root.member("injects"));
    }
    if (findings_.empty() && document.root) return {std::move(plan), {}};
    return {std::nullopt, all_findings()};
}

ReadLibrary PlanReader::read_library(std::string_view text) {
    static constexpr std::array must{std::string_view{"library"}, std::string_view{"source"},
                                     std::string_view{"injects"}};
    auto document = procedures::read_yaml(text, file_);
    findings_ = std::move(document.findings);
    std::vector<Inject> read;
    if (document.root && table(*document.root, "a library", must, {})) {
        static_cast<void>(id_of_file(*document.root, "library"));
        static_cast<void>(words(*document.root, "source", "'source'"));
        read = injects(*document.root, false);
    }
    if (findings_.empty() && document.root) return {std::move(read), {}};
    return {std::nullopt, all_findings()};
}

}  // namespace

std::string ReadPlan::findings_text() const {
    std::string text;
    for (const auto& finding : findings) text += (text.empty() ? "" : "\n") + finding.text();
    return text;
}

ReadLibrary read_library(std::string_view text, const std::string& file, const dictionary::Dictionary& dictionary,
                         const CheckFault& check) {
    return PlanReader{file, dictionary, {}, check}.read_library(text);
}

ReadPlan read_plan(std::string_view text, const std::string& file, const dictionary::Dictionary& dictionary,
                   const std::vector<Inject>& library, const CheckFault& check) {
    return PlanReader{file, dictionary, library, check}.read(text);
}

ReadPlan read_plan(const v1::InstructorPlan& kept, const dictionary::Dictionary& dictionary) {
    std::vector<Inject> library;
    if (!kept.library().empty()) {
        auto read = read_library(kept.library(), "injects.yaml", dictionary, {});
        if (!read.injects) return {std::nullopt, std::move(read.findings)};
        library = std::move(*read.injects);
    }
    return read_plan(kept.text(), kept.name(), dictionary, library, {});
}

}  // namespace aeolis::server::instruction
