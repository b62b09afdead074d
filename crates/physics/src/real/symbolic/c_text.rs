//! A recording as the text of a function.

use super::tape::{Id, Kind, Operation, Recorded, Statement, Value};
use super::{CFunction, Operations};
use std::collections::HashSet;
use std::fmt::Write;

/// Words that a temporary must not be called: keywords of C99, C++, OpenCL C and CUDA that read like a quantity, and
/// what the text itself relies on.
const RESERVED: &[&str] = &[
    "auto",
    "bool",
    "break",
    "case",
    "catch",
    "char",
    "class",
    "const",
    "constant",
    "continue",
    "default",
    "delete",
    "do",
    "double",
    "else",
    "enum",
    "event_t",
    "export",
    "extern",
    "fabs",
    "false",
    "float",
    "for",
    "friend",
    "global",
    "goto",
    "half",
    "if",
    "inline",
    "int",
    "kernel",
    "local",
    "long",
    "namespace",
    "new",
    "operator",
    "pipe",
    "private",
    "protected",
    "public",
    "real",
    "register",
    "restrict",
    "return",
    "short",
    "signed",
    "sizeof",
    "sqrt",
    "static",
    "struct",
    "switch",
    "template",
    "this",
    "throw",
    "true",
    "try",
    "typedef",
    "uniform",
    "union",
    "unsigned",
    "using",
    "vector",
    "virtual",
    "void",
    "volatile",
    "while",
    "DEVICE",
    "INFINITY",
    "NAN",
];

/// Words of a piece of C: identifiers, keywords and numbers.
fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').filter(|word| !word.is_empty())
}

/// The exact value as a literal of C; readers of decimal text restore its bits.
fn literal(value: f64) -> String {
    let size = match value.abs() {
        size if size.is_nan() => return "NAN".to_owned(),
        f64::INFINITY => "INFINITY".to_owned(),
        size => format!("{size:?}"),
    };
    if value.is_sign_negative() { format!("(-{size})") } else { size }
}

pub(super) fn function(head: &str, recorded: Recorded) -> CFunction {
    let Recorded { values, inputs, statements, outputs } = recorded;
    let mut used = vec![false; values.len()];
    for &(_, id) in &outputs {
        used[id] = true;
    }
    let statements = only_used(statements, &mut used);

    let mut printer = Printer {
        names: vec![None; values.len()],
        values: &values,
        taken: RESERVED.iter().copied().chain(words(head)).map(str::to_owned).collect(),
        temporaries: 0,
        text: format!("{head}\n{{\n"),
        always: Operations::default(),
        in_branches: Operations::default(),
    };
    for &id in &inputs {
        if let Kind::Input(expression) = &values[id].kind {
            printer.taken.extend(words(expression).map(str::to_owned));
        }
    }
    for id in inputs.into_iter().filter(|&id| used[id]) {
        printer.load(id, &outputs);
    }
    printer.block(&statements, 1);
    for (lvalue, id) in &outputs {
        let line = format!("{lvalue} = {};", printer.name(*id));
        printer.line(1, &line);
    }
    printer.text.push_str("}\n");
    CFunction { text: printer.text, always: printer.always, in_branches: printer.in_branches }
}

/// The statements that the marked values depend on; marks what those use in turn.
fn only_used(statements: Vec<Statement>, used: &mut [bool]) -> Vec<Statement> {
    let mut kept = Vec::new();
    for statement in statements.into_iter().rev() {
        match statement {
            Statement::Let(id, operation) if used[id] => {
                for operand in operands(operation).into_iter().flatten() {
                    used[operand] = true;
                }
                kept.push(statement);
            }
            Statement::Variable(id, from) | Statement::Assign(id, from) if used[id] => {
                used[from] = true;
                kept.push(statement);
            }
            Statement::If(mask, then) => {
                let then = only_used(then, used);
                if !then.is_empty() {
                    used[mask] = true;
                    kept.push(Statement::If(mask, then));
                }
            }
            _ => {}
        }
    }
    kept.reverse();
    kept
}

fn operands(operation: Operation) -> [Option<Id>; 3] {
    use Operation::{Abs, Add, Div, Greater, Mul, Neg, Select, Sqrt, Sub};
    match operation {
        Add(a, b) | Sub(a, b) | Mul(a, b) | Div(a, b) | Greater(a, b) => [Some(a), Some(b), None],
        Neg(a) | Sqrt(a) | Abs(a) => [Some(a), None, None],
        Select(mask, a, b) => [Some(mask), Some(a), Some(b)],
    }
}

struct Printer<'a> {
    values: &'a [Value],
    /// How the text calls a value that it has made.
    names: Vec<Option<String>>,
    taken: HashSet<String>,
    temporaries: usize,
    text: String,
    always: Operations,
    in_branches: Operations,
}

impl Printer<'_> {
    fn line(&mut self, depth: usize, line: &str) {
        writeln!(self.text, "{:1$}{line}", "", 4 * depth).expect("writing to a string cannot fail");
    }

    /// The name itself, or the first of `name_2`, `name_3`, ... that is free.
    fn unique(&mut self, name: &str) -> String {
        let mut unique = name.to_owned();
        let mut count = 1;
        while !self.taken.insert(unique.clone()) {
            count += 1;
            unique = format!("{name}_{count}");
        }
        unique
    }

    /// How the text refers to a value.
    fn name(&self, id: Id) -> String {
        match self.values[id].kind {
            Kind::Literal(value) => literal(value),
            _ => self.names[id].clone().expect("a value is made before it is used"),
        }
    }

    /// The name of a value that the next line makes.
    fn new_name(&mut self, id: Id) -> String {
        let name = if let Some(wanted) = self.values[id].name {
            self.unique(wanted)
        } else {
            loop {
                self.temporaries += 1;
                let name = format!("t{}", self.temporaries);
                if self.taken.insert(name.clone()) {
                    break name;
                }
            }
        };
        self.names[id] = Some(name.clone());
        name
    }

    /// Reads an input into a constant, so that no output can change it; a parameter by value is one already.
    fn load(&mut self, id: Id, outputs: &[(String, Id)]) {
        let Kind::Input(expression) = &self.values[id].kind else { return };
        let parts: Vec<&str> = words(expression).collect();
        if parts[..] == [expression.as_str()] {
            let assigned = outputs.iter().any(|(lvalue, _)| lvalue == expression);
            assert!(!assigned, "output {expression} is a parameter by value");
            self.names[id] = Some(expression.clone());
        } else {
            let name = self.unique(&parts.join("_"));
            self.line(1, &format!("const real {name} = {expression};"));
            self.names[id] = Some(name);
        }
    }

    fn block(&mut self, statements: &[Statement], depth: usize) {
        for statement in statements {
            match statement {
                &Statement::Let(id, operation) => {
                    let formula = self.formula(operation, depth > 1);
                    let kind = if matches!(self.values[id].kind, Kind::Mask) { "int" } else { "real" };
                    let name = self.new_name(id);
                    self.line(depth, &format!("const {kind} {name} = {formula};"));
                }
                &Statement::Variable(id, from) => {
                    let start = self.name(from);
                    let name = self.new_name(id);
                    self.line(depth, &format!("real {name} = {start};"));
                }
                &Statement::Assign(id, from) => {
                    let line = format!("{} = {};", self.name(id), self.name(from));
                    self.line(depth, &line);
                }
                Statement::If(mask, then) => {
                    let line = format!("if ({}) {{", self.name(*mask));
                    self.line(depth, &line);
                    self.block(then, depth + 1);
                    self.line(depth, "}");
                }
            }
        }
    }

    /// The right-hand side of an operation, which is counted.
    fn formula(&mut self, operation: Operation, in_branch: bool) -> String {
        let [a, b, c] = operands(operation).map(|id| id.map(|id| self.name(id)).unwrap_or_default());
        let count = if in_branch { &mut self.in_branches } else { &mut self.always };
        let (counter, formula) = match operation {
            Operation::Add(..) => (&mut count.additions, format!("{a} + {b}")),
            Operation::Sub(..) => (&mut count.additions, format!("{a} - {b}")),
            Operation::Mul(..) => (&mut count.multiplications, format!("{a} * {b}")),
            Operation::Div(..) => (&mut count.divisions, format!("{a} / {b}")),
            Operation::Neg(..) => (&mut count.sign_changes, format!("-{a}")),
            Operation::Sqrt(..) => (&mut count.square_roots, format!("sqrt({a})")),
            Operation::Abs(..) => (&mut count.sign_changes, format!("fabs({a})")),
            Operation::Greater(..) => (&mut count.comparisons, format!("{a} > {b}")),
            Operation::Select(..) => (&mut count.selections, format!("{a} ? {b} : {c}")),
        };
        *counter += 1;
        formula
    }
}
