//! What goes through the surface of a body of bonded particles: flux, convection, radiation, a face held warm.

use crate::Real;

/// $\sigma$ of Stefan and Boltzmann, W/(m² K⁴).
pub const STEFAN_BOLTZMANN: f64 = 5.670_374_419e-8;

/// How a particle exchanges heat with its surroundings through its part $A$ of a surface.
///
/// The centre of a particle lies below the surface: at a depth $d$ behind material that conducts with $\lambda$. Without
/// depth the surface has the temperature of the particle, which is wrong to first order in the size of particles.
///
/// $$Q = q A + G\,(T_\infty - T) + \varepsilon\sigma A\,(T_\infty^4 - T_s^4),\qquad
/// G = \frac{A}{d/\lambda + 1/h_c}$$
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exchange<R> {
    /// $A$, m²: what the outside value is multiplied by if it is a flux (W/m²), else 0.
    pub flux_area: R,
    /// $G$, W/K; $A\lambda/d$ for a face that is held at a temperature. 0 for none.
    pub conductance: R,
    /// $\varepsilon\sigma A$, W/K⁴; 0 for none.
    pub radiation: R,
    /// $d/(\lambda A)$: between the centre and the surface that radiates, K/W.
    pub resistance: R,
}

impl<R: Real> Exchange<R> {
    /// $Q$, the heat rate into a particle of temperature $T$ (K) under an outside value: $T_\infty$ in K, or $q$ in W/m².
    ///
    /// # Numerics
    /// The temperature $T_s$ of a surface that radiates is found by four steps of Newton's method, from the particle's.
    #[inline(always)]
    pub fn heat_rate(&self, temperature: R, outside: R) -> R {
        let inward = self.flux_area * outside + self.conductance * (outside - temperature);
        inward + self.radiated(temperature, outside)
    }

    /// $-\partial Q/\partial T = G + g/(1 + g\,d/(\lambda A))$ with $g = 4\varepsilon\sigma A\,T_s^3$, W/K: how much
    /// less heat comes in per kelvin of the particle.
    #[inline(always)]
    pub fn sensitivity(&self, temperature: R, outside: R) -> R {
        let surface = self.surface_temperature(temperature, outside);
        let radiating = R::lit(4.0) * self.radiation * (surface * surface * surface);
        self.conductance + radiating / (R::lit(1.0) + self.resistance * radiating)
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

    /// $\varepsilon\sigma A(T_\infty^4 - T_s^4)$ with $T_s = T + Q\,d/(\lambda A)$.
    #[inline(always)]
    fn radiated(&self, temperature: R, outside: R) -> R {
        let surface = self.surface_temperature(temperature, outside);
        let square = outside * outside;
        let surroundings = square * square;
        let square = surface * surface;
        self.radiation * (surroundings - square * square)
    }

    /// $T_s$ of a surface that radiates, K.
    #[inline(always)]
    fn surface_temperature(&self, temperature: R, outside: R) -> R {
        let square = outside * outside;
        let surroundings = square * square;
        let mut surface = temperature;
        for _ in 0..4 {
            let cube = surface * surface * surface;
            let rate = self.radiation * (surroundings - cube * surface);
            // f = T_s - T - r Q(T_s), f' = 1 + 4 r eps sigma A T_s^3.
            let slope = R::lit(1.0) + self.resistance * (R::lit(4.0) * self.radiation * cube);
            surface = surface - (surface - temperature - self.resistance * rate) / slope;
        }
        surface
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

    #[test]
    fn a_surface_that_radiates_has_the_temperature_between() {
        let (area, depth, conductivity, emissivity) = (1e-4, 1e-3, 1.5, 0.9);
        let radiation = emissivity * STEFAN_BOLTZMANN * area;
        let exchange = Exchange { radiation, resistance: depth / (conductivity * area), ..NONE };
        for (inside, outside) in [(293.15_f64, 1173.15_f64), (1173.15, 293.15), (300.0, 310.0)] {
            let rate = exchange.heat_rate(inside, outside);
            let surface = inside + rate * exchange.resistance;
            let fourth = |t: f64| (t * t) * (t * t);
            let expected = radiation * (fourth(outside) - fourth(surface));
            assert!((rate - expected).abs() <= 1e-10 * rate.abs(), "{rate} {expected}");
        }
    }

    #[test]
    fn sensitivity_is_the_slope_of_the_heat_rate() {
        let exchange = Exchange { conductance: 2e-3, radiation: 5e-12, resistance: 30.0, ..NONE };
        for (inside, outside) in [(293.15, 1173.15), (1173.15, 293.15), (900.0, 900.0)] {
            let rate = |temperature: f64| exchange.heat_rate(temperature, outside);
            let slope = (rate(inside - 0.5) - rate(inside + 0.5)) / 1.0;
            let sensitivity = exchange.sensitivity(inside, outside);
            assert!((sensitivity / slope - 1.0).abs() < 1e-5, "{sensitivity} {slope}");
        }
        assert_eq!(Exchange { flux_area: 2e-3, ..NONE }.sensitivity(500.0, 1e4), 0.0);
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
    fn flux_and_convection_add_up_to_what_they_say() {
        assert_eq!(Exchange { flux_area: 2e-3, ..NONE }.heat_rate(500.0, 1e4), 20.0);
        let film = surface_conductance(0.04, 0.0, 1.5, 10.0);
        assert!((Exchange { conductance: film, ..NONE }.heat_rate(313.15, 293.15) + 8.0).abs() < 1e-12);
        assert!((surface_conductance(0.04, 0.01, 1.5, f64::INFINITY) - 6.0).abs() < 1e-12);
        assert_eq!(surface_conductance(0.04, 0.0, 0.0, 10.0), film);
        assert_eq!(surface_conductance(0.04, 0.01, 0.0, 10.0), 0.0);
    }
}
