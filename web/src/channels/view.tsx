import { signal } from '@preact/signals';
import { STATUS } from '../design/status';
import { cutoff, dictionary, store, tick } from '../run/session';
import { channelRows } from './model';
import './style.css';

const filter = signal('');

export function Channels() {
  void tick.value;
  const words = dictionary.value;
  if (!words) return null;
  const { rows, total } = channelRows(store.value, words, filter.value, cutoff.value);
  return (
    <div class="table-box">
      <div class="table-tools">
        <input type="search" placeholder="filter channels" aria-label="filter channels" value={filter.value}
          data-testid="channel-filter" onInput={(event) => (filter.value = event.currentTarget.value)} />
        <span>{rows.length} of {words.channels.length} shown{total > rows.length ? `, ${total} match` : ''}</span>
      </div>
      <div class="table-scroll" tabIndex={0} aria-label="channels">
        <table class="channels" data-testid="channel-table">
          <thead><tr><th>state</th><th>channel</th><th class="number">value</th><th>unit</th><th class="number">age</th><th>limits</th></tr></thead>
          <tbody>
            {rows.map((row) => (
              <tr key={row.id} class={`look-${row.look}`} title={row.text} data-testid={`channel-${row.name}`}>
                <td title={STATUS[row.look].word}><span class="shape" aria-label={STATUS[row.look].word}>{STATUS[row.look].shape}</span></td>
                <td><span class="alias">{row.alias}</span> {row.name}</td>
                <td class="number value">{row.value}</td>
                <td>{row.unit}</td>
                <td class="number">{row.look === 'stale' ? `stale, ${row.age}` : row.age}{row.recorded ? ' ▣' : ''}</td>
                <td class="limits">{row.limits}</td>
              </tr>
            ))}
          </tbody>
        </table>
      </div>
    </div>
  );
}
