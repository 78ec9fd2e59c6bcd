// The axes of a frame: x red, y green, z blue.

import { ConeGeometry, CylinderGeometry, Group, Mesh, MeshBasicMaterial } from 'three';

const kColors = ['#e5484d', '#46a758', '#3e8bff'];

/** \param length of each axis [m] */
export function triad(length: number): Group {
    const group = new Group();
    const shaft = new CylinderGeometry(length * 0.028, length * 0.028, length * 0.8, 10).translate(0, length * 0.4, 0);
    const head = new ConeGeometry(length * 0.075, length * 0.22, 14).translate(0, length * 0.89, 0);
    kColors.forEach((color, axis) => {
        const material = new MeshBasicMaterial({ color });
        const arrow = new Group();
        arrow.add(new Mesh(shaft, material), new Mesh(head, material));
        if (axis === 0) arrow.rotation.z = -Math.PI / 2;
        if (axis === 2) arrow.rotation.x = Math.PI / 2;
        group.add(arrow);
    });
    return group;
}
