//! All that can be wrong with a case, by code: what it means, and what to do. `docs/errors.md` is made from this.

crate::codes! {
    /// `--set` names a place that the case cannot have, or gives a value that is not TOML.
    ///
    /// Write `--set key=value` with the keys joined by dots, such as `--set time.end=0.5`; entries of a list are counted
    /// from 0 (`--set particles.0.random.count=100`) and must be there. Text takes quotes where it could be a number.
    error BAD_OVERRIDE = "tdem::case::bad-override";

    /// A temperature is not above absolute zero.
    ///
    /// `heat.scale` says whether temperatures are in °C or in K: a case in K with values in °C gets here.
    error BELOW_ABSOLUTE_ZERO = "tdem::case::below-absolute-zero";

    /// The file of bonds names a pair that cannot be bonded: a particle with itself, a pair twice, an id that no particle
    /// has, or a particle whose bonds go on from another run.
    ///
    /// Mend the line that is named. Ids count from 0 in the order of the groups, unless a table or a run gives others.
    error BOND_FILE = "tdem::case::bond-file";

    /// Stiffness was given for a solid (`lattice`), but these bonds are not alike: they join unequal spheres, or are of
    /// unequal lengths. Only on a lattice of equal spheres does the solid's stiffness say what a bond must have.
    ///
    /// Say how stiff bonds are with `micro = { young_modulus = ..., stiffness_ratio = ... }`; `tdem calibrate` finds the
    /// values that give a packing a modulus and a Poisson's ratio.
    error BOND_LATTICE = "tdem::case::bond-lattice";

    /// Particles of two materials lie near enough to be bonded, but no `[[bond]]` joins these materials.
    ///
    /// Add a `[[bond]]` of both. Without one they only touch, which may be what is wanted, between a specimen and a tool.
    warning BOND_MISSING = "tdem::case::bond-missing";

    /// Bonds with `series = true` take their stiffness from the bonds of their two materials, and cannot here: both
    /// materials are the same, one of them has no `[[bond]]` of its own, or the two are given in different ways.
    ///
    /// Give each material a `[[bond]]` with itself, both by `lattice` or both by the same key of `micro`; or say how stiff
    /// the bonds between them are.
    error BOND_SERIES = "tdem::case::bond-series";

    /// A `[[bond]]` bonds nothing: no two particles of its materials lie within its gap, or the file of bonds has no such
    /// pair.
    ///
    /// Raise `gap` (a part of the mean radius) or `gap_length` (m), or remove the entry. Lengths are in metres.
    error BOND_UNUSED = "tdem::case::bond-unused";

    /// The case has a `[[bond]]`, but its model does not bond.
    ///
    /// Write `model = "BPM"`, which is GNTM with bonds, or `"TBPM"` with heat too; or remove `[[bond]]`.
    error BONDS_NEED_BPM = "tdem::case::bonds-need-bpm";

    /// Two keys that exclude each other are both there, or one that has no effect beside the other.
    ///
    /// Keep the one that is meant; the message shows both.
    error CONFLICTING_KEYS = "tdem::case::conflicting-keys";

    /// Two zones or groups tell the same particles to move in two ways along the same direction.
    ///
    /// Keep one of them, or bound one zone so that it leaves these particles out.
    error CONTRADICTORY_MOTION = "tdem::case::contradictory-motion";

    /// The first line of a CSV file does not name the columns that are needed, or names one that is not known.
    ///
    /// Mend the header. For particles it holds `x,y,z,radius` in any order, and what `docs/case-file.md` allows
    /// besides; for bonds `first,second`; elsewhere the case says which columns it wants.
    error CSV_COLUMN = "tdem::case::csv-column";

    /// A CSV file has no header or no rows.
    ///
    /// The first line names the columns, and each line after it is a row. An interrupted export often leaves such a file.
    error CSV_EMPTY = "tdem::case::csv-empty";

    /// A CSV file ends within a line, or a line has fewer values than the header has columns.
    ///
    /// Write the file again. If it is complete, end its last line with a line break: without one, a number that lost its
    /// last digits could not be told from a whole one.
    error CSV_TRUNCATED = "tdem::case::csv-truncated";

    /// A CSV file cannot be read.
    ///
    /// Paths are relative to the folder of the case, not to where the command runs.
    error CSV_UNREADABLE = "tdem::case::csv-unreadable";

    /// A value in a CSV file is not what its column needs: no number, not finite, a radius that is not positive, an id that
    /// is not a whole number, or a material that the case does not have.
    ///
    /// Mend the line that is named. Numbers have a decimal point and no unit; lengths are in metres.
    error CSV_VALUE = "tdem::case::csv-value";

    /// `within` keeps all particles of its group, or a hole in `without` takes none away.
    ///
    /// Look at its place and size, in metres. A lattice that a body is cut out of must reach beyond that body.
    warning CUT_IDLE = "tdem::case::cut-idle";

    /// Two `[[bond]]` describe the same pair of materials; the order of the two names does not matter.
    ///
    /// Keep one of them.
    error DUPLICATE_BOND = "tdem::case::duplicate-bond";

    /// Two particles have the same id.
    ///
    /// Give others, or leave ids out: groups without ids get the next free ones.
    error DUPLICATE_ID = "tdem::case::duplicate-id";

    /// Two `[[interaction]]` describe the same pair of materials; the order of the two names does not matter.
    ///
    /// Keep one of them.
    error DUPLICATE_INTERACTION = "tdem::case::duplicate-interaction";

    /// Two things that are told apart by their names have the same: walls, curves, pictures, columns of the history, or
    /// groups, zones and surfaces that something refers to.
    ///
    /// Give each its own name.
    error DUPLICATE_NAME = "tdem::case::duplicate-name";

    /// The run would take more steps than can be counted.
    ///
    /// Make it shorter or the step longer. A step that is chosen may be tiny because of one very small or very stiff
    /// particle: `tdem check` tells what limits it once `time.end` is shorter.
    error ENDLESS = "tdem::case::endless";

    /// A material expands with heat, but its bonds store forces. A stored force knows nothing of lengths, so that free
    /// expansion would leave stresses behind.
    ///
    /// Write `bonds.form = "total"`.
    error EXPANSION_OF_STORED_FORCES = "tdem::case::expansion-of-stored-forces";

    /// One component of motion is both fixed and prescribed.
    ///
    /// Keep one of them: fixed means prescribed at 0.
    error FIXED_AND_PRESCRIBED = "tdem::case::fixed-and-prescribed";

    /// A force acts on particles along a direction in which their motion is prescribed, where it has no effect.
    ///
    /// Keep one of them, or bound the zone so that it leaves these particles out.
    error FORCE_ON_PRESCRIBED = "tdem::case::force-on-prescribed";

    /// The dynamic coefficient of friction is larger than the static one.
    ///
    /// Lower the dynamic or raise the static coefficient; with equal ones, sliding does not make friction weaker.
    error FRICTION_ORDER = "tdem::case::friction-order";

    /// A gauge between two groups has no line to measure along: both are the same, or their mean places are.
    ///
    /// Name two groups or zones that lie apart.
    error GAUGE_OF_ONE = "tdem::case::gauge-of-one";

    /// Under Gear's integrator the vibration of bonds that store shear forces and moments, but not the normal force, grows at any
    /// step unless dashpots take more than it gains.
    ///
    /// Give the bonds the damping ratio that is named, or take `bonds.form = "total"` or `"incremental-stored"`, or the
    /// integrator `velocity-verlet`.
    error GEAR_GROWTH = "tdem::case::gear-growth";

    /// `within` and `without` leave nothing of a group of particles.
    ///
    /// Move or enlarge the body, or the region that it is cut out of; the message tells where centres lie.
    error GROUP_EMPTY = "tdem::case::group-empty";

    /// The case has a table `[heat]`, but its model is bonds without heat.
    ///
    /// Write `model = "TBPM"`, or remove `[heat]`. The models GN, GNT and GNTM take heat as they are.
    error HEAT_AND_MODEL = "tdem::case::heat-and-model";

    /// A wall has a temperature that reaches no particle: the wall is rigid, or no heat goes through contacts.
    ///
    /// Name a material that conducts, write `heat.contacts = "circle"` or `"bar"`, or remove the temperature.
    error IDLE_TEMPERATURE = "tdem::case::idle-temperature";

    /// The hardest impact that the case allows would overlap by more than `contact.overlap_limit` of the smaller radius, where the
    /// run stops.
    ///
    /// A stiffer material or a slower impact overlaps less. The speed is that of what falls freely or is driven; dashpots and
    /// neighbours are not counted, so that the run may well go through.
    warning IMPACT_DEEP = "tdem::case::impact-deep";

    /// The case cannot be read although every key and value looks right. This is rare.
    ///
    /// The place shows what is refused. Please report it: a message of its own should have been there.
    error INVALID = "tdem::case::invalid";

    /// A box has a corner `max` that does not lie above `min` in some direction.
    ///
    /// Exchange them, or correct one.
    error INVERTED_BOX = "tdem::case::inverted-box";

    /// A range, a course over time or a table over temperature does not ascend.
    ///
    /// Put its points in order. Where a value shall jump, give the jump a short time or a small difference.
    error INVERTED_RANGE = "tdem::case::inverted-range";

    /// Over the temperatures that the case names, a material would change its length by more than a tenth, far beyond the
    /// small strains that the law of expansion is for.
    ///
    /// Look at the unit: solids have some 1e-6 to 1e-4 1/K.
    error LARGE_EXPANSION = "tdem::case::large-expansion";

    /// Masses are scaled while unbonded particles fall: what has more mass falls slower, by the square root.
    ///
    /// Remove `time.mass_scaling` where the way to rest matters; the state of rest stays right.
    warning MASS_SCALING_FALLS = "tdem::case::mass-scaling-falls";

    /// The model bonds particles, but nothing says what the bonds are made of, of these materials or of any.
    ///
    /// Add a `[[bond]]` of both materials with its stiffness and its strengths; or choose a model without bonds.
    error MISSING_BOND = "tdem::case::missing-bond";

    /// Something is about heat, but the case has no table `[heat]`.
    ///
    /// Add one, which begins with `initial_temperature`; or remove what is shown.
    error MISSING_HEAT = "tdem::case::missing-heat";

    /// Two materials can meet, and no `[[interaction]]` says what happens then. Friction and damping are physics, and have
    /// no defaults.
    ///
    /// Add an `[[interaction]]` of both. A material also meets itself.
    error MISSING_INTERACTION = "tdem::case::missing-interaction";

    /// A key that has no default is not there.
    ///
    /// Add it; the message shows what it could look like, and `docs/case-file.md` what it means.
    error MISSING_KEY = "tdem::case::missing-key";

    /// A material, an interaction or a bond lacks a value that the chosen laws need.
    ///
    /// Add it, or choose a law that does without; the message shows what asks for it.
    error MISSING_PARAMETER = "tdem::case::missing-parameter";

    /// A name that becomes part of a file or of a column holds something else than letters, digits, `_` and `-`.
    ///
    /// Choose another name. Titles may hold anything.
    error NAME = "tdem::case::name";

    /// The case has no particles.
    ///
    /// Add a table `[[particles]]` and within it one of `[particles.lattice]`, `[particles.random]`, `[particles.list]`,
    /// `[particles.csv]`, `[particles.run]`.
    error NO_PARTICLES = "tdem::case::no-particles";

    /// Random insertion did not find room for all spheres.
    ///
    /// Ask for fewer, or for a larger region. Places of equal spheres that are drawn one after the other run out at 0.384 of
    /// the volume (random sequential addition; Zhang & Torquato, Phys. Rev. E 88 (2013) 053312), of unequal ones below
    /// 0.62; more is refused before any is drawn. Denser packings come from a lattice, or from letting particles settle.
    error NO_ROOM = "tdem::case::no-room";

    /// Stiffness was given for a solid (`lattice`), but the bonds do not form the lattice for which it is known: a
    /// face-centred one along x, y and z.
    ///
    /// Read the result as another solid's; or say how stiff bonds are with `micro`, and find its values by `tdem calibrate`.
    warning NOT_THE_LATTICE = "tdem::case::not-the-lattice";

    /// A picture is to show what particles of this case do not have: a temperature without heat, damage without bonds.
    ///
    /// Choose another `field`, or another model.
    error NOTHING_TO_SHOW = "tdem::case::nothing-to-show";

    /// A number is outside of what it can be.
    ///
    /// The message tells what is allowed, in which unit. Units are SI without prefixes: a radius of 5 mm is `0.005`.
    error OUT_OF_RANGE = "tdem::case::out-of-range";

    /// Centres of particles lie outside the domain, in a direction that does not repeat.
    ///
    /// Enlarge the domain, or place particles otherwise. A particle that leaves the domain later ends the run.
    error OUTSIDE_DOMAIN = "tdem::case::outside-domain";

    /// Particles overlap at the start. Where contacts act between them, they would fly apart.
    ///
    /// Look at the groups that the message shows, and at lengths, which are in metres. Where overlap is meant, say
    /// `allow_overlap = true` in the group.
    error OVERLAP = "tdem::case::overlap";

    /// Particles overlap at the start by more than `contact.overlap_limit` of the smaller radius of the pair, which stops a run
    /// before its first step, whatever `allow_overlap` says.
    ///
    /// Move them apart. Only pairs of particles that are both fixed in all components, such as rough walls made of spheres,
    /// may overlap as they like: nothing depends on the forces between them.
    error OVERLAP_LIMIT = "tdem::case::overlap-limit";

    /// A group of particles has no source, or more than one.
    ///
    /// Give each `[[particles]]` one of `lattice`, `random`, `list`, `csv`, `run`; several sources are several groups.
    error PARTICLE_SOURCE = "tdem::case::particle-source";

    /// The domain repeats after so short a length that a particle would meet the same neighbour twice.
    ///
    /// Make it at least two diameters of the largest particle long, and a little more for the skin of the neighbour list; or do
    /// not let this direction repeat.
    error PERIOD_TOO_SHORT = "tdem::case::period-too-short";

    /// No bonds on a face-centred lattice give a solid this Poisson's ratio.
    ///
    /// Choose one in the range that the message tells: bonds whose springs resist shear give no other.
    error POISSON_UNREACHABLE = "tdem::case::poisson-unreachable";

    /// A region is too small for a single sphere or a single cell of a lattice.
    ///
    /// Enlarge it, or take smaller spheres. Lengths are in metres.
    error REGION_TOO_SMALL = "tdem::case::region-too-small";

    /// A material is called `rigid`, which is the built-in material of infinitely stiff walls.
    ///
    /// Choose another name.
    error RESERVED_NAME = "tdem::case::reserved-name";

    /// Particles are made of `rigid`, which has neither a density nor a stiffness.
    ///
    /// Only walls can be rigid. Fix particles (`fixed = [...]`) if they shall not move.
    error RIGID_PARTICLES = "tdem::case::rigid-particles";

    /// The bonds of an earlier run cannot go on here: it has none, or this case has no `[[bond]]`, stores forces where that
    /// run did not, or repeats otherwise.
    ///
    /// Repeat what that run's `case.toml` says of bonds and of the domain, or take its particles with `bonds = "anew"`.
    error RUN_BONDS = "tdem::case::run-bonds";

    /// Contact histories of an earlier run, the tangential displacements of its friction springs, are dropped: the case does
    /// not say what becomes of them, it has no wall of the name that a history belongs to, or the contact is open here. What
    /// these springs held starts to slip until others have built up.
    ///
    /// Add `contacts = "carry"` to `[particles.run]` to transfer histories; walls are matched by name, and a wall that had
    /// moved must stand where that run left it. Add `contacts = "anew"` if springs shall start unloaded.
    warning RUN_HISTORIES = "tdem::case::run-histories";

    /// The materials of an earlier run have no counterpart here.
    ///
    /// Define materials of the same names, or list the names to take in their place: `materials = ["...", ...]`, in the
    /// order in which that run's case has them; or give all its particles one `material`.
    error RUN_MATERIALS = "tdem::case::run-materials";

    /// The final state of an earlier run cannot be taken.
    ///
    /// Name the directory of a run that left a checkpoint. Paths are relative to the folder of the case.
    error RUN_UNREADABLE = "tdem::case::run-unreadable";

    /// A zone, a hole or a cut has no shape, or more than one.
    ///
    /// Give it one of the shapes that the message lists; a body of several shapes is several zones.
    error SHAPE = "tdem::case::shape";

    /// The time step that was chosen is no number that a case can hold, so that the run cannot keep its case.
    ///
    /// No case should cause this: please report it with the case.
    error STEP = "tdem::case::step";

    /// The time step is longer than the whole run.
    ///
    /// Write `step = "auto"` for the largest safe step, or make the run longer.
    error STEP_BEYOND_END = "tdem::case::step-beyond-end";

    /// The time step is larger than an estimate allows, which is not proven for this case.
    ///
    /// Write `step = "auto"`, or watch the energy ledger: `tdem check` shows all limits and what causes them.
    warning STEP_LARGE = "tdem::case::step-large";

    /// The time step is larger than a proven limit: oscillations would grow until the run breaks.
    ///
    /// Write `step = "auto"` for the largest safe step. To allow longer ones: softer or larger particles, or for states of
    /// rest `time.mass_scaling`.
    error STEP_UNSTABLE = "tdem::case::step-unstable";

    /// The stiffness of bonds depends on temperature, but they store forces, which do not change when stiffness does.
    ///
    /// Write `bonds.form = "total"`.
    error STIFFNESS_OF_STORED_FORCES = "tdem::case::stiffness-of-stored-forces";

    /// A surface lies at a face where the domain repeats, so that there is no face.
    ///
    /// Choose another face, or do not let this direction repeat.
    error SURFACE_ACROSS_PERIOD = "tdem::case::surface-across-period";

    /// No particle belongs to a surface.
    ///
    /// Look at the group or zone that it names. Zones act in the order of the file, and hold particles whose centres lie
    /// in them.
    error SURFACE_EMPTY = "tdem::case::surface-empty";

    /// Particles on a plane of symmetry are told to leave it or to turn out of it, where their mirror images would move
    /// the other way.
    ///
    /// Do not prescribe the velocity or a force along the normal of the plane, or turning about an axis in it, for these.
    error SYMMETRY_CONFLICT = "tdem::case::symmetry-conflict";

    /// No centre of a particle lies on a plane of symmetry.
    ///
    /// Put the plane through centres; the message tells how far away the nearest is. `site` or `origin` of a lattice puts
    /// its centres where they are wanted.
    error SYMMETRY_EMPTY = "tdem::case::symmetry-empty";

    /// The text is not TOML.
    ///
    /// Most often a quote or a bracket is not closed, or a key is there twice. The place is where reading failed, which
    /// may be a line behind the cause.
    error SYNTAX = "tdem::case::syntax";

    /// Particles reach through a wall at the start.
    ///
    /// Move the group or the wall. The normal of a wall points to where particles are: a wall that is turned round has
    /// all of them behind it.
    error THROUGH_WALL = "tdem::case::through-wall";

    /// Heat goes so much faster than motion that a bonded body would swing instead of expanding: its slowest vibration does
    /// not fit twenty times into the course of temperatures.
    ///
    /// Make `time.end` longer, which lowers the pace; or choose `heat.motion = "quasi-static"`. What a pace costs in accuracy
    /// `tdem ladder` tells.
    error TIME_SCALE = "tdem::case::time-scale";

    /// The particles take more memory than the machine has: one copy of their state and what a run on the CPU computes with
    /// are counted, without bonds.
    ///
    /// Look at the radius and the region, in metres; take fewer particles, a model without moments, or a larger machine.
    error TOO_LITTLE_MEMORY = "tdem::case::too-little-memory";

    /// A group would have more particles than can be counted.
    ///
    /// Look at the radius and the region, in metres.
    error TOO_MANY_PARTICLES = "tdem::case::too-many-particles";

    /// Two surfaces hold the same particles at temperatures of their own.
    ///
    /// Bound one of them so that it leaves these particles out, as at edges; or give one a `depth`.
    error TWO_TEMPERATURES = "tdem::case::two-temperatures";

    /// A word is none of those that this key takes.
    ///
    /// The message lists them.
    error UNKNOWN_CHOICE = "tdem::case::unknown-choice";

    /// A curve wants a column that the history of this case does not have.
    ///
    /// `docs/outputs.md` lists all columns; those of bonds, heat and gauges are only there in cases with such.
    error UNKNOWN_COLUMN = "tdem::case::unknown-column";

    /// Nothing has the name of a group of particles or of a zone that is referred to.
    ///
    /// Give a `[[particles]]` or a `[[zone]]` that `name`, or correct it.
    error UNKNOWN_GROUP = "tdem::case::unknown-group";

    /// A key is not part of the format, or not of this table. Nothing is ever skipped in silence.
    ///
    /// The message suggests the nearest key that there is. A key below a `[table]` belongs to that table: keys of the case
    /// itself stand above all tables.
    error UNKNOWN_KEY = "tdem::case::unknown-key";

    /// A material is not defined.
    ///
    /// Add a table `[material.NAME]`, or correct the name.
    error UNKNOWN_MATERIAL = "tdem::case::unknown-material";

    /// `size` names a preset that `[sizes]` does not have.
    ///
    /// Choose one of those that there are, or remove `size`.
    error UNKNOWN_SIZE = "tdem::case::unknown-size";

    /// A gauge watches a surface that does not exist.
    ///
    /// Give a `[[surface]]` that `name`, or correct it.
    error UNKNOWN_SURFACE = "tdem::case::unknown-surface";

    /// The case itself cannot be read: it is not there, may not be read, or is not UTF-8 text.
    ///
    /// Look at the path. `tdem new NAME` writes a case to start from.
    error UNREADABLE = "tdem::case::unreadable";

    /// A wall stands across a direction in which the domain repeats.
    ///
    /// Turn the wall, leave these faces of a box open, or do not let this direction repeat.
    error WALL_ACROSS_PERIOD = "tdem::case::wall-across-period";

    /// A list has the wrong number of entries.
    ///
    /// Vectors have three: `[x, y, z]`. The message tells how many belong there.
    error WRONG_LENGTH = "tdem::case::wrong-length";

    /// A value is of another kind than its key takes: text for a number, a number for a table.
    ///
    /// Numbers stand without quotes and without units. The message tells what belongs there.
    error WRONG_TYPE = "tdem::case::wrong-type";

    /// A direction is [0, 0, 0], which is none: the normal of a wall or of a cut, or where a camera stands.
    ///
    /// Give any other vector; its length does not matter.
    error ZERO_NORMAL = "tdem::case::zero-normal";

    /// The shear strength of bonds is asked for as a multiple of what tension causes in shear, but at this Poisson's ratio
    /// bonds feel no shear: any multiple is no strength.
    ///
    /// Give `shear_strength` instead, in Pa.
    error ZERO_STRENGTH = "tdem::case::zero-strength";

    /// No centre of a particle lies in a zone.
    ///
    /// Look at its place and size, in metres. Zones act in the order of the file, each on what earlier ones left.
    error ZONE_EMPTY = "tdem::case::zone-empty";

    /// A zone changes nothing and nothing watches it.
    ///
    /// Say what particles in it are made of or how they move, or give it a name and refer to it from a `[[gauge]]` or a
    /// `[[surface]]`.
    error ZONE_IDLE = "tdem::case::zone-idle";
}

#[cfg(test)]
mod tests {
    use super::ALL;

    #[test]
    fn codes_ascend_and_say_what_they_mean_and_what_to_do() {
        assert!(ALL.is_sorted_by(|a, b| a.name < b.name), "each once, in the order of the alphabet");
        for code in ALL {
            assert!(code.name.starts_with("tdem::case::"), "{}", code.name);
            assert_eq!(code.paragraphs().filter(|paragraph| paragraph.ends_with('.')).count(), 2, "{}", code.name);
        }
    }
}
