// A user's own meshes instead of the primitives: URDF with STL or DAE, from `metier dashboard --meshes DIR`.
// A chunk of its own that is loaded after the page: most cells have no meshes.

import { api } from '../api/client.js';
import type { CellView } from './cell_view.js';

/** Looks for a URDF for each arm and draws it. Without --meshes, or where none fits, the primitives stay. */
export async function useUserMeshes(view: CellView, changed: () => void): Promise<void> {
    const files = await api.meshes().then((answer) => answer.files, () => []);
    if (files.length === 0) return;
    const urdf = await import('./urdf.js');
    for (const actor of view.actors.values()) {
        for (const file of urdf.candidates(files, actor.arm)) {
            const links = await urdf.loadLinks(`/meshes/${file}`, actor.arm).catch((error: unknown) => {
                console.warn(`${file}: ${error instanceof Error ? error.message : String(error)}`);
                return null;
            });
            if (links === null) continue;
            actor.view.useMeshes(links);
            changed();
            break;
        }
    }
}
