// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/autocoder/flight_header.hpp"
#include "dictionaries/autocoder/owners_header.hpp"
#include "dictionaries/autocoder/parameters_header.hpp"
#include "dictionaries/autocoder/state_machines_header.hpp"
#include "dictionaries/autocoder/telemetry_plan_source.hpp"
#include "dictionaries/autocoder/timeline_source.hpp"

#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>

// aeolis_autocoder MSL_DIR OUT_DIR: writes dictionary_flight.hpp, state_machines.hpp, parameters.hpp,
// parameter_names.hpp, owners.hpp, timeline.cpp and telemetry_plan.cpp, or prints every finding and writes nothing.
// Unchanged files are not rewritten, so that a change of the autocoder alone does not recompile flight. Exit status:
// 0 done, 1 findings or not writable, 2 bad usage.
namespace {

bool write(const std::filesystem::path& path, const std::string& text) {
    {
        std::ifstream in{path, std::ios::binary};
        if (in && std::string{std::istreambuf_iterator<char>{in}, {}} == text) return true;
    }
    std::ofstream out{path, std::ios::binary | std::ios::trunc};
    out << text << std::flush;
    if (!out) std::cerr << path.string() << ": cannot be written\n";
    return static_cast<bool>(out);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3) {
        std::cerr << "use: aeolis_autocoder DICTIONARY_DIR OUT_DIR\n";
        return 2;
    }
    namespace dictionary = aeolis::dictionary;
    const std::filesystem::path mission{argv[1]};
    const std::filesystem::path out{argv[2]};
    const dictionary::Loaded loaded = dictionary::load(mission);
    for (const auto& finding : loaded.findings) std::cerr << (mission / finding.text()).string() << '\n';
    if (!loaded.dictionary) return 1;
    std::error_code error;
    std::filesystem::create_directories(out, error);
    const bool written =
        write(out / "dictionary_flight.hpp", dictionary::autocoder::flight_header(*loaded.dictionary)) &&
        write(out / "state_machines.hpp", dictionary::autocoder::state_machines_header(*loaded.dictionary)) &&
        write(out / "parameters.hpp", dictionary::autocoder::parameters_header(*loaded.dictionary)) &&
        write(out / "parameter_names.hpp", dictionary::autocoder::parameter_names_header(*loaded.dictionary)) &&
        write(out / "owners.hpp", dictionary::autocoder::owners_header(*loaded.dictionary)) &&
        write(out / "timeline.cpp", dictionary::autocoder::timeline_source(*loaded.dictionary)) &&
        write(out / "telemetry_plan.cpp", dictionary::autocoder::telemetry_plan_source(*loaded.dictionary));
    return written ? 0 : 1;
}
