// Entries for the simple kinds of fields. Each reads what a person typed; empty means not set.

import type { Field } from '../api/types.js';
import { h } from '../ui/dom.js';
import {
    boundsOf, defaultText, format, parseFreeList, parseInteger, parseNumber, parseNumbers, parseRanges, rangesText, type Bounds, type Parsed,
} from './field_value.js';

export interface Editor {
    readonly element: HTMLElement;
    /** null: not set. */
    read(): Parsed | null;
    set(value: unknown): void;
}

export interface EditorOptions {
    id: string;
    changed: () => void;
}

/** Arrow keys step numbers: by 1 % of a usual value; with Shift ten times, with Alt a tenth of it. */
export function stepWithArrows(input: HTMLInputElement, step: number): void {
    input.addEventListener('keydown', (event) => {
        const sign = event.key === 'ArrowUp' ? 1 : event.key === 'ArrowDown' ? -1 : 0;
        if (sign === 0) return;
        event.preventDefault();
        const size = step * (event.shiftKey ? 10 : event.altKey ? 0.1 : 1);
        const value = Number(input.value.replace(',', '.')) || 0;
        input.value = format(Math.round((value + sign * size) / (size / 10)) * (size / 10));
        input.dispatchEvent(new Event('input', { bubbles: true }));
    });
}

export function numberInput(properties: Record<string, string>, step: number, changed: () => void): HTMLInputElement {
    const input = h('input', { type: 'text', inputmode: 'decimal', autocomplete: 'off', spellcheck: 'false', ...properties, oninput: changed });
    stepWithArrows(input, step);
    return input;
}

function stepOf(unit: string | undefined): number {
    return unit === 'm' ? 0.01 : unit === 'N' ? 1 : 0.05;
}

function unitText(unit: string | undefined): HTMLElement | null {
    return unit === undefined || unit === '' ? null : h('span', { class: 'unit' }, unit);
}

export function numberEditor(field: Field, options: EditorOptions, integer: boolean): Editor {
    const input = numberInput({ id: options.id, placeholder: defaultText(field) || 'not set' }, integer ? 1 : stepOf(field.unit), options.changed);
    return {
        element: h('div', { class: 'entry' }, input, unitText(field.unit)),
        read: () => {
            if (input.value.trim() === '') return null;
            return integer ? parseInteger(input.value, boundsOf(field)) : parseNumber(input.value, boundsOf(field), field.unit);
        },
        set: (value) => (input.value = typeof value === 'number' ? format(value) : ''),
    };
}

export function flagEditor(field: Field, options: EditorOptions): Editor {
    const input = h('input', { type: 'checkbox', id: options.id, onchange: options.changed });
    const initial = field.default === true;
    input.checked = initial;
    return {
        element: h('div', { class: 'entry flag' }, input),
        read: () => (input.checked === initial ? null : { value: input.checked }),
        set: (value) => (input.checked = value === true),
    };
}

export function textEditor(field: Field, options: EditorOptions): Editor {
    const input = h('input', { type: 'text', id: options.id, autocomplete: 'off', placeholder: defaultText(field) || 'not set', oninput: options.changed });
    return {
        element: h('div', { class: 'entry' }, input),
        read: () => (input.value === '' ? null : { value: input.value }),
        set: (value) => (input.value = typeof value === 'string' ? value : ''),
    };
}

export function choiceEditor(field: Field, options: EditorOptions, choices: readonly string[]): Editor {
    const first = defaultText(field) || 'not set';
    const select = h('select', { id: options.id, onchange: options.changed },
        h('option', { value: '' }, first), ...choices.map((choice) => h('option', { value: choice }, choice)));
    return {
        element: h('div', { class: 'entry' }, select),
        read: () => (select.value === '' ? null : { value: select.value }),
        set: (value) => (select.value = typeof value === 'string' ? value : ''),
    };
}

const kAxisNames = ['x', 'y', 'z', 'about x', 'about y', 'about z'];

/** Numbers of a known count, an entry each; all empty means not set. */
export function listEditor(field: Field, options: EditorOptions, names: readonly string[], bounds: readonly Bounds[]): Editor {
    const inputs = names.map((name, i) =>
        numberInput({ 'id': i === 0 ? options.id : `${options.id}-${i}`, 'aria-label': `${field.name} ${name}`, 'placeholder': placeholderOf(field, i) }, stepOf(field.unit), options.changed));
    return {
        element: h('div', { class: 'cells' }, ...inputs.map((input, i) => h('label', { class: 'cell' }, h('span', {}, names[i] as string), input)), unitText(field.unit)),
        read: () => {
            const texts = inputs.map((input) => input.value);
            if (texts.every((text) => text.trim() === '')) return null;
            return parseNumbers(texts, bounds, names, field.unit);
        },
        set: (value) => inputs.forEach((input, i) => (input.value = Array.isArray(value) && typeof value[i] === 'number' ? format(value[i] as number) : '')),
    };
}

function placeholderOf(field: Field, i: number): string {
    const value = Array.isArray(field.default) ? (field.default as unknown[])[i] : undefined;
    return typeof value === 'number' ? (value === 0 ? 'own' : format(value)) : '';
}

/** Names of a list's entries: x, y, z, then rotations for Cartesian limits; else axis numbers. */
export function namesOf(field: Field, count: number, axes: number): string[] {
    const cartesian = (count === 6 || count === 3) && (count !== axes || /x, y, z/.test(field.description ?? ''));
    return Array.from({ length: count }, (_, i) => (cartesian ? (kAxisNames[i] as string) : `${i + 1}`));
}

export function freeListEditor(field: Field, options: EditorOptions): Editor {
    const input = h('input', { type: 'text', id: options.id, autocomplete: 'off', placeholder: defaultText(field) || 'none', oninput: options.changed });
    return {
        element: h('div', { class: 'entry' }, input, unitText(field.unit)),
        read: () => (input.value.trim() === '' ? null : parseFreeList(input.value, field)),
        set: (value) => (input.value = Array.isArray(value) ? value.map((item) => format(Number(item))).join(', ') : ''),
    };
}

export function rangesEditor(field: Field, options: EditorOptions): Editor {
    const input = h('input', { type: 'text', id: options.id, autocomplete: 'off', placeholder: defaultText(field) || '-1..1, -2..2', oninput: options.changed });
    return {
        element: h('div', { class: 'entry' }, input, unitText(field.unit)),
        read: () => (input.value.trim() === '' ? null : parseRanges(input.value)),
        set: (value) => (input.value = rangesText(value)),
    };
}

export function textsEditor(_field: Field, options: EditorOptions): Editor {
    const input = h('input', { type: 'text', id: options.id, autocomplete: 'off', placeholder: 'names, separated by commas', oninput: options.changed });
    return {
        element: h('div', { class: 'entry' }, input),
        read: () => {
            const texts = input.value.split(',').map((text) => text.trim()).filter((text) => text !== '');
            return texts.length === 0 ? null : { value: texts };
        },
        set: (value) => (input.value = Array.isArray(value) ? value.join(', ') : ''),
    };
}
