// Entries for where an arm is to go: joints with sliders, a pose, a list of poses. Filled from where the arm is now.

import type { Arm, Field, Frame } from '../api/types.js';
import { h, icon, kIcons } from '../ui/dom.js';
import { numberInput, type Editor, type EditorOptions } from './editors.js';
import { format, kPoseNames, kPoseUnits, parseNumbers, type Bounds, type Parsed } from './field_value.js';

const kFree: Bounds = { low: -Infinity, high: Infinity };

export interface TargetOptions extends EditorOptions {
    /** The pose of the chosen tool frame now, in the arm's base frame; null while the arm is not heard. */
    currentFrame: () => Frame | null;
    /** [rad]; null while the arm is not heard. */
    currentJoints: () => number[] | null;
}

function fillButton(text: string, fill: () => void): HTMLButtonElement {
    return h('button', { type: 'button', class: 'small', onclick: fill }, text);
}

interface JointRow {
    element: HTMLElement;
    input: HTMLInputElement;
    slider: HTMLInputElement | null;
}

function jointRow(name: string, bounds: Bounds, id: string, changed: () => void): JointRow {
    const finite = Number.isFinite(bounds.low) && Number.isFinite(bounds.high);
    const input = numberInput({ id, 'aria-label': `${name} in rad` }, 0.05, () => {
        if (slider !== null) slider.value = input.value.replace(',', '.');
        changed();
    });
    const slider = !finite ? null : h('input', {
        'type': 'range', 'min': bounds.low, 'max': bounds.high, 'step': 0.001, 'value': 0, 'aria-label': `${name}, ${format(bounds.low)} to ${format(bounds.high)} rad`,
        'tabindex': -1,
        'oninput': () => {
            input.value = format(Math.round(Number(slider?.value) * 1000) / 1000);
            changed();
        },
    });
    return { element: h('div', { class: 'joint' }, h('label', { for: id }, name), slider, input), input, slider };
}

/** \param bounds of each joint [rad] */
export function jointsEditor(_field: Field, options: TargetOptions, arm: Arm | null, bounds: readonly Bounds[]): Editor {
    const names = bounds.map((_, i) => arm?.joints[i]?.name ?? `axis ${i + 1}`);
    const rows = names.map((name, i) => jointRow(name, bounds[i] as Bounds, i === 0 ? options.id : `${options.id}-${i}`, options.changed));
    const set = (value: unknown): void => rows.forEach(({ input, slider }, i) => {
        input.value = Array.isArray(value) && typeof value[i] === 'number' ? format(Math.round((value[i] as number) * 1e5) / 1e5) : '';
        if (slider !== null) slider.value = input.value === '' ? '0' : input.value;
    });
    const fill = (): void => {
        set(options.currentJoints());
        options.changed();
    };
    return {
        element: h('div', { class: 'target' }, ...rows.map((row) => row.element), h('div', { class: 'fill' }, fillButton('From current position', fill), h('span', { class: 'unit' }, 'rad'))),
        read: () => readNumbers(rows.map((row) => row.input), bounds, names, 'rad'),
        set,
    };
}

function readNumbers(inputs: readonly HTMLInputElement[], bounds: readonly Bounds[], names: readonly string[], unit?: string): Parsed | null {
    const texts = inputs.map((input) => input.value);
    return texts.every((text) => text.trim() === '') ? null : parseNumbers(texts, bounds, names, unit);
}

interface PoseInputs {
    element: HTMLElement;
    inputs: HTMLInputElement[];
    set: (value: unknown) => void;
}

function poseInputs(id: string, label: string, changed: () => void): PoseInputs {
    const inputs = kPoseNames.map((name, i) => numberInput(
        { 'id': i === 0 ? id : `${id}-${name}`, 'aria-label': `${label} ${name} in ${kPoseUnits[i] as string}` }, i < 3 ? 0.01 : 0.05, changed));
    const cells = inputs.map((input, i) => h('label', { class: 'cell' }, h('span', {}, `${kPoseNames[i] as string} `, h('small', {}, kPoseUnits[i] as string)), input));
    const set = (value: unknown): void => inputs.forEach((input, i) => {
        input.value = Array.isArray(value) && typeof value[i] === 'number' ? format(Math.round((value[i] as number) * 1e5) / 1e5) : '';
    });
    return { element: h('div', { class: 'cells pose' }, ...cells), inputs, set };
}

export function poseEditor(field: Field, options: TargetOptions): Editor {
    const pose = poseInputs(options.id, field.name, options.changed);
    const fill = (): void => {
        pose.set(options.currentFrame());
        options.changed();
    };
    return {
        element: h('div', { class: 'target' }, pose.element, h('div', { class: 'fill' }, fillButton('From current pose', fill))),
        read: () => readNumbers(pose.inputs, kPoseNames.map(() => kFree), kPoseNames),
        set: pose.set,
    };
}

/** Poses one after the other; each can be taken from where the arm is. */
export function posesEditor(field: Field, options: TargetOptions): Editor {
    const list = h('ol', { class: 'poses' });
    let rows: PoseInputs[] = [];
    const add = (value: unknown): void => {
        const pose = poseInputs(`${options.id}-${rows.length}`, `${field.name} ${rows.length + 1}`, options.changed);
        const row = h('li', {}, pose.element, h('button', {
            'type': 'button', 'class': 'plain', 'aria-label': 'Remove this pose',
            'onclick': () => {
                rows = rows.filter((other) => other !== pose);
                row.remove();
                options.changed();
            },
        }, icon(kIcons.close)));
        pose.set(value);
        rows.push(pose);
        list.append(row);
    };
    const addCurrent = (): void => {
        add(options.currentFrame());
        options.changed();
    };
    return {
        element: h('div', { class: 'target' }, list, h('div', { class: 'fill' }, fillButton('Add current pose', addCurrent))),
        read: () => readPoses(rows),
        set: (value) => {
            rows = [];
            list.replaceChildren();
            if (Array.isArray(value)) value.forEach(add);
        },
    };
}

function readPoses(rows: readonly PoseInputs[]): Parsed | null {
    if (rows.length === 0) return null;
    const poses: unknown[] = [];
    for (let i = 0; i < rows.length; ++i) {
        const parsed = parseNumbers((rows[i] as PoseInputs).inputs.map((input) => input.value), kPoseNames.map(() => kFree), kPoseNames);
        if ('error' in parsed) return { error: `pose ${i + 1}: ${parsed.error}` };
        poses.push(parsed.value);
    }
    return { value: poses };
}
