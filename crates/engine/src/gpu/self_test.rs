//! Whether a device computes as the host does, bit for bit.

use super::runtime::{Argument, Error, Fetch, Runtime};
use bytemuck::{Pod, Zeroable};

/// The kernel.
pub(super) const SOURCE: &str = include_str!("kernels/self_test.cl");
/// Items of the test.
const COUNT: usize = 256;
/// Rows of the result per item.
const ROWS: usize = 2;
/// Work-items per group.
const GROUP: usize = 64;

/// A `Quad` of the kernels.
type Quad = [f64; 4];

/// The kernel's struct of the same name.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Trial {
    scale: f64,
    count: u32,
    rows: u32,
}

/// Whether the device rounds each product before it adds, and divides and takes roots exactly: results must have the
/// host's bits. Uses every call of the runtime once.
pub(super) fn check_contraction<R: Runtime>(runtime: &R) -> Result<bool, Error> {
    agrees(runtime, SOURCE)
}

/// The same for a given kernel.
pub(super) fn agrees<R: Runtime>(runtime: &R, source: &str) -> Result<bool, Error> {
    let kernel = runtime.build(source, &["self_test"])?.remove(0);
    let trial = Trial { scale: 1.0 / 3.0, count: COUNT as u32, rows: ROWS as u32 };
    let input = inputs();
    let expected: Vec<[Quad; ROWS]> = input.iter().map(|q| on_the_host(q, &trial)).collect();
    let size = size_of_val(&input[..]);

    let (staging, memory) = (runtime.allocate(size)?, runtime.allocate(size)?);
    let output = runtime.allocate(size * ROWS)?;
    runtime.upload(&staging, bytemuck::cast_slice(&input))?;
    runtime.copy(&staging, &memory, size)?;
    runtime.clear(&output, size * ROWS)?;
    let arguments = [Argument::Memory(&memory), Argument::Memory(&output), Argument::Value(bytemuck::bytes_of(&trial))];
    runtime.launch(&kernel, COUNT.div_ceil(GROUP), GROUP, &arguments)?;
    let mut fetch = runtime.fetch(&output, size * ROWS)?;
    runtime.flush()?;
    let same = fetch.wait()? == bytemuck::cast_slice::<_, u8>(&expected);
    runtime.wait()?;
    Ok(same)
}

/// Numbers for which fusing shows: the third cancels the rounded product of the first two, exactly or nearly. Some
/// products are subnormal, which a device must not flush to zero.
fn inputs() -> Vec<Quad> {
    let mut seed = 0x2545_f491_4f6c_dd1d_u64;
    let mut uniform = || {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        (seed >> 11) as f64 / (1_u64 << 53) as f64 + 0.5
    };
    (0..COUNT)
        .map(|i| {
            let scale = if i % 16 == 15 { 1e-155 } else { 1.0 };
            let (x, y) = (uniform() * scale, uniform() * scale);
            let nearly = if i % 2 == 0 { 1.0 } else { uniform() };
            [x, y, -(x * y) * nearly, uniform()]
        })
        .collect()
}

/// What the kernel computes, operation by operation.
fn on_the_host(&[x, y, z, w]: &Quad, trial: &Trial) -> [Quad; ROWS] {
    let product = x * y;
    let root = (trial.scale * w + x * x + y * y).sqrt();
    [[product + z, product + z, z - product, product + z], [root, x / root, 1.0 / root, x / y]]
}
