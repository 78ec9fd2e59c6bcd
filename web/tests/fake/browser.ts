// A browser for tests, and the programs behind the page. Every wait has a deadline; whatever was started is ended.

import { strict as assert } from 'node:assert';
import { spawn, type ChildProcess } from 'node:child_process';
import { mkdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { createInterface } from 'node:readline';
import { chromium, type Browser, type Page } from 'playwright-core';
import { kBuilt, kSource } from './places.js';

/** Longest wait for anything on the page: it is drawn without a graphics card on a busy machine [ms]. */
export const kDeadline = 60_000;

const kWide = { width: 1440, height: 900 };
const pictures = join(kBuilt, 'pictures');

export interface Program {
    /** What its line said. */
    readonly line: string;
    end(): Promise<void>;
}

/** Starts a program and waits for a line of its output that fits. */
export async function startProgram(command: string, args: readonly string[], ready: RegExp): Promise<Program> {
    const child: ChildProcess = spawn(command, args, { stdio: ['ignore', 'pipe', 'inherit'] });
    const gone = new Promise<void>((resolve) => child.once('exit', () => resolve()));
    const end = async (): Promise<void> => {
        child.kill('SIGTERM');
        const timer = setTimeout(() => child.kill('SIGKILL'), 15_000);
        await gone;
        clearTimeout(timer);
    };
    const line = await new Promise<string>((resolve, reject) => {
        const timer = setTimeout(() => reject(new Error(`${command} ${args.join(' ')}: nothing like ${String(ready)} in time`)), kDeadline);
        createInterface({ input: child.stdout as NodeJS.ReadableStream }).on('line', (text) => {
            if (!ready.test(text)) return;
            clearTimeout(timer);
            resolve(text);
        });
        child.once('exit', (code) => reject(new Error(`${command} ended with ${String(code)}`)));
    }).catch(async (error: unknown) => {
        await end();
        throw error;
    });
    return { line, end };
}

export function startFake(...options: string[]): Promise<Program> {
    return startProgram(process.execPath, [join(kBuilt, 'tests/fake_dashboard.mjs'), join(kBuilt, 'dist'), join(kSource, 'models'), ...options], /^http:/);
}

/** Drawing without a graphics card takes all there is of a processor: what controls arms goes first. */
export function startBrowser(): Promise<Browser> {
    mkdirSync(pictures, { recursive: true });
    const program = join(pictures, 'nice_chromium');
    writeFileSync(program, '#!/bin/sh\nexec nice -n 10 chromium "$@"\n', { mode: 0o755 });
    return chromium.launch({ executablePath: program, args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'] });
}

export interface Visit {
    page: Page;
    /** What went wrong in the page's scripts, and what they asked for that is not there. */
    faults: string[];
    close(): Promise<void>;
}

/** Opens the page as a new visitor and waits for the cell. */
export async function visit(browser: Browser, url: string, look: { width?: number; height?: number; dark?: boolean } = {}): Promise<Visit> {
    const size = { width: look.width ?? kWide.width, height: look.height ?? kWide.height };
    const context = await browser.newContext({ viewport: size, colorScheme: look.dark === true ? 'dark' : 'light', reducedMotion: 'reduce' });
    context.setDefaultTimeout(kDeadline);
    const page = await context.newPage();
    const faults: string[] = [];
    page.on('pageerror', (error) => faults.push(error.message));
    page.on('response', (response) => {
        if (response.request().method() === 'GET' && response.status() >= 400) faults.push(`${response.url()}: ${String(response.status())}`);
    });
    await page.goto(url);
    return { page, faults, close: () => context.close() };
}

/** Runs a test with a visitor, who must see no fault of the page. */
export async function withVisit(browser: Browser, url: string, test: (page: Page) => Promise<void>, look: { width?: number; height?: number; dark?: boolean } = {}): Promise<void> {
    const visitor = await visit(browser, url, look);
    try {
        await visitor.page.locator('.skill').first().waitFor({ state: 'attached' });
        await visitor.page.locator('.link-state[data-link=live]').waitFor();
        await test(visitor.page);
        assert.deepEqual(visitor.faults, []);
    } finally {
        await visitor.close();
    }
}

export async function picture(page: Page, name: string): Promise<void> {
    await page.screenshot({ path: join(pictures, `${name}.png`) });
}

/** Waits until what is drawn of the cell changes: something moves. */
export async function waitForMotion(page: Page): Promise<void> {
    const canvas = page.locator('.canvas canvas');
    const before = await canvas.screenshot();
    const end = Date.now() + kDeadline;
    while (Date.now() < end) {
        if (!(await canvas.screenshot()).equals(before)) return;
    }
    assert.fail('nothing moved on the page');
}

export function skill(page: Page, key: string): ReturnType<Page['locator']> {
    return page.locator(`[data-skill="${key}"]`);
}

/** Waits until the list shows a skill in a state. */
export async function waitForState(page: Page, key: string, state: string): Promise<void> {
    await skill(page, key).locator(`.pill[data-state=${state}]`).waitFor();
}

export async function takeControl(page: Page): Promise<void> {
    await page.click('#take-control');
    await page.locator('.mode:not([data-control=none])').waitFor();
}

/** Presses one of the chosen skill's buttons. */
export async function press(page: Page, command: string): Promise<void> {
    await page.click(`.commands [data-command=${command}]`);
}
