// A gripper with two parallel jaws that follow its width.

import { Color, Group, Mesh, MeshStandardMaterial } from 'three';
import { RoundedBoxGeometry } from 'three/examples/jsm/geometries/RoundedBoxGeometry.js';
import type { Frame } from '../api/types.js';
import { placeFrame } from './place.js';

export interface GripperShape {
    /** Between the jaws, in the flange frame; x from jaw to jaw, z out of the flange. */
    frame: Frame;
    /** Largest width [m]. */
    stroke: number;
    /** How far the flange is behind the jaws along their z [m]. */
    depth: number;
}

const kBody = new MeshStandardMaterial({ color: new Color('#4b5157'), roughness: 0.45, metalness: 0.25 });
const kJaw = new MeshStandardMaterial({ color: new Color('#b9c0c7'), roughness: 0.4, metalness: 0.4 });
const kPad = new MeshStandardMaterial({ color: new Color('#26292c'), roughness: 0.8 });

function box(x: number, y: number, z: number, material: MeshStandardMaterial): Mesh {
    const edge = Math.min(x, y, z) * 0.2;
    const mesh = new Mesh(new RoundedBoxGeometry(x, y, z, 2, edge), material);
    mesh.castShadow = mesh.receiveShadow = true;
    return mesh;
}

/** A jaw whose inner face is at x = 0, towards +x; its tip reaches a little beyond the jaws' frame. */
function jaw(length: number): Group {
    const group = new Group();
    const finger = box(0.012, 0.022, length, kJaw);
    finger.position.set(-0.009, 0, -length / 2 + 0.012);
    const pad = box(0.003, 0.02, Math.min(0.03, length / 2), kPad);
    pad.position.set(-0.0015, 0, 0);
    const carrier = box(0.03, 0.03, 0.022, kBody);
    carrier.position.set(-0.015, 0, -length + 0.008);
    group.add(finger, pad, carrier);
    return group;
}

export class GripperView {
    readonly root = new Group();
    /** Largest width [m]. */
    readonly stroke: number;
    private readonly left: Group;
    private readonly right: Group;

    constructor(shape: GripperShape) {
        this.stroke = shape.stroke;
        placeFrame(this.root, shape.frame);
        const finger = Math.max(0.03, Math.min(0.085, shape.depth * 0.55));
        const body_length = Math.max(0.02, shape.depth - finger + 0.004);
        const width = Math.max(0.06, Math.min(shape.stroke + 0.05, 0.16));
        const body = box(width, 0.05, body_length, kBody);
        body.position.z = -finger - body_length / 2 + 0.004;
        this.left = jaw(finger);
        this.right = jaw(finger);
        this.right.rotation.z = Math.PI;
        this.root.add(body, this.left, this.right);
        this.setWidth(shape.stroke / 2);
    }

    /** \param width between the jaws [m] */
    setWidth(width: number): void {
        this.left.position.x = -width / 2;
        this.right.position.x = width / 2;
    }
}
