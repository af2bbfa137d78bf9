// SPDX-License-Identifier: Apache-2.0
// Whether two states describe the same run. The number alone does not tell, since each archive counts from 1.
import type { NamedRun } from '../stream/names';

export const isSameRun = (a: NamedRun, b: NamedRun): boolean =>
  a.run === b.run && a.started === b.started && a.seed === b.seed;
