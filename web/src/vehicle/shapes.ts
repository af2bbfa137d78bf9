// SPDX-License-Identifier: Apache-2.0
// The vehicle's parts as simple shapes, built in code, in B. Each part is made once and shown, hidden or hollow.
import { TYPE } from '../design/type';
import {
  AdditiveBlending,
  BoxGeometry,
  BufferGeometry,
  CanvasTexture,
  Color,
  ConeGeometry,
  CylinderGeometry,
  DoubleSide,
  Float32BufferAttribute,
  Group,
  LatheGeometry,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshBasicMaterial,
  MeshStandardMaterial,
  NormalBlending,
  SRGBColorSpace,
  SphereGeometry,
  Sprite,
  SpriteMaterial,
  TorusGeometry,
  Vector2,
  Vector3,
} from 'three';
import type { Material, Object3D } from 'three';
import {
  BACKSHELL_PROFILE,
  CRUISE_STAGE,
  ENGINE_AZIMUTHS,
  PARACHUTE,
  ROVER,
  STAGE,
  heatshieldProfile,
} from './geometry';
import type { Presence } from './model';

const matt = (colour: string, roughness = 0.75, metalness = 0.1) =>
  new MeshStandardMaterial({ color: colour, roughness, metalness, side: DoubleSide });
const SHELL = matt('#c9c3b6');
const SHIELD = matt('#7d6f62', 0.85);
const METAL = matt('#9aa3ad', 0.4, 0.6);
const DARK = matt('#3a414a', 0.6, 0.3);
const GOLD = matt('#b59a5b', 0.45, 0.5);
const PANEL = matt('#26364f', 0.35, 0.4);
const WHITE = matt('#e9e7e2', 0.6);
const CLOTH = matt('#f1eeea', 0.9, 0);
const CLOTH_DARK = matt('#8fa0b3', 0.9, 0);
const MASS = matt('#5d6a78', 0.35, 0.7);

/** A surface of revolution about z. */
function turned(profile: readonly (readonly [number, number])[], material: Material, segments = 64): Mesh {
  const geometry = new LatheGeometry(
    profile.map(([r, z]) => new Vector2(r, z)),
    segments,
  );
  geometry.rotateX(Math.PI / 2);
  geometry.computeVertexNormals();
  return new Mesh(geometry, material);
}
function placed<T extends Object3D>(of: T, x: number, y: number, z: number): T {
  of.position.set(x, y, z);
  return of;
}
/** Cylinders and cones are made along y; here they stand along z. */
function along_z(geometry: BufferGeometry): BufferGeometry {
  return geometry.rotateX(Math.PI / 2);
}
function rod(from: Vector3, to: Vector3, radius: number, material: Material): Mesh {
  const way = to.clone().sub(from);
  const mesh = new Mesh(new CylinderGeometry(radius, radius, way.length(), 8), material);
  mesh.position.copy(from).addScaledVector(way, 0.5);
  mesh.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), way.normalize());
  return mesh;
}
const at = (azimuth: number, radius: number, z: number) =>
  new Vector3(radius * Math.cos(azimuth), radius * Math.sin(azimuth), z);

function aeroshellMasses(count: number, azimuths: readonly number[], radius: number, z: number): Group[] {
  return Array.from({ length: count }, (_, i) => {
    const pair = new Group();
    const each = azimuths.length / count;
    for (const azimuth of azimuths.slice(i * each, (i + 1) * each)) {
      const mass = new Mesh(along_z(new CylinderGeometry(0.13, 0.13, 0.34, 16)), MASS);
      mass.position.copy(at(azimuth, radius, z));
      pair.add(mass);
    }
    return pair;
  });
}

function heatshield(): Group {
  const group = new Group();
  group.add(turned(heatshieldProfile(), SHIELD));
  const rim = new Mesh(new TorusGeometry(2.2, 0.035, 10, 96), DARK);
  group.add(placed(rim, 0, 0, 0.62));
  return group;
}
function backshell(): Group {
  const group = new Group();
  group.add(turned(BACKSHELL_PROFILE, SHELL));
  for (const [radius, z] of [
    [1.73, -0.5],
    [1.16, -1.15],
  ] as const)
    group.add(placed(new Mesh(new TorusGeometry(radius, 0.025, 8, 96), METAL), 0, 0, z));
  for (let i = 0; i < 4; ++i) {
    const azimuth = ((45 + 90 * i) * Math.PI) / 180; // thrusters at flight's mounts: two at each of four diagonals
    const pod = new Mesh(new BoxGeometry(0.34, 0.5, 0.18), DARK);
    pod.position.copy(at(azimuth, 1.5, -0.8));
    pod.rotation.z = azimuth;
    group.add(pod);
  }
  return group;
}
function cruiseStage(): Group {
  const { radius, z, height } = CRUISE_STAGE;
  const group = new Group();
  group.add(placed(new Mesh(along_z(new CylinderGeometry(radius * 0.55, radius * 0.55, height, 48)), METAL), 0, 0, z));
  for (let i = 0; i < 6; ++i) {
    const from = (i * Math.PI) / 3 + 0.06;
    const geometry = along_z(new CylinderGeometry(radius, radius, 0.05, 12, 1, false, from, Math.PI / 3 - 0.12));
    group.add(placed(new Mesh(geometry, PANEL), 0, 0, z - 0.1));
  }
  group.add(placed(new Mesh(along_z(new CylinderGeometry(0.5, 0.3, 0.5, 32)), WHITE), 0, 0, z - 0.45));
  for (let i = 0; i < 8; ++i) {
    const radiator = new Mesh(new BoxGeometry(0.05, 0.9, 0.42), WHITE);
    const azimuth = (i * Math.PI) / 4;
    radiator.position.copy(at(azimuth, radius * 0.62, z + 0.28));
    radiator.rotation.z = azimuth;
    group.add(radiator);
  }
  return group;
}

function parachute(): Group {
  const { lines, radius, dome, gap, band } = PARACHUTE;
  const group = new Group();
  const gores = 24;
  const skirt = -1.6 - lines;
  const cone = (r1: number, z1: number, r2: number, z2: number, i: number, steps: number) => {
    const corners: number[] = [];
    const normals: number[] = [];
    for (let k = 0; k < steps; ++k) {
      const [a, b] = [((i + k / steps) * 2 * Math.PI) / gores, ((i + (k + 1) / steps) * 2 * Math.PI) / gores];
      const [p, q, s, t] = [at(a, r1, z1), at(b, r1, z1), at(a, r2, z2), at(b, r2, z2)];
      for (const v of [p, q, s, q, t, s]) {
        corners.push(v.x, v.y, v.z);
        const outward = new Vector3(v.x, v.y, -0.6 * radius).normalize();
        normals.push(outward.x, outward.y, outward.z);
      }
    }
    return [corners, normals] as const;
  };
  for (let i = 0; i < gores; ++i) {
    const corners: number[] = [];
    const normals: number[] = [];
    const add = ([c, n]: readonly [number[], number[]]) => {
      corners.push(...c);
      normals.push(...n);
    };
    const top = skirt - band - gap;
    for (let k = 0; k < 8; ++k) {
      const [a, b] = [0.12 + (0.88 * k) / 8, 0.12 + (0.88 * (k + 1)) / 8]; // the vent at the top stays open
      const z = (part: number) => top - dome * (1 - part * part);
      add(cone(radius * a, z(a), radius * b, z(b), i, 3));
    }
    add(cone(radius, skirt - band, radius * 0.985, skirt, i, 3));
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new Float32BufferAttribute(corners, 3));
    geometry.setAttribute('normal', new Float32BufferAttribute(normals, 3));
    group.add(new Mesh(geometry, i % 6 < 2 ? CLOTH_DARK : CLOTH));
  }
  const ends: number[] = [];
  for (let i = 0; i < gores; ++i) {
    const skirtAt = at((i * 2 * Math.PI) / gores, radius * 0.985, skirt);
    const upper = at((i * 2 * Math.PI) / gores, radius, skirt - band);
    const dome0 = at((i * 2 * Math.PI) / gores, radius, skirt - band - gap);
    ends.push(0, 0, -5, skirtAt.x, skirtAt.y, skirtAt.z);
    ends.push(upper.x, upper.y, upper.z, dome0.x, dome0.y, dome0.z);
  }
  for (let i = 0; i < 3; ++i) {
    const foot = at((i * 2 * Math.PI) / 3, 0.8, -1.5);
    ends.push(0, 0, -5, foot.x, foot.y, foot.z);
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new Float32BufferAttribute(ends, 3));
  group.add(new LineSegments(geometry, new LineBasicMaterial({ color: '#cfd6de', transparent: true, opacity: 0.55 })));
  return group;
}

function descentStage(): Group {
  const group = new Group();
  const { radius, z } = STAGE;
  const corners = Array.from({ length: 4 }, (_, i) => at(((45 + 90 * i) * Math.PI) / 180, radius, z));
  for (let i = 0; i < 4; ++i) {
    const [a, b] = [corners[i] as Vector3, corners[(i + 1) % 4] as Vector3];
    group.add(rod(a, b, 0.06, METAL));
    group.add(rod(a, new Vector3(0, 0, z - 0.25), 0.05, METAL));
    group.add(rod(a, new Vector3(a.x * 0.35, a.y * 0.35, z + 0.35), 0.045, METAL));
  }
  group.add(placed(new Mesh(along_z(new CylinderGeometry(0.6, 0.7, 0.5, 8)), DARK), 0, 0, z));
  for (let i = 0; i < 3; ++i) {
    const tank = new Mesh(new SphereGeometry(0.38, 32, 20), GOLD);
    tank.position.copy(at((i * 2 * Math.PI) / 3 + 0.4, 0.95, z - 0.12));
    group.add(tank);
  }
  for (const azimuth of ENGINE_AZIMUTHS) {
    const nozzle = new Mesh(along_z(new CylinderGeometry(0.06, 0.17, 0.4, 20, 1, true)), DARK);
    nozzle.position.copy(at(azimuth, radius + 0.05, z + 0.3));
    group.add(nozzle);
  }
  const radar = new Mesh(new BoxGeometry(0.5, 0.4, 0.25), WHITE);
  group.add(placed(radar, 1.25, 0, z + 0.15));
  return group;
}

/** `unfolded`: its wheels, which come down on the bridle. */
function rover(): { group: Group; wheels: Group } {
  const group = new Group();
  group.add(placed(new Mesh(new BoxGeometry(1.7, 1.25, 0.42), WHITE), 0, 0, -0.15));
  group.add(placed(new Mesh(new BoxGeometry(1.76, 1.31, 0.06), GOLD), 0, 0, -0.38));
  const power = new Mesh(along_z(new CylinderGeometry(0.22, 0.22, 0.7, 12)), DARK);
  power.rotation.y = 0.9;
  group.add(placed(power, -1.1, 0, -0.25));
  group.add(rod(new Vector3(0.75, 0.45, -0.42), new Vector3(-0.2, 0.45, -0.42), 0.05, METAL)); // mast, folded
  group.add(placed(new Mesh(new BoxGeometry(0.22, 0.4, 0.18), WHITE), -0.25, 0.45, -0.45));
  const wheels = new Group();
  for (const side of [-1, 1]) {
    const y = side * 0.98;
    const hubs = [1.05, -0.05, -1.1].map((x) => new Vector3(x, y, 0.42));
    for (const hub of hubs) {
      const wheel = new Mesh(new CylinderGeometry(0.25, 0.25, 0.38, 28), DARK);
      wheel.position.copy(hub);
      wheels.add(wheel);
      const rim = new Mesh(new TorusGeometry(0.25, 0.02, 8, 32), METAL);
      rim.rotation.x = Math.PI / 2;
      rim.position.copy(hub).setY(y + side * 0.19);
      wheels.add(rim);
    }
    const pivot = new Vector3(0.1, side * 0.72, -0.05);
    const bogie = new Vector3(-0.55, y * 0.92, 0.15);
    wheels.add(rod(pivot, hubs[0] as Vector3, 0.045, METAL));
    wheels.add(rod(pivot, bogie, 0.045, METAL));
    wheels.add(rod(bogie, hubs[1] as Vector3, 0.04, METAL));
    wheels.add(rod(bogie, hubs[2] as Vector3, 0.04, METAL));
  }
  group.add(wheels);
  return { group, wheels };
}

/** A flame: a cone that fades from the nozzle to its tip. */
function plume(): Mesh {
  const geometry = along_z(new ConeGeometry(0.2, 1, 20, 1, true));
  geometry.rotateX(Math.PI); // the tip towards +z
  geometry.translate(0, 0, 0.5);
  const z = geometry.getAttribute('position');
  const colours: number[] = [];
  for (let i = 0; i < z.count; ++i) colours.push(0.55, 0.76, 1, z.getZ(i) < 0.5 ? 0.45 : 0);
  geometry.setAttribute('color', new Float32BufferAttribute(colours, 4));
  return new Mesh(
    geometry,
    new MeshBasicMaterial({
      vertexColors: true,
      transparent: true,
      depthWrite: false,
      side: DoubleSide,
      blending: AdditiveBlending,
    }),
  );
}

/** An arrow with its name, from the vehicle's centre along +x of its own group. */
class Arrow {
  readonly group = new Group();
  private readonly material = new MeshBasicMaterial();
  private readonly shaft = new Mesh(new CylinderGeometry(0.0035, 0.0035, 1, 8), this.material);
  private readonly head = new Mesh(new ConeGeometry(0.013, 0.04, 16), this.material);
  private readonly sprite = new Sprite(new SpriteMaterial({ depthTest: false, transparent: true }));
  private written = '';
  constructor(private readonly words: string) {
    this.shaft.rotation.z = -Math.PI / 2;
    this.head.rotation.z = -Math.PI / 2;
    this.group.add(this.shaft, this.head, this.sprite);
  }
  useColour(colour: string, font: string): void {
    this.material.color.set(colour);
    if (this.written === colour) return;
    this.written = colour;
    const canvas = new OffscreenCanvas(256, 48);
    const context = canvas.getContext('2d');
    if (!context) return;
    context.font = `600 ${TYPE.matter}px ${font}`;
    context.textBaseline = 'middle';
    context.fillStyle = colour;
    context.fillText(this.words, 4, 24);
    this.sprite.material.map?.dispose();
    this.sprite.material.map = new CanvasTexture(canvas);
    this.sprite.material.map.colorSpace = SRGBColorSpace;
    this.sprite.material.needsUpdate = true;
  }
  /**
   * Along a direction in the picture, as long as this part of a view so tall; shaft and name keep their size on the
   * screen.
   */
  point(direction: Vector3, part: number, tall: number, screenRight: Vector3): void {
    this.group.quaternion.setFromUnitVectors(new Vector3(1, 0, 0), direction);
    this.group.scale.setScalar(tall);
    this.shaft.scale.set(1, part, 1);
    this.shaft.position.x = part / 2;
    this.head.position.x = part;
    this.sprite.position.x = part + 0.035;
    this.sprite.scale.set(0.21, 0.0394, 1);
    this.sprite.center.set(direction.dot(screenRight) < -0.2 ? 0.42 : 0, 0.5);
  }
}

/** Makes a part hollow, drawn by its edges only, and back. */
function setHollow(part: Object3D, hollow: boolean): void {
  part.traverse((each) => {
    if (!(each instanceof Mesh)) return;
    each.userData.solid ??= each.material;
    const kept = each.userData.solid as Material;
    each.material = hollow ? HOLLOW : kept;
  });
}
const HOLLOW = new MeshBasicMaterial({ color: '#8fa3b8', wireframe: true, transparent: true, opacity: 0.22 });

export class Vehicle {
  readonly group = new Group();
  readonly velocity = new Arrow('velocity');
  readonly lift = new Arrow('lift');
  readonly parts = {
    cruiseStage: cruiseStage(),
    heatshield: heatshield(),
    backshell: backshell(),
    parachute: parachute(),
    descentStage: descentStage(),
  };
  readonly cruiseMasses = aeroshellMasses(2, [Math.PI * 0.92, Math.PI * 1.08], 1.95, 0.05);
  readonly entryMasses = aeroshellMasses(3, [-0.42, -0.28, -0.1, 0.1, 0.28, 0.42], 1.95, 0.05);
  private readonly rover = rover();
  private readonly plumes = ENGINE_AZIMUTHS.map((azimuth) => {
    const flame = plume();
    flame.position.copy(at(azimuth, STAGE.radius + 0.05, STAGE.z + 0.48));
    return flame;
  });
  private readonly bridle = new LineSegments(
    new BufferGeometry(),
    new LineBasicMaterial({ color: '#dfe5ec', transparent: true, opacity: 0.9 }),
  );

  constructor() {
    this.group.add(...Object.values(this.parts), ...this.cruiseMasses, ...this.entryMasses, this.rover.group);
    this.group.add(...this.plumes, this.bridle);
  }

  show(part: Object3D, presence: Presence, hollow: boolean): void {
    part.visible = presence !== 'gone';
    if (part.visible) setHollow(part, hollow || presence === 'unknown');
  }
  showAll(
    parts: { [name in keyof Vehicle['parts']]: Presence } & {
      cruiseMasses: readonly Presence[];
      entryMasses: readonly Presence[];
    },
    hollow: boolean,
  ): void {
    for (const [name, part] of Object.entries(this.parts))
      this.show(part, parts[name as keyof Vehicle['parts']], hollow);
    for (const [i, mass] of this.cruiseMasses.entries()) this.show(mass, parts.cruiseMasses[i] ?? 'gone', hollow);
    for (const [i, mass] of this.entryMasses.entries()) this.show(mass, parts.entryMasses[i] ?? 'gone', hollow);
  }
  showRover(presence: Presence, bridle_m: number | undefined, hollow: boolean): void {
    const out = (bridle_m ?? 0) > 0.05;
    this.show(this.rover.group, bridle_m === undefined ? 'gone' : presence, hollow);
    this.rover.group.position.z = ROVER.stowed_z + (bridle_m ?? 0);
    this.rover.wheels.position.z = out ? 0 : -0.3; // drawn up inside
    this.bridle.visible = this.rover.group.visible && out;
    if (!this.bridle.visible) return;
    const top = ROVER.stowed_z + (bridle_m ?? 0) - 0.4;
    const ends = [0.5, 2.6, 4.7].flatMap((azimuth) => {
      const [a, b] = [at(azimuth, 0.28, STAGE.z + 0.25), at(azimuth, 0.62, top)];
      return [a.x, a.y, a.z, b.x, b.y, b.z];
    });
    this.bridle.geometry.dispose();
    this.bridle.geometry = new BufferGeometry();
    this.bridle.geometry.setAttribute('position', new Float32BufferAttribute(ends, 3));
  }
  showPlumes(throttles: readonly number[] | undefined, light: boolean): void {
    this.plumes.forEach((flame, i) => {
      const throttle = throttles?.[i] ?? 0;
      flame.visible = throttle > 0.02; // chosen: less is warm-up, and no flame that could be seen
      flame.scale.set(0.7 + 0.7 * throttle, 0.7 + 0.7 * throttle, 0.6 + 4.2 * throttle);
      const material = flame.material as MeshBasicMaterial;
      material.blending = light ? NormalBlending : AdditiveBlending;
      material.color = new Color(light ? '#5b8fd0' : '#ffffff');
    });
  }
}
