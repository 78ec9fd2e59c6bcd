// Frames of the interface as matrices of three.js.

import { Matrix4, Object3D, Quaternion, Vector3 } from 'three';
import type { Frame } from '../api/types.js';
import { poseOf, type Pose } from '../kinematics/pose.js';

const kOne = new Vector3(1, 1, 1);

export function matrixOf(pose: Pose): Matrix4 {
    return new Matrix4().compose(new Vector3(...pose.translation), new Quaternion(...pose.rotation), kOne);
}

/** Puts an object at a pose in its parent's frame. */
export function place(object: Object3D, pose: Pose): void {
    object.position.set(...pose.translation);
    object.quaternion.set(...pose.rotation);
}

export function placeFrame(object: Object3D, frame: Frame): void {
    place(object, poseOf(frame));
}
