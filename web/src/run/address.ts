// SPDX-License-Identifier: Apache-2.0
// The requests in the page's address.

const asked = () => new URLSearchParams(globalThis.location?.search);

/** The run at ?run=NUMBER. 0: the current run, else the newest. */
export const wantedRun = (): number => Number(asked().get('run') ?? 0);

/** Channels of the panel of plots, at ?panel=plots&channels=one,two. */
export const namedChannels = (): string[] => (asked().get('channels') ?? '').split(',').filter((name) => name !== '');
