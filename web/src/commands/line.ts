// SPDX-License-Identifier: Apache-2.0
// The state of the command line, and its three keys: Enter goes one step on, Esc one step back, arrows choose.
import { computed, signal } from '@preact/signals';
import { learnAccess } from '../access/model';
import type { CommandReply } from '../gen/aeolis/v1/run_pb';
import { OutcomeUnknown, sendCommand, whyNotSent } from '../run/connection';
import { dictionary, pastRange, store, tick } from '../run/shown';
import type { CommandIntent, QueueAction } from '../stream/messages';
import { AT_ONCE, argumentOffers, candidates, fieldsOf, intentOf, isHazardous, readLine, unknownNames } from './model';
import type { Step, UplinkText } from './model';

export const step = signal<Step>('type');
export const line = signal('');
export const confirmation = signal('');
export const choiceIndex = signal(0);
export const message = signal<{ good: boolean | undefined; text: string } | undefined>(undefined);
const chosenName = signal<string | undefined>(undefined);
/** What is typed into the form; the line's own name=value come first. */
export const formText = signal<ReadonlyMap<string, string>>(new Map());
export const uplink = signal<UplinkText>(AT_ONCE);

export const typed = computed(() => readLine(line.value));
/** Set once the line names a command and goes on with its arguments. */
export const inArguments = computed(() =>
  dictionary.value ? argumentOffers(dictionary.value, line.value) : undefined,
);
export const offered = computed(() => {
  if (inArguments.value) return [inArguments.value.command];
  return dictionary.value ? candidates(dictionary.value, typed.value.words) : [];
});
export const chosen = computed(() =>
  chosenName.value === undefined ? undefined : dictionary.value?.command(chosenName.value),
);
export const fields = computed(() => {
  void tick.value;
  return chosen.value
    ? fieldsOf(chosen.value, new Map([...formText.value, ...typed.value.given]), store.value?.run.solution ?? [])
    : [];
});

/** What would be sent, or why nothing can be. */
const intent = computed<CommandIntent | { problem: string } | undefined>(() => {
  const command = chosen.value;
  if (!command) return undefined;
  const stray = inArguments.value?.strays[0];
  if (stray !== undefined) return { problem: `${stray} is no argument with a value: write name=value` };
  const unknown = unknownNames(command, typed.value.given)[0];
  if (unknown !== undefined) return { problem: `${command.name} has no argument ${unknown}` };
  return intentOf(command, fields.value, uplink.value, store.value);
});
export const problemNow = computed(() =>
  intent.value && 'problem' in intent.value ? intent.value.problem : undefined,
);
/** Changes when what would be sent does, or where to. */
export const intentKey = computed(() => JSON.stringify([store.value?.id, pastRange.value !== undefined, intent.value]));

/** The server's answer to a dry run of what is shown: nothing is sent by it. */
const preview = signal<{ of: string; reply: CommandReply } | undefined>(undefined);
export const previewNow = computed(() => (preview.value?.of === intentKey.value ? preview.value.reply : undefined));

let asked: { of: string; answer: Promise<CommandReply | undefined> } | undefined;

/** Asks what would happen if it were armed, confirmed and sent now; of the same once at a time, so that no questions stand before the command itself. Without connection, or with a problem of ours, nothing is asked. */
export async function tryOut(): Promise<CommandReply | undefined> {
  const [wanted, of, command] = [intent.value, intentKey.value, chosen.value];
  if (!wanted || 'problem' in wanted || !command) return undefined;
  if (asked?.of === of) return asked.answer;
  const one = {
    of,
    answer: sendCommand({ ...wanted, dryRun: true, armed: isHazardous(command), confirmation: command.name }).catch(
      () => undefined,
    ),
  };
  asked = one;
  const reply = await one.answer;
  if (asked === one) asked = undefined;
  if (of === intentKey.value) preview.value = reply && { of, reply }; // without one the header says that there is no connection; an old answer must not stand
  return reply;
}

export function openCommandLine(text?: string): void {
  if (text !== undefined) {
    line.value = text;
    back(true);
  }
  const input = document.querySelector<HTMLInputElement>('[data-testid="command-line"]');
  input?.focus();
  input?.select();
}

export function type(text: string): void {
  line.value = text;
  choiceIndex.value = 0;
  if (step.value !== 'sending') {
    step.value = 'type';
    chosenName.value = undefined;
    message.value = undefined;
  }
}

export function choose(name: string): void {
  chosenName.value = name;
  confirmation.value = '';
  formText.value = new Map();
  uplink.value = { ...AT_ONCE, controller: uplink.value.controller };
  preview.value = undefined; // one of before says nothing of now
  step.value = 'review';
  message.value = undefined;
}

/** Puts what is offered into the line; false when that changes nothing. */
export function complete(): boolean {
  const [before, within] = [line.value, inArguments.value];
  if (within) {
    const offer = within.offers[choiceIndex.value] ?? within.offers[0];
    if (offer !== undefined) line.value = line.value.replace(/\S*$/, within.stem + offer);
    choiceIndex.value = 0;
    return line.value !== before;
  }
  const command = offered.value[choiceIndex.value];
  if (command)
    line.value =
      [command.name.toLowerCase(), ...[...typed.value.given].map(([name, value]) => `${name}=${value}`)].join(' ') +
      (command.arguments.length > 0 ? ' ' : '');
  choiceIndex.value = 0;
  return line.value !== before;
}

/** One step on. Returns nothing; what happened stands in `step` and `message`. */
export async function forward(): Promise<void> {
  const command = chosen.value;
  if (step.value === 'type') {
    const offer = inArguments.value?.command ?? offered.value[choiceIndex.value];
    if (line.value.trim() === '') message.value = { good: undefined, text: 'type a command, for example its words' };
    else if (!offer) message.value = { good: false, text: 'no command of the dictionary has these words' };
    else choose(offer.name);
    return;
  }
  if (!command || step.value === 'sending') return;
  const wanted = intent.value;
  if (!wanted || 'problem' in wanted) {
    message.value = { good: false, text: wanted?.problem ?? 'nothing is chosen' };
    return;
  }
  if (step.value === 'review' && isHazardous(command)) return arm();
  if (!previewNow.value) {
    message.value = { good: false, text: notReviewed() };
    return;
  }
  if (step.value === 'armed' && confirmation.value.trim().toUpperCase() !== command.name) {
    message.value = { good: false, text: `type ${command.name} to confirm; nothing was sent` };
    return;
  }
  const wasArmed = step.value === 'armed';
  const sent = line.value;
  const done = () => {
    if (line.value === sent) line.value = ''; // what was typed meanwhile is the next
  };
  step.value = 'sending';
  message.value = { good: undefined, text: `${command.name}: sending` };
  try {
    const reply = await sendCommand({ ...wanted, armed: wasArmed, confirmation: wasArmed ? command.name : '' });
    message.value = reply.accepted
      ? {
          good: !reply.reason,
          text: `${command.name} is #${reply.command}, ${reply.octets.length / 2} octets${uplink.value.hold ? ', held' : uplink.value.releaseAt ? ', waits for its time' : ''}${reply.reason && `; ${reply.reason}`}`,
        }
      : { good: false, text: `${command.name} refused: ${reply.reason}; nothing was sent` };
    if (reply.accepted) done();
    else void learnAccess().catch(() => undefined); // rights may have been taken away in the middle
  } catch (error) {
    message.value = { good: false, text: `${command.name}: ${error instanceof Error ? error.message : String(error)}` };
    if (error instanceof OutcomeUnknown) done(); // the next Enter must not be a second one
  }
  step.value = 'type';
  chosenName.value = undefined;
  confirmation.value = '';
  if (document.activeElement === document.body || document.activeElement?.closest('[data-testid="panel-commands"]'))
    openCommandLine(); // who went on elsewhere is left there
}

/** What leaves has been shown as it leaves: only on the ground's answer to exactly this is Enter a yes. */
const notReviewed = () =>
  whyNotSent() ??
  'the ground has not answered yet what would become of it: nothing was sent; read it, then press Enter';

/** Not while it is known that it would be refused, nor while nothing is known: an armed command is one that can be sent. */
async function arm(): Promise<void> {
  const of = intentKey.value;
  const reply = await tryOut();
  if (step.value !== 'review' || intentKey.value !== of) return;
  if (!reply) {
    message.value = { good: false, text: `not armed: ${notReviewed()}` };
    return;
  }
  if (!reply.accepted) {
    message.value = { good: false, text: `not armed: ${reply.reason}` };
    return;
  }
  step.value = 'armed';
  message.value = undefined;
}

/** On a command that waits. */
export async function act(number: number, action: QueueAction): Promise<void> {
  const done = { release: 'released', hold: 'held', cancel: 'cancelled', approve: 'approved' }[action];
  try {
    const reply = await sendCommand({ action, number: BigInt(number), controller: uplink.value.controller });
    message.value = reply.accepted
      ? { good: !reply.reason, text: `#${number} ${done}${reply.reason && `; ${reply.reason}`}` }
      : { good: false, text: reply.reason };
  } catch (error) {
    const said = error instanceof Error ? error.message : String(error);
    message.value = {
      good: false,
      text: error instanceof OutcomeUnknown ? `#${number}, ${action}: ${said}` : `#${number} was not ${done}: ${said}`,
    };
  }
}

export function back(all = false): void {
  if (step.value === 'sending') return;
  message.value = undefined;
  confirmation.value = '';
  if (step.value === 'armed' && !all) step.value = 'review';
  else if (step.value !== 'type') {
    step.value = 'type';
    chosenName.value = undefined;
  } else if (!all) {
    line.value = '';
    (document.activeElement as HTMLElement | null)?.blur();
  }
}

/** What the ground said was of one run as it stood then: when another or the past is looked at nothing stays armed, and for another run nothing reviewed. */
export function disarm(another: boolean): void {
  const armed = step.value === 'armed' ? chosen.value?.name : undefined;
  preview.value = undefined;
  if (step.value === 'armed' || (step.value === 'review' && another)) back(another);
  else if (another) message.value = undefined; // its number is of the other run
  if (armed !== undefined)
    message.value = { good: undefined, text: `${armed} is not armed any more: nothing was sent` };
}
