// SPDX-License-Identifier: Apache-2.0
// Messages between the panel and the worker that draws in three dimensions.
import type { Scene } from './model';

/** Colours of the style sheet, "#rrggbb"; `light`: of the light theme. */
export interface Colours {
  light: boolean;
  text: string;
  dim: string;
  accent: string;
  panel: string;
  sans: string;
}

export type ToPicture =
  | { type: 'canvas'; canvas: OffscreenCanvas }
  | { type: 'size'; width: number; height: number; ratio: number }
  | { type: 'scene'; scene: Scene; colours: Colours; calm: boolean }; // calm: the reader wants no motion of the view

/** `none`: nothing can be drawn in three dimensions here, and why. */
export type FromPicture = { type: 'drawn'; renderer: string; software: boolean } | { type: 'none'; why: string };
