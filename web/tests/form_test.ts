// What a person types against what a skill takes.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { Arm, Field } from '../src/api/types.js';
import {
    boundsOf, defaultText, editorOf, format, isRequired, jointBounds, parseFreeList, parseInteger, parseNumber, parseNumbers, parseRanges, rangesText, rangeText, shortText,
} from '../src/form/field_value.js';

function field(more: Partial<Field>): Field {
    return { name: 'Width', type: 'number', unit: 'm', ...more };
}

const kWide = { low: -Infinity, high: Infinity };

test('a number is taken with point or comma, and with an exponent', () => {
    for (const [text, value] of [['0.25', 0.25], [' -1,5 ', -1.5], ['1e-3', 0.001], ['.5', 0.5], ['\u22122', -2]] as const) {
        assert.deepEqual(parseNumber(text, kWide), { value });
    }
});

test('what is no number is refused with the text', () => {
    for (const text of ['abc', '1.2.3', '0x10', 'Infinity', 'NaN', '1 2', '--1', '1e999']) {
        const parsed = parseNumber(text, kWide);
        assert.ok('error' in parsed, text);
    }
    assert.deepEqual(parseNumber('abc', kWide), { error: '"abc" is not a number' });
    assert.deepEqual(parseNumber(' ', kWide), { error: 'A number is missing' });
});

test('a number out of range is refused with value, limit and unit', () => {
    const bounds = boundsOf(field({ minimum: 0, maximum: 0.11 }));
    assert.deepEqual(parseNumber('0.2', bounds, 'm'), { error: '0.2 m is above 0.11 m' });
    assert.deepEqual(parseNumber('-1', bounds, 'm'), { error: '-1 m is below 0 m' });
    assert.deepEqual(parseNumber('0.11', bounds, 'm'), { value: 0.11 });
});

test('a whole number must be whole', () => {
    assert.deepEqual(parseInteger('2', kWide), { value: 2 });
    assert.deepEqual(parseInteger('2.5', kWide), { error: 'Must be a whole number' });
});

test('the first mistake of a list names its entry', () => {
    const bounds = [kWide, { low: -1, high: 1 }];
    assert.deepEqual(parseNumbers(['0', '2'], bounds, ['A1', 'A2'], 'rad'), { error: 'A2: 2 rad is above 1 rad' });
    assert.deepEqual(parseNumbers(['0', '-1'], bounds, ['A1', 'A2'], 'rad'), { value: [0, -1] });
});

test('a free list is of numbers within its length', () => {
    assert.deepEqual(parseFreeList('1, 2;3 4', field({ type: 'numbers' })), { value: [1, 2, 3, 4] });
    assert.ok('error' in parseFreeList('1, x', field({ type: 'numbers' })));
    assert.deepEqual(parseFreeList('1 2 3', field({ type: 'numbers', most: 2 })), { error: '3 values, not at most 2' });
});

test('ranges are read and written', () => {
    assert.deepEqual(parseRanges('-1.5..1.5, 0..2'), { value: [[-1.5, 1.5], [0, 2]] });
    assert.equal(rangesText([[-1.5, 1.5], [0, 2]]), '-1.5..1.5, 0..2');
    assert.ok('error' in parseRanges('2..1'));
    assert.ok('error' in parseRanges('1-2'));
});

test('each kind of field has its entry', () => {
    const cases: [Partial<Field>, string][] = [
        [{ type: 'bool' }, 'flag'], [{ type: 'frame' }, 'pose'], [{ type: 'frames' }, 'poses'], [{ type: 'numbers', role: 'joints', rank: 6 }, 'joints'],
        [{ type: 'numbers', rank: 6 }, 'list'], [{ type: 'double', rank: 3 }, 'list'], [{ type: 'int32' }, 'integer'], [{ type: 'number' }, 'number'],
        [{ type: 'text' }, 'text'], [{ type: 'text', choices: ['a'] }, 'choice'], [{ type: 'ranges' }, 'ranges'], [{ type: 'vector3' }, 'list'], [{ type: 'texts' }, 'texts'],
    ];
    for (const [more, editor] of cases) assert.equal(editorOf(field(more)), editor, JSON.stringify(more));
});

test('a joint is bounded by the field and by the arm, a relative one by the field alone', () => {
    const arm = { joints: [{ lower: -3, upper: 1 }, { lower: -1, upper: 9 }] } as unknown as Arm;
    const joints = field({ type: 'numbers', role: 'joints', minimum: -2, maximum: 2 });
    assert.deepEqual(jointBounds(joints, arm, false), [{ low: -2, high: 1 }, { low: -1, high: 2 }]);
    assert.deepEqual(jointBounds(joints, arm, true), [{ low: -2, high: 2 }, { low: -2, high: 2 }]);
});

test('ranges and defaults are told in words', () => {
    assert.equal(rangeText(field({ minimum: 0, maximum: 0.11 })), '0 to 0.11 m');
    assert.equal(rangeText(field({ minimum: 0, maximum: 1e11 })), '');
    assert.equal(rangeText(field({ maximum: 5 })), 'up to 5 m');
    assert.equal(defaultText(field({ default: 20, unit: 'N' })), '20 N');
    assert.equal(defaultText(field({ default: [0, 0, 0] })), 'the robot\u2019s own');
    assert.equal(defaultText(field({})), '');
});

test('a parameter without default is needed, an option never', () => {
    assert.equal(isRequired(field({})), true);
    assert.equal(isRequired(field({ default: 0 })), false);
    assert.equal(isRequired(field({ kind: 'option' })), false);
    assert.equal(isRequired(field({ optional: true })), false);
});

test('values are short for a person', () => {
    assert.equal(format(0.1 + 0.2), '0.3');
    assert.equal(format(-0), '0');
    assert.equal(shortText([1.23456789, true, null]), '[1.23457, yes, \u2013]');
    assert.equal(shortText({ Width: 0.05 }), 'Width: 0.05');
});
