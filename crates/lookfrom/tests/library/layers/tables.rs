//! The map of the house: what may use what.

/// The crates of the workspace, each with those that it may use. Rows name only rows above them, so that there is no circle.
pub(super) const CRATES: &[(&str, &str)] = &[
    ("lookfrom-simd", ""),
    ("lookfrom-test-data", ""),
    ("lookfrom-bvh", "lookfrom-simd"),
    ("lookfrom-scene", "lookfrom-test-data"),
    ("lookfrom", "lookfrom-bvh lookfrom-scene lookfrom-simd lookfrom-test-data"),
    ("lookfrom-view", "lookfrom lookfrom-scene"),
    ("lookfrom-web", "lookfrom lookfrom-scene lookfrom-view"),
    ("lookfrom-cli", "lookfrom lookfrom-scene lookfrom-view"),
    ("lookfrom-py", "lookfrom lookfrom-bvh lookfrom-cli lookfrom-scene lookfrom-view"),
];

/// The modules of `lookfrom`, each with those that it may use. Rows name only rows above them, so that there is no circle.
pub(super) const MODULES: &[(&str, &str)] = &[
    ("clock", ""),
    ("parallel", ""),
    ("hash", ""),
    ("vector", ""),
    ("elementary", ""),
    ("optics", "vector"),
    ("math", "elementary optics"),
    ("spectrum", ""),
    ("statistics", ""),
    ("times", ""),
    ("lanes", "spectrum vector"),
    ("fixed_point", ""),
    ("accumulator", "lanes"),
    ("points", "lanes vector"),
    ("warp", "elementary vector"),
    ("color", "math spectrum"),
    ("sampler", "hash lanes"),
    ("bssrdf", "elementary math parallel spectrum"),
    ("bsdf", "bssrdf color elementary hash lanes math optics parallel sampler spectrum vector warp"),
    ("noise", "hash vector"),
    ("filter", "sampler"),
    ("distribution", "sampler lanes"),
    ("lens_system", "lanes vector"),
    ("camera", "lanes lens_system math vector warp"),
    ("interior_stack", ""),
    ("footprint", "hash lanes vector"),
    ("texture", "color footprint hash lanes noise spectrum vector"),
    ("interaction", "interior_stack math points texture"),
    (
        "material",
        "bsdf bssrdf color elementary footprint interior_stack math optics points spectrum interaction texture vector warp",
    ),
    ("primitive", "lanes math points interaction texture vector warp"),
    (
        "light",
        "distribution elementary hash lanes math parallel points sampler primitive spectrum interaction \
         texture vector warp",
    ),
    ("medium", "bsdf color elementary hash lanes light noise spectrum texture vector"),
    (
        "world",
        "bsdf distribution elementary footprint interior_stack light material math medium points primitive spectrum \
         interaction texture warp",
    ),
    (
        "aov",
        "accumulator fixed_point interaction interior_stack lanes material medium sampler times vector world",
    ),
    ("film", "accumulator aov fixed_point hash lanes parallel sampler spectrum"),
    ("denoise", "film parallel"),
    ("develop", "film parallel"),
    ("exposure", "film math"),
    ("view", "camera"),
    (
        "integrator",
        "aov bsdf bssrdf elementary footprint hash interior_stack lanes light material math medium optics points sampler \
         primitive spectrum interaction texture times vector warp world",
    ),
    (
        "render",
        "aov interior_stack camera clock color film filter footprint integrator lanes lens_system light material math \
         parallel sampler spectrum interaction texture times vector view warp world",
    ),
    (
        "inspect",
        "bsdf camera develop film integrator light material math medium render primitive spectrum interaction \
         texture world",
    ),
    (
        "session",
        "aov math clock color parallel denoise develop exposure film inspect integrator render view world",
    ),
];

/// The modules of another crate, rung by rung: a module may use those of all rungs above its own.
pub(super) struct Ladder {
    pub(super) name: &'static str,
    pub(super) rungs: &'static [&'static str],
    /// Modules that use others of their rung or below, as `user > used`, by reason.
    pub(super) exceptions: &'static [(&'static str, &'static str)],
}

/// The ladders of the other crates.
pub(super) const LADDERS: &[Ladder] = &[
    Ladder {
        name: "lookfrom-simd",
        rungs: &["dispatch lane_mask level real transpose", "rounding vector", "points", "placement"],
        exceptions: &[],
    },
    Ladder {
        name: "lookfrom-bvh",
        rungs: &[
            "aabb dispatch error_bounds faces lanes masks observer parallel ray reference testing vector",
            "affine collector eight_rays exact nearest origin_primitive ray_f64 unrounded",
            "capsule ellipsoid origin prepared sphere triangle",
            "conservative item node procedural",
            "common_origin ray8 stack statistics",
            "bvh coherence packet_bounds",
            "build hit_point settings validate",
            "refit visibility",
            "traverse",
            "interleaved moving packet",
            "batch",
            "closest_point single traverse_f64",
            "trace_ray",
            "query",
        ],
        exceptions: &[],
    },
    Ladder {
        name: "lookfrom-scene",
        rungs: &[
            "remedy",
            "error grid json motion parallel plural stamps suggest variables",
            "budget camera material warning",
            "contents files",
            "digest disk inputs packed spectrum texture",
            "excerpt image measured medium",
            "atmosphere lens light settings solid",
            "shape",
            "composite scene text volume",
            "watertight",
            "builder chain count duplicates model nanovdb openvdb shutter",
            "boolean hair ies npy stl subdivision tessellation validate vdb",
            "level_set obj ply",
            "mitsuba pbrt studio",
            "gltf",
            "format",
            "source",
            "toml",
            "load",
        ],
        exceptions: &[
            (
                "ids of a scene's parts are in `scene`",
                "camera > scene, light > scene, material > scene, medium > scene, shape > scene, texture > scene",
            ),
            ("the boxes around a scene's parts are in `scene`", "solid > scene"),
            ("a camera's lens system has the picture of its aperture", "camera > lens"),
            ("a measured material has its tables", "material > measured"),
            (
                "`model` has the parsers of numbers and words for all readers of text, and chooses among formats of models",
                "spectrum > model, model > format, model > hair, model > level_set, model > obj, model > ply, model > source, model > stl, model > subdivision",
            ),
            (
                "models in a scene, and their animations, are read as those of the command line",
                "gltf > load, toml > load",
            ),
        ],
    },
    Ladder {
        name: "lookfrom-view",
        rungs: &[
            "assets heat lent message patience source",
            "compare cost mailbox",
            "document",
            "view words",
            "bundle develop lobe space view_render",
            "told",
            "parts render",
            "answers handout",
            "desk window",
            "server",
        ],
        exceptions: &[],
    },
    Ladder { name: "lookfrom-web", rungs: &["dropped", "worker", "exports"], exceptions: &[] },
    Ladder {
        name: "lookfrom-cli",
        rungs: &[
            "pipe preview values",
            "diagnostic remedy",
            "exit",
            "interrupt output report scenes terminal",
            "args naming",
            "compare develop files film help overrides prepare",
            "keywords",
            "bench completions convert farm info inspect man merge progress view",
            "picture",
            "render",
            "resume",
        ],
        exceptions: &[],
    },
];
