// SPDX-License-Identifier: Apache-2.0
#include "server/api/procedure_library.hpp"

#include "server/instruction/plan_library.hpp"
#include "server/pipeline/procedure_status.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <vector>

namespace aeolis::server {
namespace {

std::string stem_of(const std::filesystem::path& file) {
    return file.stem().string();
}

}  // namespace

std::string ProcedureLibrary::Found::findings_text() const {
    std::string all;
    for (const auto& finding : read.findings) all += (all.empty() ? "" : "\n") + finding.text();
    return all;
}

Result<ProcedureLibrary::Found> read_procedure_file(const std::filesystem::path& file, const std::string& name,
                                                    const dictionary::Dictionary& dictionary) {
    auto text = instruction::text_of_file(file);
    if (!text) return text.error();
    std::vector<std::string> beside;
    const auto folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path{"."};
    std::ranges::transform(instruction::yaml_files_in(folder), std::back_inserter(beside), stem_of);
    auto read = procedures::read_procedure(*text, name, dictionary, beside);
    return ProcedureLibrary::Found{std::move(*text), std::move(read)};
}

v1::ProcedureList ProcedureLibrary::list(const dictionary::Dictionary& dictionary) const {
    v1::ProcedureList list;
    for (const auto position : procedures::positions) list.add_positions(std::string(name_of(position)));
    for (const auto& file : instruction::yaml_files_in(folder_)) {
        const auto found = read_procedure_file(file, file.filename().string(), dictionary);
        auto& entry = *list.add_procedures();
        if (found && found->read.procedure)
            entry = std::move(*pipeline::form_of(*found->read.procedure, dictionary).mutable_entry());
        entry.set_procedure(stem_of(file));
        if (!found) entry.add_findings(found.error().message);
        if (found)
            for (const auto& finding : found->read.findings) entry.add_findings(finding.text());
    }
    return list;
}

Result<ProcedureLibrary::Found> ProcedureLibrary::procedure(const std::string& id,
                                                            const dictionary::Dictionary& dictionary) const {
    // The id may come from a client: it is looked up in the list and never made a path.
    const auto files = instruction::yaml_files_in(folder_);
    const auto file = std::ranges::find(files, id, stem_of);
    if (file != files.end()) return read_procedure_file(*file, file->filename().string(), dictionary);
    std::vector<std::string> known;
    std::ranges::transform(files, std::back_inserter(known), stem_of);
    return Error{fmt::format("procedure '{}': there is none of this id; there {}", id,
                             known.empty() ? "is none at all" : fmt::format("are: {}", fmt::join(known, ", ")))};
}

}  // namespace aeolis::server
