// SPDX-License-Identifier: Apache-2.0
import { effect } from '@preact/signals';
import { render } from 'preact';
import { access } from './access/model';
import { App } from './app';
import { startLoop } from './draw/loop';
import { printLight } from './design/print';
import { refineWhatIsLookedAt } from './run/detail';
import { begin } from './run/session';
import { dictionary } from './run/shown';
import { onKey } from './shortcuts/model';
import './style.css';
import './design/print.css';

const EMPTY_MS = 150; // chosen: without an answer by then, the page shows itself empty and says so

void begin(); // first of all, to use the time in which the server answers
document.documentElement.dataset.theme = localStorage.getItem('aeolis-theme') === 'light' ? 'light' : 'dark';
const panel = new URL(location.href).searchParams.get('panel') ?? undefined;
window.addEventListener('keydown', onKey);
startLoop();
printLight();
refineWhatIsLookedAt();

/** Resolves once the content is known or a log-in is needed. */
const known = new Promise<void>(
  (resolve) =>
    void effect(() => {
      if (dictionary.value || access.value.state === 'out' || access.value.state === 'choose') resolve();
    }),
);

// The page is built once, with its content, while the first look is under way. Built earlier, it would be built twice,
// and the picture would appear later.
const root = document.getElementById('console');
const typeThere = Promise.all(['Inter', 'JetBrains Mono'].map((family) => document.fonts.load(`16px "${family}"`)));
await Promise.race([Promise.all([known, typeThere]), new Promise((resolve) => setTimeout(resolve, EMPTY_MS))]);
if (root) render(<App panel={panel} />, root);
