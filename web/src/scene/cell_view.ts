// The cell in 3D: arms, parts, table; and whatever is played over it.

import { Box3, Color, Group, Mesh, MeshStandardMaterial, Vector3, type Object3D } from 'three';
import { RoundedBoxGeometry } from 'three/examples/jsm/geometries/RoundedBoxGeometry.js';
import type { Arm, Cell, Frame, Part, World } from '../api/types.js';
import type { LiveBuffer } from '../state/live_buffer.js';
import { ArmActor, type Show } from './arm_actor.js';
import { Paint } from './arm_view.js';
import { placeFrame } from './place.js';
import { niceSpeed } from './speed_color.js';
import type { Viewer } from './viewer.js';

const kTableThickness = 0.03;

/** Arms whose place nobody knows would stand inside each other: they are put beside each other, 1.4 m apart. */
export function spread(arms: readonly Arm[]): Arm[] {
    const taken: Frame[] = [];
    return arms.map((arm) => {
        let base = arm.base;
        while (taken.some((other) => Math.hypot(other[0] - base[0], other[1] - base[1]) < 0.05)) {
            base = [base[0] + 1.4, base[1], base[2], base[3], base[4], base[5]];
        }
        taken.push(base);
        return base === arm.base ? arm : { ...arm, base };
    });
}

/** What the cell takes up [m]: feet, reach of the arms, parts. */
function extentOf(arms: readonly Arm[]): Box3 {
    const box = new Box3();
    for (const arm of arms) {
        const foot = new Vector3(arm.base[0], arm.base[1], arm.base[2]);
        box.expandByPoint(foot.clone().add(new Vector3(-0.2, -0.25, 0)));
        box.expandByPoint(foot.clone().add(new Vector3(0.45, 0.25, 0.75)));
    }
    return box.isEmpty() ? new Box3(new Vector3(-1, -1, 0), new Vector3(1, 1, 1)) : box;
}

function solid(size: readonly [number, number, number], material: MeshStandardMaterial): Mesh {
    const edge = Math.min(0.004, Math.min(...size) * 0.12);
    const mesh = new Mesh(new RoundedBoxGeometry(...size, 2, edge), material);
    mesh.castShadow = mesh.receiveShadow = true;
    return mesh;
}

/** Something that is drawn over the cell for a while and moves by itself: a planned path, a replay. */
export interface Overlay {
    readonly root: Object3D;
    /** `now` [s, monotonic]. Returns whether anything moved. */
    update(now: number): boolean;
    dispose(): void;
}

export class CellView {
    readonly actors = new Map<string, ArmActor>();
    readonly show: Show = { trace: true, commanded: true, frames: true };
    /** End of the colour scale of the traces [m/s]. */
    speed_scale = 0.25;
    private readonly root = new Group();
    private readonly parts = new Map<string, { object: Object3D; width: number }>();
    private readonly paint = new Paint();
    private readonly table_paint = new MeshStandardMaterial({ color: new Color('#8d959e'), roughness: 0.75 });
    private readonly part_paint = new MeshStandardMaterial({ color: new Color('#d99a4e'), roughness: 0.6 });
    private readonly overlays = new Set<Overlay>();
    private followed = -1;
    private on_scale: (scale: number) => void = () => {};

    constructor(private readonly viewer: Viewer, private readonly live: LiveBuffer) {
        viewer.scene.add(this.root);
    }

    onScale(listener: (scale: number) => void): void {
        this.on_scale = listener;
        listener(this.speed_scale);
    }

    setCell(cell: Cell): void {
        this.root.clear();
        this.actors.clear();
        this.parts.clear();
        this.followed = -1;
        const arms = spread(cell.arms);
        for (const arm of arms) {
            const actor = new ArmActor(arm, this.live, this.paint, cell.servers);
            this.actors.set(arm.key, actor);
            this.root.add(actor.root);
            this.viewer.floor.addSpot(arm.base[0], arm.base[1], 0.22);
        }
        this.addWorld(cell.world);
        this.viewer.setExtent(extentOf(arms));
        this.viewer.requestDraw();
    }

    add(overlay: Overlay): void {
        this.overlays.add(overlay);
        this.viewer.scene.add(overlay.root);
        this.viewer.requestDraw();
    }

    remove(overlay: Overlay): void {
        if (!this.overlays.delete(overlay)) return;
        overlay.root.removeFromParent();
        overlay.dispose();
        this.viewer.requestDraw();
    }

    clearTraces(): void {
        for (const actor of this.actors.values()) actor.trace.clear();
        this.viewer.requestDraw();
    }

    /** Brings everything to `now` [s, monotonic]. Returns whether anything moved. */
    update(now: number): boolean {
        const t = this.live.drawTime(now);
        let moved = this.follow();
        for (const actor of this.actors.values()) moved = actor.update(t, this.show) || moved;
        for (const overlay of this.overlays) moved = overlay.update(now) || moved;
        return moved;
    }

    private follow(): boolean {
        if (this.followed === this.live.version) return false;
        this.followed = this.live.version;
        let fastest = 0;
        for (const actor of this.actors.values()) fastest = Math.max(fastest, actor.follow());
        const scale = niceSpeed(fastest);
        if (scale > this.speed_scale) this.setScale(scale);
        this.followParts();
        return true;
    }

    private followParts(): void {
        for (const [name, pose] of this.live.parts) {
            const object = this.parts.get(name)?.object;
            if (object === undefined) continue;
            object.visible = pose !== null;
            if (pose !== null) placeFrame(object, pose);
        }
        for (const actor of this.actors.values()) actor.holdNearest(this.parts.values());
    }

    private addPart(part: Part): void {
        const mesh = solid(part.size as [number, number, number], this.part_paint);
        placeFrame(mesh, part.pose);
        this.parts.set(part.name, { object: mesh, width: part.size[0] });
        this.root.add(mesh);
    }

    private setScale(scale: number): void {
        this.speed_scale = scale;
        for (const actor of this.actors.values()) actor.trace.setScale(scale);
        this.on_scale(scale);
    }

    private addWorld(world: World | null | undefined): void {
        if (world === null || world === undefined) return;
        for (const part of world.parts ?? []) this.addPart(part);
        const height = world.table?.height ?? 0;
        if (Math.abs(height) > 1e-3) this.addTable(height);
    }

    private addTable(height: number): void {
        const box = new Box3();
        for (const actor of this.actors.values()) box.expandByPoint(actor.labelPoint());
        const size = box.getSize(new Vector3());
        const top = solid([size.x + 1.4, size.y + 1.4, kTableThickness], this.table_paint);
        top.position.set((box.min.x + box.max.x) / 2, (box.min.y + box.max.y) / 2, height - kTableThickness / 2 - 0.001);
        this.root.add(top);
    }
}
