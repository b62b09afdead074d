//! CUDA's driver interface, whose libraries are looked for when they are needed.
#![allow(unsafe_code, reason = "the interface is C")]

use super::PRELUDE;
use super::devices::{Api, Listing};
use super::kernel_cache::KernelCache;
use super::pool::{Block, Pool};
use super::runtime::{Argument, Error, Fetch, Runtime, Span};
use cudarc::driver::sys::CUdevice_attribute::CU_DEVICE_ATTRIBUTE_MULTIPROCESSOR_COUNT;
use cudarc::driver::sys::{self, CUevent_flags, CUresult};
use cudarc::driver::{CudaContext, CudaEvent, CudaFunction, CudaStream, DriverError, result};
use cudarc::nvrtc::result as nvrtc;
use cudarc::nvrtc::{Ptx, sys as nvrtc_sys};
use std::ffi::CString;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr;
use std::slice;
use std::sync::Arc;

/// A device of CUDA with one stream of its own.
pub(crate) struct Cuda {
    context: Arc<CudaContext>,
    stream: Arc<CudaStream>,
    /// `sm_90` and the like.
    architecture: String,
    /// 13000 is 13.0.
    driver: i32,
    cache: KernelCache,
    pool: Pool<Pinned>,
}

/// Memory of the device.
pub(crate) struct Memory {
    place: sys::CUdeviceptr,
    bytes: usize,
    stream: Arc<CudaStream>,
}

impl Drop for Memory {
    fn drop(&mut self) {
        // SAFETY: it came from `malloc_sync` in this context, and all that used it is done.
        let freed = self.stream.synchronize().and_then(|()| unsafe { result::free_sync(self.place) });
        self.stream.context().record_err(freed);
    }
}

/// A kernel and the sizes of its parameters, which older drivers do not tell.
pub(crate) struct Kernel {
    function: CudaFunction,
    sizes: Option<Vec<usize>>,
}

/// Page-locked host memory.
pub(crate) struct Pinned {
    bytes: *mut u8,
    capacity: usize,
    context: Arc<CudaContext>,
}

// SAFETY: the memory is owned and belongs to no thread.
unsafe impl Send for Pinned {}

impl Block for Pinned {
    fn capacity(&self) -> usize {
        self.capacity
    }
}

impl Drop for Pinned {
    fn drop(&mut self) {
        // SAFETY: it came from `malloc_host` in this context, and nobody can hold it any more.
        let freed = self.context.bind_to_thread().and_then(|()| unsafe { result::free_host(self.bytes.cast()) });
        self.context.record_err(freed);
    }
}

/// A transfer to the host.
pub(crate) struct Transfer {
    /// Taken by `drop`.
    block: Option<Pinned>,
    bytes: usize,
    /// `None` when it is done.
    event: Option<CudaEvent>,
    pool: Pool<Pinned>,
}

impl Fetch for Transfer {
    fn wait(&mut self) -> Result<&[u8], Error> {
        if let Some(event) = &self.event {
            event.synchronize().map_err(|e| failed("cuEventSynchronize", e))?;
            self.event = None;
        }
        let start = self.block.as_ref().map_or(ptr::NonNull::dangling().as_ptr(), |block| block.bytes);
        // SAFETY: the block has at least this size, was written up to it, and nothing writes it now.
        Ok(unsafe { slice::from_raw_parts(start, self.bytes) })
    }
}

impl Drop for Transfer {
    fn drop(&mut self) {
        // A block that the device might still write must not be lent again, nor freed.
        let done = self.event.as_ref().is_none_or(|event| event.synchronize().is_ok());
        match self.block.take() {
            Some(block) if done => self.pool.give_back(block),
            block => std::mem::forget(block),
        }
    }
}

/// What the device noted before and behind a kernel. Where the host is slower than the device, waiting for the launch
/// lies between both.
pub(crate) struct Between {
    start: CudaEvent,
    end: CudaEvent,
}

impl Span for Between {
    fn seconds(&self) -> Result<f64, Error> {
        let milliseconds = self.start.elapsed_ms(&self.end).map_err(|e| failed("cuEventElapsedTime", e))?;
        Ok(1e-3 * f64::from(milliseconds))
    }
}

impl Cuda {
    /// All devices; whether they can be used is not known yet.
    pub(crate) fn list() -> Result<Vec<Listing>, Error> {
        guarded(|| (0..count()?).map(listing).collect())
    }
    /// The device of this number.
    pub(crate) fn open(index: usize) -> Result<Self, Error> {
        guarded(|| {
            let count = count()?;
            if index >= count {
                return Err(Error::Missing {
                    why: format!("CUDA has {count} devices here, so there is none of number {index}"),
                });
            }
            let context = CudaContext::new(index).map_err(|e| failed("cuDevicePrimaryCtxRetain", e))?;
            // SAFETY: there is one stream, and no memory is made through the binding.
            unsafe { context.disable_event_tracking() };
            let stream = context.new_stream().map_err(|e| failed("cuStreamCreate", e))?;
            let (major, minor) = context.compute_capability().map_err(|e| failed("cuDeviceGetAttribute", e))?;
            Ok(Cuda {
                stream,
                architecture: format!("sm_{major}{minor}"),
                driver: driver_version()?,
                cache: KernelCache::of_the_user(),
                pool: Pool::new(),
                context,
            })
        })
    }
    /// Makes the context the thread's.
    fn enter(&self) -> Result<(), Error> {
        self.context.bind_to_thread().map_err(|e| failed("cuCtxSetCurrent", e))
    }
    fn pin(&self, capacity: usize) -> Result<Pinned, Error> {
        // SAFETY: bytes have no invalid values, and are not read before a transfer wrote them.
        let start = unsafe { result::malloc_host(capacity, 0) }.map_err(|e| refused("cuMemHostAlloc", e, capacity))?;
        Ok(Pinned { bytes: start.cast(), capacity, context: Arc::clone(&self.context) })
    }
    /// The device notes the time when it comes here.
    fn mark(&self) -> Result<CudaEvent, Error> {
        let event = self.context.new_event(Some(CUevent_flags::CU_EVENT_DEFAULT));
        let event = event.map_err(|e| failed("cuEventCreate", e))?;
        event.record(&self.stream).map_err(|e| failed("cuEventRecord", e))?;
        Ok(event)
    }
    fn load(&self, code: Vec<u8>, names: &[&'static str]) -> Result<Vec<Kernel>, Error> {
        let module = self.context.load_module(Ptx::from_binary(code)).map_err(|e| failed("cuModuleLoadData", e))?;
        let kernel = |name: &&'static str| {
            let function = module.load_function(name).map_err(|e| Error::Call {
                call: "cuModuleGetFunction",
                message: format!("{} ({name})", message(e)),
            })?;
            Ok(Kernel { sizes: (self.driver >= 12_040).then(|| parameter_sizes(&function)), function })
        };
        names.iter().map(kernel).collect()
    }
}

impl Runtime for Cuda {
    type Memory = Memory;
    type Kernel = Kernel;
    type Fetch = Transfer;
    type Span = Between;

    fn build(&self, source: &str, names: &[&'static str]) -> Result<Vec<Kernel>, Error> {
        self.enter()?;
        let options = options(&self.architecture);
        let (driver, option_text) = (self.driver.to_string(), options.join(" "));
        let origin = [PRELUDE, source, &option_text, &driver, env!("CARGO_PKG_VERSION")];
        if let Some(Ok(kernels)) = self.cache.load(&origin).map(|code| self.load(code, names)) {
            return Ok(kernels);
        }
        let code = guarded(|| compile(&[PRELUDE, source].concat(), &options))?;
        self.cache.store(&origin, &code);
        self.load(code, names)
    }

    fn allocate(&self, bytes: usize) -> Result<Memory, Error> {
        self.enter()?;
        let bytes = bytes.max(1);
        // SAFETY: its content is undefined, as the trait says, and no host code reads it directly.
        let place = unsafe { result::malloc_sync(bytes) }.map_err(|e| refused("cuMemAlloc", e, bytes))?;
        Ok(Memory { place, bytes, stream: Arc::clone(&self.stream) })
    }

    fn upload(&self, memory: &Memory, bytes: &[u8]) -> Result<(), Error> {
        self.enter()?;
        within("cuMemcpyHtoDAsync", memory, bytes.len())?;
        if bytes.is_empty() {
            return Ok(());
        }
        // SAFETY: the sizes fit, and `bytes` is borrowed until the stream is empty.
        unsafe { result::memcpy_htod_async(memory.place, bytes, self.stream.cu_stream()) }
            .map_err(|e| refused("cuMemcpyHtoDAsync", e, bytes.len()))?;
        self.wait()
    }

    fn clear(&self, memory: &Memory, bytes: usize) -> Result<(), Error> {
        self.enter()?;
        within("cuMemsetD8Async", memory, bytes)?;
        if bytes == 0 {
            return Ok(());
        }
        // SAFETY: the size fits; freeing the memory waits for the stream.
        unsafe { result::memset_d8_async(memory.place, 0, bytes, self.stream.cu_stream()) }
            .map_err(|e| refused("cuMemsetD8Async", e, bytes))
    }

    fn copy(&self, from: &Memory, to: &Memory, bytes: usize) -> Result<(), Error> {
        self.enter()?;
        within("cuMemcpyDtoDAsync", from, bytes)?;
        within("cuMemcpyDtoDAsync", to, bytes)?;
        if bytes == 0 {
            return Ok(());
        }
        // SAFETY: the sizes fit; freeing either memory waits for the stream.
        unsafe { result::memcpy_dtod_async(to.place, from.place, bytes, self.stream.cu_stream()) }
            .map_err(|e| refused("cuMemcpyDtoDAsync", e, bytes))
    }

    fn launch(
        &self,
        kernel: &Kernel,
        groups: usize,
        size: usize,
        arguments: &[Argument<'_, Memory>],
    ) -> Result<(), Error> {
        if groups == 0 {
            return Ok(());
        }
        self.enter()?;
        let call = "cuLaunchKernel";
        if let Some(sizes) = &kernel.sizes {
            let given = arguments.iter().map(|argument| match argument {
                Argument::Memory(memory) => size_of_val(&memory.place),
                Argument::Value(value) => value.len(),
            });
            if !given.clone().eq(sizes.iter().copied()) {
                let given: Vec<usize> = given.collect();
                let message = format!("the arguments have {given:?} bytes, the kernel expects {sizes:?}");
                return Err(Error::Call { call, message });
            }
        }
        let mut parameters: Vec<_> = arguments
            .iter()
            .map(|argument| match argument {
                Argument::Memory(memory) => ptr::from_ref(&memory.place).cast_mut().cast(),
                Argument::Value(value) => value.as_ptr().cast_mut().cast(),
            })
            .collect();
        let too_many = |_| Error::Call { call, message: format!("{groups} groups of {size} are too many") };
        let groups = u32::try_from(groups).map_err(too_many)?;
        let size = u32::try_from(size).map_err(too_many)?;
        let stream = self.stream.cu_stream();
        // SAFETY: the module of the function is loaded as long as `kernel` lives; the arguments are copied by the
        // call, and their sizes are the kernel's. What the kernel does with its buffers is the business of its source.
        unsafe {
            let function = kernel.function.cu_function();
            result::launch_kernel(function, (groups, 1, 1), (size, 1, 1), 0, stream, &mut parameters)
        }
        .map_err(|e| failed(call, e))
    }

    fn time_launches(&mut self, _: bool) -> Result<(), Error> {
        self.wait()
    }

    fn launch_timed(
        &self,
        kernel: &Kernel,
        groups: usize,
        size: usize,
        arguments: &[Argument<'_, Memory>],
    ) -> Result<Between, Error> {
        let start = self.mark()?;
        self.launch(kernel, groups, size, arguments)?;
        Ok(Between { start, end: self.mark()? })
    }

    fn fetch(&self, memory: &Memory, bytes: usize) -> Result<Transfer, Error> {
        self.enter()?;
        within("cuMemcpyDtoHAsync", memory, bytes)?;
        let mut transfer = Transfer { block: None, bytes, event: None, pool: self.pool.share() };
        if bytes == 0 {
            return Ok(transfer);
        }
        let event = self.context.new_event(None).map_err(|e| failed("cuEventCreate", e))?;
        let block = transfer.block.insert(self.pool.take(bytes, |capacity| self.pin(capacity))?);
        // SAFETY: the sizes fit, and the block is kept until the event is complete.
        unsafe {
            let target = slice::from_raw_parts_mut(block.bytes, bytes);
            result::memcpy_dtoh_async(target, memory.place, self.stream.cu_stream())
        }
        .map_err(|e| failed("cuMemcpyDtoHAsync", e))?;
        let recorded = event.record(&self.stream);
        transfer.event = Some(event);
        if let Err(error) = recorded {
            // Without the event, only the whole stream tells when the block is written.
            self.wait()?;
            return Err(failed("cuEventRecord", error));
        }
        Ok(transfer)
    }

    fn flush(&self) -> Result<(), Error> {
        // Asking is what makes drivers that collect launches hand them over.
        // SAFETY: the stream is alive.
        match unsafe { sys::cuStreamQuery(self.stream.cu_stream()) } {
            CUresult::CUDA_SUCCESS | CUresult::CUDA_ERROR_NOT_READY => Ok(()),
            error => Err(failed("cuStreamQuery", DriverError(error))),
        }
    }

    fn wait(&self) -> Result<(), Error> {
        self.stream.synchronize().map_err(|e| failed("cuStreamSynchronize", e))
    }
}

/// The binding panics over libraries and functions that are missing: that becomes an error, too.
fn guarded<T>(work: impl FnOnce() -> Result<T, Error>) -> Result<T, Error> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str).or_else(|| panic.downcast_ref().copied());
        Err(Error::Missing { why: text.unwrap_or("a library of CUDA cannot be used").to_owned() })
    })
}

/// Devices of the driver, of which there is at least one.
fn count() -> Result<usize, Error> {
    // SAFETY: loads the library and lets go of it.
    if !unsafe { sys::is_culib_present() } {
        return Err(Error::Missing { why: "the library of NVIDIA's driver (libcuda) was not found".to_owned() });
    }
    let none = || Error::Missing { why: "NVIDIA's driver has no device".to_owned() };
    match CudaContext::device_count() {
        Ok(0) | Err(DriverError(CUresult::CUDA_ERROR_NO_DEVICE)) => Err(none()),
        Ok(count) => Ok(count as usize),
        Err(error) => Err(Error::Missing { why: format!("NVIDIA's driver cannot be used: {}", message(error)) }),
    }
}

fn listing(index: usize) -> Result<Listing, Error> {
    let asked = |e| failed("cuDeviceGetAttribute", e);
    let device = result::device::get(index as i32).map_err(asked)?;
    let driver = driver_version()?;
    Ok(Listing {
        api: Api::Cuda,
        index,
        name: result::device::get_name(device).map_err(asked)?,
        driver: named(driver, std::fs::read_to_string(MODULE).ok().as_deref()),
        // SAFETY: the device comes from the driver.
        memory: unsafe { result::device::total_mem(device) }.map_err(asked)? as u64,
        fp64: true,
        processor: false,
        // SAFETY: the device comes from the driver.
        compute_units: unsafe { result::device::get_attribute(device, CU_DEVICE_ATTRIBUTE_MULTIPROCESSOR_COUNT) }
            .map_err(asked)? as u32,
        usable: Ok(()),
    })
}

/// Where NVIDIA's module tells its version on Linux.
const MODULE: &str = "/proc/driver/nvidia/version";

/// The driver's own version, where its module tells it, and the version of CUDA that it knows.
fn named(driver: i32, module: Option<&str>) -> String {
    let number = |word: &&str| word.contains('.') && word.chars().all(|c| c.is_ascii_digit() || c == '.');
    let own = module.and_then(|text| text.lines().next()?.split_whitespace().find(number));
    let cuda = format!("CUDA {}.{}", driver / 1000, driver % 1000 / 10);
    own.map_or(cuda.clone(), |own| format!("{own}, {cuda}"))
}

fn driver_version() -> Result<i32, Error> {
    let mut version = 0;
    // SAFETY: writes one number.
    let asked = unsafe { sys::cuDriverGetVersion(&raw mut version) }.result();
    asked.map(|()| version).map_err(|e| failed("cuDriverGetVersion", e))
}

/// Sizes of a kernel's parameters, bytes; only for drivers of 12.4 and later.
fn parameter_sizes(function: &CudaFunction) -> Vec<usize> {
    let size = |index| {
        let (mut offset, mut size) = (0, 0);
        // SAFETY: the function is loaded; writes two numbers. Past the last parameter it answers with an error.
        let asked = unsafe { sys::cuFuncGetParamInfo(function.cu_function(), index, &raw mut offset, &raw mut size) };
        asked.result().ok().map(|()| size)
    };
    (0..).map_while(size).collect()
}

/// Options of the compiler: no contraction ever, line tables for profilers.
fn options(architecture: &str) -> [String; 4] {
    let architecture = format!("--gpu-architecture={architecture}");
    [architecture, "--fmad=false".to_owned(), "--std=c++17".to_owned(), "--generate-line-info".to_owned()]
}

/// Machine code of a source.
fn compile(source: &str, options: &[String]) -> Result<Vec<u8>, Error> {
    // SAFETY: loads the library and lets go of it.
    if !unsafe { nvrtc_sys::is_culib_present() } {
        let why = "CUDA's compiler of kernels (libnvrtc, of CUDA 12 or 13) was not found; it is only needed once per device and version";
        return Err(Error::Missing { why: why.to_owned() });
    }
    let call = |call| move |error: nvrtc::NvrtcError| Error::Call { call, message: format!("{:?}", error.0) };
    let Ok(text) = CString::new(source) else {
        return Err(Error::Compile { log: "the source contains a zero byte".to_owned() });
    };
    let program = Compilation(nvrtc::create_program(&text, Some(c"tdem.cu")).map_err(call("nvrtcCreateProgram"))?);
    // SAFETY: the program is alive until the end of this function, as is the text.
    unsafe {
        nvrtc::compile_program(program.0, options).map_err(|error| {
            let log = nvrtc::get_program_log(program.0).unwrap_or_default();
            let log: Vec<u8> = log.into_iter().map(|c| c as u8).take_while(|&c| c != 0).collect();
            match error.0 {
                nvrtc_sys::nvrtcResult::NVRTC_ERROR_COMPILATION => {
                    Error::Compile { log: String::from_utf8_lossy(&log).trim().to_owned() }
                }
                other => Error::Call {
                    call: "nvrtcCompileProgram",
                    message: format!("{other:?} {}", String::from_utf8_lossy(&log).trim()).trim().to_owned(),
                },
            }
        })?;
        let mut size = 0;
        nvrtc_sys::nvrtcGetCUBINSize(program.0, &raw mut size).result().map_err(call("nvrtcGetCUBINSize"))?;
        let mut code = vec![0_u8; size];
        nvrtc_sys::nvrtcGetCUBIN(program.0, code.as_mut_ptr().cast()).result().map_err(call("nvrtcGetCUBIN"))?;
        Ok(code)
    }
}

/// A program of the compiler.
struct Compilation(nvrtc_sys::nvrtcProgram);

impl Drop for Compilation {
    fn drop(&mut self) {
        // SAFETY: it was created, and is destroyed once.
        let _ = unsafe { nvrtc::destroy_program(self.0) };
    }
}

/// Whether the first `bytes` exist.
fn within(call: &'static str, memory: &Memory, bytes: usize) -> Result<(), Error> {
    if bytes <= memory.bytes {
        Ok(())
    } else {
        Err(Error::Call { call, message: format!("{bytes} bytes of a memory of {}", memory.bytes) })
    }
}

fn message(error: DriverError) -> String {
    let text = error.error_string().ok().map(|text| text.to_string_lossy().into_owned());
    text.unwrap_or_else(|| format!("{:?}", error.0))
}

fn failed(call: &'static str, error: DriverError) -> Error {
    Error::Call { call, message: message(error) }
}

/// A refusal of a call that may need memory.
fn refused(call: &'static str, error: DriverError, bytes: usize) -> Error {
    match error.0 {
        CUresult::CUDA_ERROR_OUT_OF_MEMORY => Error::OutOfMemory { bytes },
        _ => failed(call, error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::self_test::SOURCE;

    #[test]
    #[ignore = "needs the compiler of CUDA, but no device"]
    fn the_compiler_makes_machine_code_and_tells_what_it_refuses() {
        let options = options("sm_90");
        let code = compile(&[PRELUDE, SOURCE].concat(), &options).unwrap();
        assert_eq!(code[..4], *b"\x7fELF");
        let Err(Error::Compile { log }) = compile("int f() { return no_such_name; }", &options) else {
            panic!("it compiled");
        };
        assert!(log.contains("no_such_name"), "{log}");
        let unknown = compile(SOURCE, &["--no-such-option".to_owned()]);
        assert!(matches!(unknown, Err(Error::Call { call: "nvrtcCompileProgram", .. })), "{unknown:?}");
    }
    #[test]
    fn a_panic_of_the_binding_is_an_error() {
        let error = guarded::<()>(|| panic!("no library {}", 1));
        assert_eq!(error, Err(Error::Missing { why: "no library 1".to_owned() }));
    }

    #[test]
    fn the_version_of_the_driver_is_found_in_what_its_module_tells() {
        let closed = "NVRM version: NVIDIA UNIX x86_64 Kernel Module  550.54.15  Tue Mar  5 22:23:56 UTC 2024\nGCC version: 12.2.0";
        let open = "NVRM version: NVIDIA UNIX Open Kernel Module for x86_64  580.159.04  Release Build";
        assert_eq!(named(12_040, Some(closed)), "550.54.15, CUDA 12.4");
        assert_eq!(named(13_000, Some(open)), "580.159.04, CUDA 13.0");
        assert_eq!([named(13_000, Some("")), named(13_000, None)], ["CUDA 13.0", "CUDA 13.0"]);
    }
}
