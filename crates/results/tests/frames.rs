//! Frames that are damaged or gone: they are noticed and named, nothing is done by what they say, and the run goes on.

#![allow(clippy::unwrap_used, reason = "helpers of tests may panic like tests")]

mod common;

use common::{copy, run_new, run_on};
use rust_hdf5::H5File;
use std::fs;
use std::path::{Path, PathBuf};
use tdem_results::{Error, FrameDamage, ListDamage, RunDirectory, info, pack};

/// The same numbers in every run of the test.
struct Random(u64);

impl Random {
    fn below(&mut self, end: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % end as u64) as usize
    }
}

fn frame(run: &Path, number: usize) -> PathBuf {
    run.join(format!("frames/{number:06}.vtkhdf"))
}

/// Times of a master.
fn times(path: &Path) -> Vec<f64> {
    H5File::open(path).unwrap().dataset("VTKHDF/Steps/Values").unwrap().read_raw().unwrap()
}

fn left_out(path: &Path) -> Option<String> {
    H5File::open(path).unwrap().attr_string("left_out").ok()
}

/// Damages a file in one of the ways in which files come to harm.
fn damage(path: &Path, other: &Path, random: &mut Random) -> String {
    let mut bytes = fs::read(path).unwrap();
    let place = random.below(bytes.len());
    match random.below(8) {
        0 => {
            fs::remove_file(path).unwrap();
            return "deleted".to_owned();
        }
        1 => bytes.truncate(place),
        2 => bytes.extend([0; 3]),
        3 => bytes[place..].fill(0),
        4 => bytes = fs::read(other).unwrap(),
        _ => {
            let bit = random.below(8);
            bytes[place] ^= 1 << bit;
        }
    }
    let changed = bytes != fs::read(path).unwrap();
    fs::write(path, bytes).unwrap();
    if changed { format!("changed from byte {place} on") } else { String::new() }
}

#[test]
fn every_damage_of_a_frame_is_noticed_and_named() {
    let folder = tempfile::tempdir().unwrap();
    let (whole, run) = (folder.path().join("whole"), folder.path().join("run"));
    run_new(&whole, 400);
    assert!(info(&whole).unwrap().unreadable_frames.is_empty());
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let mut trials = 0;
    while trials < 100 {
        copy(&whole, &run);
        let number = random.below(9);
        let how = damage(&frame(&run, number), &frame(&run, (number + 1) % 9), &mut random);
        if how.is_empty() {
            continue;
        }
        trials += 1;
        let told = info(&run).unwrap();
        assert_eq!((told.frames.len(), told.unreadable_frames.len()), (8, 1), "frame {number} was {how}");
        let named = told.unreadable_frames[0].to_string();
        assert!(named.ends_with(&frame(&run, number).display().to_string()), "{named}");
        assert!(named.contains(&format!("the frame of step {}", 50 * number)), "{named}");
        if trials % 10 > 0 {
            continue;
        }
        let packed = pack(&run, &run.join("packed"), 0).unwrap();
        assert_eq!((packed.files.len(), packed.damaged.len()), (3, 1), "frame {number} was {how}");
        let file = run.join("packed/particles.vtkhdf");
        let expected: Vec<f64> = (0..9).filter(|&k| k != number).map(|k| 50.0 * k as f64 * 1e-4).collect();
        assert_eq!(times(&file), expected);
        assert!(left_out(&file).unwrap().starts_with(&format!("frames/{number:06}.vtkhdf")));

        let resumed = RunDirectory::open(&run).unwrap();
        assert_eq!(resumed.unreadable_frames.len(), 1, "frame {number} was {how}");
        drop(resumed);
        assert_eq!(times(&run.join("particles.vtkhdf")), expected);
        run_on(&run, 450);
        let (file, told) = (run.join("particles.vtkhdf"), info(&run).unwrap());
        // The frame of the checkpoint's step can be written again.
        let (shown, lost) = if number == 8 { (10, 0) } else { (9, 1) };
        assert_eq!(
            (times(&file).len(), told.frames.len(), told.unreadable_frames.len()),
            (shown, shown, lost),
            "{how}"
        );
        let told = left_out(&file).unwrap_or_default();
        assert_eq!(told.starts_with(&format!("frames/{number:06}.vtkhdf")), lost == 1, "{told}");
        assert!(fs::read_to_string(run.join("log.txt")).unwrap().contains("the frame of step"));
    }
}

#[test]
fn a_frame_that_comes_back_is_shown_again() {
    let (straight, folder) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    run_new(straight.path(), 400);
    run_new(folder.path(), 300);
    let path = frame(folder.path(), 2);
    let bytes = fs::read(&path).unwrap();
    fs::remove_file(&path).unwrap();
    run_on(folder.path(), 350);
    let told = info(folder.path()).unwrap().unreadable_frames;
    assert!(matches!(&told[..], [Error::Frame { damage: FrameDamage::Gone { step: 100 }, .. }]), "{told:?}");
    fs::write(&path, bytes).unwrap();
    run_on(folder.path(), 400);
    common::assert_same_results(straight.path(), folder.path());
}

#[test]
fn a_last_frame_that_was_lost_is_written_again() {
    let (straight, folder) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    // The second ends off the schedule: its last frame is there for the end alone.
    for end in [400, 377] {
        let (straight, folder) = (straight.path().join(end.to_string()), folder.path().join(end.to_string()));
        run_new(&straight, 450);
        run_new(&folder, end);
        fs::write(frame(&folder, 8), "rubbish").unwrap();
        assert_eq!(info(&folder).unwrap().unreadable_frames.len(), 1);
        run_on(&folder, 450);
        assert!(info(&folder).unwrap().unreadable_frames.is_empty());
        common::assert_same_results(&straight, &folder);
    }
}

#[test]
fn a_list_that_is_damaged_or_gone_costs_no_frame() {
    let folder = tempfile::tempdir().unwrap();
    let (whole, run) = (folder.path().join("whole"), folder.path().join("run"));
    run_new(&whole, 400);
    let list = fs::read_to_string(whole.join("frames.csv")).unwrap();
    let third = list.lines().nth(3).unwrap();
    let cut: String = list.split_inclusive('\n').take(4).collect();
    let damages: [(Option<String>, ListDamage); 3] = [
        (None, ListDamage::Gone),
        (Some(list.replace(third, &third.replace(',', ";"))), ListDamage::Line { line: 4, more: 0 }),
        (Some(cut), ListDamage::CutOff { frames: 6 }),
    ];
    for (text, expected) in damages {
        copy(&whole, &run);
        match &text {
            Some(text) => fs::write(run.join("frames.csv"), text).unwrap(),
            None => fs::remove_file(run.join("frames.csv")).unwrap(),
        }
        let told = info(&run).unwrap();
        let [Error::FrameList { damage, .. }] = &told.unreadable_frames[..] else { panic!("{told:?}") };
        assert_eq!((damage, told.frames.len()), (&expected, 9));
        assert_eq!(pack(&run, &run.join("packed"), 0).unwrap().damaged.len(), 1);
        assert_eq!(RunDirectory::open(&run).unwrap().unreadable_frames.len(), 1);
        // The list is whole again.
        assert!(info(&run).unwrap().unreadable_frames.is_empty());
        common::assert_same_results(&whole, &run);
    }
}

#[test]
fn counts_that_no_file_can_hold_are_refused_before_room_is_made() {
    let folder = tempfile::tempdir().unwrap();
    let (whole, run) = (folder.path().join("whole"), folder.path().join("run"));
    run_new(&whole, 400);
    let counts = ["NumberOfPoints", "Vertices/NumberOfCells", "Lines/NumberOfConnectivityIds"];
    for (name, count) in counts.into_iter().flat_map(|name| [1_i64 << 45, -1, i64::MAX, i64::MIN, 7].map(|n| (name, n)))
    {
        copy(&whole, &run);
        // As if it had been written so: the list does not know the frame.
        fs::remove_file(run.join("frames.csv")).unwrap();
        let path = frame(&run, 3);
        {
            let file = H5File::open_rw(&path).unwrap();
            file.dataset_writer(&format!("VTKHDF/particles/{name}")).unwrap().write_raw(&[count]).unwrap();
            file.close().unwrap();
        }
        let told = info(&run).unwrap();
        let named = told.unreadable_frames.last().unwrap().to_string();
        assert_eq!(told.frames.len(), 8, "{name} = {count}: {named}");
        assert!(named.ends_with("000003.vtkhdf") && named.contains("VTKHDF/particles/"), "{named}");
        pack(&run, &run.join("packed"), 0).unwrap();
        run_on(&run, 400);
    }
}

#[test]
fn a_frame_without_a_checksum_may_be_changed_in_any_byte_without_a_panic() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path();
    run_new(run, 50);
    fs::remove_file(run.join("frames.csv")).unwrap();
    let path = frame(run, 1);
    let whole = fs::read(&path).unwrap();
    let mut random = Random(0x1234_5678_9abc_def1);
    let mut refused = 0;
    for _ in 0..250 {
        let mut bytes = whole.clone();
        for _ in 0..=random.below(3) {
            let place = random.below(bytes.len());
            bytes[place] = random.below(256) as u8;
        }
        if random.below(10) == 0 {
            bytes.truncate(random.below(whole.len()));
        }
        fs::write(&path, bytes).unwrap();
        let told = info(run).unwrap();
        refused += usize::from(told.frames.len() == 1);
        let _ = pack(run, &run.join("packed"), 0);
    }
    assert!(refused > 10, "{refused}");
}

#[test]
fn a_finished_run_can_be_sent_and_goes_on_all_the_same() {
    let (straight, folder) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    run_new(straight.path(), 400);
    run_new(folder.path(), 300);
    let content = |run: &Path| H5File::open(run.join("particles.vtkhdf")).unwrap().attr_string("content").unwrap();
    let elsewhere = folder.path().join("elsewhere.vtkhdf");
    fs::copy(folder.path().join("particles.vtkhdf"), &elsewhere).unwrap();
    assert!(content(folder.path()).contains("needs no other"));
    let ids: Vec<i64> = H5File::open(&elsewhere).unwrap().dataset("VTKHDF/PointData/id").unwrap().read_raw().unwrap();
    assert_eq!(ids, (0..7).flat_map(|_| 0..100).collect::<Vec<i64>>());
    fs::remove_file(elsewhere).unwrap();

    // Opened again, it stays as it is; with more frames, masters are an index until the end.
    let resumed = RunDirectory::open(folder.path()).unwrap();
    assert!(content(folder.path()).contains("needs no other"));
    let mut directory = resumed.directory;
    directory.set_contents(common::contents());
    let mut simulation = common::simulation(resumed.state.unwrap());
    let plan = simulation.plan().clone();
    simulation.advance(50).unwrap();
    directory.frame(&simulation.state().unwrap(), &plan).unwrap();
    directory.publish().unwrap();
    assert!(content(folder.path()).contains("frames/ beside this file"));
    drop(directory);
    run_on(folder.path(), 400);
    common::assert_same_results(straight.path(), folder.path());
}
