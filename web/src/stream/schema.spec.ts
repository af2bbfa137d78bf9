// SPDX-License-Identifier: Apache-2.0
import type { DescMessage } from '@bufbuild/protobuf';
import { describe, expect, it } from 'vitest';
import * as whole from '../gen/aeolis/v1/stream_pb';
import * as wholeRun from '../gen/aeolis/v1/run_pb';
import { PredictionSchema as WholePrediction } from '../gen/aeolis/v1/prediction_pb';
import * as run from '../gen/worker/aeolis/v1/run_pb';
import { PredictionSchema } from '../gen/worker/aeolis/v1/prediction_pb';
import { ClientMessageSchema, ServerMessageSchema } from '../gen/worker/aeolis/v1/stream_pb';

/** Every field of `root` and of what it holds: `Message.field`, its number, kind and type. */
function fieldsOf(root: DescMessage, found = new Map<string, string[]>()): Map<string, string[]> {
  if (found.has(root.typeName)) return found;
  found.set(
    root.typeName,
    root.fields.map((field) => {
      const type = field.message ?? field.enum;
      const values = field.enum?.values.map((value) => `${value.name}=${value.number}`).join() ?? '';
      const { name, number, fieldKind, scalar = '', presence } = field;
      return [name, number, fieldKind, scalar, type?.typeName ?? '', values, presence].join(' ');
    }),
  );
  for (const { message } of root.fields) if (message) fieldsOf(message, found);
  return found;
}

describe("the worker's schema", () => {
  it.each([
    ['what the server sends', ServerMessageSchema, whole.ServerMessageSchema],
    ['timepoints', run.TimepointListSchema, wholeRun.TimepointListSchema],
    ['a prediction', PredictionSchema, WholePrediction],
    ['scenarios', run.ScenarioListSchema, wholeRun.ScenarioListSchema],
    ['packets', run.PacketListSchema, wholeRun.PacketListSchema],
    ['the recording', run.RecordingSummarySchema, wholeRun.RecordingSummarySchema],
    ['the proof', run.ProofReportSchema, wholeRun.ProofReportSchema],
    ['the report', run.AsFlownReportSchema, wholeRun.AsFlownReportSchema],
    ['commands', run.CommandListSchema, wholeRun.CommandListSchema],
  ])('has every field of %s', (_name, its, expected) => {
    expect(fieldsOf(its)).toEqual(fieldsOf(expected));
  });

  it('of what the page sends lacks only what goes by HTTP', () => {
    const its = fieldsOf(ClientMessageSchema);
    const expected = fieldsOf(whole.ClientMessageSchema);
    const control = expected
      .get('aeolis.v1.RehearsalControl')
      ?.filter((field) => !/^(start|inject|note|plan|jump) /.test(field));
    expect(its.get('aeolis.v1.RehearsalControl')).toEqual(control);
    for (const name of ['Subscribe', 'CommandRequest']) {
      expect(its.get(`aeolis.v1.${name}`)).toEqual(expected.get(`aeolis.v1.${name}`));
      expect(its.get(`aeolis.v1.${name}`)?.length).toBeGreaterThan(3);
    }
    expect(its.has('aeolis.v1.Scenario')).toBe(false);
  });
});
