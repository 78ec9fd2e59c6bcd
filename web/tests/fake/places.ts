// Where tests find things; ctest sets it.

import { strict as assert } from 'node:assert';

function place(name: string): string {
    const value = process.env[name];
    assert.ok(value !== undefined && value !== '', `${name} is not set: run the tests by ctest`);
    return value;
}

/** The sources of the project. */
export const kSource = place('METIER_SOURCE');
/** The folder into which the page and its tests were built. */
export const kBuilt = place('METIER_WEB');
