// SPDX-License-Identifier: Apache-2.0
// Makes TypeScript of schema/ in src/gen/: all of it, and in src/gen/worker/ what the worker decodes and encodes.
//   node scripts/generate.mjs          in web/
import { execFileSync } from 'node:child_process';
import { mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { fromBinary, toBinary } from '@bufbuild/protobuf';
import { FileDescriptorSetSchema } from '@bufbuild/protobuf/wkt';
import { pruned } from './pruned.mjs';

const FILES = ['items', 'plan', 'positions', 'prediction', 'procedures', 'run', 'scenario', 'stream'].map(
  (name) => `aeolis/v1/${name}.proto`,
);

/** The messages that the worker decodes from the socket, or from an answer, and encodes. */
const OF_THE_WORKER = [
  'ServerMessage',
  'ClientMessage',
  'TimepointList',
  'Prediction',
  'ScenarioList',
  'PacketList',
  'RecordingSummary',
  'ProofReport',
  'AsFlownReport',
  'CommandList',
].map((name) => `.aeolis.v1.${name}`);

/** Fields that the page sends by HTTP only, as JSON. They alone need the schema of scenarios. */
const NOT_ON_THE_SOCKET = ['start', 'inject', 'note', 'plan', 'jump'].map(
  (name) => `.aeolis.v1.RehearsalControl.${name}`,
);

function protoc(...more) {
  execFileSync('protoc', more, { stdio: 'inherit' });
}

function typescript(folder, from, files) {
  mkdirSync(folder, { recursive: true });
  protoc(
    ...from,
    '--plugin=protoc-gen-es=node_modules/.bin/protoc-gen-es',
    `--es_out=${folder}`,
    '--es_opt=target=ts',
    ...files,
  );
}

typescript('src/gen', ['-I', '../schema'], FILES);

const set = 'src/gen/worker/schema.bin';
mkdirSync(path.dirname(set), { recursive: true });
protoc('-I', '../schema', '--include_imports', `--descriptor_set_out=${set}`, ...FILES);
const schema = pruned(fromBinary(FileDescriptorSetSchema, readFileSync(set)), OF_THE_WORKER, NOT_ON_THE_SOCKET);
writeFileSync(set, toBinary(FileDescriptorSetSchema, schema));
typescript(
  'src/gen/worker',
  [`--descriptor_set_in=${set}`],
  schema.file.map(({ name }) => name),
);
rmSync(set);
