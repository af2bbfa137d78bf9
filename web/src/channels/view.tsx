// SPDX-License-Identifier: Apache-2.0
import { computed, signal } from '@preact/signals';
import { useLayoutEffect, useRef } from 'preact/hooks';
import { SOURCES, STATUS } from '../design/status';
import type { DictionaryChannel } from '../gen/aeolis/v1/run_pb';
import { isLost } from '../run/connection';
import { cutoff, dictionary, shownRun } from '../run/shown';
import { BLOCK, watchSight, whenDue } from './due';
import { channelRow, channelsShown } from './model';
import './style.css';

const filter = signal('');
const shown = computed(() =>
  dictionary.value ? channelsShown(dictionary.value, filter.value) : { channels: [], total: 0 },
);

// A cell that is clipped is painted by itself, so only those are whose text may be too long for the narrowest column.
const NAME_FITS = 18;
const VALUE_FITS = 15;
const clipped = (isLong: boolean) => (isLong ? 'clipped' : '');

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
      <td
        class={clipped(row.name.length > NAME_FITS || row.whose !== undefined)}
        title={[`${row.name}: ${row.text}`, row.allLimits].filter(Boolean).join('\n')}
      >
        <span class="alias">{row.alias}</span> {row.name}
        {row.whose && <span class="alias">, {row.whose}</span>}
      </td>
      <td class={`number value ${clipped(row.value.length > VALUE_FITS)}`} title={row.value}>
        {row.value}
      </td>
      <td>{row.unit}</td>
      <td class="number" title={row.timed}>
        {row.look === 'stale' && <span class="age-word">stale, </span>}
        {row.age}
        {row.recorded ? ` ${SOURCES.recording.shape}` : ''}
      </td>
      <td class={`limits ${clipped(row.limits !== '')}`} title={row.allLimits}>
        {row.limits}
      </td>
    </tr>
  );
}

export function Channels() {
  const box = useRef<HTMLDivElement>(null);
  const rows = useRef<HTMLTableElement>(null);
  const known = dictionary.value !== undefined;
  useLayoutEffect(() => (box.current && rows.current ? watchSight(box.current, rows.current) : undefined), [known]);
  if (!dictionary.value) return null;
  const { channels, total } = shown.value;
  const blocks = Array.from({ length: Math.ceil(channels.length / BLOCK) }, (_, i) => i * BLOCK);
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
        <table class="channels" data-testid="channel-table" ref={rows}>
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
          {blocks.map((first) => (
            <tbody key={first}>
              {channels.slice(first, first + BLOCK).map((channel, i) => (
                <Row key={channel.id} channel={channel} place={first + i} />
              ))}
            </tbody>
          ))}
        </table>
      </div>
    </div>
  );
}
