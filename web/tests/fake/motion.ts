// Motions of the fake arms: smooth lines in joint space, and a plain numeric inverse.

import type { Frame } from '../../src/api/types.js';
import { Chain } from '../../src/kinematics/chain.js';
import { inverse, multiply, poseOf, type Pose } from '../../src/kinematics/pose.js';
import type { ModelArm } from './model_file.js';

/** A motion through joint positions; each leg takes its time [s]. */
export interface Motion {
    points: number[][];
    times: number[];
}

export function durationOf(motion: Motion): number {
    return motion.times.at(-1) ?? 0;
}

function smooth(share: number): number {
    return share * share * share * (10 - 15 * share + 6 * share * share);
}

export function positionOf(motion: Motion, time: number): number[] {
    let leg = motion.times.findIndex((end) => time < end);
    if (leg < 0) return motion.points.at(-1) as number[];
    leg = Math.max(1, leg);
    const from = motion.points[leg - 1] as number[];
    const to = motion.points[leg] as number[];
    const start = motion.times[leg - 1] as number;
    const share = smooth((time - start) / ((motion.times[leg] as number) - start));
    return from.map((value, i) => value + ((to[i] as number) - value) * share);
}

/** Through all points, each leg as fast as a quarter of the slowest joint's limit allows. */
export function throughPoints(arm: ModelArm, points: number[][]): Motion {
    const times = [0];
    for (let k = 1; k < points.length; ++k) {
        const needed = (points[k] as number[]).map((value, i) => Math.abs(value - ((points[k - 1] as number[])[i] as number)) / ((arm.joints[i]?.velocity ?? 1) * 0.25));
        times.push((times.at(-1) as number) + Math.max(0.4, ...needed));
    }
    return { points, times };
}

function errorOf(target: Pose, actual: Pose): number[] {
    const difference = multiply(inverse(actual), target);
    const sign = difference.rotation[3] < 0 ? -2 : 2;
    return [...difference.translation, ...difference.rotation.slice(0, 3).map((part) => part * sign)];
}

/** Solves A x = b with partial pivoting. */
function solve(a: number[][], b: number[]): number[] {
    const n = b.length;
    const m = a.map((row, i) => [...row, b[i] as number]);
    for (let k = 0; k < n; ++k) {
        const pivot = m.slice(k).reduce((best, row, i) => (Math.abs(row[k] as number) > Math.abs((m[best] as number[])[k] as number) ? i + k : best), k);
        [m[k], m[pivot]] = [m[pivot] as number[], m[k] as number[]];
        for (let i = k + 1; i < n; ++i) {
            const factor = ((m[i] as number[])[k] as number) / ((m[k] as number[])[k] as number);
            for (let j = k; j <= n; ++j) (m[i] as number[])[j] = ((m[i] as number[])[j] as number) - factor * ((m[k] as number[])[j] as number);
        }
    }
    const x = new Array<number>(n).fill(0);
    for (let k = n - 1; k >= 0; --k) {
        const sum = x.reduce((total, value, j) => (j > k ? total + value * ((m[k] as number[])[j] as number) : total), 0);
        x[k] = (((m[k] as number[])[n] as number) - sum) / ((m[k] as number[])[k] as number);
    }
    return x;
}

/** Damped least squares from a seed; null where the pose is out of reach or of the limits. */
export function inverseKinematics(arm: ModelArm, frame: Frame, seed: readonly number[]): number[] | null {
    const chain = new Chain(arm);
    const target = poseOf(frame);
    const q = [...seed];
    for (let round = 0; round < 80; ++round) {
        const error = errorOf(target, chain.flange(q));
        if (Math.hypot(...error) < 1e-6) return q.every((value, i) => value >= (arm.joints[i]?.lower ?? 0) && value <= (arm.joints[i]?.upper ?? 0)) ? q : null;
        const columns = q.map((value, i) => {
            const moved = [...q];
            moved[i] = value + 1e-5;
            return errorOf(target, chain.flange(moved)).map((part, k) => ((error[k] as number) - part) / 1e-5);
        });
        const normal = columns.map((ci, i) => columns.map((cj, j) => ci.reduce((sum, part, k) => sum + part * (cj[k] as number), i === j ? 1e-4 : 0)));
        const step = solve(normal, columns.map((column) => column.reduce((sum, part, k) => sum + part * (error[k] as number), 0)));
        step.forEach((part, i) => (q[i] = (q[i] as number) + Math.max(-0.3, Math.min(0.3, part))));
    }
    return null;
}
