// Poses as translation and unit quaternion. Names read target-from-source: base_from_tool = base_from_flange * flange_from_tool.

import type { Frame, Vector3 } from '../api/types.js';

/** x, y, z, w; of length 1. */
export type Quaternion = readonly [number, number, number, number];

export interface Pose {
    readonly translation: Vector3;
    readonly rotation: Quaternion;
}

export const kIdentity: Pose = { translation: [0, 0, 0], rotation: [0, 0, 0, 1] };

export function multiplyRotations(p: Quaternion, q: Quaternion): Quaternion {
    return [
        p[3] * q[0] + p[0] * q[3] + p[1] * q[2] - p[2] * q[1],
        p[3] * q[1] - p[0] * q[2] + p[1] * q[3] + p[2] * q[0],
        p[3] * q[2] + p[0] * q[1] - p[1] * q[0] + p[2] * q[3],
        p[3] * q[3] - p[0] * q[0] - p[1] * q[1] - p[2] * q[2],
    ];
}

export function rotate(q: Quaternion, v: Vector3): Vector3 {
    const [x, y, z, w] = q;
    const tx = 2 * (y * v[2] - z * v[1]);
    const ty = 2 * (z * v[0] - x * v[2]);
    const tz = 2 * (x * v[1] - y * v[0]);
    return [v[0] + w * tx + y * tz - z * ty, v[1] + w * ty + z * tx - x * tz, v[2] + w * tz + x * ty - y * tx];
}

export function multiply(a: Pose, b: Pose): Pose {
    const moved = rotate(a.rotation, b.translation);
    return {
        translation: [a.translation[0] + moved[0], a.translation[1] + moved[1], a.translation[2] + moved[2]],
        rotation: multiplyRotations(a.rotation, b.rotation),
    };
}

export function inverse(pose: Pose): Pose {
    const [x, y, z, w] = pose.rotation;
    const rotation: Quaternion = [-x, -y, -z, w];
    const t = rotate(rotation, pose.translation);
    return { translation: [-t[0], -t[1], -t[2]], rotation };
}

/** `axis` is a unit vector, `angle` in rad. */
export function turnAbout(axis: Vector3, angle: number): Quaternion {
    const s = Math.sin(angle / 2);
    return [axis[0] * s, axis[1] * s, axis[2] * s, Math.cos(angle / 2)];
}

export function poseOf(frame: Frame): Pose {
    const rz = turnAbout([0, 0, 1], frame[5]);
    const ry = turnAbout([0, 1, 0], frame[4]);
    const rx = turnAbout([1, 0, 0], frame[3]);
    return { translation: [frame[0], frame[1], frame[2]], rotation: multiplyRotations(multiplyRotations(rz, ry), rx) };
}

/** The angles with b in [-pi/2, pi/2]; where b is at an end, a is 0. */
export function frameOf(pose: Pose): Frame {
    const [x, y, z, w] = pose.rotation;
    const sine = Math.max(-1, Math.min(1, 2 * (w * y - z * x)));
    const [tx, ty, tz] = pose.translation;
    if (Math.abs(sine) > 1 - 1e-12) {
        const c = -Math.sign(sine) * 2 * Math.atan2(x, w);
        return [tx, ty, tz, 0, Math.sign(sine) * (Math.PI / 2), c];
    }
    const a = Math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y));
    const c = Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z));
    return [tx, ty, tz, a, Math.asin(sine), c];
}

export function distance(a: Vector3, b: Vector3): number {
    return Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}
