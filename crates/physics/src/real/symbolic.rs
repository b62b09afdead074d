//! Names for numbers: a law called with them prints itself as C.
//!
//! [`CFunction::record`] calls a law with [`Symbol`]s and turns what is done to them into one straight-line function:
//! a `const real` temporary per operation, an `if` per [`Real::when`]. The text is C99, OpenCL C and CUDA C at once; it
//! needs `real` (a double), `sqrt`, `fabs`, `INFINITY` and `NAN`, and a compiler that does not contract `a * b + c`.
//!
//! # Numerics
//! The function computes the bits of the same law called with `f64`. What is left out cannot change one: a second
//! computation of the same expression, an operation between constants (unless it gives NaN), a value nobody uses.
//! `a + b` and `b + a` stay two operations, `x + 0` and `x * 1` stay operations.
//!
//! # Example
//! ```
//! use tdem_physics::real::{CFunction, Real};
//! let function = CFunction::record("void hypotenuse(const real a, const real b, real *c)", |c| {
//!     let (a, b) = (c.input("a"), c.input("b"));
//!     let square = (a * a + b * b).named("square");
//!     c.output("*c", square.sqrt());
//! });
//! assert_eq!(
//!     function.text,
//!     "void hypotenuse(const real a, const real b, real *c)
//! {
//!     const real t1 = a * a;
//!     const real t2 = b * b;
//!     const real square = t1 + t2;
//!     const real t3 = sqrt(square);
//!     *c = t3;
//! }
//! "
//! );
//! assert_eq!(function.always.multiplications, 2);
//! ```

mod c_text;
mod tape;

use super::{Branch, Pack, Real};
use std::cell::RefCell;
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::atomic::{AtomicU64, Ordering};
use tape::{Id, Kind, Operation, Tape};

thread_local! {
    static TAPE: RefCell<Option<Tape>> = const { RefCell::new(None) };
}
/// Tells recordings apart, also those of other threads.
static RECORDINGS: AtomicU64 = AtomicU64::new(0);

/// The name of a number that a recorded function will compute.
///
/// # Panics
/// Every operation panics outside the [`CFunction::record`] the symbol belongs to, and outside the [`Real::when`] that
/// made it.
#[derive(Clone, Copy, Debug)]
pub struct Symbol {
    recording: u64,
    id: Id,
}

/// The name of a comparison; panics where a [`Symbol`] does.
#[derive(Clone, Copy, Debug)]
pub struct SymbolMask {
    recording: u64,
    id: Id,
}

/// A function in C, printed by a law.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CFunction {
    /// Head and body.
    pub text: String,
    /// Operations that every call executes.
    pub always: Operations,
    /// Operations inside branches, executed where their condition holds.
    pub in_branches: Operations,
}

/// How many operations of each kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Operations {
    /// `+` and `-`.
    pub additions: usize,
    /// `*`.
    pub multiplications: usize,
    /// `/`.
    pub divisions: usize,
    /// `sqrt`.
    pub square_roots: usize,
    /// `>`.
    pub comparisons: usize,
    /// `?:`; a minimum or maximum is a comparison and a selection.
    pub selections: usize,
    /// Unary `-` and `fabs`, which touch only the sign bit.
    pub sign_changes: usize,
}

impl Operations {
    /// Additions, multiplications, divisions and square roots, each counted once.
    #[must_use]
    pub fn arithmetic(&self) -> usize {
        self.additions + self.multiplications + self.divisions + self.square_roots
    }
}

impl Add for Operations {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Operations {
            additions: self.additions + other.additions,
            multiplications: self.multiplications + other.multiplications,
            divisions: self.divisions + other.divisions,
            square_roots: self.square_roots + other.square_roots,
            comparisons: self.comparisons + other.comparisons,
            selections: self.selections + other.selections,
            sign_changes: self.sign_changes + other.sign_changes,
        }
    }
}

/// What goes into and comes out of the function that is being recorded.
#[derive(Debug)]
pub struct Recorder {
    recording: u64,
}

impl CFunction {
    /// The function with the given head (return type, name and parameters, no brace) that computes what `body` does to
    /// its inputs. Identifiers of the head are never used for temporaries.
    ///
    /// # Panics
    /// If a recording already runs on this thread.
    #[must_use]
    pub fn record(head: &str, body: impl FnOnce(&Recorder)) -> CFunction {
        /// Leaves the thread clean also if the law panics.
        struct Cleared;
        impl Drop for Cleared {
            fn drop(&mut self) {
                TAPE.take();
            }
        }
        let recording = RECORDINGS.fetch_add(1, Ordering::Relaxed);
        TAPE.with_borrow_mut(|tape| {
            assert!(tape.is_none(), "a recording already runs on this thread: CFunction::record cannot be nested");
            *tape = Some(Tape::new(recording));
        });
        let _cleared = Cleared;
        body(&Recorder { recording });
        c_text::function(head, with_tape(Tape::finish))
    }

    /// All operations, branches taken.
    #[must_use]
    pub fn operations(&self) -> Operations {
        self.always + self.in_branches
    }
}

impl Recorder {
    /// A number read from an expression of C: a parameter (`dt`), a member (`law.friction`), what a pointer shows
    /// (`*energy`). All inputs are read before the first output is written.
    #[must_use]
    pub fn input(&self, expression: &str) -> Symbol {
        let id = with_tape(|tape| {
            tape.check(self.recording);
            tape.input(expression)
        });
        Symbol { recording: self.recording, id }
    }

    /// Assigns a number to an lvalue of C at the end of the function.
    ///
    /// # Panics
    /// If the lvalue was assigned before or is a parameter by value, or inside [`Real::when`].
    pub fn output(&self, lvalue: &str, value: Symbol) {
        with_tape(|tape| {
            tape.check(self.recording);
            let id = tape.usable(value.recording, value.id);
            tape.output(lvalue, id);
        });
    }
}

/// Borrows the tape of the running recording.
fn with_tape<T>(act: impl FnOnce(&mut Tape) -> T) -> T {
    TAPE.with_borrow_mut(|tape| {
        act(tape.as_mut().expect("no recording runs on this thread: symbols live only inside CFunction::record"))
    })
}

/// Records an operation, or computes it if its value is already known.
fn made(tape: &mut Tape, operation: Operation, constant: Option<f64>) -> Symbol {
    // Which NaN an operation gives differs between machines, so it is left to them.
    let id = match constant {
        Some(value) if !value.is_nan() => tape.literal(value),
        _ => tape.operation(operation),
    };
    Symbol { recording: tape.recording, id }
}

/// Records an operation on one number.
fn unary(a: Symbol, operation: impl Fn(Id) -> Operation, constant: impl Fn(f64) -> f64) -> Symbol {
    with_tape(|tape| {
        let a = tape.usable(a.recording, a.id);
        let known = tape.constant(a).map(constant);
        made(tape, operation(a), known)
    })
}

/// Records an operation on two numbers.
fn binary(a: Symbol, b: Symbol, operation: impl Fn(Id, Id) -> Operation, constant: impl Fn(f64, f64) -> f64) -> Symbol {
    with_tape(|tape| {
        let (a, b) = (tape.usable(a.recording, a.id), tape.usable(b.recording, b.id));
        let known = tape.constant(a).zip(tape.constant(b)).map(|(a, b)| constant(a, b));
        made(tape, operation(a, b), known)
    })
}

macro_rules! operators {
    ($($operator:ident $function:ident),*) => {$(
        impl $operator for Symbol {
            type Output = Symbol;
            fn $function(self, other: Symbol) -> Symbol {
                binary(self, other, Operation::$operator, $operator::$function)
            }
        }
    )*};
}
operators!(Add add, Sub sub, Mul mul, Div div);

impl Neg for Symbol {
    type Output = Symbol;
    fn neg(self) -> Symbol {
        unary(self, Operation::Neg, Neg::neg)
    }
}

impl Real for Symbol {
    type Mask = SymbolMask;

    fn lit(value: f64) -> Symbol {
        with_tape(|tape| Symbol { id: tape.literal(value), recording: tape.recording })
    }
    fn sqrt(self) -> Symbol {
        unary(self, Operation::Sqrt, f64::sqrt)
    }
    fn abs(self) -> Symbol {
        unary(self, Operation::Abs, f64::abs)
    }
    fn gt(self, other: Symbol) -> SymbolMask {
        with_tape(|tape| {
            let (a, b) = (tape.usable(self.recording, self.id), tape.usable(other.recording, other.id));
            let id = match tape.constant(a).zip(tape.constant(b)) {
                Some((a, b)) => tape.truth(a > b),
                None => tape.operation(Operation::Greater(a, b)),
            };
            SymbolMask { recording: tape.recording, id }
        })
    }
    fn select(mask: SymbolMask, if_true: Symbol, if_false: Symbol) -> Symbol {
        with_tape(|tape| {
            let mask = tape.usable(mask.recording, mask.id);
            let (a, b) = (tape.usable(if_true.recording, if_true.id), tape.usable(if_false.recording, if_false.id));
            let id = match tape.kind(mask) {
                Kind::Truth(true) => a,
                Kind::Truth(false) => b,
                _ if a == b => a,
                _ => tape.operation(Operation::Select(mask, a, b)),
            };
            Symbol { recording: tape.recording, id }
        })
    }
    /// An `if`: what `then` replaces becomes a variable that the branch assigns.
    fn when<T: Pack<Symbol>>(mask: SymbolMask, value: T, then: impl Branch<T>) -> T {
        let (condition, kind) = with_tape(|tape| {
            let id = tape.usable(mask.recording, mask.id);
            (id, tape.kind(id).clone())
        });
        match kind {
            Kind::Truth(true) => return then.taken(value),
            Kind::Truth(false) => return value,
            _ => with_tape(Tape::open_branch),
        }
        let mut variables = Vec::new();
        let merged = then.taken(value).zip(value, &mut |replaced, kept| {
            with_tape(|tape| {
                let (new, old) = (tape.usable(replaced.recording, replaced.id), tape.usable(kept.recording, kept.id));
                let id = if new == old { old } else { tape.variable(&mut variables, old, new) };
                Symbol { recording: tape.recording, id }
            })
        });
        with_tape(|tape| tape.close_branch(condition, &variables));
        merged
    }
    fn named(self, name: &'static str) -> Symbol {
        with_tape(|tape| {
            let id = tape.usable(self.recording, self.id);
            tape.name(id, name);
        });
        self
    }
}

#[cfg(test)]
mod tests;
