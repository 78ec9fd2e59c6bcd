// A user's own meshes instead of the primitives: URDF with STL or DAE, from `metier dashboard --meshes DIR`.
// A chunk of its own that is loaded after the page: most cells have no meshes.

import { api } from '../api/client.js';
import type { Arm } from '../api/types.js';
import type { CellView } from './cell_view.js';

function plain(text: string): string {
    return text.toLowerCase().replace(/[^a-z0-9]/g, '');
}

/** All files, first those whose path names the arm. Its chain decides whether one fits. */
export function inOrder(files: readonly string[], arm: Arm): string[] {
    const words = [arm.product, arm.name, arm.key].map(plain).filter((word) => word.length > 1);
    const names = (file: string): boolean => words.some((word) => plain(file).includes(word));
    return [...files.filter(names), ...files.filter((file) => !names(file))];
}

/** Looks for a URDF for each arm and draws it. Where none fits, the primitives stay. Returns whose were drawn. */
export async function useUserMeshes(view: CellView, drawn: (arm: string) => void): Promise<void> {
    const files = await api.meshes().then((answer) => answer.files, () => []);
    if (files.length === 0) return;
    const urdf = await import('./urdf.js');
    for (const actor of view.actors.values()) {
        for (const file of inOrder(files, actor.arm)) {
            const links = await urdf.loadLinks(`/meshes/${file}`, actor.arm).catch((error: unknown) => {
                console.info(`${file} is not drawn as ${actor.arm.name}: ${error instanceof Error ? error.message : String(error)}`);
                return null;
            });
            if (links === null) continue;
            actor.view.useMeshes(links);
            drawn(actor.arm.key);
            break;
        }
    }
}
