// The floor: a grid of 10 cm that fades out, the arms' shadow, and a darker spot where an arm stands.

import {
    Color, DataTexture, Group, LinearFilter, Mesh, MeshBasicMaterial, PlaneGeometry, RGBAFormat, ShaderMaterial, ShadowMaterial,
} from 'three';

const kVertex = `
varying vec2 at;
void main() {
    vec4 world = modelMatrix * vec4(position, 1.0);
    at = world.xy;
    gl_Position = projectionMatrix * viewMatrix * world;
}`;

const kFragment = `
uniform vec3 ground;
uniform vec3 line;
uniform vec3 sky;
uniform vec2 middle;
uniform float reach;
varying vec2 at;
float grid(vec2 cell, vec2 derivative, float width) {
    vec2 near = abs(fract(cell - 0.5) - 0.5) / derivative;
    float visible = 1.0 - clamp((max(derivative.x, derivative.y) - 0.12) * 2.2, 0.0, 1.0);
    return clamp(1.0 - min(near.x, near.y) / width, 0.0, 1.0) * visible;
}
void main() {
    vec2 derivative = max(fwidth(at), 1e-6);
    float share = distance(at, middle) / reach;
    float lines = max(grid(at * 10.0, derivative * 10.0, 1.0) * 0.5, grid(at, derivative, 1.3));
    vec3 color = mix(ground, line, lines * clamp((1.0 - share) * 1.5, 0.0, 1.0));
    gl_FragColor = vec4(mix(color, sky, clamp((share - 0.4) * 1.2, 0.0, 1.0)), 1.0);
    #include <colorspace_fragment>
}`;

export interface FloorColors {
    ground: string;
    line: string;
    sky: string;
}

function spotTexture(): DataTexture {
    const size = 64;
    const data = new Uint8Array(size * size * 4);
    for (let i = 0; i < size * size; ++i) {
        const r = Math.hypot((i % size) - 31.5, Math.floor(i / size) - 31.5) / 31.5;
        data[4 * i + 3] = Math.round(255 * Math.max(0, 1 - r) ** 1.6);
    }
    const texture = new DataTexture(data, size, size, RGBAFormat);
    texture.magFilter = LinearFilter;
    texture.needsUpdate = true;
    return texture;
}

/** \param middle of the cell [m]; \param reach to where the grid is seen [m] */
export class Floor {
    readonly root = new Group();
    private readonly grid: ShaderMaterial;
    private readonly shadow = new ShadowMaterial({ opacity: 0.28 });
    private readonly shade = new Mesh(new PlaneGeometry(1, 1), this.shadow);
    private readonly spot = new MeshBasicMaterial({ map: spotTexture(), transparent: true, opacity: 0.45, depthWrite: false });

    constructor() {
        this.grid = new ShaderMaterial({
            vertexShader: kVertex,
            fragmentShader: kFragment,
            uniforms: {
                ground: { value: new Color() }, line: { value: new Color() }, sky: { value: new Color() },
                middle: { value: [0, 0] }, reach: { value: 6 },
            },
        });
        this.shade.receiveShadow = true;
        this.shade.position.z = 0.0008;
        this.root.add(new Mesh(new PlaneGeometry(200, 200), this.grid), this.shade);
    }

    setColors(colors: FloorColors, shadow_opacity: number): void {
        (this.grid.uniforms['ground']?.value as Color).set(colors.ground);
        (this.grid.uniforms['line']?.value as Color).set(colors.line);
        (this.grid.uniforms['sky']?.value as Color).set(colors.sky);
        this.shadow.opacity = shadow_opacity;
        this.spot.opacity = shadow_opacity * 1.5;
    }

    setReach(x: number, y: number, reach: number): void {
        (this.grid.uniforms['middle'] as { value: number[] }).value = [x, y];
        (this.grid.uniforms['reach'] as { value: number }).value = reach;
        this.shade.position.set(x, y, 0.0008);
        this.shade.scale.set(reach, reach, 1);
    }

    /** A contact shadow below what stands at x, y. */
    addSpot(x: number, y: number, radius: number, height = 0.0012): void {
        const mesh = new Mesh(new PlaneGeometry(2 * radius, 2 * radius), this.spot);
        mesh.position.set(x, y, height);
        mesh.renderOrder = 1;
        this.root.add(mesh);
    }
}
