//! Temperatures on the processor.

use super::field::{Field, Stuck, is_temperature};
use super::{Network, Rates, Surroundings};
use crate::cpu::{self, CHUNK, optional};
use crate::heat::book;
use crate::{Fault, HeatPlan, Plan, State};
use rayon::ThreadPool;
use rayon::prelude::*;
use std::sync::Arc;
use tdem_physics::heat::warming::warmed;

/// Temperatures, and what conducts between them.
pub(crate) struct Processor {
    heat: HeatPlan,
    pool: Arc<ThreadPool>,
    /// `(N)`.
    exposure: Vec<u16>,
    /// K, `(N)`.
    temperature: Vec<f64>,
    /// J, `(N)`; empty without ledger.
    accounts: Vec<[f64; 4]>,
    network: Network,
    around: Surroundings,
    rates: Rates,
    /// What properties that depend on temperature are looked up by.
    tempered: Option<Tempered>,
    /// The first that has no temperature.
    wrong: Option<usize>,
}

/// What tables are looked up by.
pub(crate) struct Tempered {
    /// `(N)`.
    pub(crate) material: Vec<u16>,
    /// kg, `(N)`.
    pub(crate) mass: Vec<f64>,
    /// `(walls)`.
    pub(crate) wall_material: Vec<u16>,
}

impl Processor {
    pub(crate) fn new(pool: &Arc<ThreadPool>, plan: &Plan, heat: &HeatPlan, state: &State) -> Self {
        Processor {
            heat: heat.clone(),
            pool: Arc::clone(pool),
            exposure: state.exposure.clone(),
            temperature: Vec::new(),
            accounts: Vec::new(),
            network: Network::default(),
            around: Surroundings::default(),
            rates: Rates::default(),
            tempered: (!heat.tables.is_empty()).then(|| Tempered {
                material: state.material.clone(),
                mass: state.mass.clone(),
                wall_material: plan.walls.iter().map(|wall| wall.material).collect(),
            }),
            wrong: None,
        }
    }
}

impl Field for Processor {
    fn take_up(&mut self, temperature: &[f64], accounts: Vec<[f64; 4]>) -> Result<(), Fault> {
        self.temperature = temperature.to_vec();
        self.accounts = accounts;
        Ok(())
    }
    fn put(&mut self, state: &mut State) -> Result<(), Fault> {
        state.temperature.clone_from(&self.temperature);
        state.heat_rate.clone_from(&self.rates.total);
        state.heat_accounts.clone_from(&self.accounts);
        Ok(())
    }
    fn temperatures(&mut self) -> Result<Vec<f64>, Fault> {
        Ok(self.temperature.clone())
    }
    fn link(&mut self, network: Network) -> Result<(), Fault> {
        self.network = network;
        Ok(())
    }
    fn surround(&mut self, around: Surroundings) -> Result<(), Fault> {
        self.around = around;
        Ok(())
    }
    fn temper(&mut self) -> Result<(), Fault> {
        if let Some(by) = &self.tempered {
            self.network.temper(&self.temperature, by, &self.heat, &self.around);
        }
        Ok(())
    }
    fn longest_step(&mut self) -> Result<f64, Fault> {
        Ok(self.network.longest_step(&self.temperature, &self.exposure, &self.heat, &self.around))
    }
    fn rate(&mut self) -> Result<(), Fault> {
        self.rates = self.network.rates(&self.temperature, &self.exposure, &self.heat, &self.around);
        Ok(())
    }
    fn solve(&mut self, step: f64) -> Result<Result<u64, Stuck>, Fault> {
        let solved = self.network.implicit(&self.temperature, &self.exposure, &self.heat, &self.around, step);
        Ok(solved.map(|(rates, iterations)| {
            self.rates = rates;
            iterations
        }))
    }
    fn warm(&mut self, step: f64) -> Result<(), Fault> {
        if self.wrong.is_some() {
            return Ok(());
        }
        let (capacity, rates, exposure) = (&self.network.capacity, &self.rates, &self.exposure);
        let (prescribed, heat, tempered) = (&self.around.prescribed, &self.heat, self.tempered.as_ref());
        self.wrong = self
            .temperature
            .par_chunks_mut(CHUNK)
            .zip(optional(&mut self.accounts))
            .enumerate()
            .filter_map(|(chunk, (temperature, accounts))| {
                let mut wrong = None;
                for k in 0..temperature.len() {
                    let i = chunk * CHUNK + k;
                    let free = match tempered {
                        Some(by) => heat.warmed(by.material[i], by.mass[i], temperature[k], rates.total[i], step),
                        None => warmed(temperature[k], rates.total[i], capacity[i], step),
                    };
                    let now = prescribed[usize::from(exposure[i])].unwrap_or(free);
                    if let Some(account) = accounts.get_mut(k) {
                        book(account, rates.foreign[i] * step);
                        let given = match tempered {
                            Some(by) => heat.heat_between(by.material[i], by.mass[i], free, now),
                            None => capacity[i] * (now - free),
                        };
                        book(account, given);
                    }
                    temperature[k] = now;
                    if !is_temperature(now) {
                        wrong = wrong.or(Some(i));
                    }
                }
                wrong
            })
            .min();
        Ok(())
    }
    fn book(&mut self, column: usize, amount: f64) {
        if let Some(account) = self.accounts.first_mut() {
            account[column] += amount;
        }
    }
    fn astray(&mut self) -> Result<Option<(usize, f64)>, Fault> {
        Ok(self.wrong.take().map(|index| (index, self.temperature[index])))
    }
    fn bytes(&self) -> usize {
        size_of_val(&self.temperature[..])
            + size_of_val(&self.accounts[..])
            + size_of_val(&self.exposure[..])
            + self.tempered.as_ref().map_or(0, |by| size_of_val(&by.material[..]) + size_of_val(&by.mass[..]))
            + self.network.bytes()
            + self.rates.bytes()
    }
    fn copy_bandwidth(&self) -> Result<f64, Fault> {
        cpu::copy_bandwidth(&self.pool)
    }
}
