// SPDX-License-Identifier: Apache-2.0
// What the room asks of the person at this browser, for the banner: it follows the stream, also while the panel of
// procedures is not shown.
import { computed } from '@preact/signals';
import { mayAct } from '../access/model';
import { myName } from '../commands/signature';
import { STATUS } from '../design/status';
import { positionWords } from '../procedures/position';
import { takesActs } from '../run/shown';
import { focusPanel } from '../shortcuts/model';
import { DIRECTOR, boardNow, mySeats } from './model';

/** A sentence; undefined: nothing is asked. A poll comes before a position that is offered. */
export const askedHere = computed<string | undefined>(() => {
  if (!takesActs() || !mayAct()) return undefined;
  const { poll, seats = [] } = boardNow.value ?? {};
  if (poll && !poll.decision) {
    const open = poll.answers.filter(({ answered }) => !answered).map(({ position }) => position);
    const mine = open.find((position) => mySeats.value.includes(position));
    if (mine) return `${positionWords(mine)}, go or no go: “${poll.subject}”?`;
    if (open.length === 0 && mySeats.value.includes(DIRECTOR))
      return `${positionWords(DIRECTOR)}, all have answered: “${poll.subject}”?`;
  }
  const offer = seats.find(({ offered_to }) => offered_to !== '' && offered_to === myName());
  return offer && `${offer.by} offers you ${positionWords(offer.position)}`;
});

/** It leads to where the answer is given, and answers nothing itself. */
export function AskedHere() {
  if (askedHere.value === undefined) return null;
  return (
    <strong class="asked-here" data-testid="asked-here">
      <span role="alert">
        {STATUS.next.shape} {askedHere.value}
      </span>
      <button type="button" onClick={() => focusPanel('procedures')}>
        answer <kbd>8</kbd>
      </button>
    </strong>
  );
}
