// SPDX-License-Identifier: Apache-2.0
// Who is logged in. The log-in itself (log_in.tsx) is loaded when it is wanted.
import { access, logOut, mayAct } from './model';
import './style.css';

/** User and role, in the header. */
export function Who() {
  const now = access.value;
  if (now.state === 'open')
    return (
      <div class="link who-nobody" data-testid="who">
        <b>no accounts</b>
        <small>this machine only</small>
      </div>
    );
  if (now.state !== 'in') return null;
  return (
    <div
      class="link who"
      data-testid="who"
      title={now.rights.length > 0 ? `may: ${now.rights.join(', ')}` : 'may look'}
    >
      <b>{now.user}</b>
      <small>
        {now.role}
        {mayAct(now) ? '' : ', only looks'}{' '}
        <button type="button" class="quiet" data-testid="log-out" onClick={() => void logOut()}>
          log out
        </button>
      </small>
    </div>
  );
}
