// An arm drawn from its chain and its visual primitives; also its ghosts, which share the shapes.

import {
    BufferGeometry, Color, Group, Material, Mesh, MeshStandardMaterial, Object3D, Quaternion, Vector3,
} from 'three';
import { mergeGeometries } from 'three/examples/jsm/utils/BufferGeometryUtils.js';
import type { Arm, Visual } from '../api/types.js';
import { poseOf } from '../kinematics/pose.js';
import { coneGeometry } from './cone.js';
import { place, placeFrame } from './place.js';

/** What stands for links of an arm whose model nobody knows: rods from joint to joint. */
export function rods(arm: Arm): Visual[] {
    const color: Visual['color'] = [0.72, 0.75, 0.78];
    const origins = [...arm.joints.slice(1).map((joint) => joint.origin), arm.flange];
    return origins.flatMap((origin, i) => {
        const to = [origin[0], origin[1], origin[2]] as const;
        if (Math.hypot(...to) < 0.01) return [];
        const radius = 0.055 - 0.004 * i;
        return [{ link: i + 1, from: [0, 0, 0] as const, to, from_radius: radius, to_radius: radius * 0.9, color, edge: radius * 0.8 }];
    });
}

export interface Shape {
    link: number;
    color: Visual['color'];
    geometry: BufferGeometry;
}

/** One shape for each colour of each link: fewer things to draw. */
export function shapesOf(arm: Arm): Shape[] {
    const groups = new Map<string, Visual[]>();
    for (const visual of arm.visuals.length > 0 ? arm.visuals : rods(arm)) {
        const key = `${visual.link} ${visual.color.join()}`;
        groups.set(key, [...(groups.get(key) ?? []), visual]);
    }
    return [...groups.values()].map((visuals) => {
        const { link, color } = visuals[0] as Visual;
        return { link, color, geometry: mergeGeometries(visuals.map(coneGeometry)) };
    });
}

/** The frames of an arm: base, one group per link, flange. */
export class ArmFrames {
    readonly root = new Group();
    readonly links: Group[] = [];
    readonly flange = new Group();
    private readonly axes: Vector3[];
    private readonly turn = new Quaternion();

    constructor(arm: Arm) {
        this.axes = arm.joints.map((joint) => new Vector3(...joint.axis));
        placeFrame(this.root, arm.base);
        const base = new Group();
        this.root.add(base);
        this.links.push(base);
        for (const joint of arm.joints) {
            const origin = new Group();
            place(origin, poseOf(joint.origin));
            const link = new Group();
            origin.add(link);
            (this.links.at(-1) as Group).add(origin);
            this.links.push(link);
        }
        placeFrame(this.flange, arm.flange);
        (this.links.at(-1) as Group).add(this.flange);
    }

    /** \param joint_position [rad], axis 1 first */
    setJoints(joint_position: readonly number[]): void {
        this.axes.forEach((axis, i) => {
            const link = this.links[i + 1] as Group;
            link.quaternion.copy(this.turn.setFromAxisAngle(axis, joint_position[i] ?? 0));
        });
    }
}

/** Materials by colour, shared by all arms. */
export class Paint {
    private readonly materials = new Map<string, MeshStandardMaterial>();

    of(color: Visual['color']): MeshStandardMaterial {
        const key = color.join();
        let material = this.materials.get(key);
        if (material === undefined) {
            material = new MeshStandardMaterial({ color: new Color().setRGB(...color, 'srgb'), roughness: 0.45, metalness: 0.05 });
            this.materials.set(key, material);
        }
        return material;
    }
}

function hang(frames: ArmFrames, shapes: readonly Shape[], materialOf: (shape: Shape) => Material, shadow: boolean): Mesh[] {
    return shapes.map((shape) => {
        const mesh = new Mesh(shape.geometry, materialOf(shape));
        mesh.castShadow = shadow;
        mesh.receiveShadow = shadow;
        (frames.links[shape.link] as Group | undefined)?.add(mesh);
        return mesh;
    });
}

/** The arm itself. */
export class ArmView {
    readonly frames: ArmFrames;
    private meshes: Object3D[];

    constructor(readonly arm: Arm, readonly shapes: Shape[], paint: Paint) {
        this.frames = new ArmFrames(arm);
        this.meshes = hang(this.frames, shapes, (shape) => paint.of(shape.color), true);
        for (const mesh of this.meshes) mesh.userData['arm'] = arm.key;
    }

    /** Draws a user's own meshes instead of the primitives; `links` has one object (or none) per link. */
    useMeshes(links: readonly (Object3D | null)[]): void {
        for (const mesh of this.meshes) mesh.removeFromParent();
        this.meshes = [];
        links.forEach((object, i) => {
            if (object === null) return;
            (this.frames.links[i] as Group | undefined)?.add(object);
            object.traverse((node) => {
                node.castShadow = node.receiveShadow = true;
                node.userData['arm'] = this.arm.key;
            });
            this.meshes.push(object);
        });
    }
}

/** A see-through copy of an arm: where it is to be, not where it is. */
export class GhostView {
    readonly frames: ArmFrames;
    private readonly material: MeshStandardMaterial;

    constructor(arm: Arm, shapes: readonly Shape[], color: string, opacity: number) {
        this.frames = new ArmFrames(arm);
        this.material = new MeshStandardMaterial({ color, roughness: 0.7, transparent: true, opacity, depthWrite: true, polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 4 });
        hang(this.frames, shapes, () => this.material, false);
        this.frames.root.traverse((node) => (node.renderOrder = 2));
    }

    get visible(): boolean {
        return this.frames.root.visible;
    }

    show(joint_position: readonly number[] | null): void {
        this.frames.root.visible = joint_position !== null;
        if (joint_position !== null) this.frames.setJoints(joint_position);
    }

    dispose(): void {
        this.frames.root.removeFromParent();
        this.material.dispose();
    }
}
