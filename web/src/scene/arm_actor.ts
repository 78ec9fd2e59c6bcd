// One arm on the stage: itself, its gripper, its tool frame, its trace, and the ghosts of its commanded poses.

import { Group, Vector3, type Object3D } from 'three';
import type { Arm, Frame, Server, Vector3 as Vector } from '../api/types.js';
import { Chain } from '../kinematics/chain.js';
import { kIdentity, multiply, poseOf, type Pose } from '../kinematics/pose.js';
import type { LiveBuffer } from '../state/live_buffer.js';
import { ArmView, GhostView, shapesOf, type Paint } from './arm_view.js';
import { GripperView } from './gripper_view.js';
import { placeFrame } from './place.js';
import { Trace } from './trace.js';
import { triad } from './triad.js';

/** From where on commanded and actual are seen as different [rad]. */
const kApart = 0.02;
/** Opening of a gripper whose largest width is not published [m]. */
const kStroke = 0.11;
const kLargestStroke = 0.3;
/** A part that is held is so near to the jaws [m]. */
const kWithin = 0.06;

export interface Show {
    trace: boolean;
    commanded: boolean;
    frames: boolean;
}

function largestDifference(a: readonly number[], b: readonly number[]): number {
    return a.reduce((most, value, i) => Math.max(most, Math.abs(value - (b[i] ?? value))), 0);
}

/** A server that knows no stroke gives none, or bounds far beyond any gripper. */
function strokeOf(told: number): number {
    return told > 0 && told <= kLargestStroke ? told : kStroke;
}

/** The frame of the first tool besides the flange; null if there is none. */
function firstTool(arm: Arm): Frame | null {
    return arm.tools.find((tool) => tool.name !== 'flange' && tool.frame !== null)?.frame ?? null;
}

/** The jaws of a gripper that is mounted on the arm, or of the arm's own. */
interface Jaws {
    key: string;
    view: GripperView;
}

export class ArmActor {
    readonly root = new Group();
    readonly view: ArmView;
    readonly trace = new Trace(900, 3);
    readonly chain: Chain;
    /** flange_from_tool of what the trace follows. */
    readonly flange_from_tool: Pose;
    private readonly commanded: GhostView;
    private readonly tool_triad: Object3D;
    private readonly base_from_world: Pose;
    private jaws: Jaws | null = null;
    private traced_until = 0;
    private drawn: readonly number[] = [];

    constructor(readonly arm: Arm, private readonly live: LiveBuffer, paint: Paint, servers: readonly Server[]) {
        const shapes = shapesOf(arm);
        this.view = new ArmView(arm, shapes, paint);
        this.commanded = new GhostView(arm, shapes, '#e0a030', 0.3);
        this.commanded.show(null);
        this.chain = new Chain(arm);
        this.base_from_world = poseOf(arm.base);
        const gripper = servers.find((server) => server.gripper?.arm === arm.key);
        const frame = gripper?.gripper?.frame ?? firstTool(arm);
        this.flange_from_tool = frame === null ? kIdentity : poseOf(frame);
        this.tool_triad = triad(0.09);
        if (frame !== null) placeFrame(this.tool_triad, frame);
        this.view.frames.flange.add(this.tool_triad);
        if (gripper?.gripper !== undefined && gripper.gripper !== null) this.mount(gripper.key, gripper.gripper.frame, strokeOf(gripper.gripper.stroke));
        this.root.add(this.view.frames.root, this.commanded.frames.root, this.trace.object);
        this.view.frames.setJoints(arm.joints.map(() => 0));
    }

    /** The tool frame's origin in the world. */
    toolAt(joint_position: readonly number[]): Vector {
        return multiply(this.base_from_world, this.chain.tool(joint_position, this.flange_from_tool)).translation;
    }

    /** Above the arm's foot: where its name is written. */
    labelPoint(): Vector3 {
        return new Vector3(this.arm.base[0], this.arm.base[1], this.arm.base[2] - 0.02);
    }

    /** Draws the arm as it was at `t` (server's clock) [s]. Returns whether anything changed. */
    update(t: number, show: Show): boolean {
        const actual = this.live.arm(this.arm.key).at(t, 'q');
        if (actual === null) return false;
        const moved = largestDifference(actual, this.drawn) > 1e-6 || this.drawn.length === 0;
        if (moved) {
            this.view.frames.setJoints(actual);
            this.drawn = actual;
        }
        const ghost = this.updateCommanded(t, actual, show.commanded);
        this.trace.object.visible = show.trace;
        this.tool_triad.visible = show.frames;
        return this.updateJaws() || moved || ghost;
    }

    /** Takes new samples into the trace. Returns the largest speed among them [m/s]. */
    follow(): number {
        let fastest = 0;
        for (const sample of this.live.arm(this.arm.key).samples) {
            if (sample.t <= this.traced_until || sample.q === undefined) continue;
            this.traced_until = sample.t;
            fastest = Math.max(fastest, this.trace.add(this.toolAt(sample.q), sample.t));
        }
        return fastest;
    }

    private updateCommanded(t: number, actual: readonly number[], wanted: boolean): boolean {
        const commanded = wanted ? this.live.arm(this.arm.key).at(t, 'c') : null;
        const apart = commanded !== null && largestDifference(commanded, actual) > kApart;
        const was = this.commanded.visible;
        this.commanded.show(apart ? commanded : null);
        return apart || was;
    }

    /** Arms whose gripper reports that it holds a part but not how wide it is: the width is that of the nearest part [m]. */
    holdNearest(parts: Iterable<{ object: Object3D; width: number }>): void {
        if (this.jaws === null || this.live.widths.has(this.jaws.key)) return;
        const jaws = this.jaws.view.root.getWorldPosition(new Vector3());
        let nearest = { distance: kWithin, width: this.jaws.view.stroke / 2 };
        for (const { object, width } of this.live.held.get(this.jaws.key) === true ? parts : []) {
            const away = object.position.distanceTo(jaws);
            if (away < nearest.distance) nearest = { distance: away, width };
        }
        this.jaws.view.setWidth(nearest.width);
    }

    private updateJaws(): boolean {
        const width = this.live.widths.get(this.jaws?.key ?? this.arm.key);
        if (width === undefined) return false;
        if (this.jaws === null) {
            const frame = firstTool(this.arm) ?? ([0, 0, 0.06, 0, 0, 0] as const);
            this.mount(this.arm.key, frame, Math.max(width, 0.06));
        }
        this.jaws?.view.setWidth(width);
        return true;
    }

    private mount(key: string, frame: Frame, stroke: number): void {
        const view = new GripperView({ frame, stroke, depth: Math.max(0.05, frame[2]) });
        this.view.frames.flange.add(view.root);
        this.jaws = { key, view };
    }
}
