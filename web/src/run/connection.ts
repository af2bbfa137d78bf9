// SPDX-License-Identifier: Apache-2.0
// The page's way to the server: what is connected, and what is asked and sent, each with its answer or the reason why there is none.
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
const ANSWER_WITHIN_MS = 30_000; // ours: longer than any question of the server may take

let worker: Worker | undefined;
const forWorker: ToWorker[] = []; // until there is one
let lastAsk = 0;
let lastRequest = 0;
const asked = new Map<number, { resolve: (value: unknown) => void; reject: (error: Error) => void }>();
const requests = new Map<number, { resolve: (reply: CommandReply) => void; reject: (error: Error) => void }>();
/** Sent and given up on: what an answer that comes late is about. */
const unanswered = new Map<number, string>();

export function post(message: ToWorker): void {
  if (worker) worker.postMessage(message);
  else forWorker.push(message);
}

/** What hears and answers for the server: from now on all goes there, also what was said before. */
export function sendBy(its: Worker | undefined): void {
  worker = its;
  if (its) for (const message of forWorker.splice(0)) its.postMessage(message);
}

/**
 * Since the connection broke, until the server that came back has said that it has the very run that is shown: what answers may have another archive,
 * with no such run, or another one of its number.
 */
export const inDoubt = signal(false);

/** Throws then: before anything of the run is asked. */
export function refuseInDoubt(): void {
  if (inDoubt.peek()) throw new Refused(0, 'not connected: nothing was asked');
}

/** Asks an HTTP route by the worker; rejects with the server's own words. */
export async function ask<T>(question: Question, path: string): Promise<T> {
  if (path.startsWith('/runs/')) refuseInDoubt();
  const number = ++lastAsk;
  return new Promise<T>((resolve, reject) => {
    asked.set(number, { resolve: resolve as (value: unknown) => void, reject });
    post({ type: 'ask', ask: number, question, path });
  });
}

/** Why nothing can be sent now; undefined where the server has said that this very run is what it has, and all of it is here. */
export function whyNotSent(): string | undefined {
  const { state } = stream.value;
  return state === 'live' ? undefined : state === 'catching_up' ? 'catching up: nothing was sent' : NOT_SENT;
}

/** Of the run that is shown, if no other is named: another that goes on meanwhile is not touched. */
export function control(action: ControlAction, run = store.value?.id ?? 0): void {
  const why = whyNotSent();
  if (why === undefined) post({ type: 'control', run, control: action });
  else notify(why);
}

/** Asks of the run that is shown, over HTTP: what has a small answer. */
export async function read<T>(path: string): Promise<T> {
  refuseInDoubt();
  return call<T>('GET', path);
}

/** Changes something of it, so too. */
export async function change<T>(path: string, body: object, within_ms?: number): Promise<T> {
  const why = whyNotSent();
  if (why === undefined) return call<T>('POST', path, body, within_ms);
  await learnAccess().catch(() => undefined); // the end of a session ends the connection, too
  throw new Refused(409, access.value.state === 'out' ? 'log in first' : why);
}

/** Sent, and no answer will come: it may have been taken or not. */
export class OutcomeUnknown extends Error {}

/** Sends once. Rejects when nothing was sent, and with OutcomeUnknown when it was and no answer came. Only the reply that bears its number is its answer. */
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

/** The connection is gone, and with it every answer that was to come. */
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

/** What the worker says to what was asked or sent. */
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
