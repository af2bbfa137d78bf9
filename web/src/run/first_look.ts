// What is drawn, coarse, asked for before anything else is known, while the worker and its schema are still loading: someone waits for a
// picture. The history that has no seam replaces it. Where it fails nothing is lost but that head start.
import { LAYOUT } from '../layout';
import { SOURCE_RECORDED, splitBySource } from '../stream/columns';
import type { Column } from '../stream/messages';

const POINTS = 500; // ours: of a channel
const GOING = ['waiting', 'running', 'paused'];

export interface FirstLook {
  run: number;
  columns: Column[];
}

/** The run that will be shown, if `wanted` (0: whichever goes on, else the newest) is one; only what was asked for at its address, or the layout's plots. */
export async function firstLook(wanted: number, named: readonly string[]): Promise<FirstLook | undefined> {
  const get = async (path: string) => {
    const response = await fetch(`/api/v1${path}`, { credentials: 'same-origin' });
    if (!response.ok) throw new Error(String(response.status));
    return response.json();
  };
  try {
    const { runs = [] } = await get('/runs') as { runs?: { run: string; state: string }[] };
    const run = runs.find((each) => Number(each.run) === wanted) ?? runs.find((each) => GOING.includes(each.state)) ?? runs.reduce((newest, each) => (Number(each.run) > Number(newest?.run ?? 0) ? each : newest), runs[0]);
    if (!run) return undefined;
    const names = named.length > 0 ? named : LAYOUT.plots.map((plot) => plot.channel[0]);
    const { channels = [] } = await get(`/runs/${run.run}/channels?names=${names.map(encodeURIComponent).join(',')}&points=${POINTS}`) as { channels?: { id: number; sclk?: number[]; value?: number[]; source?: string[] }[] };
    return {
      run: Number(run.run),
      columns: channels.flatMap(({ id, sclk = [], value = [], source = [] }) =>
        splitBySource({ id, sclk, value: value.map(Number), source: source.map((each) => (each === 'SOURCE_RECORDED' ? SOURCE_RECORDED : 1)) } as never)),
    };
  } catch {
    return undefined;
  }
}
