// SPDX-License-Identifier: Apache-2.0
// What the page shows, as its address has it. A link opens the same picture; a layout is the part of it that says what
// the grid's places show.

interface Span {
  from: number;
  to: number;
}

/** What the places of the grid show. Undefined: as the console comes. */
export interface View {
  /** The tab of the data panel, and what the two other places show. */
  data?: string | undefined;
  middle?: string | undefined;
  low?: string | undefined;
  /** The plots from top to bottom, each with the channels that share it. */
  plots?: readonly (readonly string[])[] | undefined;
  /** The panel that has the room of all pictures. */
  full?: string | undefined;
}

/** All of it. Times in seconds from entry. */
export interface Picture extends View {
  /** The panel that the page shows alone. */
  panel?: string | undefined;
  /** 0: the current run, else the newest. */
  run: number;
  /** The part of the run shown as the past; undefined: the run as it goes on. */
  past?: (Span & { recorded: boolean }) | undefined;
  /** The stretch of timeline, tones and plots; undefined: the landing. */
  span?: 'run' | 'minute' | Span | undefined;
  /** The instant that the cursor points at. */
  cursor?: number | undefined;
  /** The run that is laid over the plots. */
  over?: number | undefined;
}

const WORDS = ['panel', 'full', 'data', 'middle', 'low'] as const;

const spanText = ({ from, to }: Span) => `${from},${to}`;

/** The query of the address, without "?". Names as they are; of the rest only what differs from how the console comes. */
export function queryOf(picture: Partial<Picture>): string {
  const { run, past, span, plots, cursor, over } = picture;
  const parts: [string, string | undefined][] = [
    ['run', run ? String(run) : undefined],
    ['past', past && spanText(past)],
    ['with', past?.recorded ? 'recording' : undefined],
    ['span', typeof span === 'object' ? spanText(span) : span],
    ['at', cursor === undefined ? undefined : String(cursor)],
    ['over', over ? String(over) : undefined],
    ...WORDS.map((word): [string, string | undefined] => [word, picture[word]]),
    ['channels', plots?.map((names) => names.join(' ')).join(',')],
  ];
  return parts
    .flatMap(([name, value]) =>
      value === undefined ? [] : [`${name}=${encodeURIComponent(value).replaceAll('%2C', ',').replaceAll('%20', '+')}`],
    )
    .join('&');
}

const seconds = (text: string | undefined): number | undefined =>
  text !== undefined && /^-?\d+(\.\d+)?$/.test(text) ? Number(text) : undefined;

function readSpan(text: string): Span | undefined {
  const [from, to, more] = text.split(',');
  const [first, last] = [seconds(from), seconds(to)];
  return more === undefined && first !== undefined && last !== undefined && first <= last
    ? { from: first, to: last }
    : undefined;
}

/** Reads an address; `problems` has a line for each part that is none. Parts of other names mean nothing. */
export function pictureOf(query: string): { picture: Picture; problems: string[] } {
  const asked = new URLSearchParams(query);
  const picture: Picture = { run: 0 };
  const problems: string[] = [];
  const part = <T>(name: string, what: string, read: (text: string) => T | undefined): T | undefined => {
    const text = asked.get(name);
    const value = text === null ? undefined : read(text);
    if (text !== null && value === undefined) problems.push(`${name}=${text.slice(0, 40)} in the address is ${what}`);
    return value;
  };
  const numberOf = (name: string) =>
    part(name, 'no number of a run', (text) => (/^\d{1,9}$/.test(text) ? Number(text) : undefined));
  picture.run = numberOf('run') ?? 0;
  const over = numberOf('over');
  if (over) picture.over = over;
  const past = part('past', 'no range in seconds from entry', readSpan);
  if (past) picture.past = { ...past, recorded: asked.get('with') === 'recording' };
  const span = part('span', 'no stretch of time', (text) =>
    text === 'run' || text === 'minute' ? text : readSpan(text),
  );
  if (span !== undefined) picture.span = span;
  const cursor = part('at', 'no time in seconds from entry', seconds);
  if (cursor !== undefined) picture.cursor = cursor;
  for (const word of WORDS) {
    const value = asked.get(word);
    if (value) picture[word] = value;
  }
  const plots = (asked.get('channels') ?? '')
    .split(',')
    .map((names) => names.split(/[ +]/).filter((name) => name !== ''))
    .filter((names) => names.length > 0);
  if (plots.length > 0) picture.plots = plots;
  return { picture, problems };
}

/** The picture that the page was opened with. */
export const opened = pictureOf(globalThis.location?.search ?? '');
