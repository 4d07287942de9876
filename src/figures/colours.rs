//! Colours that survive colour blindness and print.

/// Red, green, blue from 0 to 255, and opacity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Colour {
    pub red: u8,
    pub green: u8,
    pub blue: u8,
    pub opacity: f64,
}

impl Colour {
    /// From 0xRRGGBB, opaque.
    #[must_use]
    pub const fn hex(rgb: u32) -> Colour {
        Colour { red: (rgb >> 16) as u8, green: (rgb >> 8) as u8, blue: rgb as u8, opacity: 1.0 }
    }

    /// The same colour, less opaque.
    #[must_use]
    pub const fn faint(self, opacity: f64) -> Colour {
        Colour { opacity, ..self }
    }
}

pub const BLACK: Colour = Colour::hex(0x1a_1a1a);
pub const GREY: Colour = Colour::hex(0x8a_8a8a);
pub const PALE: Colour = Colour::hex(0xdd_dddd);
pub const WHITE: Colour = Colour::hex(0xff_ffff);

/// Qualitative colours of Okabe & Ito (2008), the yellow left out: it vanishes on white.
pub const PALETTE: [Colour; 7] = [
    Colour::hex(0x00_72b2),
    Colour::hex(0xd5_5e00),
    Colour::hex(0x00_9e73),
    Colour::hex(0xcc_79a7),
    Colour::hex(0xe6_9f00),
    Colour::hex(0x56_b4e9),
    Colour::hex(0x4d_4d4d),
];

/// The colour of the n-th thing.
#[must_use]
pub fn palette(n: usize) -> Colour {
    PALETTE[n % PALETTE.len()]
}

/// Ten points of the viridis map of S. van der Walt & N. Smith (matplotlib 2.0, CC0), evenly spaced.
const VIRIDIS: [u32; 10] = [
    0x44_0154, 0x48_2878, 0x3e_4a89, 0x31_688e, 0x26_828e, 0x1f_9e89, 0x35_b779, 0x6d_cd59, 0xb4_de2c,
    0xfd_e725,
];

/// Viridis at 0 … 1, linear between ten published points; what is not a number is grey.
#[must_use]
pub fn viridis(at: f64) -> Colour {
    between(&VIRIDIS, at)
}

/// Blue, white, red for values of both signs at 0 … 1; the ends and middle of ColorBrewer's RdBu (Brewer 2002), reversed.
#[must_use]
pub fn diverging(at: f64) -> Colour {
    between(&[0x21_66ac, 0x67_a9cf, 0xd1_e5f0, 0xf7_f7f7, 0xfd_dbc7, 0xef_8a62, 0xb2_182b], at)
}

fn between(points: &[u32], at: f64) -> Colour {
    if !at.is_finite() {
        return PALE;
    }
    let x = at.clamp(0.0, 1.0) * (points.len() - 1) as f64;
    let k = (x as usize).min(points.len() - 2);
    let (a, b, part) = (Colour::hex(points[k]), Colour::hex(points[k + 1]), x - k as f64);
    let mix = |a: u8, b: u8| (f64::from(a) + part * (f64::from(b) - f64::from(a))).round() as u8;
    Colour { red: mix(a.red, b.red), green: mix(a.green, b.green), blue: mix(a.blue, b.blue), opacity: 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn viridis_starts_and_ends_as_published() {
        assert_eq!(viridis(0.0), Colour::hex(0x44_0154));
        assert_eq!(viridis(1.0), Colour::hex(0xfd_e725));
        assert_eq!((viridis(2.0), viridis(f64::NAN)), (Colour::hex(0xfd_e725), PALE));
    }
}
