# SPDX-License-Identifier: Apache-2.0
"""What can go wrong, each with one sentence that names it."""
from __future__ import annotations

from typing import Any


class AeolisError(Exception):
    """The server answered with a problem, or not at all (`status` 0)."""

    def __init__(self, status: int, detail: str) -> None:
        super().__init__(f"{status}: {detail}" if status else detail)
        self.status = status
        self.detail = detail


class CommandRefused(AeolisError):
    """A command got no number. `reply` says which check refused it."""

    def __init__(self, status: int, reply: Any) -> None:
        super().__init__(status, reply.reason or reply.detail)
        self.reply = reply


class CommandFailed(AeolisError):
    """A command was accepted, and a stage of it failed. `history` has all its stages."""

    def __init__(self, history: Any, detail: str) -> None:
        super().__init__(0, detail)
        self.history = history
