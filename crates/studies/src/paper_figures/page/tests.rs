//! The page of measurements that were made up.

use super::super::{Count, Machine, Point, Procedures, Size};
use super::*;
use tdem_engine::Device;

fn machine(word: &str, threads: Option<usize>, copy: f64) -> Machine {
    Machine {
        device: Device::default(),
        word: word.into(),
        name: format!("{word} <of> this & that"),
        driver: format!("driver of {word}"),
        gpu: threads.is_none(),
        threads,
        memory_bytes: None,
        copy_bytes_per_second: copy,
        operations_per_second: 4.0 * copy,
    }
}

/// Twice as slow for each model, ten times as slow on the CPU, thirty times on one thread, five times as fast in best mode.
fn measured(place: usize, model: Model, mode: Mode, size: Size, particles: usize) -> Measured {
    let step = 1e-9 * particles as f64 * f64::from(1 << model as u32) * [1.0, 10.0, 30.0][place];
    let point = |name: &str, bytes: f64| Point {
        name: name.into(),
        operations: Count { always: 1e9, at_most: 1.1e9 },
        bytes,
        seconds: step,
    };
    Measured {
        model,
        size,
        mode,
        machine: place,
        particles,
        contacts: 6 * particles,
        bonds: 0,
        steps: 777,
        repeats: 3,
        searches: 0,
        seconds_per_step: if mode == Mode::Best { 0.2 * step } else { step },
        median_seconds_per_step: step,
        memory_bytes: (particles * 100) as f64 * f64::from(1 + model as u32),
        profiled_steps: 2,
        procedures: Procedures { integration: 1.0, search: 2.0, contact: 5.0, ..Procedures::default() },
        points: vec![point("predict", 1e10), point("contact", 1e9), point("step", 2e9)],
        hash: "0".into(),
    }
}

fn record(devices: usize) -> Record {
    let machines =
        [machine("cuda", None, 5.49e12), machine("4 threads", Some(4), 1e10), machine("1 thread", Some(1), 4e9)];
    let machines = machines[..devices].to_vec();
    let mut record = Record::new("0.0.7", "tdem bench --paper-figures".into(), machines, 40);
    for (size, particles) in [(Size::K88, 88_000), (Size::M3, 3_000_000)] {
        for place in 0..devices {
            for model in Model::ALL {
                for mode in Mode::ALL {
                    record.measurements.push(measured(place, model, mode, size, particles));
                }
            }
        }
    }
    record
}

#[test]
fn it_has_all_figures_and_every_published_number_and_loads_nothing() {
    let text = page(&record(2));
    for figure in 3..=7 {
        let section =
            text.split(&format!("<section id=\"figure-{figure}\">")).nth(1).expect("each figure has a section");
        let section = section.split("</section>").next().expect("it ends");
        assert!(section.contains("<svg") && section.contains("<figcaption>"), "{figure}");
        for part in ["cuda &lt;of&gt; this &amp; that", "driver of cuda", "3,000,000", "777 steps", "tdem 0.0.7"] {
            assert!(section.contains(part), "{part} is not in figure {figure}");
        }
    }
    for value in &Published::read().values {
        assert!(text.contains(&escaped(&value.printed)), "{value:?}");
        assert!(text.contains(&format!("<td>{}</td>", number(value))), "{value:?}");
    }
    for outside in ["http:", "https:", "src=", "href=", "url(", "@import", "<script", "<link"] {
        assert!(!text.contains(outside), "{outside}");
    }
    assert!(!text.contains("NaN") && !text.contains(">inf") && !text.contains(" inf"), "a number is none");
    for element in ["section", "figure", "svg", "table", "tr", "td", "th", "ul", "li", "div", "title", "text", "p"] {
        let opened = text.matches(&format!("<{element}>")).count() + text.matches(&format!("<{element} ")).count();
        assert_eq!(opened, text.matches(&format!("</{element}>")).count(), "{element}");
    }
}

#[test]
fn numbers_are_those_that_were_measured() {
    let text = page(&record(2));
    // A copy is ten times the bandwidth of the P100 here.
    assert!(text.contains("<td>GNTM</td><td>2.83e7</td><td>2.83e8</td>"), "{text}");
    // GNTM makes 1e9 / 4 particle-steps a second in paper mode, five times that in best mode.
    assert!(
        text.contains("<td>2.50e8</td><td>8.83</td><td>0.883</td><td>1.25e9</td><td>44.2</td><td>4.42</td>"),
        "{text}"
    );
    assert!(text.contains(
        "<td>TBPM</td><td>3m</td><td>best mode</td><td>4 threads</td><td>3,000,000</td><td>0</td><td>18,000,000</td>"
    ));
    // Ten times as fast as the CPU, beside the paper's range.
    assert!(text.contains("<td>10</td><td>3.0 to 7.2</td>") && text.contains("<td>10</td><td>up to 7.4</td>"));
    // TBPM costs 16 times GN; the paper's numbers stand beside it.
    assert!(
        text.contains("<td>TBPM</td><td>2.645</td><td>2.805</td><td>16</td><td>16</td><td>16</td><td>16</td>"),
        "{text}"
    );
    // Moments add twice the time of a step of GN, heat eight times; each model takes twice the time of the one before.
    assert!(
        text.contains("<td>moments</td><td>0.121</td><td>\u{2013}</td><td>2</td><td>2</td><td>2</td><td>2</td>"),
        "{text}"
    );
    assert!(text.contains("<td>6.94</td><td>8</td><td>1.6</td>"), "{text}");
    assert!(text.contains(
        "On cuda in paper mode: over a step of GN tangential forces, moments, bonds, heat cost more than in the paper; in \
         absolute time tangential forces, moments, bonds cost less than in the paper, heat more."
    ));
    // Memory of TBPM is five times that of GN, 500 B a particle.
    assert!(text.contains("<td>TBPM</td><td>5.4</td><td>5</td><td>5</td><td>500</td><td>500</td>"), "{text}");
    // An eighth of the time is integration, and a quarter search.
    assert!(text.contains("<td>GN</td><td>cuda</td><td>12.5 %</td><td>25.0 %</td>"));
}

#[test]
fn the_processor_is_compared_by_the_core() {
    let text = page(&record(3));
    // GNTM makes 1e9 / 4 / 30 on one thread, three times that on four.
    assert!(
        text.contains(
            "<td>GNTM</td><td>paper mode</td><td>3,000,000</td><td>8.33e6</td><td>2.50e7</td><td>6.25e6</td><td>75 %</td>\
             <td>1.97e5</td>"
        ),
        "{text}"
    );
    // What the paper's processor does in a mode that is not the paper's is not known, nor of models without a speed-up.
    assert!(text.contains("<td>1.25e8</td><td>3.12e7</td><td>75 %</td><td>\u{2013}</td>"), "{text}");
    assert!(text.contains("<td>1.00e8</td><td>2.50e7</td><td>75 %</td><td>\u{2013}</td>"), "{text}");
    assert!(text.contains("cuda &lt;of&gt; this &amp; that</li>") && text.contains("that, 1 thread</li>"), "{text}");
    // The paper's speed-up is over all its cores.
    assert!(text.contains("<td>4 threads</td><td>12</td><td>120</td><td>10</td><td>3.0 to 7.2</td>"), "{text}");
    assert!(text.contains("<td>1 thread</td><td>12</td><td>360</td><td>30</td><td>\u{2013}</td>"), "{text}");
    // A processor alone is compared with itself by the core, and with no GPU.
    let mut alone = record(3);
    alone.machines.remove(0);
    alone.measurements.retain(|measured| measured.machine > 0);
    alone.measurements.iter_mut().for_each(|measured| measured.machine -= 1);
    let text = page(&alone);
    assert!(
        text.contains("by the core") && text.contains("GNTM 3.0 to 7.2, BPM up to 7.4, TBPM up to 7.4, one P100"),
        "{text}"
    );
}

#[test]
fn records_are_read_again_and_those_of_no_machine_are_refused() {
    let whole = record(2);
    let read = |record: &Record| Record::read(&record.json().expect("numbers are finite"));
    assert_eq!(page(&read(&whole).expect("it was written so")), page(&whole));
    let lost = Record { machines: whole.machines[..1].to_vec(), ..whole.clone() };
    assert!(read(&lost).expect_err("one machine is gone").to_string().contains("no machine 1"));
    let none = Record { machines: Vec::new(), measurements: Vec::new(), ..whole };
    assert!(read(&none).expect_err("all machines are gone").to_string().contains("no machines"));
}

#[test]
fn what_is_missing_is_said() {
    let mut record = record(1);
    record.measurements.truncate(3);
    record.left_out.push("TBPM at size 3m needs more".into());
    let text = page(&record);
    assert!(text.contains("3 of 40 measurements are on this page"));
    assert!(text.contains("Left out: TBPM at size 3m needs more."));
    assert!(text.contains("Nothing else was measured at the same size") && !text.contains("by the core"));
    record.measurements.clear();
    assert!(page(&record).contains("0 of 40"), "a page of nothing is a page");
}
