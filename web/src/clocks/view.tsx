// SPDX-License-Identifier: Apache-2.0
// The header: run, clocks and connections.
import { LINK_STATUS, STATUS } from '../design/status';
import { inWords } from '../run/dictionary';
import { isWorst } from '../run/limits';
import { fromEntry, duration } from '../run/time';
import { isLost, stream } from '../run/connection';
import { cutoff, modeNow, pastRange, replay, runNow } from '../run/shown';
import { badgeOf, clocksOf, headerLinks, latestSend, streamLine } from './model';
import type { LinkLine } from './model';
import { access } from '../access/model';
import { Who } from '../access/view';
import { severitiesNow, toAcknowledge } from '../alarms/model';
import { openMenu, openedMenu } from '../menu/model';
import { focusPanel } from '../shortcuts/model';
import { Lasting } from '../situation/view';
import { sound } from '../sound/model';
import './style.css';

function Link({ line, testId }: { line: LinkLine; testId: string }) {
  return (
    <div class={`link link-radio link-${line.look}`} data-testid={testId}>
      <b>
        <span aria-hidden="true">{STATUS[LINK_STATUS[line.look]].shape}</span> {line.name}
      </b>
      <small title={line.detail}>{line.short}</small>
    </div>
  );
}

/** Connection and completeness of the data shown; never cut off. */
function Stream({ line, through }: { line: LinkLine; through: number | undefined }) {
  return (
    <div class={`link link-stream link-${line.look}`} data-testid="stream-state">
      <b>
        <span aria-hidden="true">{STATUS[LINK_STATUS[line.look]].shape}</span> {line.name}
      </b>
      <small>
        {through !== undefined && (
          <span data-testid="complete-through">
            complete through {through.toLocaleString('en').replaceAll(',', ' ')}
          </span>
        )}
        {line.detail !== '' && `${through === undefined ? '' : ', '}${line.detail}`}
      </small>
    </div>
  );
}

/**
 * The number of alarms, the worst of them, and the number unacknowledged. Red only for an alarm of the worst kind, as
 * everywhere.
 */
function AlarmCount({ severities, waiting, worst }: { severities: string[]; waiting: number; worst: boolean }) {
  if (severities.length === 0 && waiting === 0) return null;
  return (
    <div class={`link link-${worst ? 'lost' : 'alarm'}`} data-testid="alarm-count">
      <b>
        <span aria-hidden="true">{STATUS[worst ? 'alarm' : 'caution'].shape}</span>{' '}
        {severities.length === 0
          ? 'no alarm now'
          : `${severities.length} ${severities.length === 1 ? 'alarm' : 'alarms'}: ${[...new Set(severities)].join(', ')}`}
      </b>
      {waiting > 0 && (
        <small data-testid="alarms-waiting">
          <button type="button" class="quiet" onClick={() => focusPanel('alarms')}>
            {waiting} to acknowledge <kbd>a</kbd>
          </button>
        </small>
      )}
    </div>
  );
}

export function Header() {
  const run = runNow();
  const past = pastRange.value;
  const badge = badgeOf(run, past, replay.value !== undefined);
  const clocks = run && clocksOf(run, past?.to);
  const send = run?.going && !past ? latestSend(run) : undefined;
  const severities = run && !past ? severitiesNow(run) : [];
  const waiting = past ? 0 : toAcknowledge.value.length;
  return (
    <header class="header" data-testid="header">
      <h1 class="brand">AEOLIS</h1>
      <div class={`badge badge-${modeNow()}`} data-testid="badge" role="status">
        <b>{badge.title}</b> <span>{!run && access.value.state === 'out' ? 'log in first' : badge.detail}</span>
      </div>
      <Lasting />
      {run && (
        <div class="clock clock-entry">
          <small>from entry{run.run.lightTimeS > 0 ? ', as seen on Earth' : ''}</small>
          <output data-testid="clock-entry">{clocks?.entry ?? fromEntry(NaN)}</output>
        </div>
      )}
      {clocks && (
        <dl class="clocks">
          {clocks.others.map((clock) => (
            <div key={clock.id}>
              <dt>{clock.label}</dt>
              <dd>
                <output data-testid={`clock-${clock.id}`}>{clock.value}</output>
              </dd>
            </div>
          ))}
        </dl>
      )}
      {send?.next && (
        <div class={`clock ${send.next.left_s < 60 ? 'late' : ''}`} data-testid="latest-send">
          <small>latest to send before “{inWords(send.next.name)}”</small>
          <output>
            {send.next.at}
            {!isLost.value && `, in ${duration(send.next.left_s)}`}
          </output>
        </div>
      )}
      <div class="links">
        <AlarmCount
          severities={severities}
          waiting={waiting}
          worst={[...severities, ...(past ? [] : toAcknowledge.value.map((alarm) => alarm.worst))].some(isWorst)}
        />
        {run &&
          headerLinks(run, cutoff.value, stream.value.state === 'lost').map((line) => (
            <Link key={line.name} line={line} testId={`link-${line.name}`} />
          ))}
        <Stream line={streamLine(stream.value.state, stream.value.gaps)} through={run?.completeThrough} />
        <Who />
      </div>
      <button
        type="button"
        class="quiet"
        data-testid="display-menu"
        aria-label="this display: link, sound, layouts"
        aria-haspopup="menu"
        aria-expanded={openedMenu.value?.kind === 'display'}
        title="this display: link, sound, layouts"
        onClick={() => openMenu('display')}
      >
        {sound.value === 'off' ? '⋮' : '♪'}
      </button>
    </header>
  );
}
