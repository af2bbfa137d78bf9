# SPDX-License-Identifier: Apache-2.0
"""Sets the parameters of EDL and permits the timeline to run: a hazardous command, armed and typed by who runs this."""
import sys

from aeolis_client import Client

with Client(*sys.argv[1:2]) as aeolis:
    aeolis.command("EDL_SET_PARAMETERS", from_solution=True, stage="verified")
    if input("Type EDL_DO_EDL to permit the timeline to run: ") == "EDL_DO_EDL":
        aeolis.command("EDL_DO_EDL", confirm=True, stage="executed")
