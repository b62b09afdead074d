//! All that can go wrong behind a case that is right, by code: what it means, and what to do. What can be wrong with a case
//! is in [`mod@tdem_case::codes`]. `docs/errors.md` is made from both.

tdem_case::codes! {
    /// `tdem bench contact --cells` takes three numbers.
    ///
    /// Write them with commas and without spaces, such as `--cells 20,20,40`.
    error BENCH_CELLS = "tdem::bench::cells";

    /// A benchmark broke: the engine found a fault, or a device failed.
    ///
    /// The message tells which. See whether the case runs with `tdem run`, and whether `tdem info` calls the device usable.
    error BENCH_FAULT = "tdem::bench::fault";

    /// Measurements cannot be written as JSON. A number among them is not finite, which no measurement should be.
    ///
    /// Please report it with the command.
    error BENCH_JSON = "tdem::bench::json";

    /// Measurements that shall be drawn again cannot be read, or are not of `tdem bench --paper-figures`.
    ///
    /// Give the folder with the `bench.json` that it wrote with `--out`.
    error BENCH_RECORD = "tdem::bench::record";

    /// The specimen does not break: its load did not fall to half of its greatest.
    ///
    /// Tensile and shear strength that are less far apart let it break.
    error CALIBRATE_DOES_NOT_BREAK = "tdem::calibrate::does-not-break";

    /// The engine found a fault while the specimen was pulled or pressed.
    ///
    /// See whether the case runs with `tdem run`.
    error CALIBRATE_FAULT = "tdem::calibrate::fault";

    /// Particles hang by so little that no state of rest is found.
    ///
    /// Raise the `gap` of the `[[bond]]`, so that more of them are bonded.
    error CALIBRATE_LOOSE = "tdem::calibrate::loose";

    /// The case bonds nothing, so that there is nothing to calibrate.
    ///
    /// Take a case with `[[bond]]`, whose particles are near enough to each other.
    error CALIBRATE_NOT_BONDED = "tdem::calibrate::not-bonded";

    /// Bonds do not lead from one end of the specimen to the other.
    ///
    /// Raise the `gap` of the `[[bond]]`, pack closer, or test along another `--axis`.
    error CALIBRATE_NOT_SPANNING = "tdem::calibrate::not-spanning";

    /// The domain repeats. A specimen has ends that are held and sides that are free.
    ///
    /// Take `periodic` out of the `[domain]`, with walls in its place.
    error CALIBRATE_PERIODIC = "tdem::calibrate::periodic";

    /// No bonds give this packing the Poisson's ratio that was asked for.
    ///
    /// Ask for one in the range that the message tells. Other packings, or a larger `gap`, have other ranges.
    error CALIBRATE_POISSON = "tdem::calibrate::poisson-out-of-reach";

    /// The specimen is of several materials, and only one can be calibrated.
    ///
    /// Calibrate each material on a case of its own.
    error CALIBRATE_SEVERAL_MATERIALS = "tdem::calibrate::several-materials";

    /// Bonds are unbreakable, so that there is no strength to find.
    ///
    /// Give the `[[bond]]` a `tensile_strength` and a `shear_strength`: their ratio is kept.
    error CALIBRATE_UNBREAKABLE = "tdem::calibrate::unbreakable";

    /// `tdem new` would overwrite a file.
    ///
    /// Choose another name; no case is ever overwritten.
    error FILE_EXISTS = "tdem::cli::file-exists";

    /// A run needs more memory than is free on this machine. It is begun all the same.
    ///
    /// Take fewer particles, a model without moments, or `output.ledger = false`; or a larger machine. `tdem check` tells what
    /// a case takes.
    warning MEMORY = "tdem::cli::memory";

    /// Standard output cannot be written, as when it leads into a file on a full disk.
    ///
    /// Look at where it leads.
    error OUTPUT = "tdem::cli::output";

    /// The operating system does not let signals be caught, without which an interrupted run could not write its last
    /// checkpoint.
    ///
    /// Nothing in a case causes this: look at how the program is started, in a container for instance.
    error SIGNALS = "tdem::cli::signals";

    /// The operating system refuses to start threads.
    ///
    /// Ask for fewer, `--threads 1`, or raise its limit (`ulimit -u`).
    error CLI_THREADS = "tdem::cli::threads";

    /// There is no such code.
    ///
    /// `tdem explain` without a code lists all.
    error UNKNOWN_CODE = "tdem::cli::unknown-code";

    /// A file or a folder cannot be written.
    ///
    /// Look at whether the folder exists and may be written, and whether the disk is full.
    error WRITE = "tdem::cli::write";

    /// A call to the device failed while it computed.
    ///
    /// Most often the device or its driver has failed, or another program has taken the device down: `tdem info` tests it.
    /// `tdem resume DIR --device cpu` goes on from the last checkpoint, to the same bits.
    error DEVICE_CALL = "tdem::device::call";

    /// The compiler of the device does not take the kernels.
    ///
    /// No case should cause this. Please report it with what the compiler said, the lines of `tdem info`, and the output of
    /// `tdem kernels CASE.toml`. `--device cpu` works everywhere, with the same bits.
    error DEVICE_COMPILE = "tdem::device::compile";

    /// The device that was asked for is not there, or cannot be used: its library is missing, it has no 64-bit reals, or its
    /// arithmetic does not agree with that of the CPU to the last bit.
    ///
    /// `tdem info` lists the devices that there are, and why some cannot be used. `--device cpu` works everywhere, with the
    /// same bits.
    error DEVICE_MISSING = "tdem::device::missing";

    /// The device has no room for the case.
    ///
    /// `tdem check` tells how much memory a case takes, `tdem info` how much a device has; other programs may hold some of
    /// it. Take fewer particles, a model without moments, `output.ledger = false`, or another device.
    error OUT_OF_MEMORY = "tdem::device::out-of-memory";

    /// Rungs of a ladder are not of the same particles and bonds.
    ///
    /// No case should cause this: please report it with the case and the command.
    error LADDER_DIFFERENT = "tdem::ladder::different";

    /// The folder holds a ladder already.
    ///
    /// Go on with it (`--resume`), replace it (`--overwrite`), or keep both (`--out DIR`).
    error LADDER_EXISTS = "tdem::ladder::exists";

    /// The run of a rung found a fault, which is told above it. Rungs that are complete are kept and compared.
    ///
    /// `tdem run` shows how far the case gets by itself.
    error LADDER_FAULT = "tdem::ladder::fault";

    /// Something is prescribed over the time of the motion, a moving wall or a ramp. On each rung the motion takes twice as
    /// long, so that the rungs would not be of the same case.
    ///
    /// Hold it still or make it constant, with `--set` if only for this. Constant forces and gravity may be there.
    error LADDER_FOLLOWS_MOTION = "tdem::ladder::follows-motion";

    /// The case has no heat.
    ///
    /// Take a case with a table `[heat]`, such as `cases/heating.toml`.
    error LADDER_NO_HEAT = "tdem::ladder::no-heat";

    /// Heat does not go faster than motion, so that there is no acceleration whose price could be found.
    ///
    /// Give the heat a `time_scale` above 1, or a `duration` longer than `time.end`.
    error LADDER_NOT_ACCELERATED = "tdem::ladder::not-accelerated";

    /// The folder of a rung is of another case, of other settings or of another version.
    ///
    /// Begin anew (`--overwrite` in place of `--resume`), or keep both (`--out DIR`).
    error LADDER_OTHER_CASE = "tdem::ladder::other-case";

    /// A rung would take a time that a case cannot have.
    ///
    /// Ask for fewer rungs with `--rungs`.
    error LADDER_OUT_OF_RANGE = "tdem::ladder::out-of-range";

    /// The case is refused as it stands on one of the rungs, for what is told above it.
    ///
    /// Mend that, or ask for fewer rungs with `--rungs`.
    error LADDER_REFUSED = "tdem::ladder::refused";

    /// On the last rung heat would go slower than it does by itself.
    ///
    /// Ask for fewer rungs with `--rungs`: each halves the pace.
    error LADDER_TOO_MANY_RUNGS = "tdem::ladder::too-many-rungs";

    /// The `case.toml` of a run is not that which ran: some of its values were changed since. Comments and the order of keys do not
    /// count.
    ///
    /// Put the old values back, which the message names and `checkpoints/case.toml` holds; or go on with the new ones, `tdem resume
    /// DIR --accept-changes`: what was written so far stays as it is. To run longer, `--steps N` is enough; to run the changed case
    /// from its start, give it to `tdem run`.
    error CASE_CHANGED = "tdem::results::case-changed";

    /// Whether the case of a run was changed since it ran is not known: the run has no `checkpoints/case.toml`, as those of version
    /// 0.1.0, or it cannot be read.
    ///
    /// See whether `case.toml` is as it was. From here on a change is noticed.
    warning CASE_UNKNOWN = "tdem::results::case-unknown";

    /// The case of a run was changed since it ran, and `tdem resume --accept-changes` goes on with what it says now. Checkpoints,
    /// frames and rows so far are those of the case as it was.
    ///
    /// Nothing need be done. `log.txt` keeps what was changed.
    warning CHANGES_ACCEPTED = "tdem::results::changes-accepted";

    /// A curve of the case could not be drawn: the history has no such column, or no finite number in it. The run is whole
    /// without it.
    ///
    /// Look at the column in `history.csv`; `tdem report DIR` draws curves anew.
    warning CURVE = "tdem::results::curve";

    /// A checkpoint does not have the contents that it was written with.
    ///
    /// The one before it is used, and steps since then are computed again, to the same bits. Look at the disk if it happens
    /// again.
    warning DAMAGED_CHECKPOINT = "tdem::results::damaged-checkpoint";

    /// Rows of `history.csv` are not as they were written, or not there any more. Rows that are good stay.
    ///
    /// What was found is kept in `history.damaged.csv`, where a line may be mended by hand. Rows that are missing come back only by
    /// running the case again. Look at the disk if it happens again.
    warning DAMAGED_HISTORY = "tdem::results::damaged-history";

    /// The disk is full. Nothing is left half-written.
    ///
    /// Free some space, then `tdem resume DIR`. `tdem check` tells what a case writes; fewer frames, or none of contacts and
    /// bonds, are smaller.
    error DISK_FULL = "tdem::results::disk-full";

    /// A file would be longer than the process may make it. Nothing is left half-written.
    ///
    /// Raise the limit in the shell or the batch system (`ulimit -f unlimited`), then `tdem resume DIR`.
    error FILE_TOO_LARGE = "tdem::results::file-too-large";

    /// A file cannot be written or understood as HDF5: it is cut off, or of another program.
    ///
    /// Frames are written whole or not at all, so that the file was changed since. Remove it; the other frames are whole.
    error FORMAT = "tdem::results::format";

    /// The columns of `history.csv` are not those that this version writes, so that no rows can be added.
    ///
    /// Run the case again, or go on with the version that began it.
    error HISTORY_COLUMNS = "tdem::results::history-columns";

    /// The operating system does not let a file of a run be written or read.
    ///
    /// The message tells what was tried and why it failed. Look at whether the path exists, may be written, and the disk is
    /// there.
    error IO = "tdem::results::io";

    /// A symbolic link, or a device, stands where a run writes a file or a folder of its own. A run that comes from elsewhere
    /// could lead to any file of yours by it, so that nothing is written.
    ///
    /// Remove the link. To keep a run on another disk, link its whole directory, not what is in it.
    error LINKED = "tdem::results::linked";

    /// Another process works in the directory of the run.
    ///
    /// Wait for it, or stop it. A process that has ended holds no lock, however it ended.
    error LOCKED = "tdem::results::locked";

    /// The run has no checkpoint that can be used.
    ///
    /// Run the case again; the same case gives the same bits.
    error NO_CHECKPOINT = "tdem::results::no-checkpoint";

    /// The run has no frames, or none of the step that was asked for.
    ///
    /// A case writes frames unless it says `output.frames = 0`; `tdem info` lists those that there are.
    error NO_FRAMES = "tdem::results::no-frames";

    /// None of the frames of the run can be used: they are damaged or gone.
    ///
    /// Run the case again; the same case gives the same bits.
    error NO_GOOD_FRAME = "tdem::results::no-good-frame";

    /// A directory is not that of a run: there is no `case.toml` in it.
    ///
    /// Name the directory that `tdem run` made; without `--out` it is `runs/` and the name of the case file.
    error NOT_A_RUN = "tdem::results::not-a-run";

    /// The directory holds files that are not a run's. They are left alone, also with `--overwrite`.
    ///
    /// Choose another directory with `--out`.
    error OCCUPIED = "tdem::results::occupied";

    /// The last checkpoint does not belong to the case of the run.
    ///
    /// A table or a run that the case names has changed since, or the case was edited: put the old one back, or run the case
    /// again.
    error RESULTS_OTHER_CASE = "tdem::results::other-case";

    /// A picture cannot be compressed.
    ///
    /// Nothing in a case causes this: please report it with the command.
    error PICTURE = "tdem::results::picture";

    /// A picture has no pixels, or more than there is memory to draw.
    ///
    /// Between 1 and 16,384 are possible in each direction. Drawing takes some 45 bytes for each pixel: ask for fewer with
    /// `--size`, or `size` of the `[[picture]]`.
    error PICTURE_SIZE = "tdem::results::picture-size";

    /// The page about the run could not be written. The run is whole without it.
    ///
    /// `tdem report DIR` writes it anew, from what lies in the directory.
    warning REPORT = "tdem::results::report";

    /// The directory holds a run already.
    ///
    /// Go on with it (`tdem resume DIR`), replace it (`--overwrite`), or keep both (`--out DIR`).
    error RUN_EXISTS = "tdem::results::run-exists";

    /// Where particles were at the start of the run is not known any more: `start.safetensors` and the checkpoint of step 0 are
    /// damaged or gone.
    ///
    /// The run goes on. `displacement` is not a number in frames from here on; it is there in those before. Put one of the files
    /// back if you have a copy, then resume.
    warning START_LOST = "tdem::results::start-lost";

    /// A frame does not have the bytes that it was written with, is gone, or cannot be read, so that `particles.vtkhdf` and its
    /// like go on without it, and say so; or the list of frames, `frames.csv`, was changed itself.
    ///
    /// The run goes on. If you have a copy of the file, put it back; else only running the case again brings the frame back.
    /// `xxh128sum` finds the sums that `frames.csv` lists.
    warning UNREADABLE_FRAME = "tdem::results::unreadable-frame";

    /// The domain repeats in a direction in which it is shorter than twice the distance of neighbours, so that a particle
    /// would meet two images of another.
    ///
    /// Make it longer, or do not let this direction repeat.
    error BOX_TOO_SMALL = "tdem::run::box-too-small";

    /// The temperatures at the end of an implicit step of the heat were not found.
    ///
    /// Make `heat.step` shorter. Properties that change greatly within a few kelvin, and radiation that is far out of balance,
    /// make it hard.
    error CONDUCTION = "tdem::run::conduction";

    /// A particle left the domain in a direction that does not repeat.
    ///
    /// Where it may fly, enlarge the domain; where a wall should have held it, the time step is too large (`tdem check` shows
    /// the limits), or something was prescribed that pushes particles through walls.
    error ESCAPED = "tdem::run::escaped";

    /// The state and the plan of a run do not belong together. A case cannot cause this.
    ///
    /// Please report it with the case.
    error INCONSISTENT = "tdem::run::inconsistent";

    /// In some row of the history a pair of particles overlapped by 5 % of its mean radius or more. The law of contact is one of
    /// small overlaps: with more, contacts are too soft, contact spots too large, and the volume of what overlaps is lost.
    ///
    /// Raise `young_modulus`, or lower what presses the particles together. Where only the way to rest is soft, it is harmless.
    warning LARGE_OVERLAP = "tdem::run::large-overlap";

    /// The list of neighbours would be longer than 32 bits can count.
    ///
    /// Take fewer particles, or a smaller `search.skin`. Sizes that differ greatly make lists long.
    error LIST_OVERFLOW = "tdem::run::list-overflow";

    /// The position of a particle is no longer a number: the simulation diverged.
    ///
    /// Most often the time step is too large (`tdem check` shows the limits), or something was prescribed that pushes
    /// particles into each other.
    error NOT_FINITE = "tdem::run::not-finite";

    /// Two particles overlap by more than `contact.overlap_limit` of the smaller radius, or a particle and a wall by more than
    /// that of the particle's, beyond what the law of contact is for.
    ///
    /// Most often the time step is too large (`tdem check` shows the limits), a load is too large for particles this soft, or
    /// something was prescribed that pushes particles into each other.
    error OVERLAP = "tdem::run::overlap";

    /// A temperature is not above absolute zero, or not a number.
    ///
    /// The time scale of the heat is too large for this step, or the surroundings are hotter than an explicit step can take:
    /// lower one of them, or `heat.step`.
    error TEMPERATURE = "tdem::run::temperature";

    /// The operating system refuses to start the threads of the engine.
    ///
    /// Ask for fewer, `--threads 1`, or raise its limit (`ulimit -u`).
    error RUN_THREADS = "tdem::run::threads";

    /// An energy or a temperature over all particles is infinite or not a number: the simulation diverged.
    ///
    /// Most often the time step is too large (`tdem check` shows the limits), or a value of the case is beyond all that can be
    /// computed with.
    error UNBOUNDED = "tdem::run::unbounded";

    /// Motion and heat took turns, and behind some steps of the heat particles did not come to rest within the steps that they
    /// had. Heat went on all the same.
    ///
    /// Where the largest ratio of forces is small, this is harmless; else raise `heat.relaxation.at_most_steps`, or take
    /// shorter steps of the heat. Cracks that run need time.
    warning UNRELAXED = "tdem::run::unrelaxed";

    /// No case and no group of the verification has this name.
    ///
    /// `tdem verify --list` shows all.
    error UNKNOWN_NAME = "tdem::verify::unknown-name";
}
