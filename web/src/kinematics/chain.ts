// Forward kinematics of an arm from its chain, as its server publishes it.

import type { Arm, Frame } from '../api/types.js';
import { frameOf, kIdentity, multiply, poseOf, turnAbout, type Pose } from './pose.js';

export interface ChainLike {
    joints: Arm['joints'];
    flange: Frame;
}

/** An arm's chain with its constant parts worked out once. */
export class Chain {
    private readonly origins: Pose[];
    private readonly last_from_flange: Pose;

    constructor(private readonly arm: ChainLike) {
        this.origins = arm.joints.map((joint) => poseOf(joint.origin));
        this.last_from_flange = poseOf(arm.flange);
    }

    get axisCount(): number {
        return this.origins.length;
    }

    /** base_from_flange at a joint position [rad]; missing values count as 0. */
    flange(joint_position: readonly number[]): Pose {
        let pose = kIdentity;
        this.arm.joints.forEach((joint, i) => {
            const turn: Pose = { translation: [0, 0, 0], rotation: turnAbout(joint.axis, joint_position[i] ?? 0) };
            pose = multiply(multiply(pose, this.origins[i] as Pose), turn);
        });
        return multiply(pose, this.last_from_flange);
    }

    /** base_from_tool. */
    tool(joint_position: readonly number[], flange_from_tool: Pose): Pose {
        return multiply(this.flange(joint_position), flange_from_tool);
    }
}

/** The tool frame of that name on an arm's flange; "" and "flange" and unknown names are the flange itself. */
export function toolFrame(arm: Arm, name: string): Pose {
    const tool = arm.tools.find((candidate) => candidate.name === name);
    const frame = tool?.frame ?? null;
    return frame === null ? kIdentity : poseOf(frame);
}

/** The pose of a tool in the base frame as a skill's parameter has it. */
export function currentFrame(arm: Arm, joint_position: readonly number[], tool_name: string): Frame {
    return frameOf(new Chain(arm).tool(joint_position, toolFrame(arm, tool_name)));
}
