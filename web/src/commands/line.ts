// SPDX-License-Identifier: Apache-2.0
// The state of the command line and its three keys: Enter one step forward, Esc one step back, arrows choose.
import { computed, signal } from '@preact/signals';
import { learnAccess } from '../access/model';
import type { CommandReply } from '../gen/aeolis/v1/run_pb';
import { OutcomeUnknown, sendCommand, whyNotSent } from '../run/connection';
import { dictionary, pastRange, store, tick } from '../run/shown';
import type { CommandIntent, QueueAction } from '../stream/messages';
import {
  AT_ONCE,
  argumentOffers,
  candidates,
  fieldsOf,
  intentOf,
  isHazardous,
  readLine,
  reasonWords,
  unknownNames,
} from './model';
import type { Step, UplinkText } from './model';
import { rowsNow, withNames } from './names';

export const step = signal<Step>('type');
export const line = signal('');
export const confirmation = signal('');
export const choiceIndex = signal(0);
export const message = signal<{ good: boolean | undefined; text: string } | undefined>(undefined);
const chosenName = signal<string | undefined>(undefined);
/** Text typed into the form; name=value on the line takes precedence. */
export const formText = signal<ReadonlyMap<string, string>>(new Map());
export const uplink = signal<UplinkText>(AT_ONCE);

export const typed = computed(() => readLine(line.value));
/** Set once the line names a command and continues with its arguments. */
export const inArguments = computed(() =>
  dictionary.value
    ? argumentOffers(dictionary.value, line.value, (command) => withNames(command, rowsNow()))
    : undefined,
);
export const offered = computed(() => {
  if (inArguments.value) return [inArguments.value.command];
  return dictionary.value ? candidates(dictionary.value, typed.value.words) : [];
});
export const chosen = computed(() => {
  const command = chosenName.value === undefined ? undefined : dictionary.value?.command(chosenName.value);
  return command && withNames(command, rowsNow());
});
export const fields = computed(() => {
  void tick.value;
  return chosen.value
    ? fieldsOf(chosen.value, new Map([...formText.value, ...typed.value.given]), store.value?.run.solution ?? [])
    : [];
});

/** The step of a procedure that asked for the command in the line; it is told the number once the command is sent. */
export interface Purpose {
  command: string;
  /** "step enable of Second Chance enabled". */
  words: string;
  /** Values that the procedure gives, as typed; the rest it leaves to whoever sends, or to ground's solution. */
  given: ReadonlyMap<string, string>;
  fromSolution: boolean;
  sent: (command: number) => void;
}
const purpose = signal<Purpose | undefined>(undefined);
/** It lasts while the line has its command. */
export const purposeNow = computed(() =>
  chosen.value && purpose.value?.command === chosen.value.name ? purpose.value : undefined,
);
/** Arguments that are not as the procedure has them. */
export const otherwise = computed(() => {
  const asked = purposeNow.value;
  if (!asked) return [];
  const isAsked = ({ argument, text, from }: (typeof fields.value)[number]) => {
    const given = asked.given.get(argument.name);
    if (given !== undefined) return text.toLowerCase() === given.toLowerCase();
    return !(asked.fromSolution && from === 'typed');
  };
  return fields.value.filter((field) => !isAsked(field)).map(({ argument }) => argument.name);
});

/** The command that would be sent, or why there is none. */
export const intent = computed<CommandIntent | { problem: string } | undefined>(() => {
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
/** Changes when the command to be sent or its run changes. */
export const intentKey = computed(() => JSON.stringify([store.value?.id, pastRange.value !== undefined, intent.value]));

/** The server's answer to a dry run of the command as shown; nothing is sent. */
const preview = signal<{ of: string; reply: CommandReply } | undefined>(undefined);
export const previewNow = computed(() => (preview.value?.of === intentKey.value ? preview.value.reply : undefined));

/** What stood in the line when Enter was pressed while another command was being sent. */
let meantWhileSending = '';

let asked: { of: string; answer: Promise<CommandReply | undefined> } | undefined;

/**
 * Asks for a dry run of the command as if armed, confirmed and sent now. The same request is under way at most once, so
 * that no queue forms ahead of the command itself. Without a connection, or with an invalid form, nothing is asked.
 */
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
  // without a reply an old answer must not stay; the header reports the lost connection
  if (of === intentKey.value) preview.value = reply && { of, reply };
  return reply;
}

/** Whether the command line has the focus: nothing then asks for it to be opened. */
export const lineFocused = signal(false);

const lineInput = () => document.querySelector<HTMLInputElement>('[data-testid="command-line"]');

/** Gives the command line the focus; what stands in it is selected, so that the next letter replaces it. */
export function openCommandLine(text?: string): void {
  const input = lineInput();
  if (text !== undefined) {
    line.value = text;
    back(true);
    purpose.value = undefined;
    if (input) input.value = text; // before the page is drawn anew, or the selection would be lost
  }
  input?.focus();
  input?.select();
}

/** Takes letters that were typed without opening the line; false if it takes none now. */
export function typeIntoLine(letters: string): boolean {
  const input = lineInput();
  if (!input || input.disabled || step.value !== 'type') return false;
  type(line.value + letters);
  input.value = line.value;
  input.focus();
  input.setSelectionRange(line.value.length, line.value.length);
  return true;
}

/** Puts the command of a step into the line, to be reviewed as any other. */
export function prepare(of: Purpose): void {
  const given = [...of.given].map(([name, value]) => `${name}=${value}`);
  openCommandLine([of.command.toLowerCase(), ...given].join(' '));
  choose(of.command);
  purpose.value = of;
  // what the procedure leaves to whoever sends it is asked for at once
  requestAnimationFrame(() =>
    document.querySelector<HTMLElement>('[data-testid="command-review"] [aria-invalid="true"]')?.focus(),
  );
}

export function type(text: string): void {
  line.value = text;
  if (text.trim() === '') purpose.value = undefined;
  choiceIndex.value = 0;
  if (step.value !== 'sending') {
    step.value = 'type';
    chosenName.value = undefined;
    message.value = undefined;
  }
}

export function choose(name: string): void {
  chosenName.value = name;
  if (purpose.value?.command !== name) purpose.value = undefined;
  confirmation.value = '';
  formText.value = new Map();
  uplink.value = { ...AT_ONCE, controller: uplink.value.controller };
  preview.value = undefined; // an earlier answer does not apply
  step.value = 'review';
  message.value = undefined;
}

/** Completes the line with the offered text. False if the line does not change. */
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

/** Asks anew what the user may do: the refusal may be because rights were withdrawn meanwhile. */
function learnRights(): void {
  void learnAccess().catch(() => undefined);
}

/** Takes one step forward. `step` and `message` hold the result. */
export async function forward(): Promise<void> {
  const command = chosen.value;
  if (step.value === 'type') {
    const offer = inArguments.value?.command ?? offered.value[choiceIndex.value];
    if (line.value.trim() === '') message.value = { good: undefined, text: 'type a command, for example its words' };
    else if (!offer) message.value = { good: false, text: 'no command of the dictionary has these words' };
    else choose(offer.name);
    return;
  }
  if (step.value === 'sending') meantWhileSending = line.value;
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
  if (!previewNow.value.accepted) {
    message.value = { good: false, text: `nothing was sent: ${reasonWords(previewNow.value.reason)}` };
    learnRights();
    return;
  }
  if (step.value === 'armed' && confirmation.value.trim().toUpperCase() !== command.name) {
    message.value = { good: false, text: `type ${command.name} to confirm; nothing was sent` };
    return;
  }
  const wasArmed = step.value === 'armed';
  const [sent, asked] = [line.value, purposeNow.value];
  const done = () => {
    if (line.value === sent) line.value = ''; // text typed meanwhile is the next command
    if (purpose.value === asked) purpose.value = undefined;
  };
  step.value = 'sending';
  meantWhileSending = '';
  let accepted = false;
  message.value = { good: undefined, text: `${command.name}: sending` };
  try {
    const reply = await sendCommand({ ...wanted, armed: wasArmed, confirmation: wasArmed ? command.name : '' });
    message.value = reply.accepted
      ? {
          good: !reply.reason,
          text: `${command.name} is #${reply.command}, ${reply.octets.length / 2} octets${uplink.value.hold ? ', held' : uplink.value.releaseAt ? ', waits for its time' : ''}${reply.reason && `; ${reply.reason}`}`,
        }
      : { good: false, text: `${command.name} refused: ${reply.reason}; nothing was sent` };
    accepted = reply.accepted;
    if (accepted) {
      done();
      asked?.sent(Number(reply.command));
    } else learnRights();
  } catch (error) {
    message.value = { good: false, text: `${command.name}: ${error instanceof Error ? error.message : String(error)}` };
    if (error instanceof OutcomeUnknown) done(); // so that another Enter does not send it again
  }
  step.value = 'type';
  chosenName.value = undefined;
  confirmation.value = '';
  if (line.value !== '' && line.value !== sent) {
    // The next command is being typed: nothing of it is selected. If Enter has ended it, its review opens.
    if (accepted && line.value === meantWhileSending) await forward();
    return;
  }
  if (document.activeElement === document.body || document.activeElement?.closest('[data-testid="panel-commands"]'))
    openCommandLine(); // a user who works elsewhere keeps the focus there
}

/** Why Enter does not send: a command leaves only after the ground has answered exactly what is shown. */
const notReviewed = () =>
  whyNotSent() ??
  'the ground has not answered yet what would become of it: nothing was sent; read it, then press Enter';

/** Arms the command, unless the ground refuses it or has not answered. */
async function arm(): Promise<void> {
  const of = intentKey.value;
  const reply = await tryOut();
  if (step.value !== 'review' || intentKey.value !== of) return;
  if (!reply) {
    message.value = { good: false, text: `not armed: ${notReviewed()}` };
    return;
  }
  if (!reply.accepted) {
    message.value = { good: false, text: `not armed: ${reasonWords(reply.reason)}` };
    learnRights();
    return;
  }
  step.value = 'armed';
  message.value = undefined;
}

/** Acts on a waiting command. */
export async function act(number: number, action: QueueAction): Promise<void> {
  const done = { release: 'released', hold: 'held', cancel: 'cancelled', approve: 'approved' }[action];
  try {
    const reply = await sendCommand({ action, number: BigInt(number), controller: uplink.value.controller.trim() });
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
    purpose.value = undefined;
    (document.activeElement as HTMLElement | null)?.blur();
  }
}

/**
 * Disarms the command when another run or the past is shown, because the ground's answer belonged to one run at one
 * time. For another run the review ends too.
 */
export function disarm(another: boolean): void {
  const armed = step.value === 'armed' ? chosen.value?.name : undefined;
  preview.value = undefined;
  if (step.value === 'armed' || (step.value === 'review' && another)) back(another);
  else if (another) message.value = undefined; // its number belongs to the other run
  if (another) purpose.value = undefined; // and so does the step
  if (armed !== undefined)
    message.value = { good: undefined, text: `${armed} is not armed any more: nothing was sent` };
}
