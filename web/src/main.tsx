// SPDX-License-Identifier: Apache-2.0
import { effect } from '@preact/signals';
import { render } from 'preact';
import { access } from './access/model';
import { App } from './app';
import { startLoop } from './draw/loop';
import { refineWhatIsLookedAt } from './run/detail';
import { begin } from './run/session';
import { dictionary } from './run/shown';
import { onKey } from './shortcuts/model';
import './style.css';

const EMPTY_MS = 150; // chosen: without an answer by then, the page is shown empty and says so

void begin(); // before all else: while the server answers there is time for it
document.documentElement.dataset.theme = localStorage.getItem('aeolis-theme') === 'light' ? 'light' : 'dark';
const panel = new URL(location.href).searchParams.get('panel') ?? undefined;
window.addEventListener('keydown', onKey);
startLoop();
refineWhatIsLookedAt();

/** Once it is known what is shown, or that somebody must log in first. */
const known = new Promise<void>(
  (resolve) =>
    void effect(() => {
      if (dictionary.value || access.value.state === 'out' || access.value.state === 'choose') resolve();
    }),
);

// Built once, with what it shows, while the first look is on its way: built before, it would be built twice, and the picture would come later.
const root = document.getElementById('console');
await Promise.race([known, new Promise((resolve) => setTimeout(resolve, EMPTY_MS))]);
if (root) render(<App panel={panel} />, root);
