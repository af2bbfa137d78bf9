// SPDX-License-Identifier: Apache-2.0
// Alarms: unacknowledged ones first; acknowledged, shelved for a time or reset in place, with a note.
import { mayAct } from '../access/model';
import { Signature } from '../commands/signature';
import { STATUS } from '../design/status';
import { numberText } from '../run/dictionary';
import { dictionary, pastRange, runNow, signalOfRun } from '../run/shown';
import { duration, fromEntry } from '../run/time';
import { nextSound, sound } from '../sound/model';
import {
  acknowledgeAll,
  act,
  acting,
  actionsOn,
  alarms,
  listed,
  lookOf,
  note,
  problem,
  shelveFor,
  toAcknowledge,
  wantsLook,
} from './model';
import { grouped, worstOf } from './causes';
import type { Group } from './causes';
import type { AlarmState } from './model';
import './style.css';

const packetOf = (channel: string): string | undefined => dictionary.value?.pick([channel])?.packet || undefined;

const SHELVES = ['60', '300', '900', '3600'];

const opened = signalOfRun<ReadonlySet<string>>(new Set());

function toggle(key: string): void {
  const next = new Set(opened.value);
  if (!next.delete(key)) next.add(key);
  opened.value = next;
}

/** Several alarms as one line, which opens. */
function GroupRow({ group, entry_sclk }: { group: Group; entry_sclk: number }) {
  const { key, alarms: all } = group;
  const worst = worstOf(group);
  const look = STATUS[lookOf(worst)];
  const waiting = all.filter(wantsLook).length;
  const isOpen = opened.value.has(key);
  return (
    <>
      <tr data-testid="alarm-group" data-state={waiting > 0 ? 'unacknowledged' : 'acknowledged'}>
        <td class={`status-${look.token}`}>
          <span aria-hidden="true">{look.shape}</span> {worst.severity}
        </td>
        <td colSpan={waiting > 0 && mayAct() ? 1 : 2}>
          <button type="button" class="alarm-opens" aria-expanded={isOpen} onClick={() => toggle(key)}>
            <span aria-hidden="true">{isOpen ? '▾' : '▸'}</span> {group.words}
          </button>
        </td>
        {waiting > 0 && mayAct() && (
          <td>
            <button
              type="button"
              disabled={acting.value !== undefined}
              aria-label={`acknowledge ${group.words}`}
              onClick={() => void acknowledgeAll(all)}
            >
              acknowledge {waiting}
            </button>
          </td>
        )}
        <td class="alarm-state" colSpan={4}>
          {group.cause ? group.cause.reason : waiting > 0 ? `${waiting} to acknowledge` : 'acknowledged'}
        </td>
      </tr>
      {isOpen && all.map((alarm) => <Row key={alarm.name} alarm={alarm} entry_sclk={entry_sclk} inGroup />)}
    </>
  );
}

/** What the menu of an alarm is about. */
const KINDS: Record<string, string> = { limit: 'channel', staleness: 'packet', link: 'link' };

function Row({ alarm, entry_sclk, inGroup = false }: { alarm: AlarmState; entry_sclk: number; inGroup?: boolean }) {
  const look = STATUS[lookOf(alarm)];
  const unit = dictionary.value?.pick([alarm.name])?.unit ?? '';
  return (
    <tr
      class={inGroup ? 'in-group' : ''}
      data-alarm={alarm.name}
      data-state={alarm.state}
      data-menu={`${KINDS[alarm.kind] ?? alarm.kind} ${alarm.name}`}
    >
      <td class={`status-${look.token}`}>
        <span aria-hidden="true">{look.shape}</span> {alarm.severity === 'none' ? `was ${alarm.worst}` : alarm.severity}
      </td>
      <td>
        <b>
          {alarm.name.split(/(?<=_)/).map((part) => (
            <>
              {part}
              <wbr />
            </>
          ))}
        </b>
      </td>
      <td>
        {mayAct() &&
          actionsOn(alarm).map((action) => (
            <button
              type="button"
              key={action}
              disabled={acting.value !== undefined}
              aria-label={`${action} ${alarm.name}`}
              onClick={() => void act(alarm.name, action)}
            >
              {action}
              {action === 'shelve' && ` ${duration(Number(shelveFor.value)).replace(' 00 s', '').replace('.0', '')}`}
            </button>
          ))}
      </td>
      <td class="alarm-state">
        {alarm.state}
        {alarm.shelved_until && ` until ${alarm.shelved_until}`}
        {alarm.by && `, ${alarm.by}`}
        {alarm.note && <small> {alarm.note}</small>}
      </td>
      <td class="number">
        {alarm.kind === 'staleness'
          ? 'stale'
          : alarm.kind === 'link'
            ? alarm.severity === 'none'
              ? 'over'
              : 'lost'
            : alarm.value === undefined
              ? ''
              : `${numberText(alarm.value)} ${unit}`}
      </td>
      <td class="alarm-limit">{alarm.limit || alarm.reason}</td>
      <td class="number">{alarm.sclk === undefined ? '' : fromEntry(alarm.sclk - entry_sclk)}</td>
    </tr>
  );
}

export function Alarms() {
  const run = runNow();
  if (!run) return <p class="none">no run</p>;
  if (pastRange.value) return <p class="not-past">▲ Alarms are of now, and are not shown in a view of the past.</p>;
  return (
    <div class="table-box" data-testid="alarms">
      <div class="table-tools">
        <input
          data-testid="alarm-note"
          aria-label="note with the next action"
          placeholder="note with the next action"
          maxLength={1000}
          value={note.value}
          disabled={!mayAct()}
          onInput={(event) => (note.value = event.currentTarget.value)}
        />
        <label>
          shelve for{' '}
          <select
            data-testid="shelve-for"
            value={shelveFor.value}
            onChange={(event) => (shelveFor.value = event.currentTarget.value)}
          >
            {SHELVES.map((seconds) => (
              <option key={seconds} value={seconds}>
                {duration(Number(seconds)).replace(' 00 s', '').replace(' 00 m', '')}
              </option>
            ))}
          </select>
        </label>
        <Signature />
        <button type="button" aria-pressed={sound.value !== 'off'} data-testid="alarm-sound" onClick={nextSound}>
          ♪ call-outs: {sound.value}
        </button>
        {mayAct() && toAcknowledge.value.length > 1 && (
          <button
            type="button"
            data-testid="acknowledge-all"
            disabled={acting.value !== undefined}
            onClick={() => void acknowledgeAll()}
          >
            acknowledge all {toAcknowledge.value.length} shown
          </button>
        )}
        <span role="status" data-testid="alarm-sentence">
          {alarms.value?.run !== run.id
            ? '? asking…'
            : listed.value.length === 0
              ? '● no alarm'
              : toAcknowledge.value.length === 0
                ? '✓ all acknowledged'
                : `▲ ${toAcknowledge.value.length} to acknowledge`}
        </span>
      </div>
      {problem.value && (
        <p role="alert" class="status-alarm" data-testid="alarm-problem">
          ✖ {problem.value}
        </p>
      )}
      <div class="table-scroll" tabIndex={0} role="region" aria-label="alarms, those that no one has looked at first">
        {listed.value.length > 0 && (
          <table class="alarm-table" data-testid="alarm-table">
            <thead>
              <tr>
                <th>severity</th>
                <th>alarm</th>
                <th>do</th>
                <th>state</th>
                <th class="number">value</th>
                <th>limit</th>
                <th class="number">since</th>
              </tr>
            </thead>
            <tbody>
              {grouped(listed.value, packetOf, run.entrySclk).map((group) =>
                group.words === undefined ? (
                  <Row key={group.key} alarm={group.alarms[0] as AlarmState} entry_sclk={run.entrySclk} />
                ) : (
                  <GroupRow key={group.key} group={group} entry_sclk={run.entrySclk} />
                ),
              )}
            </tbody>
          </table>
        )}
      </div>
    </div>
  );
}
