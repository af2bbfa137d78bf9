// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/dictionary.hpp"

#include "common/bytes.hpp"
#include "common/check.hpp"
#include "common/crc.hpp"
#include "dictionaries/enumerations.hpp"
#include "dictionaries/findings.hpp"
#include "dictionaries/mission_files.hpp"
#include "dictionaries/spreadsheet/csv.hpp"
#include "dictionaries/spreadsheet/owners.hpp"
#include "dictionaries/spreadsheet/state_machines.hpp"
#include "dictionaries/spreadsheet/tables.hpp"
#include "dictionaries/spreadsheet/telemetry_plan.hpp"
#include "dictionaries/xtce/space_system.hpp"

#include <algorithm>
#include <array>
#include <openssl/evp.h>
#include <tuple>

namespace aeolis::dictionary {
namespace {

using File = MissionFile;

/// Hash that changes with any change of the files, and when content moves from one file to the next.
std::uint16_t hash(std::initializer_list<const File*> files) {
    std::vector<std::uint8_t> octets;
    for (const File* file : files) {
        const std::string frame = file->name + ":" + std::to_string(file->text->size()) + "\n";
        octets.insert(octets.end(), frame.begin(), frame.end());
        octets.insert(octets.end(), file->text->begin(), file->text->end());
    }
    return crc16(octets);
}

/// The first 32 bits of the SHA-256 of what the sheets hold, cell by cell: line ends and quotes change nothing.
std::uint32_t content_hash(std::initializer_list<const File*> sheets) {
    std::string content;
    std::vector<Finding> known;  // a sheet that is no CSV has been told of when it was read
    for (const File* file : sheets) {
        Findings findings{file->name, known};
        const auto sheet = read_csv(*file->text, findings);
        const auto add = [&](const Sheet::Row& row) {
            content += std::to_string(row.cells.size()) + "\n";
            for (const std::string& cell : row.cells) content += std::to_string(cell.size()) + ":" + cell;
        };
        content += file->name + ":" + std::to_string(sheet->rows.size()) + "\n";
        add(sheet->header);
        std::ranges::for_each(sheet->rows, add);
    }
    std::array<std::uint8_t, EVP_MAX_MD_SIZE> sha256{};
    AEOLIS_CHECK(EVP_Digest(content.data(), content.size(), sha256.data(), nullptr, EVP_sha256(), nullptr) == 1);
    return static_cast<std::uint32_t>(read_bits(sha256, 0, 32));
}

std::vector<TimelineContext::DeclaredEvent> declared(const xtce::SpaceSystem& system) {
    std::vector<TimelineContext::DeclaredEvent> events;
    events.reserve(system.declared_events.size());
    for (const auto& event : system.declared_events) events.push_back({event.name, event.has_arguments});
    return events;
}

}  // namespace

Loaded load(const std::filesystem::path& path) {
    Loaded loaded;
    auto& all = loaded.findings;
    const MissionFiles files = read_mission_files(path, all);
    const File& xml = files.xtce;
    const File& anchors_csv = files.sheet("anchors.csv");
    const File& tones_csv = files.sheet("tones.csv");
    const File& mfsk_csv = files.sheet("mfsk.csv");
    const File& parameters_csv = files.sheet("parameters.csv");
    const File& timeline_csv = files.sheet("timeline.csv");

    const auto read = [&](const File& file, auto reader) -> decltype(reader(*file.text, std::declval<Findings&>())) {
        if (!file.text) return std::nullopt;
        Findings findings{file.name, all};
        return reader(*file.text, findings);
    };
    // A name that is wrong in its own sheet is one fault; rows of other sheets that use it are not reported as well.
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

    const File& plan_csv = files.sheet("telemetry_plan.csv");
    auto telemetry_plan = read(plan_csv, [&](std::string_view text, Findings& findings) {
        return read_telemetry_plan(text, system && is_sound(xml) ? &system->packets : nullptr, findings);
    });

    const File& constraints_csv = files.sheet("constraints.csv");
    const ConstraintContext moments{timeline && is_sound(timeline_csv) ? &*timeline : nullptr,
                                    anchors && is_sound(anchors_csv) ? &*anchors : nullptr};
    auto constraints = read(constraints_csv, [&](std::string_view text, Findings& findings) {
        return read_constraints(text, moments, findings);
    });

    const File& state_machines_csv = files.sheet("state_machines.csv");
    std::vector<const Type*> enumerations;
    const bool has_enumerations = system && is_sound(xml);
    if (has_enumerations) enumerations = enumerations_of(system->packets, system->commands);
    auto state_machines = read(state_machines_csv, [&](std::string_view text, Findings& findings) {
        return read_state_machines(text, has_enumerations ? &enumerations : nullptr, findings);
    });

    const File& owners_csv = files.sheet("owners.csv");
    auto owners = read(owners_csv, [&](std::string_view text, Findings& findings) {
        return read_owners(text, has_enumerations ? &enumerations : nullptr, findings);
    });

    const File& clock_csv = files.sheet("clock_correlation.csv");
    auto clock = read(clock_csv, read_clock_correlation);
    const File& predicted_csv = files.sheet("predicted_anchors.csv");
    auto predicted = read(predicted_csv, [&](std::string_view text, Findings& findings) {
        return read_predicted_anchors(text, anchors && is_sound(anchors_csv) ? &*anchors : nullptr, findings);
    });

    std::ranges::stable_sort(
        all, [](const Finding& a, const Finding& b) { return std::tie(a.file, a.line) < std::tie(b.file, b.line); });
    if (!all.empty()) return loaded;

    Dictionary dictionary;
    dictionary.mission = std::move(system->mission);
    dictionary.id = hash({&xml, &anchors_csv, &tones_csv, &mfsk_csv, &parameters_csv, &timeline_csv, &constraints_csv,
                          &state_machines_csv, &owners_csv, &plan_csv});
    // constraints.csv is left out: flight only monitors it, so it does not change the timeline.
    dictionary.timeline_version = content_hash({&timeline_csv, &anchors_csv});
    dictionary.channels = std::move(system->channels);
    dictionary.packets = std::move(system->packets);
    dictionary.model = std::move(system->model);
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
    dictionary.clock = std::move(*clock);
    dictionary.predicted_anchor_e_s = std::move(*predicted);
    loaded.dictionary = std::move(dictionary);
    return loaded;
}

}  // namespace aeolis::dictionary
