//! Which particles are within the skin of walls.

use crate::cpu::Cpu;
use crate::cpu::neighbours::{Histories, WallSlot};
use rayon::prelude::*;
use tdem_physics::contact::touch_wall;

impl Cpu {
    /// Lists particles within the skin of walls.
    pub(super) fn list_walls(&mut self, histories: &Histories, skin: f64) {
        let bodies = &self.bodies;
        let (walls, position) = (&self.plan.walls, &self.wall_position);
        let slots: Vec<WallSlot> = (0..bodies.len())
            .into_par_iter()
            .flat_map_iter(|i| {
                walls.iter().zip(position).enumerate().filter_map(move |(wall, (plan, &point))| {
                    let place = &bodies.place[i];
                    let touch = touch_wall(place.vector(), place.scalar(), point.into(), plan.normal.into());
                    (touch.overlap > -skin).then(|| {
                        let kept = histories.of_wall(bodies.rank[i], wall as u32);
                        WallSlot {
                            particle: i as u32,
                            wall: wall as u32,
                            touching: kept.is_some(),
                            displacement: kept.unwrap_or_default(),
                            made: 0.0,
                        }
                    })
                })
            })
            .collect();
        self.neighbours.wall_slots = slots;
        self.neighbours.wall_reference.clone_from(&self.wall_position);
        self.neighbours.index_walls(bodies.len());
    }
}
