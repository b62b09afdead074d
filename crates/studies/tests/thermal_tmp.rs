//! Temporary.
use tdem_studies::verify::{Backend, Tier, catalogue, run, table};
#[test]
fn tmp() {
    let name = std::env::var("CASE").unwrap_or_else(|_| "thermal/".into());
    let full = std::env::var("FULL").is_ok();
    let backends: Vec<Backend> = if std::env::var("ALL").is_ok() { Backend::all() } else { vec![Backend::CpuLanes] };
    let mut hashes: Vec<Vec<_>> = Vec::new();
    for b in backends {
        let out: Vec<_> = catalogue().iter().filter(|c| c.name.starts_with(&name) && (full || c.tier == Tier::Quick)).map(|c| run(c, b)).collect();
        println!("{}", table(&out));
        hashes.push(out.iter().map(|o| o.hash).collect());
        for o in &out { println!("{} {:.3} s", o.case.name, o.seconds); }
    }
    println!("{:?}", hashes.iter().map(|h| *h == hashes[0]).collect::<Vec<_>>());
}
