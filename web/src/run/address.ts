// SPDX-License-Identifier: Apache-2.0
// What the page's address asks for.

const asked = () => new URLSearchParams(globalThis.location?.search);

/** ?run=NUMBER; 0: whichever goes on, else the newest. */
export const wantedRun = (): number => Number(asked().get('run') ?? 0);

/** Of the panel of plots at an address: ?panel=plots&channels=one,two. */
export const namedChannels = (): string[] => (asked().get('channels') ?? '').split(',').filter((name) => name !== '');
