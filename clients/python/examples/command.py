# SPDX-License-Identifier: Apache-2.0
"""Sends a command and waits until the vehicle says that it was executed."""
import sys

from aeolis_client import Client, CommandFailed, CommandRefused

with Client(*sys.argv[1:2]) as aeolis:
    try:
        reply = aeolis.command("NO_OP", stage="executed")
        print(f"command {reply.command} was executed")
    except (CommandRefused, CommandFailed) as error:
        print(error)
