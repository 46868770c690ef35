//! Index decoders: triangles that share edges and vertices with recent ones (mode 1), and any sequence (mode 2).

use super::{Decoded, Stream, TOO_SHORT};

/// A ring buffer of the last sixteen items, the newest at 0.
struct Recent<T> {
    items: [T; 16],
    next: usize,
}

impl<T: Copy> Recent<T> {
    fn push(&mut self, item: T) {
        self.items[self.next] = item;
        self.next = (self.next + 1) % 16;
    }

    fn at(&self, age: usize) -> T {
        self.items[(self.next + 15 - age) % 16]
    }
}

/// The placeholder of an empty history entry; no vertex has this index.
const NOTHING: u32 = u32::MAX;

/// The decoder of vertex indices, by a half byte each: 0 is a new vertex, 15 an index in the stream, others recent ones.
struct Vertices<'a> {
    stream: Stream<'a>,
    recent: Recent<u32>,
    next: u32,
    last: u32,
}

impl Vertices<'_> {
    fn fresh(&mut self) -> u32 {
        let index = self.next;
        self.next = self.next.wrapping_add(1);
        index
    }

    fn written(&mut self) -> Decoded<u32> {
        let number = self.stream.number()?;
        self.last = self.last.wrapping_add((number >> 1) ^ (number & 1).wrapping_neg());
        Ok(self.last)
    }

    fn by(&mut self, code: u8) -> Decoded<u32> {
        match code {
            0 => Ok(self.fresh()),
            15 => self.written(),
            age => Ok(self.recent.at(usize::from(age) - 1)),
        }
    }
}

pub(super) fn triangles(bytes: &[u8], count: usize) -> Decoded<Vec<u32>> {
    let (&header, body) = bytes.split_first().ok_or(TOO_SHORT)?;
    if header != 0xe1 {
        return Err("the compressed stream of triangles does not begin with e1");
    }
    let (codes, body) = body.split_at_checked(count / 3).ok_or(TOO_SHORT)?;
    let (data, table) = body.split_at_checked(body.len().wrapping_sub(16)).ok_or(TOO_SHORT)?;

    let mut edges = Recent { items: [[NOTHING; 2]; 16], next: 0 };
    let recent = Recent { items: [NOTHING; 16], next: 0 };
    let mut vertices = Vertices { stream: Stream { rest: data }, recent, next: 0, last: 0 };
    let mut indices = Vec::with_capacity(count);
    for &code in codes {
        let (high, low) = (code >> 4, code & 15);
        let triangle @ [a, b, c] = if high < 15 {
            // A recent edge and a third vertex.
            let [a, b] = edges.at(usize::from(high));
            let (c, is_new) = match low {
                0 => (vertices.fresh(), true),
                13 | 14 => {
                    let step = if low == 13 { u32::MAX } else { 1 };
                    vertices.last = vertices.last.wrapping_add(step);
                    (vertices.last, true)
                }
                15 => (vertices.written()?, true),
                age => (vertices.recent.at(usize::from(age)), false),
            };
            if is_new {
                vertices.recent.push(c);
            }
            [a, b, c]
        } else {
            // Three vertices, whose codes are in the table or in the stream.
            let kinds = if low < 14 { table[usize::from(low)] } else { vertices.stream.byte()? };
            if low >= 14 && kinds == 0 {
                vertices.next = 0;
            }
            let [first, second, third] = [if low == 15 { 15 } else { 0 }, kinds >> 4, kinds & 15];
            let corners = [vertices.by(first)?, vertices.by(second)?, vertices.by(third)?];
            for (kind, corner) in [first, second, third].into_iter().zip(corners) {
                if kind == 0 || kind == 15 {
                    vertices.recent.push(corner);
                }
            }
            edges.push([corners[1], corners[0]]);
            corners
        };
        edges.push([c, b]);
        edges.push([a, c]);
        if triangle.contains(&NOTHING) {
            return Err("the compressed stream of triangles refers to a vertex before the first");
        }
        indices.extend(triangle);
    }
    vertices.stream.finish()?;
    Ok(indices)
}

pub(super) fn sequence(bytes: &[u8], count: usize) -> Decoded<Vec<u32>> {
    let (&header, body) = bytes.split_first().ok_or(TOO_SHORT)?;
    if header != 0xd1 {
        return Err("the compressed stream of indices does not begin with d1");
    }
    let (data, _) = body.split_at_checked(body.len().wrapping_sub(4)).ok_or(TOO_SHORT)?;
    // Every index takes at least a byte, so the count cannot exceed the length of the data.
    if data.len() < count {
        return Err(TOO_SHORT);
    }
    let mut stream = Stream { rest: data };
    let mut last = [0u32; 2];
    let mut indices = Vec::with_capacity(count);
    for _ in 0..count {
        let number = stream.number()?;
        let baseline = &mut last[(number & 1) as usize];
        let step = number >> 1;
        *baseline = baseline.wrapping_add((step >> 1) ^ (step & 1).wrapping_neg());
        indices.push(*baseline);
    }
    stream.finish()?;
    Ok(indices)
}
