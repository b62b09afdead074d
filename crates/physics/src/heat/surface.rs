//! What goes through the surface of a body of bonded particles: flux, convection, radiation, a face held warm.

use crate::Real;
use crate::real::Branch;

/// $\sigma$ of Stefan and Boltzmann, W/(m² K⁴).
pub const STEFAN_BOLTZMANN: f64 = 5.670_374_419e-8;

/// How a particle exchanges heat with its surroundings through its part $A$ of a surface.
///
/// The centre of a particle lies below the surface: at a depth $d$ behind material that conducts with $\lambda$. All that
/// acts on the surface acts at its one temperature $T_s$. Without depth that is the temperature of the particle, which is
/// wrong to first order in the size of particles.
///
/// $$Q = \frac{\lambda A}{d}(T_s - T) = qA + h_cA\,(T_\infty - T_s) + \varepsilon\sigma A\,(T_e^4 - T_s^4)$$
///
/// The part of $Q$ that is linear in $T_s$ is taken out of it. With $r = d/(\lambda A)$ and the part $w = 1/(1 + r h_cA)$ of
/// what enters at the surface that reaches the particle, since the rest leaves with the fluid,
///
/// $$Q = wA\,q + G\,(T_\infty - T) + w\varepsilon\sigma A\,(T_e^4 - T_s^4),\qquad T_s = T + rQ,\qquad
/// G = \frac{A}{d/\lambda + 1/h_c}$$
///
/// An infinite $h_c$ holds the surface at $T_\infty$: then $w = 0$.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exchange<R> {
    /// $wA$, m²; 0 for no flux.
    pub flux_area: R,
    /// $G$, W/K; 0 for no fluid.
    pub conductance: R,
    /// $w\varepsilon\sigma A$, W/K⁴; 0 for no radiation.
    pub radiation: R,
    /// $r = d/(\lambda A)$: between the centre and the surface, K/W.
    pub resistance: R,
}

/// What is outside of a surface. A value whose part of the exchange is 0 does nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outside<R> {
    /// $q$, which enters, W/m².
    pub flux: R,
    /// $T_\infty$ of the fluid, or what the surface is held at, K.
    pub fluid: R,
    /// $T_e$ of what it exchanges radiation with, K.
    pub surroundings: R,
}

impl<R: Real> Exchange<R> {
    /// $Q$, the heat rate into a particle of temperature $T$ (K), W.
    #[inline(always)]
    pub fn heat_rate(&self, temperature: R, outside: &Outside<R>) -> R {
        let linear = self.linear(temperature, outside);
        linear + self.radiated(self.surface_temperature(temperature, outside), outside)
    }

    /// $-\partial Q/\partial T = (G + g)/(1 + rg)$ with $g = 4w\varepsilon\sigma A\,T_s^3$, W/K: how much less heat comes
    /// in per kelvin of the particle.
    #[inline(always)]
    pub fn sensitivity(&self, temperature: R, outside: &Outside<R>) -> R {
        let surface = self.surface_temperature(temperature, outside);
        let radiating = R::lit(4.0) * self.radiation * (surface * surface * surface);
        (self.conductance + radiating) / (R::lit(1.0) + self.resistance * radiating)
    }

    /// The same exchange through material of another conductivity, from one of 1 W/(m K), where conductivity depends on
    /// temperature: with $r' = r/\lambda$ everything is multiplied by $\frac1{1 + (r' - r)G}$, so that
    /// $1/G' = 1/G + r' - r$.
    ///
    /// | argument | symbol | unit |
    /// |---|---|---|
    /// | `conductivity` | $\lambda(T)$ at the temperature of the particle, positive | W/(m K) |
    ///
    /// # Validity
    /// What lies between the centre and the surface conducts as at the centre, which is wrong to first order in the depth.
    #[inline(always)]
    #[must_use]
    pub fn tempered(&self, conductivity: R) -> Self {
        let resistance = self.resistance / conductivity;
        let one = R::lit(1.0);
        let part = one / (one + (resistance - self.resistance) * self.conductance);
        Exchange {
            flux_area: self.flux_area * part,
            conductance: self.conductance * part,
            radiation: self.radiation * part,
            resistance,
        }
    }

    /// $wAq + G(T_\infty - T)$, W.
    #[inline(always)]
    fn linear(&self, temperature: R, outside: &Outside<R>) -> R {
        self.flux_area * outside.flux + self.conductance * (outside.fluid - temperature)
    }

    /// $w\varepsilon\sigma A(T_e^4 - T_s^4)$, W.
    #[inline(always)]
    fn radiated(&self, surface: R, outside: &Outside<R>) -> R {
        self.radiation * (fourth_power(outside.surroundings) - fourth_power(surface))
    }

    /// $T_s$, K.
    ///
    /// # Numerics
    /// A surface that radiates is found by five steps of Newton's method for
    /// $f(T_s) = T_s - T_0 - a(T_e^4 - T_s^4)$ with $a = rw\varepsilon\sigma A$, where $T_0$ is what it would have if it did
    /// not. The root is at most the greater of $T_0$ and $T_e$, and at most $(T_e^4 + T_0/a)^{1/4}$; $f$ is convex, so that
    /// from the lesser of these the steps come down to it, to rounding, whatever the depth.
    #[inline(always)]
    pub fn surface_temperature(&self, temperature: R, outside: &Outside<R>) -> R {
        let alone = temperature + self.resistance * self.linear(temperature, outside);
        let cooling = Cooling { per_fourth: self.resistance * self.radiation, surroundings: outside.surroundings };
        // Without depth nothing has to be found either.
        R::when(cooling.per_fourth.gt(R::lit(0.0)), alone, cooling)
    }
}

/// Finds what a surface has that radiates behind a depth.
#[derive(Clone, Copy)]
struct Cooling<R> {
    /// $a$, 1/K³.
    per_fourth: R,
    /// $T_e$, K.
    surroundings: R,
}

impl<R: Real> Branch<R> for Cooling<R> {
    #[inline(always)]
    fn taken(self, alone: R) -> R {
        let (one, four) = (R::lit(1.0), R::lit(4.0));
        let outside = fourth_power(self.surroundings);
        // Not a number where a flux would cool the surface below zero: then the other bound is taken.
        let bound = (outside + alone / self.per_fourth).sqrt().sqrt();
        let mut surface = bound.min(alone.max(self.surroundings));
        for _ in 0..5 {
            let cube = surface * surface * surface;
            let excess = surface - alone - self.per_fourth * (outside - cube * surface);
            surface = surface - excess / (one + four * self.per_fourth * cube);
        }
        surface
    }
}

#[inline(always)]
fn fourth_power<R: Real>(value: R) -> R {
    let square = value * value;
    square * square
}

/// What lies between a particle and what is outside of its surface, from which [`Exchange`] follows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cover {
    /// $A$, m².
    pub area: f64,
    /// $d$, m.
    pub depth: f64,
    /// $\lambda$, W/(m K).
    pub conductivity: f64,
    /// $h_c$, W/(m² K); 0 for no fluid. Infinite, it holds the surface at a temperature.
    pub film: f64,
    /// $\varepsilon$; 0 for no radiation.
    pub emissivity: f64,
}

impl Cover {
    /// The exchange through it. Behind a depth that conducts nothing there is none but of a flux.
    #[must_use]
    pub fn exchange(&self) -> Exchange<f64> {
        let &Cover { area, depth, conductivity, film, emissivity } = self;
        let conductance = surface_conductance(area, depth, conductivity, film);
        let radiation = emissivity * STEFAN_BOLTZMANN * area;
        if depth > 0.0 && conductivity == 0.0 {
            return Exchange { flux_area: area, conductance, radiation: 0.0, resistance: 0.0 };
        }
        let resistance = if depth > 0.0 { depth / (conductivity * area) } else { 0.0 };
        let arriving = if resistance > 0.0 { 1.0 / (1.0 + resistance * (film * area)) } else { 1.0 };
        Exchange { flux_area: arriving * area, conductance, radiation: arriving * radiation, resistance }
    }
}

/// $G = A/(d/\lambda + 1/h_c)$, W/K. An infinite $h_c$ holds the surface at the outside temperature.
#[must_use]
pub fn surface_conductance(area: f64, depth: f64, conductivity: f64, film: f64) -> f64 {
    // Without depth nothing lies between, whether it would conduct or not.
    let material = if depth > 0.0 { depth / conductivity } else { 0.0 };
    area / (material + 1.0 / film)
}

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: Exchange<f64> = Exchange { flux_area: 0.0, conductance: 0.0, radiation: 0.0, resistance: 0.0 };
    const AREA: f64 = 1e-4;

    fn fourth(t: f64) -> f64 {
        (t * t) * (t * t)
    }

    /// All that acts at once, at a depth, m.
    fn cover(depth: f64) -> Cover {
        Cover { area: AREA, depth, conductivity: 1.5, film: 25.0, emissivity: 0.9 }
    }

    #[test]
    fn all_that_acts_on_a_surface_sees_its_one_temperature() {
        // From a hundredth of a millimetre to 1.5 m of concrete, by which the surface nearly has what is outside.
        for depth in [1e-5, 1e-3, 1e-2, 0.1, 1.5] {
            let exchange = cover(depth).exchange();
            for inside in [50.0, 293.15, 1173.15, 1800.0] {
                for surroundings in [50.0, 293.15, 1173.15, 1800.0] {
                    for (flux, fluid) in [(0.0, 293.15), (3e3, 1173.15), (-2e3, 400.0)] {
                        let outside = Outside { flux, fluid, surroundings };
                        let rate = exchange.heat_rate(inside, &outside);
                        let surface = inside + rate * exchange.resistance;
                        let balance = flux
                            + 25.0 * (fluid - surface)
                            + 0.9 * STEFAN_BOLTZMANN * (fourth(surroundings) - fourth(surface));
                        let scale =
                            25.0 * (fluid + surface) + 0.9 * STEFAN_BOLTZMANN * fourth(inside.max(surroundings));
                        assert!((rate / AREA - balance).abs() <= 1e-11 * scale, "{depth} {inside} {outside:?}");
                        let found = exchange.surface_temperature(inside, &outside);
                        assert!((found - surface).abs() <= 1e-11 * inside.max(surroundings), "{found} {surface}");
                    }
                }
            }
        }
    }

    #[test]
    fn sensitivity_is_the_slope_of_the_heat_rate() {
        for (inside, outside) in [(293.15, 1173.15), (1173.15, 293.15), (900.0, 900.0)] {
            let outside = Outside { flux: 1e3, fluid: 500.0, surroundings: outside };
            for exchange in [cover(0.0).exchange(), cover(1e-2).exchange()] {
                let rate = |temperature: f64| exchange.heat_rate(temperature, &outside);
                let slope = (rate(inside - 0.5) - rate(inside + 0.5)) / 1.0;
                let sensitivity = exchange.sensitivity(inside, &outside);
                assert!((sensitivity / slope - 1.0).abs() < 1e-5, "{sensitivity} {slope}");
            }
        }
        let outside = Outside { flux: 1e4, ..Outside::default() };
        assert_eq!(Exchange { flux_area: 2e-3, ..NONE }.sensitivity(500.0, &outside), 0.0);
    }

    #[test]
    fn an_exchange_through_a_better_conductor_is_that_of_the_better_conductor() {
        let (area, depth, conductivity) = (4e-4, 2e-3, 1.7);
        let resistance = |conductivity: f64| depth / (conductivity * area);
        for film in [10.0, 500.0, f64::INFINITY] {
            let of = |conductivity: f64| Exchange {
                conductance: surface_conductance(area, depth, conductivity, film),
                resistance: resistance(conductivity),
                ..NONE
            };
            let (found, expected) = (of(1.0).tempered(conductivity), of(conductivity));
            assert!((found.conductance / expected.conductance - 1.0).abs() < 1e-14, "{found:?} {expected:?}");
            assert!((found.resistance / expected.resistance - 1.0).abs() < 1e-15);
        }
        let radiating = |conductivity| Exchange { radiation: 2e-11, resistance: resistance(conductivity), ..NONE };
        assert_eq!(radiating(1.0).tempered(conductivity).radiation, 2e-11);
        let plain = Exchange { flux_area: area, ..NONE };
        assert_eq!(plain.tempered(conductivity), plain);
    }

    #[test]
    fn what_acts_alone_is_what_its_formula_says() {
        let flux = Outside { flux: 1e4, ..Outside::default() };
        let alone = Cover { film: 0.0, emissivity: 0.0, ..cover(1e-3) };
        assert_eq!(alone.exchange().heat_rate(500.0, &flux), 1e4 * AREA);
        let fluid = Outside { fluid: 293.15, ..Outside::default() };
        let film = Cover { film: 25.0, ..alone };
        let conductance = surface_conductance(AREA, 1e-3, 1.5, 25.0);
        assert_eq!(film.exchange().heat_rate(313.15, &fluid), conductance * (293.15 - 313.15));
        let held = Cover { film: f64::INFINITY, ..cover(1e-2) }.exchange();
        assert_eq!([held.flux_area, held.radiation], [0.0; 2]);
        assert!((held.surface_temperature(700.0, &fluid) - 293.15).abs() < 1e-9);
        let bare = cover(0.0).exchange();
        assert_eq!(bare.surface_temperature(700.0, &Outside { surroundings: 900.0, ..fluid }), 700.0);
        let behind_nothing = Cover { conductivity: 0.0, ..cover(1e-3) }.exchange();
        assert_eq!(behind_nothing, Exchange { flux_area: AREA, ..NONE });
    }

    #[test]
    fn a_film_and_what_it_covers_lie_one_behind_the_other() {
        assert!((surface_conductance(0.04, 0.0, 1.5, 10.0) - 0.4).abs() < 1e-15);
        assert!((surface_conductance(0.04, 0.01, 1.5, f64::INFINITY) - 6.0).abs() < 1e-12);
        assert_eq!(surface_conductance(0.04, 0.0, 0.0, 10.0), surface_conductance(0.04, 0.0, 1.5, 10.0));
        assert_eq!(surface_conductance(0.04, 0.01, 0.0, 10.0), 0.0);
    }
}
