// Shapes, colours and times of what is drawn; no browser.

import assert from 'node:assert/strict';
import { join } from 'node:path';
import { test } from 'node:test';
import { Box3, Vector3 } from 'three';
import type { Arm, RecordRow } from '../src/api/types.js';
import { coneGeometry, profile } from '../src/scene/cone.js';
import { ArmFrames, shapesOf } from '../src/scene/arm_view.js';
import { spread } from '../src/scene/cell_view.js';
import { lengthOf, positionAt, timedPath } from '../src/scene/overlays.js';
import { niceSpeed, speedColor } from '../src/scene/speed_color.js';
import { framing } from '../src/scene/viewer.js';
import { Chain } from '../src/kinematics/chain.js';
import { barsOf } from '../src/ui/strip.js';
import { overlay, velocities } from '../src/ui/record_view.js';
import { durationText, subStateWords, words } from '../src/ui/format.js';
import { readArm } from './fake/model_file.js';
import { kSource } from './fake/places.js';

test('a cone is as wide and as long as its primitive says, with rounded edges', () => {
    const points = profile(0.05, 0.03, 0.2, 0.01);
    assert.equal(Math.max(...points.map((point) => point.x)), 0.05);
    assert.equal(points.at(-1)?.y, 0.2);
    assert.ok(points.every((point) => point.y >= -1e-12 && point.y <= 0.2 + 1e-12));
    const geometry = coneGeometry({ link: 0, from: [0, 0, 0.1], to: [0, 0, 0.3], from_radius: 0.05, to_radius: 0.05, color: [1, 1, 1] });
    geometry.computeBoundingBox();
    const box = geometry.boundingBox as Box3;
    assert.ok(Math.abs(box.min.z - 0.1) < 1e-6 && Math.abs(box.max.z - 0.3) < 1e-6 && Math.abs(box.max.x - 0.05) < 1e-6);
});

test('every model has shapes on its links, and the drawn flange is where the chain says', () => {
    for (const name of ['ur5', 'ur5e', 'iiwa7', 'iiwa14', 'edo']) {
        const arm = readArm(join(kSource, `models/${name}.toml`), name, [0.5, 0.2, 0, 0, 0, 0.7]);
        assert.ok(shapesOf(arm).every((shape) => shape.link <= arm.joints.length), name);
        assert.ok(arm.visuals.length >= 19, `${name}: ${arm.visuals.length} primitives`);
        const frames = new ArmFrames({ ...arm, base: [0, 0, 0, 0, 0, 0] });
        frames.setJoints(arm.home);
        frames.root.updateMatrixWorld(true);
        const drawn = new Vector3().setFromMatrixPosition(frames.flange.matrixWorld);
        const expected = new Chain(arm).flange(arm.home).translation;
        assert.ok(drawn.distanceTo(new Vector3(...expected)) < 1e-9, name);
    }
});

test('an arm without a model is drawn as rods', () => {
    const arm = { ...readArm(join(kSource, 'models/ur5.toml'), 'ur5', [0, 0, 0, 0, 0, 0]), visuals: [] };
    assert.ok(shapesOf(arm).length >= 4);
});

test('arms on one spot are put beside each other', () => {
    const at = (x: number): Arm => ({ base: [x, 0, 0, 0, 0, 0] }) as unknown as Arm;
    assert.deepEqual(spread([at(0), at(0), at(0)]).map((arm) => Math.round(arm.base[0] * 10) / 10), [0, 1.4, 2.8]);
    const apart = [at(0), at(1.5)];
    assert.deepEqual(spread(apart), apart);
});

test('a camera is just so far away that it sees all of a box, in the middle', () => {
    const box = new Box3(new Vector3(-1, -1, -1), new Vector3(1, 1, 1));
    const level = framing(box, new Vector3(0, -1, 0), new Vector3(0, 0, 1), 1, 0.5);
    assert.ok(Math.abs(level.distance - 3) < 1e-9 && level.target.length() < 1e-9, `${level.distance}`);
    const from = new Vector3(0.4, -1, 0.6).normalize();
    const { target, distance } = framing(box, from, new Vector3(0, 0, 1), 0.6, 0.4);
    const right = new Vector3(0, 0, 1).cross(from).normalize();
    const sides = [-1, 1].flatMap((x) => [-1, 1].flatMap((y) => [-1, 1].map((z) => {
        const at = new Vector3(x, y, z).sub(target);
        return at.dot(right) / (distance - at.dot(from));
    })));
    assert.ok(Math.abs(Math.max(...sides) + Math.min(...sides)) < 1e-3, 'it is in the middle');
    assert.ok(Math.max(...sides) < 0.6 + 1e-9, 'it is all seen');
});

test('a path is on lines between its points, and rests at its ends', () => {
    const path = timedPath([{ time: 5, q: [0] }, { time: 6, q: [1] }, { time: 8, q: [1] }]);
    assert.equal(lengthOf(path), 3);
    assert.deepEqual([-1, 0.5, 2, 99].map((time) => positionAt(path, time)), [[0], [0.5], [1], [1]]);
    assert.equal(positionAt(timedPath([]), 0), null);
});

test('speed is told by a scale with round ends', () => {
    assert.deepEqual([0, 0.06, 0.25, 0.26, 40].map(niceSpeed), [0.05, 0.1, 0.25, 0.5, 10]);
    assert.deepEqual(speedColor(-1), speedColor(0));
    assert.deepEqual(speedColor(7), speedColor(1));
    assert.notDeepEqual(speedColor(0.4), speedColor(0.6));
});

test('executions are bars on the lanes of their servers', () => {
    const row = (number: number, server: string, started: number, ended: number | null): RecordRow => ({ number, id: '', server, skill: 'Move', started, ended, state: 'Ready' });
    const { lanes, bars } = barsOf([row(1, 'b', 100, 110), row(2, 'a', 110, null)], 120);
    assert.deepEqual(lanes, ['a', 'b']);
    assert.deepEqual(bars.map((bar) => [bar.lane, bar.from, bar.to]), [[1, 0, 0.5], [0, 0.5, 1]]);
});

test('two runs share one time axis, with gaps where a run has no point', () => {
    const data = overlay([{ time: [0, 1], columns: [[5, 6]] }, { time: [0, 0.5], columns: [[7, 8]] }]);
    assert.deepEqual(data, [[0, 0.5, 1], [5, null, 6], [7, 8, null]]);
});

test('velocities come from neighbours', () => {
    assert.deepEqual(velocities([{ time: 0, q: [0] }, { time: 1, q: [2] }, { time: 2, q: [4] }]), [[2], [2], [2]]);
    assert.deepEqual(velocities([{ time: 0, q: [0] }]), [[0]]);
});

test('names and durations are words', () => {
    assert.equal(words('CartesianLinearMoveSkill'), 'Cartesian Linear Move');
    assert.equal(subStateWords('Halted', 'HaltedOwnerLost'), 'owner lost');
    assert.deepEqual([0.5, 12.34, 65, 7300, -1].map(durationText), ['0.50 s', '12.3 s', '1 min 05 s', '2 h 01 min', '\u2013']);
});
