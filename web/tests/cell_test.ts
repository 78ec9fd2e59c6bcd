// A person at the page, in a browser, before the demo cell: real servers over virtual controllers, and `metier dashboard`.

import { strict as assert } from 'node:assert';
import { spawn } from 'node:child_process';
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import type { Browser, Page } from 'playwright-core';
import {
    press, picture, skill, startBrowser, startProgram, takeControl, visit, waitForMotion, waitForState, withVisit, type Program,
} from './fake/browser.js';
import { tetrahedron, tetrahedronAsCollada, urdfOf } from './fake/meshes.js';
import { readArm } from './fake/model_file.js';
import { kBuilt, kSource } from './fake/places.js';

const kMetier = process.env['METIER'] ?? '';
const kLab = '--insecure-lab';

interface Endpoints {
    servers: { name: string; url: string }[];
}

const folder = mkdtempSync(join(tmpdir(), 'metier-page-'));
const endpoints_file = join(folder, 'endpoints.json');
const records_file = join(folder, 'records.db');
const cell_file = join(folder, 'demo.toml');
/** The demo's cell, with records of its own: a cell with free ports keeps none unless it says where. */
const demo = readFileSync(join(kSource, 'cells/demo.toml'), 'utf8').replaceAll('"../models/', `"${kSource}/models/`);
writeFileSync(cell_file, `${demo}\n[records]\nurl = "${records_file}"\n`);

/** Fewer pixels to draw without a graphics card. */
const kSmall = { width: 1180, height: 720 };

let browser: Browser;
let cell: Program;
let dashboard: Program;
let url = '';

function startDashboard(...more: string[]): Promise<Program> {
    const web = join(kBuilt, 'dist');
    return startProgram(kMetier, [kLab, 'dashboard', '--cell', cell_file, '--endpoints', endpoints_file, '--port', '0', '--web', web, '--records', records_file, ...more], /^ready http/);
}

function addressOf(program: Program): string {
    return program.line.replace('ready ', '');
}

before(async () => {
    [browser, cell] = await Promise.all([
        startBrowser(), startProgram(kMetier, [kLab, 'up', cell_file, '--free-ports', '--endpoints', endpoints_file], /the cell is up/)]);
    dashboard = await startDashboard();
    url = addressOf(dashboard);
}, { timeout: 180_000 });

after(async () => {
    await browser?.close();
    await dashboard?.end();
    await cell?.end();
    rmSync(folder, { recursive: true, force: true });
});

function keyOf(server: string, name: string): string {
    return `[data-skill^="${server}/"][data-skill$="/${name}"]`;
}

/** The key of a skill of a server, once the page has it. */
async function findSkill(page: Page, server: string, name: string): Promise<string> {
    const row = page.locator(keyOf(server, name));
    await row.waitFor({ state: 'attached' });
    return (await row.getAttribute('data-skill')) as string;
}

async function choose(page: Page, server: string, name: string): Promise<string> {
    const key = await findSkill(page, server, name);
    await waitForState(page, key, 'ready');
    await skill(page, key).click();
    return key;
}

function firstJoint(page: Page): ReturnType<Page['locator']> {
    return page.locator('[data-field=TargetJointPosition] .joint input[type=text]').first();
}

/** Starts `metier square` on one arm, as another client; the promise ends with its exit status. */
function drawSquare(server: string): Promise<number | null> {
    const endpoints = JSON.parse(readFileSync(endpoints_file, 'utf8')) as Endpoints;
    const address = endpoints.servers.find((one) => one.name === server)?.url ?? '';
    const child = spawn(kMetier, [kLab, 'square', address, '--laps', '2'], { stdio: 'ignore' });
    return new Promise((resolve) => child.once('exit', resolve));
}

test('watches the square of another client', { timeout: 240_000 }, () => withVisit(browser, url, async (page) => {
    const key = await findSkill(page, 'iiwa', 'CartesianLinearMoveSkill');
    const done = drawSquare('iiwa');
    await waitForState(page, key, 'running');
    await waitForMotion(page);
    await page.locator('[aria-label="Arm"] button', { hasText: 'iiwa' }).click();
    // The iiwa's cabinet tells the force on the flange; every driver counts its cycles.
    for (const title of ['Joint position', 'Joint velocity', 'Force', 'Cycle jitter']) {
        await page.locator('.chart:not(.none) figcaption', { hasText: title }).waitFor();
    }
    await picture(page, 'cell_square_dark');
    assert.equal(await done, 0);
    await waitForState(page, key, 'ready');
}, { ...kSmall, dark: true }));

/** A place for the first joint that is far from where it is [rad]: it is on its way for longer than the page needs to draw it. */
async function farFromHere(page: Page): Promise<string> {
    await page.click('text=From current position');
    return Number(await firstJoint(page).inputValue()) > 0 ? '-1.2' : '1.2';
}

/** Has the iiwa move its first axis there [rad], from the form, and waits until it has. */
async function moveFirstJoint(page: Page, key: string, target: string): Promise<void> {
    await page.click('text=From current position');
    await firstJoint(page).fill(target);
    await press(page, 'check');
    await page.locator('.verdict .good').waitFor();
    await press(page, 'start');
    await waitForState(page, key, 'running');
    await waitForState(page, key, 'ready');
}

test('runs a move from the form', { timeout: 240_000 }, () => withVisit(browser, url, async (page) => {
    await takeControl(page);
    const key = await choose(page, 'iiwa', 'JointPtpMoveSkill');
    const target = await farFromHere(page);
    await moveFirstJoint(page, key, target);
    await picture(page, 'cell_moved_light');
    await page.click('text=From current position');
    await page.waitForFunction(([selector, wanted]) => {
        document.querySelector<HTMLButtonElement>('.fill button')?.click();
        return Math.abs(Number(document.querySelector<HTMLInputElement>(selector as string)?.value) - Number(wanted)) < 0.01;
    }, ['[data-field=TargetJointPosition] .joint input[type=text]', target] as const);
}, kSmall));

test('finds executions, looks at one, replays it, and compares two', { timeout: 240_000 }, () => withVisit(browser, url, async (page) => {
    await takeControl(page);
    const key = await choose(page, 'iiwa', 'JointPtpMoveSkill');
    for (let i = 0; i < 2; ++i) await moveFirstJoint(page, key, await farFromHere(page));
    await page.click('#tab-timeline');
    const rows = page.locator('tr[data-record]');
    await page.fill('[aria-label="Search executions"]', 'nothing of that name');
    await page.locator('.timeline-list', { hasText: 'No execution fits.' }).waitFor();
    await page.fill('[aria-label="Search executions"]', 'JointPtp');
    await rows.nth(1).waitFor();
    await page.selectOption('[aria-label="Server"]', 'wsg50');
    await page.locator('.timeline-list', { hasText: 'No execution fits.' }).waitFor();
    await page.selectOption('[aria-label="Server"]', 'iiwa');
    await rows.nth(1).waitFor();
    await rows.first().locator('button.link').click();
    await page.locator('.record h3', { hasText: 'Joint Ptp Move' }).waitFor();
    await page.locator('.transitions td', { hasText: 'Ready \u2192 Running' }).waitFor();
    await page.locator('.record .chart canvas').first().waitFor();
    await picture(page, 'cell_record_light');
    await page.click('#replay');
    await page.locator('.replay strong', { hasText: 'not live' }).waitFor();
    await page.waitForFunction(() => Number(document.querySelector<HTMLInputElement>('.replay input')?.value) > 0);
    await picture(page, 'cell_replay_light');
    await page.click('[aria-label="End the replay"]');
    for (const row of [0, 1]) await rows.nth(row).locator('input[type=checkbox]').check();
    await page.locator('.record h3', { hasText: 'Comparison' }).waitFor();
    assert.equal(await page.locator('.record .facts .run-mark').count(), 2);
    await picture(page, 'cell_compare_light');
}));

test('is refused a pose out of reach and sees why', { timeout: 240_000 }, () => withVisit(browser, url, async (page) => {
    await takeControl(page);
    const key = await choose(page, 'ur5-move', 'CartesianLinearMoveSkill');
    await page.locator('[data-field=TargetPosition] input').first().fill('3');
    await press(page, 'start');
    await page.locator('.verdict .bad p').waitFor();
    assert.match(await page.locator('.verdict').innerText(), /reach|limit|unreachable/i);
    await waitForState(page, key, 'ready');
    await picture(page, 'cell_refused_light');
}, kSmall));

test('halts a move on its way', { timeout: 240_000 }, () => withVisit(browser, url, async (page) => {
    const key = await choose(page, 'edo-move', 'JointPtpMoveSkill');
    await takeControl(page);
    await page.locator('.mode[data-control=all]').waitFor();
    await page.locator('.toast', { hasText: 'Left out: ur5, edo' }).waitFor();
    assert.equal(await page.locator('[data-server=edo] .users').innerText(), 'used by edo-move');
    await page.click('text=From current position');
    await firstJoint(page).fill(Number(await firstJoint(page).inputValue()) > 0 ? '-2' : '2');
    await press(page, 'start');
    await waitForState(page, key, 'running');
    await page.click('#halt-all');
    await waitForState(page, key, 'halted');
    await picture(page, 'cell_halted_light');
    await press(page, 'reset');
    await waitForState(page, key, 'ready');
}, kSmall));

test('frees what a closed tab controlled', { timeout: 240_000 }, () => withVisit(browser, url, async (page) => {
    const other = await visit(browser, url);
    await other.page.locator('.link-state[data-link=live]').waitFor();
    await takeControl(other.page);
    await page.locator('[data-server=iiwa] .owner:not(:text-is("free"))').waitFor();
    await other.close();
    await page.locator('[data-server=iiwa] .owner', { hasText: 'free' }).waitFor();
}, kSmall));

test('draws a user\u2019s own meshes', { timeout: 240_000 }, async () => {
    const meshes = join(folder, 'meshes');
    mkdirSync(meshes);
    writeFileSync(join(meshes, 'link.stl'), tetrahedron(0.08));
    writeFileSync(join(meshes, 'link.dae'), tetrahedronAsCollada(0.08));
    for (const [model, file] of [['iiwa7', 'link.stl'], ['ur5', 'link.dae']] as const) {
        writeFileSync(join(meshes, `${model}.urdf`), urdfOf(readArm(join(kSource, `models/${model}.toml`), model, [0, 0, 0, 0, 0, 0]), file));
    }
    const program = await startDashboard('--meshes', meshes);
    try {
        await withVisit(browser, addressOf(program), async (page) => {
            for (const arm of ['iiwa', 'ur5']) await page.locator(`.stage[data-meshes~=${arm}]`).waitFor();
            await picture(page, 'cell_meshes_light');
        }, kSmall);
    } finally {
        await program.end();
    }
});
