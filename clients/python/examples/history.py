# SPDX-License-Identifier: Apache-2.0
"""Altitude and speed from entry to parachute as a pandas table: needs python3-pandas."""
import sys

from aeolis_client import Client

with Client(*sys.argv[1:2]) as aeolis:
    print(aeolis.frame(["altitude_m", "speed_mps"], start="E+0:00", end="E+4:20").describe())
