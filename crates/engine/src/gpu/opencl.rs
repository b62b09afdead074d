//! OpenCL 1.2, whose library is looked for when it is needed.
#![allow(unsafe_code, reason = "the interface is C")]

use super::PRELUDE;
use super::devices::{Api, Listing};
use super::pool::{Block, Pool};
use super::runtime::{Argument, Error, Fetch, Runtime, Span};
use opencl3::command_queue::{CL_QUEUE_PROFILING_ENABLE, CommandQueue};
use opencl3::context::Context;
use opencl3::device::{CL_DEVICE_TYPE_ALL, CL_DEVICE_TYPE_CPU, Device};
use opencl3::error_codes::{
    CL_BUILD_PROGRAM_FAILURE, CL_DEVICE_NOT_FOUND, CL_INVALID_BUFFER_SIZE, CL_MEM_OBJECT_ALLOCATION_FAILURE,
    CL_OUT_OF_HOST_MEMORY, CL_OUT_OF_RESOURCES, CL_PLATFORM_NOT_FOUND_KHR, ClError, DLOPEN_RUNTIME_LOAD_FAILED,
};
use opencl3::event::Event;
use opencl3::kernel::set_kernel_arg;
use opencl3::memory::{Buffer, CL_MAP_READ, CL_MAP_WRITE, CL_MEM_ALLOC_HOST_PTR, CL_MEM_READ_WRITE, ClMem};
use opencl3::platform::get_platforms;
use opencl3::program::Program;
use opencl3::types::{CL_BLOCKING, CL_NON_BLOCKING, cl_command_queue_properties, cl_mem};
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::mem::ManuallyDrop;
use std::ptr;
use std::slice;
use std::sync::{Arc, Mutex, PoisonError};
use xxhash_rust::xxh3::xxh3_128;

/// A device of OpenCL with one queue that keeps its order.
pub(crate) struct OpenCl {
    shared: Arc<Shared>,
    queue: CommandQueue,
    /// For mapping host memory, which would wait for all work in the other queue.
    mapping: Arc<CommandQueue>,
    pool: Pool<Mapped>,
}

/// What all users of a device in this process share: a driver takes long to build a program, and some do it anew even
/// for a source that they know. It is kept until the process ends.
struct Shared {
    device: Device,
    context: Context,
    /// Built programs by the hash of their source.
    programs: Mutex<BTreeMap<u128, Program>>,
}

impl Shared {
    fn of(device: Device) -> Result<Arc<Self>, Error> {
        static DEVICES: Mutex<Vec<Arc<Shared>>> = Mutex::new(Vec::new());
        let mut known = DEVICES.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(shared) = known.iter().find(|shared| shared.device.id() == device.id()) {
            return Ok(Arc::clone(shared));
        }
        let context = Context::from_device(&device).map_err(|e| failed("clCreateContext", e))?;
        let shared = Arc::new(Shared { device, context, programs: Mutex::default() });
        known.push(Arc::clone(&shared));
        Ok(shared)
    }
    /// Uses the program of this whole source, built if it is new.
    fn with_program<T>(&self, source: &str, f: impl FnOnce(&Program) -> Result<T, Error>) -> Result<T, Error> {
        let mut programs = self.programs.lock().unwrap_or_else(PoisonError::into_inner);
        match programs.entry(xxh3_128(source.as_bytes())) {
            Entry::Occupied(known) => f(known.get()),
            Entry::Vacant(free) => f(free.insert(self.program(source)?)),
        }
    }
    fn queue(&self, properties: cl_command_queue_properties) -> Result<CommandQueue, Error> {
        #[allow(deprecated, reason = "the newer call is not part of OpenCL 1.2")]
        CommandQueue::create_default(&self.context, properties).map_err(|e| failed("clCreateCommandQueue", e))
    }
    fn program(&self, source: &str) -> Result<Program, Error> {
        let mut program =
            Program::create_from_source(&self.context, source).map_err(|e| failed("clCreateProgramWithSource", e))?;
        program.build(self.context.devices(), "-cl-std=CL1.2").map_err(|error| match error {
            ClError(CL_BUILD_PROGRAM_FAILURE) => Error::Compile {
                log: program.get_build_log(self.device.id()).unwrap_or_else(|_| "no log".to_owned()).trim().to_owned(),
            },
            error => failed("clBuildProgram", error),
        })?;
        Ok(program)
    }
}

/// Memory of the device.
pub(crate) struct Memory {
    buffer: Buffer<u8>,
}

impl Memory {
    /// The same buffer as the binding wants it, mutable; it is not released.
    fn alias(&self) -> ManuallyDrop<Buffer<u8>> {
        ManuallyDrop::new(Buffer::new(self.buffer.get()))
    }
}

/// A kernel and the number of its arguments.
pub(crate) struct Kernel {
    kernel: opencl3::kernel::Kernel,
    arguments: usize,
}

/// A buffer in host memory that stays mapped; vendors pin it.
pub(crate) struct Mapped {
    buffer: Buffer<u8>,
    bytes: *mut u8,
    capacity: usize,
    queue: Arc<CommandQueue>,
}

// SAFETY: the pointer is to memory of `buffer`, which any thread may read; handles of OpenCL belong to no thread.
unsafe impl Send for Mapped {}

impl Block for Mapped {
    fn capacity(&self) -> usize {
        self.capacity
    }
}

impl Drop for Mapped {
    fn drop(&mut self) {
        // SAFETY: `bytes` is what mapping `buffer` returned, and nobody can hold it any more.
        let unmapped = unsafe { self.queue.enqueue_unmap_mem_object(self.buffer.get(), self.bytes.cast(), &[]) };
        // If it fails, the buffer stays mapped until it is released, which is now.
        let _ = unmapped.and_then(|_| self.queue.flush());
    }
}

/// A transfer to the host.
pub(crate) struct Transfer {
    /// Taken by `drop`.
    block: Option<Mapped>,
    bytes: usize,
    /// `None` when it is done.
    event: Option<Event>,
    pool: Pool<Mapped>,
}

impl Fetch for Transfer {
    fn wait(&mut self) -> Result<&[u8], Error> {
        if let Some(event) = &self.event {
            event.wait().map_err(|e| failed("clWaitForEvents", e))?;
            self.event = None;
        }
        let start = self.block.as_ref().map_or(ptr::NonNull::dangling().as_ptr(), |block| block.bytes);
        // SAFETY: the block is mapped, has at least this size, was written up to it, and nothing writes it now.
        Ok(unsafe { slice::from_raw_parts(start, self.bytes) })
    }
}

impl Drop for Transfer {
    fn drop(&mut self) {
        // A block that the device might still write must not be lent again: it is let go, and never unmapped.
        let done = self.event.as_ref().is_none_or(|event| event.wait().is_ok());
        match self.block.take() {
            Some(block) if done => self.pool.give_back(block),
            block => std::mem::forget(block),
        }
    }
}

impl Span for Event {
    fn seconds(&self) -> Result<f64, Error> {
        self.wait().map_err(|e| failed("clWaitForEvents", e))?;
        let asked = |e| failed("clGetEventProfilingInfo", e);
        let start = self.profiling_command_start().map_err(asked)?;
        let end = self.profiling_command_end().map_err(asked)?;
        Ok(1e-9 * end.saturating_sub(start) as f64)
    }
}

impl OpenCl {
    /// All devices of all platforms; whether they can be used is not known yet.
    pub(crate) fn list() -> Result<Vec<Listing>, Error> {
        let list = devices()?;
        list.iter()
            .enumerate()
            .map(|(index, device)| listing(index, *device).map_err(|e| failed("clGetDeviceInfo", e)))
            .collect()
    }
    /// The device of this number.
    pub(crate) fn open(index: usize) -> Result<Self, Error> {
        let list = devices()?;
        let count = list.len();
        let Some(device) = list.into_iter().nth(index) else {
            return Err(Error::Missing {
                why: format!("OpenCL has {count} devices here, so there is none of number {index}"),
            });
        };
        if device.double_fp_config().unwrap_or(0) == 0 {
            return Err(Error::Missing { why: "the device has no 64-bit reals".to_owned() });
        }
        let shared = Shared::of(device)?;
        let (queue, mapping) = (shared.queue(0)?, Arc::new(shared.queue(0)?));
        Ok(OpenCl { shared, queue, mapping, pool: Pool::new() })
    }
    fn map(&self, capacity: usize) -> Result<Mapped, Error> {
        let flags = CL_MEM_READ_WRITE | CL_MEM_ALLOC_HOST_PTR;
        // SAFETY: no host pointer is given.
        let buffer = unsafe { Buffer::create(&self.shared.context, flags, capacity, ptr::null_mut()) };
        let buffer = buffer.map_err(|e| no_room("clCreateBuffer", e, capacity))?;
        let mut start: cl_mem = ptr::null_mut();
        let flags = CL_MAP_READ | CL_MAP_WRITE;
        // SAFETY: the buffer has this size; the call waits, so the pointer is valid when it returns.
        unsafe { self.mapping.enqueue_map_buffer(&buffer, CL_BLOCKING, flags, 0, capacity, &mut start, &[]) }
            .map_err(|e| no_room("clEnqueueMapBuffer", e, capacity))?;
        Ok(Mapped { buffer, bytes: start.cast(), capacity, queue: Arc::clone(&self.mapping) })
    }
    /// Runs at least one group.
    fn enqueue(
        &self,
        kernel: &Kernel,
        groups: usize,
        size: usize,
        arguments: &[Argument<'_, Memory>],
    ) -> Result<Event, Error> {
        let Kernel { kernel, arguments: expected } = kernel;
        if arguments.len() != *expected {
            let message = format!("{} arguments, the kernel expects {expected}", arguments.len());
            return Err(Error::Call { call: "clSetKernelArg", message });
        }
        for (index, argument) in arguments.iter().enumerate() {
            let buffer;
            let (size, value) = match argument {
                Argument::Memory(memory) => {
                    buffer = memory.buffer.get();
                    (size_of_val(&buffer), (&raw const buffer).cast())
                }
                Argument::Value(value) => (value.len(), value.as_ptr().cast()),
            };
            // SAFETY: there is an argument of this number, and its value is copied by the call. That it has the size
            // that the kernel's source gives it is checked by most drivers.
            unsafe { set_kernel_arg(kernel.get(), index as u32, size, value) }.map_err(|code| Error::Call {
                call: "clSetKernelArg",
                message: format!("{} (argument {index})", ClError(code)),
            })?;
        }
        let total = groups * size;
        // SAFETY: one dimension, as both sizes; all arguments are set. What the kernel does with its buffers is the
        // business of its source.
        unsafe {
            self.queue.enqueue_nd_range_kernel(kernel.get(), 1, ptr::null(), &raw const total, &raw const size, &[])
        }
        .map_err(|e| failed("clEnqueueNDRangeKernel", e))
    }
    /// Fills the first `bytes`, at least one, with zeros.
    fn fill(&self, memory: &Memory, bytes: usize) -> Result<(), ClError> {
        // Wide patterns are filled faster; a pattern must fit a whole number of times.
        let width = 1 << bytes.trailing_zeros().min(4);
        // SAFETY: the pattern is copied by the call, which checks the size of the buffer.
        unsafe { self.queue.enqueue_fill_buffer(&mut memory.alias(), &[0_u8; 16][..width], 0, bytes, &[]) }.map(drop)
    }
}

impl Runtime for OpenCl {
    type Memory = Memory;
    type Kernel = Kernel;
    type Fetch = Transfer;
    /// The kernel's own event, whose profile is the kernel's and no more.
    type Span = Event;

    fn build(&self, source: &str, names: &[&'static str]) -> Result<Vec<Kernel>, Error> {
        self.shared.with_program(&[PRELUDE, source].concat(), |program| {
            let kernel = |name: &&'static str| {
                let refusal = |e| Error::Call { call: "clCreateKernel", message: format!("{e} ({name})") };
                let kernel = opencl3::kernel::Kernel::create(program, name).map_err(refusal)?;
                let arguments = kernel.num_args().map_err(|e| failed("clGetKernelInfo", e))? as usize;
                Ok(Kernel { kernel, arguments })
            };
            names.iter().map(kernel).collect()
        })
    }

    fn allocate(&self, bytes: usize) -> Result<Memory, Error> {
        // SAFETY: no host pointer is given.
        let buffer = unsafe { Buffer::create(&self.shared.context, CL_MEM_READ_WRITE, bytes.max(1), ptr::null_mut()) };
        let memory = Memory { buffer: buffer.map_err(|e| no_room("clCreateBuffer", e, bytes))? };
        // Some vendors give out memory at its first use: that must fail here, not in a kernel.
        self.fill(&memory, 1).map_err(|e| no_room("clEnqueueFillBuffer", e, bytes))?;
        Ok(memory)
    }

    fn upload(&self, memory: &Memory, bytes: &[u8]) -> Result<(), Error> {
        if bytes.is_empty() {
            return Ok(());
        }
        // SAFETY: the call waits until `bytes` is read, and checks the size of the buffer.
        unsafe { self.queue.enqueue_write_buffer(&mut memory.alias(), CL_BLOCKING, 0, bytes, &[]) }
            .map_err(|e| refused("clEnqueueWriteBuffer", e, bytes.len()))?;
        Ok(())
    }

    fn clear(&self, memory: &Memory, bytes: usize) -> Result<(), Error> {
        if bytes == 0 {
            return Ok(());
        }
        self.fill(memory, bytes).map_err(|e| refused("clEnqueueFillBuffer", e, bytes))
    }

    fn copy(&self, from: &Memory, to: &Memory, bytes: usize) -> Result<(), Error> {
        if bytes == 0 {
            return Ok(());
        }
        // SAFETY: the call checks sizes and overlap; the queue keeps both buffers until it is done.
        unsafe { self.queue.enqueue_copy_buffer(&from.buffer, &mut to.alias(), 0, 0, bytes, &[]) }
            .map_err(|e| refused("clEnqueueCopyBuffer", e, bytes))?;
        Ok(())
    }

    fn launch(
        &self,
        kernel: &Kernel,
        groups: usize,
        size: usize,
        arguments: &[Argument<'_, Memory>],
    ) -> Result<(), Error> {
        if groups == 0 { Ok(()) } else { self.enqueue(kernel, groups, size, arguments).map(drop) }
    }

    /// Only a queue that was made for it times what runs in it, and each kernel then takes longer to start.
    fn time_launches(&mut self, timed: bool) -> Result<(), Error> {
        self.wait()?;
        self.queue = self.shared.queue(if timed { CL_QUEUE_PROFILING_ENABLE } else { 0 })?;
        Ok(())
    }

    fn launch_timed(
        &self,
        kernel: &Kernel,
        groups: usize,
        size: usize,
        arguments: &[Argument<'_, Memory>],
    ) -> Result<Event, Error> {
        self.enqueue(kernel, groups, size, arguments)
    }

    fn fetch(&self, memory: &Memory, bytes: usize) -> Result<Transfer, Error> {
        let mut transfer = Transfer { block: None, bytes, event: None, pool: self.pool.share() };
        if bytes == 0 {
            return Ok(transfer);
        }
        let block = transfer.block.insert(self.pool.take(bytes, |capacity| self.map(capacity))?);
        // SAFETY: the block is mapped, has at least this size, and is kept until the event is complete.
        let event = unsafe {
            let target = slice::from_raw_parts_mut(block.bytes, bytes);
            self.queue.enqueue_read_buffer(&memory.buffer, CL_NON_BLOCKING, 0, target, &[])
        };
        transfer.event = Some(event.map_err(|e| refused("clEnqueueReadBuffer", e, bytes))?);
        self.flush()?;
        Ok(transfer)
    }

    fn flush(&self) -> Result<(), Error> {
        self.queue.flush().map_err(|e| failed("clFlush", e))
    }

    fn wait(&self) -> Result<(), Error> {
        self.queue.finish().map_err(|e| failed("clFinish", e))
    }
}

/// All devices of all platforms, in the order of the loader.
fn devices() -> Result<Vec<Device>, Error> {
    /// Drivers initialise themselves when they are first asked, and not all can be asked twice at a time.
    static ASKING: Mutex<()> = Mutex::new(());
    let _asking = ASKING.lock().unwrap_or_else(PoisonError::into_inner);
    let missing = |why: &str| Error::Missing { why: why.to_owned() };
    let platforms = get_platforms().map_err(|error| match error.0 {
        DLOPEN_RUNTIME_LOAD_FAILED => missing("the loader of OpenCL (libOpenCL) was not found"),
        CL_PLATFORM_NOT_FOUND_KHR => missing("OpenCL's loader knows no driver"),
        _ => failed("clGetPlatformIDs", error),
    })?;
    let (mut list, mut refusal) = (Vec::new(), missing("no driver of OpenCL has a device"));
    for platform in platforms {
        // A driver that fails must not hide the devices of the others.
        match platform.get_devices(CL_DEVICE_TYPE_ALL) {
            Ok(ids) => list.extend(ids.into_iter().map(Device::new)),
            Err(ClError(CL_DEVICE_NOT_FOUND)) => {}
            Err(error) => refusal = failed("clGetDeviceIDs", error),
        }
    }
    if list.is_empty() { Err(refusal) } else { Ok(list) }
}

fn listing(index: usize, device: Device) -> Result<Listing, ClError> {
    let words = |text: String| text.split_whitespace().collect::<Vec<_>>().join(" ");
    Ok(Listing {
        api: Api::OpenCl,
        index,
        name: words(device.name()?),
        driver: words(format!("{} {}", device.version()?, device.driver_version()?)),
        memory: device.global_mem_size()?,
        fp64: device.double_fp_config().unwrap_or(0) != 0,
        processor: device.dev_type()? & CL_DEVICE_TYPE_CPU != 0,
        compute_units: device.max_compute_units()?,
        usable: Ok(()),
    })
}

fn failed(call: &'static str, error: ClError) -> Error {
    Error::Call { call, message: error.into() }
}

/// A refusal of a call that may need memory.
fn refused(call: &'static str, error: ClError, bytes: usize) -> Error {
    match error.0 {
        CL_MEM_OBJECT_ALLOCATION_FAILURE | CL_OUT_OF_HOST_MEMORY | CL_INVALID_BUFFER_SIZE => {
            Error::OutOfMemory { bytes }
        }
        _ => failed(call, error),
    }
}

/// A refusal of new memory. `CL_OUT_OF_RESOURCES` may then mean that, elsewhere it is what a lost device answers.
fn no_room(call: &'static str, error: ClError, bytes: usize) -> Error {
    if error.0 == CL_OUT_OF_RESOURCES { Error::OutOfMemory { bytes } } else { refused(call, error, bytes) }
}
