// The header: which run, what time it is, what is connected.
import { LINK_STATUS, STATUS } from '../design/status';
import { fromEntry, duration } from '../run/time';
import { cutoff, modeNow, pastRange, replay, runNow, stream, timepoints } from '../run/session';
import { badgeOf, clocksOf, headerLinks, latestSend, streamLine } from './model';
import type { LinkLine } from './model';
import { access } from '../access/model';
import { Who } from '../access/view';
import { toAcknowledge } from '../alarms/model';
import { focusPanel } from '../shortcuts/model';
import './style.css';

function Link({ line, testId }: { line: LinkLine; testId: string }) {
  return (
    <div class={`link link-${line.look}`} data-testid={testId}>
      <b><span aria-hidden="true">{STATUS[LINK_STATUS[line.look]].shape}</span> {line.name}</b>
      <small>{line.detail}</small>
    </div>
  );
}

export function Header() {
  const run = runNow();
  const past = pastRange.value;
  const badge = badgeOf(run, past, replay.value !== undefined);
  const clocks = run && clocksOf(run, past?.to);
  const send = run?.going && !past ? latestSend(run, timepoints.value) : undefined;
  const severities = run && !past ? [...run.alarms.values()] : [];
  const waiting = past ? 0 : toAcknowledge.value.length;
  return (
    <header class="header" data-testid="header">
      <h1 class="brand">AEOLIS</h1>
      <div class={`badge badge-${modeNow()}`} data-testid="badge" role="status">
        <b>{badge.title}</b> <span>{!run && access.value.state === 'out' ? 'log in first' : badge.detail}</span>
      </div>
      {run && (
        <div class="clock clock-entry">
          <small>from entry{run.run.lightTimeS > 0 ? ', as seen on Earth' : ''}</small>
          <output data-testid="clock-entry">{clocks?.entry ?? fromEntry(NaN)}</output>
        </div>
      )}
      {clocks && (
        <dl class="clocks">
          {clocks.others.map((clock) => (
            <div key={clock.id}><dt>{clock.label}</dt><dd><output data-testid={`clock-${clock.id}`}>{clock.value}</output></dd></div>
          ))}
        </dl>
      )}
      {send && (
        <div class={`clock ${send.left_s < 60 ? 'late' : ''}`} title={`before ${send.first}`}>
          <small>send at the latest</small>
          <output data-testid="latest-send">
            {send.left_s < 0 ? `▲ too late since ${send.at}` : `${send.at}, in ${duration(send.left_s)}`}
          </output>
        </div>
      )}
      <div class="links">
        {waiting > 0 && (
          <div class="link link-lost" data-testid="alarms-waiting">
            <b><span aria-hidden="true">■</span> {waiting} to acknowledge</b>
            <small><button type="button" class="quiet" onClick={() => focusPanel('alarms')}>alarms <kbd>a</kbd></button></small>
          </div>
        )}
        {severities.length > 0 && (
          <div class="link link-alarm" data-testid="alarm-count">
            <b><span aria-hidden="true">▲</span> {severities.length} {severities.length === 1 ? 'alarm' : 'alarms'}</b>
            <small>{[...new Set(severities.map((alarm) => alarm.severity))].join(', ')}</small>
          </div>
        )}
        {run && headerLinks(run, cutoff.value).map((line) => (
          <Link key={line.name} line={line} testId={`link-${line.name}`} />
        ))}
        <Link line={streamLine(stream.value.state, stream.value.attempt, stream.value.gaps)} testId="stream-state" />
        <Who />
        {run && (
          <div class="link" data-testid="complete-through">
            <b>complete</b>
            <small>through {run.completeThrough.toLocaleString('en').replaceAll(',', ' ')}</small>
          </div>
        )}
      </div>
    </header>
  );
}
