// The page stays small: everything that any visitor could load, compressed.

import assert from 'node:assert/strict';
import { readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { gzipSync } from 'node:zlib';
import { kBuilt, kSource } from './fake/places.js';

const kMost = 300_000;

function sizes(): { name: string; size: number }[] {
    const folder = join(kBuilt, 'dist/assets');
    const names = readdirSync(folder).filter((name) => /\.(js|css|svg)$/.test(name));
    const files = [...names.map((name) => ({ name, path: join(folder, name) })), { name: 'index.html', path: join(kBuilt, 'dist/index.html') }];
    return files.map(({ name, path }) => ({ name, size: gzipSync(readFileSync(path)).length }));
}

test('all files together are below 300 kB compressed', () => {
    const files = sizes();
    const total = files.reduce((sum, file) => sum + file.size, 0);
    console.log(`${total} bytes: ${files.map((file) => `${file.name} ${file.size}`).join(', ')}`);
    assert.ok(files.some((file) => file.name === 'main.js'));
    assert.ok(total < kMost, `${total} bytes`);
});

test('nothing is loaded from elsewhere', () => {
    const html = readFileSync(join(kBuilt, 'dist/index.html'), 'utf8');
    assert.equal(/(src|href)="(https?:)?\/\//.test(html), false);
    const css = readFileSync(join(kBuilt, 'dist/assets/style.css'), 'utf8');
    assert.equal(/@import|url\((?!["']?data:)/.test(css), false);
});

test('no data becomes markup', () => {
    const folder = join(kSource, 'web/src');
    const sources = readdirSync(folder, { recursive: true }).map(String).filter((name) => name.endsWith('.ts'));
    assert.ok(sources.length > 30);
    for (const name of sources) {
        const text = readFileSync(join(folder, name), 'utf8');
        assert.equal(/innerHTML|outerHTML|insertAdjacentHTML|document\.write|new Function|\beval\(/.test(text), false, name);
    }
});
