# SPDX-License-Identifier: Apache-2.0
"""Prints the tones of the newest run, as they were decoded."""
import sys

from aeolis_client import Client

with Client(*sys.argv[1:2]) as aeolis:
    for item in aeolis.tones():
        heard = f"{item.tone.tone} {item.tone.name}" if item.tone.HasField("tone") else "not decided"
        print(item.tone.ert_start, heard)
