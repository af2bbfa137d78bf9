# SPDX-License-Identifier: Apache-2.0
"""A landing from start to report: flies it, plots altitude by speed, and writes what was predicted and what was flown.

Needs python3-pandas and python3-matplotlib, and a server on which no rehearsal goes on.
Writes landing.png and landing.txt.
"""
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from aeolis_client import Client, word

with Client(*sys.argv[1:2]) as aeolis:
    # %% Fly
    run = aeolis.wait_for_end(aeolis.start("nominal_auto", seed=7, pace=0).run)
    print(f"run {run.run}: {word(run, 'outcome')}")

    # %% Plot
    entry = aeolis.frame(["altitude_m", "speed_mps"], run=run.run, start="E+0:00", source="recorded").dropna()
    axes = entry.plot(x="speed_mps", y="altitude_m", legend=False)
    axes.set(xlabel="speed, m/s", ylabel="altitude, m", title=f"Run {run.run}, {run.scenario}: recorded")
    plt.savefig("landing.png", dpi=150, bbox_inches="tight")

    # %% Report
    with open("landing.txt", "w", encoding="utf-8") as text:
        for row in aeolis.report(run.run).timepoints:
            flown = f"{row.recorded_e_s:+9.2f}" if row.HasField("recorded_e_s") else "        —"
            text.write(f"{row.name:32} {flown} s from entry  {row.verdict}\n")
