// What is drawn of a clip: net, bullets, target, chaser and line, set to the frame that is shown.

import * as THREE from "three";
import { Places, Tensions, unpack } from "dcone/bytes";
import { Lines } from "dcone/lines";

const SLACK = [0.62, 0.68, 0.75, 0.5];
const HELD = [0.79, 0.63, 0.37, 0.9];
const CORD = [0.9, 0.6, 0.85, 1];
const COLOURS = { target: 0xc9a15f, chaser: 0x6fb1e8, bullet: 0xf0f0f0, edge: 0x2a2115 };

/** A place or direction of ours, (radial, along, cross), in the page's axes. */
const turned = ([radial, along, cross]) => new THREE.Vector3(along, radial, -cross);

/** A closed surface of flat faces, each a polygon of corners in body axes (radial, along, cross at no turn). */
function solid({ corners, faces }) {
  const place = (n) => turned(corners[n]);
  const points = [], edges = [];
  for (const face of faces) {
    const around = face.map(place);
    for (let i = 1; i + 1 < around.length; i++) points.push(around[0], around[i], around[i + 1]);
    around.forEach((point, i) => edges.push(point, around[(i + 1) % around.length]));
  }
  const shape = new THREE.BufferGeometry().setFromPoints(points);
  shape.computeVertexNormals();
  const material = new THREE.MeshLambertMaterial({ color: COLOURS.target, side: THREE.DoubleSide, transparent: true, opacity: 0.72, flatShading: true });
  const made = new THREE.Group();
  made.add(new THREE.Mesh(shape, material));
  made.add(new THREE.LineSegments(new THREE.BufferGeometry().setFromPoints(edges), new THREE.LineBasicMaterial({ color: COLOURS.edge })));
  return made;
}

const ball = (radius, color) => new THREE.Mesh(new THREE.SphereGeometry(radius, 20, 14), new THREE.MeshLambertMaterial({ color }));

/** A body whose part swings: the faces at rest, and those of the part about their hinge. */
class Hinged {
  constructor({ corners, faces }, swing) {
    const [rest, part] = [false, true].map((side) => faces.filter((face) => swing.corners[face[0]] === side));
    [this.hinge, this.axis, this.lag] = [swing.hinge, swing.axis, swing.lag].map(turned);
    [this.rest, this.part] = [rest, part].map((some) => solid({ corners, faces: some }));
    this.object = new THREE.Group().add(this.rest, this.part);
  }

  /** At an angle [rad]; the body's own place is that of the common centre of mass, which the part takes along. */
  at(angle) {
    this.part.quaternion.setFromAxisAngle(this.axis, angle);
    const shift = this.lag.clone().applyQuaternion(this.part.quaternion).sub(this.lag);
    this.rest.position.copy(shift).negate();
    this.part.position.copy(this.hinge).applyQuaternion(this.part.quaternion).negate().add(this.hinge).sub(shift);
  }
}

/** Of a chaser that would be too small to be seen, over the radius of a ball. */
const LARGER = 2.5;

export class Bodies {
  constructor(clip, colours, scene) {
    this.clip = clip;
    this.times = unpack(clip.times);
    this.chaser = new Places(clip.chaser);
    for (const name of ["target", "line", "bullets"]) this[name] = clip[name] ? new Places(clip[name]) : null;
    this.attitude = clip.attitude ? unpack(clip.attitude.values ?? clip.attitude) : null;
    this.angle = clip.angle ? unpack(clip.angle.values ?? clip.angle) : null;
    this.tension = clip.tension ? new Tensions(clip.tension) : null;
    this.box = clip.box ?? this.bounds();
    const size = 0.012 * this.reach();
    this.ship = new THREE.Mesh(new THREE.BoxGeometry(1.4, 1.1, 1.1), new THREE.MeshLambertMaterial({ color: COLOURS.chaser }));
    this.ship.scale.setScalar(Math.max(1, LARGER * size));
    scene.add(this.ship);
    if (this.target) {
      this.swing = clip.surface && clip.swing ? new Hinged(clip.surface, clip.swing) : null;
      this.body = this.swing?.object ?? (clip.surface ? solid(clip.surface) : ball(2.2 * size, COLOURS.target));
      if (clip.forces) this.press(clip.forces, colours.image.data);
      scene.add(this.body);
    }
    this.shots = this.bullets ? Array.from({ length: this.bullets.count }, () => ball(size, COLOURS.bullet)) : [];
    this.shots.forEach((one) => scene.add(one));
    if (this.line) {
      this.tether = new Lines(1, colours, [0.75, 0.8, 0.86, 0.8], [1.2, 4]);
      scene.add(this.tether.object);
      if (this.target && clip.held) {
        this.held = new Lines(1, colours, HELD, [1.4, 1.4]);
        scene.add(this.held.object);
      }
    }
    if (clip.net) this.hang(clip.net, colours, scene);
    this.ribbons = [this.tether, this.held, this.threads, this.rim].filter(Boolean);
  }

  hang(net, colours, scene) {
    this.nodes = new Places(net.nodes);
    this.ends = unpack(net.threads);
    this.tensions = net.tensions ? new Tensions(net.tensions) : null;
    this.threads = new Lines(this.ends.length / 2, colours, this.tensions ? SLACK : [0.55, 0.75, 0.95, 0.9], [0.55, 2.6]);
    scene.add(this.threads.object);
    if (net.rim.length) {
      this.mouth = net.rim;
      this.rim = new Lines(net.rim.length - 1, colours, CORD, [1.3, 1.3]);
      scene.add(this.rim.object);
    }
  }

  /** Cells on the body, each in the colour of the largest force that it bore. */
  press(forces, colours) {
    const places = new Places(forces.places), peaks = new Tensions(forces.peaks), count = forces.places.shape[0];
    const side = forces.size, shape = new THREE.BoxGeometry(side, side, side);
    this.cells = new THREE.InstancedMesh(shape, new THREE.MeshBasicMaterial({ transparent: true, opacity: 0.9 }), count);
    const here = new THREE.Matrix4(), colour = new THREE.Color();
    for (let i = 0; i < count; i++) {
      const at = 4 * Math.round(255 * Math.max(Bodies.tone(peaks.code(i)), 0));
      here.makeTranslation(places.told(i, 0, 1), places.told(i, 0, 0), -places.told(i, 0, 2));
      this.cells.setMatrixAt(i, here);
      this.cells.setColorAt(i, colour.setRGB(colours[at] / 255, colours[at + 1] / 255, colours[at + 2] / 255, THREE.SRGBColorSpace));
    }
    this.body.add(this.cells);
  }

  /** Everything that is ever shown lies in it; `far` are places of chaser and target. */
  bounds() {
    const box = new THREE.Box3(), point = new THREE.Vector3();
    const parts = [this.chaser, this.target, this.line, this.bullets, this.clip.net ? new Places(this.clip.net.nodes) : null].filter(Boolean);
    const every = Math.max(1, Math.floor(this.times.length / 60));
    this.far = [];
    for (const part of parts) {
      for (let frame = 0; frame < this.times.length; frame += every) {
        const points = part.at(frame);
        for (let i = 0; i < part.count; i++) box.expandByPoint(point.fromArray(points, 3 * i));
        if (part === this.chaser || part === this.target) this.far.push(point.clone());
      }
    }
    if (this.clip.surface) {
      const far = Math.max(...this.clip.surface.corners.map((corner) => Math.hypot(...corner)));
      const middle = new THREE.Vector3().fromArray(this.target.at(0));
      box.union(new THREE.Box3().setFromCenterAndSize(middle, new THREE.Vector3(2 * far, 2 * far, 2 * far)));
    }
    return box;
  }

  reach() {
    return 0.5 * this.box.getSize(new THREE.Vector3()).length();
  }

  /** Tone of a code: 0 to 1 on the scale, -1 for slack. */
  static tone(code) {
    return code === 0 ? -1 : (code - 1) / 254;
  }

  show(frame) {
    this.ship.position.fromArray(this.chaser.at(frame));
    if (this.target) this.body.position.fromArray(this.target.at(frame));
    if (this.attitude) {
      const [w, a, b, c] = this.attitude.subarray(4 * frame, 4 * frame + 4);
      this.body.quaternion.set(b, a, -c, w);
    }
    if (this.swing && this.angle) this.swing.at(this.angle[frame]);
    const shots = this.bullets?.at(frame);
    this.shots.forEach((one, i) => one.position.fromArray(shots, 3 * i));
    if (this.tether) {
      const ends = [...this.chaser.at(frame), ...this.line.at(frame)];
      this.tether.put(0, ends, 0, 1, this.tension ? Bodies.tone(this.tension.code(frame)) : -1);
      this.tether.done();
      this.held?.put(0, [...this.line.at(frame), ...this.target.at(frame)], 0, 1, -1);
      this.held?.done();
    }
    if (this.threads) {
      const points = this.nodes.at(frame);
      for (let i = 0; i < this.threads.count; i++) this.threads.put(i, points, this.ends[2 * i], this.ends[2 * i + 1], this.tensions ? Bodies.tone(this.tensions.code(frame, i)) : -1);
      this.threads.done();
      for (let i = 0; this.rim && i < this.rim.count; i++) this.rim.put(i, points, this.mouth[i], this.mouth[i + 1], -1);
      this.rim?.done();
    }
  }

  /** Tautest thread of a frame [N], and how many are taut; null where tensions are not known. */
  told(frame) {
    const of = this.tensions ?? this.tension;
    if (!of) return null;
    let most = 0, taut = 0;
    for (let i = 0; i < of.count; i++) {
      const code = of.code(frame, i);
      most = Math.max(most, code);
      taut += code > 0 ? 1 : 0;
    }
    return { most: of.newtons(most), taut, count: of.count };
  }
}
