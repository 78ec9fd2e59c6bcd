// Reads a URDF and puts its visual meshes on the links of an arm. The server's kinematics move it, not the file's:
// the file's chain only says where each mesh is on its link.

import { Color, Group, Matrix4, Mesh, MeshStandardMaterial, type Object3D } from 'three';
import { ColladaLoader } from 'three/examples/jsm/loaders/ColladaLoader.js';
import { STLLoader } from 'three/examples/jsm/loaders/STLLoader.js';
import type { Arm, Frame, Vector3 } from '../api/types.js';
import { inverse, kIdentity, multiply, poseOf, type Pose } from '../kinematics/pose.js';
import { matrixOf } from './place.js';
import { groupsOf, standOf, type UrdfJoint } from './urdf_chain.js';

interface UrdfVisual {
    origin: Pose;
    file: string;
    scale: readonly number[];
    color: Color;
}

function numbers(text: string | null | undefined, fallback: readonly number[]): number[] {
    const values = (text ?? '').trim().split(/\s+/).filter((part) => part !== '').map(Number);
    return values.length === fallback.length && values.every(Number.isFinite) ? values : [...fallback];
}

function child(element: Element, name: string): Element | null {
    return [...element.children].find((candidate) => candidate.tagName === name) ?? null;
}

function originOf(element: Element): Pose {
    const origin = child(element, 'origin');
    return poseOf([...numbers(origin?.getAttribute('xyz'), [0, 0, 0]), ...numbers(origin?.getAttribute('rpy'), [0, 0, 0])] as unknown as Frame);
}

function readJoint(element: Element): UrdfJoint {
    return {
        name: element.getAttribute('name') ?? '', type: element.getAttribute('type') ?? '',
        parent: child(element, 'parent')?.getAttribute('link') ?? '', child: child(element, 'child')?.getAttribute('link') ?? '',
        origin: originOf(element), axis: numbers(child(element, 'axis')?.getAttribute('xyz'), [1, 0, 0]) as unknown as Vector3,
    };
}

function readVisual(visual: Element): UrdfVisual | null {
    const mesh = visual.querySelector('geometry > mesh');
    const file = mesh?.getAttribute('filename') ?? '';
    if (mesh === null || file === '') return null;
    const [r, g, b] = numbers(visual.querySelector('material > color')?.getAttribute('rgba'), [0.78, 0.8, 0.82, 1]) as [number, number, number];
    return { origin: originOf(visual), file, scale: numbers(mesh.getAttribute('scale'), [1, 1, 1]), color: new Color().setRGB(r, g, b, 'srgb') };
}

function readLinks(robot: Element): Map<string, UrdfVisual[]> {
    const links = [...robot.children].filter((element) => element.tagName === 'link');
    return new Map(links.map((link) => {
        const visuals = [...link.children].filter((element) => element.tagName === 'visual').map(readVisual);
        return [link.getAttribute('name') ?? '', visuals.filter((visual): visual is UrdfVisual => visual !== null)];
    }));
}

async function loadMesh(address: string, color: Color): Promise<Object3D> {
    if (!/\.dae$/i.test(address)) {
        const geometry = await new STLLoader().loadAsync(address);
        // Many files leave the normals out.
        geometry.computeVertexNormals();
        return new Mesh(geometry, new MeshStandardMaterial({ color, roughness: 0.5 }));
    }
    const collada = await new ColladaLoader().loadAsync(address);
    if (collada === null) throw new Error(`${address}: no scene`);
    return collada.scene;
}

/** Address of a mesh: a `package://NAME/...` is looked for in the folder of meshes, any other beside the file. */
export function meshAddress(urdf: string, file: string): string {
    if (file.startsWith('package://')) return `/meshes/${file.slice('package://'.length)}`;
    return new URL(file.replace(/^file:\/\//, ''), new URL(urdf, 'http://page')).pathname;
}

/** The meshes of the file's links at their poses, in a frame of the arm. */
async function fillGroup(group: Group, links: readonly (readonly [UrdfVisual, Pose])[], url: string): Promise<void> {
    for (const [visual, link_from_visual] of links) {
        const holder = new Group();
        const [x, y, z] = visual.scale as [number, number, number];
        holder.applyMatrix4(matrixOf(link_from_visual).multiply(new Matrix4().makeScale(x, y, z)));
        holder.add(await loadMesh(meshAddress(url, visual.file), visual.color));
        group.add(holder);
    }
}

/** Where the arm's link frames are in its base with all joints at 0. */
function linkFrames(arm: Arm): Pose[] {
    let pose = kIdentity;
    return [kIdentity, ...arm.joints.map((joint) => (pose = multiply(pose, poseOf(joint.origin))))];
}

/**
 * One object per link of the arm, 0 the base; null for a link without meshes.
 * Throws where the file's chain is not the arm's, or a mesh cannot be read.
 */
export async function loadLinks(url: string, arm: Arm): Promise<(Object3D | null)[]> {
    const text = await (await fetch(url)).text();
    const robot = new DOMParser().parseFromString(text, 'application/xml').documentElement;
    const joints = [...robot.children].filter((element) => element.tagName === 'joint').map(readJoint);
    const visuals = readLinks(robot);
    const groups = groupsOf(joints, arm.joints.length);
    const frames = linkFrames(arm);
    let pose = standOf(arm, groups);
    const objects: (Object3D | null)[] = [];
    for (let i = 0; i < groups.length; ++i) {
        const link_from_base = inverse(frames[i] as Pose);
        const placed = (name: string): [UrdfVisual, Pose][] => (visuals.get(name) ?? []).map((visual) => [visual, multiply(multiply(link_from_base, pose), visual.origin)]);
        const links = i === 0 ? placed(groups.flat()[0]?.parent ?? '') : [];
        for (const joint of groups[i] ?? []) {
            pose = multiply(pose, joint.origin);
            links.push(...placed(joint.child));
        }
        const group = new Group();
        await fillGroup(group, links, url);
        objects.push(links.length > 0 ? group : null);
    }
    return objects;
}
