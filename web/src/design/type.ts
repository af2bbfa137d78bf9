// SPDX-License-Identifier: Apache-2.0

/** The type scale for pictures, in pixels, as the style sheet's `--t-…` have it; type.spec.ts compares them. */
export const TYPE = { mark: 11, table: 12.5, body: 13.5, value: 15, title: 17, condition: 19, matter: 26 } as const;
