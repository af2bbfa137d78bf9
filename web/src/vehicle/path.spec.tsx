// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { create } from '@bufbuild/protobuf';
import { render } from 'preact';
import { act } from 'preact/test-utils';
import { expect, it } from 'vitest';
import { TargetEllipseSchema } from '../gen/aeolis/v1/prediction_pb';
import { Path, ellipseWords } from './path';

const ellipse = create(TargetEllipseSchema, { majorM: 20000, minorM: 7000, azimuthDeg: 90 });

it('the ellipse is drawn to the scale of the map, and said in words', () => {
  const root = document.createElement('div');
  const map = <Path points={[]} now={undefined} stale={false} label="map" ellipse={ellipse} least_m={10000} />;
  act(() => render(map, root));
  const drawn = root.querySelector('[data-testid="ellipse"]');
  expect(['rx', 'ry', 'transform'].map((name) => drawn?.getAttribute(name))).toEqual(['35', '100', 'rotate(90)']);
  expect(ellipseWords(ellipse)).toBe('the 99 % ellipse, 20 × 7 km');
});
