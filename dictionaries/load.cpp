#include "dictionaries/dictionary.hpp"

#include "common/crc.hpp"
#include "dictionaries/findings.hpp"
#include "dictionaries/enumerations.hpp"
#include "dictionaries/spreadsheet/owners.hpp"
#include "dictionaries/spreadsheet/state_machines.hpp"
#include "dictionaries/spreadsheet/tables.hpp"
#include "dictionaries/spreadsheet/telemetry_plan.hpp"
#include "dictionaries/xtce/space_system.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <system_error>
#include <tuple>

namespace aeolis::dictionary {
namespace {

constexpr std::uintmax_t file_octets_max = 16U << 20U; // ours: a hundred times the landing's largest file

struct File {
    std::string name;
    std::optional<std::string> text; ///< none: a finding says why
};

File read_file(const std::filesystem::path& path, std::vector<Finding>& all) {
    File file{path.filename().string(), std::nullopt};
    Findings findings{file.name, all};
    std::error_code error;
    const std::uintmax_t octets = std::filesystem::file_size(path, error);
    std::ifstream in{path, std::ios::binary};
    if (error || !in)
        findings.add(1, "cannot be read: " + path.string());
    else if (octets > file_octets_max)
        findings.add(1, "is larger than " + std::to_string(file_octets_max) + " octets");
    else
        file.text = std::string{std::istreambuf_iterator<char>{in}, {}};
    return file;
}

/// The one XTCE file of the folder.
File read_xtce(const std::filesystem::path& directory, std::vector<Finding>& all) {
    std::vector<std::filesystem::path> found;
    std::error_code error;
    for (std::filesystem::directory_iterator entry{directory, error}, end; !error && entry != end;
         entry.increment(error))
        if (entry->path().extension() == ".xml") found.push_back(entry->path());
    if (found.size() == 1) return read_file(found.front(), all);
    std::ranges::sort(found);
    const std::string name = found.empty() ? directory.filename().string() : found[1].filename().string();
    Findings{name, all}.add(1, found.empty() ? "there is no XTCE file (*.xml) in " + directory.string()
                                             : "a second XTCE file beside " + found[0].filename().string());
    return {name, std::nullopt};
}

/// Changes with every change of any of the files, and with a move of content from one to the next.
std::uint16_t hash(std::initializer_list<const File*> files) {
    std::vector<std::uint8_t> octets;
    for (const File* file : files) {
        const std::string frame = file->name + ":" + std::to_string(file->text->size()) + "\n";
        octets.insert(octets.end(), frame.begin(), frame.end());
        octets.insert(octets.end(), file->text->begin(), file->text->end());
    }
    return crc16(octets);
}

std::vector<TimelineContext::DeclaredEvent> declared(const xtce::SpaceSystem& system) {
    std::vector<TimelineContext::DeclaredEvent> events;
    events.reserve(system.declared_events.size());
    for (const auto& event : system.declared_events)
        events.push_back({event.name, event.has_arguments});
    return events;
}

} // namespace

Loaded load(const std::filesystem::path& directory) {
    Loaded loaded;
    auto& all = loaded.findings;
    const File xml = read_xtce(directory, all);
    const File anchors_csv = read_file(directory / "anchors.csv", all);
    const File tones_csv = read_file(directory / "tones.csv", all);
    const File mfsk_csv = read_file(directory / "mfsk.csv", all);
    const File parameters_csv = read_file(directory / "parameters.csv", all);
    const File timeline_csv = read_file(directory / "timeline.csv", all);

    const auto read = [&](const File& file, auto reader) -> decltype(reader(*file.text, std::declval<Findings&>())) {
        if (!file.text) return std::nullopt;
        Findings findings{file.name, all};
        return reader(*file.text, findings);
    };
    // A name that its own sheet has wrong is one fault, not one more for each row of another that uses it.
    const auto is_sound = [&](const File& file) {
        return std::ranges::find(all, file.name, &Finding::file) == all.end();
    };
    auto system = read(xml, xtce::read_space_system);
    auto anchors = read(anchors_csv, read_anchors);
    auto tones = read(tones_csv, read_tones);
    auto mfsk = read(mfsk_csv, read_mfsk);
    auto parameters = read(parameters_csv, read_parameters);
    std::vector<TimelineContext::DeclaredEvent> events;
    if (system) events = declared(*system);
    const TimelineContext context{anchors ? &*anchors : nullptr, tones ? &*tones : nullptr, system ? &events : nullptr};
    auto timeline = read(timeline_csv, [&](std::string_view text, Findings& findings) {
        return read_timeline(text, context, findings);
    });

    const File plan_csv = read_file(directory / "telemetry_plan.csv", all);
    auto telemetry_plan = read(plan_csv, [&](std::string_view text, Findings& findings) {
        return read_telemetry_plan(text, system && is_sound(xml) ? &system->packets : nullptr, findings);
    });

    const File constraints_csv = read_file(directory / "constraints.csv", all);
    const ConstraintContext moments{timeline && is_sound(timeline_csv) ? &*timeline : nullptr,
                                    anchors && is_sound(anchors_csv) ? &*anchors : nullptr};
    auto constraints = read(constraints_csv, [&](std::string_view text, Findings& findings) {
        return read_constraints(text, moments, findings);
    });

    const File state_machines_csv = read_file(directory / "state_machines.csv", all);
    std::vector<const Type*> enumerations;
    const bool has_enumerations = system && is_sound(xml);
    if (has_enumerations) enumerations = enumerations_of(system->packets, system->commands);
    auto state_machines = read(state_machines_csv, [&](std::string_view text, Findings& findings) {
        return read_state_machines(text, has_enumerations ? &enumerations : nullptr, findings);
    });

    const File owners_csv = read_file(directory / "owners.csv", all);
    const OwnerContext owned{timeline && is_sound(timeline_csv) ? &*timeline : nullptr,
                             has_enumerations ? &enumerations : nullptr};
    auto owners = read(owners_csv, [&](std::string_view text, Findings& findings) {
        return read_owners(text, owned, findings);
    });

    std::ranges::stable_sort(
        all, [](const Finding& a, const Finding& b) { return std::tie(a.file, a.line) < std::tie(b.file, b.line); });
    if (!all.empty()) return loaded;

    Dictionary dictionary;
    dictionary.mission = std::move(system->mission);
    dictionary.id = hash({&xml, &anchors_csv, &tones_csv, &mfsk_csv, &parameters_csv, &timeline_csv, &constraints_csv,
                          &state_machines_csv, &owners_csv, &plan_csv});
    // Without constraints.csv: flight checks it and does not act on it, so it makes no other timeline.
    dictionary.timeline_version = hash({&timeline_csv, &anchors_csv});
    dictionary.channels = std::move(system->channels);
    dictionary.packets = std::move(system->packets);
    dictionary.events = std::move(system->events);
    dictionary.commands = std::move(system->commands);
    dictionary.timeline = std::move(*timeline);
    dictionary.anchors = std::move(*anchors);
    dictionary.tones = std::move(*tones);
    dictionary.mfsk = *mfsk;
    dictionary.parameters = std::move(*parameters);
    dictionary.constraints = std::move(*constraints);
    dictionary.state_machines = std::move(*state_machines);
    dictionary.owners = std::move(*owners);
    dictionary.telemetry_plan = std::move(*telemetry_plan);
    loaded.dictionary = std::move(dictionary);
    return loaded;
}

} // namespace aeolis::dictionary
