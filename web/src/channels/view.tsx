// SPDX-License-Identifier: Apache-2.0
import { computed, signal } from '@preact/signals';
import { useLayoutEffect, useRef } from 'preact/hooks';
import { SOURCES, STATUS } from '../design/status';
import type { DictionaryChannel } from '../gen/aeolis/v1/run_pb';
import { isLost } from '../run/connection';
import { cutoff, dictionary, shownRun } from '../run/shown';
import { watchSight, whenDue } from './due';
import { channelRow, channelsShown } from './model';
import './style.css';

const filter = signal('');
const shown = computed(() =>
  dictionary.value ? channelsShown(dictionary.value, filter.value) : { channels: [], total: 0 },
);

function Row({ channel, place }: { channel: DictionaryChannel; place: number }) {
  whenDue(place);
  const row = channelRow(shownRun(), channel, cutoff.value, isLost.value);
  return (
    <tr class={`look-${row.look}`} data-testid={`channel-${row.name}`} data-menu={`channel ${row.name}`}>
      <td title={STATUS[row.look].word}>
        <span class="shape" role="img" aria-label={STATUS[row.look].word}>
          {STATUS[row.look].shape}
        </span>
      </td>
      <td title={[`${row.name}: ${row.text}`, row.allLimits].filter(Boolean).join('\n')}>
        <span class="alias">{row.alias}</span> {row.name}
        {row.whose && <span class="alias">, {row.whose}</span>}
      </td>
      <td class="number value" title={row.value}>
        {row.value}
      </td>
      <td>{row.unit}</td>
      <td class="number" title={row.timed}>
        {row.look === 'stale' && <span class="age-word">stale, </span>}
        {row.age}
        {row.recorded ? ` ${SOURCES.recording.shape}` : ''}
      </td>
      <td class="limits" title={row.allLimits}>
        {row.limits}
      </td>
    </tr>
  );
}

export function Channels() {
  const box = useRef<HTMLDivElement>(null);
  const rows = useRef<HTMLTableSectionElement>(null);
  const known = dictionary.value !== undefined;
  useLayoutEffect(() => (box.current && rows.current ? watchSight(box.current, rows.current) : undefined), [known]);
  if (!dictionary.value) return null;
  const { channels, total } = shown.value;
  return (
    <div class="table-box">
      <div class="table-tools">
        <input
          type="search"
          placeholder="filter channels"
          aria-label="filter channels"
          value={filter.value}
          data-testid="channel-filter"
          onInput={(event) => (filter.value = event.currentTarget.value)}
        />
        <span>
          {channels.length} of {dictionary.value.channels.length} shown
          {total > channels.length ? `, ${total} match` : ''}
        </span>
      </div>
      <div class="table-scroll channels-scroll" ref={box} tabIndex={0} role="group" aria-label="channels">
        <table class="channels" data-testid="channel-table">
          <thead>
            <tr>
              <th>state</th>
              <th>channel</th>
              <th class="number">value</th>
              <th>unit</th>
              <th class="number">age</th>
              <th>limits</th>
            </tr>
          </thead>
          <tbody ref={rows}>
            {channels.map((channel, place) => (
              <Row key={channel.id} channel={channel} place={place} />
            ))}
          </tbody>
        </table>
      </div>
    </div>
  );
}
