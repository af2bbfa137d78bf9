// SPDX-License-Identifier: Apache-2.0
// All data that the page holds of one run, filled by the stream and read by every panel. Each run has its own store, so
// that no data of one run appear in another.
import type { JsonValue } from '@bufbuild/protobuf';
import type { Clocks, Explanation, Staleness, Packet } from '../gen/aeolis/v1/items_pb';
import type { Board } from '../positions/model';
import { SOURCE_RECORDED } from '../stream/columns';
import type { BatchOfFacts, Column, Fact, Newest } from '../stream/messages';
import type {
  NamedAlarm,
  NamedEvent,
  NamedFiring,
  NamedLink,
  NamedRun,
  NamedSituation,
  NamedStage,
  NamedTone,
} from '../stream/names';
import { LIMIT_NOT_DRAWN, Series } from './series';
import { isGoing } from './start';
import { secondsOfErt } from './time';

const EVENT_LIMIT = 20000;
const PACKET_LIMIT = 400;
const LINK_LIMIT = 5000;
const ALARM_LIMIT = 1000; // per channel
const STALENESS_LIMIT = 1000; // per packet
const SITUATION_LIMIT = 5000; // chosen: a landing has a hundred or two
// chosen: a packet heard this much later than light time was kept by an orbiter or by a queue on board
const LATE_S = 2;
export const LATE_LIMIT = 1 << 14; // per packet; older ones are forgotten, and notTold reports that
const ABOUT_ALARMS: ReadonlySet<string> = new Set(['alarm', 'staleness', 'alarmAction']);
const ABOUT_TIMELINE: ReadonlySet<string> = new Set(['timepoint', 'tone', 'commandStage']);

/** A fact with the time of its arrival, `ert_s`, seconds since 1970. */
export interface Known<T> {
  seq: number;
  ert_s: number;
  fact: T;
}
/** `known_s`: when it was known on Earth, seconds since 1970. */
interface ToneRow extends Known<NamedTone> {
  known_s: number;
}
/** A fact that the recording repeats. `heard_s`: time of live reception, seconds since 1970; NaN: not received live. */
interface Twin {
  live: boolean;
  recorded: boolean;
  heard_s: number;
}
interface EventRow extends Known<NamedEvent>, Twin {}
interface ExplanationRow extends Known<Explanation>, Twin {}
interface FiringPair {
  name: string;
  live?: NamedFiring;
  recorded?: NamedFiring;
  heard_s?: number; // as in Twin
}
export type StageWord = NamedStage & { ert_s: number };
export interface CommandRow {
  command: number;
  name: string;
  arguments: string;
  /** Reports on each stage, oldest first. The last one counts, in a past view the last one then known. */
  stages: Map<string, StageWord[]>;
}
/** Totals of one packet over one link. */
export interface PacketTotals {
  link: string;
  apid: number;
  name: string;
  packets: number;
  octets: number;
  duplicates: number;
}
export interface Sample {
  sclk: number;
  value: number;
  recorded: boolean;
  /** The exact value where a number does not hold it. */
  text?: string | undefined;
  /** Of the newest sample of a followed mission: when it was received, seconds since 1970. */
  ert_s?: number;
  /** Its packet holds no time: `sclk` is when it was received. */
  byReception?: boolean;
}

const TEXT_LIMIT = 1 << 11; // exact values held of a channel
const RHYTHM_FADES = 0.9; // chosen: an interval counts for some ten samples after it

/** The newest sample of a channel by reception, and the longest interval lately between such samples. */
interface NewestKnown extends Newest {
  interval_s: number;
}

/** The later of two times; `b` may be NaN. */
const later = (a: number, b: number): number => (Number.isNaN(b) ? a : Math.max(a, b));

/** Channels as they were heard, each computed when it is requested. */
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
  /** Of live samples, by channel. */
  private readonly newest = new Map<number, NewestKnown>();
  /** By channel that needs text: the exact values of samples, in the order of reception. */
  private readonly texts = new Map<number, { sclk: number; text: string | undefined }[]>();
  events: EventRow[] = [];
  explanations: ExplanationRow[] = [];
  tones: ToneRow[] = [];
  firings = new Map<number, FiringPair>();
  commands = new Map<number, CommandRow>();
  links = new Map<string, Known<NamedLink>[]>();
  /** Alarms in force, by channel. */
  alarms = new Map<number, NamedAlarm>();
  private readonly alarmChanges = new Map<number, NamedAlarm[]>();
  /** By packet: when the ground found that its live values are no longer of now, and that they are again. */
  private readonly staleness = new Map<string, Known<Staleness>[]>();
  /** What mattered, each from its item to the next. */
  situations: Known<NamedSituation>[] = [];
  packets: Known<Packet>[] = [];
  /** Totals by link and packet. */
  packetTotals = new Map<string, PacketTotals>();
  clocks: Clocks | undefined;
  completeThrough = 0;
  /** Channels whose history has arrived. Other channels without samples may not have been requested yet. */
  askedFor = new Set<string>();
  thinnedSinceHistory = false;
  /** Counts news of alarms; with the two below, tells other modules to ask again. */
  alarmsVersion = 0;
  notesVersion = 0;
  proceduresVersion = 0;
  /** The newest status of each procedure that the stream brought, by its number. */
  procedures = new Map<number, { seq: number; status: JsonValue }>();
  /** How the room stood behind the newest act on a position that the stream brought, of that number. */
  positions: { seq: number; board: Board } | undefined;
  /** Counts items on which the prediction of the timeline depends: firings, tones, stages of commands. */
  timelineVersion = 0;
  /** Newest SCLK of all samples, events and tones. */
  private newestSclk = -Infinity;
  private newestErt_s = NaN;
  private heard: { version: number; cutoff: number; run: RunStore } | undefined;
  /**
   * Late live packets by name: the SCLK of each, and the SCLK of the signal that was heard at its arrival, which
   * increases.
   */
  private readonly late = new Map<string, { sclk: number[]; heard: number[] }>();
  /** By packet: the number of late ones forgotten, the first SCLK concerned, and when the last of them was heard. */
  private readonly lateForgotten = new Map<string, { packets: number; from: number; heard: number }>();
  /** By channel: SCLK of the last sample from an answer of live samples alone. */
  private readonly liveAloneThrough = new Map<number, number>();
  private readonly heardSeries = new Map<number, { of: Series; version: number; key: string; series: Series }>();
  private lastPacket = { ert_s: NaN, sclk: NaN };
  /** Counts arrivals of samples of plotted channels. */
  samplesDrawn = 0;
  /** Counts all changes. */
  version = 0;

  constructor(
    public run: NamedRun,
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
  /** False for a followed mission of others, whose time of entry is not known. */
  get entryKnown(): boolean {
    return this.run.entrySclk !== 0;
  }
  /**
   * Vehicle time of the signal that reaches Earth now. Of a followed mission it is not known: the latest of the times
   * that the channels have now, which goes back with their clock.
   */
  get seenSclk(): number {
    if (!this.entryKnown && this.newest.size > 0) return this.newestOfAll;
    return this.clocks?.seenSclk || this.clocks?.sclk || Math.max(this.run.startSclk, this.newestSclk);
  }
  /** The time on Earth now, as far as this run knows it, seconds since 1970. */
  get ertNow_s(): number {
    const newest = this.newestErt_s;
    const { ertUs } = this.clocks ?? {};
    return ertUs !== undefined && this.going ? later(secondsOfErt(ertUs), newest) : newest;
  }
  get seenE(): number {
    return this.seenSclk - this.entrySclk;
  }
  /**
   * SCLK of the signal received at `ert_s`, seconds since 1970. Both advance alike, apart from the drift of the clock
   * on board.
   */
  sclkSeenAt(ert_s: number): number {
    const at = this.instant;
    return at.sclk + (ert_s - at.ert_s) / (this.run.clock?.rate || 1);
  }
  /** Earth time at which a signal sent at `sclk` can be received, seconds since 1970; NaN while unknown. */
  ertOf(sclk: number): number {
    const at = this.instant;
    return at.ert_s + (sclk - at.sclk) * (this.run.clock?.rate || 1);
  }
  /**
   * One instant on both clocks. A run that is over has no clocks any more. Then what was heard gives it: the first
   * tone, whose SCLK is that of its beginning by light time, or the first live event, which was under way slightly
   * longer.
   * Where neither is loaded, clock correlation and light time do, of a run whose entry is known: of a followed mission
   * the light time is not.
   */
  private get instant(): { sclk: number; ert_s: number } {
    const { ertUs } = this.clocks ?? {};
    if (ertUs !== undefined) return { sclk: this.seenSclk, ert_s: secondsOfErt(ertUs) };
    const tone = this.tones[0]?.fact;
    if (tone) return { sclk: tone.sclk, ert_s: secondsOfErt(tone.ertStartUs) };
    const event = this.events.find((row) => row.live);
    if (event) return { sclk: event.fact.sclk, ert_s: event.ert_s };
    const { clock, lightTimeS } = this.run;
    if (clock && this.entryKnown) return { sclk: clock.sclk, ert_s: secondsOfErt(clock.scetUs) + lightTimeS };
    return { sclk: NaN, ert_s: NaN };
  }

  /** Whether an item dated `ert_s` was known on Earth when the vehicle was heard at `cutoff`. */
  knownBy(ert_s: number, cutoff: number): boolean {
    return cutoff === Infinity || !(this.sclkSeenAt(ert_s) > cutoff);
  }
  /** Tones decided by then. */
  tonesBy(cutoff: number): readonly ToneRow[] {
    return cutoff === Infinity
      ? this.tones
      : this.tones.filter(({ fact, known_s }) => fact.sclk <= cutoff && this.knownBy(known_s, cutoff));
  }
  /**
   * The same run as heard by the instant at which the vehicle was heard at `cutoff`: without data of the recording, and
   * without data that an orbiter or a queue on board delivered later. Read-only.
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

  /**
   * The live series without samples of packets that were under way at `cutoff`. Copies are made on request and renewed
   * when the set changes.
   */
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

  update(run: NamedRun): void {
    this.run = run;
    if (run.clocks) this.clocks = run.clocks;
    ++this.version;
  }

  /**
   * The newest sample of a channel at or before `cutoff`, from either source. Now and of a followed mission it is the one
   * received last: its clocks may restart, stand still, or be missing.
   */
  latest(id: number, cutoff = Infinity): Sample | undefined {
    const newest = cutoff === Infinity && !this.entryKnown ? this.newest.get(id) : undefined;
    if (newest) return { ...newest, recorded: false };
    const live = this.live.get(id)?.at(cutoff);
    const recorded = this.recorded.get(id)?.at(cutoff);
    if (recorded && (!live || recorded.sclk >= live.sclk)) return { ...recorded, recorded: true };
    return live && { ...live, recorded: false, text: this.textAt(id, live.sclk) };
  }

  private textAt(id: number, sclk: number): string | undefined {
    return this.texts.get(id)?.findLast((each) => each.sclk === sclk)?.text;
  }

  /** The longest interval lately between two receptions of a channel, in seconds; 0: not known. */
  rhythm(id: number): number {
    return this.newest.get(id)?.interval_s ?? 0;
  }

  /** The alarm of a channel in force at `cutoff`, as the ground raised it. */
  alarmAt(channel: number, cutoff: number): NamedAlarm | undefined {
    const last = this.alarmChanges.get(channel)?.findLast((change) => change.sclk <= cutoff);
    return last?.severity === 'none' ? undefined : last;
  }

  /** The ground's last word by `cutoff` on whether a packet still comes. */
  stalenessAt(packet: string, cutoff: number): Known<Staleness> | undefined {
    return this.staleness.get(packet)?.findLast(({ ert_s }) => this.knownBy(ert_s, cutoff));
  }

  /** Whether the ground had found by `cutoff` that the live values of a packet are no longer of now. */
  isStale(packet: string, cutoff: number): boolean {
    return this.stalenessAt(packet, cutoff)?.fact.stale ?? false;
  }

  /** Mean interval in seconds between the held samples of a channel, in the denser of its two series. */
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
      this.noteTexts(column, (known) => known);
      if (column.newest) this.noteNewest(column.id, column.newest, column.sclk.length);
    }
    for (const fact of batch.facts) this.addFact(fact);
    if (this.events.length > EVENT_LIMIT) this.events.splice(0, this.events.length - EVENT_LIMIT);
  }

  /**
   * Adds an answer of the archive. `names`: the requested channels; those without a column have no samples.
   * `liveAlone`: the answer leaves out the recording. Answers arrive in any order. An answer thinned together with the
   * recording holds few live samples, so it replaces none from an answer of live samples alone.
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
      this.noteTexts(column, (known) => known.filter((each) => each.sclk > last));
      if (column.newest) this.noteNewest(column.id, column.newest, 0);
    }
  }

  /** `keep`: of the texts that are known, those that stay behind the column's. */
  private noteTexts(column: Column, keep: (known: { sclk: number; text: string | undefined }[]) => typeof known): void {
    const { id, sclk, texts } = column;
    if (!texts) return;
    const added = texts.map((text, i) => ({ sclk: sclk[i] as number, text }));
    const known = this.texts.get(id) ?? [];
    const kept = keep(known);
    this.texts.set(id, (kept === known ? [...known, ...added] : [...added, ...kept]).slice(-TEXT_LIMIT));
  }

  /** `samples`: received since the newest that was known; 0: not known. */
  private noteNewest(id: number, newest: Newest, samples: number): void {
    const before = this.newest.get(id);
    if (before && newest.ert_s < before.ert_s) return;
    const interval_s = before && samples > 0 ? (newest.ert_s - before.ert_s) / samples : 0;
    this.newest.set(id, { ...newest, interval_s: Math.max(interval_s, RHYTHM_FADES * (before?.interval_s ?? 0)) });
    this.newestErt_s = later(newest.ert_s, this.newestErt_s);
    this.newestOfAllAt = -1;
  }

  private newestOfAllAt = -1;
  private newestOfAllWas = -Infinity;
  private get newestOfAll(): number {
    if (this.newestOfAllAt !== this.version) {
      this.newestOfAllAt = this.version;
      this.newestOfAllWas = Math.max(...[...this.newest.values()].map(({ sclk }) => sclk));
    }
    return this.newestOfAllWas;
  }

  /** Adds a requested range, which is exact where the held samples were thinned. */
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
    } else if (this.isDrawn(column.id)) series.widen();
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
        // Its packet is the newest one received.
        this.addTwin(
          this.explanations,
          item,
          this.newestErt_s,
          (a, b) => a.text === b.text && a.decision === b.decision,
        );
        break;
      case 'tone':
        // It is decided some time after its end; items with lower numbers were known by then.
        this.tones.push({ ...item, known_s: later(item.ert_s, this.newestErt_s) });
        break;
      case 'procedure':
        this.procedures.set(item.fact.number, { seq: item.seq, status: item.fact.status });
        ++this.proceduresVersion;
        break;
      case 'positionAct':
        this.positions = { seq: item.seq, board: item.fact.board };
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
      case 'staleness':
        this.staleness.set(item.fact.packet, [
          ...(this.staleness.get(item.fact.packet) ?? []).slice(-STALENESS_LIMIT),
          item,
        ]);
        break;
      case 'alarm':
        this.alarmChanges.set(item.fact.channel, [
          ...(this.alarmChanges.get(item.fact.channel) ?? []).slice(-ALARM_LIMIT),
          item.fact,
        ]);
        if (item.fact.severity === 'none') this.alarms.delete(item.fact.channel);
        else this.alarms.set(item.fact.channel, item.fact);
        break;
      case 'unit':
        this.addPacket(item);
        break;
      case 'situation':
        this.situations.push(item);
        if (this.situations.length > SITUATION_LIMIT) this.situations.shift();
        break;
    }
  }

  /** A lost link is an alarm, from the change that reports it to the next change. */
  private isAboutLoss(item: Fact): boolean {
    return item.kind === 'link' && (item.fact.lost || this.links.get(item.fact.link)?.at(-1)?.fact.lost === true);
  }

  /** Keeps `rows` in order of SCLK. A fact received live and again with the recording is one row. */
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

  private addFiring(firing: NamedFiring): void {
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

  private addPacket(item: Known<Packet>): void {
    const { link, apid, name } = item.fact;
    const key = `${link} ${apid} ${name}`;
    const totals = this.packetTotals.get(key) ?? { link, apid, name, packets: 0, octets: 0, duplicates: 0 };
    ++totals.packets;
    totals.octets += item.fact.octets;
    if (item.fact.duplicate) ++totals.duplicates;
    this.packetTotals.set(key, totals);
    if (item.fact.source !== SOURCE_RECORDED && !item.fact.duplicate) this.judgeLate(item);
    this.packets.push(item);
    if (this.packets.length > PACKET_LIMIT * 2) this.packets.splice(0, PACKET_LIMIT);
  }

  private judgeLate({ fact: unit, ert_s }: Known<Packet>): void {
    if (ert_s !== this.lastPacket.ert_s) this.lastPacket = { ert_s, sclk: this.sclkSeenAt(ert_s) };
    const heard = this.lastPacket.sclk;
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
      packets: (before?.packets ?? 0) + half,
      from: Math.min(before?.from ?? Infinity, ...sclk),
      heard: Math.max(before?.heard ?? -Infinity, heard.at(-1) as number),
    });
  }

  /**
   * Packets for which it is no longer known which samples were under way at `cutoff`; these samples may be shown as
   * heard.
   */
  notTold(cutoff: number): { packet: string; packets: number }[] {
    return [...this.lateForgotten].flatMap(([packet, { packets, from, heard }]) =>
      from <= cutoff && heard > cutoff ? [{ packet, packets }] : [],
    );
  }
}
