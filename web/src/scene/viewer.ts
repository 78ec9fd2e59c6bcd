// The window into the cell: renderer, camera, light. Draws on demand, at most once per frame of the screen.

import {
    Box3, Color, DirectionalLight, Fog, HemisphereLight, PCFShadowMap, PerspectiveCamera, Raycaster, Scene,
    SRGBColorSpace, Vector2, Vector3, WebGLRenderer, type Object3D,
} from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import type { Theme } from '../ui/theme.js';
import { Floor, type FloorColors } from './floor.js';

interface Look extends FloorColors {
    hemisphere: number;
    below: string;
    key: number;
    fill: number;
    shadow: number;
}

const kLooks: Record<Theme, Look> = {
    light: { sky: '#eef0f4', ground: '#f2f3f5', line: '#c4c9d0', hemisphere: 1.75, below: '#b9bec6', key: 2.2, fill: 0.45, shadow: 0.3 },
    dark: { sky: '#171c22', ground: '#272e36', line: '#414b56', hemisphere: 1.05, below: '#2a3038', key: 2.1, fill: 0.5, shadow: 0.55 },
};

export type View = 'fit' | 'top' | 'front' | 'side';

/** A slower machine gets fewer pixels, not fewer frames: the least pixel ratio. */
const kLeastRatio = 0.5;
/** Without motion for so long the picture is drawn anew in full [s]. */
const kRest = 0.4;

/** Where each view looks from. */
const kFrom: Record<View, readonly [number, number, number]> = {
    fit: [0.36, -1, 0.56], top: [0, -0.001, 1], front: [0, -1, 0.08], side: [1, 0, 0.08],
};

/** Whether the browser draws without a graphics card. */
function drawsInSoftware(): boolean {
    const context = document.createElement('canvas').getContext('webgl2');
    const extension = context?.getExtension('WEBGL_debug_renderer_info');
    if (context === null || extension === null || extension === undefined) return false;
    const name = String(context.getParameter(extension.UNMASKED_RENDERER_WEBGL));
    context.getExtension('WEBGL_lose_context')?.loseContext();
    return /swiftshader|llvmpipe|software|basic render/i.test(name);
}

/** How far from its target a camera sees all of a box [m]. */
function distanceToSee(box: Box3, target: Vector3, from: Vector3, right: Vector3, above: Vector3, tan_x: number, tan_y: number): number {
    return Math.max(...cornersOf(box).map((corner) => {
        const at = corner.sub(target);
        return at.dot(from) + Math.max(Math.abs(at.dot(right)) / tan_x, Math.abs(at.dot(above)) / tan_y);
    }));
}

/** From where a camera sees all of a box in the middle of its window: `from` a direction, tangents of half its angles [m]. */
export function framing(box: Box3, from: Vector3, up: Vector3, tan_x: number, tan_y: number): { target: Vector3; distance: number } {
    const right = new Vector3().crossVectors(up, from).normalize();
    const above = new Vector3().crossVectors(from, right).normalize();
    const target = box.getCenter(new Vector3());
    let distance = distanceToSee(box, target, from, right, above, tan_x, tan_y);
    // What is near looks larger: the middle of the window is not the middle of the box.
    for (let round = 0; round < 8; ++round) {
        const seen = cornersOf(box).map((corner) => {
            const at = corner.sub(target);
            const depth = distance - at.dot(from);
            return { x: at.dot(right) / depth, y: at.dot(above) / depth };
        });
        const middle = (values: number[]): number => (Math.min(...values) + Math.max(...values)) / 2;
        target.addScaledVector(right, middle(seen.map((one) => one.x)) * distance).addScaledVector(above, middle(seen.map((one) => one.y)) * distance);
        distance = distanceToSee(box, target, from, right, above, tan_x, tan_y);
    }
    return { target, distance };
}

function cornersOf(box: Box3): Vector3[] {
    return [0, 1, 2, 3, 4, 5, 6, 7].map((i) => new Vector3(i & 1 ? box.max.x : box.min.x, i & 2 ? box.max.y : box.min.y, i & 4 ? box.max.z : box.min.z));
}

export class Viewer {
    readonly scene = new Scene();
    readonly floor = new Floor();
    readonly camera = new PerspectiveCamera(38, 1, 0.05, 60);
    private readonly renderer: WebGLRenderer;
    private readonly controls: OrbitControls;
    private readonly hemisphere = new HemisphereLight('#ffffff', '#888888', 1);
    private readonly key = new DirectionalLight('#ffffff', 2);
    private readonly fill = new DirectionalLight('#dfe8ff', 0.4);
    private readonly middle = new Vector3();
    private readonly software: boolean;
    private readonly most_ratio: number;
    private box = new Box3(new Vector3(-1, -1, 0), new Vector3(1, 1, 1));
    private dirty = true;
    private ratio: number;
    private readonly frame_times: number[] = [];
    private last_frame = 0;
    private last_motion = 0;
    private sharp = false;

    /**
     * \param before_draw changes the scene for this time [s, monotonic]; true: something moved
     * Throws where the browser has no WebGL.
     */
    constructor(private readonly container: HTMLElement, private readonly before_draw: (now: number) => boolean) {
        this.software = drawsInSoftware();
        this.most_ratio = this.software ? 1 : Math.min(devicePixelRatio, 2);
        this.renderer = new WebGLRenderer({ antialias: true, powerPreference: 'high-performance' });
        this.renderer.outputColorSpace = SRGBColorSpace;
        this.renderer.shadowMap.enabled = true;
        this.renderer.shadowMap.type = PCFShadowMap;
        this.ratio = this.most_ratio;
        this.camera.up.set(0, 0, 1);
        container.append(this.renderer.domElement);
        this.controls = new OrbitControls(this.camera, this.renderer.domElement);
        this.controls.enableDamping = false;
        this.controls.maxPolarAngle = Math.PI * 0.53;
        this.controls.addEventListener('change', () => this.requestDraw());
        this.light();
        this.scene.add(this.floor.root);
        new ResizeObserver(() => this.resize()).observe(container);
        this.renderer.setAnimationLoop((time) => this.tick(time / 1000));
    }

    get canvas(): HTMLCanvasElement {
        return this.renderer.domElement;
    }

    /** Frames per second over the last drawn ones; 0 while nothing moves. */
    get framesPerSecond(): number {
        const sum = this.frame_times.reduce((total, time) => total + time, 0);
        return sum > 0 ? this.frame_times.length / sum : 0;
    }

    requestDraw(): void {
        this.dirty = true;
    }

    setTheme(theme: Theme): void {
        const look = kLooks[theme];
        this.scene.background = new Color(look.sky);
        this.scene.fog = new Fog(look.sky, 12, 40);
        this.hemisphere.intensity = look.hemisphere;
        this.hemisphere.groundColor.set(look.below);
        this.key.intensity = look.key;
        this.fill.intensity = look.fill;
        this.floor.setColors(look, look.shadow);
        this.requestDraw();
    }

    /** Takes the extent of the cell: where light falls and what "fit" shows [m]. */
    setExtent(box: Box3): void {
        this.box = box;
        box.getCenter(this.middle);
        const radius = Math.max(0.6, box.getSize(new Vector3()).length() / 2);
        this.floor.setReach(this.middle.x, this.middle.y, radius * 3.2);
        const shadow = this.key.shadow.camera;
        const half = radius * 1.15;
        [shadow.left, shadow.right, shadow.top, shadow.bottom] = [-half, half, half, -half];
        shadow.near = 0.1;
        shadow.far = radius * 8;
        shadow.updateProjectionMatrix();
        this.key.position.copy(this.middle).add(new Vector3(-0.9, -1.3, 2.4).normalize().multiplyScalar(radius * 3));
        this.key.target.position.copy(this.middle);
        this.look('fit');
    }

    look(view: View): void {
        const from = new Vector3(...kFrom[view]).normalize();
        const tan_y = Math.tan((this.camera.fov * Math.PI) / 360) * 0.96;
        const { target, distance } = framing(this.box, from, this.camera.up, tan_y * this.camera.aspect, tan_y);
        this.controls.target.copy(target);
        this.camera.position.copy(target).addScaledVector(from, distance);
        this.controls.update();
        this.requestDraw();
    }

    /** The nearest object under a point of the window, or null. */
    pick(x: number, y: number, objects: Object3D[]): Object3D | null {
        const bounds = this.canvas.getBoundingClientRect();
        const point = new Vector2(((x - bounds.left) / bounds.width) * 2 - 1, 1 - ((y - bounds.top) / bounds.height) * 2);
        const ray = new Raycaster();
        ray.setFromCamera(point, this.camera);
        return ray.intersectObjects(objects, true)[0]?.object ?? null;
    }

    /** Where a point of the world is in the window [px]; null behind the camera. */
    project(point: Vector3): { x: number; y: number } | null {
        const p = point.clone().project(this.camera);
        if (p.z > 1) return null;
        return { x: ((p.x + 1) / 2) * this.canvas.clientWidth, y: ((1 - p.y) / 2) * this.canvas.clientHeight };
    }

    private light(): void {
        this.hemisphere.position.set(0, 0, 1);
        this.key.castShadow = true;
        const size = this.software ? 1024 : 2048;
        this.key.shadow.mapSize.set(size, size);
        this.key.shadow.bias = -0.0004;
        this.key.shadow.normalBias = 0.012;
        this.key.shadow.radius = 3;
        this.fill.position.set(2, 1.5, 1.2);
        this.scene.add(this.hemisphere, this.key, this.key.target, this.fill);
    }

    private resize(): void {
        const { clientWidth: width, clientHeight: height } = this.container;
        if (width === 0 || height === 0) return;
        const was = this.camera.aspect;
        this.camera.aspect = width / height;
        this.camera.updateProjectionMatrix();
        this.renderer.setPixelRatio(this.sharp ? this.most_ratio : this.ratio);
        this.renderer.setSize(width, height);
        if (Math.abs(was - this.camera.aspect) > 0.25) this.look('fit');
        this.requestDraw();
    }

    private tick(now: number): void {
        const moved = this.before_draw(now);
        if (moved) this.last_motion = now;
        const resting = now - this.last_motion > kRest;
        if (resting !== this.sharp && this.ratio < this.most_ratio) this.setSharp(resting);
        if (!moved && !this.dirty) {
            this.last_frame = 0;
            return;
        }
        this.dirty = false;
        this.renderer.render(this.scene, this.camera);
        if (this.last_frame > 0 && !this.sharp) this.measure(now - this.last_frame);
        this.last_frame = now;
    }

    /** While nothing moves there is time for all pixels. */
    private setSharp(sharp: boolean): void {
        this.sharp = sharp;
        this.resize();
    }

    private measure(frame_time: number): void {
        this.frame_times.push(frame_time);
        if (this.frame_times.length < 12) return;
        const mean = this.frame_times.reduce((sum, time) => sum + time, 0) / this.frame_times.length;
        this.frame_times.splice(0, 6);
        const wanted = mean > 1 / 31 ? this.ratio * Math.max(0.7, Math.sqrt(1 / 33 / mean)) : mean < 1 / 55 ? this.ratio * 1.1 : this.ratio;
        const ratio = Math.max(kLeastRatio, Math.min(this.most_ratio, wanted));
        if (Math.abs(ratio - this.ratio) < 0.01) return;
        this.ratio = ratio;
        this.resize();
    }
}
