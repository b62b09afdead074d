//! Typed buffers, and a queue that runs the kernels of the table.

use super::layout::{Call, InC};
use super::program::{Program, Variant};
use super::runtime::{Argument, Error, Fetch, Runtime};
use super::traffic::Traffic;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::marker::PhantomData;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Device memory for `len` values of one type.
pub(crate) struct Buffer<T, M> {
    memory: Arc<M>,
    len: usize,
    /// How many of them mean something; there may be room for more.
    used: usize,
    /// Whether it stands in the memory of another buffer.
    lodges: bool,
    /// Bytes of all buffers of the queue together.
    total: Arc<AtomicUsize>,
    element: PhantomData<fn() -> T>,
}

impl<T, M> Buffer<T, M> {
    pub(super) fn memory(&self) -> &M {
        &self.memory
    }
    pub(crate) fn len(&self) -> usize {
        self.len
    }
    pub(crate) fn used(&self) -> usize {
        self.used
    }
    /// Says that the first `len` values mean something.
    pub(crate) fn set_used(&mut self, len: usize) {
        debug_assert!(len <= self.len, "what is used has room");
        self.used = len;
    }
    fn bytes(&self) -> usize {
        self.len * size_of::<T>()
    }
}

impl<T: InC, M> Buffer<T, M> {
    /// The memory as room for `len` values of another type, while nobody needs what this buffer holds.
    pub(super) fn room<U: InC>(&self, len: usize) -> Buffer<U, M> {
        assert!(len * size_of::<U>() <= self.bytes(), "there is room");
        Buffer {
            memory: Arc::clone(&self.memory),
            len,
            used: len,
            lodges: true,
            total: Arc::clone(&self.total),
            element: PhantomData,
        }
    }
}

impl<T, M> Drop for Buffer<T, M> {
    fn drop(&mut self) {
        if !self.lodges {
            self.total.fetch_sub(self.bytes(), Ordering::Relaxed);
        }
    }
}

/// A device's queue and the kernels built for a run.
pub(crate) struct Queue<R: Runtime, P = Variant> {
    runtime: R,
    program: P,
    kernels: BTreeMap<&'static str, R::Kernel>,
    total: Arc<AtomicUsize>,
    /// What was launched since a profile began, while one is taken.
    record: RefCell<Option<Vec<Launched<R::Span>>>>,
}

/// A launch of a profile.
pub(super) struct Launched<S> {
    pub(super) kernel: &'static str,
    pub(super) traffic: Traffic,
    pub(super) span: S,
}

impl<R: Runtime, P: Program> Queue<R, P> {
    /// Builds the kernels of a program.
    pub(super) fn new(runtime: R, program: P) -> Result<Self, Error> {
        let names = program.kernels();
        let built = runtime.build(&program.source(), &names)?;
        let kernels = names.into_iter().zip(built).collect();
        Ok(Queue { runtime, program, kernels, total: Arc::default(), record: RefCell::default() })
    }
    /// Bytes of all buffers together.
    pub(crate) fn bytes(&self) -> usize {
        self.total.load(Ordering::Relaxed)
    }
    /// A buffer whose content is not defined.
    pub(crate) fn buffer<T: InC>(&self, len: usize) -> Result<Buffer<T, R::Memory>, Error> {
        let memory = self.runtime.allocate((len * size_of::<T>()).max(1))?;
        self.total.fetch_add(len * size_of::<T>(), Ordering::Relaxed);
        let memory = Arc::new(memory);
        Ok(Buffer { memory, len, used: len, lodges: false, total: Arc::clone(&self.total), element: PhantomData })
    }
    /// A buffer that holds `values`.
    pub(crate) fn buffer_of<T: InC>(&self, values: &[T]) -> Result<Buffer<T, R::Memory>, Error> {
        let buffer = self.buffer(values.len())?;
        self.upload(&buffer, values)?;
        Ok(buffer)
    }
    /// A buffer of zeros.
    pub(crate) fn zeros<T: InC>(&self, len: usize) -> Result<Buffer<T, R::Memory>, Error> {
        let buffer = self.buffer(len)?;
        self.clear(&buffer, len)?;
        Ok(buffer)
    }
    pub(crate) fn upload<T: InC>(&self, buffer: &Buffer<T, R::Memory>, values: &[T]) -> Result<(), Error> {
        debug_assert!(values.len() <= buffer.len, "what is written has room");
        if values.is_empty() { Ok(()) } else { self.runtime.upload(&buffer.memory, bytemuck::cast_slice(values)) }
    }
    /// Fills the first `len` values with zeros.
    pub(crate) fn clear<T: InC>(&self, buffer: &Buffer<T, R::Memory>, len: usize) -> Result<(), Error> {
        if len == 0 { Ok(()) } else { self.runtime.clear(&buffer.memory, len * size_of::<T>()) }
    }
    /// Copies all values of a buffer to another of the same length.
    pub(crate) fn copy<T: InC>(&self, from: &Buffer<T, R::Memory>, to: &Buffer<T, R::Memory>) -> Result<(), Error> {
        debug_assert_eq!(from.len, to.len, "what is copied has room");
        if from.len == 0 { Ok(()) } else { self.runtime.copy(&from.memory, &to.memory, from.bytes()) }
    }
    /// Starts to bring the first `len` values to the host.
    pub(crate) fn fetch<T: InC>(&self, buffer: &Buffer<T, R::Memory>, len: usize) -> Result<Arriving<T, R>, Error> {
        let len = len.min(buffer.len);
        let transfer = if len == 0 { None } else { Some(self.runtime.fetch(&buffer.memory, len * size_of::<T>())?) };
        Ok(Arriving { transfer, element: PhantomData })
    }
    /// Waits for the first `len` values.
    pub(crate) fn read<T: InC>(&self, buffer: &Buffer<T, R::Memory>, len: usize) -> Result<Vec<T>, Error> {
        self.fetch(buffer, len)?.take()
    }
    /// Runs a kernel for at least so many work-items.
    pub(crate) fn run<C: Call<R::Memory, Program = P>>(&self, call: &C, items: usize) -> Result<(), Error> {
        self.run_groups(call, items.div_ceil(C::GROUP))
    }
    /// Runs a kernel in so many groups.
    pub(crate) fn run_groups<C: Call<R::Memory, Program = P>>(&self, call: &C, groups: usize) -> Result<(), Error> {
        let arguments: Vec<Argument<'_, R::Memory>> = call.arguments();
        let (kernel, groups) = (&self.kernels[C::NAME], groups.max(1));
        match &mut *self.record.borrow_mut() {
            None => self.runtime.launch(kernel, groups, C::GROUP, &arguments),
            Some(record) => {
                let span = self.runtime.launch_timed(kernel, groups, C::GROUP, &arguments)?;
                record.push(Launched { kernel: C::NAME, traffic: self.traffic(call), span });
                Ok(())
            }
        }
    }
    /// What a launch moves at least.
    pub(super) fn traffic<C: Call<R::Memory, Program = P>>(&self, call: &C) -> Traffic {
        call.traffic(&self.program)
    }
    /// From here on launches are timed and recorded.
    pub(super) fn begin_record(&mut self) -> Result<(), Error> {
        self.runtime.time_launches(true)?;
        *self.record.get_mut() = Some(Vec::new());
        Ok(())
    }
    /// Takes the last launches out of the record, if there is one: they did nothing.
    pub(super) fn forget_launches(&self, count: usize) {
        if let Some(record) = &mut *self.record.borrow_mut() {
            record.truncate(record.len() - count);
        }
    }
    /// What was launched since the record began, which ends here.
    pub(super) fn end_record(&mut self) -> Result<Vec<Launched<R::Span>>, Error> {
        let record = self.record.get_mut().take().unwrap_or_default();
        self.runtime.time_launches(false)?;
        Ok(record)
    }
    pub(crate) fn wait(&self) -> Result<(), Error> {
        self.runtime.wait()
    }
    pub(crate) fn flush(&self) -> Result<(), Error> {
        self.runtime.flush()
    }
}

/// Values on their way to the host.
pub(crate) struct Arriving<T, R: Runtime> {
    transfer: Option<R::Fetch>,
    element: PhantomData<fn() -> T>,
}

impl<T: InC, R: Runtime> Arriving<T, R> {
    /// Waits for them.
    pub(crate) fn take(mut self) -> Result<Vec<T>, Error> {
        Ok(self.view()?.to_vec())
    }
    /// The same, in the host memory where they arrive, which is aligned for every type.
    pub(crate) fn view(&mut self) -> Result<&[T], Error> {
        match &mut self.transfer {
            None => Ok(&[]),
            Some(transfer) => Ok(bytemuck::cast_slice(transfer.wait()?)),
        }
    }
}
