# SPDX-License-Identifier: Apache-2.0
"""The client for asyncio."""
from __future__ import annotations

import asyncio
import ssl
import uuid
from collections.abc import AsyncIterator, Sequence
from datetime import datetime
from pathlib import Path
from types import TracebackType
from typing import Any, Optional, Union
from urllib.parse import quote, urlsplit

import httpx
import websockets
from google.protobuf import json_format

from .errors import AeolisError, CommandFailed, CommandRefused
from .frames import frame_of
from .schema import Schema, word

Instant = Union[float, str, datetime]
"""SCLK in seconds, SCET as a datetime (a naive one is UTC), or a text: SCET ("2012-219T05:10:47"), "ert:" and a UTC
time, or from entry ("E+4:58")."""
Run = Union[int, str]
"""The number of a run, or "latest"."""

STAGES = ("queued", "authorised", "released", "radiated", "received", "accepted", "executed", "verified")
_ASK_AGAIN_S = 0.25
_WAITS_S = (0.2, 0.5, 1.0, 2.0, 5.0)  # before a lost stream is opened again, or a command is sent again
_PASSING = (0, 429, 502, 503, 504)  # statuses of a server that is away or busy, or of the proxy before it


class AsyncClient:
    """A server as one account, or one token, sees it.

        async with AsyncClient("https://console.example:8443", token=token) as aeolis:
            print(await aeolis.runs())

    Errors: AeolisError with the server's sentence; CommandRefused and CommandFailed of commands.
    """

    def __init__(
        self,
        server: str = "http://127.0.0.1:8080",
        *,
        token: str = "",
        authorities: Optional[Union[str, Path]] = None,
        timeout_s: float = 30.0,
    ) -> None:
        self._server = server.rstrip("/")
        self._tls = ssl.create_default_context(cafile=str(authorities) if authorities else None)
        headers = {"Authorization": f"Bearer {token}"} if token else {}
        self._http = httpx.AsyncClient(
            base_url=self._server, headers=headers, verify=self._tls, timeout=timeout_s, trust_env=False
        )
        self._schema: Optional[Schema] = None

    async def __aenter__(self) -> AsyncClient:
        answer = await self._answer("GET", "/api/v1/schema/descriptor_set.binpb")
        self._schema = Schema(answer.content)
        return self

    async def __aexit__(
        self, kind: Optional[type[BaseException]], error: Optional[BaseException], trace: Optional[TracebackType]
    ) -> None:
        await self.close()

    async def close(self) -> None:
        """Ends the connections. A log-in session goes on until it expires; `log_out` ends it."""
        await self._http.aclose()

    @property
    def schema(self) -> Schema:
        """The server's messages, once connected."""
        if self._schema is None:
            raise AeolisError(0, "not connected yet: use `async with AsyncClient(...)`")
        return self._schema

    # Who one is.

    async def log_in(self, user: str, password: str) -> Any:
        """Logs in; the cookie is sent from then on. Returns the Session: user, role, rights."""
        return await self._ask("Session", "POST", "/session", {"user": user, "password": password})

    async def log_out(self) -> None:
        await self._answer("DELETE", "/api/v1/session")

    async def session(self) -> Any:
        """Who is logged in, and what they may do."""
        return await self._ask("Session", "GET", "/session")

    # Runs and their data.

    async def runs(self) -> list[Any]:
        """All runs, newest first."""
        return [run async for run in self._pages("RunList", "/runs", {})]

    async def run(self, run: Run = "latest") -> Any:
        """The RunState of a run: state, outcome, clocks, predicted entry."""
        return await self._ask("RunState", "GET", f"/runs/{run}")

    async def dictionary(self) -> Any:
        """Channels, packets, commands, events, tones and timepoints of the mission."""
        return await self._ask("DictionaryReply", "GET", "/dictionary")

    async def history(
        self,
        channels: Sequence[str],
        *,
        run: Run = "latest",
        start: Optional[Instant] = None,
        end: Optional[Instant] = None,
        points: Optional[int] = None,
        source: str = "",
    ) -> list[Any]:
        """Samples of channels, as ChannelSeries: all, or thinned to about `points`. @param source realtime, recorded"""
        query = {"names": ",".join(channels), "start": start, "end": end, "points": points, "source": source or None}
        answer = await self._answer("GET", f"/api/v1/runs/{run}/channels", query={**query, "format": "protobuf"})
        return list(self.schema.ChannelSeriesList.FromString(answer.content).channels)

    async def items(
        self, *, run: Run = "latest", after_seq: int = 0, channels: Optional[Sequence[str]] = None
    ) -> AsyncIterator[Any]:
        """All items that a run has now, in order, page by page, as `subscribe` gives them.

        @param channels  names; None: all
        """
        if run == "latest":
            run = (await self.run()).run  # another run may begin between two pages
        names = ",".join(channels) if channels is not None else None
        while True:
            query = {"names": names, "after": after_seq, "format": "protobuf"}
            batch = self.schema.Batch.FromString(
                (await self._answer("GET", f"/api/v1/runs/{run}/items", query=query)).content
            )
            for item in batch.items:
                yield item
            if batch.complete_through == after_seq:
                return
            after_seq = batch.complete_through

    async def frame(self, channels: Sequence[str], *, run: Run = "latest", **limits: Any) -> Any:
        """The same as a pandas.DataFrame by SCLK, with `e_s`, seconds from entry."""
        state = await self.run(run)
        return frame_of(await self.history(channels, run=state.run, **limits), state.entry_sclk)

    def events(self, *, run: Run = "latest", **query: Any) -> AsyncIterator[Any]:
        """Event items, page by page. @param query level, text, start, end, order: oldest or newest"""
        return self._pages("EventList", f"/runs/{run}/events", query)

    def tones(self, *, run: Run = "latest", **query: Any) -> AsyncIterator[Any]:
        """Tone items, page by page. @param query text, start, end, order"""
        return self._pages("ToneList", f"/runs/{run}/tones", query)

    def notes(self, *, run: Run = "latest", **query: Any) -> AsyncIterator[Any]:
        """The shift log, page by page. @param query text, order"""
        return self._pages("NoteList", f"/runs/{run}/notes", query)

    async def add_note(self, text: str, *, run: Run = "latest", by: str = "", sclk: Optional[float] = None) -> Any:
        """Writes a line of the shift log; returns its item once it is durable."""
        body = {"text": text, "by": by, **({} if sclk is None else {"sclk": sclk})}
        return await self._ask("Item", "POST", f"/runs/{run}/notes", body)

    async def make_call(
        self, call: str, *, run: Run = "latest", by: str = "", position: str = "", text: str = ""
    ) -> Any:
        """Makes a standard call, by its id in the dictionary; returns its item. @param text what the call asks for"""
        body = {"call": call, "by": by, "position": position, "text": text}
        return await self._ask("Item", "POST", f"/runs/{run}/notes", body)

    async def read_back(self, call: int, *, run: Run = "latest", by: str = "", position: str = "") -> Any:
        """Reads back the standard call in the item of that number, made by another person; returns the item."""
        body = {"reads_back": call, "by": by, "position": position}
        return await self._ask("Item", "POST", f"/runs/{run}/notes", body)

    def procedures(self) -> AsyncIterator[Any]:
        """The mission's procedures, ProcedureEntry by id; one with findings cannot be begun."""
        return self._pages("ProcedureList", "/procedures", {})

    async def run_procedures(self, *, run: Run = "latest", at: Optional[str] = None) -> Any:
        """The procedures of a run as they stand, or stood when Earth had received so much: a RunProcedureList."""
        answer = await self._answer("GET", f"/api/v1/runs/{run}/procedures", query={"at": at})
        return self._read("RunProcedureList", answer)

    async def begin_procedure(self, procedure: str, position: str, *, run: Run = "latest", by: str = "") -> Any:
        """Begins a procedure in the run that goes on; returns the item with its status once it is durable."""
        body = {"procedure": procedure, "position": position, "by": by}
        return await self._ask("Item", "POST", f"/runs/{run}/procedures", body)

    async def act_on_procedure(
        self, number: int, kind: str, position: str, *, step: str = "", run: Run = "latest", by: str = "", **more: Any
    ) -> Any:
        """Acts on a procedure of the run; returns the item with its status once it is durable.

        @param kind tick, sign, choose, skip, sent, hold, release, acknowledge, stop
        @param more reason, choice, command, as the kind wants
        """
        body = {"kind": kind, "step": step, "position": position, "by": by, **more}
        return await self._ask("Item", "POST", f"/runs/{run}/procedures/{number}/acts", body)

    async def positions(self, *, run: Run = "latest", at: Optional[str] = None) -> Any:
        """Who holds which position, the poll, and the acts until then: a RunPositions."""
        answer = await self._answer("GET", f"/api/v1/runs/{run}/positions", query={"at": at})
        return self._read("RunPositions", answer)

    async def act_on_position(self, kind: str, position: str, *, run: Run = "latest", by: str = "", **more: Any) -> Any:
        """Takes, offers or leaves a position, calls the poll or answers it; returns the item once it is durable.

        @param kind take, offer, leave, poll, go, no_go
        @param more to, subject, reason, as the kind wants
        """
        body = {"kind": kind, "position": position, "by": by, **more}
        return await self._ask("Item", "POST", f"/runs/{run}/positions", body)

    async def report(self, run: Run = "latest") -> Any:
        """The AsFlownReport: timepoints and events, predicted and flown, with the first page of commands and notes."""
        return await self._ask("AsFlownReport", "GET", f"/runs/{run}/report")

    async def export(
        self, path: Union[str, Path], channels: Sequence[str], *, run: Run = "latest", **query: Any
    ) -> int:
        """Writes samples to a CSV file as they come, whatever their number. Returns the octets written.

        @param query start, end, source
        Errors: AeolisError; when the connection breaks off, the file is incomplete
        """
        asked = {"names": ",".join(channels), **query}
        written = 0
        try:
            async with self._http.stream("GET", f"/api/v1/runs/{run}/samples", params=_given(asked)) as answer:
                if answer.status_code >= 400:
                    await answer.aread()
                    raise _problem(answer)
                with open(path, "wb") as file:
                    async for part in answer.aiter_bytes():
                        written += file.write(part)
        except httpx.HTTPError as error:
            raise self._no_answer(error) from error
        return written

    # Rehearsals and commands.

    async def scenarios(self) -> list[Any]:
        return [each async for each in self._pages("ScenarioList", "/scenarios", {})]

    async def start(self, scenario: str, *, seed: int = 1, pace: float = 1.0) -> Any:
        """Starts a rehearsal; returns its RunState once it is in the archive. @param pace 0: as fast as it goes"""
        return await self._ask("RunState", "POST", "/rehearsals", {"scenario": scenario, "seed": seed, "pace": pace})

    async def control(self, **action: Any) -> None:
        """One of pause=True, pause=False, pace=N, jump="E-0:47:00", stop=True."""
        await self._answer("POST", "/api/v1/rehearsals/current", body=action)

    async def wait_for_end(self, run: Run = "latest", *, timeout_s: float = 3600.0) -> Any:
        """The RunState of a run once it is over."""

        async def ended() -> Any:
            while not _is_over(state := await self.run(run)):
                await asyncio.sleep(_ASK_AGAIN_S)
            return state

        return await asyncio.wait_for(ended(), timeout_s)

    async def command(
        self,
        name: str,
        arguments: Optional[dict[str, float]] = None,
        *,
        run: Run = "latest",
        confirm: bool = False,
        stage: str = "",
        timeout_s: float = 60.0,
        client_id: str = "",
        **more: Any,
    ) -> Any:
        """Sends a command once; returns its CommandReply, once `stage` is reached if one is named.

        When the connection is lost before the reply, or the server is too busy to look at it, it is sent again with the
        same id: within its run the server takes it once, and replies with the fate of the first.
        @param confirm    arms a hazardous command and types its name: only what a person decided
        @param stage      one of STAGES, of which word must have come
        @param client_id  an id of one's own, by which the command can be sent again later, also by another program
        @param more       fields of CommandRequest: from_solution, dry_run, release_at, hold, priority, controller.
                          release_at is when it leaves the station (UTC, as text or datetime), or when it arrives at the
                          vehicle: "E-10:00", SCLK in seconds, or "scet:2012-219T05:00:00"
        Errors: CommandRefused; CommandFailed, when that stage or one before failed; asyncio.TimeoutError; AeolisError
            when no reply came in six tries: whether the command was taken is not known then
        """
        if run == "latest":
            run = (await self.run()).run  # another run may begin meanwhile: this is for the present one
        body: dict[str, Any] = {"command": name, "client_id": client_id or uuid.uuid4().hex, **more}
        if "release_at" in body:
            body["release_at"] = str(_written(body["release_at"]))
        body["arguments"] = [{"name": key, "value": value} for key, value in (arguments or {}).items()]
        if confirm:
            body.update(armed=True, confirmation=name)
        answer = await self._send(f"/api/v1/runs/{run}/commands", body)
        reply = self._read("CommandReply", answer)
        if not reply.accepted:
            raise CommandRefused(answer.status_code, reply)
        if stage and not reply.dry_run:
            await self.wait_for_stage(reply.command, stage, run=run, timeout_s=timeout_s)
        return reply

    async def _send(self, path: str, body: dict[str, Any]) -> httpx.Response:
        for wait_s in (*_WAITS_S, None):
            try:
                return await self._answer("POST", path, body=body, accept=(202, 409, 422))
            except AeolisError as error:
                if wait_s is None or error.status not in _PASSING:
                    raise
            await asyncio.sleep(wait_s)
        raise AssertionError

    async def commands(self, *, run: Run = "latest", **query: Any) -> list[Any]:
        """The CommandHistory of each command of a run. @param query text, start, end, order"""
        return [history async for history in self._pages("CommandList", f"/runs/{run}/commands", query)]

    async def wait_for_stage(self, number: int, stage: str, *, run: Run = "latest", timeout_s: float = 60.0) -> Any:
        """The CommandHistory of a command once a stage of it is reached."""
        wanted = STAGES.index(stage)

        async def reached() -> Any:
            while True:
                asked = {"after": number - 1, "limit": 1}
                answer = await self._answer("GET", f"/api/v1/runs/{run}/commands", query=asked)
                for history in self._read("CommandList", answer).commands:
                    if history.command != number:  # it has no stage yet
                        continue
                    for item in history.stages:
                        change = item.command_stage
                        if change.status == 2 and change.stage <= wanted:  # failed
                            raise CommandFailed(history, f"{history.name}, {STAGES[change.stage]}: {change.evidence}")
                        if change.status == 1 and change.stage == wanted:  # ok
                            return history
                await asyncio.sleep(_ASK_AGAIN_S)

        return await asyncio.wait_for(reached(), timeout_s)

    # The stream.

    async def subscribe(
        self, *, run: int = 0, after_seq: int = 0, channels: Optional[Sequence[str]] = None, **more: Any
    ) -> AsyncIterator[Any]:
        """Items of a run in order, live and from the archive, none twice.

        When the connection is lost it is opened again, and the stream goes on behind the last item. Ends with the run.
        No item is left out, but for samples above `max_rate_hz` where one is given: `items` has those.
        @param run       0: the current run
        @param channels  names or aliases; None: all
        @param more      fields of Subscribe: max_rate_hz, without_units, pace
        Errors: AeolisError when the server refuses, or is not reached again in five tries
        """
        wanted: dict[str, Any] = {"run": run, "after_seq": after_seq, **more}
        if channels is None:
            wanted["all_channels"] = True
        else:
            wanted["channel_names"] = list(channels)
        state = self.schema.RunState()  # as the stream told last
        lost = 0
        while True:
            try:
                async for kind, message in self._messages(wanted):
                    lost = 0
                    if kind == "batch":
                        for item in message.items:
                            yield item
                        wanted["after_seq"] = max(wanted["after_seq"], message.complete_through)
                    else:
                        state = message
                    wanted["run"] = wanted["run"] or message.run
                    if state.run == wanted["run"] and _is_over(state) and wanted["after_seq"] >= state.last_seq:
                        return
            except (OSError, asyncio.TimeoutError, websockets.exceptions.WebSocketException) as error:
                status = _status_of(error)
                if lost == len(_WAITS_S) or status not in _PASSING:
                    raise AeolisError(status, f"{self._server}: the stream is lost: {error}") from error
                await asyncio.sleep(_WAITS_S[lost])
                lost += 1

    async def _messages(self, wanted: dict[str, Any]) -> AsyncIterator[tuple[str, Any]]:
        """Of one connection: batches, and states of the run."""
        parts = urlsplit(self._server)
        secure = parts.scheme == "https"
        cookies = "; ".join(f"{name}={value}" for name, value in self._http.cookies.items())
        headers = {name: self._http.headers[name] for name in ("Authorization",) if name in self._http.headers}
        if cookies:
            headers["Cookie"] = cookies
        address = f"{'wss' if secure else 'ws'}://{parts.netloc}/api/v1/stream"
        options: dict[str, Any] = {"subprotocols": ["aeolis.v1.protobuf"], "max_size": None}
        # The option has another name since version 14.
        is_new = int(websockets.__version__.split(".")[0]) >= 14
        options["additional_headers" if is_new else "extra_headers"] = headers
        if secure:
            options["ssl"] = self._tls
        async with websockets.connect(address, **options) as stream:
            message = self.schema.ClientMessage()
            json_format.ParseDict({"subscribe": wanted}, message)
            await stream.send(message.SerializeToString())
            async for octets in stream:
                reply = self.schema.ServerMessage.FromString(octets)
                kind = reply.WhichOneof("message")
                if kind == "refusal" and not reply.refusal.goes_on:
                    raise AeolisError(0, reply.refusal.reason)
                if kind in ("batch", "run_state"):
                    yield kind, getattr(reply, kind)
                elif kind == "welcome" and reply.welcome.HasField("run_state"):
                    yield "run_state", reply.welcome.run_state
            raise ConnectionError("the server has closed it")

    # HTTP.

    async def _answer(
        self,
        method: str,
        path: str,
        *,
        query: Optional[dict[str, Any]] = None,
        body: Optional[dict[str, Any]] = None,
        accept: tuple[int, ...] = (),
    ) -> httpx.Response:
        try:
            answer = await self._http.request(method, path, params=_given(query or {}), json=body)
        except httpx.HTTPError as error:
            raise self._no_answer(error) from error
        if answer.status_code >= 400 and answer.status_code not in accept:
            raise _problem(answer)
        return answer

    def _no_answer(self, error: httpx.HTTPError) -> AeolisError:
        return AeolisError(0, f"{self._server}: {str(error) or type(error).__name__}")

    async def _ask(self, message: str, method: str, path: str, body: Optional[dict[str, Any]] = None) -> Any:
        return self._read(message, await self._answer(method, "/api/v1" + quote(path, safe="/"), body=body))

    def _read(self, message: str, answer: httpx.Response) -> Any:
        return json_format.Parse(answer.content, getattr(self.schema, message)(), ignore_unknown_fields=True)

    async def _pages(self, message: str, path: str, query: dict[str, Any]) -> AsyncIterator[Any]:
        after = 0
        while True:
            answer = await self._answer("GET", f"/api/v1{path}", query={**query, "after": after})
            page = self._read(message, answer)
            for item in getattr(page, path.rsplit("/", 1)[1]):
                yield item
            if not page.next_after:
                return
            after = page.next_after


def _is_over(state: Any) -> bool:
    return word(state, "state") in ("finished", "interrupted")


def _status_of(error: Exception) -> int:
    """The status by which an upgrade to a stream was refused; 0: another error."""
    return int(getattr(getattr(error, "response", error), "status_code", 0))


def _given(query: dict[str, Any]) -> dict[str, Any]:
    """A query as the server reads it: `from` is a keyword of Python, so the client says start and end."""
    names = {"start": "from", "end": "to"}
    return {names.get(name, name): _written(value) for name, value in query.items() if value is not None}


def _written(value: Any) -> Any:
    return value.isoformat() if isinstance(value, datetime) else value


def _problem(answer: httpx.Response) -> AeolisError:
    try:
        detail = answer.json()["detail"]
    except (ValueError, KeyError, TypeError):
        detail = answer.text[:200] or answer.reason_phrase
    return AeolisError(answer.status_code, detail)
