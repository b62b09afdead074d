//! What was done to the symbols of one recording.

use std::collections::HashMap;

/// Index into [`Tape::values`].
pub(super) type Id = usize;

/// What a value is, apart from its name.
#[derive(Clone, Debug)]
pub(super) enum Kind {
    Literal(f64),
    /// A comparison of literals. It never reaches the text: what depends on it is decided while recording.
    Truth(bool),
    /// Read from this expression.
    Input(String),
    /// Computed, a number.
    Number,
    /// Computed, the outcome of a comparison.
    Mask,
}

#[derive(Debug)]
pub(super) struct Value {
    pub(super) kind: Kind,
    /// Wanted by [`crate::Real::named`].
    pub(super) name: Option<&'static str>,
    /// The branch that made it; `None` is good everywhere.
    scope: Option<usize>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Operation {
    Add(Id, Id),
    Sub(Id, Id),
    Mul(Id, Id),
    Div(Id, Id),
    Neg(Id),
    Sqrt(Id),
    Abs(Id),
    Greater(Id, Id),
    Select(Id, Id, Id),
}

#[derive(Debug)]
pub(super) enum Statement {
    /// A new constant.
    Let(Id, Operation),
    /// A new variable that starts as another value.
    Variable(Id, Id),
    /// A variable of an enclosing block takes another value.
    Assign(Id, Id),
    If(Id, Vec<Statement>),
}

/// A variable that the branch being recorded assigns.
pub(super) struct Variable {
    id: Id,
    start: Id,
    replacement: Id,
}

/// A block under construction and the expressions it holds.
#[derive(Debug)]
struct Scope {
    number: usize,
    statements: Vec<Statement>,
    seen: HashMap<Operation, Id>,
}

impl Scope {
    fn new(number: usize) -> Self {
        Scope { number, statements: Vec::new(), seen: HashMap::new() }
    }
}

#[derive(Debug)]
pub(super) struct Tape {
    pub(super) recording: u64,
    values: Vec<Value>,
    literals: HashMap<u64, Id>,
    inputs: Vec<Id>,
    outputs: Vec<(String, Id)>,
    /// Innermost last; the first is the function.
    scopes: Vec<Scope>,
    scopes_opened: usize,
}

/// A finished recording.
#[derive(Debug)]
pub(super) struct Recorded {
    pub(super) values: Vec<Value>,
    pub(super) inputs: Vec<Id>,
    pub(super) statements: Vec<Statement>,
    pub(super) outputs: Vec<(String, Id)>,
}

impl Tape {
    pub(super) fn new(recording: u64) -> Self {
        Tape {
            recording,
            values: Vec::new(),
            literals: HashMap::new(),
            inputs: Vec::new(),
            outputs: Vec::new(),
            scopes: vec![Scope::new(0)],
            scopes_opened: 1,
        }
    }

    /// Takes everything out.
    pub(super) fn finish(&mut self) -> Recorded {
        let mut tape = std::mem::replace(self, Tape::new(self.recording));
        Recorded {
            values: tape.values,
            inputs: tape.inputs,
            statements: tape.scopes.swap_remove(0).statements,
            outputs: tape.outputs,
        }
    }

    pub(super) fn check(&self, recording: u64) {
        assert!(recording == self.recording, "a symbol or recorder of another recording is used");
    }

    /// The id of a symbol's value, if it may be used here.
    pub(super) fn usable(&self, recording: u64, id: Id) -> Id {
        self.check(recording);
        if let Some(home) = self.values[id].scope {
            let inside = self.scopes.iter().any(|scope| scope.number == home);
            assert!(inside, "a value made inside Real::when is used outside of it: return it from the closure instead");
        }
        id
    }

    pub(super) fn kind(&self, id: Id) -> &Kind {
        &self.values[id].kind
    }

    pub(super) fn constant(&self, id: Id) -> Option<f64> {
        if let Kind::Literal(value) = self.values[id].kind { Some(value) } else { None }
    }

    fn value(&mut self, kind: Kind, scope: Option<usize>) -> Id {
        self.values.push(Value { kind, name: None, scope });
        self.values.len() - 1
    }

    fn scope(&mut self) -> &mut Scope {
        self.scopes.last_mut().expect("the function's own scope is never closed")
    }

    /// Literals are told apart by their bits, so that 0.0 and -0.0 stay two.
    pub(super) fn literal(&mut self, value: f64) -> Id {
        if let Some(&id) = self.literals.get(&value.to_bits()) {
            return id;
        }
        let id = self.value(Kind::Literal(value), None);
        self.literals.insert(value.to_bits(), id);
        id
    }

    pub(super) fn truth(&mut self, holds: bool) -> Id {
        self.value(Kind::Truth(holds), None)
    }

    pub(super) fn input(&mut self, expression: &str) -> Id {
        let known = |&&id: &&Id| matches!(&self.values[id].kind, Kind::Input(other) if other == expression);
        if let Some(&id) = self.inputs.iter().find(known) {
            return id;
        }
        let id = self.value(Kind::Input(expression.to_owned()), None);
        self.inputs.push(id);
        id
    }

    pub(super) fn output(&mut self, lvalue: &str, id: Id) {
        assert!(self.scopes.len() == 1, "output {lvalue} is set inside Real::when: set it after the branch");
        assert!(self.outputs.iter().all(|(other, _)| other != lvalue), "output {lvalue} is set twice");
        self.outputs.push((lvalue.to_owned(), id));
    }

    /// The value of an operation, recorded unless this block or one around it has it.
    pub(super) fn operation(&mut self, operation: Operation) -> Id {
        if let Some(&id) = self.scopes.iter().find_map(|scope| scope.seen.get(&operation)) {
            return id;
        }
        let kind = if matches!(operation, Operation::Greater(..)) { Kind::Mask } else { Kind::Number };
        let home = self.scope().number;
        let id = self.value(kind, Some(home));
        let scope = self.scope();
        scope.statements.push(Statement::Let(id, operation));
        scope.seen.insert(operation, id);
        id
    }

    pub(super) fn name(&mut self, id: Id, name: &'static str) {
        let letters = name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_');
        let valid = letters && !name.is_empty() && !name.as_bytes()[0].is_ascii_digit();
        assert!(valid, "{name:?} is no identifier of C");
        // Constants and inputs speak for themselves; a shared value keeps its first name.
        if matches!(self.values[id].kind, Kind::Number) {
            self.values[id].name.get_or_insert(name);
        }
    }

    pub(super) fn open_branch(&mut self) {
        self.scopes.push(Scope::new(self.scopes_opened));
        self.scopes_opened += 1;
    }

    /// A variable of the enclosing block that starts as `start` and becomes `replacement` in the present branch.
    pub(super) fn variable(&mut self, variables: &mut Vec<Variable>, start: Id, replacement: Id) -> Id {
        let home = self.scopes[self.scopes.len() - 2].number;
        let id = self.value(Kind::Number, Some(home));
        variables.push(Variable { id, start, replacement });
        id
    }

    pub(super) fn close_branch(&mut self, condition: Id, variables: &[Variable]) {
        let mut branch = self.scopes.pop().expect("a branch is open");
        branch.statements.extend(variables.iter().map(|v| Statement::Assign(v.id, v.replacement)));
        let outer = self.scope();
        outer.statements.extend(variables.iter().map(|v| Statement::Variable(v.id, v.start)));
        outer.statements.push(Statement::If(condition, branch.statements));
    }
}
