// SPDX-License-Identifier: Apache-2.0
// A canvas that fills its box, sharp on every screen. The loop redraws it when its key has changed.
import { useLayoutEffect, useRef } from 'preact/hooks';
import { onDraw } from './loop';
import { palette } from './palette';
import type { Palette } from './palette';

export interface Surface {
  context: CanvasRenderingContext2D;
  width: number;
  height: number;
  colours: Palette;
}

/** The magnification of the page on a wall. Mouse events are in screen pixels, the layout in page pixels. */
export const grownBy = (element: Element): number =>
  (element as Element & { currentCSSZoom?: number }).currentCSSZoom ?? 1;
/** Screen pixels per page pixel. */
const sharpness = (element: Element): number => (window.devicePixelRatio || 1) * grownBy(element);

interface Properties {
  /** Changes whenever the drawing would change. */
  keyOf: () => string;
  draw: (surface: Surface) => void;
  /** Description of the picture for people who cannot see it. */
  label: string;
  testId?: string;
  onPoint?: (x: number, y: number, width: number, height: number) => void;
  /** Position of the mouse over it; undefined after it has left. */
  onHover?: (x: number | undefined, width: number) => void;
  onWheel?: (x: number, width: number, delta: number) => void;
}

export function Canvas({ keyOf, draw, label, testId, onPoint, onHover, onWheel }: Properties) {
  const element = useRef<HTMLCanvasElement>(null);
  const current = useRef({ keyOf, draw });
  current.current = { keyOf, draw };

  useLayoutEffect(() => {
    const canvas = element.current;
    const context = canvas?.getContext('2d');
    if (!canvas || !context) return undefined;
    let shown = '';
    return onDraw(() => {
      const width = canvas.clientWidth;
      const height = canvas.clientHeight;
      if (width === 0 || height === 0) return undefined;
      const ratio = sharpness(canvas);
      const colours = palette();
      const key = `${width}×${height}×${ratio} ${colours.name} ${current.current.keyOf()}`;
      if (key === shown) return undefined;
      shown = key;
      return () => {
        if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
          canvas.width = Math.round(width * ratio);
          canvas.height = Math.round(height * ratio);
        }
        context.setTransform(ratio, 0, 0, ratio, 0, 0);
        context.clearRect(0, 0, width, height);
        current.current.draw({ context, width, height, colours });
      };
    });
  }, []);

  const at = (event: MouseEvent): [number, number, number, number] => {
    const canvas = event.currentTarget as HTMLCanvasElement;
    const [box, grown] = [canvas.getBoundingClientRect(), grownBy(canvas)];
    return [
      (event.clientX - box.left) / grown,
      (event.clientY - box.top) / grown,
      box.width / grown,
      box.height / grown,
    ];
  };
  return (
    <canvas
      ref={element}
      role="img"
      aria-label={label}
      data-testid={testId}
      onClick={onPoint && ((event) => onPoint(...at(event)))}
      onMouseMove={
        onHover &&
        ((event) => {
          const [x, , width] = at(event);
          onHover(x, width);
        })
      }
      onMouseLeave={onHover && (() => onHover(undefined, 0))}
      onWheel={
        onWheel &&
        ((event) => {
          event.preventDefault();
          const [x, , width] = at(event);
          onWheel(x, width, event.deltaY);
        })
      }
    />
  );
}
