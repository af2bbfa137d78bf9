// SPDX-License-Identifier: Apache-2.0
// The page: the whole console or, at ?panel=NAME, one panel of it for another monitor.
import type { FunctionComponent } from 'preact';
import { access } from './access/model';
import { reportState } from './anomaly/opened';
import { callsShown } from './calls/opened';
import { Channels } from './channels/view';
import { Header } from './clocks/view';
import { step } from './commands/line';
import { Commands } from './commands/view';
import { Descent } from './descent/view';
import { Events } from './events/view';
import { guideNow } from './guide/model';
import { Guide } from './guide/view';
import { PastBar, Tape } from './mode/view';
import { Panel } from './design/panel';
import { openedLater } from './design/opened_later';
import { Phases } from './phases/view';
import { Plots } from './plots/view';
import { PaceBar } from './rehearsal/pace';
import { ReplayBar } from './replay/view';
import { stream } from './run/connection';
import { dismissNotice, modeNow, notices, runNow } from './run/shown';
import type { Tab } from './places/model';
import { TABS, full, low, middle, showAt, tab } from './places/model';
import { helpShown, ignoreHeldEnter } from './shortcuts/model';
import { Menu } from './menu/shown';
import { Situation } from './situation/view';
import { Timeline } from './timeline/view';
import { Tones } from './tones/view';
import { WaitingFor } from './waiting/view';

const Help = openedLater(async () => (await import('./shortcuts/view')).Help);
const LogIn = openedLater(async () => (await import('./access/log_in')).LogIn);
const AnomalyReport = openedLater(async () => (await import('./anomaly/view')).AnomalyReport);
const ExpiredBar = openedLater(async () => (await import('./access/log_in')).ExpiredBar);

/** The tabs of the data panel. */
const DATA = {
  channels: Channels,
  alarms: openedLater(async () => (await import('./alarms/view')).Alarms),
  procedures: openedLater(async () => (await import('./procedures/view')).Procedures),
  notes: openedLater(async () => (await import('./notes/view')).Notes),
  users: openedLater(async () => (await import('./users/view')).Users),
  packets: openedLater(async () => (await import('./packets/view')).Packets),
  verdicts: openedLater(async () => (await import('./verdicts/view')).Verdicts),
  links: openedLater(async () => (await import('./links/view')).Links),
  flown: openedLater(async () => (await import('./flown/view')).Flown),
  recorded: openedLater(async () => (await import('./recorded/view')).Recorded),
  rehearsal: openedLater(async () => (await import('./rehearsal/view')).Rehearsal),
  campaigns: openedLater(async () => (await import('./campaigns/view')).Campaigns),
  what_if: openedLater(async () => (await import('./rehearsal/what_if')).WhatIf),
  vehicle: openedLater(async () => (await import('./vehicle/view')).Vehicle),
};

const Calls = openedLater(async () => (await import('./calls/view')).Calls);
const Debrief = openedLater(async () => (await import('./debrief/view')).Debrief);

function Data() {
  const Shown = DATA[tab.value];
  return (
    <Panel
      name="data"
      title={
        <span role="tablist" class="tabs">
          {TABS.filter(
            (each) =>
              each.id !== 'users' ||
              each.id === tab.value ||
              (access.value.state === 'in' && access.value.role === 'administrator'),
          ).map((each) => (
            <button
              type="button"
              role="tab"
              key={each.id}
              aria-selected={tab.value === each.id}
              data-testid={`tab-${each.id}`}
              onClick={() => showAt('data', each.id)}
            >
              {each.title} <kbd>{each.key}</kbd>
            </button>
          ))}
        </span>
      }
      extra={
        <button type="button" class="quiet" aria-label="keys" onClick={() => (helpShown.value = !helpShown.value)}>
          <span class="keys-word">keys </span>
          <kbd>?</kbd>
        </button>
      }
    >
      <Shown />
    </Panel>
  );
}

function Notices() {
  if (notices.value.length === 0) return null;
  return (
    <ul class="notices" role="status" data-testid="notices">
      {notices.value.map((notice) => (
        <li key={notice.id}>
          ▲ {notice.text}{' '}
          <button type="button" class="quiet" aria-label="dismiss" onClick={() => dismissNotice(notice.id)}>
            ×
          </button>
        </li>
      ))}
    </ul>
  );
}

const inPanel = (name: keyof typeof DATA, title: string) => {
  const Shown = DATA[name];
  return () => (
    <Panel name={name} title={title}>
      <Shown />
    </Panel>
  );
};

/** The panels and tabs by their names: what ?panel=NAME shows alone, and the places of the grid. */
const ALONE = {
  timeline: Timeline,
  tones: Tones,
  plots: Plots,
  descent: Descent,
  events: Events,
  commands: Commands,
  data: Data,
  waiting: WaitingFor,
  debrief: () => (
    <Panel name="debrief" title="Debrief">
      <Debrief />
    </Panel>
  ),
  phases: () => null, // the strip at the top of every page shows the phases already
  ...(Object.fromEntries(TABS.map(({ id, title }) => [id, inPanel(id, title)])) as unknown as Record<
    Tab,
    FunctionComponent
  >),
};

/** The places on the left, or the one panel that has all their room. */
function Pictures() {
  if (full.value !== undefined) {
    const Whole = ALONE[full.value as keyof typeof ALONE];
    return Whole ? <Whole /> : null;
  }
  const [Middle, Low] = [ALONE[middle.value], ALONE[low.value]];
  return (
    <>
      <Timeline />
      <div class="middle">
        <Middle key={middle.value} />
        <Plots />
      </div>
      <div class="bottom">
        <Low key={low.value} />
        <Data />
      </div>
    </>
  );
}

/** By itself, since the page around it stays as it is. */
function Keys() {
  return helpShown.value ? <Help /> : null;
}

export function App({ panel }: { panel?: string | undefined }) {
  const mode = modeNow();
  const run = runNow();
  const Alone = panel === undefined ? undefined : ALONE[panel as keyof typeof ALONE];
  return (
    <div
      class={`console mode-${mode} wants-${guideNow()?.wants ?? 'nothing'} ${stream.value.state === 'lost' ? 'is-lost' : ''} ${Alone ? 'alone' : ''} ${step.value === 'type' ? '' : 'reviewing'}`}
      data-testid="console"
      data-mode={mode}
      onKeyDownCapture={ignoreHeldEnter}
    >
      <Tape />
      <Header />
      <Situation />
      <section class="strip" aria-label="phase and pace">
        <Phases />
        <PaceBar />
      </section>
      <div class="bars">
        {run && ['out', 'choose'].includes(access.value.state) && <ExpiredBar />}
        <PastBar />
        <ReplayBar />
        <Notices />
        {callsShown() && <Calls />}
      </div>
      {['out', 'choose'].includes(access.value.state) && !run ? (
        <LogIn />
      ) : Alone ? (
        <main class="one">
          <Alone />
        </main>
      ) : (
        <main class={`grid ${full.value === undefined ? '' : 'has-full'}`}>
          <div class="left">
            <Pictures />
          </div>
          <div class="right">
            {full.value !== 'waiting' && <WaitingFor />}
            <Guide />
            {full.value !== 'events' && <Events />}
            {full.value !== 'commands' && <Commands />}
          </div>
        </main>
      )}
      <Keys />
      {reportState.value !== 'closed' && <AnomalyReport />}
      <Menu />
    </div>
  );
}
