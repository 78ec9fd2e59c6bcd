// A URDF as a user has one, made from an arm's chain.

import type { Arm } from '../../src/api/types.js';

const kFaces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

function cornersOf(edge: number): number[][] {
    return [[0, 0, 0], [edge, 0, 0], [0, edge, 0], [0, 0, edge]];
}

/** A tetrahedron as STL text; edge in m. */
export function tetrahedron(edge: number): string {
    const corners = cornersOf(edge);
    const face = (indices: number[]): string => `facet normal 0 0 0\nouter loop\n${indices.map((i) => `vertex ${(corners[i] as number[]).join(' ')}`).join('\n')}\nendloop\nendfacet`;
    return `solid link\n${kFaces.map(face).join('\n')}\nendsolid link\n`;
}

/** The same as Collada. */
export function tetrahedronAsCollada(edge: number): string {
    const positions = cornersOf(edge).flat();
    const source = `<source id="at"><float_array id="at-array" count="12">${positions.join(' ')}</float_array><technique_common>` +
        '<accessor source="#at-array" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>';
    const mesh = `<mesh>${source}<vertices id="corners"><input semantic="POSITION" source="#at"/></vertices>` +
        `<triangles count="4"><input semantic="VERTEX" source="#corners" offset="0"/><p>${kFaces.flat().join(' ')}</p></triangles></mesh>`;
    return '<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset><unit name="metre" meter="1"/><up_axis>Z_UP</up_axis></asset>' +
        `<library_geometries><geometry id="link">${mesh}</geometry></library_geometries>` +
        '<library_visual_scenes><visual_scene id="scene"><node id="node"><instance_geometry url="#link"/></node></visual_scene></library_visual_scenes>' +
        '<scene><instance_visual_scene url="#scene"/></scene></COLLADA>';
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
