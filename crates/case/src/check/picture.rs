//! What the text shows to be wrong with pictures.

use super::Checker;
use crate::codes;
use crate::problem::Problem;
use crate::schema::Field;
use std::collections::BTreeMap;
use std::ops::Range;

/// More pixels than anybody looks at.
const LARGEST: u32 = 16_384;

impl Checker<'_> {
    pub(super) fn pictures(&mut self) {
        let mut names: BTreeMap<&str, Range<usize>> = BTreeMap::new();
        for (k, picture) in self.case.picture.iter().enumerate() {
            let index = k.to_string();
            let path = |key| ["picture", index.as_str(), key];
            let place = self.place(&path("name"));
            self.file_name(&picture.name, place.clone());
            if let Some(first) = names.insert(&picture.name, place.clone()) {
                let message = format!("two pictures are called `{}`", picture.name);
                let problem = Problem::new(codes::DUPLICATE_NAME, message).at(place, "again here");
                self.push(problem.at(first, "first here").help("give each its own name"));
            }
            if picture.view.is_some() && picture.direction.is_some() {
                self.exclusive(&["picture", &index], "view", "direction");
            }
            self.shows_something(picture.field, &path("field"));
            if let Some([low, high]) = picture.range.filter(|[low, high]| low >= high) {
                let message = format!("colours go from {low} to {high}, but the second value must be larger");
                let problem = Problem::new(codes::INVERTED_RANGE, message);
                self.push(problem.at(self.place(&path("range")), "must ascend").help("exchange them"));
            }
            if picture.direction == Some([0.0; 3]) {
                let problem = Problem::new(codes::ZERO_NORMAL, "the camera has no direction");
                let problem = problem.at(self.place(&path("direction")), "all components are 0");
                self.push(problem.help("give where it stands, such as [1.0, -1.7, 0.9]"));
            }
            if picture.clip.is_some_and(|clip| clip.normal == [0.0; 3]) {
                let place = self.place(&["picture", &index, "clip", "normal"]);
                let problem = Problem::new(codes::ZERO_NORMAL, "the plane that cuts has no direction");
                let problem = problem.at(place, "all components are 0");
                self.push(problem.help("give the direction towards what is left out, such as [0.0, -1.0, 0.0]"));
            }
            if picture.size.iter().any(|pixels| !(1..=LARGEST).contains(pixels)) {
                let [width, height] = picture.size;
                let message = format!("a picture of {width} x {height} pixels cannot be drawn");
                let problem = Problem::new(codes::OUT_OF_RANGE, message);
                self.push(problem.at(self.place(&path("size")), format!("each must be from 1 to {LARGEST}")));
            }
        }
    }

    /// A field that particles of the case do not have would be grey everywhere.
    fn shows_something(&mut self, field: Field, path: &[&str]) {
        let (missing, help) = match field {
            Field::Temperature if self.case.heat.is_none() => ("heat", "add a table [heat], or choose another field"),
            Field::Damage if !self.case.model.bonds() => {
                ("bonds", "choose another field, or a model with bonds: \"BPM\" or \"TBPM\"")
            }
            _ => return,
        };
        let message = format!("a case without {missing} has nothing to show there");
        let problem = Problem::new(codes::NOTHING_TO_SHOW, message);
        self.push(problem.at(self.place(path), format!("needs {missing}")).help(help));
    }
}
