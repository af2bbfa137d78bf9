// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/pipeline/pipeline.hpp"
#include "tests/server/small_mission.hpp"

#include <cstdlib>

namespace aeolis::test {

/// An archive of the small mission, made once: run 1 is over and has a bit of everything, run 2 was cut off.
class RecordedRun {
  public:
    RecordedRun() {
        auto archive = archive::Archive::open(file());
        if (!archive) std::abort();
        pipeline::Pipeline pipeline{*archive, dictionary};
        archive::RunStart start;
        start.scenario = "nominal";
        start.entry = Sclk{1010.0};
        for (const bool over : {true, false}) {
            if (!pipeline.begin(start)) std::abort();
            must(pipeline.accept({telemetry::uhf_live_link, Ert{5}, true, "nominal"}));
            for (std::uint16_t i = 0; i < 1300; ++i)
                must(
                    pipeline.accept(live(navigation_packet(i, 1000.0 + i / 64.0, static_cast<float>(i), 6001.0F - i))));
            must(pipeline.accept(live(status_packet(0, 1001.0, 2))));
            must(pipeline.accept(live(mortar_packet(0, 1002.0, 405.0F))));
            must(pipeline.accept(live(fired_packet(0, 1002.0, 2))));
            must(pipeline.accept(live({1, 2, 3})));
            telemetry::ReceivedTone tone;
            tone.tone = ToneId{9};
            must(pipeline.accept(tone));
            archive::StageRecord stage;
            stage.command = 1;
            stage.name = "NO_OP";
            stage.stage = commands::Stage::queued;
            must(pipeline.accept(stage));
            must(over ? pipeline.finish({archive::Outcome::touchdown, "", "d", ""}) : pipeline.commit());
            pipeline.abandon();
        }
    }
    std::filesystem::path file() const { return folder / "a.db"; }

    TemporaryFolder folder;
    dictionary::Dictionary dictionary = small_dictionary();

  private:
    static void must(const Result<void>& done) {
        if (!done) std::abort();
    }
};

}  // namespace aeolis::test
