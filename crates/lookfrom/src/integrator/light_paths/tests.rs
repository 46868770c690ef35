use super::*;

const LIGHTS: [(&str, bool); 3] = [("window", false), ("lamp 2 (room.toml:14)", false), ("sky", true)];

fn layer(name: &str, expression: &str) -> LightPathLayer {
    LightPathLayer { name: name.to_owned(), expression: expression.to_owned(), at: Location::default() }
}

fn compiled(expressions: &[&str]) -> Result<LightPaths> {
    let named = |(index, expression): (usize, &&str)| layer(&format!("layer{index}"), expression);
    LightPaths::new(&expressions.iter().enumerate().map(named).collect::<Vec<_>>(), LIGHTS.into_iter())
}

/// The layers that have light of a way: pairs such as `RD`, and its end.
fn has(paths: &LightPaths, way: &str, end: Term) -> Vec<usize> {
    let mut state = paths.start();
    for event in way.split_whitespace() {
        state = paths.scattered(state, lobe(event));
    }
    let mut layers = vec![Spectrum::BLACK; paths.count()];
    paths.add(state, end, Spectrum::ONE, &mut layers);
    (0..layers.len()).filter(|index| !layers[*index].is_black()).collect()
}

fn lobe(event: &str) -> Lobes {
    Lobes::sampled(event.ends_with('S'), event.ends_with('D'), event.starts_with('T'))
}

#[test]
fn ways_are_in_the_layers_that_describe_them() {
    let expressions = [
        "C.*[LBOA]",
        "C<RD>L",
        "C D .+ [LB]",
        "C(<TS>{2}|<RS>)+ <RD> L",
        "C[^D]*<L.'window'>",
        "CL|CB",
        "C<[RT][GS]>?<B.'sky'>",
        "C.{1,2}O",
    ];
    let paths = compiled(&expressions).unwrap();
    let (window, lamp, sky) = (Term::Light(0), Term::Found { light: 1, weight: 0.5 }, Term::Light(2));
    assert_eq!(has(&paths, "", window), [0, 4, 5]);
    assert_eq!(has(&paths, "RD", window), [0, 1]);
    assert_eq!(has(&paths, "RD RD", lamp), [0, 2]);
    assert_eq!(has(&paths, "TD RG", sky), [0, 2]);
    assert_eq!(has(&paths, "TS TS RS RD", lamp), [0, 3]);
    assert_eq!(has(&paths, "TS RS RD", lamp), [0]);
    assert_eq!(has(&paths, "RG RS", window), [0, 4]);
    assert_eq!(has(&paths, "RG RS", lamp), [0]);
    assert_eq!(has(&paths, "TS", sky), [0, 6]);
    assert_eq!(has(&paths, "", Term::Sky), [0, 5]);
    assert_eq!(has(&paths, "RG TD", Term::Emission), [0, 7]);
    assert_eq!(has(&paths, "", Term::Emission), [0]);
    assert_eq!(has(&paths, "", Term::Ambient), [0]);
    assert_eq!(has(&paths, "", Term::View), [0; 0]);
}

/// A slow matcher: of a way from a place on, all places where an expression may end.
mod reference {
    pub(super) enum Node {
        Event(Vec<&'static str>),
        Sequence(Vec<Node>),
        Either(Box<Node>, Box<Node>),
        Many(Box<Node>),
    }

    impl Node {
        pub(super) fn text(&self) -> String {
            match self {
                Self::Event(events) => {
                    let events: Vec<String> = events
                        .iter()
                        .map(
                            |event| if event.len() == 2 { format!("<{event}>") } else { (*event).to_owned() },
                        )
                        .collect();
                    format!("[{}]", events.concat())
                }
                Self::Sequence(nodes) => nodes.iter().map(Self::text).collect(),
                Self::Either(a, b) => format!("({}|{})", a.text(), b.text()),
                Self::Many(node) => format!("({})*", node.text()),
            }
        }

        pub(super) fn ends(&self, way: &[&str], from: usize) -> Vec<usize> {
            let mut ends = match self {
                Self::Event(events) => {
                    let is = from < way.len() && events.contains(&way[from]);
                    if is { vec![from + 1] } else { Vec::new() }
                }
                Self::Sequence(nodes) => nodes.iter().fold(vec![from], |places, node| {
                    places.into_iter().flat_map(|place| node.ends(way, place)).collect()
                }),
                Self::Either(a, b) => [a.ends(way, from), b.ends(way, from)].concat(),
                Self::Many(node) => {
                    let mut places = vec![from];
                    let mut next = 0;
                    while next < places.len() {
                        for place in node.ends(way, places[next]) {
                            if !places.contains(&place) {
                                places.push(place);
                            }
                        }
                        next += 1;
                    }
                    places
                }
            };
            ends.sort_unstable();
            ends.dedup();
            ends
        }
    }
}

#[test]
fn random_expressions_match_as_a_slow_matcher_does() {
    use reference::Node;
    const EVENTS: [&str; 7] = ["RD", "RG", "RS", "TD", "TG", "TS", "L"];
    let mut seed = 7_u64;
    let mut random = move |count: usize| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 40) as usize % count
    };
    fn node(random: &mut impl FnMut(usize) -> usize, depth: usize) -> Node {
        match if depth == 0 { 0 } else { random(4) } {
            0 => Node::Event((0..1 + random(3)).map(|_| EVENTS[random(7)]).collect()),
            1 => Node::Sequence((0..random(4)).map(|_| node(random, depth - 1)).collect()),
            2 => Node::Either(Box::new(node(random, depth - 1)), Box::new(node(random, depth - 1))),
            _ => Node::Many(Box::new(node(random, depth - 1))),
        }
    }
    let mut matches = 0;
    for _ in 0..300 {
        let expressions = [node(&mut random, 3), node(&mut random, 3)];
        let texts = expressions.each_ref().map(|node| format!("C{}", node.text()));
        let paths = compiled(&[&texts[0], &texts[1]]).unwrap();
        for _ in 0..40 {
            let way: Vec<&str> = (0..random(5)).map(|_| EVENTS[random(6)]).collect();
            let with_light: Vec<&str> = way.iter().copied().chain(["L"]).collect();
            let expected: Vec<usize> = (0..2)
                .filter(|index| expressions[*index].ends(&with_light, 0).contains(&with_light.len()))
                .collect();
            matches += expected.len();
            assert_eq!(has(&paths, &way.join(" "), Term::Light(0)), expected, "{texts:?} {way:?}");
        }
    }
    assert!(matches > 500, "{matches}");
}

#[test]
fn sampled_light_is_divided_between_diffuse_and_glossy() {
    let paths = compiled(&["C<RD>L", "C<RG>L", "C.L"]).unwrap();
    let share = Spectrum([0.25, 0.5, 1.0, 0.0]);
    let last = paths.last_scattering(paths.start(), false, share);
    let mut layers = [Spectrum::BLACK; 3];
    paths.add_sampled(&last, Term::Light(1), Spectrum([4.0, 2.0, 3.0, 0.0]), &mut layers);
    assert_eq!(layers[0], Spectrum([1.0, 1.0, 3.0, 0.0]));
    assert_eq!(layers[1], Spectrum([3.0, 1.0, 0.0, 0.0]));
    assert_eq!(layers[2], Spectrum([4.0, 2.0, 3.0, 0.0]));
}

#[test]
fn faults_say_what_was_expected_and_where() {
    let error = |expression: &str| compiled(&[expression]).unwrap_err().to_string();
    for (expression, expected) in [
        ("", "expected C, the camera, but found the end at column 1"),
        ("<RD>L", "expected C, the camera, but found '<' at column 1"),
        ("C<RX>L", "expected an event: one of D G S R T V L B O A . < [ ( but found 'X' at column 4"),
        ("C(D|S", "expected ')' but found the end at column 6"),
        ("CD)L", "expected an event or the end but found ')' at column 3"),
        ("C<RL>", "a set without any event at column 6"),
        ("CD{2,1}L", "at least 2 and at most 1 times at column 7"),
        ("CD{101}", "expected a number up to 100 but found '1' at column 4"),
        ("C*L", "expected an event: one of D G S R T V L B O A . < [ ( but found '*' at column 2"),
        ("C<L.'window>", "expected a name and ' but found 'w' at column 6"),
        ("C<L.'door'>", "no light is named \"door\""),
        ("C[.^", "expected an event"),
    ] {
        let error = error(expression);
        assert!(error.contains(expected), "{expression}: {error}");
    }
    let deep = format!("C{}L{}", "(".repeat(60), ")".repeat(60));
    assert!(error(&deep).contains("more than 50 parentheses"), "{}", error(&deep));
    let huge = format!("C{}L", "(.{50}D|.{60}S){80}".repeat(9));
    assert!(error(&huge).contains("too many states"), "{}", error(&huge));
    let nested = format!("C{}.{}L", "(".repeat(40), "){100}".repeat(40));
    assert!(error(&nested).contains("too many states"), "{}", error(&nested));
}

#[test]
fn names_of_layers_are_words_of_their_own() {
    let named = |names: &[&str]| {
        let layers: Vec<_> = names.iter().map(|name| layer(name, "C.*L")).collect();
        LightPaths::new(&layers, LIGHTS.into_iter()).map(|paths| paths.count())
    };
    assert_eq!(named(&["direct", "in-direct_2"]).unwrap(), 2);
    for bad in [&["a", "a"][..], &["R"], &["Albedo"], &[""], &["a b"], &["a.b"], &["film"], &["motion"]] {
        assert!(named(bad).is_err(), "{bad:?}");
    }
}
