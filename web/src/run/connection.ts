// SPDX-License-Identifier: Apache-2.0
// The page's connection to the server: its state, and requests and commands with their answers or the reason for having
// none.
import { computed, signal } from '@preact/signals';
import type { CommandReply } from '../gen/aeolis/v1/run_pb';
import { access, learnAccess } from '../access/model';
import type { CommandIntent, ControlAction, FromWorker, Question, StreamState, ToWorker } from '../stream/messages';
import { Refused, call, turnedAway } from './api';
import { notify, store } from './shown';

export const stream = signal<{ state: StreamState; attempt: number; gaps: number; serverVersion: string }>({
  state: 'connecting',
  attempt: 0,
  gaps: 0,
  serverVersion: '',
});
export const isLost = computed(() => stream.value.state === 'lost');

const NOT_SENT = 'not connected: nothing was sent';
const ANSWER_WITHIN_MS = 30_000; // chosen: longer than any request may take the server

let worker: Worker | undefined;
const forWorker: ToWorker[] = []; // until there is a worker
let lastAsk = 0;
let lastRequest = 0;
const asked = new Map<number, { resolve: (value: unknown) => void; reject: (error: Error) => void }>();
const requests = new Map<number, { resolve: (reply: CommandReply) => void; reject: (error: Error) => void }>();
/** Sent commands whose answer is no longer awaited, for naming a late answer. */
const unanswered = new Map<number, string>();

export function post(message: ToWorker): void {
  if (worker) worker.postMessage(message);
  else forWorker.push(message);
}

/** Sets the worker, which listens and answers for the server. Earlier messages are passed on to it. */
export function sendBy(its: Worker | undefined): void {
  worker = its;
  if (its) for (const message of forWorker.splice(0)) its.postMessage(message);
}

/**
 * True from the loss of the connection until the server confirms that it has the very run shown. Meanwhile the server
 * that answers may have another archive, without this run or with another run of its number.
 */
export const inDoubt = signal(false);

/** Throws while in doubt, before anything about the run is asked. */
export function refuseInDoubt(): void {
  if (inDoubt.peek()) throw new Refused(0, 'not connected: nothing was asked');
}

/** Asks an HTTP route through the worker; rejects with the server's own words. */
export async function ask<T>(question: Question, path: string): Promise<T> {
  if (path.startsWith('/runs/')) refuseInDoubt();
  const number = ++lastAsk;
  return new Promise<T>((resolve, reject) => {
    asked.set(number, { resolve: resolve as (value: unknown) => void, reject });
    post({ type: 'ask', ask: number, question, path });
  });
}

/** Why nothing can be sent now. Undefined once the server has confirmed the run shown and the page has all of it. */
export function whyNotSent(): string | undefined {
  const { state } = stream.value;
  return state === 'live' ? undefined : state === 'catching_up' ? 'catching up: nothing was sent' : NOT_SENT;
}

/** Controls the run shown unless another is named; another current run is not touched. */
export function control(action: ControlAction, run = store.value?.id ?? 0): void {
  const why = whyNotSent();
  if (why === undefined) post({ type: 'control', run, control: action });
  else notify(why);
}

/** Reads a small answer about the run shown over HTTP. */
export async function read<T>(path: string): Promise<T> {
  refuseInDoubt();
  return call<T>('GET', path);
}

/** Changes the run shown over HTTP. */
export async function change<T>(path: string, body: object, within_ms?: number): Promise<T> {
  const why = whyNotSent();
  if (why === undefined) return call<T>('POST', path, body, within_ms);
  await learnAccess().catch(() => undefined); // the end of a session also ends the connection
  throw new Refused(409, access.value.state === 'out' ? 'log in first' : why);
}

/** A command was sent and no answer will arrive: it may have been accepted or not. */
export class OutcomeUnknown extends Error {}

/**
 * Sends a command once. Rejects if it was not sent, and with OutcomeUnknown if no answer arrived. Only the reply with
 * its number is its answer.
 */
export function sendCommand(intent: CommandIntent): Promise<CommandReply> {
  const why = whyNotSent();
  if (why !== undefined) return Promise.reject(new Error(why));
  const request = ++lastRequest;
  return new Promise((resolve, reject) => {
    requests.set(request, { resolve, reject });
    setTimeout(() => {
      if (!requests.delete(request)) return;
      if (!intent.dryRun) unanswered.set(request, intent.command ?? `${intent.action} of command ${intent.number}`);
      reject(
        new OutcomeUnknown(
          `no answer came in ${ANSWER_WITHIN_MS / 1000} s: whether it was taken is not known; the history below will say`,
        ),
      );
    }, ANSWER_WITHIN_MS);
    post({ type: 'command', request, run: store.value?.id ?? 0, intent });
  });
}

/** Rejects the awaited commands, because the connection is lost and with it their answers. */
export function giveUpCommands(): void {
  for (const request of requests.values()) {
    request.reject(
      new OutcomeUnknown(
        'the connection was lost before an answer came: whether it was taken is not known; the history below will say',
      ),
    );
  }
  requests.clear();
}

/** Passes an answer of the worker to its request. */
export function takeAnswer(message: Extract<FromWorker, { type: 'reply' | 'not_sent' | 'answer' }>): void {
  switch (message.type) {
    case 'reply': {
      const request = Number(message.reply.request);
      requests.get(request)?.resolve(message.reply);
      requests.delete(request);
      const { accepted, command, reason } = message.reply;
      const late = unanswered.get(request);
      if (late !== undefined)
        notify(
          `${late}: the answer has come late. ${accepted ? `It was taken${command > 0n ? ` as #${command}` : ''}.` : `It was refused: ${reason}; nothing was sent.`}`,
        );
      unanswered.delete(request);
      break;
    }
    case 'not_sent':
      requests.get(message.request)?.reject(new Error(NOT_SENT));
      requests.delete(message.request);
      break;
    case 'answer': {
      const question = asked.get(message.ask);
      asked.delete(message.ask);
      if (message.ok) question?.resolve(message.value);
      else {
        if (message.status === 401) turnedAway.value += 1;
        question?.reject(new Refused(message.status, message.error));
      }
      break;
    }
  }
}
