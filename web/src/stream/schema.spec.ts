// SPDX-License-Identifier: Apache-2.0
import { createRegistry } from '@bufbuild/protobuf';
import type { DescField, DescFile, Registry } from '@bufbuild/protobuf';
import { describe, expect, it } from 'vitest';
import { file_aeolis_v1_stream } from '../gen/aeolis/v1/stream_pb';
import { file_aeolis_v1_stream as file_of_the_worker } from '../gen/worker/aeolis/v1/stream_pb';

const registryOf = (file: DescFile): Registry => createRegistry(file, ...file.dependencies);
const messagesOf = (registry: Registry) => [...registry].filter((type) => type.kind === 'message');
const enumsOf = (registry: Registry) => [...registry].filter((type) => type.kind === 'enum');
/** As the wire and JSON have it. */
const formOf = ({
  name,
  jsonName,
  number,
  fieldKind,
  scalar,
  message,
  enum: values,
  presence,
  oneof,
  proto,
}: DescField) => ({
  name,
  jsonName,
  number,
  fieldKind,
  scalar,
  message: message?.typeName,
  values: values?.typeName,
  presence,
  oneof: oneof?.name,
  label: proto.label,
  packed: proto.options?.packed,
});

const whole = registryOf(file_aeolis_v1_stream);
const spoken = registryOf(file_of_the_worker);

describe('the worker’s part of the schema', () => {
  it('has every field of each of its messages as the whole schema has it, but for orders that go over HTTP', () => {
    const missing: string[] = [];
    for (const message of messagesOf(spoken)) {
      const original = whole.getMessage(message.typeName);
      const here = new Map(message.fields.map((field) => [field.name, formOf(field)]));
      for (const field of original?.fields ?? []) {
        if (here.has(field.name)) expect(here.get(field.name), field.toString()).toEqual(formOf(field));
        else missing.push(`${message.name}.${field.name}`);
        here.delete(field.name);
      }
      expect([...here.keys()], message.typeName).toEqual([]);
    }
    for (const { typeName, values } of enumsOf(spoken)) {
      expect(
        values.map(({ name, number }) => [name, number]),
        typeName,
      ).toEqual(whole.getEnum(typeName)?.values.map(({ name, number }) => [name, number]));
    }
    expect(missing).toEqual(['RehearsalControl.start', 'RehearsalControl.inject', 'RehearsalControl.note']);
  });

  it('has no scenario and no dictionary: the page asks for these by HTTP, and every octet of it is part of the script', () => {
    const names = messagesOf(spoken).map(({ name }) => name);
    expect(names).toContain('Batch');
    expect(
      names.filter((name) => /^(Scenario|Dictionary.*|EntryState|FaultInjection|StartRehearsal)$/.test(name)),
    ).toEqual([]);
  });
});
