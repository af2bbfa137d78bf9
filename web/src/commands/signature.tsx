// SPDX-License-Identifier: Apache-2.0
// The controller's name, needed on a server without accounts. Commands, alarms and notes share it.
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
