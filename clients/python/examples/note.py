# SPDX-License-Identifier: Apache-2.0
"""Writes a line of the shift log and prints the log."""
import sys

from aeolis_client import Client

with Client(*sys.argv[1:2]) as aeolis:
    aeolis.add_note("seen by a program", by="example")
    for item in aeolis.notes():
        print(item.note.by, item.note.text)
