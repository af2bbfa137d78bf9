// SPDX-License-Identifier: Apache-2.0
// The X-band tone receiver against exact theory, as printed by `aeolis tones bench`. AEOLIS_FULL=1 adds the slow
// points. AEOLIS_STEADY=2000,7 counts the whole receiver's errors where theory has one in a thousand, over 2000 symbols
// of seed 7 alone: parts of that point, which takes long, to be added up.
#include "server/scenario/scenario_text.hpp"
#include "server/tones/tone_bench.hpp"
#include "telemetry/mfsk/symbol_error.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace {

using namespace aeolis;

/// A part of the whole receiver's point at 1e-3, 0.2 dB above theory as in the whole bench.
int count_steady(const MfskWaveform& waveform, const char* told) {
    unsigned long symbols = 0, seed = 0;
    if (std::sscanf(told, "%lu,%lu", &symbols, &seed) != 2 || symbols == 0) return 2;
    const double tone_dbhz =
        10.0 * std::log10(telemetry::energy_for_symbol_error(1e-3, MfskWaveform::tones) / waveform.symbol_s) + 0.2;
    const auto count =
        server::steady_errors(waveform, tone_dbhz - 10.0 * std::log10(waveform.tone_fraction()), symbols, seed);
    std::printf("the whole receiver, beginnings known, at %.2f dB-Hz of tone, seed %lu: %lu errors of %lu\n", tone_dbhz,
                seed, static_cast<unsigned long>(count.errors.errors), static_cast<unsigned long>(count.errors.trials));
    return 0;
}

}  // namespace

int main() {
    const auto loaded = dictionary::load(AEOLIS_SOURCE_DIR "/dictionaries/msl");
    const auto landing = server::scenario_from_file(AEOLIS_SOURCE_DIR "/simulation/scenarios/od137.textproto");
    const auto errors = server::scenario_from_file(AEOLIS_SOURCE_DIR "/simulation/scenarios/nominal_auto.textproto");
    if (!loaded.dictionary || !landing || !errors) return 1;
    if (const char* told = std::getenv("AEOLIS_STEADY")) return count_steady(loaded.dictionary->mfsk, told);
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
