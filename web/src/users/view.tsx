// Users, tokens and the audit, for administrators.
import { signal } from '@preact/signals';
import { useEffect } from 'preact/hooks';
import { access } from '../access/model';
import { ROLES, addToken, addUser, audit, auditAfter, busy, message, newToken, refreshUsers, removeToken, removeUser, setOwnPassword, setPassword, setRole, tokens, users } from './model';
import './style.css';

const name = signal('');
const password = signal('');
const role = signal<string>('observer');
const tokenName = signal('');
const tokenRole = signal<string>('observer');
/** What is about to be removed: a second press does it. */
const removing = signal('');

function Roles({ of, label, onChoose }: { of: string; label: string; onChoose: (role: string) => void }) {
  return <select aria-label={label} value={of} disabled={busy.value} onChange={(event) => onChoose(event.currentTarget.value)}>{ROLES.map((each) => <option key={each}>{each}</option>)}</select>;
}

function Remove({ what, words, onRemove }: { what: string; words: string; onRemove: () => void }) {
  const sure = removing.value === what;
  return (
    <button type="button" disabled={busy.value} aria-label={sure ? `really ${words}` : words} onBlur={() => (removing.value = '')} onClick={() => {
      removing.value = sure ? '' : what;
      if (sure) onRemove();
    }}>{sure ? 'press again: it is final' : 'remove'}</button>
  );
}

function OwnPassword({ user }: { user: string }) {
  return (
    <form onSubmit={(event) => {
      event.preventDefault();
      const form = event.currentTarget;
      const [current, chosen] = ['current', 'secret'].map((each) => form.elements.namedItem(each) as HTMLInputElement);
      void setOwnPassword(user, current!.value, chosen!.value).then(() => form.reset());
    }}>
      <input name="current" type="password" autocomplete="current-password" aria-label="your password of before" placeholder="of before" required maxLength={128} />{' '}
      <input name="secret" type="password" autocomplete="new-password" aria-label={`new password of ${user}`} placeholder="a new one" required maxLength={128} /> <button type="submit" disabled={busy.value}>set</button>
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
  if (now.state !== 'in') return <p class="none">This server runs without accounts: whoever is on its machine may do everything. docs/operations.md says how to begin with accounts.</p>;
  if (!may) return <p class="none">Users are for administrators; you are {now.user}, {now.role}.</p>;
  return (
    <div class="table-box" data-testid="users">
      {message.value && <p role="status" class={message.value.good ? 'status-good' : 'status-alarm'} data-testid="users-message">{message.value.good ? '✓' : '✖'} {message.value.text}</p>}
      {newToken.value && <p class="new-token" data-testid="new-token">▲ The token of {newToken.value.name}, shown this once: <output>{newToken.value.token}</output></p>}
      <div class="table-scroll" tabIndex={0} role="region" aria-label="users, tokens, audit">
        <form class="table-tools" data-testid="add-user" onSubmit={(event) => {
          event.preventDefault();
          const secret = password.value;
          password.value = '';
          void addUser(name.value.trim(), role.value, secret).then((done) => done && (name.value = ''));
        }}>
          <input aria-label="name of the new user" placeholder="new user" required maxLength={64} spellcheck={false} value={name.value} onInput={(event) => (name.value = event.currentTarget.value)} />
          <input aria-label="password of the new user" type="password" autocomplete="new-password" placeholder="password" required maxLength={1024} value={password.value} onInput={(event) => (password.value = event.currentTarget.value)} />
          <Roles of={role.value} label="role of the new user" onChoose={(each) => (role.value = each)} />
          <button type="submit" disabled={busy.value}>add</button>
        </form>
        <table>
          <thead><tr><th>user</th><th>role</th><th>password</th><th>remove</th></tr></thead>
          <tbody>
            {users.value.map((each) => (
              <tr key={each.user} data-user={each.user}>
                <td><b>{each.user}</b>{each.user === now.user && ' (you)'}</td>
                <td><Roles of={each.role} label={`role of ${each.user}`} onChoose={(chosen) => void setRole(each.user, chosen)} /></td>
                <td>{each.user === now.user ? <OwnPassword user={each.user} /> : (
                  <form onSubmit={(event) => {
                    event.preventDefault();
                    const field = event.currentTarget.elements.namedItem('secret') as HTMLInputElement;
                    const secret = field.value;
                    field.value = '';
                    void setPassword(each.user, secret);
                  }}>
                    <input name="secret" type="password" autocomplete="new-password" aria-label={`new password of ${each.user}`} placeholder="a new one" required maxLength={1024} /> <button type="submit" disabled={busy.value}>set</button>
                  </form>)}
                </td>
                <td>{each.user !== now.user && <Remove what={`user ${each.user}`} words={`remove ${each.user}`} onRemove={() => void removeUser(each.user)} />}</td>
              </tr>
            ))}
          </tbody>
        </table>
        <h3>Tokens of programs</h3>
        <form class="table-tools" data-testid="add-token" onSubmit={(event) => {
          event.preventDefault();
          void addToken(tokenName.value.trim(), tokenRole.value).then((done) => done && (tokenName.value = ''));
        }}>
          <input aria-label="name of the new token" placeholder="new token" required maxLength={64} spellcheck={false} value={tokenName.value} onInput={(event) => (tokenName.value = event.currentTarget.value)} />
          <Roles of={tokenRole.value} label="role of the new token" onChoose={(each) => (tokenRole.value = each)} />
          <button type="submit" disabled={busy.value}>make</button>
        </form>
        <table>
          <tbody>
            {tokens.value.map((each) => (
              <tr key={each.name} data-token={each.name}><td><b>{each.name}</b></td><td>{each.role}</td>
                <td><Remove what={`token ${each.name}`} words={`void the token ${each.name}`} onRemove={() => void removeToken(each.name)} /></td></tr>
            ))}
          </tbody>
        </table>
        <h3>Audit <label class="audit-after">after <input value={auditAfter.value} inputMode="numeric" placeholder="number" aria-label="audit after number" onInput={(event) => (auditAfter.value = event.currentTarget.value.replace(/\D/g, ''))}
          onChange={() => void refreshUsers()} /></label></h3>
        <table data-testid="audit">
          <thead><tr><th class="number">number</th><th>at</th><th>who</th><th>from</th><th>did</th><th>what</th><th>outcome</th></tr></thead>
          <tbody>
            {audit.value.map((row) => (
              <tr key={row.entry} title={`hash ${row.hash}`}><td class="number">{row.entry}</td><td>{row.at}</td><td>{row.who}</td><td>{row.from}</td><td>{row.action}</td><td class="audit-of">{row.detail}</td><td>{row.outcome}</td></tr>
            ))}
          </tbody>
        </table>
      </div>
    </div>
  );
}
