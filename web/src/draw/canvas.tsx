// A canvas that fills its box, sharp on every screen, drawn by the loop when its key has changed.
import { useEffect, useRef } from 'preact/hooks';
import { onDraw } from './loop';
import { palette } from './palette';
import type { Palette } from './palette';

export interface Surface {
  context: CanvasRenderingContext2D;
  width: number;
  height: number;
  colours: Palette;
}

interface Properties {
  /** Changes whenever the drawing would. */
  keyOf: () => string;
  draw: (surface: Surface) => void;
  /** What the picture shows, for those who do not see it. */
  label: string;
  testId?: string;
  onPoint?: (x: number, y: number, width: number, height: number) => void;
  onWheel?: (x: number, width: number, delta: number) => void;
}

export function Canvas({ keyOf, draw, label, testId, onPoint, onWheel }: Properties) {
  const element = useRef<HTMLCanvasElement>(null);
  const current = useRef({ keyOf, draw });
  current.current = { keyOf, draw };

  useEffect(() => {
    const canvas = element.current;
    const context = canvas?.getContext('2d');
    if (!canvas || !context) return undefined;
    let shown = '';
    return onDraw(() => {
      const width = canvas.clientWidth;
      const height = canvas.clientHeight;
      if (width === 0 || height === 0) return;
      const ratio = window.devicePixelRatio || 1;
      const colours = palette();
      const key = `${width}×${height}×${ratio} ${colours.name} ${current.current.keyOf()}`;
      if (key === shown) return;
      shown = key;
      if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
        canvas.width = Math.round(width * ratio);
        canvas.height = Math.round(height * ratio);
      }
      context.setTransform(ratio, 0, 0, ratio, 0, 0);
      context.clearRect(0, 0, width, height);
      context.font = '11px var(--sans, sans-serif)';
      current.current.draw({ context, width, height, colours });
    });
  }, []);

  const at = (event: MouseEvent): [number, number, number, number] => {
    const box = (event.currentTarget as HTMLCanvasElement).getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top, box.width, box.height];
  };
  return (
    <canvas
      ref={element}
      role="img"
      aria-label={label}
      data-testid={testId}
      onClick={onPoint && ((event) => onPoint(...at(event)))}
      onWheel={onWheel && ((event) => {
        event.preventDefault();
        const [x, , width] = at(event);
        onWheel(x, width, event.deltaY);
      })}
    />
  );
}
