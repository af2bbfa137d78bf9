import { render } from 'preact';
import { App } from './app';
import { startLoop } from './draw/loop';
import { refineWhatIsLookedAt } from './run/detail';
import { begin } from './run/session';
import { onKey } from './shortcuts/model';
import './style.css';

document.documentElement.dataset['theme'] = localStorage.getItem('aeolis-theme') === 'light' ? 'light' : 'dark';
const panel = new URL(location.href).searchParams.get('panel') ?? undefined;
const root = document.getElementById('console');
if (root) render(<App panel={panel} />, root);
window.addEventListener('keydown', onKey);
startLoop();
refineWhatIsLookedAt();
void begin();
