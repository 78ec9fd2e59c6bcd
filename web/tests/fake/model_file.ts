// Reads models/*.toml as far as the fake dashboard needs them: tables, lists of tables, numbers, texts, lists.

import { readFileSync } from 'node:fs';
import type { Arm, Frame, Joint, Visual } from '../../src/api/types.js';
import { frameOf, kIdentity, multiply, poseOf, turnAbout, type Pose } from '../../src/kinematics/pose.js';

type Table = Record<string, unknown>;

function valueOf(text: string): unknown {
    const clean = text.trim();
    if (clean.startsWith('"')) return clean.slice(1, clean.indexOf('"', 1));
    if (clean.startsWith('[')) return JSON.parse(clean.replace(/#.*$/, '').trim()) as unknown;
    if (clean.startsWith('{')) {
        const pairs = clean.slice(1, clean.indexOf('}')).split(',').map((pair) => pair.split('=').map((part) => part.trim()));
        return Object.fromEntries(pairs.map(([key, value]) => [key as string, Number(value)]));
    }
    return Number(clean.replace(/#.*$/, ''));
}

export function readToml(text: string): Table {
    const root: Table = {};
    let table = root;
    for (const line of text.split('\n').map((one) => one.trim())) {
        const list = /^\[\[(\w+)\]\]/.exec(line);
        const single = /^\[(\w+)\]/.exec(line);
        const pair = /^(\w+)\s*=\s*(.+)$/.exec(line);
        if (list !== null) {
            table = {};
            ((root[list[1] as string] ??= []) as Table[]).push(table);
        } else if (single !== null) {
            table = root[single[1] as string] = {};
        } else if (pair !== null && !line.startsWith('#')) {
            table[pair[1] as string] = valueOf(pair[2] as string);
        }
    }
    return root;
}

function angle(table: Table, key: string): number {
    const degrees = table[`${key}_deg`];
    return typeof degrees === 'number' ? (degrees * Math.PI) / 180 : ((table[key] as number | undefined) ?? 0);
}

function turned(axis: readonly [number, number, number], by: number): Pose {
    return { translation: [0, 0, 0], rotation: turnAbout(axis, by) };
}

function jointsOf(rows: Table[]): { joints: Joint[]; after: Pose } {
    let after = kIdentity;
    const joints = rows.map((row) => {
        const range = ((row['position_deg'] as number[] | undefined)?.map((value) => (value * Math.PI) / 180) ?? row['position']) as number[];
        const dh = row['dh'] as Table | undefined;
        const before = dh === undefined ? poseOf(row['origin'] as unknown as Frame) : turned([0, 0, 1], angle(dh, 'offset'));
        const origin = frameOf(multiply(after, before));
        after = kIdentity;
        if (dh !== undefined) after = { translation: [dh['a'] as number, 0, dh['d'] as number], rotation: turnAbout([1, 0, 0], angle(dh, 'alpha')) };
        const axis = (row['axis'] ?? [0, 0, 1]) as Joint['axis'];
        return { name: row['name'] as string, origin, axis, lower: range[0] as number, upper: range[1] as number, velocity: angle(row, 'velocity') };
    });
    return { joints, after };
}

export interface ModelArm extends Arm {
    home: number[];
}

export function readArm(path: string, key: string, base: Frame): ModelArm {
    const model = readToml(readFileSync(path, 'utf8'));
    const { joints, after } = jointsOf(model['joint'] as Table[]);
    const flange = model['flange'] === undefined ? after : multiply(after, poseOf(model['flange'] as unknown as Frame));
    const visuals = ((model['visual'] ?? []) as Table[]).map((visual) => ({ ...visual, to_radius: visual['to_radius'] ?? visual['from_radius'] }) as unknown as Visual);
    return {
        key, name: key, maker: model['maker'] as string, product: model['product'] as string, server: key, base, joints,
        flange: frameOf(flange), tools: [], visuals, cycle_time: model['cycle_time'] as number, home: model['home'] as number[],
    };
}
