# SPDX-License-Identifier: Apache-2.0
"""Prints what warned during the newest run: events of high levels, in order."""
import sys

from aeolis_client import Client

with Client(*sys.argv[1:2]) as aeolis:
    for item in aeolis.events(level="WARNING_HI,FATAL"):
        print(f"{item.event.sclk:.3f} {item.event.name}: {item.event.text}")
