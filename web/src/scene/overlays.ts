// Ghosts that are played over the cell: a planned path before Start, and recorded executions.

import { Group } from 'three';
import type { Frame } from '../api/types.js';
import type { ArmActor } from './arm_actor.js';
import { GhostView } from './arm_view.js';
import type { Overlay } from './cell_view.js';
import { placeFrame } from './place.js';
import { Trace } from './trace.js';
import { triad } from './triad.js';

export interface TimedPath {
    readonly time: readonly number[];
    readonly q: readonly (readonly number[])[];
}

export function timedPath(points: readonly { time: number; q: number[] }[]): TimedPath {
    const start = points[0]?.time ?? 0;
    return { time: points.map((point) => point.time - start), q: points.map((point) => point.q) };
}

export function lengthOf(path: TimedPath): number {
    return path.time.at(-1) ?? 0;
}

/** Joint position at a time since the start [s], on lines between the points; null for an empty path. */
export function positionAt(path: TimedPath, time: number): number[] | null {
    const count = path.time.length;
    if (count === 0) return null;
    let high = path.time.findIndex((value) => value > time);
    if (high < 0) high = count - 1;
    const low = Math.max(0, high - 1);
    const from = path.q[low] ?? [];
    const to = path.q[high] ?? [];
    const span = (path.time[high] ?? 0) - (path.time[low] ?? 0);
    const share = span <= 0 ? 1 : Math.max(0, Math.min(1, (time - (path.time[low] ?? 0)) / span));
    return from.map((value, i) => value + ((to[i] ?? value) - value) * share);
}

/** A ghost of an arm that goes along a path, with the path of its tool. */
export class PathGhost implements Overlay {
    readonly root = new Group();
    readonly length: number;
    private readonly ghost: GhostView;
    private readonly trace: Trace;
    private shown = -1;
    private time = 0;

    constructor(actor: ArmActor, private readonly path: TimedPath, color: string, opacity: number) {
        this.length = lengthOf(path);
        this.ghost = new GhostView(actor.arm, actor.view.shapes, color, opacity);
        this.trace = new Trace(Math.max(1, path.q.length), 3, 0.9);
        this.trace.addPlain(path.q.map((q) => actor.toolAt(q)), color);
        this.root.add(this.ghost.frames.root, this.trace.object);
        this.ghost.show(positionAt(path, 0));
    }

    /** \param time since the start [s] */
    seek(time: number): void {
        this.time = Math.max(0, Math.min(this.length, time));
    }

    update(_now: number): boolean {
        if (this.time === this.shown) return false;
        this.shown = this.time;
        this.ghost.show(positionAt(this.path, this.time));
        return true;
    }

    dispose(): void {
        this.ghost.dispose();
        this.trace.dispose();
    }
}

/** A planned path, over and over: in its own time, with a rest at the end. */
export class Preview implements Overlay {
    readonly root = new Group();
    private readonly ghost: PathGhost;
    private start = -1;

    constructor(actor: ArmActor, path: TimedPath, color: string) {
        this.ghost = new PathGhost(actor, path, color, 0.42);
        this.root.add(this.ghost.root);
    }

    update(now: number): boolean {
        if (this.start < 0) this.start = now;
        const rest = 0.8;
        this.ghost.seek((now - this.start) % (this.ghost.length + rest));
        return this.ghost.update(now);
    }

    dispose(): void {
        this.ghost.dispose();
    }
}

/** The target that a form holds now: an arm at a joint position, or a frame. */
export class Target implements Overlay {
    readonly root = new Group();
    private readonly ghost: GhostView;
    private readonly frame = triad(0.13);
    private changed = true;

    constructor(actor: ArmActor) {
        this.ghost = new GhostView(actor.arm, actor.view.shapes, '#8aa0b8', 0.3);
        this.ghost.show(null);
        const base = new Group();
        placeFrame(base, actor.arm.base);
        base.add(this.frame);
        this.frame.visible = false;
        this.root.add(this.ghost.frames.root, base);
    }

    showJoints(joint_position: readonly number[] | null): void {
        this.ghost.show(joint_position);
        this.frame.visible = false;
        this.changed = true;
    }

    /** In the arm's base frame. */
    showFrame(frame: Frame | null): void {
        this.ghost.show(null);
        this.frame.visible = frame !== null;
        if (frame !== null) placeFrame(this.frame, frame);
        this.changed = true;
    }

    update(): boolean {
        const was = this.changed;
        this.changed = false;
        return was;
    }

    dispose(): void {
        this.ghost.dispose();
    }
}
