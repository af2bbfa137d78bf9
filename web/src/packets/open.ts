// SPDX-License-Identifier: Apache-2.0
// What of the packets is opened from elsewhere: one packet with a field lit, or those of one name.
import { signal } from '@preact/signals';
import type { PacketRow } from '../gen/aeolis/v1/run_pb';
import { focusPanel } from '../shortcuts/model';

/** The wish for the panel, which takes it when it is shown. */
export const wish = signal<{ name: string; row?: PacketRow; field?: string } | undefined>(undefined);

export function openPackets(name: string): void {
  wish.value = { name };
  focusPanel('packets');
}

export function openPacket(row: PacketRow, field: string): void {
  wish.value = { name: row.unit?.name ?? '', row, field };
  focusPanel('packets');
}
