// All that the page holds of one run. Filled by the stream; read by every panel. One store a run: another run, another
// store, so that nothing of one can be seen in the other.
import type {
  Alarm, Clocks, CommandStage, Event, Explanation, LinkChange, TimepointFiring, Tone, Unit,
} from '../gen/aeolis/v1/items_pb';
import type { RunState } from '../gen/aeolis/v1/run_pb';
import { SOURCE_RECORDED } from '../stream/columns';
import type { BatchOfFacts, Column, Fact } from '../stream/messages';
import { LIMIT_NOT_DRAWN, Series } from './series';
import { secondsOfDayOfYear } from './time';

const EVENT_LIMIT = 20000;
const UNIT_LIMIT = 400;
const LINK_LIMIT = 5000;
const ABOUT_ALARMS: ReadonlySet<string> = new Set(['alarm', 'staleness', 'alarmAction']);

export interface Known<T> {
  seq: number;
  fact: T;
}
export interface EventRow extends Known<Event> {
  live: boolean;
  recorded: boolean;
}
export interface ExplanationRow extends Known<Explanation> {
  live: boolean;
  recorded: boolean;
}
export interface FiringPair {
  name: string;
  live?: TimepointFiring;
  recorded?: TimepointFiring;
}
export interface CommandRow {
  command: number;
  name: string;
  arguments: string;
  /** What was said of each stage, oldest first: the last word counts, in a past view the last of then. */
  stages: Map<string, CommandStage[]>;
}
/** Of one packet over one link. */
export interface UnitTotals {
  link: string;
  apid: number;
  name: string;
  units: number;
  octets: number;
  duplicates: number;
}
export interface Sample {
  sclk: number;
  value: number;
  recorded: boolean;
}

export class RunStore {
  live = new Map<number, Series>();
  recorded = new Map<number, Series>();
  events: EventRow[] = [];
  explanations: ExplanationRow[] = [];
  tones: Known<Tone>[] = [];
  firings = new Map<number, FiringPair>();
  commands = new Map<number, CommandRow>();
  links = new Map<string, Known<LinkChange>[]>();
  alarms = new Map<number, Alarm>();
  units: Known<Unit>[] = [];
  /** By link and packet. */
  unitTotals = new Map<string, UnitTotals>();
  clocks: Clocks | undefined;
  completeThrough = 0;
  thinnedSinceHistory = false;
  /** Count what came about alarms, and about notes: whoever keeps their states asks again. */
  alarmsVersion = 0;
  notesVersion = 0;
  /** Of all samples, events and tones. */
  private newestSclk = -Infinity;
  /** Counts what came with samples of what is drawn. */
  samplesDrawn = 0;
  /** Counts changes of anything. */
  version = 0;

  constructor(public run: RunState, private readonly isDrawn: (channel: number) => boolean = () => true) {
    this.clocks = run.clocks;
  }

  get id(): number {
    return Number(this.run.run);
  }
  get going(): boolean {
    return ['waiting', 'running', 'paused'].includes(this.run.state);
  }
  get entrySclk(): number {
    return this.run.entrySclk;
  }
  /** Of what reaches Earth now. */
  get seenSclk(): number {
    return this.clocks?.seenSclk || this.clocks?.sclk || Math.max(this.run.startSclk, this.newestSclk);
  }
  get seenE(): number {
    return this.seenSclk - this.entrySclk;
  }
  /** SCLK of what was received at `ert`. The two run side by side, a light time apart, but for the drift of the clock on board. */
  sclkSeenAt(ert: string): number {
    const { sclk, ert: at } = this.instant;
    return sclk + (secondsOfDayOfYear(ert) - secondsOfDayOfYear(at)) / (this.run.clock?.rate || 1);
  }
  /** When, on Earth, what left the vehicle at `sclk` could be received; in seconds since 1970, NaN while nothing tells. */
  ertOf(sclk: number): number {
    return secondsOfDayOfYear(this.instant.ert) + (sclk - this.instant.sclk) * (this.run.clock?.rate || 1);
  }
  /**
   * One instant on both clocks. A run of the day before has no clocks any more; then a tone tells it, whose SCLK is that of
   * its beginning by light time, or else the first event that came live, which was on its way a little longer.
   */
  private get instant(): { sclk: number; ert: string } {
    if (this.clocks?.ert) return { sclk: this.seenSclk, ert: this.clocks.ert };
    const tone = this.tones[0]?.fact;
    if (tone) return { sclk: tone.sclk, ert: tone.ertStart };
    const event = this.events.find((row) => row.live)?.fact;
    return { sclk: event?.sclk ?? NaN, ert: event?.ert ?? '' };
  }

  update(run: RunState): void {
    this.run = run;
    if (run.clocks) this.clocks = run.clocks;
    ++this.version;
  }

  /** Of a channel, at `cutoff` or before: the newest, whichever way it came. */
  latest(id: number, cutoff = Infinity): Sample | undefined {
    const live = this.live.get(id)?.at(cutoff);
    const recorded = this.recorded.get(id)?.at(cutoff);
    if (recorded && (!live || recorded.sclk >= live.sclk)) return { ...recorded, recorded: true };
    return live && { ...live, recorded: false };
  }

  add(batch: BatchOfFacts): void {
    ++this.version;
    this.completeThrough = Math.max(this.completeThrough, batch.completeThrough);
    if (batch.clocks) this.clocks = batch.clocks;
    if (batch.thinned) this.thinnedSinceHistory = true;
    if (batch.columns.some((column) => this.isDrawn(column.id))) ++this.samplesDrawn;
    for (const column of batch.columns) {
      this.series(column).append(column.sclk, column.value);
      this.sawSclk(column.sclk.at(-1));
    }
    for (const fact of batch.facts) this.addFact(fact);
    if (this.events.length > EVENT_LIMIT) this.events.splice(0, this.events.length - EVENT_LIMIT);
  }

  addHistory(columns: Column[]): void {
    ++this.version;
    ++this.samplesDrawn;
    for (const column of columns) {
      this.series(column).replaceBefore(column.sclk, column.value);
      this.sawSclk(column.sclk.at(-1));
    }
  }

  /** A range that was asked for: exact where what we held was thinned. */
  addRange(columns: Column[], from_sclk: number, to_sclk: number): void {
    ++this.version;
    ++this.samplesDrawn;
    for (const column of columns) this.series(column).replace(from_sclk, to_sclk, column.sclk, column.value);
  }

  private sawSclk(sclk: number | undefined): void {
    if (sclk !== undefined && sclk > this.newestSclk) this.newestSclk = sclk;
  }

  private series(column: Column): Series {
    const all = column.recorded ? this.recorded : this.live;
    let series = all.get(column.id);
    if (!series) all.set(column.id, (series = new Series(this.isDrawn(column.id) ? undefined : LIMIT_NOT_DRAWN)));
    return series;
  }

  private addFact(item: Fact): void {
    if (item.kind === 'event' || item.kind === 'tone') this.sawSclk(item.fact.sclk);
    if (ABOUT_ALARMS.has(item.kind)) ++this.alarmsVersion;
    if (item.kind as string === 'note') ++this.notesVersion;
    switch (item.kind) {
      case 'event':
        this.addTwin(this.events, item, (a, b) => a.id === b.id && a.text === b.text);
        break;
      case 'explanation':
        this.addTwin(this.explanations, item, (a, b) => a.text === b.text && a.decision === b.decision);
        break;
      case 'tone':
        this.tones.push(item);
        break;
      case 'timepoint':
        this.addFiring(item.fact);
        break;
      case 'commandStage':
        this.addStage(item.fact);
        break;
      case 'link': {
        const changes = this.links.get(item.fact.link) ?? [];
        changes.push(item);
        if (changes.length > LINK_LIMIT) changes.shift();
        this.links.set(item.fact.link, changes);
        break;
      }
      case 'alarm':
        if (item.fact.severity === 'none') this.alarms.delete(item.fact.channel);
        else this.alarms.set(item.fact.channel, item.fact);
        break;
      case 'unit':
        this.addUnit(item);
        break;
    }
  }

  /** Keeps `rows` in order of SCLK. What came live and again with the recording is one row that was seen twice. */
  private addTwin<T extends { sclk: number; source: number; duplicate: boolean }>(
    rows: (Known<T> & { live: boolean; recorded: boolean })[], item: Known<T>, same: (a: T, b: T) => boolean,
  ): void {
    const recorded = item.fact.source === SOURCE_RECORDED;
    let index = rows.length;
    while (index > 0 && (rows[index - 1] as Known<T>).fact.sclk > item.fact.sclk) --index;
    for (let i = index - 1; i >= 0; --i) {
      const row = rows[i] as (typeof rows)[number];
      if (row.fact.sclk < item.fact.sclk) break;
      if (same(row.fact, item.fact) && (recorded ? !row.recorded : !row.live)) {
        if (recorded) row.recorded = true;
        else row.live = true;
        return;
      }
    }
    rows.splice(index, 0, { seq: item.seq, fact: item.fact, live: !recorded, recorded });
  }

  private addFiring(firing: TimepointFiring): void {
    const pair = this.firings.get(firing.timepoint) ?? { name: firing.name };
    if (firing.source === SOURCE_RECORDED) pair.recorded = firing;
    else pair.live = firing;
    this.firings.set(firing.timepoint, pair);
  }

  private addStage(stage: CommandStage): void {
    const number = Number(stage.command);
    let row = this.commands.get(number);
    if (!row) this.commands.set(number, (row = { command: number, name: stage.name, arguments: '', stages: new Map() }));
    if (stage.name) row.name = stage.name;
    if (stage.arguments) row.arguments = stage.arguments;
    row.stages.set(stage.stage, [...(row.stages.get(stage.stage) ?? []), stage]);
  }

  private addUnit(item: Known<Unit>): void {
    const { link, apid, name } = item.fact;
    const key = `${link} ${apid} ${name}`;
    const totals = this.unitTotals.get(key) ?? { link, apid, name, units: 0, octets: 0, duplicates: 0 };
    ++totals.units;
    totals.octets += item.fact.octets;
    if (item.fact.duplicate) ++totals.duplicates;
    this.unitTotals.set(key, totals);
    this.units.push(item);
    if (this.units.length > UNIT_LIMIT * 2) this.units.splice(0, UNIT_LIMIT);
  }
}
