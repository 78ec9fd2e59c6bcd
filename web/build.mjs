// Builds the page, or its tests, with esbuild:  node build.mjs page|tests OUTPUT_FOLDER
import { build } from 'esbuild';
import { cp, mkdir, readdir, rm } from 'node:fs/promises';
import { dirname, join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

const here = dirname(fileURLToPath(import.meta.url));
const [what, output] = process.argv.slice(2);
if ((what !== 'page' && what !== 'tests') || output === undefined) {
    console.error('usage: node build.mjs page|tests OUTPUT_FOLDER');
    process.exit(2);
}

async function buildPage() {
    // Chunks are named by their content: those of an earlier build would stay.
    await rm(join(output, 'assets'), { recursive: true, force: true });
    await mkdir(join(output, 'assets'), { recursive: true });
    await build({
        absWorkingDir: here,
        entryPoints: { main: 'src/main.ts', style: 'src/style/main.css' },
        bundle: true, splitting: true, format: 'esm', target: 'es2022', minify: true, legalComments: 'linked',
        outdir: join(output, 'assets'), entryNames: '[name]', chunkNames: 'chunk-[hash]', logLevel: 'warning',
    });
    await cp(join(here, 'src/index.html'), join(output, 'index.html'));
    await cp(join(here, 'src/icon.svg'), join(output, 'assets/icon.svg'));
}

/** The browser's remote control stays in its package; tests find it wherever they are built. */
const playwright = {
    name: 'playwright',
    setup(builder) {
        const path = pathToFileURL(join(here, 'node_modules/playwright-core/index.mjs')).href;
        builder.onResolve({ filter: /^playwright-core$/ }, () => ({ path, external: true }));
    },
};

async function buildTests() {
    const files = (await readdir(join(here, 'tests'))).filter((file) => /(_test|fake_dashboard)\.ts$/.test(file));
    await build({
        absWorkingDir: here,
        entryPoints: files.map((file) => `tests/${file}`),
        bundle: true, platform: 'node', format: 'esm', target: 'node18', sourcemap: 'inline', plugins: [playwright],
        outdir: output, outExtension: { '.js': '.mjs' }, logLevel: 'warning',
    });
}

await (what === 'page' ? buildPage() : buildTests());
