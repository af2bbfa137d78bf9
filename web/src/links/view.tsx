// SPDX-License-Identifier: Apache-2.0
// The links side by side: which are up, which are silent and why, and the traffic and losses of each.
import { Carrier } from '../carrier/view';
import { LINK_STATUS, STATUS } from '../design/status';
import type { LinkCounters } from '../gen/aeolis/v1/run_pb';
import { proofOfRun } from '../proof/report';
import { stream } from '../run/connection';
import { cutoff, pastRange, runNow } from '../run/shown';
import { duration, fromEntry } from '../run/time';
import { framesKept, linkTitle, linkViews, sequenceRows } from './model';
import type { LinkView } from './model';
import './style.css';

const count = (value: bigint | number) => Number(value).toLocaleString('en').replaceAll(',', ' ');

/** What a link without counted frames carries. */
const NO_FRAMES: Record<string, string> = {
  x_band: 'carries tones, not frames: see the strip of tones',
};

const hurt = (value: bigint) => (value > 0n ? 'number status-caution' : 'number');

function Row({ view }: { view: LinkView }) {
  const look = STATUS[LINK_STATUS[view.state]];
  const { counters, judged } = view;
  const kept = counters && framesKept(counters);
  return (
    <tr data-testid={`link-row-${view.link}`} data-state={view.state} data-menu={`link ${view.link}`}>
      <td>
        <b>
          <span class={`status-${look.token}`} aria-hidden="true">
            {look.shape}
          </span>{' '}
          {linkTitle(view.link)}
        </b>
      </td>
      <td class={`status-${look.token}`}>
        {view.state === 'unknown' ? 'not known' : view.state}
        {view.reason && `, ${view.reason}`}
        {view.since_e_s !== undefined && Number.isFinite(view.since_e_s) && (
          <small> since {fromEntry(view.since_e_s)}</small>
        )}
      </td>
      {counters ? (
        <>
          <td class="kept">
            {kept !== undefined && (
              <>
                <span class="kept-bar">
                  <i style={{ width: `${kept * 100}%` }} />
                </span>{' '}
                {(kept * 100).toFixed(1)} %
              </>
            )}
          </td>
          <td class="number">{count(counters.frames)}</td>
          <td class={hurt(counters.missingFrames)}>{count(counters.missingFrames)}</td>
          <td class="number">{count(counters.gaps)}</td>
          <td class={hurt(counters.badCrc)}>{count(counters.badCrc)}</td>
          <td class={hurt(counters.badHeader)}>{count(counters.badHeader)}</td>
          <td class={hurt(counters.uncorrectableFrames)}>
            {count(counters.uncorrectableFrames)}
            {counters.correctedFrames > 0n && <small> {count(counters.correctedFrames)} corrected</small>}
          </td>
          <td class="number">{count(counters.repeatedFrames)}</td>
          <td class="number">{count(counters.lateFrames)}</td>
          <td class={hurt(counters.restarts)}>{count(counters.restarts)}</td>
          <td class="number">{count(counters.octets)}</td>
          <td class={hurt(counters.skippedOctets)}>{count(counters.skippedOctets)}</td>
          <td class="number">{((counters.octetsPerS * 8) / 1000).toFixed(1)} kb/s</td>
        </>
      ) : (
        <td colSpan={13} class="status-dim">
          {NO_FRAMES[view.link] ?? 'no frames counted'}
        </td>
      )}
      <td class="number">
        {judged ? count(judged.live > 0 ? judged.live : judged.recorded) : count(view.packets)}
        {view.seenBefore > 0 && <small> {count(view.seenBefore)} again</small>}
      </td>
      <td class="number">{judged && judged.live > 0 ? count(judged.identical) : ''}</td>
    </tr>
  );
}

/** What of a link's packets did not come whole, in words; empty: nothing. */
function packetFaults(counters: LinkCounters): string {
  return (
    [
      [counters.cutPackets, 'packets cut off'],
      [counters.lostSegments, 'segments without the rest'],
      [counters.encapsulationPackets, 'encapsulation packets not decoded'],
      [counters.unreadableOctets, 'octets unreadable'],
      [counters.badDatagrams, 'bad datagrams'],
      [counters.otherDataFrames, 'frames whose data are not packets'],
      [counters.correctedHeaders, 'headers corrected'],
      [counters.slips, 'slips of bits'],
      [counters.forgottenChannels, 'virtual channels forgotten'],
    ] as const
  )
    .filter(([number]) => number > 0n)
    .map(([number, what]) => `${count(number)} ${what}`)
    .join(', ');
}

/** The virtual channels and packet ids of each link, those first whose counts are not in order. */
function Sequences({ views }: { views: LinkView[] }) {
  const faults = views.flatMap(({ link, counters }) => {
    const words = counters ? packetFaults(counters) : '';
    return words ? [{ link, words }] : [];
  });
  const rows = sequenceRows(views);
  if (rows.length === 0 && faults.length === 0) return null;
  return (
    <section class="sequences" data-testid="sequences">
      {faults.map(({ link, words }) => (
        <p key={link} class="status-caution">
          {linkTitle(link)}: {words}
        </p>
      ))}
      <table class="link-table">
        <thead>
          <tr>
            <th>link</th>
            <th>sequence</th>
            {['received', 'missing', 'gaps', 'repeated', 'late', 'restarts', 'wraps'].map((each) => (
              <th key={each} class="number">
                {each}
              </th>
            ))}
          </tr>
        </thead>
        <tbody>
          {rows.slice(0, SEQUENCES_SHOWN).map(({ link, counted }) => (
            <tr key={`${link} ${counted.packets} ${counted.name}`}>
              <td>{linkTitle(link)}</td>
              <td>
                {counted.name}, {counted.packets ? 'packets' : 'frames'}
              </td>
              <td class="number">{count(counted.received)}</td>
              <td class={hurt(counted.missing)}>{count(counted.missing)}</td>
              <td class="number">{count(counted.gaps)}</td>
              <td class="number">{count(counted.repeated)}</td>
              <td class="number">{count(counted.late)}</td>
              <td class={hurt(counted.restarts)}>{count(counted.restarts)}</td>
              <td class="number">{count(counted.wraps)}</td>
            </tr>
          ))}
        </tbody>
      </table>
      {rows.length > SEQUENCES_SHOWN && <p>{rows.length - SEQUENCES_SHOWN} more</p>}
    </section>
  );
}

const SEQUENCES_SHOWN = 200;

function Silences({ views }: { views: LinkView[] }) {
  const all = views
    .flatMap((view) => view.silences.map((silence) => ({ ...silence, link: view.link })))
    .sort((a, b) => b.from - a.from)
    .slice(0, 40);
  return (
    <section class="silences">
      <h3>Silences, newest first</h3>
      <ol data-testid="silences">
        {all.map((silence) => (
          <li key={`${silence.link} ${silence.from}`}>
            <time>
              {fromEntry(silence.from)} … {fromEntry(silence.to)}
            </time>{' '}
            <b>{linkTitle(silence.link)}</b> {silence.words} <small>{duration(silence.to - silence.from)}</small>
          </li>
        ))}
        {all.length === 0 && <li>none</li>}
      </ol>
    </section>
  );
}

export function Links() {
  const run = runNow();
  const proof = proofOfRun.use();
  if (!run) return <p class="none">no run</p>;
  const views = linkViews(run, proof, cutoff.value, stream.value.state === 'lost');
  return (
    <div class="table-box" data-testid="links">
      {pastRange.value && (
        <p class="not-past">
          ▲ Counters are of the whole run; states and silences are those of the past that is shown.
        </p>
      )}
      <div class="table-scroll" tabIndex={0} role="group" aria-label="links">
        {views.length === 0 ? (
          <p class="none">no link has been heard of yet</p>
        ) : (
          <table class="link-table" data-testid="link-table">
            <thead>
              <tr>
                <th>link</th>
                <th>state</th>
                <th>frames that came</th>
                <th class="number">frames</th>
                <th class="number">missing</th>
                <th class="number">gaps</th>
                <th class="number">bad CRC</th>
                <th class="number">bad header</th>
                <th class="number">uncorrectable</th>
                <th class="number">repeated</th>
                <th class="number">late</th>
                <th class="number">restarts</th>
                <th class="number">octets</th>
                <th class="number">skipped</th>
                <th class="number">rate</th>
                <th class="number">packets</th>
                <th class="number">identical</th>
              </tr>
            </thead>
            <tbody>
              {views.map((view) => (
                <Row key={view.link} view={view} />
              ))}
            </tbody>
          </table>
        )}
        <Carrier />
        <Sequences views={views} />
        <Silences views={views} />
      </div>
    </div>
  );
}
