//! Smoothing kernels W(r) with cut-off `h` in one, two and three dimensions.
//!
//! `h` is the cut-off (support radius) of every kernel here, not half of it as in some of the literature.

use std::f64::consts::PI;

/// The shape of a kernel; q = r/h in 0..1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum KernelKind {
    /// Lucy (1977): (1 + 3q)(1 - q)³.
    #[default]
    Lucy,
    /// Cubic spline of Monaghan & Lattanzio (1985).
    CubicSpline,
    /// Quintic Wendland (1995) C2: (1 - q)⁴(1 + 4q); the same polynomial in 1D.
    Wendland,
}

/// A normalised kernel of `D` dimensions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kernel<const D: usize> {
    kind: KernelKind,
    /// Cut-off, m.
    h: f64,
    inverse_h: f64,
    /// Normalisation, m^-D.
    a: f64,
    /// a/h², the unit of F.
    a_f: f64,
}

impl<const D: usize> Kernel<D> {
    /// The kernel of a shape with cut-off `h` (m).
    #[must_use]
    pub fn new(kind: KernelKind, h: f64) -> Kernel<D> {
        let unit = match (kind, D) {
            (KernelKind::Lucy, 1) => 5.0 / 4.0,
            (KernelKind::Lucy, 2) => 5.0 / PI,
            (KernelKind::Lucy, _) => 105.0 / (16.0 * PI),
            (KernelKind::CubicSpline, 1) => 4.0 / 3.0,
            (KernelKind::CubicSpline, 2) => 40.0 / (7.0 * PI),
            (KernelKind::CubicSpline, _) => 8.0 / PI,
            (KernelKind::Wendland, 1) => 3.0 / 2.0,
            (KernelKind::Wendland, 2) => 7.0 / PI,
            (KernelKind::Wendland, _) => 21.0 / (2.0 * PI),
        };
        let a = unit / h.powi(D as i32);
        Kernel { kind, h, inverse_h: 1.0 / h, a, a_f: a / (h * h) }
    }

    /// The cut-off h, m.
    #[inline]
    #[must_use]
    pub fn cutoff(&self) -> f64 {
        self.h
    }

    /// W(r), m^-D; zero from the cut-off on.
    #[inline]
    #[must_use]
    pub fn value(&self, r: f64) -> f64 {
        let q = r * self.inverse_h;
        let s = 1.0 - q;
        if s <= 0.0 {
            return 0.0;
        }
        self.a
            * match self.kind {
                KernelKind::Lucy => (1.0 + 3.0 * q) * s * s * s,
                KernelKind::CubicSpline if q < 0.5 => 1.0 - 6.0 * q * q * s,
                KernelKind::CubicSpline => 2.0 * s * s * s,
                KernelKind::Wendland => (1.0 + 4.0 * q) * (s * s) * (s * s),
            }
    }

    /// F(r) = -W'(r)/r >= 0, m^-(D+2), so that the gradient is `-F x_ij`; zero from the cut-off on.
    #[inline]
    #[must_use]
    pub fn f(&self, r: f64) -> f64 {
        let mut one = [r];
        self.fs_in_place(&mut one);
        one[0]
    }

    /// F of every distance `r` (m) into `out`.
    #[inline(always)]
    pub fn fs(&self, r: &[f64], out: &mut [f64]) {
        out.copy_from_slice(r);
        self.fs_in_place(out);
    }

    /// F in the place of every distance (m): one loop a shape, which the compiler turns into many at a time.
    #[inline(always)]
    pub fn fs_in_place(&self, r: &mut [f64]) {
        match self.kind {
            KernelKind::Lucy => self.each(r, |_, s| 12.0 * s * s),
            KernelKind::CubicSpline => {
                self.each(r, |q, s| if q < 0.5 { 12.0 - 18.0 * q } else { 6.0 * s * s / q });
            }
            KernelKind::Wendland => self.each(r, |_, s| 20.0 * s * s * s),
        }
    }

    /// a/h² `shape(q, 1 - q)` in the place of every distance (m), with 1 - q not below zero.
    #[inline(always)]
    fn each(&self, r: &mut [f64], shape: impl Fn(f64, f64) -> f64) {
        for r in r {
            let q = *r * self.inverse_h;
            let s = 1.0 - q;
            *r = self.a_f * shape(q, if s > 0.0 { s } else { 0.0 });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KINDS: [KernelKind; 3] = [KernelKind::Lucy, KernelKind::CubicSpline, KernelKind::Wendland];

    fn integral<const D: usize>(kernel: &Kernel<D>) -> f64 {
        let n = 20_000;
        let dr = kernel.cutoff() / f64::from(n);
        (0..n)
            .map(|k| {
                let r = (f64::from(k) + 0.5) * dr;
                let shell = [2.0, 2.0 * PI * r, 4.0 * PI * r * r][D - 1];
                kernel.value(r) * shell * dr
            })
            .sum()
    }

    fn check<const D: usize>() {
        for kind in KINDS {
            let kernel = Kernel::<D>::new(kind, 2.4e-6);
            // Midpoint rule with 2e4 intervals: error of order 1e-9.
            assert!((integral(&kernel) - 1.0).abs() < 1e-7, "{kind:?} in {D}D");
            for q in [0.05, 0.3, 0.49, 0.51, 0.77, 0.95] {
                let (r, d) = (q * 2.4e-6, 1e-5 * 2.4e-6);
                let slope = (kernel.value(r + d) - kernel.value(r - d)) / (2.0 * d);
                let scale = kernel.value(0.0) / 2.4e-6;
                // Central difference: truncation 1e-10 and rounding 1e-11 of the scale, times a few.
                assert!((slope + kernel.f(r) * r).abs() < 1e-8 * scale, "{kind:?} in {D}D at {q}");
            }
            assert_eq!((kernel.value(2.4e-6), kernel.f(2.5e-6)), (0.0, 0.0));
        }
    }

    #[test]
    fn normalised_and_gradient_matches_difference_quotient() {
        check::<1>();
        check::<2>();
        check::<3>();
    }
}
