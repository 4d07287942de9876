//! Packets of a file that is written as it comes: length, checksum, compressed content. A packet that was cut short
//! by a crash is recognised.

use std::io::{Error, ErrorKind, Read, Write};

/// Bytes before the content: length, checksum.
pub const HEAD: u64 = 8;

/// Writes a packet; its length in the file.
///
/// # Errors
/// Those of `out`, and content of 4 GB or more.
pub fn write(out: &mut impl Write, content: &[u8]) -> std::io::Result<u64> {
    let body = zstd::bulk::compress(content, 1)?;
    let length = u32::try_from(body.len()).map_err(Error::other)?;
    let mut packet = Vec::with_capacity(HEAD as usize + body.len());
    packet.extend(length.to_le_bytes());
    packet.extend(crc32fast::hash(&body).to_le_bytes());
    packet.extend(body);
    out.write_all(&packet)?;
    Ok(packet.len() as u64)
}

/// What is found where a packet may begin.
#[derive(Debug, PartialEq, Eq)]
pub enum Found {
    /// Its length in the file and its content.
    Packet(u64, Vec<u8>),
    /// The end of the file, or a last packet that was cut short.
    End,
    /// Something that is no packet, with more behind it.
    Damaged,
}

/// Reads the packet that begins here, `left` bytes before the end of the file.
///
/// # Errors
/// Those of `from`.
pub fn read(from: &mut impl Read, left: u64) -> std::io::Result<Found> {
    if left < HEAD {
        return Ok(Found::End);
    }
    let mut head = [0; HEAD as usize];
    from.read_exact(&mut head)?;
    let word = |k: usize| u32::from_le_bytes([head[k], head[k + 1], head[k + 2], head[k + 3]]);
    let length = HEAD + u64::from(word(0));
    if length > left {
        return Ok(Found::End);
    }
    let mut body = vec![0; word(0) as usize];
    from.read_exact(&mut body)?;
    if body.is_empty() || crc32fast::hash(&body) != word(4) {
        // A crash of the machine can leave a last packet that is long enough but not all there.
        return Ok(if length == left || body.is_empty() { Found::End } else { Found::Damaged });
    }
    match zstd::stream::decode_all(body.as_slice()) {
        Ok(content) => Ok(Found::Packet(length, content)),
        Err(error) if error.kind() == ErrorKind::OutOfMemory => Err(error),
        Err(_) => Ok(Found::Damaged),
    }
}
