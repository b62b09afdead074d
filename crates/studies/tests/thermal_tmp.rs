//! Temporary.
use tdem_studies::verify::{Backend, Tier, catalogue, markdown, run, table};
#[test]
fn tmp() {
    let name = std::env::var("CASE").unwrap_or_else(|_| "thermal/".into());
    let full = std::env::var("FULL").is_ok();
    let out: Vec<_> = catalogue()
        .iter()
        .filter(|c| c.name.starts_with(&name) && (full || c.tier == Tier::Quick))
        .map(|c| run(c, if std::env::var("SCALAR").is_ok() { Backend::CpuScalar } else { Backend::CpuLanes }))
        .collect();
    println!("{}", table(&out));
    println!("{}", markdown(&out));
    for o in &out {
        println!("{} {:.3} s", o.case.name, o.seconds);
    }
}
