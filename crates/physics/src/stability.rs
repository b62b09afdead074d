//! How large a time step may be.
//!
//! Bounds that are proved (an oscillator or a dashpot alone, bonded particles) are told from estimates (a packing in
//! contact, an impact).

use crate::bond::{Bond, Coefficients};
use crate::material::Elastic;
use crate::{Vec3, vec3};

/// Time a Rayleigh wave needs to travel around a sphere, s:
/// $T_R = \pi R\sqrt{\rho/G}\,/(0.1631\nu + 0.8766)$. Steps of 0.1 to 0.2 of it are customary with velocity Verlet,
/// 0.03 to 0.1 with Gear.
///
/// # Example
/// ```
/// use tdem_physics::{material::Elastic, stability::rayleigh_time};
/// let plastic = Elastic { young_modulus: 9.33e6, poisson_ratio: 0.352 };
/// assert!((rayleigh_time(0.02, 920.0, plastic) - 1.0985e-3).abs() < 1e-7);
/// ```
///
/// # References
/// Thornton & Randall, in *Micromechanics of Granular Materials* (1988) 133; LIGGGHTS documentation, fix
/// check/timestep/gran.
#[must_use]
pub fn rayleigh_time(radius: f64, density: f64, material: Elastic) -> f64 {
    let wave = (density / material.shear_modulus()).sqrt();
    std::f64::consts::PI * radius * wave / (0.1631 * material.poisson_ratio + 0.8766)
}

/// Duration of an elastic Hertz impact, s: $t_c = 2.8682657\,(m^{*2}/(R^*E^{*2}v))^{1/5}$; infinite at zero speed.
///
/// | argument | symbol | unit |
/// |---|---|---|
/// | `mass_eff` | $m^*$ | kg |
/// | `radius_eff` | $R^*$ | m |
/// | `young_modulus_eff` | $E^*$ | Pa |
/// | `speed` | $v$ | m/s |
///
/// # References
/// Johnson, *Contact Mechanics* (1985), section 11.4.
#[must_use]
pub fn hertz_collision_time(mass_eff: f64, radius_eff: f64, young_modulus_eff: f64, speed: f64) -> f64 {
    if speed == 0.0 {
        return f64::INFINITY;
    }
    let m_per_e = mass_eff / young_modulus_eff;
    2.868_265_7 * libm::pow(m_per_e * m_per_e / (radius_eff * speed), 0.2)
}

/// Largest overlap of an elastic Hertz impact, m: $h_{max} = (15m^*v^2/(16E^*\sqrt{R^*}))^{2/5}$.
#[must_use]
pub fn hertz_largest_overlap(mass_eff: f64, radius_eff: f64, young_modulus_eff: f64, speed: f64) -> f64 {
    libm::pow(15.0 * mass_eff * speed * speed / (16.0 * young_modulus_eff * radius_eff.sqrt()), 0.4)
}

/// Largest $\omega\Delta t$ of an undamped oscillator under velocity Verlet: proved.
pub const VERLET_OSCILLATOR_LIMIT: f64 = 2.0;
/// Largest $\gamma\Delta t$ of a dashpot alone under velocity Verlet, whose forces see the half-step velocity: proved.
pub const VERLET_DASHPOT_LIMIT: f64 = 2.0;
/// Largest $\omega\Delta t$ of an undamped oscillator under Gear's method: spectral radius at most 1 + 1e-9.
pub const GEAR_OSCILLATOR_LIMIT: f64 = 0.312;
/// Largest $\gamma\Delta t$ of a dashpot alone under Gear's method: spectral radius.
pub const GEAR_DASHPOT_LIMIT: f64 = 0.1635;
/// In a dense packing with twelve contacts a sphere feels about this multiple of the damping of one contact: estimate.
pub const DENSE_PACKING_DAMPING: f64 = 4.0;

/// Largest $\omega\Delta t$ of an oscillator of damping ratio $\zeta$ under velocity Verlet, whose forces see the half-step
/// velocity: $2(\sqrt{1+\zeta^2}-\zeta)$, proved.
#[must_use]
pub fn verlet_damped_oscillator_limit(damping_ratio: f64) -> f64 {
    2.0 / ((1.0 + damping_ratio * damping_ratio).sqrt() + damping_ratio)
}

/// The same under Gear's method: spectral radius. Little damping helps, much of it does harm.
#[must_use]
pub fn gear_damped_oscillator_limit(damping_ratio: f64) -> f64 {
    // The largest damping rate times the step grows with the damping ratio, ever more slowly: chords stay below it.
    const RATES: [[f64; 2]; 4] = [[0.2, 0.1345], [0.3, 0.148], [0.5, 0.1574], [1.0, 0.1624]];
    let [[least, _], .., [_, most]] = RATES;
    if damping_ratio <= least {
        return GEAR_OSCILLATOR_LIMIT;
    }
    let chord = RATES.windows(2).find(|chord| damping_ratio <= chord[1][0]);
    let rate = chord.map_or(most, |chord| {
        let [[left, below], [right, above]] = [chord[0], chord[1]];
        below + (above - below) * (damping_ratio - left) / (right - left)
    });
    GEAR_OSCILLATOR_LIMIT.min(rate / (2.0 * damping_ratio))
}

/// What the bonds of one particle hold it with, summed bond by bond: bounds of how fast bonded particles can vibrate and
/// how strongly dashpots act on them.
///
/// The stiffness matrix of all bonds is a sum over bonds, each of which is at most twice the sum of what it is with
/// either end held. So the greatest eigenvalue is at most twice that of the particle held most tightly while all others
/// are fixed:
///
/// $$\omega_{max}^2 \le 2\max_i\lambda_i,\qquad
/// \lambda_i \le \frac{p+r}2 + \sqrt{\left(\frac{p-r}2\right)^2 + c^2},\quad
/// p = \frac{\lVert\mathbf P\rVert}m,\ r = \frac{\lVert\mathbf Q\rVert}I,\ c^2 = \frac{|\mathbf c|^2}{mI}$$
///
/// $$\mathbf P = \sum K_s\mathbf 1 + (K_n-K_s)\mathbf{nn},\quad
/// \mathbf Q = \sum(K_sd^2+K_b)(\mathbf 1-\mathbf{nn}) + K_t\mathbf{nn},\quad \mathbf c = \sum K_sd\,\mathbf n$$
///
/// with row sums as norms; the dashpots' $\gamma_{max}$ is bounded in the same way by their coefficients. Proved, for any
/// packing, orientation of the axes and mixture of bonds. In a lattice $\mathbf c$ vanishes; in the face-centred cubic one
/// the bound is exact without shear stiffness and 1.30 times the true frequency at $\kappa = 1/3$.
///
/// # Example
/// ```
/// use tdem_physics::bond::{Bond, Cement, Section};
/// use tdem_physics::{stability::BondedParticle, vec3};
/// let cement = Cement {
///     stiffness_ratio: 0.0,
///     radius_multiplier: 1.0,
///     tensile_strength: f64::INFINITY,
///     shear_strength: f64::INFINITY,
///     internal_friction: 0.0,
///     moment_contribution: 1.0,
///     damping_ratio: 0.0,
/// };
/// let bond = Bond::new(&cement, &Section::between(1.0, 1e-3, 1e-3), 1e13);
/// let (mass, inertia) = (1e-5, 1.0);
/// let mut particle = BondedParticle::default();
/// particle.hold(&bond, vec3(1.0, 0.0, 0.0), 1e-3);
/// // A pair that vibrates along its bond: omega^2 = 2 K_n / m.
/// let omega = particle.greatest_frequency(mass, inertia);
/// assert!((omega * omega / (2.0 * bond.stiffness.normal / mass) - 1.0).abs() < 1e-12);
/// assert!((particle.verlet_step(mass, inertia) * omega / 2.0 - 1.0).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BondedParticle {
    springs: Held,
    dashpots: Held,
}

impl BondedParticle {
    /// Adds a bond that leaves in the direction of `normal`, with the particle's lever arm (m).
    pub fn hold(&mut self, bond: &Bond<f64>, normal: Vec3<f64>, arm: f64) {
        self.springs.hold(&bond.stiffness, normal, arm);
        self.dashpots.hold(&bond.damping, normal, arm);
    }

    /// The bound of $\omega_{max}$, rad/s, for a particle of the given mass (kg) and moment of inertia (kg m²). The
    /// greatest of all particles bounds every vibration of the whole.
    #[must_use]
    pub fn greatest_frequency(&self, mass: f64, inertia: f64) -> f64 {
        self.springs.bound(mass, inertia).sqrt()
    }

    /// The bound of the damping rate $\gamma_{max}$, 1/s; an oscillator of damping ratio $\zeta$ has $2\zeta\omega$.
    #[must_use]
    pub fn greatest_damping_rate(&self, mass: f64, inertia: f64) -> f64 {
        self.dashpots.bound(mass, inertia)
    }

    /// The largest step of velocity Verlet, s: $(\omega_{max}\Delta t)^2 + 2\gamma_{max}\Delta t \le 4$, proved. The least
    /// of all particles is that of the whole; infinite without bonds.
    ///
    /// # Numerics
    /// With forces that see the half-step velocity, Verlet is the central difference method with the mass matrix
    /// reduced by $\tfrac12\Delta t\,\mathbf C$, which is stable while $\mathbf M - \tfrac12\Delta t\,\mathbf C -
    /// \tfrac14\Delta t^2\,\mathbf K$ is positive definite.
    #[must_use]
    pub fn verlet_step(&self, mass: f64, inertia: f64) -> f64 {
        let (square, rate) = (self.springs.bound(mass, inertia), self.greatest_damping_rate(mass, inertia));
        4.0 / (rate + (rate * rate + 4.0 * square).sqrt())
    }
}

/// The block of one particle in a stiffness or damping matrix.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Held {
    /// $\mathbf P$: diagonal, and the pairs yz, zx, xy.
    translation: [Vec3<f64>; 2],
    /// $\mathbf Q$ likewise.
    rotation: [Vec3<f64>; 2],
    coupling: Vec3<f64>,
}

impl Default for Held {
    fn default() -> Self {
        let none = Vec3::zero();
        Held { translation: [none; 2], rotation: [none; 2], coupling: none }
    }
}

impl Held {
    fn hold(&mut self, coefficients: &Coefficients<f64>, normal: Vec3<f64>, arm: f64) {
        let add = |[diagonal, pairs]: &mut [Vec3<f64>; 2], along: f64, across: f64| {
            let n = normal;
            let difference = along - across;
            *diagonal = *diagonal + vec3(n.x * n.x, n.y * n.y, n.z * n.z) * difference + vec3(across, across, across);
            *pairs = *pairs + vec3(n.y * n.z, n.z * n.x, n.x * n.y) * difference;
        };
        add(&mut self.translation, coefficients.normal, coefficients.shear);
        add(&mut self.rotation, coefficients.torsion, coefficients.shear * arm * arm + coefficients.bending);
        self.coupling = self.coupling + normal * (coefficients.shear * arm);
    }

    /// $2\lambda$.
    fn bound(&self, mass: f64, inertia: f64) -> f64 {
        let norm = |[diagonal, pairs]: [Vec3<f64>; 2]| {
            let p = pairs.map(f64::abs);
            let rows = diagonal.map(f64::abs) + vec3(p.y + p.z, p.z + p.x, p.x + p.y);
            rows.x.max(rows.y).max(rows.z)
        };
        let (p, r) = (norm(self.translation) / mass, norm(self.rotation) / inertia);
        let coupling = self.coupling.dot(self.coupling) / (mass * inertia);
        let half = 0.5 * (p - r);
        2.0 * (0.5 * (p + r) + (half * half + coupling).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bond::{Cement, Section};
    use crate::motion::gear::{self, Trajectory};

    /// Golden: omega_max in units of sqrt(K_n/m) from lattice_checks.out, a scan of all waves of the face-centred cubic
    /// lattice.
    #[test]
    fn bound_of_the_bonded_lattice() {
        for (ratio, multiplier, scanned) in
            [(0.0, 1.0, 2.8284), (0.1, 0.5, 2.9665), (0.1, 1.0, 3.0058), (1.0 / 3.0, 1.0, 3.9791), (1.0, 1.0, 6.5192)]
        {
            let cement = Cement {
                stiffness_ratio: ratio,
                radius_multiplier: multiplier,
                tensile_strength: f64::INFINITY,
                shear_strength: f64::INFINITY,
                internal_friction: 0.0,
                moment_contribution: 1.0,
                damping_ratio: 0.0,
            };
            let section = Section::between(multiplier, 1.0, 1.0);
            let bond = Bond::new(&cement, &section, 1.0 / section.area);
            let mut particle = BondedParticle::default();
            let s = std::f64::consts::FRAC_1_SQRT_2;
            for [u, v] in [[s, s], [s, -s], [-s, s], [-s, -s]] {
                for normal in [vec3(u, v, 0.0), vec3(0.0, u, v), vec3(v, 0.0, u)] {
                    particle.hold(&bond, normal, 1.0);
                }
            }
            let bound = particle.greatest_frequency(1.0, 0.4);
            assert!((particle.verlet_step(1.0, 0.4) * bound / VERLET_OSCILLATOR_LIMIT - 1.0).abs() < 1e-15);
            assert!((scanned - 1e-4..1.45 * scanned).contains(&bound), "{ratio}: {bound} for {scanned}");
        }
    }

    /// A unit oscillator under Gear's method; whether it has died away after 20,000 steps.
    fn gear_dies_away(step: f64, damping_ratio: f64) -> bool {
        let mut now =
            Trajectory { position: vec3(1.0, 0.0, 0.0), velocity: Vec3::zero(), derivatives: [Vec3::zero(); 4] };
        for _ in 0..20_000 {
            let p = gear::predict(&now, step);
            now = gear::correct(&p, -p.position - p.velocity * (2.0 * damping_ratio), 1.0, step);
        }
        now.position.x.abs() < 1e-3
    }

    #[test]
    fn limits_of_gear_with_damping() {
        for damping_ratio in [0.02, 0.05, 0.1, 0.2, 0.25, 0.3, 0.4, 0.5, 0.7, 1.0, 3.0] {
            let limit = gear_damped_oscillator_limit(damping_ratio);
            assert!(gear_dies_away(0.995 * limit, damping_ratio), "{damping_ratio}");
        }
        for damping_ratio in [0.3, 0.4, 0.5, 1.0, 3.0] {
            let limit = gear_damped_oscillator_limit(damping_ratio);
            assert!(!gear_dies_away(1.03 * limit, damping_ratio), "{damping_ratio}");
        }
    }

    /// Two particles on a line, [`crate::motion::verlet`]: the bound is the limit itself.
    #[test]
    fn the_step_of_a_damped_pair_is_the_largest_that_is_stable() {
        let (mass, stiffness, damping_ratio) = (2.0, 50.0_f64, 0.3);
        let rigid = Coefficients { normal: stiffness, shear: 0.0, torsion: 0.0, bending: 0.0 };
        let coefficient = 2.0 * damping_ratio * (0.5 * mass * stiffness).sqrt();
        let dashpots = Coefficients { normal: coefficient, ..rigid.scaled(0.0, 0.0) };
        let section = Section::between(1.0, 1.0, 1.0);
        let cement = Cement {
            stiffness_ratio: 0.0,
            radius_multiplier: 1.0,
            tensile_strength: f64::INFINITY,
            shear_strength: f64::INFINITY,
            internal_friction: 0.0,
            moment_contribution: 1.0,
            damping_ratio,
        };
        let bond = Bond { stiffness: rigid, damping: dashpots, ..Bond::new(&cement, &section, 1.0) };
        let mut particle = BondedParticle::default();
        particle.hold(&bond, vec3(1.0, 0.0, 0.0), 1.0);
        let limit = particle.verlet_step(mass, 0.4 * mass);
        let dies_away = |step: f64| {
            let (mut stretch, mut rate) = (1.0_f64, 0.0_f64);
            for _ in 0..5000 {
                rate -= step * (stiffness * stretch + coefficient * rate) / (0.5 * mass);
                stretch += step * rate;
            }
            stretch.abs() < 1.0
        };
        assert!(dies_away(0.999 * limit) && !dies_away(1.001 * limit), "{limit}");
    }

    #[test]
    fn a_particle_without_bonds_sets_no_limit() {
        assert_eq!(BondedParticle::default().verlet_step(1.0, 0.4), f64::INFINITY);
    }

    #[test]
    fn damping_lowers_the_limit_of_verlet() {
        assert_eq!(verlet_damped_oscillator_limit(0.0), VERLET_OSCILLATOR_LIMIT);
        // A dashpot alone: omega dt = gamma dt / (2 zeta).
        let zeta = 1e6;
        assert!((verlet_damped_oscillator_limit(zeta) * 2.0 * zeta / VERLET_DASHPOT_LIMIT - 1.0).abs() < 1e-9);
    }

    #[test]
    fn collision_of_two_glass_spheres() {
        // Chung & Ooi (2011) test 1: R = 10 mm, rho = 2800, E = 48 GPa, nu = 0.2, +-10 m/s.
        let mass = 4.0 / 3.0 * std::f64::consts::PI * 1e-6 * 2800.0;
        let t = hertz_collision_time(0.5 * mass, 0.005, 2.5e10, 20.0);
        assert!((t / 4.033_945e-5 - 1.0).abs() < 1e-6, "{t}");
        let h = hertz_largest_overlap(0.5 * mass, 0.005, 2.5e10, 20.0);
        assert!((h / 2.741_127e-4 - 1.0).abs() < 1e-6, "{h}");
    }
}
