// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/archive/archive.hpp"
#include "server/archive/fingerprint.hpp"
#include "server/archive/schema.hpp"
#include "server/archive/upkeep.hpp"
#include "server/pipeline/pipeline.hpp"
#include "tests/server/small_mission.hpp"

#include <cmath>
#include <filesystem>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

// Runs to be copied, and what two archives hold of them.
namespace aeolis::test {

inline telemetry::ReceivedPacket navigation(std::uint16_t count) {
    const auto x = static_cast<float>(count);
    return live(navigation_packet(count, 1000.0 + static_cast<double>(count) / 64.0,
                                  count % 7 == 0 ? std::nullopt : std::optional{std::sin(x)},
                                  5900.0F + std::fmod(x, 200.0F)),
                1'000'000 + 15'625LL * count);
}

template <typename Value>
void must(const Result<Value>& done) {
    if (!done) throw std::runtime_error(done.error().message);
}

/// A finished run of so many packets, with alarms, an event, tones, octets of a link and requests.
inline void record_run(archive::Archive& archive, const dictionary::Dictionary& dictionary, std::uint16_t packets) {
    pipeline::Pipeline pipeline{archive, dictionary};
    archive::RunStart start;
    start.scenario = "made_up";
    start.scenario_text = "name: \"made_up\"";
    start.solution = {{"latitude_deg", -4.5}};
    must(pipeline.begin(start));
    for (std::uint16_t count = 0; count < packets; ++count) {
        must(pipeline.accept(navigation(count)));
        if (count % 100 == 0) {
            must(pipeline.accept(telemetry::LinkState{{"uhf_mex", false}, Ert{1'000'000 + count}, count % 200 == 0}));
            must(pipeline.accept(archive::RequestRecord{count, "made up"}));
            must(pipeline.accept(
                telemetry::ReceivedOctets{telemetry::uhf_live_link, Ert{1'000'000 + count}, {1, 2, 3}}));
        }
        if (count == 150) must(pipeline.accept(live(mortar_packet(0, 1002.0, 400.0F))));
        must(pipeline.commit_if_full());
    }
    must(pipeline.finish({archive::Outcome::touchdown, "", "", "2026-11-27T12:00:00Z"}));
}

inline void add_note(archive::Archive& archive, archive::RunId run, const std::string& text) {
    archive::NoteRecord note;
    note.text = text;
    note.by = "nina";
    note.written = "2026-11-27T12:00:00Z";
    must(archive.annotate(run, note));
}

/// Every row of every run, exactly, but for the order in which a table holds them.
inline std::string rows_of_runs(const std::filesystem::path& file) {
    auto database = archive::sqlite::Database::open(file.string(), archive::sqlite::Mode::read_only);
    must(database);
    std::string all;
    for (const auto& table : archive::run_tables()) {
        const std::string name = table.name;
        const bool search = name == "search";
        auto rows = database->prepare(
            (search ? "SELECT rowid FROM search WHERE search MATCH 'PARACHUTE OR note OR after OR day' ORDER BY 1"
                    : "SELECT * FROM " + name)
                .c_str());
        must(rows);
        std::set<std::string> sorted;
        for (auto row = rows->step(); row && *row; row = rows->step()) {
            std::vector<std::uint8_t> exact;
            for (int column = 0; column < rows->columns(); ++column) rows->append_exact(column, exact);
            sorted.emplace(exact.begin(), exact.end());
        }
        for (const auto& row : sorted) all.append(name).append(1, ' ').append(row).append(1, '\n');
    }
    return all;
}

/// What `aeolis archive verify` finds, but for the values that are derived.
inline std::vector<std::string> faults_of(const std::filesystem::path& file) {
    auto database = archive::sqlite::Database::open(file.string(), archive::sqlite::Mode::read_only);
    must(database);
    auto faults = *archive::integrity_faults(*database);
    const auto audit = archive::check_audit(*database);
    faults.insert(faults.end(), audit->faults.begin(), audit->faults.end());
    const auto fingerprints = archive::check_fingerprints(*database, std::nullopt);
    faults.insert(faults.end(), fingerprints->faults.begin(), fingerprints->faults.end());
    const auto runs = archive::run_lines(*database);
    for (const auto& run : *runs) {
        const auto of_run = archive::sequence_faults(*database, run.run, "main.", 10);
        faults.insert(faults.end(), of_run->begin(), of_run->end());
    }
    return faults;
}

}  // namespace aeolis::test
