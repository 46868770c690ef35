//! Attribute decoder: elements of 4 to 256 bytes as byte-wise deltas from element to element; mode 0, versions 0 and 1.

use super::{Decoded, LEFT_OVER, Stream, TOO_SHORT};

/// Number of elements that share one header of bit widths.
const GROUP: usize = 16;

/// The bit widths of a group's deltas, by its two header bits.
const WIDTHS_OF_VERSION_0: [u32; 4] = [0, 2, 4, 8];
/// Widths of version 1, by the two control bits of a byte position; the other two controls have no header.
const WIDTHS_OF_VERSION_1: [[u32; 4]; 2] = [[0, 1, 2, 4], [1, 2, 4, 8]];

/// The encoding of deltas of four bytes of an element.
#[derive(Clone, Copy)]
enum Channel {
    Bytes,
    Words,
    /// Exclusive or of 32 bits, rotated left by this number of bits.
    Turned(u32),
}

pub(super) fn decode(bytes: &[u8], count: usize, stride: usize) -> Decoded<Vec<u8>> {
    let (&header, body) = bytes.split_first().ok_or(TOO_SHORT)?;
    let is_new = match header {
        0xa0 => false,
        0xa1 => true,
        _ => return Err("the compressed stream of attributes does not begin with a0 or a1"),
    };
    // The tail holds the baseline element and, in version 1, the channel mode of every four bytes of an element.
    let (tail, shortest) = if is_new { (stride + stride / 4, 24) } else { (stride, 32) };
    let blocks = body.len().checked_sub(tail.max(shortest)).ok_or(TOO_SHORT)?;
    let (baseline, channels) = body[body.len() - tail..].split_at(stride);
    let channels = match is_new {
        true => channels.iter().map(|&code| channel(code)).collect::<Decoded<Vec<_>>>()?,
        false => vec![Channel::Bytes; stride / 4],
    };

    let mut stream = Stream { rest: &body[..blocks] };
    let mut last = baseline.to_vec();
    let most = ((8192 / stride) & !15).min(256);
    let mut decoded = Vec::new();
    let mut differences = vec![0; most * stride];
    while decoded.len() < count * stride {
        let length = (count - decoded.len() / stride).min(most);
        // Each byte position of the block's elements has its own run of deltas.
        let controls = if is_new { Some(stream.take(stride / 4)?) } else { None };
        for position in 0..stride {
            let control = controls.map(|controls| (controls[position / 4] >> (2 * (position % 4))) & 3);
            let run = &mut differences[position * most..][..most];
            read_run(&mut stream, control, length, run)?;
        }
        // Prefix sums along the elements.
        for index in 0..length {
            for (quad, channel) in channels.iter().enumerate() {
                let difference = [0, 1, 2, 3].map(|byte| differences[(4 * quad + byte) * most + index]);
                let value = &mut last[4 * quad..][..4];
                let before = [value[0], value[1], value[2], value[3]];
                value.copy_from_slice(&channel.next(before, difference));
            }
            decoded.extend_from_slice(&last);
        }
    }
    if stream.rest.is_empty() { Ok(decoded) } else { Err(LEFT_OVER) }
}

fn channel(code: u8) -> Decoded<Channel> {
    match (code & 15, code >> 4) {
        (0, 0) => Ok(Channel::Bytes),
        (1, 0) => Ok(Channel::Words),
        (2, turn) => Ok(Channel::Turned(u32::from(turn))),
        _ => Err("the compressed stream of attributes has an unknown channel mode"),
    }
}

impl Channel {
    /// The next value of the four bytes.
    fn next(self, before: [u8; 4], difference: [u8; 4]) -> [u8; 4] {
        match self {
            Self::Bytes => {
                let step = |d: u8| (d >> 1) ^ (d & 1).wrapping_neg();
                [0, 1, 2, 3].map(|i| before[i].wrapping_add(step(difference[i])))
            }
            Self::Words => {
                let word = |bytes: [u8; 4], i: usize| u16::from_le_bytes([bytes[i], bytes[i + 1]]);
                let step = |d: u16| (d >> 1) ^ (d & 1).wrapping_neg();
                let sum = |i| word(before, i).wrapping_add(step(word(difference, i))).to_le_bytes();
                let (low, high) = (sum(0), sum(2));
                [low[0], low[1], high[0], high[1]]
            }
            Self::Turned(by) => {
                let turned = u32::from_le_bytes(difference).rotate_right(by);
                (u32::from_le_bytes(before) ^ turned).to_le_bytes()
            }
        }
    }
}

/// The deltas of one byte position for a block of `length` elements.
fn read_run(stream: &mut Stream<'_>, control: Option<u8>, length: usize, run: &mut [u8]) -> Decoded<()> {
    let widths = match control {
        None => WIDTHS_OF_VERSION_0,
        Some(2) => {
            run.fill(0);
            return Ok(());
        }
        Some(3) => {
            run[..length].copy_from_slice(stream.take(length)?);
            return Ok(());
        }
        Some(control) => WIDTHS_OF_VERSION_1[usize::from(control)],
    };
    let groups = length.div_ceil(GROUP);
    let header = stream.take(groups.div_ceil(4))?;
    for (index, group) in run.chunks_exact_mut(GROUP).take(groups).enumerate() {
        let width = widths[usize::from((header[index / 4] >> (2 * (index % 4))) & 3)];
        read_group(stream, width, group)?;
    }
    Ok(())
}

/// Sixteen deltas of `width` bits each; all ones mean that the delta follows as a byte.
pub(super) fn read_group(stream: &mut Stream<'_>, width: u32, group: &mut [u8]) -> Decoded<()> {
    match width {
        0 => group.fill(0),
        8 => group.copy_from_slice(stream.take(GROUP)?),
        _ => {
            let packed = stream.take(2 * width as usize)?;
            let mask = (1u8 << width) - 1;
            let in_a_byte = 8 / width as usize;
            for (i, difference) in group.iter_mut().enumerate() {
                // Single bits start at the lowest, wider ones at the highest.
                let place = (i % in_a_byte) as u32;
                let shift = if width == 1 { place } else { 8 - width * (place + 1) };
                let value = (packed[i / in_a_byte] >> shift) & mask;
                *difference = if value == mask { stream.byte()? } else { value };
            }
        }
    }
    Ok(())
}
