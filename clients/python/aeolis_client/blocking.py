# SPDX-License-Identifier: Apache-2.0
"""The same client for programs without asyncio."""
from __future__ import annotations

import asyncio
import inspect
import threading
from collections.abc import Coroutine, Iterator
from types import TracebackType
from typing import Any, Optional

from .asynchronous import AsyncClient


class Client:
    """AsyncClient with blocking methods: what it awaits is returned, what it yields is an iterator.

        with Client() as aeolis:
            run = aeolis.start("nominal_auto", pace=0)
            for event in aeolis.events(run=run.run):
                print(event.event.name)

    Its loop runs in a thread of its own, so that it works in notebooks, too.
    """

    def __init__(self, server: str = "http://127.0.0.1:8080", **options: Any) -> None:
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, daemon=True, name="aeolis_client")
        self._thread.start()
        try:
            self._client = self._wait(self._open(server, options))
        except BaseException:
            self._end()
            raise

    @staticmethod
    async def _open(server: str, options: dict[str, Any]) -> AsyncClient:
        return await AsyncClient(server, **options).__aenter__()

    def _wait(self, work: Coroutine[Any, Any, Any]) -> Any:
        future = asyncio.run_coroutine_threadsafe(work, self._loop)
        try:
            return future.result()
        except BaseException:
            future.cancel()
            raise

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        asked = getattr(self._client, name)
        if inspect.iscoroutinefunction(asked):
            return lambda *given, **named: self._wait(asked(*given, **named))
        if not callable(asked) or not hasattr(type(self._client), name) or name == "schema":
            return asked
        return lambda *given, **named: self._items(asked(*given, **named))

    def _items(self, items: Any) -> Iterator[Any]:
        try:
            while True:
                try:
                    yield self._wait(items.__anext__())
                except StopAsyncIteration:
                    return
        finally:
            self._wait(items.aclose())

    def __enter__(self) -> Client:
        return self

    def __exit__(
        self, kind: Optional[type[BaseException]], error: Optional[BaseException], trace: Optional[TracebackType]
    ) -> None:
        self.close()

    def close(self) -> None:
        """Ends the connections and the thread."""
        if self._loop.is_closed():
            return
        self._wait(self._client.close())
        self._end()

    def _end(self) -> None:
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()
        self._loop.close()
