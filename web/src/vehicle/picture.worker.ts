// SPDX-License-Identifier: Apache-2.0
// Draws the vehicle in three dimensions, away from the page's own thread. It draws when there is something new, eases
// from one received state to the next (telemetry comes twice a second), and rests otherwise.
import {
  DirectionalLight,
  HemisphereLight,
  PerspectiveCamera,
  Quaternion,
  Scene,
  Vector2,
  Vector3,
  WebGLRenderer,
} from 'three';
import { RAISED, VIEWS, wheelsBelow_m } from './geometry';
import { Ground, RADIUS_M } from './ground';
import type { FromPicture, ToPicture } from './messages';
import { Vehicle } from './shapes';

type Wanted = Extract<ToPicture, { type: 'scene' }>;

const EASE_S = 0.22; // chosen: the picture follows within half a second, and does not jump
const FRAME_MS = 33;
const FRAME_EARLY_MS = 4; // frames are not exact to the millisecond
const SOFTWARE_FRAME_MS = 120; // chosen: without a graphics processor a frame costs the processors that all else needs
const FIELD_DEG = 32;

const say = (message: FromPicture) => self.postMessage(message);

class Picture {
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(FIELD_DEG, 1, 0.5, 2000);
  private readonly ground = new Ground();
  private readonly vehicle = new Vehicle();
  private readonly sky = new HemisphereLight('#ffffff', '#7a5a48', 1.5);
  private readonly sun = new DirectionalLight('#fff4e6', 2.4);
  private readonly attitude = new Quaternion();
  private readonly velocity = new Vector3();
  private readonly lift = new Vector3();
  private readonly over = new Vector2();
  private view = { tall: 0, below: 0 };
  private altitude_m = 0;
  private bridle_m = 0;
  private throttles: number[] = [];
  private heading = 0;
  private size = { width: 0, height: 0, ratio: 1 };
  private wanted: Wanted | undefined;
  private fresh = true;
  private last_ms = 0;
  private going = false;

  constructor(
    private readonly renderer: WebGLRenderer,
    private readonly every_ms: number,
  ) {
    this.sun.position.set(-4, 9, 7);
    this.scene.add(this.ground.mesh, this.vehicle.group, this.sky, this.sun);
    this.scene.add(this.vehicle.velocity.group, this.vehicle.lift.group);
  }

  resize(size: { width: number; height: number; ratio: number }): void {
    this.size = size;
    this.renderer.setPixelRatio(size.ratio);
    this.renderer.setSize(size.width, size.height, false);
    this.camera.aspect = size.width / Math.max(1, size.height);
    this.camera.updateProjectionMatrix();
    this.begin();
  }

  show(wanted: Wanted): void {
    const before = this.wanted;
    this.wanted = wanted;
    if (before?.colours.light !== wanted.colours.light || !before) {
      this.ground.useTheme(wanted.colours.light);
      this.vehicle.velocity.useColour(wanted.colours.accent, wanted.colours.sans);
      this.vehicle.lift.useColour(wanted.colours.text, wanted.colours.sans);
    }
    this.begin();
  }

  /** The browser calls when it can show another frame, so that a slow one never has frames waiting. */
  private begin(): void {
    if (this.going) return;
    this.going = true;
    requestAnimationFrame((now_ms) => this.frame(now_ms));
  }
  private frame(now_ms: number): void {
    this.going = false;
    if (now_ms - this.last_ms < this.every_ms - FRAME_EARLY_MS || this.draw()) this.begin();
  }

  /** Returns whether the picture still moves towards what is wanted. */
  private draw(): boolean {
    const { wanted } = this;
    if (!wanted || this.size.width === 0) return false;
    const now_ms = performance.now();
    const since_s = Math.min(0.25, (now_ms - this.last_ms) / 1000);
    this.last_ms = now_ms;
    const part = this.fresh || wanted.calm ? 1 : 1 - Math.exp(-since_s / EASE_S);
    this.fresh = false;
    const moves = this.ease(part);
    this.compose();
    this.renderer.render(this.scene, this.camera);
    return moves;
  }

  private ease(part: number): boolean {
    const { scene } = this.wanted as Wanted;
    const { motion } = scene;
    const view = VIEWS[scene.scenery];
    let left = 0;
    const near = (from: number, to: number, size: number): number => {
      left = Math.max(left, Math.abs(to - from) / size);
      return from + (to - from) * part;
    };
    this.view.tall = near(this.view.tall || view.tall, view.tall, view.tall);
    this.view.below = near(this.view.below, view.below, view.tall);
    const altitude = motion.altitude_m ?? 0;
    this.altitude_m = near(this.altitude_m, altitude, Math.max(3, altitude));
    this.bridle_m = near(this.bridle_m, scene.bridle_m ?? 0, 1);
    this.throttles = (scene.throttles ?? []).map((to, i) => near(this.throttles[i] ?? to, to, 1));
    const turn = Math.atan2(Math.sin(scene.heading - this.heading), Math.cos(scene.heading - this.heading));
    this.heading += turn * part;
    left = Math.max(left, Math.abs(turn));
    const [w, x, y, z] = motion.attitude ?? UPRIGHT;
    const to = new Quaternion(x, y, z, w);
    left = Math.max(left, this.attitude.angleTo(to));
    this.attitude.slerp(to, part);
    for (const [from, wanted] of [
      [this.velocity, motion.velocity],
      [this.lift, motion.lift],
    ] as const) {
      if (!wanted) continue;
      const direction = new Vector3(...wanted).normalize();
      if (from.lengthSq() === 0) from.copy(direction);
      left = Math.max(left, from.distanceTo(direction));
      from.lerp(direction, part).normalize();
    }
    if (motion.over) {
      const place = new Vector2(motion.over.east_m, -motion.over.north_m);
      if (this.over.distanceTo(place) > 20000) this.over.copy(place);
      left = Math.max(left, this.over.distanceTo(place) / Math.max(5, altitude));
      this.over.lerp(place, part);
    }
    return left > 0.002;
  }

  private compose(): void {
    const { scene, colours } = this.wanted as Wanted;
    const { vehicle, camera, ground } = this;
    const { parts, motion, scenery } = scene;
    const known = motion.attitude !== undefined;
    vehicle.group.quaternion.copy(this.attitude);
    vehicle.showAll(
      {
        ...parts,
        descentStage: parts.backshell === 'there' && parts.heatshield === 'there' ? 'gone' : parts.descentStage,
      },
      !known,
    );
    const inside = parts.backshell === 'there' && parts.heatshield !== 'gone';
    vehicle.showRover(inside ? 'gone' : parts.rover, scene.bridle_m === undefined ? undefined : this.bridle_m, !known);
    vehicle.showPlumes(this.throttles, colours.light);

    // The view looks across the approach: the vehicle flies to the right.
    const axis = new Vector3(0, 0, 1).applyQuaternion(this.attitude);
    const middle = axis.multiplyScalar(this.view.below);
    const distance = this.view.tall / 2 / Math.tan((FIELD_DEG * Math.PI) / 360);
    // What is taller than the picture's shape allows is seen from farther away.
    const far = scenery === 'parachute' ? distance : distance * Math.max(1, 0.95 / camera.aspect);
    const ahead = new Vector3(Math.sin(this.heading), 0, -Math.cos(this.heading));
    const side = new Vector3().crossVectors(ahead, new Vector3(0, 1, 0));
    // From high up the horizon is far below: the view follows it, so that it stays in sight.
    const dip = Math.acos(RADIUS_M / (RADIUS_M + Math.max(0, this.altitude_m)));
    const raised = 0.1 + 0.9 * Math.tan(dip);
    const from = side
      .clone()
      .addScaledVector(ahead, scenery === 'entry' ? 0.5 : 0.18)
      .setY(raised)
      .normalize();
    const wheels_m = this.bridle_m > 0.5 ? wheelsBelow_m(this.bridle_m) : 0;
    // Height is of the vehicle's centre and off by a metre or two at the end: the wheels are never drawn below the ground.
    const height_m = Math.max(this.altitude_m, wheels_m);
    camera.position.copy(middle).addScaledVector(from, far);
    camera.position.y = Math.max(camera.position.y, 0.6 - height_m);
    camera.lookAt(middle);
    camera.updateMatrixWorld();
    const { width, height } = this.size;
    camera.setViewOffset(width, height, 0, RAISED * height, width, height);

    const [right, up, forward] = [new Vector3(), new Vector3(), new Vector3()];
    camera.matrixWorld.extractBasis(right, up, forward);
    for (const [arrow, direction] of [
      [vehicle.velocity, motion.velocity && this.velocity],
      [vehicle.lift, scenery === 'entry' ? motion.lift && this.lift : undefined],
    ] as const) {
      arrow.group.visible = direction !== undefined && known;
      if (direction) arrow.point(direction, VIEWS[scenery].arrow, this.view.tall, right);
    }

    ground.vector<Vector3>('right').copy(right);
    ground.vector<Vector3>('up').copy(up);
    ground.vector<Vector3>('forward').copy(forward).negate();
    const reach = Math.tan((FIELD_DEG * Math.PI) / 360);
    ground.vector<Vector2>('reach').set(reach * camera.aspect, reach);
    ground.vector<Vector2>('over').set(this.over.x + camera.position.x, this.over.y + camera.position.z);
    ground.vector<Vector2>('foot').set(-camera.position.x, -camera.position.z);
    ground.set('raised', 2 * RAISED);
    ground.set('height', height_m + camera.position.y);
    ground.set('shown', motion.altitude_m === undefined || !known ? 0 : 1);
    this.sky.intensity = colours.light ? 2.1 : 1.25;
  }
}

/** Nose down, for want of an attitude: q_SB of z down. */
const UPRIGHT = [Math.SQRT1_2, Math.SQRT1_2, 0, 0] as const;

let picture: Picture | undefined;

function begin(canvas: OffscreenCanvas): void {
  try {
    if (!new OffscreenCanvas(1, 1).getContext('webgl2')) throw new Error('the browser gives no WebGL');
    const renderer = new WebGLRenderer({ canvas, antialias: true, powerPreference: 'low-power' });
    const gl = renderer.getContext();
    const told = gl.getExtension('WEBGL_debug_renderer_info');
    const name = String(gl.getParameter(told ? told.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
    const software = /swiftshader|llvmpipe|software/i.test(name);
    picture = new Picture(renderer, software ? SOFTWARE_FRAME_MS : FRAME_MS);
    say({ type: 'drawn', renderer: name, software });
  } catch (error) {
    say({ type: 'none', why: error instanceof Error ? error.message : String(error) });
  }
}

self.onmessage = ({ data }: MessageEvent<ToPicture>) => {
  if (data.type === 'canvas') begin(data.canvas);
  else if (data.type === 'size') picture?.resize(data);
  else picture?.show(data);
};
