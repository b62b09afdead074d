//! What heat goes through: a bar between the centres, the circle of a contact, a bond.

use crate::Real;
use crate::contact::Touch;
use crate::contact::encounter::radius_eff;

/// How heat goes through a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Path {
    /// Not at all.
    Closed,
    /// Along a bar between the centres, see [`bar`] (the paper's).
    Bar,
    /// Through the circle of the contact, see [`circle`].
    Circle,
}

/// What two materials conduct with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conductor<R> {
    /// $\lambda_{12}$ of [`pair_conductivity`], W/(m K).
    pub conductivity: R,
    /// $\tfrac{\pi}{4}\chi^2$: the section of the bar over the square of the sum of radii; $\chi$ is the radius of the bar
    /// over the mean of both radii.
    pub section: R,
}

/// $\lambda_{12} = 2\lambda_1\lambda_2/(\lambda_1+\lambda_2)$, W/(m K): two halves of equal length one behind the other.
///
/// # Example
/// ```
/// use tdem_physics::heat::conduction::pair_conductivity;
/// assert!((pair_conductivity(1.5, 45.0) - 2.9032).abs() < 1e-4); // concrete against steel
/// assert_eq!(pair_conductivity(0.0, 0.0), 0.0);
/// ```
#[inline(always)]
pub fn pair_conductivity<R: Real>(first: R, second: R) -> R {
    let (zero, sum) = (R::lit(0.0), first + second);
    let conducts = sum.gt(zero);
    R::select(conducts, R::lit(2.0) * (first * second) / R::select(conducts, sum, R::lit(1.0)), zero)
}

/// Conductance of a bar between two centres.
///
/// $$H = \frac{\lambda_{12}A}{L},\qquad A = \pi\Big(\chi\,\frac{R_1+R_2}{2}\Big)^2$$
///
/// | argument | symbol | unit |
/// |---|---|---|
/// | `conductor` | $\lambda_{12}, \chi$ | W/(m K), 1 |
/// | `radius_sum` | $R_1 + R_2$ | m |
/// | `length` | $L$, positive | m |
///
/// # Returns
/// $H$, W/K.
///
/// # Validity
/// With $\chi = 1$ a bonded body conducts too well (2.22 times on a face-centred cubic lattice); see [`face_centred_bar`].
///
/// # References
/// Pacevič & Kačeniauskas (2022), eq. 6.
#[inline(always)]
pub fn bar<R: Real>(conductor: &Conductor<R>, radius_sum: R, length: R) -> R {
    conductance_length(conductor, radius_sum) / length
}

/// $HL = \lambda_{12}A$, W m/K.
#[inline(always)]
fn conductance_length<R: Real>(conductor: &Conductor<R>, radius_sum: R) -> R {
    conductor.conductivity * (conductor.section * (radius_sum * radius_sum))
}

/// Conductance of the circle in which two spheres touch, $H = 2\lambda_{12}a$ with $a = \sqrt{R^*h}$, W/K.
///
/// | argument | symbol | unit |
/// |---|---|---|
/// | `conductivity` | $\lambda_{12}$ | W/(m K) |
/// | `radius_eff`, `overlap` | $R^*, h$ | m |
///
/// # Validity
/// $a \ll R$; nothing goes through the fluid in the gap.
///
/// # References
/// Batchelor & O'Brien, Proc. R. Soc. A 355 (1977) 313.
#[inline(always)]
pub fn circle<R: Real>(conductivity: R, radius_eff: R, overlap: R) -> R {
    R::lit(2.0) * conductivity * (radius_eff * overlap).sqrt()
}

/// Contact radius of two materials over that of the softened ones that stand for them, under the same load.
///
/// $$\frac{a}{a_s} = \Big(\frac{E^*_s}{E^*}\Big)^{1/3},\qquad a = \Big(\frac{3FR^*}{4E^*}\Big)^{1/3}$$
///
/// | argument | symbol | unit |
/// |---|---|---|
/// | `softened` | $E^*_s$, effective modulus of the contact law | Pa |
/// | `original` | $E^*$, effective modulus of the materials | Pa |
///
/// # Validity
/// Contacts that bear a given load: packings, beds, slow flows. Where heat goes through impacts of a given speed, the
/// largest contact radius goes with the power 1/5 instead (Zhou, Yu & Zulli 2010), and the impact lasts as much longer.
///
/// # Example
/// ```
/// use tdem_physics::heat::conduction::contact_radius_ratio;
/// assert!((contact_radius_ratio(6e7, 6e10) - 0.1).abs() < 1e-15); // a thousand times softer
/// ```
///
/// # References
/// Hertz' contact radius; the option `area_correction` of LIGGGHTS, which scales the overlap by the power 2/3 and so the
/// radius by 1/3. Zhou, Yu & Zulli, Powder Technology 197 (2010) 102 for impacts.
#[must_use]
pub fn contact_radius_ratio(softened: f64, original: f64) -> f64 {
    libm::cbrt(softened / original)
}

/// Conductance of the contact of two spheres of radii $R_1, R_2$ (m), W/K.
#[inline(always)]
pub fn between_spheres<R: Real>(
    path: Path,
    conductor: &Conductor<R>,
    first_radius: R,
    second_radius: R,
    touch: &Touch<R>,
) -> R {
    through_contact(path, conductor, first_radius + second_radius, radius_eff(first_radius, second_radius), touch)
}

/// Conductance of the contact of a sphere of radius $R$ (m) with a plane wall, W/K: the bar has $2R$ for the sum of radii
/// and ends at the wall.
#[inline(always)]
pub fn at_wall<R: Real>(path: Path, conductor: &Conductor<R>, radius: R, touch: &Touch<R>) -> R {
    through_contact(path, conductor, R::lit(2.0) * radius, radius, touch)
}

/// Conductance of bodies that touch, W/K.
#[inline(always)]
fn through_contact<R: Real>(path: Path, conductor: &Conductor<R>, radius_sum: R, radius_eff: R, touch: &Touch<R>) -> R {
    match path {
        Path::Closed => R::lit(0.0),
        Path::Bar => bar(conductor, radius_sum, touch.distance),
        Path::Circle => circle(conductor.conductivity, radius_eff, touch.overlap),
    }
}

/// $H = \lambda_{12}H_1$, W/K, with the conductivities of both bodies at their mean temperature in [`pair_conductivity`], where
/// they depend on it.
///
/// | argument | symbol | unit |
/// |---|---|---|
/// | `unit_conductance` | $H_1$, the conductance with a conductivity of 1 W/(m K) | W/K |
/// | `first`, `second` | $\lambda_1(\bar T), \lambda_2(\bar T)$ | W/(m K) |
#[inline(always)]
pub fn tempered<R: Real>(unit_conductance: R, first: R, second: R) -> R {
    unit_conductance * pair_conductivity(first, second)
}

/// $Q = H(T_2 - T_1)$, the heat rate into the first body, W.
#[inline(always)]
pub fn flow<R: Real>(conductance: R, first_temperature: R, second_temperature: R) -> R {
    conductance * (second_temperature - first_temperature)
}

/// What a bond within an open side of a face-centred lattice conducts over what others do, see [`Link::within_side`].
pub const WITHIN_SIDE: f64 = 1.5;

/// What a bond is to heat, whatever its length. It conducts through the section that it had when it was made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link<R> {
    /// $HL = \lambda_{12}A$, W m/K: the conductance of a bond of unit length.
    pub conductance_length: R,
    /// $\alpha_1R_1/(R_1+R_2)$: strain that it takes up without force per kelvin of the first body, 1/K.
    pub first_growth: R,
    /// $\alpha_2R_2/(R_1+R_2)$: and of the second, 1/K.
    pub second_growth: R,
}

impl<R: Real> Link<R> {
    /// The link of two bodies of radii $R$ (m) and expansions $\alpha$ (1/K).
    #[inline(always)]
    pub fn between(conductor: &Conductor<R>, radii: [R; 2], expansions: [R; 2]) -> Self {
        let [first, second] = radii;
        let radius_sum = first + second;
        let inverse = R::lit(1.0) / radius_sum;
        Link {
            conductance_length: conductance_length(conductor, radius_sum),
            first_growth: expansions[0] * (first * inverse),
            second_growth: expansions[1] * (second * inverse),
        }
    }

    /// $H$ of a bond of this length when it was made, m, W/K: that of a [`bar`].
    ///
    /// # Numerics
    /// By the inverse of the length, which the law of the bond has found already.
    #[inline(always)]
    pub fn conductance(&self, bonded_length: R) -> R {
        self.conductance_length * (R::lit(1.0) / bonded_length)
    }

    /// The same within an open side of a face-centred lattice: it conducts 3/2 times as well.
    ///
    /// A particle of a side has three bonds ahead instead of four, two of them within the side. With $2\cdot\tfrac32 + 1 = 4$
    /// it conducts along the side as those inside do, whatever the temperatures; at an edge of two sides three quarters of
    /// that remain.
    #[inline(always)]
    #[must_use]
    pub fn within_side(self) -> Self {
        Link { conductance_length: R::lit(WITHIN_SIDE) * self.conductance_length, ..self }
    }

    /// The strain that the bond takes up without force when its bodies expand by $\varepsilon_1$ and $\varepsilon_2$.
    ///
    /// $$\varepsilon = \frac{R_1\varepsilon_1 + R_2\varepsilon_2}{R_1+R_2},\qquad \varepsilon_k = \alpha_k(T_k - T_0)$$
    ///
    /// | argument | symbol | unit |
    /// |---|---|---|
    /// | `first_warmth`, `second_warmth` | $T_k - T_0$, above where bonds are free of stress | K |
    ///
    /// # Example
    /// ```
    /// use tdem_physics::bond::expansion::rest_length;
    /// use tdem_physics::heat::{Conductor, Link};
    /// // Steel and concrete of equal radius, 100 K warmer than when they were bonded.
    /// let conductor = Conductor { conductivity: 2.9, section: 0.35 };
    /// let link = Link::between(&conductor, [5e-4, 5e-4], [12e-6, 10e-6]);
    /// assert!((rest_length(1e-3, link.free_strain(100.0, 100.0)) - 1.0011e-3).abs() < 1e-15);
    /// ```
    ///
    /// # References
    /// Wanne & Young, Int. J. Rock Mech. Min. Sci. 45 (2008) 789, where $\Delta F_n = -\bar k_nA\bar\alpha L\Delta T$; the
    /// particles' part is eq. 7 of Pacevič & Kačeniauskas (2022) with the sign of an expansion.
    #[inline(always)]
    pub fn free_strain(&self, first_warmth: R, second_warmth: R) -> R {
        self.first_growth * first_warmth + self.second_growth * second_warmth
    }
}

/// $\chi = \sqrt{\sqrt2/\pi} = 0.670938$: with this bar, spheres on a face-centred cubic lattice conduct like the solid.
///
/// There $\lambda_{eff} = 4H/a$ in every direction, which is $\lambda$ if $A = \sqrt2R^2$. A block with open sides conducts
/// less along an axis, because particles of a side have three bonds ahead instead of four; `cells` are the lattice cells
/// across, and $A$ is divided by $1 - \frac1{4n_x} - \frac1{4n_y}$. `None` is the bulk.
///
/// # Errors
/// Temperatures of a block corrected in this way are right to second order in $1/n$.
///
/// # Example
/// ```
/// use tdem_physics::heat::conduction::face_centred_bar;
/// assert!((face_centred_bar(None) - 0.670938267).abs() < 1e-9);
/// assert!((face_centred_bar(Some([28, 28])) - 0.677010).abs() < 1e-6);
/// ```
#[must_use]
pub fn face_centred_bar(cells: Option<[u32; 2]>) -> f64 {
    let missing = cells.map_or(0.0, |cells| cells.iter().map(|&n| 0.25 / f64::from(n)).sum());
    (std::f64::consts::SQRT_2 / (std::f64::consts::PI * (1.0 - missing))).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_link_seen_from_either_side_is_the_same() {
        let conductor = Conductor { conductivity: 1.7, section: 0.35 };
        let (a, b) = ([1.1e-3, 0.7e-3], [6.6e-6, 12e-6]);
        let link = Link::between(&conductor, a, b);
        let back = Link::between(&conductor, [a[1], a[0]], [b[1], b[0]]);
        assert_eq!(link.conductance_length.to_bits(), back.conductance_length.to_bits());
        assert!((link.conductance(1.9e-3) / bar(&conductor, 1.8e-3, 1.9e-3) - 1.0).abs() < 1e-15);
        assert_eq!(link.free_strain(311.7, 17.9).to_bits(), back.free_strain(17.9, 311.7).to_bits());
        let flow_there = flow(link.conductance(1.9e-3), 400.3, 291.7);
        assert_eq!(flow_there.to_bits(), (-flow(link.conductance(1.9e-3), 291.7, 400.3)).to_bits());
    }

    #[test]
    fn free_strain_is_that_of_the_formula() {
        let conductor = Conductor { conductivity: 1.0, section: 1.0 };
        let link = Link::between(&conductor, [5e-4, 7e-4], [12e-6, 10e-6]);
        let expected = (5e-4 * (12e-6 * 100.0) + 7e-4 * (10e-6 * 80.0)) / (5e-4 + 7e-4);
        assert!((link.free_strain(100.0, 80.0) / expected - 1.0).abs() < 1e-14);
    }
}
