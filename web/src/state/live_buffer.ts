// The last half minute of what the arms measured, and where they were between two samples.

import type { ArmSample, Frame, LiveEvent } from '../api/types.js';

export interface TimedSample extends ArmSample {
    t: number;
}

/** Kept length [s]. */
const kWindow = 30;

/** Samples of one arm in order of time; what an event leaves out is as before. */
export class ArmBuffer {
    readonly samples: TimedSample[] = [];

    add(t: number, sample: ArmSample): void {
        const last = this.samples.at(-1);
        if (last !== undefined && t <= last.t) return;
        this.samples.push({ ...last, ...sample, t });
        let old = 0;
        while (old < this.samples.length - 2 && (this.samples[old] as TimedSample).t < t - kWindow) ++old;
        if (old > 60) this.samples.splice(0, old);
    }

    get latest(): TimedSample | null {
        return this.samples.at(-1) ?? null;
    }

    /** Index of the last sample at or before `t`; -1 if there is none. */
    private before(t: number): number {
        let i = this.samples.length - 1;
        while (i >= 0 && (this.samples[i] as TimedSample).t > t) --i;
        return i;
    }

    /** Joint position at `t` [rad], on a line between samples; null while nothing is known. */
    at(t: number, what: 'q' | 'c'): number[] | null {
        const i = this.before(t);
        const from = this.samples[Math.max(i, 0)];
        const to = this.samples[Math.min(i + 1, this.samples.length - 1)];
        const a = from?.[what];
        const b = to?.[what];
        if (from === undefined || to === undefined || a === undefined || b === undefined) return a ?? b ?? null;
        const span = to.t - from.t;
        // Nothing is sent while nothing moves: a long gap is rest, not a slow motion.
        const start = span > 0.5 ? to.t - 0.05 : from.t;
        const share = span <= 0 ? 1 : Math.max(0, Math.min(1, (t - start) / (to.t - start)));
        return a.map((value, k) => value + ((b[k] ?? value) - value) * share);
    }
}

/** All arms, grippers and parts; and the time to draw, a little behind, so that there is a next sample. */
export class LiveBuffer {
    readonly arms = new Map<string, ArmBuffer>();
    readonly widths = new Map<string, number>();
    readonly held = new Map<string, boolean>();
    /** Where parts are in the world; null: gone. */
    readonly parts = new Map<string, Frame | null>();
    /** Least of (this clock - server's clock) that was seen lately: the quickest way of a sample [s]. */
    private offset = Infinity;
    private version_ = 0;

    /** Grows with each event that changes something. */
    get version(): number {
        return this.version_;
    }

    /** `now`: this computer's monotonic clock when the event came [s]. */
    add(event: LiveEvent, now: number): void {
        ++this.version_;
        this.offset = Math.min(this.offset + 0.0005, now - event.t);
        for (const [key, sample] of Object.entries(event.arms ?? {})) {
            this.arm(key).add(event.t, sample);
            if (sample.width !== undefined) this.widths.set(key, sample.width);
        }
        for (const [key, gripper] of Object.entries(event.grippers ?? {})) {
            if (gripper.width !== undefined) this.widths.set(key, gripper.width);
            if (gripper.held !== undefined) this.held.set(key, gripper.held);
        }
        for (const [name, pose] of Object.entries(event.parts ?? {})) this.parts.set(name, pose);
    }

    arm(key: string): ArmBuffer {
        let buffer = this.arms.get(key);
        if (buffer === undefined) {
            buffer = new ArmBuffer();
            this.arms.set(key, buffer);
        }
        return buffer;
    }

    /** The server's time to draw at `now` [s]: two samples behind. */
    drawTime(now: number): number {
        return this.offset === Infinity ? 0 : now - this.offset - 0.08;
    }

    /** After a loss the clocks may differ anew. */
    forgetClock(): void {
        this.offset = Infinity;
    }
}
