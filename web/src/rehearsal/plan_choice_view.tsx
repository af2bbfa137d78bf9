// SPDX-License-Identifier: Apache-2.0
// The choice of a plan in the form that starts a rehearsal, for who may instruct.
import { useEffect } from 'preact/hooks';
import {
  NONE,
  OWN,
  askPlans,
  choice,
  chosenEntry,
  offerProblem,
  offered,
  ownPlan,
  takeFile,
  writtenFor,
} from './plan_choice';

function OwnFile() {
  const own = ownPlan.value;
  return (
    <>
      <label class="file-choice">
        choose a file
        <input
          type="file"
          accept=".yaml,.yml"
          data-testid="plan-file"
          onChange={(event) => {
            void takeFile(event.currentTarget.files?.[0]);
            event.currentTarget.value = ''; // the same file, corrected, is a choice as well
          }}
        />
      </label>
      {own && 'name' in own && (
        <span role="status" data-testid="plan-file-name">
          {own.name}
        </span>
      )}
    </>
  );
}

export function PlanChoice({ scenario }: { scenario: string }) {
  useEffect(() => void askPlans(), []);
  const entry = chosenEntry();
  const other = entry && writtenFor(entry, scenario);
  return (
    <>
      <label class="plan-choice">
        plan{' '}
        <select
          value={choice.value}
          data-testid="plan-choice"
          onChange={(event) => (choice.value = event.currentTarget.value)}
        >
          <option value={NONE}>none</option>
          {offered.value.map((each) => {
            const mark = writtenFor(each, scenario);
            return (
              <option key={each.name} value={each.name}>
                {each.title || each.name}
                {mark && ` (${mark})`}
              </option>
            );
          })}
          <option value={OWN}>a file of your own</option>
        </select>
      </label>
      {choice.value === OWN && <OwnFile />}
      {entry && (
        <span class="plan-chosen" data-testid="plan-chosen">
          {entry.title || entry.name}: {entry.purpose} {entry.injects} inject{entry.injects === 1 ? '' : 's'}
          {other && <span class="status-caution"> ▲ {other}</span>}
        </span>
      )}
      {offerProblem.value && (
        <span class="status-alarm" role="status" data-testid="plan-problem">
          ✖ plans: {offerProblem.value}
        </span>
      )}
    </>
  );
}
