# SPDX-License-Identifier: Apache-2.0
"""Follows the current run: each event as it becomes known, over lost connections, until the run ends."""
import asyncio
import sys

from aeolis_client import AsyncClient


async def main() -> None:
    async with AsyncClient(*sys.argv[1:2]) as aeolis:
        async for item in aeolis.subscribe(channels=[], without_units=True):
            if item.HasField("event"):
                print(f"{item.event.sclk:.3f} {item.event.name}: {item.event.text}")


asyncio.run(main())
