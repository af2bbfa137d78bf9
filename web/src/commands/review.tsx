// SPDX-License-Identifier: Apache-2.0
// The review of a command before it is sent: a form from the dictionary, the server's dry run, and the arming in place.
import { useEffect, useLayoutEffect, useRef } from 'preact/hooks';
import type { CommandReply, DictionaryCommand } from '../gen/aeolis/v1/run_pb';
import { STATUS } from '../design/status';
import { inWords } from '../run/dictionary';
import { CASES, flyOut, flyingOut } from '../rehearsal/fly_out';
import { modeNow, runNow, store } from '../run/shown';
import { duration, fromEntry } from '../run/time';
import { moved } from '../timeline/now';
import {
  confirmation,
  fields,
  formText,
  intent,
  intentKey,
  openCommandLine,
  otherwise,
  previewNow,
  problemNow,
  purposeNow,
  step,
  tryOut,
  typed,
  uplink,
} from './line';
import { arrivalOf, conditionWords, isHazardous, rangeText, reasonWords, textOf, unitText } from './model';
import type { UplinkText } from './model';
import { argumentsInWords, rowName, rowsNow } from './names';

const TYPED_MS = 150; // chosen: delay after the last key
const AGAIN_MS = 1000; // chosen: the rate of the vehicle's status reports

interface Properties {
  command: DictionaryCommand;
  onKey: (event: KeyboardEvent) => void;
}

function Fields({ onKey }: Pick<Properties, 'onKey'>) {
  const filled = fields.value.filter((field) => field.from === 'solution').length;
  if (fields.value.length === 0) return null;
  return (
    <>
      {filled > 0 && (
        <p>
          {filled} of {fields.value.length} filled from ground’s navigation solution; type to change one.
        </p>
      )}
      <div class="fields">
        {fields.value.map((field) => (
          <label key={field.argument.name} class={field.problem !== undefined ? 'bad' : ''} title={field.argument.text}>
            <span>{field.argument.name}</span>
            <input
              value={field.text}
              placeholder={field.value === undefined ? 'needed' : String(field.value)}
              aria-invalid={field.problem !== undefined}
              disabled={typed.value.given.has(field.argument.name) || step.value !== 'review'}
              onKeyDown={onKey}
              onInput={(event) =>
                (formText.value = new Map([...formText.value, [field.argument.name, event.currentTarget.value]]))
              }
            />
            <small>
              {unitText(field.argument)}{' '}
              {field.problem ?? rowName(field.argument, field.value) ?? rangeText(field.argument)}
            </small>
          </label>
        ))}
      </div>
    </>
  );
}

function Uplink({ onKey }: Pick<Properties, 'onKey'>) {
  const now = uplink.value;
  const fixed = step.value !== 'review';
  const set = (change: Partial<UplinkText>) => (uplink.value = { ...uplink.value, ...change });
  return (
    <div class="uplink" role="group" aria-label="how it leaves">
      <label>
        leaves{' '}
        <input
          data-testid="release-at"
          placeholder="at once"
          title="ERT as 2012-219T05:00:00, or E-15:00 by the clock on top"
          spellcheck={false}
          value={now.releaseAt}
          disabled={fixed}
          onKeyDown={onKey}
          onInput={(event) => set({ releaseAt: event.currentTarget.value })}
        />
      </label>
      <label>
        priority{' '}
        <input
          class="narrow"
          data-testid="priority"
          inputMode="numeric"
          placeholder="0"
          title="of those that are due the largest leaves first"
          value={now.priority}
          disabled={fixed}
          onKeyDown={onKey}
          onInput={(event) => set({ priority: event.currentTarget.value })}
        />
      </label>
      <label>
        service{' '}
        <select
          data-testid="service"
          value={now.service}
          disabled={fixed}
          onKeyDown={onKey}
          title="AD: repeated until the vehicle reports its frame. BD: sent once, taken by a vehicle that is not heard."
          onChange={(event) => set({ service: event.currentTarget.value as UplinkText['service'] })}
        >
          <option value="">what suits</option>
          <option value="AD">AD</option>
          <option value="BD">BD</option>
        </select>
      </label>
      <label>
        by{' '}
        <input
          class="name"
          data-testid="controller"
          placeholder="your name"
          maxLength={64}
          title="who asks; needed where a second person must approve"
          spellcheck={false}
          value={now.controller}
          disabled={fixed}
          onKeyDown={onKey}
          onInput={(event) => set({ controller: event.currentTarget.value })}
        />
      </label>
      <label>
        <input
          type="checkbox"
          data-testid="hold"
          checked={now.hold}
          disabled={fixed}
          onKeyDown={onKey}
          onChange={(event) => set({ hold: event.currentTarget.checked })}
        />{' '}
        hold
      </label>
    </div>
  );
}

const CONDITION = { holds: 'holds', fails: 'failed', unknown: 'unknown' } as const;

function Checks({ reply }: { reply: CommandReply }) {
  if (reply.preconditions.length === 0) return null;
  return (
    <ul class="preconditions" aria-label="preconditions">
      {reply.preconditions.map((condition) => {
        const look = CONDITION[condition.state as keyof typeof CONDITION] ?? CONDITION.unknown;
        const { words, value } = conditionWords(condition.text);
        return (
          <li key={words} class={look} title={condition.text}>
            {STATUS[look].shape} {words}{' '}
            <output>
              {value}
              {look === 'unknown' && '; flight decides'}
            </output>
          </li>
        );
      })}
    </ul>
  );
}

/** When it leaves and arrives, and what it is. */
function Told({ reply }: { reply: CommandReply }) {
  const run = runNow();
  if (!run) return null;
  const arrival = reply.arrivesUs !== undefined ? arrivalOf(reply, run) : undefined;
  const octets = reply.octets.length / 2;
  return (
    <>
      {arrival && (
        <dl class="told">
          <dt>at the latest</dt>
          <dd data-testid="send-by">
            {arrival.before && arrival.before.slack_s > 0 ? (
              <>
                leave by <output>{arrival.before.leave_ert}</output> ERT to be there before{' '}
                {inWords(arrival.before.name)}: <output>{duration(arrival.before.slack_s)}</output> to spare
              </>
            ) : arrival.before ? (
              <>
                too late: to be there before {inWords(arrival.before.name)} it had to leave by{' '}
                <output>{arrival.before.leave_ert}</output> ERT
              </>
            ) : (
              'nothing comes after it whose time is planned or predicted'
            )}
          </dd>
          <dt>leaves</dt>
          <dd>
            {uplink.value.hold ? (
              'held until you release it'
            ) : uplink.value.releaseAt ? (
              <>
                <output>{textOf(reply.leavesUs)}</output> ERT
              </>
            ) : (
              'at once'
            )}
            , by{' '}
            {reply.service === 'AD' ? 'AD: repeated until the vehicle reports its frame' : 'BD: once, unacknowledged'}
            {reply.station && (
              <>
                ,{' '}
                <span data-testid="station">
                  from {reply.station}, whose pass ends <output>{textOf(reply.stationUntilUs)}</output> ERT
                </span>
              </>
            )}
          </dd>
          <dt>at Mars</dt>
          <dd data-testid="arrives">
            <output>{textOf(reply.arrivesUs)}</output> SCET, <output>{fromEntry(arrival.arrives_e_s)}</output>
            {uplink.value.hold && ' or later'}
          </dd>
          <dt>effect seen</dt>
          <dd data-testid="effect-seen">
            from <output>{textOf(reply.effectSeenUs)}</output> ERT, <output>{duration(2 * run.run.lightTimeS)}</output>{' '}
            after it leaves
          </dd>
          {reply.timeline && (
            <>
              <dt>timeline</dt>
              <dd data-testid="analysed">✓ {reply.timeline}</dd>
            </>
          )}
          {reply.arguments && (
            <>
              <dt>as encoded</dt>
              <dd class="encoded" tabIndex={0}>
                {argumentsInWords(reply.arguments, rowsNow())}
              </dd>
            </>
          )}
          {reply.accepted && run.going && modeNow() === 'rehearsal' && step.value !== 'armed' && (
            <>
              <dt>what if</dt>
              <dd>
                <button
                  type="button"
                  class="quiet"
                  data-testid="fly-out"
                  disabled={uplink.value.hold || flyingOut.value}
                  title={
                    uplink.value.hold
                      ? 'nobody knows when it leaves: it is held'
                      : `${CASES} landings with it and ${CASES} without, from what ground heard until now`
                  }
                  onClick={() => {
                    const wanted = intent.value;
                    if (wanted && !('problem' in wanted)) void flyOut(run.id, wanted);
                  }}
                >
                  fly it out, with it and without
                </button>
              </dd>
            </>
          )}
          <dt>{octets} octets</dt>
          <dd class="encoded" tabIndex={0}>
            {reply.octets.replace(/../g, '$& ')}
          </dd>
        </dl>
      )}
    </>
  );
}

/** The ground's verdict on the form, and the timepoints it would miss; shown first, before and during arming. */
function Verdict({ command }: { command: DictionaryCommand }) {
  const run = runNow();
  const reply = previewNow.value;
  const problem = problemNow.value;
  const tooLateFor =
    run && reply?.arrivesUs !== undefined && problem === undefined ? arrivalOf(reply, run).tooLateFor : [];
  return (
    <>
      {problem !== undefined ? (
        <p class="verdict unknown">
          {STATUS.missing.shape} {problem}
        </p>
      ) : !reply ? (
        <p class="verdict unknown">? the ground has not answered the dry run yet</p>
      ) : reply.accepted && reply.needsApproval ? (
        <p class="verdict holds">✓ It would wait for the approval of a second controller; its own checks hold.</p>
      ) : reply.accepted ? (
        <p class="verdict holds">
          ✓{' '}
          {step.value === 'armed'
            ? 'Its checks hold.'
            : isHazardous(command)
              ? 'It would be sent once it is armed and its name is typed.'
              : 'It would be sent as it stands here.'}
        </p>
      ) : (
        <p class="verdict missing">✖ It would be refused: {reasonWords(reply.reason)}</p>
      )}
      {tooLateFor.length > 0 && (
        <p class="verdict caution" data-testid="too-late">
          ▲ Too late for {tooLateFor.slice(0, 3).map(inWords).join(', ')}
          {tooLateFor.length > 3 && ` and ${tooLateFor.length - 3} more`}.
        </p>
      )}
    </>
  );
}

/** Repeats the dry run while the form is shown, because conditions change. */
function DryRun({ command, onKey }: Properties) {
  const key = intentKey.value;
  useEffect(() => {
    const soon = setTimeout(() => void tryOut(), TYPED_MS);
    const again = setInterval(() => void tryOut(), AGAIN_MS);
    return () => {
      clearTimeout(soon);
      clearInterval(again);
    };
  }, [key, store.value?.id]);
  const reply = previewNow.value;
  return (
    <div class="dry-run" data-testid="dry-run">
      {step.value !== 'armed' && (
        <div aria-live="polite">
          <Verdict command={command} />
        </div>
      )}
      {step.value === 'review' && (
        <p class="next">
          {reply?.accepted !== false && (
            <>
              <kbd>Enter</kbd>{' '}
              {isHazardous(command)
                ? 'arms it; nothing is sent yet'
                : uplink.value.hold
                  ? 'puts it into the queue, held'
                  : reply?.needsApproval
                    ? 'asks a second controller for it'
                    : 'sends it'}{' '}
              ·{' '}
            </>
          )}
          <kbd>Tab</kbd> to change · <kbd>Esc</kbd> goes back
        </p>
      )}
      {step.value !== 'armed' && <Effect onKey={onKey} />}
      {reply && <Checks reply={reply} />}
      {step.value !== 'armed' && reply && <Told reply={reply} />}
    </div>
  );
}

const MOVED_SHOWN = 12;

/** The timepoints that the command would move: one line that opens. The lane of predictions draws the same. */
function Effect({ onKey }: Pick<Properties, 'onKey'>) {
  const all = moved.value;
  if (!all) return null;
  const most = all.reduce((largest, each) => Math.max(largest, Math.abs(each.to_e_s - each.from_e_s)), 0);
  if (all.length === 0)
    return (
      <p class="effect" data-testid="effect">
        ◌ As predicted now, it moves no timepoint.
      </p>
    );
  const [what, atMost] = [
    `◌ It would move ${all.length} ${all.length === 1 ? 'timepoint' : 'timepoints'}`,
    `, by at most ${duration(most)}`,
  ];
  return (
    <details class="effect" data-testid="effect">
      {/* biome-ignore lint/a11y/noStaticElementInteractions: a summary is interactive by itself */}
      <summary title={what + atMost} onKeyDown={(event) => event.key === 'Escape' && onKey(event)}>
        <b>{what}</b>
        {atMost}
      </summary>
      <ul>
        {all.slice(0, MOVED_SHOWN).map((each) => (
          <li key={each.id}>
            {inWords(each.name)}{' '}
            <output>
              {fromEntry(each.from_e_s, { tenths: true })} → {fromEntry(each.to_e_s, { tenths: true })},{' '}
              {each.to_e_s > each.from_e_s ? '+' : '−'}
              {duration(Math.abs(each.to_e_s - each.from_e_s))}
            </output>
          </li>
        ))}
        {all.length > MOVED_SHOWN && <li>and {all.length - MOVED_SHOWN} more, dashed on the timeline</li>}
      </ul>
    </details>
  );
}

/** The step of a procedure for which it is sent. */
function For() {
  const asked = purposeNow.value;
  if (!asked) return null;
  return (
    <p data-testid="command-purpose">
      For {asked.words}.
      {otherwise.value.length > 0 && (
        <span class="caution"> ▲ Not as the procedure has it: {otherwise.value.join(', ')}.</span>
      )}
    </p>
  );
}

export function Review({ command, onKey }: Properties) {
  return (
    <div class={`review ${step.value === 'armed' ? 'review-armed' : ''}`} data-testid="command-review">
      <p>
        <b>{command.name}</b> {command.text}
      </p>
      {step.value !== 'armed' && <For />}
      {step.value !== 'armed' && command.reasonForWarning && <p class="caution">▲ {command.reasonForWarning}</p>}
      <DryRun command={command} onKey={onKey} />
      {step.value !== 'armed' && (
        <>
          <Fields onKey={onKey} />
          <Uplink onKey={onKey} />
        </>
      )}
    </div>
  );
}

export function Armed({ command, onKey }: { command: DictionaryCommand; onKey: (event: KeyboardEvent) => void }) {
  const input = useRef<HTMLInputElement>(null);
  useLayoutEffect(() => {
    // Before the next key can be typed. From the top: its checks are in sight, and the field below them.
    input.current?.focus({ preventScroll: true });
    input.current?.closest('.panel-body')?.scrollTo?.(0, 0);
    input.current?.scrollIntoView?.({ block: 'nearest' });
  }, []);
  const reply = previewNow.value;
  return (
    <>
      <div class="armed" data-testid="command-armed">
        <b>▲ ARMED: {command.name}</b>
        {command.reasonForWarning && <p class="caution">▲ {command.reasonForWarning}</p>}
        {otherwise.value.length > 0 && <For />}
        <Verdict command={command} />
        <label>
          <span>
            {' '}
            Nothing is sent yet: type <b>{command.name}</b> and press Enter. Esc disarms.
          </span>
          <input
            ref={input}
            data-testid="command-confirmation"
            autocomplete="off"
            spellcheck={false}
            value={confirmation.value}
            onInput={(event) => (confirmation.value = event.currentTarget.value)}
            onKeyDown={(event) => {
              const escaped = event.key === 'Escape';
              onKey(event);
              if (escaped) openCommandLine();
            }}
          />
        </label>
      </div>
      {reply && (
        <div class="review">
          <Told reply={reply} />
        </div>
      )}
    </>
  );
}
