// Lines in space as ribbons of some pixels: tension is told by colour and by width, so that neither is needed alone.

import * as THREE from "three";

const VERTEX = `
attribute vec3 begin; attribute vec3 end; attribute float tone;
uniform vec2 size; uniform vec2 widths;
varying float shade;
void main() {
  vec4 a = projectionMatrix * modelViewMatrix * vec4(begin, 1.0);
  vec4 b = projectionMatrix * modelViewMatrix * vec4(end, 1.0);
  a.w = max(a.w, 1e-3); b.w = max(b.w, 1e-3);
  vec2 way = (b.xy / b.w - a.xy / a.w) * size;
  way = length(way) > 1e-6 ? normalize(way) : vec2(1.0, 0.0);
  float width = tone < 0.0 ? widths.x : mix(widths.x + 0.6, widths.y, tone);
  vec4 here = mix(a, b, position.x);
  here.xy += vec2(-way.y, way.x) * position.y * width / size * here.w;
  shade = tone;
  gl_Position = here;
}`;
const FRAGMENT = `
uniform sampler2D colours; uniform vec4 slack;
varying float shade;
void main() { gl_FragColor = shade < 0.0 ? slack : vec4(texture2D(colours, vec2(clamp(shade, 0.002, 0.998), 0.5)).rgb, 1.0); }`;

export class Lines {
  /** So many of them; `colours` is a texture, `slack` what has no tone [r, g, b, opacity], `widths` of slack and of the tautest [px]. */
  constructor(count, colours, slack, widths) {
    this.count = count;
    const shape = new THREE.InstancedBufferGeometry();
    shape.setAttribute("position", new THREE.Float32BufferAttribute([0, -1, 0, 1, -1, 0, 1, 1, 0, 0, -1, 0, 1, 1, 0, 0, 1, 0], 3));
    shape.instanceCount = count;
    this.begin = new THREE.InstancedBufferAttribute(new Float32Array(3 * count), 3);
    this.end = new THREE.InstancedBufferAttribute(new Float32Array(3 * count), 3);
    this.tone = new THREE.InstancedBufferAttribute(new Float32Array(count).fill(-1), 1);
    shape.setAttribute("begin", this.begin);
    shape.setAttribute("end", this.end);
    shape.setAttribute("tone", this.tone);
    this.size = new THREE.Vector2(1, 1);
    const uniforms = { size: { value: this.size }, widths: { value: new THREE.Vector2(...widths) }, colours: { value: colours }, slack: { value: new THREE.Vector4(...slack) } };
    const material = new THREE.ShaderMaterial({ vertexShader: VERTEX, fragmentShader: FRAGMENT, uniforms, transparent: true, side: THREE.DoubleSide });
    this.object = new THREE.Mesh(shape, material);
    this.object.frustumCulled = false;
  }

  /** Line `i` from point a to point b of a flat array, with a tone from 0 to 1, or -1 for slack. */
  put(i, points, a, b, tone) {
    for (let axis = 0; axis < 3; axis++) {
      this.begin.array[3 * i + axis] = points[3 * a + axis];
      this.end.array[3 * i + axis] = points[3 * b + axis];
    }
    this.tone.array[i] = tone;
  }

  done() {
    this.begin.needsUpdate = this.end.needsUpdate = this.tone.needsUpdate = true;
  }
}

/** The colours of tensions as a texture, from 256 triples of 0 to 255. */
export function texture(colours) {
  const data = new Uint8Array(4 * 256);
  for (let i = 0; i < 256; i++) data.set([...colours.slice(3 * i, 3 * i + 3), 255], 4 * i);
  const made = new THREE.DataTexture(data, 256, 1);
  made.minFilter = made.magFilter = THREE.LinearFilter;
  made.needsUpdate = true;
  return made;
}
