// SPDX-License-Identifier: Apache-2.0
#include "server/instruction/plan_library.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fstream>
#include <spdlog/spdlog.h>

namespace aeolis::server::instruction {

namespace {

std::string lines_of(const std::vector<procedures::TextFinding>& findings) {
    std::string lines;
    for (const auto& finding : findings) lines += (lines.empty() ? "" : "\n") + finding.text();
    return lines;
}

}  // namespace

Result<std::string> text_of_file(const std::filesystem::path& file) {
    std::error_code error;
    std::ifstream stream{file, std::ios::binary};
    if (!stream || std::filesystem::is_directory(file, error)) return Error{file.string() + ": cannot be read"};
    // One octet more than may be read shows that there are too many.
    std::string text(procedures::yaml_octets_max + 1, '\0');
    stream.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(stream.gcount()));
    return text;
}

std::vector<std::filesystem::path> yaml_files_in(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> files;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator{folder, error})
        if (entry.path().extension() == ".yaml") files.push_back(entry.path());
    std::ranges::sort(files);
    return files;
}

std::string PlanLibrary::injects_text() const {
    const auto text = text_of_file(folder_ / "injects.yaml");
    return text ? *text : std::string{};
}

v1::PlanList PlanLibrary::list() const {
    v1::PlanList list;
    for (const auto& file : yaml_files_in(folder_ / "plans")) {
        const auto text = plan(file.stem().string());
        const auto read = text ? read_plan(*text, dictionary_) : ReadPlan{};
        if (!read.plan) {
            spdlog::warn("plan left out: {}", text ? read.findings_text() : text.error().message);
            continue;
        }
        auto& entry = *list.add_plans();
        entry.set_name(read.plan->id);
        entry.set_title(read.plan->title);
        entry.set_purpose(read.plan->purpose);
        entry.set_scenario(read.plan->scenario);
        entry.set_injects(static_cast<std::uint32_t>(read.plan->injects.size()));
    }
    const auto library = injects_text();
    if (library.empty()) return list;
    const auto read = read_library(library, "injects.yaml", dictionary_, {});
    for (const auto& finding : read.findings) spdlog::warn("library of injects: {}", finding.text());
    const auto by = rubric();
    for (const auto& inject : read.injects.value_or(std::vector<Inject>{})) {
        auto& entry = *list.add_library();
        entry.set_name(inject.id);
        entry.set_title(inject.title);
        entry.set_does(text_of(inject.fault));
        entry.set_shows(inject.shows);
        *entry.mutable_fault() = inject.fault;
        for (auto& words : team_texts(inject, by ? *by : Rubric{})) entry.add_team(std::move(words));
    }
    return list;
}

Result<v1::InstructorPlan> PlanLibrary::plan(const std::string& name) const {
    // The name may come from a client: it is looked up in the list and never made a path.
    const auto files = yaml_files_in(folder_ / "plans");
    const auto stem_of = [](const std::filesystem::path& file) { return file.stem().string(); };
    const auto file = std::ranges::find(files, name, stem_of);
    if (file == files.end()) {
        std::vector<std::string> known;
        std::ranges::transform(files, std::back_inserter(known), stem_of);
        return Error{fmt::format("plan '{}': there is none of this name; there {}", name,
                                 known.empty() ? "is none at all" : fmt::format("are: {}", fmt::join(known, ", ")))};
    }
    auto text = text_of_file(*file);
    if (!text) return text.error();
    v1::InstructorPlan plan;
    plan.set_name(file->filename().string());
    plan.set_text(std::move(*text));
    plan.set_library(injects_text());
    return plan;
}

Result<Rubric> PlanLibrary::rubric() const {
    const auto file = folder_ / "rubric.yaml";
    const auto text = text_of_file(file);
    if (!text) return text.error();
    auto read = read_rubric(*text, file.string(), dictionary_);
    if (read.rubric) return std::move(*read.rubric);
    return Error{lines_of(read.findings)};
}

Result<procedures::CallList> PlanLibrary::calls() const {
    const auto file = folder_ / "calls.yaml";
    std::error_code error;
    if (folder_.empty() || !std::filesystem::exists(file, error)) return procedures::CallList{};
    const auto text = text_of_file(file);
    if (!text) return text.error();
    auto read = procedures::read_calls(*text, file.string());
    if (read.calls) return std::move(*read.calls);
    return Error{lines_of(read.findings)};
}

}  // namespace aeolis::server::instruction
