// SPDX-License-Identifier: Apache-2.0
// The states of things on the screen: one shape, one colour and one word each, the same in every panel.

export const STATUS = {
  good: { shape: '●', token: 'good', word: 'good' },
  holds: { shape: '✓', token: 'good', word: 'holds' },
  caution: { shape: '▲', token: 'caution', word: 'watch' },
  missing: { shape: '□', token: 'caution', word: 'is missing' },
  alarm: { shape: '⬢', token: 'alarm', word: 'alarm' },
  failed: { shape: '✖', token: 'alarm', word: 'failed' },
  quiet: { shape: '◇', token: 'caution', word: 'silent' },
  stale: { shape: '◌', token: 'dim', word: 'stale' },
  unknown: { shape: '?', token: 'dim', word: 'not known' },
  next: { shape: '▷', token: 'accent', word: 'awaited' },
  unasked: { shape: '…', token: 'dim', word: 'not asked for yet' },
  never: { shape: '·', token: 'dim', word: 'not received' },
} as const;
export type Status = keyof typeof STATUS;

/** Look of a condition: holds, does not hold, or not known. */
export const held = (holds: boolean | undefined): Status =>
  holds === undefined ? 'unknown' : holds ? 'holds' : 'missing';

/** Look of a link or of the connection. down: silent for a named reason; lost: it should be there. */
export const LINK_STATUS = { up: 'good', down: 'quiet', lost: 'failed', unknown: 'unknown' } as const satisfies Record<
  string,
  Status
>;
export type LinkLook = keyof typeof LINK_STATUS;
/** By the ground's word on a link: whether it is up, and whether a silence is one that nothing explains. */
export const linkLook = ({ up, lost }: { up: boolean; lost: boolean }): LinkLook =>
  up ? 'up' : lost ? 'lost' : 'down';

/** Look of a silence: that of its link at the time. */
export const silenceStatus = ({ lost }: { lost: boolean }) => STATUS[LINK_STATUS[linkLook({ up: false, lost })]];

/** Look of a stage of a command. A stage without evidence has no shape, and none is green by default. */
export const STAGE_LOOKS = {
  ok: { shape: '✓', word: 'seen' },
  failed: { shape: '✖', word: 'failed' },
  unknown: { shape: '?', word: 'not known' },
  pending: { shape: '…', word: 'due' },
  absent: { shape: '–', word: 'there is none' },
  none: { shape: '', word: 'nothing known' },
} as const;
export type StageLook = keyof typeof STAGE_LOOKS;

/** Verdict on a live packet or tone against the recording. */
export const VERDICTS = {
  differs: { status: 'failed', words: 'differs', means: 'live and recording have other octets for the same packet' },
  missing_in_recording: {
    status: 'failed',
    words: 'missing in recording',
    means: 'came live; the complete recording does not have it',
  },
  not_decoded: { status: 'caution', words: 'not decoded', means: 'arrived, and no packet of the dictionary fits it' },
  never_seen_live: { status: 'unknown', words: 'never seen live', means: 'known from the recording only' },
  pending: { status: 'missing', words: 'pending', means: 'the recording is not complete yet' },
  made_on_ground: { status: 'quiet', words: 'made on ground', means: 'no vehicle sent it' },
  identical: { status: 'holds', words: 'identical', means: 'live and recording have the same octets' },
} as const satisfies Record<string, { status: Status; words: string; means: string }>;
export type Verdict = keyof typeof VERDICTS;

/** How something became known. */
export const SOURCES = {
  plan: { shape: '○', token: 'dim', word: 'plan' },
  tone: { shape: '■', token: 'by-tone', word: 'by tone' },
  uhf: { shape: '◆', token: 'by-uhf', word: 'by telemetry, live' },
  recording: { shape: '▣', token: 'by-recording', word: 'by recording' },
} as const;
/** What is expected: dashed and faint wherever it is drawn. */
export const PREDICTED = { shape: '┄', token: 'dim', word: 'predicted' } as const;
