//! What the text shows to be wrong with bonds and zones.

use super::{COMPONENTS, Checker};
use crate::codes;
use crate::problem::Problem;
use crate::schema::{Joint, Micro, Solid, Zone};
use std::collections::BTreeMap;
use tdem_engine::physics::bond::face_centred;

impl Checker<'_> {
    pub(super) fn bonds(&mut self) {
        let bonds = &self.case.bond;
        if self.case.model.bonds() && bonds.is_empty() {
            let place = self.place(&["model"]);
            self.push(
                Problem::new(
                    codes::MISSING_BOND,
                    format!("the model is {:?}, but nothing says what bonds are made of", self.case.model),
                )
                .at(place, "bonds particles")
                .help("add a [[bond]] with between = [..., ...], its stiffness and its strength; or choose \"GNTM\""),
            );
        }
        if !self.case.model.bonds() && !bonds.is_empty() {
            let [place, cause] = [&["bond", "0", "between"][..], &["model"]].map(|path| self.place(path));
            self.push(
                Problem::new(codes::BONDS_NEED_BPM, "the case describes bonds, but its model has none")
                    .at(cause, "does not bond")
                    .at(place, "bonds are described here")
                    .help("write model = \"BPM\", which is GNTM with bonds, or remove [[bond]]"),
            );
        }
        let mut seen: BTreeMap<[&str; 2], usize> = BTreeMap::new();
        for (k, joint) in bonds.iter().enumerate() {
            let index = k.to_string();
            for (n, name) in joint.between.iter().enumerate() {
                self.material(name, false, &["bond", &index, "between", &n.to_string()]);
            }
            let mut pair = joint.between.each_ref().map(String::as_str);
            pair.sort_unstable();
            if let Some(first) = seen.insert(pair, k) {
                let first = self.place(&["bond", &first.to_string(), "between"]);
                let again = self.place(&["bond", &index, "between"]);
                self.push(
                    Problem::new(
                        codes::DUPLICATE_BOND,
                        format!("the bonds of `{}` and `{}` are given twice", pair[0], pair[1]),
                    )
                    .at(again, "again here")
                    .at(first, "first here")
                    .help("keep one of them"),
                );
            }
            if joint.gap_length.is_some() && self.tree.get(&["bond", &index, "gap"]).is_some() {
                self.exclusive(&["bond", &index], "gap", "gap_length");
            }
            self.stiffness(joint, &index);
            self.strengths(joint, &index);
        }
    }

    fn stiffness(&mut self, joint: &Joint, index: &str) {
        let given: Vec<&str> =
            [("lattice", joint.lattice.is_some()), ("micro", joint.micro.is_some()), ("series", joint.series)]
                .into_iter()
                .filter_map(|(key, there)| there.then_some(key))
                .collect();
        match given.as_slice() {
            [] => self.lacking(
                joint,
                index,
                "`lattice`, `micro` or `series`",
                "lattice = { young_modulus = ..., poisson_ratio = ... }",
            ),
            [one, other, ..] => self.exclusive(&["bond", index], one, other),
            _ => {}
        }
        if let Some(solid) = &joint.lattice {
            self.solid(solid, index);
        }
        if let Some(Micro { young_modulus, stiffness_per_area, .. }) = &joint.micro {
            match (young_modulus, stiffness_per_area) {
                (Some(_), Some(_)) => self.exclusive(&["bond", index, "micro"], "young_modulus", "stiffness_per_area"),
                (None, None) => {
                    self.lacking(joint, index, "`micro.young_modulus`", "young_modulus = ..., in Pa, to `micro`");
                }
                _ => {}
            }
        }
        if joint.series {
            let [first, second] = &joint.between;
            let own = |name: &String| self.case.bond.iter().any(|j| !j.series && j.between.iter().all(|n| n == name));
            if first == second || !own(first) || !own(second) {
                let place = self.place(&["bond", index, "series"]);
                self.push(
                    Problem::new(
                        codes::BOND_SERIES,
                        "bonds in series join two materials, each of which has bonds of its own",
                    )
                    .at(place, format!("needs a [[bond]] for `{first}` alone and one for `{second}` alone"))
                    .help("say how stiff these bonds are with `lattice` or `micro`"),
                );
            }
        }
    }

    fn solid(&mut self, solid: &Solid, index: &str) {
        match face_centred::stiffness_ratio(solid.poisson_ratio.get()) {
            Err(error) => {
                let place = self.place(&["bond", index, "lattice", "poisson_ratio"]);
                self.push(
                    Problem::new(codes::POISSON_UNREACHABLE, error.to_string())
                        .at(place, format!("must be from {} to {:.4}", error.least, error.greatest))
                        .help("bonds on this lattice resist shear with springs, which gives no other Poisson's ratio"),
                );
            }
            Ok(0.0) if solid.shear_factor.is_some() => {
                let place = self.place(&["bond", index, "lattice", "shear_factor"]);
                let cause = self.place(&["bond", index, "lattice", "poisson_ratio"]);
                self.push(
                    Problem::new(codes::ZERO_STRENGTH, "these bonds feel no shear, a multiple of which is no strength")
                        .at(place, "gives a strength of 0 Pa")
                        .at(cause, "leaves no shear stiffness")
                        .help("give `shear_strength` instead, in Pa"),
                );
            }
            Ok(_) => {}
        }
        if solid.shear_factor.is_some() && solid.tensile_strength.is_none() {
            let place = self.place(&["bond", index, "lattice", "shear_factor"]);
            self.push(
                Problem::new(
                    codes::MISSING_PARAMETER,
                    "`shear_factor` is a multiple of what the tensile strength causes",
                )
                .at(place, "`tensile_strength` belongs beside it")
                .help("add tensile_strength = ..., in Pa, of the solid; or give `shear_strength` of the bonds"),
            );
        }
    }

    fn strengths(&mut self, joint: &Joint, index: &str) {
        let of_solid = |pick: fn(&Solid) -> bool| joint.lattice.as_ref().is_some_and(pick);
        let both = [
            (
                "tensile_strength",
                "tensile_strength",
                joint.tensile_strength,
                of_solid(|s| s.tensile_strength.is_some()),
            ),
            ("shear_strength", "shear_factor", joint.shear_strength, of_solid(|s| s.shear_factor.is_some())),
        ];
        for (key, of_solid, own, solid) in both {
            match (own, solid) {
                (None, false) => {
                    self.lacking(joint, index, &format!("`{key}`"), &format!("{key} = ..., in Pa, or \"unbreakable\""));
                }
                (Some(_), true) => {
                    let place = self.place(&["bond", index, key]);
                    let other = self.place(&["bond", index, "lattice", of_solid]);
                    self.push(
                        Problem::new(codes::CONFLICTING_KEYS, format!("`{key}` is given twice"))
                            .at(place, "for the bonds")
                            .at(other, "and for the solid")
                            .help("keep one of them"),
                    );
                }
                _ => {}
            }
        }
    }

    fn lacking(&mut self, joint: &Joint, index: &str, what: &str, add: &str) {
        let [first, second] = &joint.between;
        let place = self.place(&["bond", index]);
        self.push(
            Problem::new(codes::MISSING_PARAMETER, format!("the bonds of `{first}` and `{second}` lack {what}"))
                .at(place, format!("{what} belongs here"))
                .help(format!("add {add}")),
        );
    }

    pub(super) fn zones(&mut self) {
        for (k, zone) in self.case.zone.iter().enumerate() {
            self.zone(zone, &k.to_string());
        }
    }

    fn zone(&mut self, zone: &Zone, index: &str) {
        for (key, name) in [("only", &zone.only), ("material", &zone.material)] {
            if let Some(name) = name {
                self.material(name, false, &["zone", index, key]);
            }
        }
        let here = self.place(&["zone", index]);
        self.shape(&zone.shape, &["zone", index], "this zone");
        let orders = !zone.fixed.is_empty() || !zone.prescribed.is_empty() || !zone.force.is_empty();
        if zone.material.is_none() && !orders && !self.is_watched(&zone.name) {
            self.push(
                Problem::new(codes::ZONE_IDLE, "this zone changes nothing")
                    .at(here, "`material`, `fixed`, `prescribed` or `force` belongs here")
                    .help("say what the particles in it are made of or how they move, or give it a name and watch it with a [[gauge]]"),
            );
        }
        for (k, component) in zone.fixed.iter().enumerate() {
            let component = *component as usize;
            if zone.prescribed.components()[component].is_some() {
                let name = COMPONENTS[component].1;
                let place = self.place(&["zone", index, "fixed", &k.to_string()]);
                let other = self.place(&["zone", index, "prescribed", name]);
                self.push(
                    Problem::new(codes::FIXED_AND_PRESCRIBED, format!("`{name}` is fixed and prescribed"))
                        .at(place, "fixed here")
                        .at(other, "prescribed here")
                        .help("keep one of them"),
                );
            }
        }
    }
}
