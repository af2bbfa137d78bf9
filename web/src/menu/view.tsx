// SPDX-License-Identifier: Apache-2.0
// The open menu, and what an item opens in its place.
import { signal, useSignal } from '@preact/signals';
import type { ComponentChildren } from 'preact';
import { useEffect, useLayoutEffect, useRef } from 'preact/hooks';
import { alarms } from '../alarms/model';
import { busy, layouts, loadLayouts, most, problem, removeLayout, saveLayout, showLayout } from '../layouts/model';
import { openPacket, openPackets } from '../packets/open';
import { linkNow } from '../picture/model';
import { wordsFor } from '../run/api';
import { dictionary, shownRun } from '../run/shown';
import { itemsOf } from './items';
import type { Item, Sheet } from './items';
import { closeMenu, openedMenu } from './model';
import type { Opened } from './model';
import {
  happeningLines,
  limitLines,
  linkLines,
  lookedAt,
  packetLines,
  packetOf,
  packetStateLines,
  sampleLines,
} from './why';
import type { Lines } from './why';

const EDGE_PX = 8;

/** Keeps a box within the window: left of and above its point if there is no room. */
function useInside(x: number, y: number) {
  const box = useRef<HTMLDivElement>(null);
  const place = useSignal({ left: x, top: y });
  useLayoutEffect(() => {
    const element = box.current;
    if (!element) return undefined;
    const put = () => {
      const [wide, high] = [element.offsetWidth, element.offsetHeight];
      const { clientWidth, clientHeight } = document.documentElement;
      const left = Math.max(EDGE_PX, Math.min(x, clientWidth - wide - EDGE_PX));
      const top = Math.max(EDGE_PX, Math.min(y, clientHeight - high - EDGE_PX));
      if (left !== place.value.left || top !== place.value.top) place.value = { left, top };
    };
    put();
    const sizes = new ResizeObserver(put);
    sizes.observe(element);
    return () => sizes.disconnect();
  }, [x, y]);
  return { box, style: { left: `${place.value.left}px`, top: `${place.value.top}px` } };
}

/** Closes it when the focus or the mouse goes elsewhere. */
function useClosing(): void {
  useEffect(() => {
    const outside = (event: Event) => {
      if (event.target instanceof Element && !event.target.closest('.menu')) openedMenu.value = undefined;
    };
    document.addEventListener('pointerdown', outside);
    document.addEventListener('focusin', outside);
    return () => {
      document.removeEventListener('pointerdown', outside);
      document.removeEventListener('focusin', outside);
    };
  }, []);
}

const titleOf = ({ kind, name }: Opened): string =>
  kind === 'display' ? 'this display' : kind === 'link' ? 'link' : kind === 'panel' ? `panel ${name}` : name;

function onMenuKey(event: KeyboardEvent): void {
  const list = event.currentTarget as HTMLElement;
  const all = [...list.querySelectorAll<HTMLElement>('[role^="menuitem"]')];
  const at = all.indexOf(document.activeElement as HTMLElement);
  const starts = (each: HTMLElement) => each.textContent?.trim().toLowerCase().startsWith(event.key.toLowerCase());
  let to = {
    ArrowDown: all[(at + 1) % all.length],
    ArrowUp: all[(at - 1 + all.length) % all.length],
    Home: all[0],
    End: all.at(-1),
  }[event.key];
  if (event.key === 'Escape' || event.key === 'Tab') closeMenu();
  else if (!to && /^\p{L}$/u.test(event.key)) to = [...all.slice(at + 1), ...all].find(starts);
  else if (!to) {
    if (event.key !== 'Enter' && event.key !== ' ') event.stopPropagation(); // no key of the page acts under it
    return;
  }
  to?.focus();
  event.preventDefault();
  event.stopPropagation();
}

function MenuItem({ item, choose }: { item: Item; choose: (item: Item) => void }) {
  return (
    <button
      type="button"
      {...(item.checked === undefined
        ? { role: 'menuitem' }
        : { role: item.isBox ? 'menuitemcheckbox' : 'menuitemradio', 'aria-checked': item.checked })}
      aria-disabled={item.why !== undefined}
      tabIndex={-1}
      onClick={() => item.why === undefined && choose(item)}
      onPointerMove={(event) => event.currentTarget.focus({ preventScroll: true })}
    >
      <span class="menu-check" aria-hidden="true">
        {item.checked ? '✓' : ''}
      </span>
      <span>
        {item.words}
        {item.why !== undefined && <small>: {item.why}</small>}
      </span>
      {item.key && <kbd>{item.key}</kbd>}
    </button>
  );
}

function List({ menu, open }: { menu: Opened; open: (sheet: Sheet) => void }) {
  const { box, style } = useInside(menu.x, menu.y);
  useClosing();
  const groups = (itemsOf(menu) ?? [[{ words: menu.name, why: 'nothing of this name is known' }]]).filter(
    (group) => group.length > 0,
  );
  useLayoutEffect(
    () => box.current?.querySelector<HTMLElement>('[role^="menuitem"][aria-disabled="false"]')?.focus(),
    [],
  );
  const choose = (item: Item) => {
    if (item.opens) {
      open(item.opens);
      return;
    }
    closeMenu();
    item.act?.();
  };
  return (
    <div
      class="menu"
      role="menu"
      aria-label={titleOf(menu)}
      tabIndex={-1}
      ref={box}
      style={style}
      data-testid="menu"
      onKeyDown={onMenuKey}
    >
      <p role="presentation">{titleOf(menu)}</p>
      {groups.map((group, i) => (
        <div role="group" key={i}>
          {group.map((item) => (
            <MenuItem key={item.words} item={item} choose={choose} />
          ))}
        </div>
      ))}
    </div>
  );
}

/** What an item opens: a small sheet in the menu's place, which Esc closes. */
function Box({ menu, title, children }: { menu: Opened; title: string; children: ComponentChildren }) {
  const { box, style } = useInside(menu.x, menu.y);
  useClosing();
  useLayoutEffect(() => {
    const element = box.current;
    const field = element?.querySelector<HTMLInputElement>('input');
    if (field) field.focus();
    else element?.focus();
  }, []);
  return (
    <div
      class="menu sheet"
      role="dialog"
      aria-label={title}
      tabIndex={-1}
      ref={box}
      style={style}
      data-testid="menu-sheet"
      onKeyDown={(event) => {
        event.stopPropagation(); // no key of the page acts under it
        if (event.key !== 'Escape') return;
        event.preventDefault();
        closeMenu();
      }}
    >
      <h2>
        {title}
        <button type="button" class="quiet" onClick={closeMenu}>
          close <kbd>Esc</kbd>
        </button>
      </h2>
      {children}
    </div>
  );
}

function Facts({ lines }: { lines: Lines }) {
  return (
    <dl>
      {lines.map(([name, words], i) => (
        <div key={i}>
          <dt>{name}</dt>
          <dd>{words}</dd>
        </div>
      ))}
    </dl>
  );
}

function Link({ menu }: { menu: Opened }) {
  const field = useRef<HTMLInputElement>(null);
  const copied = useSignal<boolean | undefined>(undefined);
  const link = useSignal(linkNow());
  useEffect(() => {
    field.current?.select();
    const writing = navigator.clipboard?.writeText(link.value) ?? Promise.reject(new Error('no clipboard'));
    writing.then(
      () => (copied.value = true),
      () => (copied.value = false),
    );
  }, []);
  return (
    <Box menu={menu} title="A link to what is shown">
      <p role="status" data-testid="link-copied">
        {copied.value === undefined
          ? '…'
          : copied.value
            ? '✓ Copied.'
            : 'The browser lets the page copy nothing: press Ctrl+C.'}
      </p>
      <input ref={field} readOnly aria-label="link" value={link.value} data-testid="link" />
    </Box>
  );
}

function Limits({ menu }: { menu: Opened }) {
  const words = dictionary.value;
  const channel = words?.pick([menu.name]);
  return (
    <Box menu={menu} title={`Alarm limits of ${menu.name}${channel?.unit ? `, in ${channel.unit}` : ''}`}>
      {words && channel && <Facts lines={limitLines(shownRun(), channel)} />}
    </Box>
  );
}

/** A channel: its sample first, then the packet, as soon as the archive has answered. */
function ChannelWhy({ menu, opens }: { menu: Opened; opens: boolean }) {
  const found = useSignal<Lines>([['packet', 'asking the archive …']]);
  const run = shownRun();
  const channel = dictionary.value?.pick([menu.name]);
  const sample = useSignal(run && channel ? run.latest(channel.id, lookedAt(run)) : undefined);
  const open = useSignal<(() => void) | undefined>(undefined);
  useEffect(() => {
    if (!run || !channel || !sample.value) {
      found.value = [];
      return;
    }
    if (channel.packet === '') {
      found.value = [['packet', 'none: the ground computes it']];
      return;
    }
    packetOf(run, channel.packet, sample.value).then(
      (row) => {
        if (!row) {
          found.value = [['packet', `the archive has no ${channel.packet} of that instant`]];
          return;
        }
        const show = () => {
          closeMenu();
          openPacket(row, channel.name);
        };
        if (opens) show();
        else [found.value, open.value] = [packetLines(row, channel.name), show];
      },
      (error: unknown) => (found.value = [['packet', `not known: ${wordsFor(error)}`]]),
    );
  }, []);
  return (
    <Box menu={menu} title={`${opens ? 'The bytes' : 'Why'}: ${menu.name}`}>
      {run && channel && <Facts lines={[...sampleLines(run, channel, sample.value), ...found.value]} />}
      {open.value && (
        <button type="button" onClick={() => open.value?.()} data-testid="why-bytes">
          open the packet
        </button>
      )}
    </Box>
  );
}

function Why({ menu }: { menu: Opened }) {
  const run = shownRun();
  const { kind, name } = menu;
  if (kind === 'channel') return <ChannelWhy menu={menu} opens={false} />;
  const reason = alarms.value?.all.find((alarm) => alarm.name === name)?.reason;
  return (
    <Box menu={menu} title={`Why: ${name}`}>
      {run && (
        <Facts
          lines={
            kind === 'link'
              ? linkLines(run, name)
              : kind === 'packet'
                ? packetStateLines(run, name, reason)
                : happeningLines(run, name)
          }
        />
      )}
    </Box>
  );
}

function Bytes({ menu }: { menu: Opened }) {
  useEffect(() => {
    if (menu.kind !== 'packet') return;
    closeMenu();
    openPackets(menu.name);
  }, []);
  return menu.kind === 'channel' ? <ChannelWhy menu={menu} opens={true} /> : null;
}

const newName = signal('');

function Layouts({ menu }: { menu: Opened }) {
  const all = layouts.value ?? [];
  const name = newName.value.trim();
  const replaces = all.some((each) => each.name === name);
  return (
    <Box menu={menu} title="Layouts">
      <form
        onSubmit={(event) => {
          event.preventDefault();
          void saveLayout(name).then((done) => {
            if (done) newName.value = '';
          });
        }}
      >
        <input
          aria-label="name of the layout"
          placeholder="name for what the places show now"
          maxLength={40}
          required
          value={newName.value}
          data-testid="layout-name"
          onInput={(event) => (newName.value = event.currentTarget.value)}
        />
        <button type="submit" disabled={busy.value || name === ''} data-testid="layout-save">
          {replaces ? 'replace' : 'save'}
        </button>
      </form>
      {problem.value && (
        <p role="alert" class="status-alarm" data-testid="layout-problem">
          ✖ {problem.value}
        </p>
      )}
      <ul data-testid="layout-list">
        {all.map((layout) => (
          <li key={layout.name}>
            <button type="button" class="link-button" onClick={() => showLayout(layout)}>
              {layout.name}
            </button>
            <button
              type="button"
              aria-label={`remove ${layout.name}`}
              disabled={busy.value}
              onClick={() => void removeLayout(layout.name)}
            >
              remove
            </button>
          </li>
        ))}
      </ul>
      <p>{layouts.value ? `${all.length} of at most ${most.value}` : '? asking…'}</p>
    </Box>
  );
}

const SHEETS = { limits: Limits, why: Why, bytes: Bytes, link: Link, layouts: Layouts };

export function MenuView() {
  const menu = openedMenu.value;
  const sheet = useSignal<Sheet | undefined>(menu?.kind === 'link' ? 'link' : undefined);
  useEffect(() => {
    if (menu?.kind === 'display') void loadLayouts();
  }, []);
  if (!menu) return null;
  const Shown = sheet.value && SHEETS[sheet.value];
  return (
    <aside aria-label="menu">
      {Shown ? <Shown menu={menu} /> : <List menu={menu} open={(next) => (sheet.value = next)} />}
    </aside>
  );
}
