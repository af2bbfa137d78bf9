// SPDX-License-Identifier: Apache-2.0
// Users, tokens and the audit, for administrators.
import { signal, useSignal } from '@preact/signals';
import { useEffect, useId } from 'preact/hooks';
import { access } from '../access/model';
import { dictionary } from '../run/shown';
import {
  ROLES,
  addToken,
  addUser,
  audit,
  auditBefore,
  busy,
  lookAtAudit,
  message,
  newToken,
  offersFor,
  refreshUsers,
  removeToken,
  removeUser,
  setCommands,
  setOwnPassword,
  setPassword,
  setRole,
  tokens,
  users,
} from './model';
import './style.css';

const name = signal('');
const password = signal('');
const role = signal<string>('observer');
const commands = signal('');
const tokenName = signal('');
const tokenCommands = signal('');
const tokenRole = signal<string>('observer');
/** The entry whose removal needs a second press. */
const removing = signal('');

function Roles({ of, label, onChoose }: { of: string; label: string; onChoose: (role: string) => void }) {
  return (
    <select
      aria-label={label}
      value={of}
      disabled={busy.value}
      onChange={(event) => onChoose(event.currentTarget.value)}
    >
      {ROLES.map((each) => (
        <option key={each}>{each}</option>
      ))}
    </select>
  );
}

const ALL_OF_ROLE = 'all of the role';

/** A field for names of commands, with completions of the last one. */
function CommandNames({ of, label, onType }: { of: string; label: string; onType: (text: string) => void }) {
  const offers = useId();
  return (
    <>
      <input
        class="command-names"
        aria-label={label}
        title={of}
        placeholder={ALL_OF_ROLE}
        value={of}
        list={offers}
        spellcheck={false}
        autocomplete="off"
        disabled={busy.value}
        onInput={(event) => onType(event.currentTarget.value)}
      />
      <datalist id={offers}>
        {offersFor(of, dictionary.value?.commands ?? []).map((offer) => (
          <option key={offer} value={offer} />
        ))}
      </datalist>
    </>
  );
}

/** The typed text stays until it is set or the list of another user arrives. */
function CommandsOf({ user, may }: { user: string; may: readonly string[] }) {
  const now = may.join(' ');
  const typed = useSignal(now);
  useEffect(() => {
    typed.value = now;
  }, [now]);
  return (
    <form
      onSubmit={(event) => {
        event.preventDefault();
        void setCommands(user, typed.value);
      }}
    >
      <CommandNames of={typed.value} label={`commands that ${user} may send`} onType={(text) => (typed.value = text)} />{' '}
      <button type="submit" disabled={busy.value || typed.value === now}>
        set
      </button>
    </form>
  );
}

function Remove({ what, words, onRemove }: { what: string; words: string; onRemove: () => void }) {
  const sure = removing.value === what;
  return (
    <button
      type="button"
      disabled={busy.value}
      aria-label={sure ? `really ${words}` : words}
      onBlur={() => (removing.value = '')}
      onClick={() => {
        removing.value = sure ? '' : what;
        if (sure) onRemove();
      }}
    >
      {sure ? 'press again: it is final' : 'remove'}
    </button>
  );
}

function OwnPassword({ user }: { user: string }) {
  return (
    <form
      onSubmit={(event) => {
        event.preventDefault();
        const form = event.currentTarget;
        const typed = (name: string) => (form.elements.namedItem(name) as HTMLInputElement).value;
        void setOwnPassword(user, typed('current'), typed('secret')).then(() => form.reset());
      }}
    >
      <input
        name="current"
        type="password"
        autocomplete="current-password"
        aria-label="your password of before"
        placeholder="of before"
        required
        maxLength={128}
      />{' '}
      <input
        name="secret"
        type="password"
        autocomplete="new-password"
        aria-label={`new password of ${user}`}
        placeholder="a new one"
        required
        maxLength={128}
      />{' '}
      <button type="submit" disabled={busy.value}>
        set
      </button>
    </form>
  );
}

export function Users() {
  const now = access.value;
  const may = now.state === 'in' && now.role === 'administrator';
  useEffect(() => {
    if (may) void refreshUsers();
    return () => (newToken.value = undefined);
  }, [may]);
  if (now.state !== 'in')
    return (
      <p class="none">
        This server runs without accounts: whoever is on its machine may do everything. docs/operations.md says how to
        begin with accounts.
      </p>
    );
  if (!may)
    return (
      <p class="none">
        Users are for administrators; you are {now.user}, {now.role}.
      </p>
    );
  return (
    <div class="table-box" data-testid="users">
      {message.value && (
        <p role="status" class={message.value.good ? 'status-good' : 'status-alarm'} data-testid="users-message">
          {message.value.good ? '✓' : '✖'} {message.value.text}
        </p>
      )}
      {newToken.value && (
        <p class="new-token" data-testid="new-token">
          ▲ The token of {newToken.value.name}, shown this once: <output>{newToken.value.token}</output>
        </p>
      )}
      <div class="table-scroll" tabIndex={0} role="region" aria-label="users, tokens, audit">
        <form
          class="table-tools"
          data-testid="add-user"
          onSubmit={(event) => {
            event.preventDefault();
            const secret = password.value;
            password.value = '';
            void addUser(name.value.trim(), role.value, secret, commands.value).then((done) => {
              if (done) [name.value, commands.value] = ['', ''];
            });
          }}
        >
          <input
            aria-label="name of the new user"
            placeholder="new user"
            required
            maxLength={64}
            spellcheck={false}
            value={name.value}
            onInput={(event) => (name.value = event.currentTarget.value)}
          />
          <input
            aria-label="password of the new user"
            type="password"
            autocomplete="new-password"
            placeholder="password"
            required
            maxLength={1024}
            value={password.value}
            onInput={(event) => (password.value = event.currentTarget.value)}
          />
          <Roles of={role.value} label="role of the new user" onChoose={(each) => (role.value = each)} />
          <label>
            may send{' '}
            <CommandNames
              of={commands.value}
              label="commands of the new user"
              onType={(text) => (commands.value = text)}
            />
          </label>
          <button type="submit" disabled={busy.value}>
            add
          </button>
        </form>
        <table class="users-list">
          <thead>
            <tr>
              <th>user</th>
              <th>role</th>
              <th title="names of commands, between spaces; nothing: all that the role may send">may send</th>
              <th>password</th>
              <th>remove</th>
            </tr>
          </thead>
          <tbody>
            {users.value.map((each) => (
              <tr key={each.user} data-user={each.user}>
                <td class="audit-who">
                  <b>{each.user}</b>
                  {each.user === now.user && ' (you)'}
                </td>
                <td>
                  <Roles
                    of={each.role}
                    label={`role of ${each.user}`}
                    onChoose={(chosen) => void setRole(each.user, chosen)}
                  />
                </td>
                <td>
                  {each.user === now.user ? (
                    each.commands?.join(' ') || ALL_OF_ROLE
                  ) : (
                    <CommandsOf user={each.user} may={each.commands ?? []} />
                  )}
                </td>
                <td>
                  {each.user === now.user ? (
                    <OwnPassword user={each.user} />
                  ) : (
                    <form
                      onSubmit={(event) => {
                        event.preventDefault();
                        const field = event.currentTarget.elements.namedItem('secret') as HTMLInputElement;
                        const secret = field.value;
                        field.value = '';
                        void setPassword(each.user, secret);
                      }}
                    >
                      <input
                        name="secret"
                        type="password"
                        autocomplete="new-password"
                        aria-label={`new password of ${each.user}`}
                        placeholder="a new one"
                        required
                        maxLength={1024}
                      />{' '}
                      <button type="submit" disabled={busy.value}>
                        set
                      </button>
                    </form>
                  )}
                </td>
                <td>
                  {each.user !== now.user && (
                    <Remove
                      what={`user ${each.user}`}
                      words={`remove ${each.user}`}
                      onRemove={() => void removeUser(each.user)}
                    />
                  )}
                </td>
              </tr>
            ))}
          </tbody>
        </table>
        <h3>Tokens of programs</h3>
        <form
          class="table-tools"
          data-testid="add-token"
          onSubmit={(event) => {
            event.preventDefault();
            void addToken(tokenName.value.trim(), tokenRole.value, tokenCommands.value).then((done) => {
              if (done) [tokenName.value, tokenCommands.value] = ['', ''];
            });
          }}
        >
          <input
            aria-label="name of the new token"
            placeholder="new token"
            required
            maxLength={64}
            spellcheck={false}
            value={tokenName.value}
            onInput={(event) => (tokenName.value = event.currentTarget.value)}
          />
          <Roles of={tokenRole.value} label="role of the new token" onChoose={(each) => (tokenRole.value = each)} />
          <label>
            may send{' '}
            <CommandNames
              of={tokenCommands.value}
              label="commands of the new token"
              onType={(text) => (tokenCommands.value = text)}
            />
          </label>
          <button type="submit" disabled={busy.value}>
            make
          </button>
        </form>
        <table class="tokens-list">
          <tbody>
            {tokens.value.map((each) => (
              <tr key={each.name} data-token={each.name}>
                <td class="audit-who">
                  <b>{each.name}</b>
                </td>
                <td>{each.role}</td>
                <td>{each.owner ? `of ${each.owner}` : ''}</td>
                <td class="audit-of">{each.commands?.join(' ') || ALL_OF_ROLE}</td>
                <td>
                  <Remove
                    what={`token ${each.name}`}
                    words={`void the token ${each.name}`}
                    onRemove={() => void removeToken(each.name)}
                  />
                </td>
              </tr>
            ))}
          </tbody>
        </table>
        <h3>
          Audit{' '}
          <label class="audit-after">
            before{' '}
            <input
              value={auditBefore.value}
              inputMode="numeric"
              placeholder="number"
              aria-label="audit before number"
              onInput={(event) => (auditBefore.value = event.currentTarget.value.replace(/\D/g, ''))}
              onChange={() => void refreshUsers()}
            />
          </label>{' '}
          <button
            type="button"
            data-testid="audit-older"
            disabled={!(Number(audit.value.at(-1)?.entry) > 1)}
            onClick={() => lookAtAudit(audit.value.at(-1)?.entry ?? '')}
          >
            older
          </button>{' '}
          <button
            type="button"
            data-testid="audit-newest"
            disabled={auditBefore.value === ''}
            onClick={() => lookAtAudit('')}
          >
            newest
          </button>
        </h3>
        <table class="audit" data-testid="audit">
          <thead>
            <tr>
              <th class="number">number</th>
              <th>at</th>
              <th>who</th>
              <th>from</th>
              <th>did</th>
              <th>what</th>
              <th>outcome</th>
            </tr>
          </thead>
          <tbody>
            {audit.value.map((row) => (
              <tr key={row.entry} title={`hash ${row.hash}`}>
                <td class="number">{row.entry}</td>
                <td>{row.at}</td>
                <td class="audit-who">{row.who}</td>
                <td>{row.from}</td>
                <td>{row.action}</td>
                <td class="audit-of">{row.detail}</td>
                <td class="audit-of audit-outcome">{row.outcome}</td>
              </tr>
            ))}
          </tbody>
        </table>
      </div>
    </div>
  );
}
