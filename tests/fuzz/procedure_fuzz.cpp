// SPDX-License-Identifier: Apache-2.0
// Procedures as anyone may have written them: one that can be printed and begun, or faults with their places.
#include "server/procedures/execution.hpp"
#include "server/procedures/procedure_reader.hpp"
#include "server/procedures/procedure_text.hpp"

#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace aeolis;
    using namespace aeolis::server::procedures;
    static const auto loaded = dictionary::load(AEOLIS_SOURCE_DIR "/dictionaries/msl");
    if (!loaded.dictionary) std::abort();
    static const std::vector<std::string> others{"start", "computer_reset", "tones_lost", "commanding_closed"};
    const std::string text{data, data + size};
    const auto read = read_procedure(text, "start.yaml", *loaded.dictionary, others);
    if (read.procedure.has_value() != read.findings.empty()) std::abort();
    for (const TextFinding& finding : read.findings)
        if (finding.mark.line == 0 || finding.mark.column == 0 || finding.message.empty()) std::abort();
    if (!read.procedure) return 0;
    if (printed(*read.procedure, *loaded.dictionary).empty()) std::abort();
    Execution execution{std::make_shared<const Procedure>(*read.procedure), *loaded.dictionary, Ert{}};
    execution.pass(Ert{1'000'000});
    if (execution.steps().empty()) std::abort();
    return 0;
}
