// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { render } from 'preact';
import { act } from 'preact/test-utils';
import { afterEach, beforeEach, expect, it, vi } from 'vitest';
import { access } from '../access/model';
import { step, uplink } from '../commands/line';
import { stream } from '../run/connection';
import { useForTest } from '../run/session';
import { lookAtPast, notices, pastRange, store } from '../run/shown';
import { tab } from '../places/model';
import { onKey } from '../shortcuts/model';
import { aDictionary, aRun, aStore, samples } from '../testing/fixtures';
import { aServer } from '../testing/server';
import { leaveReport, openReport, reportState } from './opened';
import { AnomalyReport } from './view';

const server = aServer();
let root: HTMLElement;
const inSight = (element: HTMLElement, top: number) =>
  (element.getBoundingClientRect = () =>
    ({ left: 0, right: 10, width: 10, top, bottom: top + 10, height: 10 }) as DOMRect);
const find = <T extends HTMLElement>(id: string) => document.querySelector<T>(`[data-testid="${id}"]`);
const draw = () => act(() => render(reportState.value === 'closed' ? null : <AnomalyReport />, root));
const settled = async () => {
  await act(async () => void (await new Promise((resolve) => setTimeout(resolve, 0))));
  draw();
};
function press(key: string, more: KeyboardEventInit = {}): void {
  act(
    () =>
      void (document.activeElement ?? document.body).dispatchEvent(
        new KeyboardEvent('keydown', { key, bubbles: true, cancelable: true, ...more }),
      ),
  );
  draw();
}
function typeInto(id: string, text: string): void {
  const field = find<HTMLInputElement>(id);
  if (!field) throw new Error(`no ${id}`);
  field.value = text;
  act(() => void field.dispatchEvent(new Event('input', { bubbles: true })));
}
const posted = () => server.asked.filter(({ method }) => method === 'POST');

beforeEach(() => {
  document.body.innerHTML = `<button id="before"></button>
    <p data-menu="channel altitude_m"></p><p data-menu="channel speed_mps"></p>
    <div style="overflow-y: auto"><p data-menu="channel edl_phase"></p></div><div id="root"></div>`;
  root = document.querySelector('#root')!;
  const [altitude, speed, phase] = document.querySelectorAll<HTMLElement>('[data-menu]');
  inSight(altitude!, 20);
  inSight(speed!, 1e6); // below the window
  inSight(phase!, 100); // scrolled away in its box
  inSight(phase!.parentElement!, 20);
  useForTest(aStore([samples(899, { 3: 1234.5, 4: 5000, 1: 4 })]), aDictionary);
  stream.value = { ...stream.value, state: 'live' };
  access.value = { state: 'open' };
  uplink.value = { ...uplink.value, controller: 'Ann' };
  notices.value = [];
  window.addEventListener('keydown', onKey);
  server.routes['POST /runs/1/notes'] = { json: {} };
  server.routes['GET /runs/1/notes'] = { json: { notes: [] } };
});
afterEach(() => {
  window.removeEventListener('keydown', onKey);
  [reportState.value, pastRange.value, step.value] = ['closed', undefined, 'type'];
  draw();
});

it('one key opens it with the focus in the field of the cause and the values in sight in its text', () => {
  press('!');
  expect(document.activeElement).toBe(find('report-cause'));
  const text = find<HTMLTextAreaElement>('report-text')?.value ?? '';
  expect(text).toMatch(/^At E−1:40\.0, [^]*\nValues in view: 1\n- altitude_m: 1234\.5 m, 1\.0 s old$/);
  expect(find('report-first')?.textContent).toBe('Anomaly report: cause not known');
  expect(find('report')?.getAttribute('aria-labelledby')).toBe('report-title');
});
it('its text stays that of its instant while the run goes on', () => {
  press('!');
  const before = find<HTMLTextAreaElement>('report-text')?.value;
  useForTest(aStore([samples(950, { 3: 7 })]), aDictionary);
  typeInto('report-cause', 'x');
  draw();
  expect(find<HTMLTextAreaElement>('report-text')?.value).toBe(before);
});
it('Ctrl Enter writes it once into the log of its run, with its instant, and gives the focus back', async () => {
  document.querySelector<HTMLElement>('#before')?.focus();
  press('!');
  typeInto('report-cause', 'radar late');
  store.value = aStore([], aRun({ run: 2n })); // another run began meanwhile
  press('Enter', { ctrlKey: true });
  press('Enter', { ctrlKey: true });
  await settled();
  expect(posted().map(({ path }) => path)).toEqual(['/runs/1/notes']);
  expect(posted()[0]?.body).toMatchObject({
    by: 'Ann',
    sclk: 900,
    text: expect.stringMatching(/^Anomaly report: radar late\nAt E−1:40\.0/),
  });
  expect(find('report-kept')?.textContent).toContain('is in the shift log');
  expect(document.activeElement?.id).toBe('before');
  press('Escape');
  expect(reportState.value).toBe('closed');
});
it('Esc leaves at once when nothing was typed, else asks first; typing on takes the question back', () => {
  press('!');
  press('Escape');
  expect([reportState.value, find('report')]).toEqual(['closed', null]);
  press('!');
  typeInto('report-text', 'mine');
  press('Escape');
  expect(find('report-asks')?.textContent).toContain('Esc again throws it away');
  typeInto('report-cause', 'm');
  draw();
  expect(find('report-asks')).toBeNull();
  press('Escape');
  press('Escape');
  expect([reportState.value, posted()]).toEqual(['closed', []]);
});
it('Esc takes back what is armed before it leaves', () => {
  press('!');
  step.value = 'armed';
  press('Escape');
  expect([step.value, reportState.value]).toEqual(['review', 'open']);
});
it('no key typed into it or onto its buttons is a shortcut', () => {
  vi.useFakeTimers({ toFake: ['setTimeout', 'clearTimeout'] });
  press('!');
  tab.value = 'channels';
  for (const where of ['report-cause', 'report-text', 'report-send']) {
    find(where)?.focus();
    press('n');
    vi.advanceTimersByTime(2000);
    press('?');
    press('!');
  }
  vi.useRealTimers();
  expect([tab.value, reportState.value]).toEqual(['channels', 'open']);
});
it('a refusal stays in it with all that was typed, and a missing name gets the focus', async () => {
  server.routes['POST /runs/1/notes'] = { status: 422, json: { error: 'by: who says so? A name is wanted' } };
  uplink.value = { ...uplink.value, controller: '' };
  press('!');
  typeInto('report-cause', 'radar late');
  press('Enter', { ctrlKey: true });
  await settled();
  expect(find('report-problem')?.textContent).toContain('it was not written down: by: who says so?');
  expect(find<HTMLInputElement>('report-cause')?.value).toBe('radar late');
  expect(document.activeElement).toBe(find('signature'));
});
it('a refusal that comes after it was left is told', async () => {
  server.routes['POST /runs/1/notes'] = { status: 503, json: { error: 'too much waits' } };
  press('!');
  press('Enter', { ctrlKey: true });
  leaveReport();
  draw();
  await settled();
  expect(notices.value.map(({ text }) => text)).toEqual([
    'The anomaly report: it was not written down: too much waits',
  ]);
});
it('in a past view its first line says so', () => {
  lookAtPast({ from: -200, to: -140 }, true);
  press('!');
  expect(find('report-first')?.textContent).toBe(
    'Anomaly report: cause not known (PAST, NOT LIVE: E−2:20.0, with the recording)',
  );
});
it('observers get a sentence and no form; without a run there is nothing to report on', () => {
  access.value = { state: 'in', user: 'olga', role: 'observer', rights: [] };
  press('!');
  expect(find('report-none')?.textContent).toContain('Observers write nothing into the shift log');
  expect([find('report-cause'), find('report-send')]).toEqual([null, null]);
  expect(document.activeElement?.textContent).toContain('close');
  press('Escape');
  access.value = { state: 'open' };
  store.value = undefined;
  openReport();
  draw();
  expect(find('report-none')?.textContent).toBe('There is no run to report on.');
});
