//! Checkpoints: the complete state, exact to the bit, in the safetensors format.
//!
//! A change of any byte of the file is found. Python reads the file with `safetensors.numpy.load_file`.

use crate::error::Error;
use crate::files::{remove, sync_folder, with_ending};
use crate::tensors::{self, Damage, Element, Reader, Tensor};
use rayon::prelude::*;
use std::fs;
use std::path::{Path, PathBuf};
use tdem_engine::physics::bond::Failure;
use tdem_engine::{Bond, BondHistory, Breakage, Contact, State, WallContact};
use thiserror::Error;

const ENDING: &str = "safetensors";
const FORMAT: &str = "tdem-checkpoint-1";
/// A checkpoint that was passed over.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("a checkpoint is damaged, {damage}: {}", path.display())]
pub struct Damaged {
    /// What is wrong with it.
    pub damage: Damage,
    /// Which it is.
    pub path: PathBuf,
}

/// Name of the checkpoint of a step, in the folder of checkpoints.
pub(crate) fn path_of(folder: &Path, step: u64) -> PathBuf {
    folder.join(format!("{step:012}.{ENDING}"))
}

/// Step of a checkpoint, from its name.
pub(crate) fn step_of(path: &Path) -> Option<u64> {
    path.file_stem()?.to_str()?.parse().ok()
}

/// Checkpoints in a folder, ascending by step.
pub(crate) fn list(folder: &Path) -> Result<Vec<PathBuf>, Error> {
    let mut paths = with_ending(folder, ENDING)?;
    paths.retain(|path| step_of(path).is_some());
    paths.sort_by_key(|path| step_of(path));
    Ok(paths)
}

/// Removes all checkpoints but the first, where the run began, and the last two.
pub(crate) fn thin_out(folder: &Path) -> Result<(), Error> {
    let paths = list(folder)?;
    let Some(superfluous) = paths.get(1..paths.len().saturating_sub(2)) else { return Ok(()) };
    superfluous.iter().try_for_each(|path| remove(path))?;
    if superfluous.is_empty() { Ok(()) } else { sync_folder(folder) }
}

/// The newest checkpoint that is whole, and those newer ones that are not.
pub(crate) struct Newest {
    pub(crate) state: Option<State>,
    pub(crate) path: Option<PathBuf>,
    pub(crate) damaged: Vec<Damaged>,
}

/// Looks for the newest checkpoint that can be trusted.
pub(crate) fn newest(folder: &Path) -> Result<Newest, Error> {
    let mut damaged = Vec::new();
    for path in list(folder)?.into_iter().rev() {
        match read(&path) {
            Ok(state) => return Ok(Newest { state: Some(state), path: Some(path), damaged }),
            Err(damage) => damaged.push(Damaged { damage, path }),
        }
    }
    Ok(Newest { state: None, path: None, damaged })
}

/// Writes the checkpoint of a state into a folder.
///
/// # Errors
/// [`Error::DiskFull`] and [`Error::Io`]; no half-written file stays behind.
pub fn write(folder: &Path, state: &State) -> Result<PathBuf, Error> {
    let path = path_of(folder, state.step);
    let apart = Apart::of(state);
    let tensors = tensors(state, &apart);
    tensors::write(&path, FORMAT, &tensors)?;
    Ok(path)
}

/// Reads a checkpoint, checks every hash, and that the numbers are those of a state: whatever is computed from it can rely on
/// lengths, ids and finite numbers.
///
/// # Errors
/// What is wrong with it.
pub fn read(path: &Path) -> Result<State, Damage> {
    let state = decode(&fs::read(path).map_err(|error| Damage::Inaccessible { kind: error.kind() })?)?;
    match step_of(path) {
        Some(step) if step != state.step => Err(Damage::Name { step: state.step }),
        _ => Ok(state),
    }
}

fn decode(bytes: &[u8]) -> Result<State, Damage> {
    let state = Reader::new(bytes, FORMAT)?.state()?;
    state.look_for_flaws()?;
    Ok(state)
}

/// What a state holds in another form than its tensors.
struct Apart {
    step: [u64; 1],
    initial_energy: [f64; 1],
    initial_heat: [f64; 1],
    forces_known: [u8; 1],
    pairs: Vec<[u32; 2]>,
    slips: Vec<[f64; 3]>,
    wall_pairs: Vec<[u32; 2]>,
    wall_slips: Vec<[f64; 3]>,
    bonds: Bonds,
}

/// The bonds of a state, field by field; a bond that holds broke in step 0, of nothing and with no energy.
struct Bonds {
    pairs: Vec<[u32; 2]>,
    strength: Vec<f64>,
    broken_at: Vec<u64>,
    failure: Vec<u8>,
    energy: Vec<f64>,
    histories: Vec<[f64; 10]>,
}

impl Bonds {
    fn of(state: &State) -> Self {
        let bonds = &state.bonds;
        let broken = |bond: &Bond| bond.breakage.map_or((0, 0, 0.0), |b| (b.step, b.failure.code() as u8, b.energy));
        Bonds {
            pairs: bonds.par_iter().map(|bond| [bond.first, bond.second]).collect(),
            strength: bonds.par_iter().map(|bond| bond.strength).collect(),
            broken_at: bonds.par_iter().map(|bond| broken(bond).0).collect(),
            failure: bonds.par_iter().map(|bond| broken(bond).1).collect(),
            energy: bonds.par_iter().map(|bond| broken(bond).2).collect(),
            histories: state.bond_histories.par_iter().map(numbers_of).collect(),
        }
    }
}

fn numbers_of(history: &BondHistory) -> [f64; 10] {
    let BondHistory { normal: n, tension, shear: s, couple: c } = *history;
    [n[0], n[1], n[2], tension, s[0], s[1], s[2], c[0], c[1], c[2]]
}

fn history_of([nx, ny, nz, tension, sx, sy, sz, cx, cy, cz]: [f64; 10]) -> BondHistory {
    BondHistory { normal: [nx, ny, nz], tension, shear: [sx, sy, sz], couple: [cx, cy, cz] }
}

impl Apart {
    fn of(state: &State) -> Self {
        let (contacts, walls) = (&state.contacts, &state.wall_contacts);
        Apart {
            step: [state.step],
            initial_energy: [state.initial_energy],
            initial_heat: [state.initial_heat],
            forces_known: [state.forces_known.into()],
            pairs: contacts.par_iter().map(|contact| [contact.first, contact.second]).collect(),
            slips: contacts.par_iter().map(|contact| contact.displacement).collect(),
            wall_pairs: walls.par_iter().map(|contact| [contact.particle, contact.wall]).collect(),
            wall_slips: walls.par_iter().map(|contact| contact.displacement).collect(),
            bonds: Bonds::of(state),
        }
    }
}

/// All fields of a state; those of bonds and of heat only where there are some. Wide numbers come first, so that every tensor is
/// aligned.
fn tensors<'a>(state: &'a State, apart: &'a Apart) -> Vec<Tensor<'a>> {
    // No `..`: a field that is added to the state must be added here.
    let State {
        step: _,
        forces_known: _,
        initial_energy: _,
        initial_heat: _,
        id,
        material,
        constraint,
        radius,
        mass,
        position,
        image,
        velocity,
        angular_velocity,
        force,
        moment,
        orientation,
        bonded_position,
        derivatives,
        accounts,
        wall_position,
        contacts: _,
        wall_contacts: _,
        bonds,
        bond_histories: _,
        temperature,
        heat_rate,
        exposure,
        reference_radius,
        heat_accounts,
        work_per_kelvin,
    } = state;
    let of_bonds = &apart.bonds;
    let mut tensors = vec![
        Tensor::new("step", &apart.step),
        Tensor::new("initial_energy", &apart.initial_energy),
        Tensor::new("radius", radius),
        Tensor::new("mass", mass),
        Tensor::new("position", position),
        Tensor::new("velocity", velocity),
        Tensor::new("angular_velocity", angular_velocity),
        Tensor::new("force", force),
        Tensor::new("moment", moment),
        Tensor::new("derivatives", derivatives),
        Tensor::new("accounts", accounts),
        Tensor::new("wall_position", wall_position),
        Tensor::new("contacts.displacement", &apart.slips),
        Tensor::new("wall_contacts.displacement", &apart.wall_slips),
    ];
    if !bonds.is_empty() {
        tensors.extend([
            Tensor::new("orientation", orientation),
            Tensor::new("bonded_position", bonded_position),
            Tensor::new("bonds.strength", &of_bonds.strength),
            Tensor::new("bonds.broken_at", &of_bonds.broken_at),
            Tensor::new("bonds.energy", &of_bonds.energy),
            Tensor::new("bonds.history", &of_bonds.histories),
        ]);
    }
    if !temperature.is_empty() {
        tensors.extend([
            Tensor::new("initial_heat", &apart.initial_heat),
            Tensor::new("temperature", temperature),
            Tensor::new("heat_rate", heat_rate),
            Tensor::new("reference_radius", reference_radius),
            Tensor::new("heat_accounts", heat_accounts),
            Tensor::new("work_per_kelvin", work_per_kelvin),
        ]);
    }
    tensors.extend([
        Tensor::new("id", id),
        Tensor::new("image", image),
        Tensor::new("contacts.pair", &apart.pairs),
        Tensor::new("wall_contacts.pair", &apart.wall_pairs),
    ]);
    if !bonds.is_empty() {
        tensors.push(Tensor::new("bonds.pair", &of_bonds.pairs));
    }
    tensors.extend([Tensor::new("material", material), Tensor::new("constraint", constraint)]);
    if !temperature.is_empty() {
        tensors.push(Tensor::new("exposure", exposure));
    }
    tensors.push(Tensor::new("forces_known", &apart.forces_known));
    if !bonds.is_empty() {
        tensors.push(Tensor::new("bonds.failure", &of_bonds.failure));
    }
    tensors
}

/// A state from the tensors of its checkpoint.
impl Reader<'_> {
    fn contacts<C>(
        &self,
        pair: &'static str,
        displacement: &'static str,
        make: impl Fn([u32; 2], [f64; 3]) -> C,
    ) -> Result<Vec<C>, Damage> {
        let (pairs, displacements) = (self.rows::<[u32; 2]>(pair)?, self.rows::<[f64; 3]>(displacement)?);
        if pairs.len() != displacements.len() {
            return Err(Damage::Layout { tensor: pair });
        }
        Ok(pairs.into_iter().zip(displacements).map(|(pair, displacement)| make(pair, displacement)).collect())
    }

    /// A tensor of bonds, which a checkpoint without any lacks.
    fn of_bonds<T: Element>(&self, tensor: &'static str) -> Result<Vec<T>, Damage> {
        if self.has("bonds.pair") { self.rows(tensor) } else { Ok(Vec::new()) }
    }
    /// A tensor of heat, which a checkpoint without heat lacks.
    fn of_heat<T: Element>(&self, tensor: &'static str) -> Result<Vec<T>, Damage> {
        if self.has("temperature") { self.rows(tensor) } else { Ok(Vec::new()) }
    }
    fn bonds(&self) -> Result<Vec<Bond>, Damage> {
        let pairs = self.of_bonds::<[u32; 2]>("bonds.pair")?;
        let strength = self.of_bonds::<f64>("bonds.strength")?;
        let broken_at = self.of_bonds::<u64>("bonds.broken_at")?;
        let failure = self.of_bonds::<u8>("bonds.failure")?;
        let energy = self.of_bonds::<f64>("bonds.energy")?;
        if [strength.len(), broken_at.len(), failure.len(), energy.len()] != [pairs.len(); 4] {
            return Err(Damage::Layout { tensor: "bonds.pair" });
        }
        let bond = |k: usize| {
            let [first, second] = pairs[k];
            let breakage = match (broken_at[k], Failure::of_code(failure[k].into())) {
                (0, None) => None,
                (step @ 1.., Some(failure)) => Some(Breakage { step, failure, energy: energy[k] }),
                _ => return Err(Damage::Layout { tensor: "bonds.failure" }),
            };
            Ok(Bond { first, second, strength: strength[k], breakage })
        };
        (0..pairs.len()).map(bond).collect()
    }

    fn state(&self) -> Result<State, Damage> {
        Ok(State {
            step: self.one("step")?,
            forces_known: self.one::<u8>("forces_known")? != 0,
            initial_energy: self.one("initial_energy")?,
            initial_heat: if self.has("temperature") { self.one("initial_heat")? } else { 0.0 },
            id: self.rows("id")?,
            material: self.rows("material")?,
            constraint: self.rows("constraint")?,
            radius: self.rows("radius")?,
            mass: self.rows("mass")?,
            position: self.rows("position")?,
            image: self.rows("image")?,
            velocity: self.rows("velocity")?,
            angular_velocity: self.rows("angular_velocity")?,
            force: self.rows("force")?,
            moment: self.rows("moment")?,
            orientation: self.of_bonds("orientation")?,
            bonded_position: self.of_bonds("bonded_position")?,
            derivatives: self.rows("derivatives")?,
            accounts: self.rows("accounts")?,
            wall_position: self.rows("wall_position")?,
            contacts: self.contacts("contacts.pair", "contacts.displacement", |[first, second], displacement| {
                Contact { first, second, displacement }
            })?,
            wall_contacts: self.contacts(
                "wall_contacts.pair",
                "wall_contacts.displacement",
                |[particle, wall], displacement| WallContact { particle, wall, displacement },
            )?,
            bonds: self.bonds()?,
            bond_histories: self.of_bonds("bonds.history")?.into_iter().map(history_of).collect(),
            temperature: self.of_heat("temperature")?,
            heat_rate: self.of_heat("heat_rate")?,
            exposure: self.of_heat("exposure")?,
            reference_radius: self.of_heat("reference_radius")?,
            heat_accounts: self.of_heat("heat_accounts")?,
            work_per_kelvin: self.of_heat("work_per_kelvin")?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Particles, with all that they have without bonds and heat.
    fn particles(id: Vec<u32>) -> State {
        let count = id.len();
        State {
            step: 12,
            initial_energy: 0.25,
            material: (0..count as u16).collect(),
            constraint: vec![0; count],
            radius: vec![1e-3; count],
            mass: vec![2e-3; count],
            position: vec![[0.1, -0.0, 0.3]; count],
            image: vec![[0, -1, 1]; count],
            velocity: vec![[0.5; 3]; count],
            angular_velocity: vec![[-1.0, 0.0, 2.0]; count],
            force: vec![[0.25; 3]; count],
            moment: vec![[0.125; 3]; count],
            id,
            ..State::default()
        }
    }

    #[test]
    fn a_change_of_any_byte_is_found() {
        let state = State {
            derivatives: vec![[[1.0; 3]; 4]; 2],
            contacts: vec![Contact { first: 0, second: 1, displacement: [1.0, 2.0, 3.0] }],
            ..particles(vec![0, 1])
        };
        every_change_is_found(&state);
        assert!(tensors(&state, &Apart::of(&state)).iter().all(|tensor| !tensor.name.contains("bond")));
    }

    /// Two bonds between three particles, one of them broken.
    fn bonded() -> State {
        let breakage = Some(Breakage { step: 7, failure: Failure::Shear, energy: 1e-3 });
        let history = BondHistory { normal: [1.0, 2.0, 3.0], tension: 4.0, shear: [5.0, 6.0, 7.0], couple: [8.0; 3] };
        State {
            orientation: vec![[0.0, 0.0, 0.6, 0.8]; 3],
            bonded_position: vec![[0.1, 0.2, 0.3]; 3],
            bonds: vec![Bond::new(0, 1, 0.75), Bond { breakage, ..Bond::new(1, 5, 1.0) }],
            bond_histories: vec![history, BondHistory::default()],
            ..particles(vec![0, 1, 5])
        }
    }

    #[test]
    fn a_change_of_any_byte_of_bonds_is_found() {
        every_change_is_found(&bonded());
    }

    /// Particles with heat.
    fn heated(state: State) -> State {
        State {
            temperature: vec![293.15, 400.0, 1e3],
            heat_rate: vec![0.0, -1.5, 2.0],
            exposure: vec![0, 1, 2],
            reference_radius: vec![1e-3; 3],
            heat_accounts: vec![[1.0, 2.0, 3.0, -4.0]; 3],
            work_per_kelvin: vec![0.5, -0.25, 0.125],
            ..state
        }
    }

    #[test]
    fn a_change_of_any_byte_of_heat_is_found() {
        every_change_is_found(&heated(particles(vec![0, 1, 5])));
    }

    /// A state that has something in every tensor.
    fn full() -> State {
        State {
            accounts: vec![[0.0; 4]; 3],
            derivatives: vec![[[1.0; 3]; 4]; 3],
            wall_position: vec![[0.0; 3]; 2],
            contacts: vec![Contact { first: 0, second: 1, displacement: [1e-6; 3] }],
            wall_contacts: vec![WallContact { particle: 5, wall: 1, displacement: [1e-6; 3] }],
            ..heated(bonded())
        }
    }

    /// A tensor as the file has it.
    struct Part {
        name: String,
        kind: String,
        shape: Vec<usize>,
        bytes: Vec<u8>,
    }

    fn parts(state: &State) -> Vec<Part> {
        let apart = Apart::of(state);
        tensors(state, &apart)
            .iter()
            .map(Tensor::parts)
            .map(|(n, k, s, b)| Part { name: n, kind: k, shape: s, bytes: b })
            .collect()
    }

    /// The file of such tensors, with all hashes as they should be.
    fn file_of(parts: &[Part]) -> Vec<u8> {
        tensors::file(
            FORMAT,
            parts.iter().map(|part| (part.name.as_str(), part.kind.as_str(), &part.shape[..], &part.bytes[..])),
        )
    }

    /// That a file with right hashes is refused, and the tensor named.
    fn refused(parts: &[Part], name: &str, how: &str) {
        match decode(&file_of(parts)) {
            Err(damage) => assert!(damage.to_string().contains(name), "{how} `{name}`: {damage}"),
            Ok(_) => panic!("{how} `{name}` was taken"),
        }
    }

    #[test]
    fn a_crafted_tensor_of_another_length_is_refused_by_its_name() {
        let whole = parts(&full());
        assert_eq!(decode(&file_of(&whole)), Ok(full()));
        // Without these there are none of their kind; any length of walls is one.
        let kinds = ["bonds.pair", "temperature"];
        for (index, part) in whole.iter().enumerate() {
            let rows = part.shape[0];
            let row = part.bytes.len() / rows;
            let changed = |rows_now: usize| {
                let mut parts = parts(&full());
                parts[index].shape[0] = rows_now;
                parts[index].bytes = part.bytes.iter().copied().cycle().take(rows_now * row).collect();
                parts
            };
            for rows_now in [rows + 1, 2 * rows, rows - 1, 0].into_iter().filter(|&now| now != rows) {
                let parts = changed(rows_now);
                // None at all is what a model without them has.
                let optional = [
                    "derivatives",
                    "accounts",
                    "reference_radius",
                    "heat_accounts",
                    "work_per_kelvin",
                    "bonds.history",
                ];
                if rows_now == 0 && optional.contains(&part.name.as_str()) {
                    assert!(decode(&file_of(&parts)).is_ok(), "{}", part.name);
                } else if part.name == "id" || part.name.starts_with("wall") || kinds.contains(&part.name.as_str()) {
                    // Others then do not belong to it.
                    assert!(decode(&file_of(&parts)).is_err() || part.name == "wall_position", "{}", part.name);
                } else if !(part.name.contains("contacts") || part.name.starts_with("bonds.")) {
                    refused(&parts, &part.name, "another length of");
                } else {
                    assert!(decode(&file_of(&parts)).is_err(), "{}", part.name);
                }
            }
            let mut parts = parts(&full());
            parts[index].shape.push(1);
            refused(&parts, &part.name, "another shape of");
            parts.remove(index);
            let left = decode(&file_of(&parts));
            assert!(left.is_err() || kinds.contains(&part.name.as_str()), "without `{}`", part.name);
        }
    }

    #[test]
    fn crafted_numbers_that_are_none_are_refused_by_their_name() {
        let positive = ["radius", "mass", "temperature", "reference_radius", "bonds.strength"];
        let whole = parts(&full());
        let mut tried = 0;
        for (index, part) in whole.iter().enumerate().filter(|(_, part)| part.kind == "F64") {
            let count = part.bytes.len() / 8;
            let mut values = vec![f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, -1e200];
            if positive.contains(&part.name.as_str()) {
                values.extend([0.0, -1.0, -0.0, f64::MIN_POSITIVE]);
            }
            if part.name == "orientation" {
                values.extend([1e3, -7.0]);
            }
            for (place, value) in
                [0, count / 2, count - 1].into_iter().flat_map(|place| values.iter().map(move |v| (place, *v)))
            {
                if part.name == "bonds.energy" && place == 0 {
                    // A bond that holds has none, whatever stands there.
                    continue;
                }
                let mut parts = parts(&full());
                parts[index].bytes[8 * place..][..8].copy_from_slice(&value.to_le_bytes());
                refused(&parts, &part.name, &format!("{value} in"));
                tried += 1;
            }
        }
        assert!(tried > 200, "{tried}");
    }

    #[test]
    fn crafted_ids_that_do_not_exist_are_refused_by_their_name() {
        for name in ["id", "contacts.pair", "wall_contacts.pair", "bonds.pair"] {
            for wrong in [3_u32, 77, u32::MAX] {
                let mut parts = parts(&full());
                let part = parts.iter_mut().find(|part| part.name == name).unwrap();
                part.bytes[..4].copy_from_slice(&wrong.to_le_bytes());
                refused(&parts, name, "an unknown id in");
            }
        }
        let mut parts = parts(&full());
        let part = parts.iter_mut().find(|part| part.name == "bonds.broken_at").unwrap();
        part.bytes[8..].copy_from_slice(&u64::MAX.to_le_bytes());
        refused(&parts, "bonds.broken_at", "a later step in");
    }

    #[test]
    fn a_shape_that_is_larger_than_the_file_is_refused_before_room_is_made() {
        for huge in [1 << 40, usize::MAX / 8, usize::MAX] {
            for index in 0..parts(&full()).len() {
                let mut parts = parts(&full());
                parts[index].shape[0] = huge;
                assert!(decode(&file_of(&parts)).is_err(), "{}", parts[index].name);
            }
        }
    }

    #[test]
    fn a_checkpoint_under_the_name_of_another_step_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = write(folder.path(), &full()).unwrap();
        let other = path_of(folder.path(), 99);
        fs::rename(&path, &other).unwrap();
        assert_eq!(read(&other), Err(Damage::Name { step: 12 }));
        let unnamed = folder.path().join("last.safetensors");
        fs::rename(&other, &unnamed).unwrap();
        assert_eq!(read(&unnamed), Ok(full()));
    }

    fn every_change_is_found(state: &State) {
        let folder = tempfile::tempdir().unwrap();
        let good = fs::read(write(folder.path(), state).unwrap()).unwrap();
        assert_eq!(decode(&good).as_ref(), Ok(state));
        for place in 0..good.len() {
            // Every bit, and a space that becomes another kind of white space.
            for change in [1, 2, 4, 8, 16, 32, 64, 128, 0x2d] {
                let mut bad = good.clone();
                bad[place] ^= change;
                assert!(decode(&bad).is_err(), "byte {place} changed by {change:#x}");
            }
        }
        for length in 0..good.len() {
            assert!(decode(&good[..length]).is_err(), "cut off at {length}");
        }
        assert!(decode(&[good.as_slice(), b"x"].concat()).is_err(), "a byte too many");
    }

    #[test]
    fn the_first_and_the_last_two_checkpoints_are_kept() {
        let folder = tempfile::tempdir().unwrap();
        for step in [5, 10, 100, 1_000_000_000_000, 1_000_000_000_001] {
            write(folder.path(), &State { step, ..State::default() }).unwrap();
            thin_out(folder.path()).unwrap();
        }
        let steps: Vec<Option<u64>> = list(folder.path()).unwrap().iter().map(|path| step_of(path)).collect();
        assert_eq!(steps, [Some(5), Some(1_000_000_000_000), Some(1_000_000_000_001)]);
    }
}
