// The states a thing on the screen can be in: one shape, one colour and one word each, the same in every panel.

export const STATUS = {
  good: { shape: '●', token: 'good', word: 'good' },
  holds: { shape: '✓', token: 'good', word: 'holds' },
  caution: { shape: '▲', token: 'caution', word: 'watch' },
  missing: { shape: '○', token: 'caution', word: 'is missing' },
  alarm: { shape: '■', token: 'alarm', word: 'alarm' },
  failed: { shape: '✖', token: 'alarm', word: 'failed' },
  stale: { shape: '◌', token: 'dim', word: 'stale' },
  unknown: { shape: '?', token: 'dim', word: 'not known' },
  never: { shape: '·', token: 'dim', word: 'not received' },
} as const;
export type Status = keyof typeof STATUS;

/** How something became known. */
export const SOURCES = {
  plan: { shape: '○', token: 'dim', word: 'plan' },
  tone: { shape: '■', token: 'by-tone', word: 'by tone' },
  uhf: { shape: '◆', token: 'by-uhf', word: 'by UHF, live' },
  recording: { shape: '●', token: 'by-recording', word: 'by recording' },
} as const;
