// SPDX-License-Identifier: Apache-2.0
// The name of the person at this browser: the account, without accounts the name that they give. Commands, alarms,
// notes, procedures and positions share it.
import { access } from '../access/model';
import { uplink } from './line';

/** The name with which this browser's acts are signed; '': whoever acts has to give one. */
export const myName = (): string => (access.value.state === 'in' ? access.value.user : uplink.value.controller.trim());

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
