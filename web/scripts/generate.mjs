// SPDX-License-Identifier: Apache-2.0
// Makes TypeScript of schema/: src/gen/ has all of it, for types and tests, and src/gen/worker/ what the worker speaks, whose descriptors are part of
// its script. Field numbers and names are the same in both; what the part leaves out is never sent to the worker, nor by it.
//   node scripts/generate.mjs          in web/
import { execFileSync } from 'node:child_process';
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { fromBinary, toBinary } from '@bufbuild/protobuf';
import { FileDescriptorSetSchema } from '@bufbuild/protobuf/wkt';

const FILES = ['items', 'run', 'scenario', 'stream'].map((name) => `aeolis/v1/${name}.proto`);
// What it reads and writes; messages that these hold come with them.
const SPOKEN = [
  'ClientMessage',
  'ServerMessage',
  'TimepointList',
  'ScenarioList',
  'PacketList',
  'RecordingSummary',
  'ProofReport',
  'AsFlownReport',
  'CommandList',
];
const LEFT_OUT = { RehearsalControl: ['start', 'inject', 'note'] }; // the page asks for these by HTTP: with them a whole scenario would come

/** Leaves of the files the messages and enumerations that the spoken ones lead to. */
function leaveTheSpoken(files) {
  const types = new Map(
    files.flatMap((file) =>
      [...file.messageType, ...file.enumType].map((type) => [`.${file.package}.${type.name}`, type]),
    ),
  );
  const kept = new Set();
  const keep = (type) => {
    if (kept.has(type)) return;
    kept.add(type);
    if (type.name in LEFT_OUT) type.field = type.field.filter((field) => !LEFT_OUT[type.name].includes(field.name));
    for (const field of type.field ?? []) if (field.typeName) keep(types.get(field.typeName));
  };
  for (const name of SPOKEN) keep(types.get(`.aeolis.v1.${name}`));
  for (const file of files) {
    file.messageType = file.messageType.filter((type) => kept.has(type));
    file.enumType = file.enumType.filter((type) => kept.has(type));
  }
}

const protoc = (...of) => execFileSync('protoc', [...of, ...FILES], { stdio: 'inherit' });
const typescript = (folder) => {
  mkdirSync(folder, { recursive: true });
  return ['--plugin=protoc-gen-es=node_modules/.bin/protoc-gen-es', `--es_out=${folder}`, '--es_opt=target=ts'];
};

const temporary = mkdtempSync(path.join(tmpdir(), 'aeolis-schema-'));
try {
  const set = path.join(temporary, 'schema.binpb');
  protoc('-I', '../schema', ...typescript('src/gen'), '--include_imports', `--descriptor_set_out=${set}`);
  const all = fromBinary(FileDescriptorSetSchema, readFileSync(set));
  leaveTheSpoken(all.file);
  writeFileSync(set, toBinary(FileDescriptorSetSchema, all));
  protoc(`--descriptor_set_in=${set}`, ...typescript('src/gen/worker'));
} finally {
  rmSync(temporary, { recursive: true });
}
