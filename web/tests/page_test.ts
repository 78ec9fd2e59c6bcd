// A person at the page, in a browser, before a cell that the fake dashboard makes up.

import { strict as assert } from 'node:assert';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import type { Browser, Page } from 'playwright-core';
import { press, picture, skill, startBrowser, startFake, takeControl, visit, waitForMotion, waitForState, withVisit, type Program } from './fake/browser.js';
import { urdfOf, tetrahedron } from './fake/meshes.js';
import { readArm } from './fake/model_file.js';
import { kSource } from './fake/places.js';

const kJointMove = 'iiwa/Controller/JointPtpMoveSkill';
const kLinear = 'ur5-move/Controller/CartesianLinearMoveSkill';

let browser: Browser;
let quiet: Program;
let squares: Program;

before(async () => {
    [browser, quiet, squares] = await Promise.all([startBrowser(), startFake(), startFake('--square')]);
});

after(async () => {
    await browser?.close();
    await Promise.all([quiet?.end(), squares?.end()]);
});

/** Types a joint's target and leaves the entry. */
async function setJoint(page: Page, index: number, value: string): Promise<void> {
    const inputs = page.locator('[data-field=TargetJointPosition] .joint input[type=text]');
    await inputs.nth(index).fill(value);
}

/** Where the form has the first joint: where the arm is, until somebody types. */
async function firstJointOf(page: Page): Promise<number> {
    return Number(await page.locator('[data-field=TargetJointPosition] .joint input[type=text]').first().inputValue());
}

async function chooseIdle(page: Page, key: string): Promise<void> {
    if (await skill(page, key).locator('.pill[data-state=halted]').count() > 0) {
        await skill(page, key).click();
        await press(page, 'reset');
    }
    await waitForState(page, key, 'ready');
    await skill(page, key).click();
}

test('watches three arms go around their squares', () => withVisit(browser, squares.line, async (page) => {
    await page.locator('.skill .pill[data-state=running]').nth(2).waitFor();
    await waitForMotion(page);
    await page.locator('.chart canvas').first().waitFor();
    assert.match(await page.locator('.mode').innerText(), /Read-only/);
    assert.match(await page.locator('[data-server=iiwa] .owner').innerText(), /demo client/);
    await picture(page, 'square_dark');
}, { dark: true }));

test('runs a move from the form, and the arm arrives', () => withVisit(browser, quiet.line, async (page) => {
    await takeControl(page);
    await chooseIdle(page, kJointMove);
    await setJoint(page, 0, '1.2');  // on its way for longer than the page needs to draw it
    await page.keyboard.press('Enter');
    await page.locator('.verdict .good').waitFor();
    await waitForMotion(page);
    await picture(page, 'checked_light');
    await press(page, 'start');
    await waitForState(page, kJointMove, 'running');
    await waitForState(page, kJointMove, 'ready');
    await setJoint(page, 0, '');
    await page.click('text=From current position');
    assert.ok(Math.abs(await firstJointOf(page) - 1.2) < 0.01);
}));

test('cannot start anything while only reading', () => withVisit(browser, quiet.line, async (page) => {
    await chooseIdle(page, kJointMove);
    await page.locator('.commands [data-command=start]:disabled').waitFor();
    assert.equal(await page.locator('.why-not').innerText(), 'Take control first');
    assert.equal(await page.locator('.commands [data-command=halt]').isEnabled(), true);
    assert.equal(await page.locator('#halt-all').isEnabled(), true);
}));

test('is refused a pose out of reach, sees why, and nothing moves', () => withVisit(browser, quiet.line, async (page) => {
    await takeControl(page);
    await chooseIdle(page, kLinear);
    await page.locator('[data-field=TargetPosition] input').first().fill('3');
    await press(page, 'start');
    await page.locator('.verdict .bad').waitFor();
    assert.match(await page.locator('.verdict').innerText(), /unreachable[\s\S]*TargetPosition: \[3, .*out of reach of UR5/);
    await waitForState(page, kLinear, 'ready');
    await picture(page, 'refused_light');
}));

test('is told of a wrong value while typing', () => withVisit(browser, quiet.line, async (page) => {
    await chooseIdle(page, kJointMove);
    await setJoint(page, 3, '9');
    assert.match(await page.locator('[data-field=TargetJointPosition] .field-error').innerText(), /A4: 9 rad is above 2\.0944 rad/);
    assert.equal(await page.locator('[data-field=TargetJointPosition] input[type=text]').first().getAttribute('aria-invalid'), 'true');
    await setJoint(page, 3, '0.5');
    await page.locator('[data-field=TargetJointPosition] .field-error').waitFor({ state: 'hidden' });
}));

test('suspends, resumes, halts and resets a move', () => withVisit(browser, quiet.line, async (page) => {
    await takeControl(page);
    await chooseIdle(page, kJointMove);
    const far = await firstJointOf(page) > 0 ? '-2' : '2';
    await setJoint(page, 0, far);
    await press(page, 'start');
    await waitForState(page, kJointMove, 'running');
    await press(page, 'suspend');
    await waitForState(page, kJointMove, 'suspended');
    await press(page, 'resume');
    await waitForState(page, kJointMove, 'running');
    await page.click('[aria-label^="Halt iiwa"]');
    await waitForState(page, kJointMove, 'halted');
    await page.locator('.run-head .error', { hasText: 'Halt by operator' }).waitFor();
    await picture(page, 'halted_light');
    await press(page, 'reset');
    await waitForState(page, kJointMove, 'ready');
}));

test('halts everything without having control, by key', () => withVisit(browser, quiet.line, async (page) => {
    await page.keyboard.press('Shift+H');
    await waitForState(page, kJointMove, 'halted');
    await waitForState(page, 'wsg50/Controller/GraspGripperSkill', 'halted');
    await page.locator('.toast.good', { hasText: 'not an emergency stop' }).waitFor();
    await page.keyboard.press('c');
    await page.locator('.mode[data-control=all]').waitFor();
    for (const key of [kJointMove, kLinear, 'iiwa/Controller/CartesianLinearMoveSkill', 'iiwa/Controller/CartesianPtpMoveSkill']) await chooseIdle(page, key);
}));

test('finds an execution, replays it, and compares two', () => withVisit(browser, quiet.line, async (page) => {
    await takeControl(page);
    await chooseIdle(page, kJointMove);
    // Both are far from where it is before.
    for (const target of await firstJointOf(page) > 0 ? ['-1.5', '1.5'] : ['1.5', '-1.5']) {
        await chooseIdle(page, kJointMove);
        await setJoint(page, 0, target);
        await press(page, 'start');
        await waitForState(page, kJointMove, 'running');
        await waitForState(page, kJointMove, 'ready');
    }
    await page.click('#tab-timeline');
    await page.fill('[aria-label="Search executions"]', 'JointPtp');
    await page.locator('tr[data-record] button.link').first().click();
    await page.locator('.record h3', { hasText: 'Joint Ptp Move' }).waitFor();
    await page.locator('.transitions td', { hasText: 'Ready \u2192 Running' }).waitFor();
    await page.click('#replay');
    await page.locator('.replay strong', { hasText: 'not live' }).waitFor();
    await page.waitForFunction(() => Number(document.querySelector<HTMLInputElement>('.replay input')?.value) > 0);
    await picture(page, 'replay_light');
    await page.click('[aria-label="End the replay"]');
    await page.locator('tr[data-record] input[type=checkbox]').nth(0).check();
    await page.locator('tr[data-record] input[type=checkbox]').nth(1).check();
    await page.locator('.record h3', { hasText: 'Comparison' }).waitFor();
    assert.equal(await page.locator('.record .facts .run-mark').count(), 2);
    await picture(page, 'compare_light');
}));

test('frees what a closed tab controlled', () => withVisit(browser, quiet.line, async (page) => {
    const other = await visit(browser, quiet.line);
    await other.page.locator('.link-state[data-link=live]').waitFor();
    await takeControl(other.page);
    await page.locator('[data-server=iiwa] .owner', { hasText: 'demo client' }).waitFor();
    await other.close();
    await page.locator('[data-server=iiwa] .owner', { hasText: 'free' }).waitFor();
}));

/** As the browser does it with a tab behind others. */
async function setSeen(page: Page, seen: boolean): Promise<void> {
    await page.evaluate((state) => {
        Object.defineProperty(document, 'visibilityState', { value: state, configurable: true });
        document.dispatchEvent(new Event('visibilitychange'));
    }, seen ? 'visible' : 'hidden');
}

test('leaves its connection to other tabs while nobody sees it, unless it has control', () => withVisit(browser, quiet.line, async (page) => {
    const other = await visit(browser, quiet.line);
    await other.page.locator('.link-state[data-link=live]').waitFor();
    await takeControl(other.page);
    await setSeen(other.page, false);
    await setSeen(page, false);
    await page.locator('.link-state[data-link=lost]').waitFor();
    await setSeen(page, true);
    await page.locator('.link-state[data-link=live]').waitFor();
    assert.equal(await other.page.locator('.mode').getAttribute('data-control'), 'all');
    await other.close();
}));

test('halts at once although no record comes', async () => {
    const program = await startFake('--square', '--silent-records');
    try {
        await withVisit(browser, program.line, async (page) => {
            await page.locator('.skill .pill[data-state=running]').first().waitFor();
            await page.click('#tab-timeline');
            for (const state of ['Running', 'Ready', 'Halted', 'Suspended', 'Running', 'Ready']) await page.selectOption('[aria-label=State]', state);
            await page.keyboard.press('Shift+H');
            // Sooner than the page gives up a request.
            await page.locator('.toast.good', { hasText: 'not an emergency stop' }).waitFor({ timeout: 15_000 });
        });
    } finally {
        await program.end();
    }
});

test('logs in with user and password, and not with wrong ones', async () => {
    const closed = await startFake('--login', 'maria:secret');
    const visitor = await visit(browser, closed.line);
    try {
        const { page } = visitor;
        await page.fill('#login-user', 'maria');
        await page.fill('#login-password', 'wrong');
        await page.keyboard.press('Enter');
        await page.locator('.dialog .field-error', { hasText: 'Wrong user or password' }).waitFor();
        await picture(page, 'login_light');
        await page.fill('#login-password', 'secret');
        await page.keyboard.press('Enter');
        await page.locator('.skill').first().waitFor();
        assert.equal(await page.locator('.user').innerText(), 'maria');
    } finally {
        await visitor.close();
        await closed.end();
    }
});

test('works on a narrow screen, and nothing is wider than it', () => withVisit(browser, squares.line, async (page) => {
    for (const [name, panel] of [['Cell', '.stage'], ['Skills', '.servers'], ['Run', '.run'], ['History', '.below']] as const) {
        await page.click(`.panes button:has-text("${name}")`);
        await page.locator(panel).waitFor();
        assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), `${name} is wider than the screen`);
        assert.equal(await page.locator('#halt-all').isVisible(), true);
        await picture(page, `narrow_${name.toLowerCase()}`);
    }
}, { width: 400, height: 800, dark: true }));

test('draws a user\u2019s own meshes', async () => {
    const folder = mkdtempSync(join(tmpdir(), 'metier-meshes-'));
    writeFileSync(join(folder, 'link.stl'), tetrahedron(0.08));
    writeFileSync(join(folder, 'iiwa.urdf'), urdfOf(readArm(join(kSource, 'models/iiwa7.toml'), 'iiwa', [0, 0, 0, 0, 0, 0]), 'link.stl'));
    const program = await startFake('--meshes', folder);
    try {
        await withVisit(browser, program.line, async (page) => {
            await page.locator('.stage[data-meshes~=iiwa]').waitFor();
            await picture(page, 'meshes_light');
        });
    } finally {
        await program.end();
        rmSync(folder, { recursive: true });
    }
});
