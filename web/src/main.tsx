// SPDX-License-Identifier: Apache-2.0
import { effect } from '@preact/signals';
import { render } from 'preact';
import { access } from './access/model';
import { App } from './app';
import { callsReady } from './calls/opened';
import { startLoop } from './draw/loop';
import { listenForMenus } from './menu/model';
import { printLight } from './design/print';
import { keepAddress, openPicture } from './picture/model';
import { refineWhatIsLookedAt } from './run/detail';
import { opened } from './run/address';
import { begin } from './run/session';
import { dictionary } from './run/shown';
import { onKey } from './shortcuts/model';
import { listenForCalls } from './sound/model';
import './style.css';
import './design/print.css';

const SOON_MS = 3000; // chosen: after the first pictures
const EMPTY_MS = 150; // chosen: without an answer by then, the page shows itself empty and says so

void begin(); // first of all, to use the time in which the server answers
document.documentElement.dataset.theme = localStorage.getItem('aeolis-theme') === 'light' ? 'light' : 'dark';
window.addEventListener('keydown', onKey);
startLoop();
printLight();
refineWhatIsLookedAt();
openPicture();
keepAddress();
listenForMenus();
listenForCalls();

/**
 * What is opened in a hurry, perhaps when there is no connection any more, is loaded before that; else when it is
 * opened.
 */
const loadSoon = () =>
  Promise.all([
    import('./alarms/view'),
    import('./menu/view'),
    import('./commands/details'),
    import('./rehearsal/view'),
    import('./anomaly/view'),
  ]).catch(() => undefined);

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
setTimeout(() => void loadSoon().then(() => (callsReady.value = true)), SOON_MS);
if (root) render(<App panel={opened.picture.panel} />, root);
