# SPDX-License-Identifier: Apache-2.0
"""Lists the runs of a server, newest first."""
import sys

from aeolis_client import Client, word

with Client(*sys.argv[1:2]) as aeolis:
    for run in aeolis.runs():
        print(run.run, run.scenario, word(run, "state"), word(run, "outcome"))
