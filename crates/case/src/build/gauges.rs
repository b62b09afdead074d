//! What is watched during a run.

use super::Context;
use super::draft::Draft;
use super::heat::Surfaces;
use crate::codes;
use crate::problem::Problem;
use crate::schema::{self, Case};
use std::collections::BTreeMap;
use std::sync::Arc;
use tdem_engine::{Gauge, Group, Measure, Plan, State};

/// Ids of the particles that gauges watch, by the name of their group or zone.
pub(super) type Watched<'c> = BTreeMap<&'c str, Arc<[u32]>>;

/// The particles of each group or zone that is watched; `zones` holds indices into the draft.
pub(super) fn members<'c>(case: &'c Case, draft: &Draft, zones: &[Vec<u32>]) -> Watched<'c> {
    let mut watched = Watched::new();
    for name in case.gauge.iter().flat_map(schema::Gauge::watched) {
        let mut ids: Vec<u32> = if let Some(zone) = case.zone.iter().position(|zone| zone.name == name) {
            zones[zone].iter().map(|&member| draft.state.id[member as usize]).collect()
        } else {
            let of_group = |k: &usize| case.particles[usize::from(draft.group[*k])].name == name;
            (0..draft.state.len()).filter(of_group).map(|k| draft.state.id[k]).collect()
        };
        ids.sort_unstable();
        watched.entry(name).or_insert_with(|| ids.into());
    }
    watched
}

/// The gauges of a case, and pairs of groups that lie in the same place.
pub(super) fn gauges(
    context: &Context<'_>,
    watched: &Watched<'_>,
    surfaces: &Surfaces,
    state: &State,
    plan: &Plan,
) -> (Vec<Gauge>, Vec<Problem>) {
    let group = |name: &String| {
        let members = watched.get(name.as_str()).map_or_else(|| Arc::from([]), Arc::clone);
        Group::at_start(members, state, plan)
    };
    let (mut gauges, mut problems) = (Vec::new(), Vec::new());
    for (k, gauge) in context.loaded.case.gauge.iter().enumerate() {
        let measure = if let Some(between) = &gauge.between {
            let groups = between.each_ref().map(group);
            if groups[0].start == groups[1].start {
                let [first, second] = between;
                let place = context.loaded.tree.place(&["gauge", &k.to_string(), "between"]);
                problems.push(
                    Problem::new(
                        codes::GAUGE_OF_ONE,
                        format!("the means of `{first}` and `{second}` lie in the same place"),
                    )
                    .at(place, "no line joins them"),
                );
            }
            Measure::Between(groups)
        } else if let Some(of) = &gauge.of {
            Measure::Of(group(of))
        } else if let Some(surface) = gauge.surface.as_ref().and_then(|name| surfaces.get(name)) {
            Measure::Surface(surface.clone())
        } else {
            continue;
        };
        gauges.push(Gauge { name: gauge.name.clone(), measure });
    }
    (gauges, problems)
}
