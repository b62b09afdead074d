//! The figures as data: what was measured, arranged as the paper arranges it.

use super::published::On;
use super::{Machine, Measured, Mode, Model, Published, Quantity, Record, Size};

/// A record, looked at.
pub(super) struct View<'a> {
    pub(super) record: &'a Record,
    pub(super) published: &'a Published,
}

impl View<'_> {
    /// Measurements of a model on a machine in a mode, the smallest first.
    pub(super) fn series(&self, machine: usize, mode: Mode, model: Model) -> Vec<&Measured> {
        let mut found: Vec<&Measured> = self.of(machine, mode).filter(|measured| measured.model == model).collect();
        found.sort_by_key(|measured| measured.particles);
        found
    }
    fn of(&self, machine: usize, mode: Mode) -> impl Iterator<Item = &Measured> {
        self.record.measurements.iter().filter(move |measured| measured.machine == machine && measured.mode == mode)
    }
    /// One measurement.
    pub(super) fn one(&self, machine: usize, mode: Mode, model: Model, size: Size) -> Option<&Measured> {
        self.of(machine, mode).find(|measured| measured.model == model && measured.size == size)
    }
    /// The size at which most models were measured on a machine in this mode; of several, the largest.
    pub(super) fn size(&self, machine: usize, mode: Mode) -> Option<Size> {
        let models =
            |size: Size| Model::ALL.iter().filter(|&&model| self.one(machine, mode, model, size).is_some()).count();
        Size::ALL.into_iter().filter(|&size| models(size) > 0).max_by_key(|&size| (models(size), size))
    }
    /// The models measured at that size.
    pub(super) fn at(&self, machine: usize, mode: Mode) -> Vec<&Measured> {
        let size = self.size(machine, mode);
        let one = |model| self.one(machine, mode, model, size?);
        Model::ALL.into_iter().filter_map(one).collect()
    }
    /// A value of each particle over that of GN at the same size: the applications differ a little in their numbers of
    /// particles.
    pub(super) fn over_gn(
        &self,
        machine: usize,
        mode: Mode,
        model: Model,
        value: impl Fn(&Measured) -> f64,
    ) -> Option<f64> {
        let size = self.size(machine, mode)?;
        let of = |model| self.one(machine, mode, model, size).map(&value);
        Some(of(model)? / of(Model::GN)?)
    }
    /// What a published Cundall number would be at the bandwidth of a machine: a scaling, not a measurement.
    pub(super) fn scaled(&self, cundall: f64, machine: &Machine) -> f64 {
        cundall * machine.copy_bytes_per_second / self.published.constant(Quantity::Bandwidth)
    }
    /// The published Cundall number of a model.
    pub(super) fn cundall(&self, model: Model) -> Option<f64> {
        self.published.value(Quantity::Cundall, Some(model), Some(On::Gpu))
    }
    /// How many times faster the paper's GPU is than its processors, at least, where it prints that, and at most.
    pub(super) fn published_speed_up(&self, model: Model) -> Option<(Option<f64>, f64)> {
        match self.published.find(Quantity::SpeedUp, Some(model), None).and_then(|value| value.range) {
            Some([low, high]) => Some((Some(low), high)),
            None => self.published.value(Quantity::SpeedUpAtMost, Some(model), None).map(|most| (None, most)),
        }
    }
    /// How many times faster the first machine is than another, at each size that both have.
    pub(super) fn speed_ups(&self, other: usize, mode: Mode) -> Vec<(&Measured, &Measured)> {
        let pair = |fast| {
            let fast: &Measured = fast;
            Some((fast, self.one(other, mode, fast.model, fast.size)?))
        };
        let mut pairs: Vec<_> = self.of(0, mode).filter_map(pair).collect();
        pairs.sort_by_key(|(fast, _)| (fast.model, fast.particles));
        pairs
    }
    /// The machine of this place.
    pub(super) fn machine(&self, place: usize) -> &Machine {
        &self.record.machines[place]
    }
}
