// A URDF as a user has one, made from an arm's chain.

import type { Arm } from '../../src/api/types.js';

/** A tetrahedron as STL text; edge in m. */
export function tetrahedron(edge: number): string {
    const corners = [[0, 0, 0], [edge, 0, 0], [0, edge, 0], [0, 0, edge]];
    const faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    const face = (indices: number[]): string => `facet normal 0 0 0\nouter loop\n${indices.map((i) => `vertex ${(corners[i] as number[]).join(' ')}`).join('\n')}\nendloop\nendfacet`;
    return `solid link\n${faces.map(face).join('\n')}\nendsolid link\n`;
}

/** Each link with one mesh; the base turned by 180 degrees about z, as some makers' files have it. */
export function urdfOf(arm: Arm, mesh: string): string {
    const visual = `<visual><geometry><mesh filename="${mesh}"/></geometry></visual>`;
    const links = [...arm.joints.keys(), arm.joints.length].map((i) => `<link name="link_${i}">${visual}</link>`).join('');
    const joints = arm.joints.map((joint, i) => `<joint name="${joint.name}" type="revolute"><parent link="link_${i}"/><child link="link_${i + 1}"/>` +
        `<origin xyz="${joint.origin.slice(0, 3).join(' ')}" rpy="${joint.origin.slice(3).join(' ')}"/><axis xyz="${joint.axis.join(' ')}"/></joint>`).join('');
    const turned = '<link name="world"/><joint name="stand" type="fixed"><parent link="world"/><child link="link_0"/><origin rpy="0 0 3.141592653589793"/></joint>';
    return `<?xml version="1.0"?><robot name="${arm.name}">${turned}${links}${joints}</robot>`;
}
