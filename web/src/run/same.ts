// SPDX-License-Identifier: Apache-2.0
// Whether two states describe the same run. The number alone does not tell, since each archive counts from 1.
import type { RunState } from '../gen/aeolis/v1/run_pb';

export const isSameRun = (a: RunState, b: RunState): boolean =>
  a.run === b.run && a.started === b.started && a.seed === b.seed;
