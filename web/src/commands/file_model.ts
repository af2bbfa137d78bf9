// SPDX-License-Identifier: Apache-2.0
// A command file: its contents and the request made from it. Pure; the JSON of `aeolis send` and POST
// /runs/{run}/sequences.
import type { Dictionary } from '../run/dictionary';
import { isHazardous } from './model';

/** A command as the file has it. Its arguments, hold, release_at and the rest go to the server unchanged. */
interface FileCommand {
  command: string;
  [field: string]: unknown;
}

/** A reply in the server's JSON. */
export interface FileReply {
  accepted: boolean;
  reason: string;
  command: string; // its number in the run
  octets: string;
  arguments: string;
  leaves: string;
  arrives: string;
  latest_useful: string;
  useful_before: string;
  too_late_for: string[];
}
export interface SequenceAnswer {
  accepted: boolean;
  reason: string;
  commands: FileReply[];
}

const COMMANDS_MAX = 100; // the server's limit
export const FILE_OCTETS_MAX = 200_000; // chosen: a hundred commands are far shorter
/** Reads the text of a file, chosen or pasted. */
export const TOO_LONG = `a command file has at most ${COMMANDS_MAX} commands and ${FILE_OCTETS_MAX / 1e6} MB`;

export function readFile(text: string): { commands: FileCommand[] } | { problem: string } {
  if (new TextEncoder().encode(text).length > FILE_OCTETS_MAX) return { problem: TOO_LONG };
  let file: unknown;
  try {
    file = JSON.parse(text);
  } catch (error) {
    return { problem: `this is no JSON: ${error instanceof Error ? error.message : String(error)}` };
  }
  if (typeof file !== 'object' || file === null || !Array.isArray((file as { commands?: unknown }).commands))
    return { problem: 'a file is {"commands": […]}, as POST /runs/{run}/sequences takes it' };
  const stray = Object.keys(file).find((key) => key !== 'commands');
  if (stray !== undefined)
    return {
      problem:
        stray === 'dry_run'
          ? 'dry_run: take it out; here nothing is sent before you say so'
          : `${stray}: a file has commands, and nothing else`,
    };
  const commands = (file as { commands: unknown[] }).commands;
  if (commands.length === 0) return { problem: 'it has no commands' };
  if (commands.length > COMMANDS_MAX) return { problem: TOO_LONG };
  const bad = commands.findIndex(
    (each) => typeof each !== 'object' || each === null || typeof (each as { command?: unknown }).command !== 'string',
  );
  if (bad >= 0) return { problem: `commands[${bad}]: {"command": NAME, …} is wanted` };
  return { commands: commands as FileCommand[] };
}

/** Names of the hazardous commands, in order; each must be typed. */
export function hazardousIn(commands: readonly FileCommand[], dictionary: Dictionary): string[] {
  return commands.flatMap(({ command }) => {
    const known = dictionary.command(command);
    return known && isHazardous(known) ? [command] : [];
  });
}

/** Whether the typed text is these names, in order. */
export function confirms(typed: string, hazardous: readonly string[]): boolean {
  const words = typed.trim().toUpperCase().split(/\s+/);
  return words.length === hazardous.length && words.every((word, i) => word === hazardous[i]);
}

/**
 * The request to the server. Arming and typed names are the controller's, never the file's own. The controller's name
 * is filled in where the file lacks one. `confirmed`: the commands that were armed and typed, or would be in a dry run.
 */
export function sequenceOf(
  commands: readonly FileCommand[],
  confirmed: readonly string[],
  controller: string,
  dryRun: boolean,
): object {
  return {
    dry_run: dryRun,
    commands: commands.map(({ armed: _armed, confirmation: _confirmation, ...each }) => ({
      ...(controller !== '' && { controller }),
      ...each,
      ...(confirmed.includes(each.command) && { armed: true, confirmation: each.command }),
    })),
  };
}
