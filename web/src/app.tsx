// The whole console, or one panel of it at ?panel=NAME for further monitors.
import { Channels } from './channels/view';
import { Header } from './clocks/view';
import { Commands } from './commands/view';
import { Descent } from './descent/view';
import { Events } from './events/view';
import { Packets } from './packets/view';
import { Panel } from './panel';
import { Phases } from './phases/view';
import { Plots } from './plots/view';
import { Recorded, backToLive } from './recorded/view';
import { PaceBar, Rehearsal } from './rehearsal/view';
import { dismissNotice, modeNow, notices, pastRange, store, stream } from './run/session';
import { fromEntry } from './run/time';
import { TABS, helpShown, tab } from './shortcuts/model';
import { Help } from './shortcuts/view';
import { Timeline } from './timeline/view';
import { Tones } from './tones/view';
import { WaitingFor } from './waiting/view';

const DATA = { channels: Channels, packets: Packets, recorded: Recorded, rehearsal: Rehearsal };

function Data() {
  const Shown = DATA[tab.value];
  return (
    <Panel name="data" title={
      <span role="tablist" class="tabs">
        {TABS.map((each) => (
          <button type="button" role="tab" key={each.id} aria-selected={tab.value === each.id} data-testid={`tab-${each.id}`}
            onClick={() => (tab.value = each.id)}>{each.title} <kbd>{each.key}</kbd></button>
        ))}
      </span>
    } extra={<button type="button" class="quiet" onClick={() => (helpShown.value = !helpShown.value)}>keys <kbd>?</kbd></button>}>
      <Shown />
    </Panel>
  );
}

function PastBar() {
  const past = pastRange.value;
  if (!past) return null;
  return (
    <div class="past-bar" role="alert" data-testid="past-bar">
      THE PAST: {fromEntry(past.from)} to {fromEntry(past.to)}. Nothing here is live{store.value?.going ? '; the run goes on' : ''}.
      <button type="button" onClick={backToLive}>leave <kbd>Esc</kbd></button>
    </div>
  );
}

function Notices() {
  if (notices.value.length === 0) return null;
  return (
    <ul class="notices" role="status" data-testid="notices">
      {notices.value.map((notice) => (
        <li key={notice.id}>▲ {notice.text} <button type="button" class="quiet" aria-label="dismiss" onClick={() => dismissNotice(notice.id)}>×</button></li>
      ))}
    </ul>
  );
}

const ALONE = {
  timeline: Timeline, tones: Tones, plots: Plots, descent: Descent, events: Events, commands: Commands, data: Data, waiting: WaitingFor,
};

export function App({ panel }: { panel?: string | undefined }) {
  const mode = modeNow();
  const Alone = panel === undefined ? undefined : ALONE[panel as keyof typeof ALONE];
  return (
    <div class={`console mode-${mode} ${stream.value.state === 'lost' ? 'is-lost' : ''} ${Alone ? 'alone' : ''}`} data-testid="console" data-mode={mode}>
      <Header />
      <div class="strip"><Phases /><PaceBar /></div>
      <PastBar />
      <Notices />
      {Alone ? <main class="one"><Alone /></main> : (
        <main class="grid">
          <div class="left">
            <Timeline />
            <div class="middle"><Descent /><Plots /></div>
            <div class="bottom"><Tones /><Data /></div>
          </div>
          <div class="right"><WaitingFor /><Events /><Commands /></div>
        </main>
      )}
      <Help />
    </div>
  );
}
