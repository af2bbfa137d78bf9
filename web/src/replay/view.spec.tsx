// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { render } from 'preact';
import { act } from 'preact/test-utils';
import { expect, it } from 'vitest';
import { useForTest } from '../run/session';
import { pastRange, withRecording } from '../run/shown';
import { LATE_LIMIT } from '../run/store';
import { aDictionary, aStore, unit } from '../testing/fixtures';
import { Reading } from './view';

it('the past as it was heard says where it no longer knows what was heard when; with the recording that does not matter', () => {
  const late = Array.from({ length: LATE_LIMIT + 1 }, (_, i) =>
    unit({ name: 'Navigation', sclk: 901 + i / 1000, ert: '2012-219T05:05:30.0' }),
  );
  useForTest(aStore([unit({ name: 'Status', sclk: 1230, ert: '2012-219T05:05:30.0' }), ...late]), aDictionary);
  const page = document.createElement('div');
  const said = (to: number) => {
    act(() => {
      pastRange.value = { from: -100, to };
      render(<Reading />, page);
    });
    return page.querySelector('[data-testid="not-told"]')?.textContent;
  };
  expect([said(-99.5), said(0), said(300)]).toEqual([
    undefined,
    `▲ Too much came late to tell it all apart: ${LATE_LIMIT / 2} packets of Navigation may be shown before they were heard.`,
    undefined,
  ]);
  act(() => {
    withRecording.value = true;
  });
  expect(said(0)).toBe(undefined);
  act(() => {
    render(null, page);
    withRecording.value = false;
    pastRange.value = undefined;
  });
});
