//! The runtimes, on the OpenCL of this machine; without one, these tests fail.
#![allow(unsafe_code, reason = "where a driver keeps its compiled kernels is told by the environment")]

use super::cuda::Cuda;
use super::devices::{Api, open_opencl, survey};
use super::kernel_cache::KernelCache;
use super::network::{SUM_WORDS, copies_of_sums};
use super::opencl::OpenCl;
use super::runtime::{Argument, Error, Fetch, Runtime, Span};
use super::self_test::{SOURCE, agrees, check_contraction};
use crate::ExactSum;
use crate::exact::tests::{Random, assert_rounded_once, hard_sums};
use std::env;
use std::sync::Once;
use std::time::Instant;

/// Runs tests on OpenCL, and on CUDA when the ignored ones are asked for.
macro_rules! on_each_runtime {
    ($($test:ident)*) => {
        mod opencl {
            $(#[test] fn $test() { super::$test(&super::opencl_runtime()); })*
        }
        mod cuda {
            $(#[test] #[ignore = "needs a device of CUDA"] fn $test() { super::$test(&super::cuda_runtime()); })*
        }
    };
}
on_each_runtime! {
    a_kernel_reads_what_was_uploaded_and_the_host_what_it_wrote
    fetches_overlap_and_their_memory_is_used_again
    a_fetch_may_outlive_its_memory
    nothing_is_a_size_too
    atomics_and_local_memory_count_every_item
    bits_of_reals_are_those_of_the_host
    refusals_say_what_is_wrong
    a_device_that_fuses_is_found_out
    hard_sums_are_rational_sums_rounded_once_in_any_order
    sums_of_many_groups_and_copies_have_the_bits_of_the_host
    what_is_no_number_gives_what_it_gives_on_the_host
}

fn opencl_runtime() -> OpenCl {
    separate_caches();
    OpenCl::open(0).expect("an OpenCL device (PoCL will do)")
}

fn cuda_runtime() -> Cuda {
    separate_caches();
    Cuda::open(0).expect("a device of CUDA")
}

/// Test processes that run at the same time must not share PoCL's cache: each slot of nextest has its own.
fn separate_caches() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let slot = env::var("NEXTEST_TEST_GLOBAL_SLOT").unwrap_or_else(|_| "alone".to_owned());
        let program = env::current_exe().unwrap();
        let folder = program.parent().unwrap().join("kernel-cache").join(slot);
        // SAFETY: all tests of this program that read the environment wait for this first.
        unsafe {
            env::set_var("POCL_CACHE_DIR", folder.join("pocl"));
            env::set_var("TDEM_CACHE_DIR", folder);
        }
    });
}

const KERNELS: &str = "
typedef struct { real factor; u32 count; u32 offset; } Scaling;
KERNEL(64, 1) scale(GLOBAL const Quad *RESTRICT from, GLOBAL Quad *RESTRICT to, const Scaling by) {
    FOR_EACH(i, by.count) {
        const Quad q = LOAD(from, i);
        if (q.x < 0.0) continue;
        to[i] = QUAD(q.x * by.factor, q.y * by.factor, q.z * by.factor, q.w + (real)by.offset);
    }
}
KERNEL(64, 1) count(GLOBAL u32 *RESTRICT into, const u32 n) {
    LOCAL u32 of_group[64];
    of_group[LOCAL_INDEX] = 0;
    FOR_EACH(i, n) {
        of_group[LOCAL_INDEX] = 1;
        ATOMIC_OR(&into[1], 1u << (i % 32));
        ATOMIC_MAX(&into[2], i);
        into[4 + ATOMIC_ADD(&into[3], 1)] = GROUP_INDEX;
    }
    BARRIER;
    if (LOCAL_INDEX == 0) {
        u32 sum = 0;
        for (u32 k = 0; k < 64; ++k) sum += of_group[k];
        ATOMIC_ADD(&into[0], sum);
    }
}
KERNEL(64, 1) bits(GLOBAL u64 *RESTRICT to, const real x) {
    FOR_EACH(i, 4u) {
        to[i] = BITS_OF(i == 0 ? x : i == 1 ? INFINITY : i == 2 ? fabs(-x) : sqrt(x));
    }
    if (GROUP_COUNT != 1) to[0] = 0;
}
";

/// A sum for each group, and two of all groups together, behind `exact.cl`.
const SUMS: &str = "
KERNEL(256, 4) add_each(GLOBAL const real *RESTRICT from, GLOBAL const u32 *RESTRICT start, GLOBAL u32 *RESTRICT words) {
    ROOM_FOR_TERMS(1u);
    const u32 begin = start[GROUP_INDEX], count = start[GROUP_INDEX + 1u] - begin;
    for (u32 k = LOCAL_INDEX; k < count; k += GROUP) terms[k] = from[begin + k];
    ADD_TERMS(1u, count, 1u, words + GROUP_INDEX * WORDS)
}
KERNEL(256, 4) take_each(GLOBAL u32 *RESTRICT words, GLOBAL real *RESTRICT to) {
    TAKE_SUMS(1u, 1u, words + GROUP_INDEX * WORDS);
    if (LOCAL_INDEX == 0u) to[GROUP_INDEX] = totals[0];
}
KERNEL(256, 4) add_all(GLOBAL const real *RESTRICT from, GLOBAL u32 *RESTRICT words, const u32 n, const u32 copies) {
    ROOM_FOR_TERMS(2u);
    const u32 begin = GROUP_INDEX * CHUNK, count = n - begin < CHUNK ? n - begin : CHUNK;
    for (u32 k = LOCAL_INDEX; k < count; k += GROUP) {
        terms[k] = from[begin + k];
        terms[CHUNK + k] = -0.75 * from[begin + k];
    }
    ADD_TERMS(2u, count, copies, words)
}
KERNEL(256, 1) take_all(GLOBAL u32 *RESTRICT words, GLOBAL real *RESTRICT to, const u32 copies) {
    TAKE_SUMS(2u, copies, words);
    if (LOCAL_INDEX < 2u) to[LOCAL_INDEX] = totals[LOCAL_INDEX];
}
";

fn sums_source() -> String {
    [include_str!("kernels/exact.cl"), SUMS].concat()
}

/// Sums of some lists of at most 1024 terms, each by a group of the device.
fn sums_of_groups(runtime: &impl Runtime, lists: &[Vec<f64>]) -> Vec<f64> {
    let kernels = runtime.build(&sums_source(), &["add_each", "take_each"]).unwrap();
    let terms = lists.concat();
    let starts = lists.iter().scan(0, |end, list| {
        *end += list.len() as u32;
        Some(*end)
    });
    let starts: Vec<u32> = std::iter::once(0).chain(starts).collect();
    let size = size_of_val(&terms[..]);
    let (from, start) = (runtime.allocate(size).unwrap(), runtime.allocate(size_of_val(&starts[..])).unwrap());
    let bytes = 4 * SUM_WORDS * lists.len();
    let (words, to) = (runtime.allocate(bytes).unwrap(), runtime.allocate(8 * lists.len()).unwrap());
    runtime.upload(&from, bytemuck::cast_slice(&terms)).unwrap();
    runtime.upload(&start, bytemuck::cast_slice(&starts)).unwrap();
    runtime.clear(&words, bytes).unwrap();
    let arguments = [&from, &start, &words].map(Argument::Memory);
    runtime.launch(&kernels[0], lists.len(), 256, &arguments).unwrap();
    runtime.launch(&kernels[1], lists.len(), 256, &[&words, &to].map(Argument::Memory)).unwrap();
    let mut fetch = runtime.fetch(&words, bytes).unwrap();
    assert!(fetch.wait().unwrap().iter().all(|&byte| byte == 0), "words are zeros again");
    let mut fetch = runtime.fetch(&to, 8 * lists.len()).unwrap();
    bytemuck::cast_slice(fetch.wait().unwrap()).to_vec()
}

fn hard_sums_are_rational_sums_rounded_once_in_any_order(runtime: &impl Runtime) {
    let mut random = Random::new(4);
    let mut lists = hard_sums(20_000);
    for terms in &mut lists {
        terms.truncate(1024);
    }
    let first = sums_of_groups(runtime, &lists);
    for (k, (&value, terms)) in first.iter().zip(&lists).enumerate() {
        assert_rounded_once(value, terms, &format!("sum {k}"));
    }
    for terms in &mut lists {
        random.shuffle(terms);
    }
    let second = sums_of_groups(runtime, &lists);
    assert!(first.iter().zip(&second).all(|(first, second)| first.to_bits() == second.to_bits()));
}

fn what_is_no_number_gives_what_it_gives_on_the_host(runtime: &impl Runtime) {
    let (positive, negative) = (f64::INFINITY, f64::NEG_INFINITY);
    let half = f64::from_bits((2046 - 53) << 52);
    let lists = vec![
        vec![],
        vec![-0.0; 300],
        vec![1.0, positive, -f64::MAX, positive],
        vec![negative; 600],
        vec![negative, 1.0, positive],
        [vec![1.0; 700], vec![f64::NAN]].concat(),
        vec![positive, -f64::NAN],
        vec![-f64::MAX; 1024],
        vec![f64::MAX, half],
        vec![f64::MAX, half, -5e-324],
    ];
    let found = sums_of_groups(runtime, &lists);
    for (terms, found) in lists.iter().zip(found) {
        let expected = ExactSum::of(terms.iter().copied()).value();
        let same = found.to_bits() == expected.to_bits() || found.is_nan() && expected.is_nan();
        assert!(same, "{found:e}, not {expected:e}");
    }
}

fn sums_of_many_groups_and_copies_have_the_bits_of_the_host(runtime: &impl Runtime) {
    let kernels = runtime.build(&sums_source(), &["add_all", "take_all"]).unwrap();
    let mut random = Random::new(5);
    let mut terms = hard_sums(800).concat();
    let expected = [1.0, -0.75].map(|factor| ExactSum::of(terms.iter().map(|term| factor * term)).value());
    let n = terms.len() as u32;
    let (from, to) = (runtime.allocate(8 * terms.len()).unwrap(), runtime.allocate(16).unwrap());
    for copies in [1, 3, copies_of_sums(terms.len()) as u32] {
        let bytes = 2 * copies as usize * 4 * SUM_WORDS;
        let words = runtime.allocate(bytes).unwrap();
        runtime.clear(&words, bytes).unwrap();
        let copies = copies.to_ne_bytes();
        for _ in 0..2 {
            random.shuffle(&mut terms);
            runtime.upload(&from, bytemuck::cast_slice(&terms)).unwrap();
            let (of, into) = (Argument::Memory(&from), Argument::Memory(&words));
            let (count, shared) = (n.to_ne_bytes(), Argument::Value(&copies));
            let groups = terms.len().div_ceil(1024);
            runtime.launch(&kernels[0], groups, 256, &[of, into, Argument::Value(&count), shared]).unwrap();
            let arguments = [Argument::Memory(&words), Argument::Memory(&to), Argument::Value(&copies)];
            runtime.launch(&kernels[1], 1, 256, &arguments).unwrap();
            let mut fetch = runtime.fetch(&to, 16).unwrap();
            let found: &[f64] = bytemuck::cast_slice(fetch.wait().unwrap());
            assert_eq!(found, expected, "{copies:?} copies");
        }
    }
}

fn quads(count: usize) -> Vec<[f64; 4]> {
    (0..count).map(|i| [if i % 5 == 4 { -1.0 } else { i as f64 }, 0.1, i as f64 / 3.0, 1.0]).collect()
}

/// `f64`, then two `u32`, as C lays them out.
fn scaling(factor: f64, count: u32, offset: u32) -> Vec<u8> {
    [&factor.to_ne_bytes()[..], &count.to_ne_bytes(), &offset.to_ne_bytes()].concat()
}

fn a_kernel_reads_what_was_uploaded_and_the_host_what_it_wrote(runtime: &impl Runtime) {
    let kernels = runtime.build(KERNELS, &["scale", "count"]).unwrap();
    let input = quads(1000);
    let size = size_of_val(&input[..]);
    let (staging, from) = (runtime.allocate(size).unwrap(), runtime.allocate(size).unwrap());
    let to = runtime.allocate(size + 1).unwrap();
    runtime.upload(&staging, bytemuck::cast_slice(&input)).unwrap();
    runtime.copy(&staging, &from, size).unwrap();
    runtime.clear(&to, size + 1).unwrap();
    let value = scaling(0.7, 1000, 3);
    let arguments = [Argument::Memory(&from), Argument::Memory(&to), Argument::Value(&value)];
    runtime.launch(&kernels[0], 16, 64, &arguments).unwrap();
    let mut fetch = runtime.fetch(&to, size).unwrap();
    let expected: Vec<[f64; 4]> = input
        .iter()
        .map(|&[x, y, z, w]| if x < 0.0 { [0.0; 4] } else { [x * 0.7, y * 0.7, z * 0.7, w + 3.0] })
        .collect();
    assert_eq!(bytemuck::cast_slice::<u8, [f64; 4]>(fetch.wait().unwrap()), expected);
    assert_eq!(fetch.wait().unwrap().len(), size);
}

fn fetches_overlap_and_their_memory_is_used_again(runtime: &impl Runtime) {
    let memory = runtime.allocate(4096).unwrap();
    runtime.upload(&memory, &[1; 4096]).unwrap();
    let mut first = runtime.fetch(&memory, 4096).unwrap();
    runtime.upload(&memory, &[2; 100]).unwrap();
    let mut second = runtime.fetch(&memory, 200).unwrap();
    assert_eq!(first.wait().unwrap(), [1; 4096]);
    assert_eq!(second.wait().unwrap(), [[2; 100], [1; 100]].concat());
    let place = first.wait().unwrap().as_ptr();
    drop(first);
    let mut third = runtime.fetch(&memory, 4000).unwrap();
    assert_eq!(third.wait().unwrap().as_ptr(), place);
}

fn a_fetch_may_outlive_its_memory(runtime: &impl Runtime) {
    let memory = runtime.allocate(4096).unwrap();
    runtime.upload(&memory, &[1; 4096]).unwrap();
    drop(runtime.fetch(&memory, 4096).unwrap());
    let mut fetch = runtime.fetch(&memory, 4096).unwrap();
    drop(memory);
    assert_eq!(fetch.wait().unwrap(), [1; 4096]);
}

fn nothing_is_a_size_too(runtime: &impl Runtime) {
    let kernels = runtime.build(KERNELS, &["count"]).unwrap();
    let memory = runtime.allocate(0).unwrap();
    runtime.upload(&memory, &[]).unwrap();
    runtime.clear(&memory, 0).unwrap();
    runtime.copy(&memory, &memory, 0).unwrap();
    runtime.launch(&kernels[0], 0, 64, &[]).unwrap();
    assert_eq!(runtime.fetch(&memory, 0).unwrap().wait().unwrap(), []);
    runtime.flush().unwrap();
    runtime.wait().unwrap();
}

fn atomics_and_local_memory_count_every_item(runtime: &impl Runtime) {
    let kernel = runtime.build(KERNELS, &["count"]).unwrap().remove(0);
    let n = 1000_u32;
    let bytes = 4 * (4 + n as usize);
    let memory = runtime.allocate(bytes).unwrap();
    runtime.clear(&memory, bytes).unwrap();
    runtime.launch(&kernel, 16, 64, &[Argument::Memory(&memory), Argument::Value(&n.to_ne_bytes())]).unwrap();
    let mut fetch = runtime.fetch(&memory, bytes).unwrap();
    let words: &[u32] = bytemuck::cast_slice(fetch.wait().unwrap());
    assert_eq!(words[..4], [n, u32::MAX, n - 1, n]);
    let mut groups = words[4..].to_vec();
    groups.sort_unstable();
    assert!(groups.iter().enumerate().all(|(i, &group)| group as usize == i / 64));
}

fn bits_of_reals_are_those_of_the_host(runtime: &impl Runtime) {
    let kernel = runtime.build(KERNELS, &["bits"]).unwrap().remove(0);
    let memory = runtime.allocate(32).unwrap();
    let x = 0.1_f64;
    runtime.launch(&kernel, 1, 64, &[Argument::Memory(&memory), Argument::Value(&x.to_ne_bytes())]).unwrap();
    let mut fetch = runtime.fetch(&memory, 32).unwrap();
    let expected = [x, f64::INFINITY, x, x.sqrt()].map(f64::to_bits);
    assert_eq!(bytemuck::cast_slice::<u8, u64>(fetch.wait().unwrap()), expected);
}

fn refusals_say_what_is_wrong(runtime: &impl Runtime) {
    let Err(Error::Compile { log }) = runtime.build("KERNEL(64, 1) broken() { no_such_name = 1; }", &["broken"]) else {
        panic!("it compiled");
    };
    assert!(log.contains("no_such_name"), "{log}");
    let unknown = runtime.build(KERNELS, &["absent"]).err();
    assert!(matches!(&unknown, Some(Error::Call { message, .. }) if message.contains("absent")), "{unknown:?}");
    let kernel = runtime.build(KERNELS, &["count"]).unwrap().remove(0);
    let memory = runtime.allocate(64).unwrap();
    let too_few = runtime.launch(&kernel, 1, 64, &[Argument::Memory(&memory)]);
    assert!(matches!(too_few, Err(Error::Call { .. })), "{too_few:?}");
    assert!(runtime.upload(&memory, &[0; 65]).is_err());
    assert!(runtime.clear(&memory, 65).is_err());
    assert!(runtime.fetch(&memory, 65).is_err());
    let huge = runtime.allocate(1 << 50).err();
    assert_eq!(huge, Some(Error::OutOfMemory { bytes: 1 << 50 }));
}

fn a_device_that_fuses_is_found_out(runtime: &impl Runtime) {
    assert_eq!(check_contraction(runtime), Ok(true));
    for (plain, other) in [
        ("q.x * q.y + q.z", "fma(q.x, q.y, q.z)"),
        ("product + q.z", "fma(q.x, q.y, q.z)"),
        ("q.z - q.x * q.y", "fma(-q.x, q.y, q.z)"),
        ("sum += q.x * q.x", "sum = fma(q.x, q.x, sum)"),
        ("q.x / root", "q.x * (1.0 / root)"),
    ] {
        assert!(SOURCE.contains(plain));
        assert_eq!(agrees(runtime, &SOURCE.replace(plain, other)), Ok(false), "{other}");
    }
}

#[test]
fn a_timed_launch_does_the_same_on_opencl() {
    a_timed_launch_does_the_same(opencl_runtime());
}

#[test]
#[ignore = "needs a device of CUDA"]
fn a_timed_launch_does_the_same_on_cuda() {
    a_timed_launch_does_the_same(cuda_runtime());
}

fn a_timed_launch_does_the_same(mut runtime: impl Runtime) {
    let kernel = runtime.build(KERNELS, &["count"]).unwrap().remove(0);
    let n = 1_u32 << 18;
    let groups = n as usize / 64;
    let memory = runtime.allocate(4 * (4 + 4 * n as usize)).unwrap();
    runtime.clear(&memory, 16).unwrap();
    let value = n.to_ne_bytes();
    let arguments = [Argument::Memory(&memory), Argument::Value(&value)];
    runtime.time_launches(true).unwrap();
    let start = Instant::now();
    let spans: Vec<_> = (0..3).map(|_| runtime.launch_timed(&kernel, groups, 64, &arguments).unwrap()).collect();
    let seconds: Vec<f64> = spans.iter().map(|span| span.seconds().unwrap()).collect();
    let whole = start.elapsed().as_secs_f64();
    runtime.time_launches(false).unwrap();
    runtime.launch(&kernel, groups, 64, &arguments).unwrap();
    // Both clocks count seconds.
    assert!(seconds.iter().all(|&s| s > 0.0) && seconds.iter().sum::<f64>() < 2.0 * whole, "{seconds:?} of {whole}");
    let mut fetch = runtime.fetch(&memory, 16).unwrap();
    assert_eq!(bytemuck::cast_slice::<u8, u32>(fetch.wait().unwrap())[3], 4 * n);
}

#[test]
fn the_survey_lists_a_device_that_passed_and_says_what_is_missing() {
    separate_caches();
    let survey = survey();
    let device = survey.devices.iter().find(|d| d.api == Api::OpenCl && d.index == 0).expect("an OpenCL device");
    assert_eq!(device.usable, Ok(()));
    assert!(device.fp64 && device.memory > 0 && device.compute_units > 0, "{device:?}");
    assert!(!device.name.is_empty() && !device.driver.is_empty(), "{device:?}");
    let cuda = survey.devices.iter().any(|d| d.api == Api::Cuda);
    let missing = survey.missing.iter().find(|(api, _)| *api == Api::Cuda);
    assert_ne!(cuda, missing.is_some());
    assert!(missing.is_none_or(|(_, why)| why.contains("NVIDIA")), "{missing:?}");
}

#[test]
fn a_device_that_does_not_exist_is_missing_and_no_panic() {
    separate_caches();
    assert!(matches!(open_opencl(1000).err(), Some(Error::Missing { .. })));
    assert!(matches!(Cuda::open(1000).err(), Some(Error::Missing { .. })));
}

#[test]
fn a_cache_gives_back_what_it_was_given_and_nothing_damaged() {
    let folder = env::temp_dir().join(format!("tdem-kernel-cache-{}", std::process::id()));
    let cache = KernelCache::at(folder.join("new"));
    let origin = ["source", "options"];
    assert_eq!(cache.load(&origin), None);
    cache.store(&origin, b"code");
    assert_eq!(cache.load(&origin).as_deref(), Some(&b"code"[..]));
    assert_eq!(cache.load(&["sourceopt", "ions"]), None);
    let file = std::fs::read_dir(folder.join("new")).unwrap().next().unwrap().unwrap().path();
    let whole = std::fs::read(&file).unwrap();
    for damaged in [&whole[..3], &whole[..18], &whole[..34], &[&whole[..35], &b"X"[..]].concat()] {
        std::fs::write(&file, damaged).unwrap();
        assert_eq!(cache.load(&origin), None);
    }
    // A folder that cannot be made is no error.
    KernelCache::at(file.join("under a file")).store(&origin, b"code");
    std::fs::remove_dir_all(folder).unwrap();
}

#[cfg(unix)]
#[test]
fn a_cache_takes_no_code_that_another_could_have_written() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let folder = env::temp_dir().join(format!("tdem-kernel-links-{}", std::process::id()));
    let cache = KernelCache::at(folder.clone());
    let (one, other) = (["one"], ["other"]);
    cache.store(&one, b"code");
    let entry = std::fs::read_dir(&folder).unwrap().next().unwrap().unwrap().path();
    cache.store(&other, b"other code");
    let of_other =
        std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).find(|p| *p != entry).unwrap();

    let whole = std::fs::metadata(&entry).unwrap().permissions();
    assert_eq!(whole.mode() & 0o777, 0o600);
    for open in [0o620, 0o602] {
        std::fs::set_permissions(&entry, PermissionsExt::from_mode(open)).unwrap();
        assert_eq!(cache.load(&one), None, "{open:o}");
    }
    std::fs::set_permissions(&entry, whole).unwrap();
    assert_eq!(cache.load(&one).as_deref(), Some(&b"code"[..]));

    // Under the name of another, and by a link to it.
    std::fs::copy(&of_other, &entry).unwrap();
    assert_eq!(cache.load(&one), None);
    std::fs::remove_file(&entry).unwrap();
    cache.store(&one, b"code");
    let aside = folder.join("aside");
    std::fs::rename(&entry, &aside).unwrap();
    symlink(&aside, &entry).unwrap();
    assert_eq!(cache.load(&one), None);

    // What a link under the temporary name leads to is left alone.
    let victim = folder.join("victim");
    std::fs::write(&victim, "precious").unwrap();
    symlink(&victim, entry.with_extension(format!("{}.tmp", std::process::id()))).unwrap();
    cache.store(&one, b"code");
    assert_eq!(cache.load(&one).as_deref(), Some(&b"code"[..]));
    assert_eq!(std::fs::read_to_string(&victim).unwrap(), "precious");
    std::fs::remove_dir_all(folder).unwrap();
}
