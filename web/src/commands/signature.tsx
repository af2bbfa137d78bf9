// SPDX-License-Identifier: Apache-2.0
// Who asks, where the server has no accounts to know it by; one name for commands, alarms and notes.
import { access } from '../access/model';
import { uplink } from './line';

export function Signature() {
  if (access.value.state === 'in') return null;
  return (
    <label>
      by{' '}
      <input
        class="signature"
        data-testid="signature"
        placeholder="your name"
        maxLength={64}
        spellcheck={false}
        value={uplink.value.controller}
        onInput={(event) => (uplink.value = { ...uplink.value, controller: event.currentTarget.value })}
      />
    </label>
  );
}
