// A camera that goes round a point: drag to turn, Shift and drag to move, wheel or two fingers to come near.

import * as THREE from "three";

const STEEP = Math.PI / 2 - 0.02;

/** How much wider than what is to be in sight the view is. */
const ROOM = 1.12;

export class Camera {
  constructor(stage, changed) {
    this.eye = new THREE.PerspectiveCamera(38, 1, 0.05, 5000);
    this.about = new THREE.Vector3();
    this.changed = changed;
    this.turned = 0.6;
    this.raised = 0.35;
    this.distance = 10;
    this.fingers = new Map();
    stage.addEventListener("pointerdown", (event) => { stage.setPointerCapture(event.pointerId); this.fingers.set(event.pointerId, event); });
    stage.addEventListener("pointermove", (event) => this.drag(event));
    for (const gone of ["pointerup", "pointercancel"]) stage.addEventListener(gone, (event) => this.fingers.delete(event.pointerId));
    stage.addEventListener("wheel", (event) => {
      if (document.activeElement !== stage && !event.ctrlKey) return;
      event.preventDefault();
      this.near(event.deltaY > 0 ? 1.1 : 1 / 1.1);
    }, { passive: false });
  }

  drag(event) {
    const last = this.fingers.get(event.pointerId);
    if (!last) return;
    const x = event.clientX - last.clientX, y = event.clientY - last.clientY;
    if (this.fingers.size === 2) {
      const [other] = [...this.fingers.entries()].filter(([id]) => id !== event.pointerId).map(([, finger]) => finger);
      const gap = (finger) => Math.hypot(finger.clientX - other.clientX, finger.clientY - other.clientY);
      this.near(gap(last) / Math.max(gap(event), 1));
    } else if (event.shiftKey) this.move(x, y);
    else this.turn(-0.007 * x, 0.007 * y);
    this.fingers.set(event.pointerId, event);
  }

  turn(round, up) {
    this.turned += round;
    this.raised = Math.min(STEEP, Math.max(-STEEP, this.raised + up));
    this.changed();
  }

  near(by) {
    this.distance = Math.min(2000, Math.max(0.3, this.distance * by));
    this.changed();
  }

  move(x, y) {
    const size = this.distance * 0.0011;
    const right = new THREE.Vector3().setFromMatrixColumn(this.eye.matrix, 0), up = new THREE.Vector3().setFromMatrixColumn(this.eye.matrix, 1);
    this.about.addScaledVector(right, -x * size).addScaledVector(up, y * size);
    this.changed();
  }

  /** Look from a direction so that what is about `about` is in sight, and all of some points. */
  look(about, reach, turned, raised, points = []) {
    this.about.copy(about);
    Object.assign(this, { turned, raised });
    const open = Math.tan((this.eye.fov * Math.PI) / 360), wide = open * this.eye.aspect;
    const [s, c, S, C] = [Math.sin(turned), Math.cos(turned), Math.sin(raised), Math.cos(raised)];
    const [back, right, up] = [[C * s, S, C * c], [c, 0, -s], [-S * s, C, -S * c]].map((axis) => new THREE.Vector3(...axis));
    this.distance = reach / open / Math.min(1, this.eye.aspect);
    for (const point of points) {
      const from = point.clone().sub(about), aside = Math.max(Math.abs(from.dot(up)) / open, Math.abs(from.dot(right)) / wide);
      this.distance = Math.max(this.distance, from.dot(back) + ROOM * aside);
    }
    this.changed();
  }

  place() {
    const flat = Math.cos(this.raised) * this.distance;
    this.eye.position.set(flat * Math.sin(this.turned), Math.sin(this.raised) * this.distance, flat * Math.cos(this.turned)).add(this.about);
    this.eye.lookAt(this.about);
    this.eye.updateMatrixWorld();
  }
}
