// Whether a URDF is of an arm: its turning joints must lie on the same lines in space. Pure.

import type { Arm, Vector3 } from '../api/types.js';
import { distance, kIdentity, multiply, poseOf, rotate, turnAbout, type Pose } from '../kinematics/pose.js';

export interface UrdfJoint {
    name: string;
    type: string;
    parent: string;
    child: string;
    origin: Pose;
    axis: Vector3;
}

/** A turning joint and the fixed ones behind it; the first group is what stands still. */
export type JointGroup = readonly UrdfJoint[];

/** Largest distance of the axes' lines of which they still are the same [m]. */
const kSame = 0.02;

function isTurning(joint: UrdfJoint): boolean {
    return joint.type === 'revolute' || joint.type === 'continuous';
}

/** The longest way down from the root: grippers' fingers branch off behind it. */
function longestWay(joints: readonly UrdfJoint[], link: string): UrdfJoint[] {
    const ways = joints.filter((joint) => joint.parent === link).map((joint) => [joint, ...longestWay(joints, joint.child)]);
    return ways.sort((a, b) => b.filter(isTurning).length - a.filter(isTurning).length)[0] ?? [];
}

/** The file's chain, a group for the base and one for each axis. Throws where the file has fewer turning joints. */
export function groupsOf(joints: readonly UrdfJoint[], axes: number): JointGroup[] {
    const children = new Set(joints.map((joint) => joint.child));
    const root = joints.find((joint) => !children.has(joint.parent))?.parent ?? '';
    const groups: UrdfJoint[][] = [[]];
    for (const joint of longestWay(joints, root)) {
        if (isTurning(joint) && groups.length > axes) break;
        if (isTurning(joint)) groups.push([]);
        (groups.at(-1) as UrdfJoint[]).push(joint);
    }
    if (groups.length !== axes + 1) throw new Error(`${groups.length - 1} turning joints, the arm has ${axes}`);
    return groups;
}

interface Line {
    at: Vector3;
    along: Vector3;
}

function armLines(arm: Pick<Arm, 'joints'>): Line[] {
    let pose = kIdentity;
    return arm.joints.map((joint) => {
        pose = multiply(pose, poseOf(joint.origin));
        return { at: pose.translation, along: rotate(pose.rotation, joint.axis) };
    });
}

function urdfLines(groups: readonly JointGroup[], base: Pose): Line[] {
    let pose = base;
    return groups.flatMap((group, i) => group.flatMap((joint, k) => {
        pose = multiply(pose, joint.origin);
        return i > 0 && k === 0 ? [{ at: pose.translation, along: rotate(pose.rotation, joint.axis) }] : [];
    }));
}

/** How far apart two lines are, as the distance of a point of one from the other, and of a point 1 m along. */
function apart(a: Line, b: Line): number {
    const away = (point: Vector3): number => {
        const d: Vector3 = [point[0] - b.at[0], point[1] - b.at[1], point[2] - b.at[2]];
        const along = d[0] * b.along[0] + d[1] * b.along[1] + d[2] * b.along[2];
        return distance(d, [b.along[0] * along, b.along[1] * along, b.along[2] * along]);
    };
    return Math.max(away(a.at), away([a.at[0] + a.along[0], a.at[1] + a.along[1], a.at[2] + a.along[2]]));
}

/**
 * arm_base_from_file: how the file's root is turned about z against the arm's base. All joints at 0 in both.
 * Throws where the axes do not lie on the same lines.
 */
export function standOf(arm: Pick<Arm, 'joints'>, groups: readonly JointGroup[]): Pose {
    const lines = armLines(arm);
    let best = { pose: kIdentity, worst: Infinity };
    for (const quarter of [0, 1, 2, 3]) {
        const pose: Pose = { translation: [0, 0, 0], rotation: turnAbout([0, 0, 1], (quarter * Math.PI) / 2) };
        const worst = Math.max(...urdfLines(groups, pose).map((line, i) => apart(line, lines[i] as Line)));
        if (worst < best.worst) best = { pose, worst };
    }
    if (best.worst > kSame) throw new Error(`an axis is ${best.worst.toFixed(3)} m off the arm's`);
    return best.pose;
}
