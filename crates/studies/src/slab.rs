//! A slab that is heated on one side and cooled on the other: its temperature, exactly.
//!
//! $$\frac{\partial T}{\partial t} = \alpha_T\frac{\partial^2T}{\partial x^2},\qquad
//! T(0,t) = T_{top}(t),\qquad -\lambda\frac{\partial T}{\partial x}(L,t) = h\,(T(L,t) - T_\infty),\qquad T(x,0) = T_0$$
//!
//! With $\xi = x/L$, $\mathrm{Bi} = hL/\lambda$, $\tau = \alpha_Tt/L^2$, the roots of $b_n\cot b_n = -\mathrm{Bi}$ and
//! $N_n = 1 + \mathrm{Bi}/(\mathrm{Bi}^2 + b_n^2)$, warmth $\theta = T - T_\infty$ has three parts:
//!
//! | cause | warmth |
//! |---|---|
//! | 1 everywhere at first, top at 0 | $\sum 2(1-\cos b_n)\sin(b_n\xi)\,e^{-b_n^2\tau}/(b_nN_n)$ |
//! | top at 1 from the start on | $s = p(\xi) - \sum 2\sin(b_n\xi)\,e^{-b_n^2\tau}/(b_nN_n)$, $p = 1 - \frac{\mathrm{Bi}}{1+\mathrm{Bi}}\xi$ |
//! | top at $t$, a ramp | $\int_0^ts\,dt = p\,t + \frac{L^2}{\alpha_T}\big(q(\xi) + \sum 2\sin(b_n\xi)\,e^{-b_n^2\tau}/(b_n^3N_n)\big)$ |
//!
//! where $q'' = p$, $q(0) = 0$, $q'(1) + \mathrm{Bi}\,q(1) = 0$. A temperature of the top that is straight between points
//! is a sum of ramps, one from each corner, by as much as the slope changes there.
//!
//! # References
//! Carslaw & Jaeger, *Conduction of Heat in Solids* (1959), 1.14 and 3.11.

use tdem_engine::Course;

/// What conducts, and how it gives heat away at the bottom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slab {
    /// $L$, m, positive.
    pub thickness: f64,
    /// $\alpha_T = \lambda/(\rho c)$, m²/s, positive.
    pub diffusivity: f64,
    /// $\lambda$, W/(m K), positive.
    pub conductivity: f64,
    /// $h$ at the bottom, W/(m² K); 0 insulates it.
    pub film_coefficient: f64,
}

/// What the slab is exposed to. All temperatures are in one unit, K or °C.
#[derive(Clone, Debug, PartialEq)]
pub struct Heating {
    /// $T_0$, everywhere at first.
    pub initial: f64,
    /// $T_\infty$, below the bottom.
    pub surroundings: f64,
    /// $T_{top}$ over time, s.
    pub top: Course,
}

/// Terms of the series at the most, see [`Slab::temperature`].
const MODES: u32 = 1000;
/// An exponent beyond which nothing is left: $e^{-50}$.
const FADED: f64 = 50.0;

impl Slab {
    /// $T$ at a depth below the top (m, 0 to the thickness) and a time (s), in the unit of the heating.
    ///
    /// # Validity
    /// Within $4\cdot10^{-8}$ of $L^2/\alpha_T$ times the largest slope, and much closer but just behind a corner of the
    /// course. Where the top or the bottom jumps at the start ($T_{top}(0)$ or $T_\infty$ other than $T_0$), only for
    /// $\alpha_Tt/L^2 > 5\cdot10^{-6}$: before, more terms would be needed.
    #[must_use]
    pub fn temperature(&self, heating: &Heating, depth: f64, time: f64) -> f64 {
        if time <= 0.0 {
            return if depth > 0.0 { heating.initial } else { heating.top.value(0.0) };
        }
        let place = depth / self.thickness;
        let scale = self.thickness * self.thickness / self.diffusivity;
        let at_first = heating.initial - heating.surroundings;
        let step = heating.top.value(0.0) - heating.surroundings;
        let ramps = ramps(&heating.top, time);
        let ramped = |since: f64| since * self.steady(place) + scale * self.lag(place);
        let mut warmth = step * self.steady(place);
        warmth += ramps.iter().map(|&[since, slope]| slope * ramped(since)).sum::<f64>();
        for n in 1..=MODES {
            let root = self.root(n);
            let rate = root * root / scale;
            // The ramp that began last fades last.
            let last = ramps.last().map_or(time, |ramp| ramp[0]);
            if rate * last > FADED {
                break;
            }
            let decay = |since: f64| libm::exp(-rate * since);
            let by_start = (at_first * (1.0 - libm::cos(root)) - step) * decay(time);
            let by_ramps = ramps.iter().map(|&[since, slope]| slope * decay(since)).sum::<f64>() / rate;
            warmth += self.mode(root, place) * (by_start + by_ramps);
        }
        heating.surroundings + warmth
    }

    /// $\mathrm{Bi} = hL/\lambda$.
    #[must_use]
    pub fn biot(&self) -> f64 {
        self.film_coefficient * self.thickness / self.conductivity
    }

    /// $b_n = n\pi - \arctan(b_n/\mathrm{Bi})$, by Newton's method: the left side less the right grows steadily.
    fn root(&self, n: u32) -> f64 {
        let (end, biot) = (f64::from(n) * std::f64::consts::PI, self.biot());
        (0..8).fold(end - 0.5 * std::f64::consts::FRAC_PI_2, |root, _| {
            let excess = root - end + libm::atan2(root, biot);
            root - excess / (1.0 + biot / (biot * biot + root * root))
        })
    }

    /// $2\sin(b_n\xi)/(b_nN_n)$.
    fn mode(&self, root: f64, place: f64) -> f64 {
        let biot = self.biot();
        2.0 * libm::sin(root * place) / (root * (1.0 + biot / (biot * biot + root * root)))
    }

    /// $p(\xi)$: warmth in the end if the top is at 1.
    fn steady(&self, place: f64) -> f64 {
        let biot = self.biot();
        1.0 - biot / (1.0 + biot) * place
    }

    /// $q(\xi)$: how the slab lags behind a ramp that has lasted.
    fn lag(&self, place: f64) -> f64 {
        let biot = self.biot();
        let loss = biot / (1.0 + biot);
        let slope = (1.0 - loss / 2.0 + biot * (0.5 - loss / 6.0)) / (1.0 + biot);
        place * (place * (0.5 - place * loss / 6.0) - slope)
    }
}

/// The ramps that have begun, in the order of time: how long ago, s, and by how much the slope changed, 1/s.
fn ramps(course: &Course, time: f64) -> Vec<[f64; 2]> {
    let mut corners = vec![0.0];
    corners.extend(course.0.iter().map(|point| point[0]).filter(|&corner| corner > 0.0));
    let slope = |ends: &[f64]| (course.value(ends[1]) - course.value(ends[0])) / (ends[1] - ends[0]);
    let slopes = corners.windows(2).map(slope).chain([0.0]);
    let mut before = 0.0;
    let changes = corners.iter().zip(slopes).map(|(&corner, slope)| {
        let change = slope - before;
        before = slope;
        [time - corner, change]
    });
    changes.take_while(|ramp| ramp[0] > 0.0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOUR: f64 = 3600.0;
    const FILMS: [f64; 5] = [0.0, 5.0, 10.0, 15.0, 25.0];

    fn refractory(film_coefficient: f64) -> Slab {
        Slab { thickness: 0.2, diffusivity: 1.5 / (2250.0 * 900.0), conductivity: 1.5, film_coefficient }
    }

    /// 20 to 900 °C at 300 K/h, half an hour there, back at 400 K/h.
    fn furnace() -> Heating {
        let top = Course(vec![[0.0, 20.0], [10560.0, 900.0], [12360.0, 900.0], [20280.0, 20.0]]);
        Heating { initial: 20.0, surroundings: 20.0, top }
    }

    /// Another program: eigenfunctions with Duhamel's integral, and finite volumes of 800 cells with Crank and Nicolson's
    /// rule, which agree within 2.4e-4 K.
    #[test]
    fn the_bottom_has_the_temperatures_of_the_reference() {
        let table = [
            (0.5, [20.0033, 20.0032, 20.0031, 20.0030, 20.0028]),
            (1.0, [20.6334, 20.5947, 20.5602, 20.5294, 20.4767]),
            (1.5, [25.0707, 24.6553, 24.3000, 23.9931, 23.4907]),
            (2.0, [36.6649, 35.0046, 33.6312, 32.4788, 30.6582]),
            (2.5, [57.0461, 52.7799, 49.3534, 46.5490, 42.2486]),
            (3.0, [86.6308, 78.0324, 71.3067, 65.9214, 57.8712]),
            (3.5, [125.2195, 110.3150, 98.9347, 89.9996, 76.9367]),
            (4.0, [171.4596, 148.1747, 130.7948, 117.3957, 98.2009]),
            (4.5, [220.1851, 186.7729, 162.4072, 143.9702, 118.1053]),
            (5.0, [263.1012, 218.7651, 187.2534, 163.9007, 131.9014]),
            (5.5, [294.0340, 239.1594, 201.2599, 173.8212, 137.2014]),
            (5.633_333_333, [299.8503, 242.3644, 202.9833, 174.6605, 137.1428]),
        ];
        for (hours, row) in table {
            for (film, expected) in FILMS.into_iter().zip(row) {
                let found = refractory(film).temperature(&furnace(), 0.2, hours * HOUR);
                assert!((found - expected).abs() < 1e-4, "h = {film}, {hours} h: {found} {expected}");
            }
        }
    }

    #[test]
    fn the_middle_has_the_temperatures_of_the_reference() {
        for (hours, expected) in [(1.0, 39.0508), (2.0, 117.1947), (3.0, 234.3424), (4.0, 350.5246), (5.0, 358.8953)] {
            let found = refractory(10.0).temperature(&furnace(), 0.1, hours * HOUR);
            assert!((found - expected).abs() < 1e-4, "{hours} h: {found} {expected}");
        }
    }

    #[test]
    fn the_bottom_is_warmest_when_the_reference_says() {
        let peaks = [(5.0, 246.222, 6.011), (10.0, 203.979, 5.839), (15.0, 174.803, 5.717), (25.0, 137.251, 5.556)];
        for (film, temperature, hours) in peaks {
            let at = |hours: f64| refractory(film).temperature(&furnace(), 0.2, hours * HOUR);
            assert!((at(hours) - temperature).abs() < 1e-3, "h = {film}: {} {temperature}", at(hours));
            assert!(at(hours - 0.02) < at(hours) && at(hours) > at(hours + 0.02), "h = {film}: not the peak");
        }
    }

    #[test]
    fn what_begins_with_a_jump_is_the_semi_infinite_solid() {
        let slab = refractory(10.0);
        let heating = Heating { initial: 20.0, surroundings: 20.0, top: Course(vec![[0.0, 120.0]]) };
        for (depth, time) in [(0.01, 60.0), (0.01, 300.0), (0.04, 900.0)] {
            let expected = 20.0 + 100.0 * libm::erfc(depth / (2.0 * (slab.diffusivity * time).sqrt()));
            let found = slab.temperature(&heating, depth, time);
            assert!((found - expected).abs() < 1e-9, "{depth} {time}: {found} {expected}");
        }
        // The film alone changes the bottom: a semi-infinite solid with convection at its surface.
        let heating = Heating { initial: 120.0, surroundings: 20.0, top: Course(vec![[0.0, 120.0]]) };
        let reach = (slab.diffusivity * 600.0).sqrt() * slab.film_coefficient / slab.conductivity;
        let expected = 20.0 + 100.0 * libm::exp(reach * reach) * libm::erfc(reach);
        let found = slab.temperature(&heating, 0.2, 600.0);
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    }

    #[test]
    fn in_the_end_heat_flows_steadily() {
        let slab = refractory(10.0);
        let heating = Heating { initial: 60.0, surroundings: 20.0, top: Course(vec![[0.0, 20.0], [HOUR, 520.0]]) };
        // 0.2/1.5 m²K/W in the slab, 1/10 at its bottom.
        let flux = 500.0 / (0.2 / 1.5 + 0.1);
        for depth in [0.0, 0.05, 0.2] {
            let found = slab.temperature(&heating, depth, 400.0 * HOUR);
            assert!((found - (520.0 - flux * depth / 1.5)).abs() < 1e-9, "{depth}: {found}");
        }
        // A top follows its course at all times, and nothing has changed at the start.
        for time in [0.0, 0.3 * HOUR, HOUR, 2.0 * HOUR] {
            assert!((slab.temperature(&heating, 0.0, time) - heating.top.value(time)).abs() < 1e-9);
        }
        assert_eq!(slab.temperature(&heating, 0.1, 0.0), 60.0);
    }
}
