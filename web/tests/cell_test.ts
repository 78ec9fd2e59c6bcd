// A person at the page, in a browser, before the demo cell: real servers over virtual controllers, and `metier dashboard`.

import { strict as assert } from 'node:assert';
import { spawn } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import type { Browser, Page } from 'playwright-core';
import {
    press, picture, skill, startBrowser, startProgram, takeControl, visit, waitForMotion, waitForState, withVisit, type Program,
} from './fake/browser.js';
import { kBuilt, kSource } from './fake/places.js';

const kMetier = process.env['METIER'] ?? '';
const kLab = '--insecure-lab';

interface Endpoints {
    servers: { name: string; url: string }[];
}

const folder = mkdtempSync(join(tmpdir(), 'metier-page-'));
const endpoints_file = join(folder, 'endpoints.json');
const cell_file = join(kSource, 'cells/demo.toml');

/** Fewer pixels to draw without a graphics card. */
const kSmall = { width: 1180, height: 720 };

let browser: Browser;
let cell: Program;
let dashboard: Program;
let url = '';

before(async () => {
    [browser, cell] = await Promise.all([
        startBrowser(), startProgram(kMetier, [kLab, 'up', cell_file, '--free-ports', '--endpoints', endpoints_file], /the cell is up/)]);
    const web = join(kBuilt, 'dist');
    dashboard = await startProgram(kMetier, [kLab, 'dashboard', '--cell', cell_file, '--endpoints', endpoints_file, '--port', '0', '--web', web], /^ready http/);
    url = dashboard.line.replace('ready ', '');
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
    await picture(page, 'cell_square_dark');
    assert.equal(await done, 0);
    await waitForState(page, key, 'ready');
}, { ...kSmall, dark: true }));

test('runs a move from the form', { timeout: 240_000 }, () => withVisit(browser, url, async (page) => {
    await takeControl(page);
    const key = await choose(page, 'iiwa', 'JointPtpMoveSkill');
    await page.click('text=From current position');
    const target = Number(await firstJoint(page).inputValue()) > 0 ? '-0.4' : '0.4';
    await firstJoint(page).fill(target);
    await press(page, 'check');
    await page.locator('.verdict .good').waitFor();
    await picture(page, 'cell_checked_light');
    await press(page, 'start');
    await waitForState(page, key, 'running');
    await waitForState(page, key, 'ready');
    await page.click('text=From current position');
    await page.waitForFunction(([selector, wanted]) => {
        document.querySelector<HTMLButtonElement>('.fill button')?.click();
        return Math.abs(Number(document.querySelector<HTMLInputElement>(selector as string)?.value) - Number(wanted)) < 0.01;
    }, ['[data-field=TargetJointPosition] .joint input[type=text]', target] as const);
}, kSmall));

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
    const key = await choose(page, 'iiwa', 'JointPtpMoveSkill');
    await takeControl(page);
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
