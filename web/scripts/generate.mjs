// SPDX-License-Identifier: Apache-2.0
// Makes TypeScript of schema/ in src/gen/.
//   node scripts/generate.mjs          in web/
import { execFileSync } from 'node:child_process';
import { mkdirSync } from 'node:fs';

const FILES = ['items', 'plan', 'prediction', 'run', 'scenario', 'stream'].map((name) => `aeolis/v1/${name}.proto`);

mkdirSync('src/gen', { recursive: true });
execFileSync(
  'protoc',
  [
    '-I',
    '../schema',
    '--plugin=protoc-gen-es=node_modules/.bin/protoc-gen-es',
    '--es_out=src/gen',
    '--es_opt=target=ts',
    ...FILES,
  ],
  { stdio: 'inherit' },
);
