//! What the back end needs from a GPU's programming interface: memory, kernels, one queue that keeps its order.

use thiserror::Error;

/// One device with one queue: what is asked for first is done first, on the device; the host does not wait unless a
/// method says so.
pub(crate) trait Runtime: Send + Sized + 'static {
    /// Memory of the device; freed when dropped.
    type Memory: Send + Sync;
    /// A compiled kernel.
    type Kernel: Send;
    /// A transfer to the host that is under way.
    type Fetch: Fetch;
    /// A launch that was timed.
    type Span: Span;

    /// Compiles kernels written in the dialect of `kernels/prelude.cl`, without contraction of `a * b + c`.
    ///
    /// `source` is the whole text but the prelude; `names` are the kernels wanted, in the order of the answer.
    fn build(&self, source: &str, names: &[&'static str]) -> Result<Vec<Self::Kernel>, Error>;
    /// Memory whose content is not defined yet; at least 1 byte is allocated.
    fn allocate(&self, bytes: usize) -> Result<Self::Memory, Error>;
    /// Writes the start of a memory; `bytes` may be reused when this returns.
    fn upload(&self, memory: &Self::Memory, bytes: &[u8]) -> Result<(), Error>;
    /// Fills the first `bytes` with zeros.
    fn clear(&self, memory: &Self::Memory, bytes: usize) -> Result<(), Error>;
    /// Copies the first `bytes` of a memory to another.
    fn copy(&self, from: &Self::Memory, to: &Self::Memory, bytes: usize) -> Result<(), Error>;
    /// Runs `groups` work-groups of `size` work-items each.
    fn launch(
        &self,
        kernel: &Self::Kernel,
        groups: usize,
        size: usize,
        arguments: &[Argument<'_, Self::Memory>],
    ) -> Result<(), Error>;
    /// Says whether launches will be timed, which some devices must know before. Waits until all is done.
    fn time_launches(&mut self, timed: bool) -> Result<(), Error>;
    /// As [`Self::launch`], of at least one group, with the device's clock read before and behind it.
    fn launch_timed(
        &self,
        kernel: &Self::Kernel,
        groups: usize,
        size: usize,
        arguments: &[Argument<'_, Self::Memory>],
    ) -> Result<Self::Span, Error>;
    /// Starts to bring the first `bytes` of a memory to the host, into pinned memory where there is such a thing.
    fn fetch(&self, memory: &Self::Memory, bytes: usize) -> Result<Self::Fetch, Error>;
    /// Hands over to the device what was asked for so far.
    fn flush(&self) -> Result<(), Error>;
    /// Waits until all is done.
    fn wait(&self) -> Result<(), Error>;
}

/// A transfer to the host that is under way. Its host memory goes back to a pool when it is dropped.
pub(crate) trait Fetch: Send {
    /// Waits for the bytes.
    fn wait(&mut self) -> Result<&[u8], Error>;
}

/// A launch that was timed.
pub(crate) trait Span: Send {
    /// How long it took on the device, s. Waits until it is done.
    fn seconds(&self) -> Result<f64, Error>;
}

/// An argument of a kernel.
#[derive(Debug)]
pub(crate) enum Argument<'a, M> {
    /// A buffer.
    Memory(&'a M),
    /// A number or a struct, by value, as C lays it out.
    Value(&'a [u8]),
}

/// What an interface or a device refuses.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum Error {
    /// There is no such interface or device here, or it cannot be used.
    #[error("{why}")]
    Missing {
        /// What is missing, in a sentence's end: "libcuda.so was not found".
        why: String,
    },
    /// The device has too little memory left.
    #[error("the device has no room for {bytes} bytes more")]
    OutOfMemory {
        /// Asked for.
        bytes: usize,
    },
    /// The kernels were not accepted.
    #[error("the device's compiler refuses the kernels:\n{log}")]
    Compile {
        /// What the compiler said.
        log: String,
    },
    /// A call failed.
    #[error("{call} failed: {message}")]
    Call {
        /// Name of the function of the interface.
        call: &'static str,
        /// What it answered.
        message: String,
    },
}
