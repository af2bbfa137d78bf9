# SPDX-License-Identifier: Apache-2.0
"""Starts a rehearsal as fast as it goes, on a server where none goes on, and says how it ended."""
import sys

from aeolis_client import Client, word

with Client(*sys.argv[1:2]) as aeolis:
    run = aeolis.start("nominal_auto", seed=7, pace=0)
    print(f"run {run.run}: {word(aeolis.wait_for_end(run.run), 'outcome')}")
