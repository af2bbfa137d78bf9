// SPDX-License-Identifier: Apache-2.0
// The log-in: alone before the console may be shown, or as a bar over the display when a session ends during work.
import { signal } from '@preact/signals';
import { useEffect, useRef } from 'preact/hooks';
import { access, busy, choosePassword, logIn, problem } from './model';
import './style.css';

const user = signal('');
const password = signal('');

function Form({ known }: { known: string }) {
  const first = useRef<HTMLInputElement>(null);
  useEffect(() => {
    if (known === '') first.current?.focus();
  }, [known]);
  return (
    <form
      data-testid="log-in"
      aria-label="log in"
      onSubmit={(event) => {
        event.preventDefault();
        const [name, secret] = [user.value || known, password.value];
        password.value = '';
        void logIn(name, secret);
      }}
    >
      <label>
        user{' '}
        <input
          ref={first}
          name="username"
          autocomplete="username"
          maxLength={64}
          required
          value={user.value || known}
          data-testid="log-in-user"
          spellcheck={false}
          onInput={(event) => (user.value = event.currentTarget.value)}
        />
      </label>
      <label>
        password{' '}
        <input
          name="password"
          type="password"
          autocomplete="current-password"
          maxLength={1024}
          required
          value={password.value}
          data-testid="log-in-password"
          onInput={(event) => (password.value = event.currentTarget.value)}
        />
      </label>
      <button type="submit" class="primary" disabled={busy.value}>
        {busy.value ? 'asking…' : 'log in'}
      </button>
      {problem.value && (
        <p role="alert" class="status-alarm" data-testid="log-in-problem">
          ✖ {problem.value}
        </p>
      )}
    </form>
  );
}

const CHOICE = [
  ['given', 'the one you were given', 'current-password'],
  ['chosen', 'your own, 12 letters or more', 'new-password'],
  ['again', 'once more', 'new-password'],
] as const;

function ChooseForm({ who }: { who: string }) {
  return (
    <form
      data-testid="choose-password"
      aria-label="choose a password"
      onSubmit={(event) => {
        event.preventDefault();
        const form = event.currentTarget;
        const [given = '', chosen = '', again = ''] = CHOICE.map(
          ([name]) => (form.elements.namedItem(name) as HTMLInputElement).value,
        );
        void choosePassword(given, chosen, again);
      }}
    >
      <p>{who}, this password was given to you. Choose one of your own, then everything else opens.</p>
      {CHOICE.map(([name, label, complete]) => (
        <label key={name}>
          {label}{' '}
          <input
            name={name}
            type="password"
            autocomplete={complete}
            required
            maxLength={128}
            data-testid={`password-${name}`}
          />
        </label>
      ))}
      <button type="submit" class="primary" disabled={busy.value}>
        {busy.value ? 'asking…' : 'choose it'}
      </button>
      {problem.value && (
        <p role="alert" class="status-alarm" data-testid="choose-problem">
          ✖ {problem.value}
        </p>
      )}
    </form>
  );
}

/** The log-in before the console is shown. */
export function LogIn() {
  const now = access.value;
  if (now.state === 'choose')
    return (
      <main class="log-in-page">
        <section class="panel log-in">
          <h2>Choose a password</h2>
          <ChooseForm who={now.user} />
        </section>
      </main>
    );
  return (
    <main class="log-in-page">
      <section class="panel log-in">
        <h2>Log in</h2>
        <p>This server shows its runs to those with an account only.</p>
        <Form known="" />
      </section>
    </main>
  );
}

/** The log-in after the end of a session. The display stays and is marked as old. */
export function ExpiredBar() {
  const now = access.value;
  if (now.state === 'choose')
    return (
      <div class="expired-bar" role="alert">
        <ChooseForm who={now.user} />
      </div>
    );
  if (now.state !== 'out' || !now.expired) return null;
  return (
    <div class="expired-bar" role="alert" data-testid="expired-bar">
      <b>
        ✖ Your session has ended. What is shown is old, and what you were doing was not done unless its own line says
        so. Log in to go on; nothing is sent again by itself.
      </b>
      <Form known={now.user} />
    </div>
  );
}
