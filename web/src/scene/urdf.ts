// Reads a URDF and puts its visual meshes on the links of an arm. The server's kinematics move it, not the file's:
// the file's own chain only tells where each mesh is on its link.

import { Color, Group, Matrix4, Mesh, MeshStandardMaterial, Object3D } from 'three';
import { ColladaLoader } from 'three/examples/jsm/loaders/ColladaLoader.js';
import { STLLoader } from 'three/examples/jsm/loaders/STLLoader.js';
import type { Arm, Frame } from '../api/types.js';
import { kIdentity, multiply, inverse, poseOf, type Pose } from '../kinematics/pose.js';
import { matrixOf } from './place.js';

interface UrdfJoint {
    name: string;
    type: string;
    parent: string;
    child: string;
    origin: Pose;
    axis: readonly [number, number, number];
}

interface UrdfVisual {
    origin: Pose;
    file: string;
    scale: readonly number[];
    color: string | null;
}

function numbers(text: string | null, fallback: readonly number[]): number[] {
    const values = (text ?? '').trim().split(/\s+/).filter((part) => part !== '').map(Number);
    return values.length === fallback.length && values.every(Number.isFinite) ? values : [...fallback];
}

function originOf(element: Element | null): Pose {
    const xyz = numbers(element?.getAttribute('xyz') ?? null, [0, 0, 0]);
    const rpy = numbers(element?.getAttribute('rpy') ?? null, [0, 0, 0]);
    return poseOf([...xyz, ...rpy] as unknown as Frame);
}

function child(element: Element, name: string): Element | null {
    return [...element.children].find((candidate) => candidate.tagName === name) ?? null;
}

function readJoint(element: Element): UrdfJoint {
    return {
        name: element.getAttribute('name') ?? '', type: element.getAttribute('type') ?? '',
        parent: child(element, 'parent')?.getAttribute('link') ?? '', child: child(element, 'child')?.getAttribute('link') ?? '',
        origin: originOf(child(element, 'origin')), axis: numbers(child(element, 'axis')?.getAttribute('xyz') ?? null, [1, 0, 0]) as [number, number, number],
    };
}

function readVisuals(link: Element): UrdfVisual[] {
    return [...link.children].filter((element) => element.tagName === 'visual').flatMap((visual) => {
        const mesh = visual.querySelector('geometry > mesh');
        const file = mesh?.getAttribute('filename');
        if (mesh === null || file === null || file === undefined) return [];
        const rgba = visual.querySelector('material > color')?.getAttribute('rgba');
        const color = rgba === null || rgba === undefined ? null : `#${new Color().setRGB(...(numbers(rgba, [0, 0, 0, 1]).slice(0, 3) as [number, number, number]), 'srgb').getHexString()}`;
        return [{ origin: originOf(child(visual, 'origin')), file, scale: numbers(mesh.getAttribute('scale'), [1, 1, 1]), color }];
    });
}

/** URDF files that may be of this arm, best first: those whose path names its product, then all others. */
export function candidates(files: readonly string[], arm: Arm): string[] {
    const plain = (text: string): string => text.toLowerCase().replace(/[^a-z0-9]/g, '');
    const words = [arm.product, arm.name, arm.key].map(plain).filter((word) => word.length > 1);
    const fits = files.filter((file) => words.some((word) => plain(file).includes(word) || word.includes(plain(file.split('/').at(-1)?.replace(/\..*$/, '') ?? ''))));
    return fits;
}

/** The turning joints from the base on, as many as the arm has axes. */
function chainOf(joints: readonly UrdfJoint[], axes: number): UrdfJoint[][] {
    const children = new Set(joints.map((joint) => joint.child));
    let links = [joints.find((joint) => !children.has(joint.parent))?.parent ?? ''];
    const path: UrdfJoint[] = [];
    // The longest way down: arms have one; a gripper's fingers branch off behind it.
    const walk = (link: string): UrdfJoint[] => joints.filter((joint) => joint.parent === link)
        .map((joint) => [joint, ...walk(joint.child)]).sort((a, b) => turning(b) - turning(a))[0] ?? [];
    path.push(...walk(links[0] as string));
    const groups: UrdfJoint[][] = [[]];
    for (const joint of path) {
        if (joint.type !== 'fixed' && groups.length > axes) break;
        if (joint.type !== 'fixed') groups.push([]);
        (groups.at(-1) as UrdfJoint[]).push(joint);
    }
    if (groups.length !== axes + 1) throw new Error(`${groups.length - 1} turning joints, the arm has ${axes}`);
    links = [];
    return groups;
}

function turning(joints: readonly UrdfJoint[]): number {
    return joints.filter((joint) => joint.type !== 'fixed').length;
}

/** Turns the file's joint frame into the arm's: both turn about the same axis in space at joint position 0. */
function armLinkFrames(arm: Arm): Pose[] {
    const frames = [kIdentity];
    let pose = kIdentity;
    for (const joint of arm.joints) {
        pose = multiply(pose, poseOf(joint.origin));
        frames.push(pose);
    }
    return frames;
}

async function loadMesh(url: string, visual: UrdfVisual): Promise<Object3D> {
    const material = new MeshStandardMaterial({ color: visual.color ?? '#c9ced4', roughness: 0.5 });
    if (/\.dae$/i.test(url)) {
        const collada = await new ColladaLoader().loadAsync(url);
        if (collada === null) throw new Error(`${url}: no scene`);
        return collada.scene;
    }
    return new Mesh(await new STLLoader().loadAsync(url), material);
}

/** Address of a mesh: `package://NAME/...` is looked for beside the URDF, the way such packages are laid out. */
export function meshAddress(urdf: string, file: string): string {
    if (!file.startsWith('package://')) return new URL(file, new URL(urdf, location.href)).pathname;
    const inside = file.slice('package://'.length);
    return `/meshes/${inside}`;
}

/**
 * One object per link of the arm, 0 the base. The file's zero position must be the arm's.
 * Throws where the chain or a mesh does not fit.
 */
export async function loadLinks(url: string, arm: Arm): Promise<(Object3D | null)[]> {
    const document = new DOMParser().parseFromString(await (await fetch(url)).text(), 'application/xml');
    const robot = document.documentElement;
    const joints = [...robot.children].filter((element) => element.tagName === 'joint').map(readJoint);
    const visuals = new Map([...robot.children].filter((element) => element.tagName === 'link').map((link) => [link.getAttribute('name') ?? '', readVisuals(link)]));
    const groups = chainOf(joints, arm.joints.length);
    const arm_frames = armLinkFrames(arm);
    let pose = kIdentity;
    const first = groups.flat()[0]?.parent ?? '';
    const links: (Object3D | null)[] = [];
    for (let i = 0; i < groups.length; ++i) {
        const group = new Group();
        const names: [string, Pose][] = i === 0 ? [[first, kIdentity]] : [];
        for (const joint of groups[i] as UrdfJoint[]) {
            pose = multiply(pose, joint.origin);
            names.push([joint.child, pose]);
        }
        await fillLink(group, names, visuals, url, inverse(arm_frames[i] as Pose));
        links.push(group.children.length > 0 ? group : null);
    }
    return links;
}

async function fillLink(group: Group, names: readonly [string, Pose][], visuals: Map<string, UrdfVisual[]>, url: string, link_from_base: Pose): Promise<void> {
    for (const [name, base_from_link] of names) {
        for (const visual of visuals.get(name) ?? []) {
            const object = await loadMesh(meshAddress(url, visual.file), visual);
            const at = multiply(multiply(link_from_base, base_from_link), visual.origin);
            const holder = new Group();
            holder.applyMatrix4(matrixOf(at).multiply(new Matrix4().makeScale(visual.scale[0] ?? 1, visual.scale[1] ?? 1, visual.scale[2] ?? 1)));
            holder.add(object);
            group.add(holder);
        }
    }
}
