// The state of the command line, and its three keys: Enter goes one step on, Esc one step back, arrows choose.
import { computed, signal } from '@preact/signals';
import { dictionary, sendCommand, store, tick } from '../run/session';
import { argumentOffers, candidates, fieldsOf, isHazardous, readLine, unknownNames } from './model';
import type { Step } from './model';

export const step = signal<Step>('type');
export const line = signal('');
export const confirmation = signal('');
export const choiceIndex = signal(0);
export const message = signal<{ good: boolean | undefined; text: string } | undefined>(undefined);
const chosenName = signal<string | undefined>(undefined);
/** What is typed into the form; the line's own name=value come first. */
export const formText = signal<ReadonlyMap<string, string>>(new Map());

export const typed = computed(() => readLine(line.value));
/** Set once the line names a command and goes on with its arguments. */
export const inArguments = computed(() => (dictionary.value ? argumentOffers(dictionary.value, line.value) : undefined));
export const offered = computed(() => {
  if (inArguments.value) return [inArguments.value.command];
  return dictionary.value ? candidates(dictionary.value, typed.value.words) : [];
});
export const chosen = computed(() =>
  chosenName.value === undefined ? undefined : dictionary.value?.command(chosenName.value));
export const fields = computed(() => {
  void tick.value;
  return chosen.value
    ? fieldsOf(chosen.value, new Map([...formText.value, ...typed.value.given]), store.value?.run.solution ?? [])
    : [];
});

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
  step.value = 'review';
  message.value = undefined;
}

export function complete(): void {
  const within = inArguments.value;
  if (within) {
    const offer = within.offers[choiceIndex.value] ?? within.offers[0];
    if (offer !== undefined) line.value = line.value.replace(/\S*$/, within.stem + offer);
    choiceIndex.value = 0;
    return;
  }
  const command = offered.value[choiceIndex.value];
  if (command) line.value = [command.name.toLowerCase(), ...[...typed.value.given].map(([name, value]) => `${name}=${value}`)].join(' ') + (command.arguments.length > 0 ? ' ' : '');
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
  const problem = problemNow();
  if (problem !== undefined) {
    message.value = { good: false, text: problem };
    return;
  }
  if (step.value === 'review' && isHazardous(command)) {
    step.value = 'armed';
    message.value = undefined;
    return;
  }
  if (step.value === 'armed' && confirmation.value.trim().toUpperCase() !== command.name) {
    message.value = { good: false, text: `type ${command.name} to confirm; nothing was sent` };
    return;
  }
  const wasArmed = step.value === 'armed';
  step.value = 'sending';
  message.value = { good: undefined, text: `${command.name}: sending` };
  try {
    const reply = await sendCommand({
      command: command.name,
      arguments: fields.value.filter((field) => field.from === 'typed').map((field) => ({ name: field.argument.name, value: field.value as number })),
      armed: wasArmed, confirmation: wasArmed ? command.name : '',
      fromSolution: fields.value.some((field) => field.from === 'solution'),
    });
    message.value = reply.accepted
      ? { good: true, text: `${command.name} is #${reply.command}, ${reply.octets.length / 2} octets: ${reply.octets.slice(0, 48)}${reply.octets.length > 48 ? '…' : ''}` }
      : { good: false, text: `${command.name} refused: ${reply.reason}` };
    if (reply.accepted) line.value = '';
  } catch (error) {
    message.value = { good: false, text: `${command.name}: ${error instanceof Error ? error.message : String(error)}` };
  }
  step.value = 'type';
  chosenName.value = undefined;
  confirmation.value = '';
  openCommandLine();
}

function problemNow(): string | undefined {
  const command = chosen.value;
  if (!command) return undefined;
  const stray = inArguments.value?.strays[0];
  if (stray !== undefined) return `${stray} is no argument with a value: write name=value`;
  const unknown = unknownNames(command, typed.value.given)[0];
  if (unknown !== undefined) return `${command.name} has no argument ${unknown}`;
  const bad = fields.value.find((field) => field.problem !== undefined);
  return bad && `${bad.argument.name} ${bad.problem}${bad.text ? `: ${bad.text}` : ''}`;
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
