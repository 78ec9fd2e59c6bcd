// Poses and chains against vectors that two other implementations agree on.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import type { Frame } from '../src/api/types.js';
import { Chain, currentFrame } from '../src/kinematics/chain.js';
import { frameOf, inverse, kIdentity, multiply, poseOf, type Pose } from '../src/kinematics/pose.js';
import { readArm, type ModelArm } from './fake/model_file.js';
import { inverseKinematics } from './fake/motion.js';
import { kSource } from './fake/places.js';

interface KinematicsVector {
    robot: string;
    q: number[];
    position: number[];
    quaternion_wxyz: number[];
}

/** The vectors of the C++ tests: `{"ur5", JointVector{...}, {...}, {...}}`. */
function vectors(): KinematicsVector[] {
    const text = readFileSync(join(kSource, 'libs/motion/tests/kinematics_vectors.hpp'), 'utf8');
    const rows = [...text.matchAll(/\{"(\w+)",\s*JointVector\{([^}]*)\},\s*\{([^}]*)\},\s*\{([^}]*)\}\}/g)];
    const numbers = (list: string): number[] => list.split(',').map(Number);
    return rows.map(([, robot, q, position, quaternion]) => ({
        robot: robot as string, q: numbers(q as string), position: numbers(position as string), quaternion_wxyz: numbers(quaternion as string),
    }));
}

const kFiles: Record<string, string> = { ur5: 'ur5', ur5e: 'ur5e', iiwa7: 'iiwa7', iiwa14: 'iiwa14', edo: 'edo' };

function arm(robot: string): ModelArm | null {
    const file = kFiles[robot];
    return file === undefined ? null : readArm(join(kSource, `models/${file}.toml`), robot, [0, 0, 0, 0, 0, 0]);
}

function assertNear(actual: Pose, position: readonly number[], wxyz: readonly number[], tolerance: number): void {
    position.forEach((value, i) => assert.ok(Math.abs(value - (actual.translation[i] as number)) < tolerance, `position ${i}: ${actual.translation[i]} not ${value}`));
    const [w, x, y, z] = wxyz as [number, number, number, number];
    const [ax, ay, az, aw] = actual.rotation;
    const dot = Math.abs(w * aw + x * ax + y * ay + z * az);
    assert.ok(1 - dot < tolerance, `rotation: ${actual.rotation.join()} not ${wxyz.join()}`);
}

test('the flange is where two other implementations say', () => {
    const known = vectors().filter((vector) => arm(vector.robot) !== null);
    assert.ok(known.length >= 15, `only ${known.length} vectors were read`);
    for (const vector of known) assertNear(new Chain(arm(vector.robot) as ModelArm).flange(vector.q), vector.position, vector.quaternion_wxyz, 1e-9);
});

test('a frame becomes a pose and the same frame again', () => {
    const frames: Frame[] = [[1, 2, 3, 0.1, -0.7, 2.9], [0, 0, 0, -3, 1.2, -3], [0.4, 0, 0, 0, Math.PI / 2, 0.3], [0, 0, 0, 0, -Math.PI / 2, -0.8]];
    for (const frame of frames) frameOf(poseOf(frame)).forEach((value, i) => assert.ok(Math.abs(value - (frame[i] as number)) < 1e-7, `${frame.join()}: ${i}: ${value}`));
});

test('rotations are about z, then y, then x of the turned frame', () => {
    const pose = poseOf([0, 0, 0, Math.PI / 2, 0, Math.PI / 2]);
    // R = Rz(90) Rx(90): y becomes z, then stays.
    const moved = multiply(pose, { translation: [0, 1, 0], rotation: [0, 0, 0, 1] }).translation;
    moved.forEach((value, i) => assert.ok(Math.abs(value - ([0, 0, 1][i] as number)) < 1e-12));
});

test('a pose and its inverse are nothing', () => {
    const pose = poseOf([0.3, -0.2, 0.9, 0.4, -1.1, 2.2]);
    assertNear(multiply(pose, inverse(pose)), kIdentity.translation, [1, 0, 0, 0], 1e-12);
});

test('the current pose of a tool is behind the flange', () => {
    const ur5 = { ...(arm('ur5') as ModelArm), tools: [{ name: 'jaws', frame: [0, 0, 0.15, 0, 0, 0] as const }] };
    const flange = poseOf(currentFrame(ur5, ur5.home, ''));
    const jaws = poseOf(currentFrame(ur5, ur5.home, 'jaws'));
    assertNear(jaws, multiply(flange, poseOf([0, 0, 0.15, 0, 0, 0])).translation, [flange.rotation[3], flange.rotation[0], flange.rotation[1], flange.rotation[2]], 1e-9);
    // The home position has its tool down.
    assert.ok(jaws.translation[2] < flange.translation[2] - 0.149);
});

test('the fake dashboard reaches what can be reached, and nothing else', () => {
    const iiwa = arm('iiwa7') as ModelArm;
    const home = currentFrame(iiwa, iiwa.home, '');
    const moved = [home[0], home[1] + 0.1, home[2] + 0.05, home[3], home[4], home[5]] as const;
    const joints = inverseKinematics(iiwa, moved, iiwa.home);
    assert.ok(joints !== null);
    assertNear(new Chain(iiwa).flange(joints), moved.slice(0, 3), [poseOf(moved).rotation[3], ...poseOf(moved).rotation.slice(0, 3)], 1e-5);
    assert.equal(inverseKinematics(iiwa, [3, 0, 0.5, 0, 0, 0], iiwa.home), null);
});
