// SPDX-License-Identifier: Apache-2.0
// Reads server/api/openapi.yaml by Redocly's public rules, the recommended ones, each of them an error.
import { readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { createConfig, lintFromString } from '@redocly/openapi-core';

const file = fileURLToPath(new URL('../../server/api/openapi.yaml', import.meta.url));
const config = await createConfig({ extends: ['recommended-strict'] });
const problems = await lintFromString({ source: readFileSync(file, 'utf8'), absoluteRef: file, config });
for (const { ruleId, message, location } of problems) console.error(`${location[0].pointer}: ${message} (${ruleId})`);
process.exitCode = problems.length > 0 ? 1 : 0;
