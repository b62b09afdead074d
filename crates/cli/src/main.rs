//! tdem
fn main() {}
