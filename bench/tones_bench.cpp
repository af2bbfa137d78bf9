// SPDX-License-Identifier: Apache-2.0
// The X-band tone receiver against exact theory, as printed by `aeolis tones bench`. AEOLIS_FULL=1 adds the slow
// points.
#include "server/scenario/scenario_text.hpp"
#include "server/tones/tone_bench.hpp"

#include <cstdio>
#include <cstdlib>
#include <string>

int main() {
    using namespace aeolis;
    const auto loaded = dictionary::load(AEOLIS_SOURCE_DIR "/dictionaries/msl");
    const auto landing = server::scenario_from_file(AEOLIS_SOURCE_DIR "/simulation/scenarios/od137.textproto");
    const auto errors = server::scenario_from_file(AEOLIS_SOURCE_DIR "/simulation/scenarios/nominal_auto.textproto");
    if (!loaded.dictionary || !landing || !errors) return 1;
    simulation::Scenario dispersed = *landing;
    dispersed.dispersions = errors->dispersions;
    const char* full = std::getenv("AEOLIS_FULL");
    const bool met =
        server::tell_tone_figures(*loaded.dictionary, *landing, dispersed, full != nullptr && std::string{full} == "1",
                                  [](const server::ToneFigure& figure) {
                                      std::printf("%s\n", figure.text().c_str());
                                      std::fflush(stdout);  // the next may take minutes
                                  });
    return met ? 0 : 1;
}
