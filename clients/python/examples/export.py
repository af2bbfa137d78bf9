# SPDX-License-Identifier: Apache-2.0
"""Writes every sample of two channels to samples.csv."""
import sys

from aeolis_client import Client

with Client(*sys.argv[1:2]) as aeolis:
    print(aeolis.export("samples.csv", ["altitude_m", "propellant_kg"]), "octets in samples.csv")
