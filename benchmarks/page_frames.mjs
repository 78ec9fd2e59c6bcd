// Cost of a frame of the page while three arms draw squares: the time of the browser's main thread, which every
// machine pays, beside the 33.3 ms that a frame may take at 30 frames/s; and how much it draws, which a graphics card
// does. Where there is none Chromium draws in software, and the frames/s are those of the processor.
//
//   node benchmarks/page_frames.mjs BUILD_FOLDER [SECONDS]      BUILD_FOLDER/web is where the page and its tests were built
import { spawn } from 'node:child_process';
import { dirname, join } from 'node:path';
import { createInterface } from 'node:readline';
import { fileURLToPath } from 'node:url';
import { chromium } from '../web/node_modules/playwright-core/index.mjs';

const kFrame = 1000 / 30;
const source = join(dirname(fileURLToPath(import.meta.url)), '..');
const [build, seconds = '15'] = process.argv.slice(2);
if (build === undefined || !(Number(seconds) > 0)) {
    console.error('usage: node benchmarks/page_frames.mjs BUILD_FOLDER [SECONDS]');
    process.exit(2);
}

async function startCell() {
    const child = spawn(process.execPath, [join(build, 'web/tests/fake_dashboard.mjs'), join(build, 'web/dist'), join(source, 'models'), '--square'], { stdio: ['ignore', 'pipe', 'inherit'] });
    const url = await new Promise((resolve, reject) => {
        createInterface({ input: child.stdout }).once('line', resolve);
        child.once('exit', (code) => reject(new Error(`the made-up cell ended with ${code}`)));
    });
    return { url, end: () => child.kill() };
}

/** Seconds that the main thread of the page has worked so far, and those of them in scripts. */
async function worked(session) {
    const { metrics } = await session.send('Performance.getMetrics');
    const of = (name) => metrics.find((metric) => metric.name === name).value;
    return { all: of('TaskDuration'), scripts: of('ScriptDuration'), time: of('Timestamp') };
}

/** Counts what is drawn from now on; a frame has as many draw calls as WebGL gets between two frames. */
function count() {
    const { renderer } = window.metier.stage.viewer;
    const counted = { frames: 0, calls: 0, triangles: 0 };
    const draw = renderer.render.bind(renderer);
    renderer.render = (scene, camera) => {
        draw(scene, camera);
        counted.frames += 1;
        counted.calls += renderer.info.render.calls;
        counted.triangles += renderer.info.render.triangles;
    };
    window.counted = counted;
}

async function measure(page) {
    const session = await page.context().newCDPSession(page);
    await session.send('Performance.enable');
    await page.evaluate(count);
    const before = await worked(session);
    await page.waitForTimeout(Number(seconds) * 1000);
    const after = await worked(session);
    const drawn = await page.evaluate(() => window.counted);
    const each = (name) => (1000 * (after[name] - before[name])) / drawn.frames;
    return { ...drawn, seconds: after.time - before.time, all: each('all'), scripts: each('scripts') };
}

const cell = await startCell();
let browser;
try {
    browser = await chromium.launch({ executablePath: '/usr/bin/chromium', args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'] });
    const page = await browser.newPage({ viewport: { width: 1440, height: 900 } });
    await page.goto(cell.url);
    await page.locator('.skill .pill[data-state=running]').nth(2).waitFor();
    const of = await measure(page);
    const row = (what, value, goal) => console.log(`${what.padEnd(36)} ${value.padStart(12)}   ${goal}`);
    row('main thread for a frame', `${of.all.toFixed(2)} ms`, `${(of.all / kFrame).toFixed(2)} of ${kFrame.toFixed(1)} ms, goal 1`);
    row('  of it scripts', `${of.scripts.toFixed(2)} ms`, '');
    row('draw calls in a frame', (of.calls / of.frames).toFixed(0), '');
    row('triangles in a frame', (of.triangles / of.frames).toFixed(0), '');
    row('frames/s, drawn in software', (of.frames / of.seconds).toFixed(1), 'goal 30 with a graphics card');
} finally {
    await browser?.close();
    cell.end();
}
