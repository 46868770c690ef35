// The types of the messages between page and server. `view` is the whole wish of a window, never a part of it.

/** @typedef {[number, number, number]} Vector */
/** @typedef {{lookfrom: Vector, lookat: Vector, up: Vector, fov: number | null}} Camera */
/** @typedef {"wipe" | "reference" | "difference" | "flip" | "z"} Compare */

/**
 * What a window shows; null means the scene's own.
 * @typedef {object} View
 * @property {Camera | null} camera
 * @property {[number, number] | null} size
 * @property {string | null} integrator
 * @property {number | null} depth
 * @property {number | null} samples
 * @property {number | null} minContribution
 * @property {number | null} turn degrees
 * @property {number | null} rotateEnvironment degrees
 * @property {number | null} animation
 * @property {number | null} at seconds
 * @property {string | null} variant
 * @property {number | null} exposure stops
 * @property {string | null} tonemap
 * @property {boolean | null} denoise
 * @property {string} layer
 * @property {Compare | null} compare
 */

/**
 * @typedef {object} Scene
 * @property {"scene"} type
 * @property {number} generation
 * @property {string} name
 * @property {[number, number]} size
 * @property {Camera & {projection: string}} camera
 * @property {{min: Vector, max: Vector}} bounds
 * @property {string} integrator
 * @property {string[]} integrators
 * @property {number} depth
 * @property {number} samples
 * @property {number} minContribution
 * @property {number} exposure
 * @property {string} tonemap
 * @property {string[]} tonemaps
 * @property {boolean} denoise
 * @property {{name: string, title: string}[]} layers
 * @property {string[]} variants
 * @property {{name: string, seconds: number}[]} animations
 * @property {number | null} duration
 * @property {boolean} turntable
 * @property {Record<string, any>} counts
 * @property {{name: string, position: Vector | null}[]} lights
 * @property {string | null} reference
 * @property {string[]} warnings
 * @property {string} version
 */

/** @typedef {{type: "progress", view: number, samples: number, of: number, seconds: number, raysPerSecond: number, done: boolean}} Progress */
/** @typedef {{type: "error", id: number | null, message: string, excerpt: string | null}} Failure */
/** @typedef {{type: "value", x: number, y: number, rgb: Vector, samples: number, variance: Vector, reference: Vector | null}} Value */
/** @typedef {{kind: "picture", view: number, width: number, height: number, scale: number, samples: number, of: number, done: boolean, layer: string, seconds: number, sizes?: number[]}} PictureHeader */
/** @typedef {{kind: "space", id: number, width: number, height: number, screenFromWorld: number[], sizes: number[]}} SpaceHeader */
/** @typedef {{kind: "file", id: number, name: string, mime: string}} FileHeader */
/** @typedef {{header: any, payload: ArrayBuffer}} Binary */
/** @typedef {{type: "lobe", address: number, point: Vector, normal: Vector, wi: Vector, chosen: Vector | null, theta: number, phi: number, values: number[], directions: Vector[]}} Lobe */

/** @typedef {{sample: number, film: number[], luminance: number, depth: number, light: string | null, expression: string}} SampleRow */
/** @typedef {{sample: number, value: number[], address?: number, expression: string, why: string}} Contribution */
/** @typedef {{pixel: [number, number], samples: number, mean: number[], variance: number[] | null, standardError: number[] | null, standard_error?: number[] | null, color8: number[], contributions: Contribution[], all: SampleRow[]}} PixelReport */

/** @typedef {{lanes: number[], rgb: Vector}} Amount */
/** @typedef {{f32: number | "NaN" | "Infinity" | "-Infinity", f64: number | "NaN" | "Infinity" | "-Infinity", bits: number}} Twice */
/** @typedef {{name: string, verdict: string, is_nearest: boolean, test: any}} Candidate */
/** @typedef {{from: Vector, to: Vector, is_endless: boolean, blockers: {shape: string, passed: number[], t?: number, point?: Vector}[]}} Shadow */
/** @typedef {{boundary: string, refracts: boolean, alpha: [number, number], half_vector: Vector, d: number | null, g: number | null, fresnel: number[], value: number[]}} Microfacet */
/** @typedef {{name: string, does: string, matrix: number[][], product: number[][], point: number[]}} Step */
/** @typedef {{lookfrom: Vector, u: Vector, v: Vector, w: Vector, p_k: number[], steps: Step[], p_world: Vector, a: Vector, b: Vector, direction: Vector, lens: boolean}} CameraReport */

/**
 * A ray of an inspection. Newer servers add fields.
 * @typedef {object} Ray
 * @property {number} address
 * @property {number | null} parent
 * @property {string} kind
 * @property {number} depth
 * @property {Vector} a
 * @property {Vector} direction
 * @property {number[]} throughput
 * @property {number[] | null} throughput_there
 * @property {number | null} pdf
 * @property {{nodes: number, culled: number, tests: number}} [traversal]
 * @property {any} [absorption]
 * @property {Candidate[]} candidates
 * @property {any} met
 * @property {any[]} found
 * @property {any} scattering
 * @property {any[]} lights
 * @property {any} light_sample
 * @property {Shadow | null} openness
 * @property {any} bounce
 * @property {any[]} branches
 * @property {string | null} ends
 * @property {Amount} added
 * @property {Amount} subtree
 */

/**
 * @typedef {object} Inspection
 * @property {[number, number]} pixel
 * @property {number} sample
 * @property {string} integrator
 * @property {any} wavelengths
 * @property {CameraReport} camera
 * @property {Ray[]} rays
 * @property {Amount} radiance
 * @property {{address: number, term: string, value: Amount}[]} additions
 * @property {number} weight
 * @property {Vector} film
 * @property {boolean} adds_up
 * @property {Contribution[]} [contributions]
 * @property {number[]} [color8]
 */

export {};
