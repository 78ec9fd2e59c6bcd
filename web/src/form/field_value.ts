// Between the values of a skill's parameters and what a person types. Pure; tested without a browser.

import type { Arm, Field } from '../api/types.js';

/** How a field is edited. */
export type Editor = 'number' | 'integer' | 'flag' | 'text' | 'choice' | 'joints' | 'pose' | 'poses' | 'list' | 'ranges' | 'texts';

const kInteger = new Set(['int', 'int32', 'uint32', 'uint64', 'integer']);
const kNumber = new Set(['double', 'number', 'float']);
const kList = new Set(['numbers', 'doubles', 'vector3', 'list']);

export function editorOf(field: Field): Editor {
    if (field.type === 'bool' || field.type === 'boolean') return 'flag';
    if (field.type === 'frame' || (field.role === 'pose' && field.type !== 'frames')) return 'pose';
    if (field.type === 'frames') return 'poses';
    if (field.type === 'ranges') return 'ranges';
    if (field.type === 'texts') return 'texts';
    if (field.role === 'joints') return 'joints';
    if (kList.has(field.type) || ((field.rank ?? 0) > 0 && kNumber.has(field.type))) return 'list';
    if (kInteger.has(field.type)) return 'integer';
    if (kNumber.has(field.type)) return 'number';
    return (field.choices?.length ?? 0) > 0 ? 'choice' : 'text';
}

export interface Bounds {
    low: number;
    high: number;
}

export type Parsed = { value: unknown } | { error: string };

function withUnit(value: number, unit: string | undefined): string {
    return unit === undefined || unit === '' ? format(value) : `${format(value)} ${unit}`;
}

/** A number as short as it may be without losing what matters: 6 digits. */
export function format(value: number): string {
    if (!Number.isFinite(value)) return String(value);
    const text = String(Number(value.toPrecision(6)));
    return text === '-0' ? '0' : text;
}

export function boundsOf(field: Field): Bounds {
    return { low: field.minimum ?? -Infinity, high: field.maximum ?? Infinity };
}

/** The range in words for below an entry; "" where there is none or none worth a word. */
export function rangeText(field: Field): string {
    const { low, high } = boundsOf(field);
    if (high > 1e9 || (low === -Infinity && high === Infinity)) return '';
    if (low === -Infinity) return `up to ${withUnit(high, field.unit)}`;
    if (high === Infinity) return `from ${withUnit(low, field.unit)}`;
    return `${format(low)} to ${withUnit(high, field.unit)}`;
}

/** One number from text. A decimal comma is taken as a point. */
export function parseNumber(text: string, bounds: Bounds, unit?: string): Parsed {
    const clean = text.trim().replace(',', '.').replace('\u2212', '-');
    if (clean === '') return { error: 'A number is missing' };
    if (!/^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i.test(clean)) return { error: `"${text.trim()}" is not a number` };
    const value = Number(clean);
    if (!Number.isFinite(value)) return { error: 'Too large a number' };
    if (value < bounds.low) return { error: `${withUnit(value, unit)} is below ${withUnit(bounds.low, unit)}` };
    if (value > bounds.high) return { error: `${withUnit(value, unit)} is above ${withUnit(bounds.high, unit)}` };
    return { value };
}

export function parseInteger(text: string, bounds: Bounds): Parsed {
    const parsed = parseNumber(text, bounds);
    if ('value' in parsed && !Number.isInteger(parsed.value)) return { error: 'Must be a whole number' };
    return parsed;
}

/** Numbers of a list in separate entries; the first mistake names its entry. */
export function parseNumbers(texts: readonly string[], bounds: readonly Bounds[], names: readonly string[], unit?: string): Parsed {
    const values: number[] = [];
    for (let i = 0; i < texts.length; ++i) {
        const parsed = parseNumber(texts[i] ?? '', bounds[i] ?? { low: -Infinity, high: Infinity }, unit);
        if ('error' in parsed) return { error: `${names[i] ?? `value ${i + 1}`}: ${parsed.error}` };
        values.push(parsed.value as number);
    }
    return { value: values };
}

/** Numbers of any count in one entry, separated by commas, semicolons or blanks. */
export function parseFreeList(text: string, field: Field): Parsed {
    const parts = text.split(/[\s,;]+/).filter((part) => part !== '');
    const parsed = parseNumbers(parts, parts.map(() => boundsOf(field)), [], field.unit);
    if ('error' in parsed) return parsed;
    const count = parts.length;
    if (count < (field.least ?? 0)) return { error: `${count} values, not at least ${field.least}` };
    if (count > (field.most ?? Infinity)) return { error: `${count} values, not at most ${field.most}` };
    return parsed;
}

/** "low..high" for each axis. */
export function parseRanges(text: string): Parsed {
    const ranges: number[][] = [];
    for (const part of text.split(/[,;\n]+/).filter((piece) => piece.trim() !== '')) {
        const ends = part.split('..').map((end) => Number(end.trim()));
        const [low, high] = ends;
        if (ends.length !== 2 || low === undefined || high === undefined || Number.isNaN(low) || Number.isNaN(high)) {
            return { error: `"${part.trim()}" is not a range such as -1.5..1.5` };
        }
        if (low > high) return { error: `${low} is above ${high}` };
        ranges.push([low, high]);
    }
    return { value: ranges };
}

export function rangesText(value: unknown): string {
    if (!Array.isArray(value)) return '';
    return value.map((range) => (Array.isArray(range) ? `${format(Number(range[0]))}..${format(Number(range[1]))}` : '')).join(', ');
}

export const kPoseNames = ['x', 'y', 'z', 'a', 'b', 'c'];
export const kPoseUnits = ['m', 'm', 'm', 'rad', 'rad', 'rad'];

/** Bounds of each joint: those of the field, narrowed to the arm's. A relative target may be anything within the field's. */
export function jointBounds(field: Field, arm: Arm | null, relative: boolean): Bounds[] {
    const own = boundsOf(field);
    const count = arm?.joints.length ?? field.rank ?? 0;
    return Array.from({ length: count }, (_, i) => {
        const joint = arm?.joints[i];
        if (joint === undefined || relative) return own;
        return { low: Math.max(own.low, joint.lower), high: Math.min(own.high, joint.upper) };
    });
}

/** Whether a person must give a value. */
export function isRequired(field: Field): boolean {
    return (field.default === undefined || field.default === null) && field.optional !== true && field.kind !== 'option';
}

/** The default in words; "" where there is none. */
export function defaultText(field: Field): string {
    const value = field.default;
    if (value === undefined || value === null || value === '') return '';
    if (typeof value === 'number') return withUnit(value, field.unit);
    if (Array.isArray(value)) return allZero(value) ? 'the robot\u2019s own' : shortText(value);
    return String(value);
}

function allZero(value: unknown): boolean {
    return Array.isArray(value) ? value.every(allZero) : value === 0;
}

/** A value in a line: numbers rounded, lists in brackets, objects as key: value. */
export function shortText(value: unknown): string {
    if (value === null || value === undefined) return '\u2013';
    if (typeof value === 'number') return format(value);
    if (typeof value === 'boolean') return value ? 'yes' : 'no';
    if (Array.isArray(value)) return `[${value.map(shortText).join(', ')}]`;
    if (typeof value === 'object') {
        return Object.entries(value as Record<string, unknown>).map(([key, item]) => `${key}: ${shortText(item)}`).join(', ');
    }
    return String(value);
}
