// SPDX-License-Identifier: Apache-2.0
// All that the page holds of one run. Filled by the stream; read by every panel. One store a run: another run, another
// store, so that nothing of one can be seen in the other.
import type { Clocks, Explanation, LinkChange, TimepointFiring, Unit } from '../gen/aeolis/v1/items_pb';
import type { RunState } from '../gen/aeolis/v1/run_pb';
import { SOURCE_RECORDED } from '../stream/columns';
import type { BatchOfFacts, Column, Fact } from '../stream/messages';
import type { NamedAlarm, NamedEvent, NamedStage, NamedTone } from '../stream/names';
import { LIMIT_NOT_DRAWN, Series } from './series';
import { isGoing } from './start';
import { secondsOfDayOfYear, secondsOfErt } from './time';

const EVENT_LIMIT = 20000;
const UNIT_LIMIT = 400;
const LINK_LIMIT = 5000;
const ALARM_LIMIT = 1000; // of a channel
const LATE_S = 2; // ours: what is heard so much later than light takes was kept by an orbiter, or in a queue on board
export const LATE_LIMIT = 1 << 14; // of a packet: what is older is forgotten, and notTold says so
const ABOUT_ALARMS: ReadonlySet<string> = new Set(['alarm', 'staleness', 'alarmAction']);
const ABOUT_TIMELINE: ReadonlySet<string> = new Set(['timepoint', 'tone', 'commandStage']);

/** `ert_s`: when it had come, seconds since 1970. */
export interface Known<T> {
  seq: number;
  ert_s: number;
  fact: T;
}
/** `known_s`: when it was known on Earth, seconds since 1970. */
interface ToneRow extends Known<NamedTone> {
  known_s: number;
}
/** What the recording brings again. `heard_s`: when it came live, seconds since 1970; NaN: it did not. */
interface Twin {
  live: boolean;
  recorded: boolean;
  heard_s: number;
}
interface EventRow extends Known<NamedEvent>, Twin {}
interface ExplanationRow extends Known<Explanation>, Twin {}
interface FiringPair {
  name: string;
  live?: TimepointFiring;
  recorded?: TimepointFiring;
  heard_s?: number; // as of a twin
}
export type StageWord = NamedStage & { ert_s: number };
export interface CommandRow {
  command: number;
  name: string;
  arguments: string;
  /** What was said of each stage, oldest first: the last word counts, in a past view the last of then. */
  stages: Map<string, StageWord[]>;
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

/** `b` may be NaN. */
const later = (a: number, b: number): number => (Number.isNaN(b) ? a : Math.max(a, b));

/** Channels as they were heard: each is looked at only when it is asked for. */
class HeardSeries extends Map<number, Series> {
  constructor(
    private readonly all: ReadonlyMap<number, Series>,
    private readonly heard: (channel: number, series: Series | undefined) => Series | undefined,
  ) {
    super();
  }
  override get(channel: number): Series | undefined {
    return this.heard(channel, this.all.get(channel));
  }
  override has(channel: number): boolean {
    return this.all.has(channel);
  }
}

export class RunStore {
  live = new Map<number, Series>();
  recorded = new Map<number, Series>();
  events: EventRow[] = [];
  explanations: ExplanationRow[] = [];
  tones: ToneRow[] = [];
  firings = new Map<number, FiringPair>();
  commands = new Map<number, CommandRow>();
  links = new Map<string, Known<LinkChange>[]>();
  /** Those that stand now, by channel. */
  alarms = new Map<number, NamedAlarm>();
  private readonly alarmChanges = new Map<number, NamedAlarm[]>();
  units: Known<Unit>[] = [];
  /** By link and packet. */
  unitTotals = new Map<string, UnitTotals>();
  clocks: Clocks | undefined;
  completeThrough = 0;
  /** Channels of which the history has come: where nothing is held of another, it may only not have been asked for yet. */
  askedFor = new Set<string>();
  thinnedSinceHistory = false;
  /** Count what came about alarms, and about notes: whoever keeps their states asks again. */
  alarmsVersion = 0;
  notesVersion = 0;
  /** Counts what came from which the timeline is predicted: firings, tones, stages of commands. */
  timelineVersion = 0;
  /** Of all samples, events and tones. */
  private newestSclk = -Infinity;
  private newestErt_s = NaN;
  private heard: { version: number; cutoff: number; run: RunStore } | undefined;
  /** Of each packet, what came live, but late: SCLK of the unit, and of what else was heard then, which grows. */
  private readonly late = new Map<string, { sclk: number[]; heard: number[] }>();
  /** Of each packet, of how much that came late is not kept any more, from which SCLK on, and when the last of it was heard. */
  private readonly lateForgotten = new Map<string, { units: number; from: number; heard: number }>();
  /** Of each channel, the SCLK of the last sample that an answer of live samples alone brought. */
  private readonly liveAloneThrough = new Map<number, number>();
  private readonly heardSeries = new Map<number, { of: Series; version: number; key: string; series: Series }>();
  private lastUnit = { ert_s: NaN, sclk: NaN };
  /** Counts what came with samples of what is drawn. */
  samplesDrawn = 0;
  /** Counts changes of anything. */
  version = 0;

  constructor(
    public run: RunState,
    private readonly isDrawn: (channel: number) => boolean = () => true,
  ) {
    this.clocks = run.clocks;
  }

  get id(): number {
    return Number(this.run.run);
  }
  get going(): boolean {
    return isGoing(this.run);
  }
  get entrySclk(): number {
    return this.run.entrySclk;
  }
  /** Of another mission that is followed nobody knows when it enters. */
  get entryKnown(): boolean {
    return this.run.entrySclk !== 0;
  }
  /** Of what reaches Earth now. */
  get seenSclk(): number {
    return this.clocks?.seenSclk || this.clocks?.sclk || Math.max(this.run.startSclk, this.newestSclk);
  }
  get seenE(): number {
    return this.seenSclk - this.entrySclk;
  }
  /** SCLK of what was received at `ert_s`, seconds since 1970. The two run side by side, a light time apart, but for the drift of the clock on board. */
  sclkSeenAt(ert_s: number): number {
    const at = this.instant;
    return at.sclk + (ert_s - at.ert_s) / (this.run.clock?.rate || 1);
  }
  /** When, on Earth, what left the vehicle at `sclk` could be received; in seconds since 1970, NaN while nothing tells. */
  ertOf(sclk: number): number {
    const at = this.instant;
    return at.ert_s + (sclk - at.sclk) * (this.run.clock?.rate || 1);
  }
  /**
   * One instant on both clocks. A run of the day before has no clocks any more; then a tone tells it, whose SCLK is that of
   * its beginning by light time, or else the first event that came live, which was on its way a little longer.
   */
  private get instant(): { sclk: number; ert_s: number } {
    if (this.clocks?.ert) return { sclk: this.seenSclk, ert_s: secondsOfDayOfYear(this.clocks.ert) };
    const tone = this.tones[0]?.fact;
    if (tone) return { sclk: tone.sclk, ert_s: secondsOfErt(tone.ertStartUs) };
    const event = this.events.find((row) => row.live);
    return { sclk: event?.fact.sclk ?? NaN, ert_s: event?.ert_s ?? NaN };
  }

  /** Whether what is dated `ert_s` was known on Earth when the vehicle was heard at `cutoff`. */
  knownBy(ert_s: number, cutoff: number): boolean {
    return cutoff === Infinity || !(this.sclkSeenAt(ert_s) > cutoff);
  }
  /** Tones that had been decided by then. */
  tonesBy(cutoff: number): readonly ToneRow[] {
    return cutoff === Infinity
      ? this.tones
      : this.tones.filter(({ fact, known_s }) => fact.sclk <= cutoff && this.knownBy(known_s, cutoff));
  }
  /**
   * The same run as it had been heard when the vehicle was heard at `cutoff`: without what only the recording told, and without what an
   * orbiter or a queue on board brought later. It is read, and never added to.
   */
  asHeardBy(cutoff: number, packetOf: (channel: number) => string | undefined): RunStore {
    if (this.heard?.version === this.version && this.heard.cutoff === cutoff) return this.heard.run;
    const until_s = cutoff === Infinity ? Infinity : this.ertOf(cutoff);
    const was = <T extends Twin>(rows: readonly T[]) =>
      rows.filter((row) => row.live && !(row.heard_s > until_s)).map((row) => ({ ...row, recorded: false }));
    const firings = [...this.firings].flatMap(([id, { name, live: told, heard_s = NaN }]) =>
      told && !(heard_s > until_s) ? [[id, { name, live: told, heard_s }] as const] : [],
    );
    const run = Object.assign(Object.create(this) as RunStore, {
      recorded: new Map<number, Series>(),
      live: this.liveBy(cutoff, packetOf),
      firings: new Map<number, FiringPair>(firings),
      events: was(this.events),
      explanations: was(this.explanations),
    });
    this.heard = { version: this.version, cutoff, run };
    return run;
  }

  /** Without the samples of units that were under way at `cutoff`: made when they are asked for, and again when others are. */
  private liveBy(cutoff: number, packetOf: (channel: number) => string | undefined): ReadonlyMap<number, Series> {
    const underWay = new Map<string, { key: string; instants: Set<number> }>();
    for (const [packet, { sclk, heard }] of this.late) {
      const which = sclk.flatMap((at, i) => (at <= cutoff && (heard[i] as number) > cutoff ? [i] : []));
      if (which.length > 0)
        underWay.set(packet, {
          key: `${which[0]} ${which.at(-1)} ${which.length}`,
          instants: new Set(which.map((i) => sclk[i] as number)),
        });
    }
    if (underWay.size === 0) return this.live;
    const heard = (channel: number, series: Series | undefined): Series | undefined => {
      const without = series && underWay.get(packetOf(channel) ?? '');
      if (!without) return series;
      const made = this.heardSeries.get(channel);
      if (made?.of === series && made.version === series.version && made.key === without.key) return made.series;
      const copy = series.without(without.instants);
      this.heardSeries.set(channel, { of: series, version: series.version, key: without.key, series: copy });
      return copy;
    };
    return new HeardSeries(this.live, heard);
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

  /** The alarm of a channel that stood at `cutoff`, as the ground raised it. */
  alarmAt(channel: number, cutoff: number): NamedAlarm | undefined {
    const last = this.alarmChanges.get(channel)?.findLast((change) => change.sclk <= cutoff);
    return last?.severity === 'none' ? undefined : last;
  }

  /** Seconds between the samples that are held of a channel, on average; the series that has more of them counts. */
  spacing(id: number): number {
    const spacings = [this.live.get(id), this.recorded.get(id)].flatMap((series) =>
      series && series.length > 1 ? [(series.newestSclk - (series.sclk[0] as number)) / (series.length - 1)] : [],
    );
    return spacings.length === 0 ? 0 : Math.min(...spacings);
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

  /**
   * An answer of the archive. `names`: the channels that were asked for; those without a column have no samples.
   * `liveAlone`: the answer leaves out the recording. Answers come in any order. One that was thinned together with the
   * recording holds few live samples, so it replaces none of those that an answer of live samples alone brought.
   */
  addHistory(columns: Column[], names: readonly string[] = [], liveAlone = false): void {
    ++this.version;
    for (const name of names) this.askedFor.add(name);
    ++this.samplesDrawn;
    for (const column of columns) {
      const through = column.recorded ? undefined : this.liveAloneThrough.get(column.id);
      this.series(column).replaceBefore(column.sclk, column.value, liveAlone ? undefined : through);
      const last = column.sclk.at(-1) ?? -Infinity;
      if (liveAlone) this.liveAloneThrough.set(column.id, Math.max(through ?? -Infinity, last));
      this.sawSclk(last);
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
    if (!series) {
      series = new Series(this.isDrawn(column.id) ? undefined : LIMIT_NOT_DRAWN);
      all.set(column.id, series);
    }
    return series;
  }

  private addFact(item: Fact): void {
    if (item.kind === 'event' || item.kind === 'unit') this.newestErt_s = later(item.ert_s, this.newestErt_s);
    if (item.kind === 'event' || item.kind === 'tone') this.sawSclk(item.fact.sclk);
    if (ABOUT_ALARMS.has(item.kind) || this.isAboutLoss(item)) ++this.alarmsVersion;
    if ((item.kind as string) === 'note') ++this.notesVersion;
    if (ABOUT_TIMELINE.has(item.kind)) ++this.timelineVersion;
    switch (item.kind) {
      case 'event':
        this.addTwin(this.events, item, item.ert_s, (a, b) => a.id === b.id && a.text === b.text);
        break;
      case 'explanation':
        // Its unit is the newest that came.
        this.addTwin(
          this.explanations,
          item,
          this.newestErt_s,
          (a, b) => a.text === b.text && a.decision === b.decision,
        );
        break;
      case 'tone':
        // It is decided some time after its end: what came before it in the order of numbers was known by then.
        this.tones.push({ ...item, known_s: later(item.ert_s, this.newestErt_s) });
        break;
      case 'timepoint':
        this.addFiring(item.fact);
        break;
      case 'commandStage':
        this.addStage({ ...item.fact, ert_s: item.ert_s });
        break;
      case 'link': {
        const changes = this.links.get(item.fact.link) ?? [];
        changes.push(item);
        if (changes.length > LINK_LIMIT) changes.shift();
        this.links.set(item.fact.link, changes);
        break;
      }
      case 'alarm':
        this.alarmChanges.set(item.fact.channel, [
          ...(this.alarmChanges.get(item.fact.channel) ?? []).slice(-ALARM_LIMIT),
          item.fact,
        ]);
        if (item.fact.severity === 'none') this.alarms.delete(item.fact.channel);
        else this.alarms.set(item.fact.channel, item.fact);
        break;
      case 'unit':
        this.addUnit(item);
        break;
    }
  }

  /** A lost link is an alarm: from when it is told so to when it is told anything else. */
  private isAboutLoss(item: Fact): boolean {
    return item.kind === 'link' && (item.fact.lost || this.links.get(item.fact.link)?.at(-1)?.fact.lost === true);
  }

  /** Keeps `rows` in order of SCLK. What came live and again with the recording is one row that was seen twice. */
  private addTwin<T extends { sclk: number; source: number; duplicate: boolean }>(
    rows: (Known<T> & Twin)[],
    item: Known<T>,
    ert_s: number,
    same: (a: T, b: T) => boolean,
  ): void {
    const recorded = item.fact.source === SOURCE_RECORDED;
    const heard_s = recorded ? NaN : ert_s;
    let index = rows.length;
    while (index > 0 && (rows[index - 1] as Known<T>).fact.sclk > item.fact.sclk) --index;
    for (let i = index - 1; i >= 0; --i) {
      const row = rows[i] as (typeof rows)[number];
      if (row.fact.sclk < item.fact.sclk) break;
      if (same(row.fact, item.fact) && (recorded ? !row.recorded : !row.live)) {
        if (recorded) row.recorded = true;
        else [row.live, row.heard_s] = [true, heard_s];
        return;
      }
    }
    rows.splice(index, 0, { seq: item.seq, ert_s: item.ert_s, fact: item.fact, live: !recorded, recorded, heard_s });
  }

  private addFiring(firing: TimepointFiring): void {
    const pair = this.firings.get(firing.timepoint) ?? { name: firing.name };
    if (firing.source === SOURCE_RECORDED) pair.recorded = firing;
    else if (!pair.live) [pair.live, pair.heard_s] = [firing, this.newestErt_s];
    this.firings.set(firing.timepoint, pair);
  }

  private addStage(stage: StageWord): void {
    const number = Number(stage.command);
    let row = this.commands.get(number);
    if (!row) {
      row = { command: number, name: stage.name, arguments: '', stages: new Map() };
      this.commands.set(number, row);
    }
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
    if (item.fact.source !== SOURCE_RECORDED && !item.fact.duplicate) this.judgeLate(item);
    this.units.push(item);
    if (this.units.length > UNIT_LIMIT * 2) this.units.splice(0, UNIT_LIMIT);
  }

  private judgeLate({ fact: unit, ert_s }: Known<Unit>): void {
    if (ert_s !== this.lastUnit.ert_s) this.lastUnit = { ert_s, sclk: this.sclkSeenAt(ert_s) };
    const heard = this.lastUnit.sclk;
    if (!(heard - unit.sclk > LATE_S)) return;
    let late = this.late.get(unit.name);
    if (!late) {
      late = { sclk: [], heard: [] };
      this.late.set(unit.name, late);
    }
    if (late.sclk.length === LATE_LIMIT) this.forgetLate(unit.name, late);
    late.sclk.push(unit.sclk);
    late.heard.push(heard);
  }

  private forgetLate(packet: string, late: { sclk: number[]; heard: number[] }): void {
    const half = LATE_LIMIT / 2;
    const [sclk, heard] = [late.sclk.splice(0, half), late.heard.splice(0, half)];
    const before = this.lateForgotten.get(packet);
    this.lateForgotten.set(packet, {
      units: (before?.units ?? 0) + half,
      from: Math.min(before?.from ?? Infinity, ...sclk),
      heard: Math.max(before?.heard ?? -Infinity, heard.at(-1) as number),
    });
  }

  /** Packets of which it is not told any more what was still under way at `cutoff`: samples that were may be shown as heard then. */
  notTold(cutoff: number): { packet: string; units: number }[] {
    return [...this.lateForgotten].flatMap(([packet, { units, from, heard }]) =>
      from <= cutoff && heard > cutoff ? [{ packet, units }] : [],
    );
  }
}
