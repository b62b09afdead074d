//! A hash of a state that does not depend on the order of its records.

use super::{State, energy_accounts};
use crate::heat_accounts;
use rayon::prelude::*;
use xxhash_rust::xxh3::{xxh3_64, xxh3_128};

/// Names of the columns of [`State::accounts`] and [`State::heat_accounts`].
const ACCOUNTS: [(&str, usize); 4] = [
    ("friction_dissipated", energy_accounts::FRICTION),
    ("damping_dissipated", energy_accounts::DAMPING),
    ("stiffening_work", energy_accounts::STIFFENING),
    ("external_work", energy_accounts::EXTERNAL),
];
const HEAT_ACCOUNTS: [(&str, usize); 4] = [
    ("heat_in", heat_accounts::IN),
    ("heat_out", heat_accounts::OUT),
    ("heat_made", heat_accounts::MADE),
    ("expansion_work", heat_accounts::EXPANSION),
];

/// Named numbers of a thing with a key, as bytes to hash.
#[derive(Default)]
struct Record(Vec<u8>);

impl Record {
    /// The record of a thing of some kind; all things of a kind have keys of the same length.
    fn of(mut self, kind: &str, key: &[u64]) -> Self {
        self.0.clear();
        self.word(xxh3_64(kind.as_bytes()));
        for &word in key {
            self.word(word);
        }
        self
    }
    fn word(&mut self, word: u64) {
        self.0.extend_from_slice(&word.to_le_bytes());
    }
    /// Adds the integers of a quantity that are not zero.
    fn integers(&mut self, name: &str, numbers: impl IntoIterator<Item = u64>) {
        let name = xxh3_64(name.as_bytes());
        for (place, number) in numbers.into_iter().enumerate().filter(|&(_, number)| number != 0) {
            self.word(name.wrapping_add(place as u64));
            self.word(number);
        }
    }
    /// The same of reals; the sign of a zero does not matter.
    fn reals<'a>(&mut self, name: &str, numbers: impl IntoIterator<Item = &'a f64>) {
        self.integers(name, numbers.into_iter().map(|&number| (number + 0.0).to_bits()));
    }
    fn hash(&self) -> u128 {
        xxh3_128(&self.0)
    }
}

/// The sum of the hashes of so many records modulo $2^{128}$.
fn sum(count: usize, record: impl Fn(Record, usize) -> Record + Sync) -> u128 {
    let of = |room: &mut Record, index| {
        *room = record(std::mem::take(room), index);
        room.hash()
    };
    (0..count).into_par_iter().with_min_len(1024).map_init(Record::default, of).reduce(|| 0, u128::wrapping_add)
}

impl State {
    /// A hash of the whole state but for its initial energies, the same wherever the same bits were computed.
    ///
    /// It is the sum modulo $2^{128}$ of the XXH3 hashes of one record for the step, each particle, wall, contact, contact
    /// with a wall and bond, so that their order does not matter. A record has a key, which is made of persistent ids and of
    /// numbers of walls, whose order is one of sums, and named numbers that are not zero: a field of zeros is as none.
    /// Signed zeros do not matter.
    #[must_use]
    pub fn hash(&self) -> u128 {
        let mut run = Record::default().of("run", &[]);
        run.integers("step", [self.step]);
        let parts = [
            run.hash(),
            sum(self.len(), |room, i| self.particle_record(room, i)),
            sum(self.wall_position.len(), |room, number| {
                let mut record = room.of("wall", &[number as u64]);
                record.reals("position", &self.wall_position[number]);
                record
            }),
            sum(self.contacts.len(), |room, k| {
                let contact = &self.contacts[k];
                let mut record = room.of("contact", &[contact.first.into(), contact.second.into()]);
                record.reals("displacement", &contact.displacement);
                record
            }),
            sum(self.wall_contacts.len(), |room, k| {
                let contact = &self.wall_contacts[k];
                let mut record = room.of("wall contact", &[contact.particle.into(), contact.wall.into()]);
                record.reals("displacement", &contact.displacement);
                record
            }),
            sum(self.bonds.len(), |room, k| self.bond_record(room, k)),
        ];
        parts.into_iter().fold(0, u128::wrapping_add)
    }

    fn particle_record(&self, room: Record, i: usize) -> Record {
        let mut record = room.of("particle", &[self.id[i].into()]);
        record.integers("material", [self.material[i].into()]);
        record.integers("constraint", [self.constraint[i].into()]);
        record.integers("exposure", self.exposure.get(i).map(|&exposure| exposure.into()));
        record.integers("image", self.image[i].map(|image| image.cast_unsigned().into()));
        for (name, field) in [
            ("radius", &self.radius),
            ("mass", &self.mass),
            ("temperature", &self.temperature),
            ("heat_rate", &self.heat_rate),
            ("reference_radius", &self.reference_radius),
            ("work_per_kelvin", &self.work_per_kelvin),
        ] {
            record.reals(name, field.get(i));
        }
        for (name, field) in [
            ("position", &self.position),
            ("velocity", &self.velocity),
            ("angular_velocity", &self.angular_velocity),
            ("force", &self.force),
            ("moment", &self.moment),
            ("bonded_position", &self.bonded_position),
        ] {
            record.reals(name, field.get(i).into_iter().flatten());
        }
        record.reals("orientation", self.orientation.get(i).into_iter().flatten());
        record.reals("derivatives", self.derivatives.get(i).into_iter().flatten().flatten());
        for (names, accounts) in [(ACCOUNTS, &self.accounts), (HEAT_ACCOUNTS, &self.heat_accounts)] {
            for (name, column) in names {
                record.reals(name, accounts.get(i).map(|account| &account[column]));
            }
        }
        record
    }

    fn bond_record(&self, room: Record, k: usize) -> Record {
        let bond = &self.bonds[k];
        let mut record = room.of("bond", &[bond.first.into(), bond.second.into()]);
        record.reals("strength", [&bond.strength]);
        if let Some(breakage) = &bond.breakage {
            record.integers("breakage_step", [breakage.step]);
            record.reals("failure", [&breakage.failure.code()]);
            record.reals("released_energy", [&breakage.energy]);
        }
        if let Some(history) = self.bond_histories.get(k) {
            record.reals("normal", &history.normal);
            record.reals("tension", [&history.tension]);
            record.reals("shear", &history.shear);
            record.reals("couple", &history.couple);
        }
        record
    }
}
