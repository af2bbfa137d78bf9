// SPDX-License-Identifier: Apache-2.0
// Sky and ground behind the vehicle: one triangle over the picture, and for each pixel where its ray meets the globe.
// The ground is smooth, since its relief is not known; its mottles are fixed to it, so that motion is seen, and mean
// nothing. The rings are 10 m, 100 m, 1 km, … from the point below the vehicle.
import { BufferGeometry, Color, Float32BufferAttribute, Mesh, ShaderMaterial, Vector2, Vector3 } from 'three';

export const RADIUS_M = 3391148; // [od137]: the landing radius

const vertexShader = `
varying vec2 at;
void main() { at = position.xy; gl_Position = vec4(position.xy, 1.0, 1.0); }`;

const fragmentShader = `
precision highp float;
varying vec2 at;
uniform vec3 right, up, forward, ground, groundDark, haze, space, ink;
uniform vec2 reach, over, foot;
uniform float height, radius, shown, raised;

float hash(vec2 p) { p = fract(p * vec2(123.34, 345.45)); p += dot(p, p + 34.345); return fract(p.x * p.y); }
float noise(vec2 p) {
  vec2 i = floor(p), f = fract(p);
  f = f * f * (3.0 - 2.0 * f);
  return mix(mix(hash(i), hash(i + vec2(1, 0)), f.x), mix(hash(i + vec2(0, 1)), hash(i + vec2(1, 1)), f.x), f.y);
}
void main() {
  vec3 ray = normalize(forward + at.x * reach.x * right + (at.y - raised) * reach.y * up);
  float b = ray.y * (radius + height), c = height * (2.0 * radius + height);
  float under = b * b - c;
  float thick = exp(-height / 18000.0); // chosen: how much of the air is still above
  float dip = acos(radius / (radius + height));
  float above = asin(clamp(ray.y, -1.0, 1.0)) + dip;
  float wide = mix(0.02, 0.5, thick);
  vec3 sky = mix(space, haze, clamp(exp(-max(above, 0.0) / wide) * mix(0.55, 1.0, thick), 0.0, 1.0));
  vec3 colour = sky;
  if (b < 0.0 && under > 0.0) {
    float t = c / (sqrt(under) - b); // the nearer meeting, written so that it stays exact when the ray is long
    vec2 near = t * ray.xz;
    vec2 place = near + over;
    float pixel = t * reach.y / 300.0 / max(0.05, -ray.y);
    float mottle = 0.0, weight = 0.0, size = 6.0;
    for (int i = 0; i < 7; ++i) {
      float seen = smoothstep(0.5, 0.1, pixel / size) * smoothstep(900.0, 60.0, size / max(pixel, 0.02));
      mottle += seen * (noise(mod(place / size, 4096.0)) - 0.5);
      weight += seen;
      size *= 7.0;
    }
    vec3 soil = mix(ground, groundDark, clamp(0.5 + 0.9 * mottle / max(1.0, weight * 0.7), 0.0, 1.0));
    float away = length(near - foot);
    float ring = 0.0;
    for (float r = 10.0; r < 200000.0; r *= 10.0) {
      float wide_m = max(pixel * 0.9, r * 0.002);
      ring = max(ring, (1.0 - smoothstep(wide_m * 0.5, wide_m * 1.5, abs(away - r))) * smoothstep(0.3, 0.05, pixel * 4.0 / r));
    }
    soil = mix(soil, ink, 0.3 * ring);
    float path = min(t, 11000.0 / max(0.02, -ray.y));
    float veil = 1.0 - exp(-path / mix(90000.0, 26000.0, thick));
    colour = mix(soil, haze, clamp(veil, 0.0, 0.93));
  }
  gl_FragColor = vec4(mix(space, colour, shown), 1.0);
  #include <colorspace_fragment>
}`;

const THEMES = {
  dark: { ground: '#6a4433', groundDark: '#4d3228', haze: '#8a6a55', space: '#0d131c', ink: '#f3e6da' },
  light: { ground: '#c79f84', groundDark: '#b1886e', haze: '#ecdccb', space: '#dfe7f0', ink: '#4a3325' },
};

export class Ground {
  private readonly material = new ShaderMaterial({
    vertexShader,
    fragmentShader,
    depthTest: false,
    depthWrite: false,
    uniforms: {
      right: { value: new Vector3() },
      up: { value: new Vector3() },
      forward: { value: new Vector3() },
      reach: { value: new Vector2() },
      over: { value: new Vector2() },
      foot: { value: new Vector2() },
      height: { value: 0 },
      radius: { value: RADIUS_M },
      shown: { value: 0 },
      raised: { value: 0 },
      ...Object.fromEntries(Object.keys(THEMES.dark).map((name) => [name, { value: new Color() }])),
    },
  });
  readonly mesh: Mesh;

  constructor() {
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new Float32BufferAttribute([-1, -1, 0, 3, -1, 0, -1, 3, 0], 3));
    this.mesh = new Mesh(geometry, this.material);
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = -1;
  }

  set(name: string, value: number): void {
    const uniform = this.material.uniforms[name];
    if (uniform) uniform.value = value;
  }
  vector<T extends Vector2 | Vector3>(name: string): T {
    return this.material.uniforms[name]?.value as T;
  }
  useTheme(light: boolean): void {
    for (const [name, colour] of Object.entries(light ? THEMES.light : THEMES.dark))
      (this.material.uniforms[name]?.value as Color | undefined)?.set(colour);
  }
}
