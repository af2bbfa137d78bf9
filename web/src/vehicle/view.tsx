// SPDX-License-Identifier: Apache-2.0
// The vehicle as it is known: a picture, the same facts as text, and its path from above.
import { signal } from '@preact/signals';
import { useEffect, useLayoutEffect, useRef } from 'preact/hooks';
import { PREDICTED, STATUS } from '../design/status';
import { Canvas, grownBy } from '../draw/canvas';
import { onDraw } from '../draw/loop';
import { palette } from '../draw/palette';
import { isPredicted, predictedVersion, prediction } from '../prediction/model';
import { isLost } from '../run/connection';
import { asHeard, cutoff, dictionary, pastRange, runNow, shownRun, tick, timepoints } from '../run/shown';
import { fromEntry } from '../run/time';
import { resultShown, touchedDown } from '../touchdown/shown';
import { Touchdown } from '../touchdown/view';
import { drawFlat, drawOutline } from './flat';
import { useHistory } from './history';
import type { FromPicture, ToPicture } from './messages';
import { missingOf, motionOf, pathOf, sceneOf, staleOf, targetOf } from './model';
import type { Look } from './model';
import { ellipseWords, Path } from './path';
import { predictedLook, predictedPath } from './predicted';
import { channelOf, figuresOf, rowsOf } from './rows';
import './style.css';

/** Who draws: 'asking' until the worker has answered. `why`: why it is flat. */
interface Renderer {
  kind: 'asking' | 'space' | 'flat';
  words: string;
  by?: string;
}
const renderer = signal<Renderer>({ kind: 'asking', words: '' });
const KEPT = 'aeolis-vehicle';

function lookNow(run = shownRun()): Look | undefined {
  const words = dictionary.value;
  return run && words && { run, words, plan: timepoints.value, cutoff: cutoff.value, lost: isLost.value };
}
/** Follows the numbers beside it, five times a second. Attitudes come twice a second; what lies between is eased. */
const keyNow = () => {
  const run = shownRun();
  return `${run?.id} ${tick.peek()} ${cutoff.value} ${isLost.value} ${timepoints.value.length} ${asHeard.value}`;
};

function chooseFlat(): void {
  localStorage.setItem(KEPT, 'flat');
  renderer.value = { kind: 'flat', words: 'flat, as chosen' };
}
function chooseSpace(): void {
  localStorage.removeItem(KEPT);
  renderer.value = { kind: 'asking', words: '' };
}

/** The picture in three dimensions, which a worker draws on this canvas. */
function Space() {
  const element = useRef<HTMLCanvasElement>(null);
  useLayoutEffect(() => {
    const canvas = element.current;
    if (!canvas) return undefined;
    if (!('transferControlToOffscreen' in canvas) || typeof Worker === 'undefined') {
      renderer.value = { kind: 'flat', words: 'flat: this browser draws in no worker' };
      return undefined;
    }
    const worker = new Worker(new URL('./picture.worker.ts', import.meta.url), { type: 'module' });
    const post = (message: ToPicture, moved: Transferable[] = []) => worker.postMessage(message, moved);
    worker.onmessage = ({ data }: MessageEvent<FromPicture>) => {
      renderer.value =
        data.type === 'drawn'
          ? { kind: 'space', words: `3-D${data.software ? ', without a graphics processor' : ''}`, by: data.renderer }
          : { kind: 'flat', words: `flat: no 3-D here (${data.why})` };
    };
    worker.onerror = () => (renderer.value = { kind: 'flat', words: 'flat: the worker that draws in 3-D failed' });
    const offscreen = canvas.transferControlToOffscreen();
    post({ type: 'canvas', canvas: offscreen }, [offscreen]);
    let [size, shown] = ['', ''];
    const calm = matchMedia('(prefers-reduced-motion: reduce)');
    const stop = onDraw(() => {
      const [width, height] = [canvas.clientWidth, canvas.clientHeight];
      const ratio = Math.min(2, (window.devicePixelRatio || 1) * grownBy(canvas)); // chosen: finer is not seen
      const colours = palette();
      const [nowSize, now] = [`${width} ${height} ${ratio}`, `${colours.name} ${keyNow()}`];
      if (width === 0 || height === 0 || (size === nowSize && shown === now)) return undefined;
      return () => {
        if (size !== nowSize) post({ type: 'size', width, height, ratio });
        const look = lookNow();
        if (look && shown !== now) {
          const { text, dim, accent, panel, sans } = colours;
          post({
            type: 'scene',
            scene: sceneOf(look),
            colours: { light: colours.name === 'light', text, dim, accent, panel, sans },
            calm: calm.matches,
          });
        }
        [size, shown] = [nowSize, now];
      };
    });
    return () => {
      stop();
      worker.terminate();
    };
  }, []);
  return <canvas ref={element} role="img" aria-label={LABEL} data-testid="vehicle-canvas" />;
}

const LABEL = 'The vehicle from the side of its approach; the same facts stand beside it as text';

function Flat() {
  return (
    <Canvas
      label={LABEL}
      testId="vehicle-flat"
      keyOf={keyNow}
      draw={(surface) => {
        const look = lookNow();
        if (look) drawFlat(surface, sceneOf(look));
      }}
    />
  );
}

const menuOf = (look: Look, name: string): string | undefined => {
  const channel = channelOf(look.words, name);
  return channel && `channel ${channel}`;
};
/** Whether the predicted vehicle is drawn; undefined: while what is told is old. */
const outlineChosen = signal<boolean | undefined>(undefined);
const showsOutline = (look: Look): boolean => outlineChosen.value ?? staleOf(look) !== undefined;
const BESIDE = 0.82; // of the width, where there is a reported vehicle in the middle

/** The predicted vehicle, hollow, over the picture of the reported one. */
function Predicted({ look, part }: { look: Look; part: number }) {
  return (
    <div class="vehicle-predicted">
      <Canvas
        label="The vehicle as it is predicted, hollow"
        testId="vehicle-predicted"
        keyOf={() => `${keyNow()} ${predictedVersion.value} ${look.cutoff} ${part}`}
        draw={(surface) => {
          const scene = sceneOf(look);
          const reported = lookNow();
          if (scene.motion.attitude)
            drawOutline(surface, reported ? { ...scene, heading: sceneOf(reported).heading } : scene, part);
        }}
      />
    </div>
  );
}

function Stage({ look }: { look: Look }) {
  const scene = sceneOf(look);
  const stale = staleOf(look);
  const missing = missingOf(scene);
  const empty = scene.parts.descentStage === 'unknown';
  const predicted = showsOutline(look) ? predictedLook(look) : undefined;
  const expected = predicted && figuresOf(predicted, motionOf(predicted));
  return (
    <div class={`vehicle-stage ${stale ? 'is-old' : ''}`} data-testid="vehicle-stage" data-scenery={scene.scenery}>
      {!empty && (renderer.value.kind === 'flat' ? <Flat /> : <Space />)}
      {predicted && <Predicted look={predicted} part={empty ? 0.5 : BESIDE} />}
      <ul class="vehicle-said" data-testid="vehicle-said">
        {stale && <li>{`${STATUS.stale.shape} as last heard, ${stale.replace(STATUS.stale.shape, '').trim()} ago`}</li>}
        {predicted && (
          <li data-testid="vehicle-predicted-words">
            {PREDICTED.shape} dashed: as predicted for {fromEntry(predicted.cutoff - predicted.run.entrySclk)}
          </li>
        )}
        {missing.map((words) => (
          <li key={words}>
            {STATUS.unknown.shape} {words}
          </li>
        ))}
      </ul>
      <dl class="vehicle-figures" data-testid="vehicle-figures">
        {figuresOf(look, scene.motion).map(({ name, value, unit, note, age }, i) => (
          <div key={name} class={age ? 'old' : ''} data-menu={menuOf(look, name)}>
            <dt>{unit === '' ? name : `${name}, ${unit}`}</dt>
            <dd>
              <output>{value}</output>
              <small>
                {age ?? note}
                {unit !== '' && expected?.[i] && ` predicted ${expected[i].value} ${expected[i].unit}`}
              </small>
            </dd>
          </div>
        ))}
      </dl>
    </div>
  );
}

function Facts({ look }: { look: Look }) {
  const motion = motionOf(look);
  const stale = staleOf(look) !== undefined;
  const expected = predictedLook(look);
  return (
    <div
      class="vehicle-facts table-scroll"
      tabIndex={0}
      role="region"
      aria-label="the same facts as text, and the path"
    >
      <table data-testid="vehicle-rows">
        <tbody>
          {rowsOf(look, motion).map(({ name, text, age }) => (
            <tr key={name} class={age ? 'old' : ''} data-menu={menuOf(look, name)}>
              <th scope="row">{name}</th>
              <td class="wraps">{text}</td>
              <td>{age ?? ''}</td>
            </tr>
          ))}
        </tbody>
      </table>
      <figure>
        <Path
          points={pathOf(look)}
          predicted={expected && predictedPath(look, expected)}
          now={motion.over}
          stale={stale}
          label="Path from above"
          ellipse={prediction.value?.ellipse}
        />
        <figcaption>
          Path over ground by navigation on board. The ground in the picture is smooth: its relief is not known.
          {/* what comes later stands last: it moves nothing */}
          {prediction.value?.ellipse ? ` Around the target: ${ellipseWords(prediction.value.ellipse)}.` : ''}
          {targetOf(look.run) ? '' : ' No target is known: the middle is where it is.'}
        </figcaption>
      </figure>
    </div>
  );
}

export function Vehicle() {
  const run = runNow();
  const look = lookNow(run);
  const sclk = Math.min(look?.run.seenSclk ?? NaN, cutoff.value);
  useHistory(sclk, pastRange.value !== undefined || run?.going === false);
  const box = useRef<HTMLDivElement>(null);
  useEffect(() => {
    if (localStorage.getItem(KEPT) === 'flat') chooseFlat();
  }, []);
  if (!look) return <p class="none">No run yet.</p>;
  const landed = touchedDown();
  const result = landed && resultShown.value;
  return (
    <div class="table-box" ref={box} data-testid="vehicle">
      <div class="table-tools">
        {landed && (
          <button type="button" onClick={() => (resultShown.value = !resultShown.value)} data-testid="vehicle-result">
            {result ? 'the picture' : 'the result'}
          </button>
        )}
        {!result && (
          <button
            type="button"
            onClick={renderer.value.kind === 'flat' ? chooseSpace : chooseFlat}
            data-testid="vehicle-renderer-choice"
          >
            {renderer.value.kind === 'flat' ? 'draw it in 3-D' : 'draw it flat'}
          </button>
        )}
        {!result && (
          <button
            type="button"
            disabled={!isPredicted()}
            aria-pressed={isPredicted() && showsOutline(look)}
            onClick={() => (outlineChosen.value = !showsOutline(look))}
            data-testid="vehicle-outline"
          >
            {PREDICTED.shape} predicted
          </button>
        )}
        <button type="button" onClick={() => void box.current?.requestFullscreen?.().catch(() => undefined)}>
          full screen
        </button>
        {!result && (
          <span data-testid="vehicle-renderer" title={renderer.value.by ?? renderer.value.words}>
            {renderer.value.kind === 'asking' ? 'drawn: not known yet' : renderer.value.words}
          </span>
        )}
      </div>
      {result ? (
        <Touchdown />
      ) : (
        <div class="vehicle">
          <Stage look={look} />
          <Facts look={look} />
        </div>
      )}
    </div>
  );
}
