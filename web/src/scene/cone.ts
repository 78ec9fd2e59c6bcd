// Capped cones with rounded edges: what arms are made of.

import { BufferGeometry, LatheGeometry, Matrix4, Quaternion, Vector2, Vector3 } from 'three';
import type { Visual } from '../api/types.js';

const kArcSteps = 3;
const kSegments = 32;

/** Rounding of both edges where the model gives none: a quarter of the smaller radius, 14 mm at most [m]. */
export function defaultEdge(from_radius: number, to_radius: number, length: number): number {
    return Math.min(0.014, 0.28 * Math.min(from_radius, to_radius), 0.45 * length);
}

function arc(points: Vector2[], radius: number, height: number, edge: number, start: number): void {
    for (let i = 0; i <= kArcSteps; ++i) {
        const angle = start + (i / kArcSteps) * (Math.PI / 2);
        points.push(new Vector2(radius - edge + edge * Math.cos(angle), height + edge * Math.sin(angle)));
    }
}

/** Half a section of the cone, from the middle of its foot to the middle of its top; along y [m]. */
export function profile(from_radius: number, to_radius: number, length: number, edge: number): Vector2[] {
    const rounded = Math.min(edge, from_radius, to_radius, length / 2);
    const points = [new Vector2(0, 0)];
    arc(points, from_radius, rounded, rounded, -Math.PI / 2);
    arc(points, to_radius, length - rounded, rounded, 0);
    points.push(new Vector2(0, length));
    return points;
}

/** The cone of a visual primitive, in the frame of its link. */
export function coneGeometry(visual: Visual): BufferGeometry {
    const from = new Vector3(...visual.from);
    const along = new Vector3(...visual.to).sub(from);
    const length = along.length();
    const edge = visual.edge ?? defaultEdge(visual.from_radius, visual.to_radius, length);
    const geometry = new LatheGeometry(profile(visual.from_radius, visual.to_radius, length, edge), kSegments);
    const turn = new Quaternion().setFromUnitVectors(new Vector3(0, 1, 0), along.normalize());
    return geometry.applyMatrix4(new Matrix4().compose(from, turn, new Vector3(1, 1, 1)));
}
