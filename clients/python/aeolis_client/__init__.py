# SPDX-License-Identifier: Apache-2.0
"""A client of the Aeolis server: runs, recorded data, rehearsals, commands and the stream.

`AsyncClient` is for asyncio; `Client` has the same methods, blocking, on a loop of its own.
Replies are Protobuf messages of the server's own schema, which is read when a client connects.
"""
from .asynchronous import AsyncClient
from .blocking import Client
from .errors import AeolisError, CommandFailed, CommandRefused
from .frames import frame_of
from .schema import word

__all__ = ["AeolisError", "AsyncClient", "Client", "CommandFailed", "CommandRefused", "frame_of", "word"]
