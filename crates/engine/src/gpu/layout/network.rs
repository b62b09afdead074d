//! The table of heat alone, see `kernels/network.cl`. Its kernels are a program of their own.

use super::super::network::Alone;
use super::{Argument, Buffer, Call, ExchangeOf, Head, InC, Pod, Traffic, Zeroable};

records! {
    /// What the kernels are told.
    Conduction {
        /// Length of the step, or of its part, s.
        step: f64,
        /// Square of the relative error that is allowed.
        tolerance_squared: f64,
        particles: u32,
        /// Of the words to which chunks of particles add.
        copies: u32,
        /// Prescribed temperatures stand behind those of walls,
        walls: u32,
        /// and outside values of exchanges behind those.
        exposures: u32,
        /// Part of the step, from 1.
        part: u32,
        /// Iterations beyond which no solution is sought.
        most_iterations: u32,
        /// Whether what comes in and goes out is booked.
        booked: u32,
        padding: u32,
    }
    /// How particles exchange heat with their surroundings: at a prescribed temperature, or through exchanges.
    Surface {
        first_exchange: u32,
        end_exchange: u32,
        prescribed: u32,
        padding: u32,
    }
    /// Of an implicit step: what all its iterations know together.
    Scalars {
        /// Of the residual, by the inverse of the diagonal, W K.
        square: f64,
        /// Of the temperatures that the residual stands for, J K.
        error: f64,
        /// The square that ends it, J K.
        limit: f64,
        /// Of all particles, J/K.
        capacity: f64,
        /// How far to go along the present way.
        part: f64,
        /// How much of the present way the next one keeps.
        turn: f64,
        iterations: u32,
        /// Nothing is left to do.
        done: u32,
        /// There is no solution.
        stuck: u32,
        padding: u32,
    }
}

kernels! {
    of Alone;
    /// Heat rates at temperatures.
    rate as Rate(256, 4) {
        conduction: value Conduction, halted: read u32,
        slice: read u64, contacts_end: read u32, bonds_end: read u32, walls_end: read u32, other: read u32,
        conductance: read f64,
        exposure: read u32, surfaces: read Surface, exchanges: read ExchangeOf, around: read f64,
        temperature: read f64, total: write f64, foreign: write f64,
    }
    /// The longest explicit step of each chunk.
    least_step as LeastStep(256, 4) {
        conduction: value Conduction,
        slice: read u64, contacts_end: read u32, bonds_end: read u32, walls_end: read u32, other: seldom u32,
        conductance: read f64,
        exposure: read u32, surfaces: read Surface, exchanges: read ExchangeOf, around: read f64, capacity: read f64,
        temperature: read f64, partial: write f64,
    }
    /// Temperatures and accounts behind a step.
    warm as Warm(256, 4) {
        conduction: value Conduction, halted: shared u32,
        exposure: read u32, surfaces: read Surface, around: read f64, capacity: read f64,
        total: read f64, foreign: read f64, temperature: update f64, heat_in: update f64, heat_out: update f64,
    }
    /// Where an implicit step begins, and the square of its temperatures.
    begin as Begin(256, 4) {
        conduction: value Conduction, exposure: read u32, surfaces: read Surface, around: read f64,
        capacity: read f64, temperature: read f64, end: write f64, sums: shared u32,
    }
    /// The system of an implicit step, and the residual of no change.
    assemble as Assemble(256, 4) {
        conduction: value Conduction,
        slice: read u64, contacts_end: read u32, bonds_end: read u32, walls_end: read u32, other: read u32,
        conductance: read f64,
        exposure: read u32, surfaces: read Surface, exchanges: read ExchangeOf, around: read f64, capacity: read f64,
        end: read f64, foreign: write f64, loss: write f64, held: write f64, diagonal: write f64, residual: write f64,
        change: write f64, way: write f64, sums: shared u32,
    }
    /// What the matrix makes of the present way.
    multiply as Multiply(256, 6) {
        conduction: value Conduction, scalars: read Scalars,
        slice: read u64, contacts_end: read u32, bonds_end: read u32, walls_end: seldom u32, other: read u32,
        conductance: read f64, exposure: read u32, surfaces: read Surface,
        held: read f64, way: read f64, product: write f64, sums: shared u32,
    }
    /// A part of the present way.
    advance as Advance(256, 6) {
        conduction: value Conduction, scalars: read Scalars, way: read f64, product: read f64, diagonal: read f64,
        capacity: read f64, change: update f64, residual: update f64, sums: shared u32,
    }
    /// The next way.
    turn as Turn(256, 6) {
        conduction: value Conduction, scalars: read Scalars, residual: read f64, diagonal: read f64, way: update f64,
    }
    /// Temperatures of the end, and what is foreign then.
    finish as Finish(256, 6) {
        conduction: value Conduction, change: read f64, loss: read f64, end: update f64, foreign: update f64,
    }
    /// Heat rates of the end.
    conduct as Conduct(256, 4) {
        conduction: value Conduction,
        slice: read u64, contacts_end: read u32, bonds_end: read u32, walls_end: seldom u32, other: read u32,
        conductance: read f64, end: read f64, foreign: read f64, total: write f64,
    }
    /// One group: what the solution is measured by.
    take_content as TakeContent(256, 1) { conduction: value Conduction, sums: shared u32, scalars: shared Scalars }
    /// One group: how far to go.
    take_work as TakeWork(256, 1) { conduction: value Conduction, sums: shared u32, scalars: shared Scalars }
    /// One group: what is missing now, and whether that will do. Counts an iteration, or none before the first.
    take_squares as TakeSquares(256, 1) {
        conduction: value Conduction, counted: value u32, sums: shared u32, scalars: shared Scalars,
    }
}
