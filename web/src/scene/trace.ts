// The way of a tool frame, coloured by its speed.

import { Color, InstancedInterleavedBuffer, InterleavedBufferAttribute } from 'three';
import { LineMaterial } from 'three/examples/jsm/lines/LineMaterial.js';
import { LineSegments2 } from 'three/examples/jsm/lines/LineSegments2.js';
import { LineSegmentsGeometry } from 'three/examples/jsm/lines/LineSegmentsGeometry.js';
import type { Vector3 } from '../api/types.js';
import { distance } from '../kinematics/pose.js';
import { speedColor } from './speed_color.js';

/** Least way between two points of a trace [m]. */
const kStep = 0.0015;
/** A jump of more than that is no motion [m]. */
const kJump = 0.4;

interface Point {
    at: Vector3;
    t: number;
}

/** A line of `capacity` segments in world coordinates; the oldest make room. */
export class Trace {
    readonly object: LineSegments2;
    private readonly positions: InstancedInterleavedBuffer;
    private readonly colors: InstancedInterleavedBuffer;
    private readonly speeds: Float32Array;
    private readonly geometry = new LineSegmentsGeometry();
    private last: Point | null = null;
    private count = 0;
    private next = 0;
    private scale = 0.25;

    constructor(private readonly capacity: number, width: number, opacity = 1) {
        this.geometry.setPositions(new Float32Array(capacity * 6));
        this.geometry.setColors(new Float32Array(capacity * 6));
        this.positions = (this.geometry.getAttribute('instanceStart') as InterleavedBufferAttribute).data as InstancedInterleavedBuffer;
        this.colors = (this.geometry.getAttribute('instanceColorStart') as InterleavedBufferAttribute).data as InstancedInterleavedBuffer;
        this.speeds = new Float32Array(capacity * 2);
        const material = new LineMaterial({ linewidth: width, vertexColors: true, transparent: opacity < 1, opacity });
        this.object = new LineSegments2(this.geometry, material);
        this.object.frustumCulled = false;
        this.geometry.instanceCount = 0;
    }

    /** Appends a point at server time `t` [s]. Returns the speed on the way there [m/s]; 0 for what is too near. */
    add(at: Vector3, t: number): number {
        if (this.last === null) {
            this.last = { at, t };
            return 0;
        }
        const way = distance(at, this.last.at);
        if (way < kStep) {
            // At rest the time of the last point moves along, so that the next segment is not counted as slow.
            if (t - this.last.t > 0.3) this.last = { at: this.last.at, t };
            return 0;
        }
        const speed = way / Math.max(t - this.last.t, 1e-3);
        if (way < kJump) this.put(this.last.at, at, speed);
        this.last = { at, t };
        return way < kJump ? speed : 0;
    }

    /** The same path in one colour, as for compared runs. */
    addPlain(path: readonly Vector3[], color: string): void {
        const { r, g, b } = new Color(color);
        for (let i = 1; i < path.length; ++i) this.write(path[i - 1] as Vector3, path[i] as Vector3, 0, [r, g, b]);
        this.changed();
    }

    setScale(scale: number): void {
        if (scale === this.scale) return;
        this.scale = scale;
        for (let i = 0; i < this.count; ++i) this.paint(i);
        this.changed();
    }

    clear(): void {
        this.last = null;
        this.count = this.next = 0;
        this.geometry.instanceCount = 0;
    }

    dispose(): void {
        this.object.removeFromParent();
        this.geometry.dispose();
        this.object.material.dispose();
    }

    private put(from: Vector3, to: Vector3, speed: number): void {
        this.write(from, to, speed, null);
        this.changed();
    }

    private write(from: Vector3, to: Vector3, speed: number, color: readonly number[] | null): void {
        const slot = this.next;
        const before = this.speeds[2 * ((slot + this.capacity - 1) % this.capacity) + 1] ?? speed;
        this.positions.array.set([...from, ...to], slot * 6);
        this.speeds.set([this.count === 0 ? speed : before, speed], slot * 2);
        if (color === null) this.paint(slot);
        else this.colors.array.set([...color, ...color], slot * 6);
        this.next = (slot + 1) % this.capacity;
        this.count = Math.min(this.count + 1, this.capacity);
    }

    private paint(slot: number): void {
        for (let end = 0; end < 2; ++end) {
            const [r, g, b] = speedColor((this.speeds[2 * slot + end] as number) / this.scale);
            const color = new Color().setRGB(r, g, b, 'srgb');
            this.colors.array.set([color.r, color.g, color.b], slot * 6 + end * 3);
        }
    }

    private changed(): void {
        this.geometry.instanceCount = this.count;
        this.positions.needsUpdate = true;
        this.colors.needsUpdate = true;
    }
}
