# SPDX-License-Identifier: Apache-2.0
"""The Python client against a real server: python3 -m unittest discover -s tests/python -p '*_test.py'"""
import asyncio
import importlib.util
import json
import os
import random
import re
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import urllib.request
from datetime import datetime, timedelta, timezone
from pathlib import Path
from typing import Any

import httpx

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "clients/python"))

from aeolis_client import AeolisError, AsyncClient, Client, CommandRefused, word  # noqa: E402

PROGRAM = os.environ.get("AEOLIS_PROGRAM", str(ROOT / "build/release/aeolis"))


class Server:
    """A server on a port of its own, with its archive in a folder that goes with it."""

    def __init__(self, *options: str) -> None:
        self.folder = tempfile.TemporaryDirectory(prefix="aeolis-python-")
        archive = Path(self.folder.name) / "a.db"
        self.process = subprocess.Popen(
            [PROGRAM, "serve", "--listen", "127.0.0.1:0", "--archive", str(archive), "--plan-flights", "0", *options],
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
        )
        assert self.process.stdout is not None
        said = ""
        for line in self.process.stdout:
            said += line
            if found := re.search(r"http://[\d.]+:\d+", line):
                self.address = found[0]
                return
        raise AssertionError(said)

    def end(self) -> None:
        self.process.terminate()
        self.process.communicate(timeout=30)
        self.folder.cleanup()


class Landed(unittest.TestCase):
    """One landing, flown once, that the tests read."""

    server: Server
    landed: int

    @classmethod
    def setUpClass(cls) -> None:
        cls.server = Server()
        with Client(cls.server.address) as aeolis:
            cls.landed = aeolis.start("nominal_auto", seed=7, pace=0).run
            ended = aeolis.wait_for_end(cls.landed, timeout_s=300)
            assert word(ended, "outcome") == "touchdown", ended

    @classmethod
    def tearDownClass(cls) -> None:
        cls.server.end()

    def test_each_example_runs(self) -> None:
        examples = sorted((ROOT / "clients/python/examples").glob("*.py"))
        self.assertGreaterEqual(len(examples), 11)
        for example in examples:
            if example.name in ("do_edl.py", "command.py", "follow.py"):
                continue  # of a run in progress: below
            with self.subTest(example.name):
                wanted = re.findall(r"python3-(pandas|matplotlib)", example.read_text())
                if not all(importlib.util.find_spec(name) for name in wanted):
                    self.skipTest(f"{example.name}: {' and '.join(wanted)} are not installed")
                done = subprocess.run(
                    [sys.executable, str(example), self.server.address], cwd=self.server.folder.name, text=True,
                    env={**os.environ, "PYTHONPATH": str(ROOT / "clients/python")}, capture_output=True, timeout=300,
                )
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertTrue(done.stdout or example.name == "alarms.py" or "landing.txt" in example.read_text())

    def test_values_are_those_that_the_server_gives_without_the_client(self) -> None:
        url = f"{self.server.address}/api/v1/runs/{self.landed}/channels?names=altitude_m&to=E%2B60"
        plain = json.load(urllib.request.urlopen(url))["channels"][0]
        with Client(self.server.address) as aeolis:
            (series,) = aeolis.history(["altitude_m"], run=self.landed, end="E+60")
        self.assertEqual(list(series.value), plain["value"])
        self.assertEqual(list(series.sclk), plain["sclk"])
        self.assertGreater(len(series.value), 100)

    def test_a_table_has_a_row_for_each_instant_and_nothing_between(self) -> None:
        with Client(self.server.address) as aeolis:
            state = aeolis.run(self.landed)
            names = ["altitude_m", "propellant_kg"]
            limits = {"start": "E+0:00", "end": "E+1:00", "source": "recorded"}
            table = aeolis.frame(names, run=self.landed, **limits)
            altitude, propellant = aeolis.history(names, run=self.landed, **limits)
        self.assertEqual(list(table.columns), ["e_s", *names])
        self.assertEqual(list(table.index), sorted(set(altitude.sclk) | set(propellant.sclk)))
        self.assertEqual(list(table["altitude_m"].dropna()), list(altitude.value))
        self.assertEqual(table["e_s"].iloc[0], table.index[0] - state.entry_sclk)
        self.assertTrue(table["propellant_kg"].isna().any())  # nothing is interpolated

    def test_a_stream_gives_each_item_once_and_goes_on_behind_the_last_one(self) -> None:
        async def numbers(after: int, at_most: int = 10**9) -> list[int]:
            async with AsyncClient(self.server.address) as aeolis:
                seen = []
                async for item in aeolis.subscribe(run=self.landed, after_seq=after, channels=[]):
                    seen.append(item.seq)
                    if len(seen) == at_most:
                        break
                return seen

        everything = asyncio.run(numbers(0))
        self.assertEqual(everything, sorted(set(everything)))
        first = asyncio.run(numbers(0, 500))
        self.assertEqual(first + asyncio.run(numbers(first[-1])), everything)

    def test_a_stream_gives_the_channels_that_are_named_by_name_or_alias(self) -> None:
        with Client(self.server.address) as aeolis:
            known = {channel.name: channel for channel in aeolis.dictionary().channels}
            wanted = [known["altitude_m"], known["speed_mps"]]
            names = ["altitude_m", known["speed_mps"].alias, "altitude_m"]
            seen: set[int] = set()
            for item in aeolis.subscribe(run=self.landed, channels=names, without_units=True):
                seen.update(item.samples.ids)
        self.assertEqual(seen, {channel.id for channel in wanted})

    def test_pages_come_to_all_events(self) -> None:
        with Client(self.server.address) as aeolis:
            by_tens = [item.seq for item in aeolis.events(run=self.landed, limit=10)]
            every = list(aeolis.events(run=self.landed))
            self.assertEqual(by_tens, [item.seq for item in every])
            entry = aeolis.run(self.landed).entry_sclk
            late = [item.seq for item in every if entry + 60 <= item.event.sclk <= entry + 240]
            self.assertEqual([item.seq for item in aeolis.events(run=self.landed, start="E+1:00", end="E+4:00")], late)
            self.assertGreater(len(late), 0)

    def test_times_of_python_are_instants_whatever_their_zone(self) -> None:
        with Client(self.server.address) as aeolis:
            state = aeolis.run(self.landed)
            entry_us = state.clock.scet_us + round((state.entry_sclk - state.clock.sclk) * state.clock.rate * 1e6)
            entry = datetime(2000, 1, 1, 12, tzinfo=timezone.utc) + timedelta(microseconds=entry_us)
            (by_name,) = aeolis.history(["altitude_m"], run=self.landed, start="E+0:10", end="E+0:20")
            for zone in (timezone.utc, timezone(timedelta(hours=-7)), timezone(timedelta(hours=5, minutes=30))):
                start = (entry + timedelta(seconds=10)).astimezone(zone)
                (by_time,) = aeolis.history(
                    ["altitude_m"], run=self.landed, start=start, end=start + timedelta(seconds=10)
                )
                self.assertEqual(list(by_time.sclk), list(by_name.sclk))
            self.assertGreater(len(by_name.sclk), 0)

    def test_errors_are_the_server_s_own_sentences(self) -> None:
        with Client(self.server.address) as aeolis:
            with self.assertRaisesRegex(AeolisError, "404: .*99") as caught:
                aeolis.run(99)
            self.assertEqual(caught.exception.status, 404)
            with self.assertRaisesRegex(AeolisError, "there is no channel 'altitud'"):
                list(aeolis.subscribe(run=self.landed, channels=["altitud"]))
            with self.assertRaisesRegex(CommandRefused, "422: unknown command 'NO_SUCH'") as refused:
                aeolis.command("NO_SUCH")
            self.assertEqual(refused.exception.status, 422)
            self.assertEqual(refused.exception.reply.reason, refused.exception.detail)
            with self.assertRaisesRegex(CommandRefused, "422: unknown service 'CD': AD, BD"):
                aeolis.command("NO_OP", service="CD")
            with self.assertRaisesRegex(CommandRefused, "422: release_at: 'nan' is no instant"):
                aeolis.command("NO_OP", release_at=float("nan"))
            with self.assertRaisesRegex(CommandRefused, "409: no run goes on"):
                aeolis.command("NO_OP")
            aeolis._client._http.base_url = "http://127.0.0.1:1"
            with self.assertRaisesRegex(AeolisError, self.server.address), tempfile.TemporaryDirectory() as folder:
                aeolis.export(Path(folder) / "a.csv", ["altitude_m"], run=self.landed)
        threads = threading.active_count()
        with self.assertRaisesRegex(AeolisError, "http://127.0.0.1:1"):
            Client("http://127.0.0.1:1")
        self.assertEqual(threading.active_count(), threads)


class InProgress(unittest.TestCase):
    """A run that goes on while it is commanded and followed."""

    def test_a_program_commands_and_follows_a_landing(self) -> None:
        server = Server()
        self.addCleanup(server.end)
        environment = {**os.environ, "PYTHONPATH": str(ROOT / "clients/python"), "PYTHONUNBUFFERED": "1"}
        with Client(server.address) as aeolis:
            run = aeolis.start("nominal", seed=1, pace=20).run
            follower = subprocess.Popen(
                [sys.executable, str(ROOT / "clients/python/examples/follow.py"), server.address],
                env=environment, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
            )
            for example, typed in (("command.py", ""), ("do_edl.py", "EDL_DO_EDL\n")):
                done = subprocess.run(
                    [sys.executable, str(ROOT / "clients/python/examples" / example), server.address],
                    env=environment, text=True, input=typed, capture_output=True, timeout=300,
                )
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            sent = {each.name for each in aeolis.commands(run=run)}
            self.assertEqual(sent, {"NO_OP", "EDL_SET_PARAMETERS", "EDL_DO_EDL"})
            aeolis.control(pace=0)
            self.assertEqual(word(aeolis.wait_for_end(run, timeout_s=300), "outcome"), "touchdown")
            said, _ = follower.communicate(timeout=120)
            self.assertIn("TOUCHDOWN", said)

    def test_a_program_begins_a_procedure_and_acts_on_it(self) -> None:
        server = Server()
        self.addCleanup(server.end)
        with Client(server.address) as aeolis:
            self.assertIn("day_after", [each.procedure for each in aeolis.procedures()])
            run = aeolis.start("nominal", seed=1, pace=1).run
            begun = aeolis.begin_procedure("day_after", "flight_director", run=run, by="Ada")
            self.assertEqual(begun.procedure.number, 1)
            held = aeolis.act_on_procedure(1, "hold", "gnc", run=run, by="Ada", reason="not yet")
            self.assertEqual(held.procedure.held, "Ada (gnc): not yet")
            with self.assertRaises(AeolisError) as refused:
                aeolis.act_on_procedure(1, "stop", "gnc", run=run, by="Ada", reason="enough")
            self.assertEqual(refused.exception.status, 409)
            standing = aeolis.run_procedures(run=run).procedures
            self.assertEqual([each.procedure.held for each in standing], ["Ada (gnc): not yet"])

    def test_a_program_takes_a_position_and_answers_the_poll(self) -> None:
        server = Server()
        self.addCleanup(server.end)
        with Client(server.address) as aeolis:
            run = aeolis.start("nominal", seed=1, pace=1).run
            aeolis.act_on_position("take", "flight_director", run=run, by="Ada")
            aeolis.act_on_position("take", "gnc", run=run, by="Bob")
            aeolis.act_on_position("poll", "flight_director", run=run, by="Ada", subject="do edl")
            with self.assertRaises(AeolisError) as refused:
                aeolis.act_on_position("go", "flight_director", run=run, by="Ada")
            self.assertEqual(refused.exception.status, 409)
            aeolis.act_on_position("go", "gnc", run=run, by="Bob")
            went = aeolis.act_on_position("go", "flight_director", run=run, by="Ada")
            self.assertEqual(went.position_act.board.closed, "")
            self.assertEqual(len(aeolis.positions(run=run).acts), 5)

    def test_a_lost_connection_is_opened_again_without_a_gap_or_a_double(self) -> None:
        server = Server()
        self.addCleanup(server.end)

        async def follow() -> list[int]:
            async with AsyncClient(server.address) as aeolis:
                run = (await aeolis.start("nominal_auto", seed=3, pace=60)).run
                seen: list[int] = []
                items = aeolis.subscribe(run=run, channels=[], without_units=True)
                opened = aeolis._messages  # each connection is cut after two batches

                async def cut(wanted: dict) -> object:
                    batches = 0
                    async for kind, message in opened(wanted):
                        yield kind, message
                        batches += kind == "batch"
                        if batches == 2:
                            raise OSError("cut by the test")

                aeolis._messages = cut  # type: ignore[method-assign]
                async for item in items:
                    seen.append(item.seq)
                    if len(seen) == 60:
                        await items.aclose()
                        break
                await aeolis.control(stop=True)
                await aeolis.wait_for_end(run, timeout_s=60)
                aeolis._messages = opened  # type: ignore[method-assign]
                every = [item.seq async for item in aeolis.subscribe(run=run, channels=[], without_units=True)]
                assert seen == every[: len(seen)], (seen, every[: len(seen)])
                return seen

        self.assertEqual(len(asyncio.run(follow())), 60)

    def test_a_stream_that_is_refused_for_now_is_opened_again_and_one_refused_for_good_says_its_status(self) -> None:
        server = Server()
        self.addCleanup(server.end)
        refusals = ["503 Service Unavailable", "502 Bad Gateway", ""]  # empty: closed without an answer

        async def pass_on(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
            head = await reader.readuntil(b"\r\n\r\n")
            if b"/api/v1/stream" in head and refusals:
                if status := refusals.pop(0):
                    writer.write(f"HTTP/1.1 {status}\r\nContent-Length: 0\r\n\r\n".encode())
                writer.close()
                return
            there, back = await asyncio.open_connection("127.0.0.1", int(server.address.rsplit(":", 1)[1]))
            back.write(head)

            async def copy(source: asyncio.StreamReader, sink: asyncio.StreamWriter) -> None:
                while octets := await source.read(65536):
                    sink.write(octets)
                sink.close()

            await asyncio.gather(copy(reader, back), copy(there, writer), return_exceptions=True)

        async def follow() -> None:
            between = await asyncio.start_server(pass_on, "127.0.0.1", 0)
            port = between.sockets[0].getsockname()[1]
            async with AsyncClient(f"http://127.0.0.1:{port}") as aeolis:
                run = (await aeolis.start("nominal", pace=1)).run
                await aeolis.control(stop=True)
                await aeolis.wait_for_end(run, timeout_s=60)
                seen = [item.seq async for item in aeolis.subscribe(run=run)]
                self.assertEqual(seen, [item.seq async for item in aeolis.items(run=run)])
                self.assertEqual(refusals, [])
                refusals.append("401 Unauthorized")
                with self.assertRaises(AeolisError) as refused:
                    await aeolis.subscribe(run=run).__anext__()
                self.assertEqual(refused.exception.status, 401)
            between.close()

        asyncio.run(follow())

    def test_a_full_stream_that_is_cut_off_at_any_place_has_every_value_that_the_run_has(self) -> None:
        server = Server()
        self.addCleanup(server.end)

        async def follow(cuts: random.Random) -> None:
            async with AsyncClient(server.address) as aeolis:
                run = (await aeolis.start("nominal_auto", seed=3, pace=200)).run
                opened = aeolis._messages

                async def cut(wanted: dict) -> object:
                    batches = cuts.randrange(1, 12)
                    async for kind, message in opened(wanted):
                        yield kind, message
                        batches -= kind == "batch"
                        if batches == 0:
                            await asyncio.sleep(cuts.random() * 0.2)  # nobody follows meanwhile
                            raise OSError("cut by the test")

                aeolis._messages = cut  # type: ignore[method-assign]
                got: dict[int, bytes] = {}
                async for item in aeolis.subscribe(run=run):
                    self.assertNotIn(item.seq, got)
                    got[item.seq] = item.SerializeToString(deterministic=True)
                    if len(got) == 6000:
                        break
                await aeolis.control(stop=True)
                state = await aeolis.wait_for_end(run, timeout_s=60)
                wanted = [item async for item in aeolis.items(run=state.run) if item.seq <= max(got)]
                self.assertEqual([item.seq for item in wanted], list(got))
                for item in wanted:
                    self.assertEqual(item.SerializeToString(deterministic=True), got[item.seq])

        for seed in range(3):
            asyncio.run(follow(random.Random(seed)))

    def test_a_command_whose_reply_is_lost_is_sent_again_and_taken_once(self) -> None:
        server = Server()
        self.addCleanup(server.end)

        async def command() -> None:
            async with AsyncClient(server.address) as aeolis:
                run = (await aeolis.start("nominal", seed=3, pace=1)).run
                sent = aeolis._http.request
                lost = 2

                async def lose(*given: Any, **named: Any) -> httpx.Response:
                    nonlocal lost
                    answer = await sent(*given, **named)
                    if given[0] == "POST" and lost:
                        lost -= 1
                        raise httpx.ReadError("lost by the test")
                    return answer

                aeolis._http.request = lose  # type: ignore[method-assign]
                reply = await aeolis.command("NO_OP", run=run)
                self.assertTrue(reply.repeated)
                self.assertEqual(lost, 0)
                (history,) = await aeolis.commands(run=run)
                self.assertEqual(history.command, reply.command)
                self.assertRegex(history.client_id, "^[0-9a-f]{32}$")
                again = await aeolis.command("NO_OP", run=run, client_id=history.client_id)
                self.assertEqual(again.command, history.command)
                state = await aeolis.run(run)
                leaves_us = state.clocks.ert_us + 600_000_000
                at = datetime(2000, 1, 1, 12) + timedelta(microseconds=leaves_us)
                arrives = at + timedelta(seconds=state.light_time_s)
                forms = (at, at.isoformat() + "+00:00", "ert:" + at.isoformat(), "scet:" + arrives.isoformat())
                for release_at in forms:
                    reply = await aeolis.command("NO_OP", run=run, dry_run=True, release_at=release_at)
                    self.assertAlmostEqual(reply.leaves_us, leaves_us, delta=2)

        asyncio.run(command())


class Documents(unittest.TestCase):
    def test_each_example_of_the_page_for_programs_runs_as_it_stands(self) -> None:
        server = Server("--scenario", str(ROOT / "simulation/scenarios/nominal.textproto"))  # as ./run starts it
        self.addCleanup(server.end)
        with Client(server.address) as aeolis:
            while not aeolis.runs():
                time.sleep(0.1)
        page = (ROOT / "docs/programs.md").read_text()
        examples = re.findall(r"^```python\n(.*?)^```$", page, re.DOTALL | re.MULTILINE)
        self.assertGreaterEqual(len(examples), 2)
        for example in examples:
            self.assertLess(len(example.splitlines()), 40)
            done = subprocess.run(
                [sys.executable, "-c", example.replace("127.0.0.1:8080", server.address.removeprefix("http://"))],
                env={**os.environ, "PYTHONPATH": str(ROOT / "clients/python")}, text=True, capture_output=True,
                timeout=300,
            )
            self.assertEqual(done.returncode, 0, example + done.stderr)
            self.assertTrue(done.stdout)


if __name__ == "__main__":
    unittest.main()
