# SPDX-License-Identifier: Apache-2.0
"""The messages of the API, made from the descriptors that the server gives: they always fit its version."""
from __future__ import annotations

from typing import Any

from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

PACKAGE = "aeolis.v1."


class Schema:
    """Message classes by name: `schema.RunState`, `schema.ClientMessage`."""

    def __init__(self, descriptor_set: bytes) -> None:
        self._pool = descriptor_pool.DescriptorPool()
        for file in descriptor_pb2.FileDescriptorSet.FromString(descriptor_set).file:
            self._pool.Add(file)  # each after those that it imports
        self._classes: dict[str, Any] = {}

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        if name not in self._classes:
            try:
                descriptor = self._pool.FindMessageTypeByName(PACKAGE + name)
            except KeyError:
                raise AttributeError(f"the server's schema has no message {name}") from None
            self._classes[name] = _class_of(descriptor)
        return self._classes[name]


def word(message: Any, field: str) -> str:
    """The name of an enumeration's value, as in JSON: word(run, "outcome") is "touchdown"."""
    number = getattr(message, field)
    value = message.DESCRIPTOR.fields_by_name[field].enum_type.values_by_number.get(number)
    return value.name if value else str(number)


def _class_of(descriptor: Any) -> Any:
    if hasattr(message_factory, "GetMessageClass"):
        return message_factory.GetMessageClass(descriptor)
    return message_factory.MessageFactory(descriptor.file.pool).GetPrototype(descriptor)
