// Stage `bond`: forces and moments of bonded pairs, and which of them break.
#if BONDS

// Rows of bonds, in planes of one bond of each particle: higher ranks first, then lower ones. A slot holds the other
// particle, with a bit while the bond holds, or NOBODY behind the last.
#define HOLDS               0x80000000u
#define BOND_SLOT(k, i)     ((size_t)(k) * step.particles + (i))
#define FAILURE_BITS        30u

#define LENGTH_OF(offset)   sqrt(inner(offset, offset))

// The numbers of a bond but for the factor on its strengths. The spheres have the radii that bonds have.
DEVICE Bond bond_of(const Step step, const u32 i, const u32 j, const Sphere body, const Sphere partner,
                    const real bonded_length, GLOBAL const u32 *RESTRICT kind, GLOBAL const Joint *RESTRICT joints,
                    GLOBAL const Bond *RESTRICT beams)
{
#if ONE_BOND
    return step.bond;
#elif ALIKE_BONDS
    return beams[MATERIAL_OF(kind[i]) * step.materials + MATERIAL_OF(kind[j])];
#else
    Bond between;
    bond_between(joints[MATERIAL_OF(kind[i]) * step.materials + MATERIAL_OF(kind[j])], body, partner, bonded_length,
                 1.0, &between);
    return between;
#endif
}

#if BOND_TABLES
// The numbers of a bond at the temperatures of its particles.
DEVICE Bond bond_at(const Step step, const Bond bond, const u32 first, const u32 second, const real mine,
                    const real theirs, const Heated heated)
{
    const Factors factors = heated.factors[first * step.materials + second];
    real mean;
    mean_temperature(mine, theirs, &mean);
    Bond now;
    bond_tempered(bond, property_at(heated.pieces, factors.stiffness, factors.end_stiffness, mean),
                  property_at(heated.pieces, factors.strength, factors.end_strength, mean), &now);
    return now;
}
#endif

#if SOFTENING_WORK
// What the springs of a bond gain per kelvin of either particle, as their stiffness changes.
DEVICE real softening_of(const Step step, const Modes load, const Bond bond, const u32 first, const u32 second,
                         const real mine, const real theirs, const Heated heated)
{
    const Factors factors = heated.factors[first * step.materials + second];
    real mean, energy, slope, work;
    mean_temperature(mine, theirs, &mean);
    bond_energy(load, bond, &energy);
    const Piece piece = heated.pieces[piece_at(heated.pieces, factors.stiffness, factors.end_stiffness, mean)];
    table_slope(piece.start, piece.start_value, piece.end, piece.end_value, &slope);
    softening_work(energy, property_at(heated.pieces, factors.stiffness, factors.end_stiffness, mean), slope, &work);
    return work;
}
#endif

// The velocities of the end of the step, as well as they are known.
DEVICE Sphere settled(Sphere sphere, const Vec3 kick, const Vec3 twist)
{
    sphere.velocity = plus(sphere.velocity, kick);
    sphere.angular_velocity = plus(sphere.angular_velocity, twist);
    return sphere;
}

// An end of a bond, without its motion where the law does not look at it.
#if BOND_DASHPOTS || BONDS_REMEMBER
#define BONDED_SPHERE(x, i)  sphere(x, LOAD(motion, i), LOAD(spin, i))
#else
#define BONDED_SPHERE(x, i)  sphere(x, QUAD(0.0, 0.0, 0.0, 0.0), QUAD(0.0, 0.0, 0.0, 0.0))
#endif

// Energy that leaves with a bond, less that of the contact that begins.
DEVICE real energy_of_breakage(const Step step, const Sphere first, const Sphere second, const Vec3 offset,
                               const Modes load, const Bond bond, const Interaction pair)
{
    real energy;
    bond_release(first, second, offset, load, bond, step.history_dt, step.lead, &energy);
#if BONDS_KEEP_OFF
    Touch touch;
    touch_of_spheres(offset, first.radius + second.radius, &touch);
    if (touch.overlap > 0.0) {
        real begun;
        contact_begun(first, second, touch, pair, step.history_dt, step.lead, &begun);
        energy -= begun;
    }
#endif
    return energy;
}

// A bond that broke no longer keeps contact off: in the row of one of its particles.
DEVICE void let_touch(const u32 i, const u32 j, GLOBAL const u32 *RESTRICT slice, GLOBAL u32 *RESTRICT other)
{
#if BONDS_KEEP_OFF
    for (u32 c = slice[i / SLICE]; c < slice[i / SLICE + 1u]; ++c)
        if (other[SLOT(c, i)] == (j | BONDED))
            other[SLOT(c, i)] = j;
#endif
}

#if CONTACTS_BESIDE_BONDS
// Whether a bond holds between two particles: then it alone conducts.
DEVICE int beside_bond(const Step step, const u32 i, const u32 j, GLOBAL const u32 *bond_other)
{
    for (u32 k = 0; k < step.bond_slots; ++k)
        if (bond_other[BOND_SLOT(k, i)] == (j | HOLDS))
            return 1;
    return 0;
}
#endif

#if BONDS_APART
// Each bond is evaluated once, by a kernel of its own; what it does to its particles stands in `reaction`: the moment on
// the first, the force on the first, the moment on the second, and in `bond_flow` the heat rate into the first, zeros once
// it is broken. Rows hold the place of each bond
// in the table, with a bit where the particle is the second, or NOBODY behind the last.
#define SECOND                0x80000000u
#define BOND_HISTORY(c, b)    ((size_t)(c) * step.bonds + (b))

DEVICE void sum_reactions(const Step step, const u32 i, GLOBAL const u32 *RESTRICT bond_number,
                          GLOBAL const Vec3 *RESTRICT reaction, GLOBAL const real *RESTRICT bond_flow, Heat *heat,
#if LEDGER && BOND_DASHPOTS
                          GLOBAL const real *RESTRICT bond_lost, Quad *account,
#endif
#if EXPANSION_WORK
                          GLOBAL const real *RESTRICT bond_work,
#endif
                          Vec3 *force, Vec3 *moment)
{
    Vec3 f = zero(), m = zero();
#if LEDGER && BOND_DASHPOTS
    real damping = 0.0;
#endif
    u32 next = step.bond_slots ? bond_number[BOND_SLOT(0, i)] : NOBODY;
    for (u32 k = 0; next != NOBODY; ++k) {
        const u32 entry = next;
        next = k + 1u < step.bond_slots ? bond_number[BOND_SLOT(k + 1u, i)] : NOBODY;
        const size_t at = 3u * (size_t)(entry & ~SECOND);
        if (entry & SECOND) {
            f = minus(f, reaction[at + 1u]);
            m = plus(m, reaction[at + 2u]);
#if HEAT
            heat->bonds -= bond_flow[entry & ~SECOND];
#endif
#if MAKES_HEAT && BOND_DASHPOTS
            heat->made_by_bonds += half_of_heat(step, 0.0, bond_lost[entry & ~SECOND]);
#endif
#if EXPANSION_WORK
            heat->work_of_bonds += bond_work[2u * (size_t)(entry & ~SECOND) + 1u];
#endif
        } else {
            f = plus(f, reaction[at + 1u]);
            m = plus(m, reaction[at]);
#if HEAT
            heat->bonds += bond_flow[entry];
#endif
#if LEDGER && BOND_DASHPOTS
            damping += bond_lost[entry];
#endif
#if MAKES_HEAT && BOND_DASHPOTS
            heat->made_by_bonds += half_of_heat(step, 0.0, bond_lost[entry]);
#endif
#if EXPANSION_WORK
            heat->work_of_bonds += bond_work[2u * (size_t)entry];
#endif
        }
    }
#if LEDGER && BOND_DASHPOTS
    account->y += damping;
#endif
    *force = f;
    *moment = m;
}

#if BONDS_REMEMBER
DEVICE Vec3 remembered_vector(const Step step, GLOBAL const real *RESTRICT history, const u32 c, const u32 b)
{
    Vec3 v;
    v.x = history[BOND_HISTORY(c, b)];
    v.y = history[BOND_HISTORY(c + 1u, b)];
    v.z = history[BOND_HISTORY(c + 2u, b)];
    return v;
}

DEVICE void remember_vector(const Step step, GLOBAL real *RESTRICT history, const u32 c, const u32 b, const Vec3 v)
{
    history[BOND_HISTORY(c, b)] = v.x;
    history[BOND_HISTORY(c + 1u, b)] = v.y;
    history[BOND_HISTORY(c + 2u, b)] = v.z;
}

DEVICE History history_of(const Step step, GLOBAL const real *RESTRICT history, const u32 b)
{
    History earlier;
    earlier.normal = remembered_vector(step, history, 0, b);
    earlier.tension = history[BOND_HISTORY(3, b)];
    earlier.shear = remembered_vector(step, history, 4, b);
    earlier.couple = remembered_vector(step, history, 7, b);
    return earlier;
}

DEVICE void remember(const Step step, GLOBAL real *RESTRICT history, const u32 b, const History now)
{
    remember_vector(step, history, 0, b, now.normal);
    history[BOND_HISTORY(3, b)] = now.tension;
    remember_vector(step, history, 4, b, now.shear);
    remember_vector(step, history, 7, b, now.couple);
}
#endif

// One side of a bond that broke lets go.
DEVICE void let_go(const Step step, const u32 i, const u32 j, GLOBAL u32 *RESTRICT bond_other,
                   GLOBAL const u32 *RESTRICT slice, GLOBAL u32 *RESTRICT other)
{
    for (u32 k = 0; k < step.bond_slots; ++k)
        if (bond_other[BOND_SLOT(k, i)] == (j | HOLDS))
            bond_other[BOND_SLOT(k, i)] = j;
    let_touch(i, j, slice, other);
}
#endif

kernel bond
{
#if BONDS_APART
    const u32 flags = halted(step, status);
    if (!flags) {
        FOR_EACH(b, step.bonds) {
            const u32 entry = bond_ends[2u * b];
            if (!(entry & HOLDS))
                continue;
            const u32 i = entry & ~HOLDS, j = bond_ends[2u * b + 1u];
            const Quad x = LOAD(place, i), y = LOAD(place, j);
            Sphere first = BONDED_SPHERE(x, i), second = BONDED_SPHERE(y, j);
            const Vec3 offset = offset_between(step, first.position, second.position);
            Heated heated;
            heated.temperature = temperature;
            heated.reference_radius = reference_radius;
            heated.thermals = thermals;
            heated.conductors = conductors;
            heated.links = links;
            heated.exposure = exposure;
            heated.exposures = exposures;
            heated.conductivities = conductivities;
            heated.factors = factors;
            heated.pieces = pieces;
            const Sphere bonded_first = as_bonded(first, i, heated), bonded_second = as_bonded(second, j, heated);
            const real mine = TEMPERATURE_AT(i, LOAD(spin, i)), theirs = TEMPERATURE_AT(j, LOAD(spin, j));
            Reaction acting;
#if BONDS_REMEMBER
            const real bonded_length = bond_length[b];
#else
            Posture posture;
            posture.bonded_offset = offset_between(step, vector(LOAD(bonded_place, i)), vector(LOAD(bonded_place, j)));
            posture.first_orientation = quaternion(LOAD(orientation, i));
            posture.second_orientation = quaternion(LOAD(orientation, j));
            posture.free_strain = 0.0;
            const real bonded_length = LENGTH_OF(posture.bonded_offset);
#endif
            Bond numbers = bond_of(step, i, j, bonded_first, bonded_second, bonded_length, kind, joints, beams);
#if HEAT
            const Link link = link_of(step, i, j, bonded_first, bonded_second, kind, heated);
            const real flow = through_bond(link, bonded_length, MATERIAL_OF(kind[i]), MATERIAL_OF(kind[j]), mine, theirs,
                                           heated);
#if EXPANDS
            posture.free_strain = strain_of(step, link, mine, theirs);
#endif
#endif
#if SCATTERED_BONDS
            numbers.tensile_strength *= bond_strength[b];
            numbers.shear_strength *= bond_strength[b];
#endif
#if BOND_TABLES
            numbers = bond_at(step, numbers, MATERIAL_OF(kind[i]), MATERIAL_OF(kind[j]), mine, theirs, heated);
#endif
#if BONDS_REMEMBER
            Advance advance;
            advance.earlier = history_of(step, bond_history, b);
            bond_rest(bonded_length, 0.0, 0.0, &advance.rest);
            advance.dt = step.history_dt;
            History now;
            bond_incremental(first, second, offset, advance, numbers, step.lead, &now, &acting);
#else
            bond_total(first, second, offset, posture, numbers, step.lead, &acting);
#endif
            // While a fresh state is prepared nothing breaks.
            const int breaks = acting.failure > 0.0 && step.history_dt > 0.0;
            if (breaks) {
                first = sphere(x, motion[i], spin[i]);
                second = sphere(y, motion[j], spin[j]);
                broken[b] = step.number | (u32)acting.failure << FAILURE_BITS;
                released[b] = energy_of_breakage(step, first, second, offset, acting.load, numbers,
                                                 INTERACTION(MATERIAL_OF(kind[i]), MATERIAL_OF(kind[j])));
                bond_ends[2u * b] = i;
                let_go(step, i, j, bond_other, slice, other);
                let_go(step, j, i, bond_other, slice, other);
#if BONDS_REMEMBER
                now.normal = now.shear = now.couple = zero();
                now.tension = 0.0;
#endif
                acting.force = acting.first_moment = acting.second_moment = zero();
            }
#if BONDS_REMEMBER
            remember(step, bond_history, b, now);
#endif
            reaction[3u * (size_t)b] = acting.first_moment;
            reaction[3u * (size_t)b + 1u] = acting.force;
            reaction[3u * (size_t)b + 2u] = acting.second_moment;
#if HEAT
            bond_flow[b] = breaks ? 0.0 : flow;
#endif
#if EXPANSION_WORK
            real work, work_of_second;
            expansion_work_of_bond(link.first_growth, acting.load.normal, bonded_length, &work);
            expansion_work_of_bond(link.second_growth, acting.load.normal, bonded_length, &work_of_second);
#if SOFTENING_WORK
            const real softening = softening_of(step, acting.load, numbers, MATERIAL_OF(kind[i]), MATERIAL_OF(kind[j]),
                                                mine, theirs, heated);
            work += softening;
            work_of_second += softening;
#endif
            bond_work[2u * (size_t)b] = breaks ? 0.0 : work;
            bond_work[2u * (size_t)b + 1u] = breaks ? 0.0 : work_of_second;
#endif
#if LEDGER && BOND_DASHPOTS
            real loss = 0.0;
#if GEAR
            if (!breaks)
                bond_loss(first, second, first, second, offset, numbers, step.history_dt, step.lead, &loss);
#else
            if (!breaks)
                bond_loss(first, second, settled(first, vector(kick_by_half[i]), vector(twist_by_half[i])),
                          settled(second, vector(kick_by_half[j]), vector(twist_by_half[j])), offset, numbers,
                          step.history_dt, step.lead, &loss);
#endif
            bond_lost[b] = loss;
#endif
        }
    }
    hand_on(step, status, flags, 0u);
#endif
}

#if !BONDS_APART
// The law of one bond as seen from particle i, the heat rate that goes through it into i, and what its spring gains per
// kelvin of i.
DEVICE Reaction evaluate_bond(const Step step, const u32 i, const u32 j, const u32 k, const Sphere body,
                              const Sphere partner, const Vec3 offset, Posture posture,
                              GLOBAL const Quad *RESTRICT orientation, GLOBAL const Quad *RESTRICT bonded_place,
                              GLOBAL const u32 *RESTRICT kind, GLOBAL const Joint *RESTRICT joints,
                              GLOBAL const Bond *RESTRICT beams, GLOBAL const real *RESTRICT bond_strength,
                              const Vec3 bonded, const Heated heated, const real temperature, const real theirs, Bond *numbers,
                              real *flow, real *work)
{
    posture.bonded_offset = offset_between(step, bonded, vector(LOAD(bonded_place, j)));
    posture.second_orientation = quaternion(LOAD(orientation, j));
    const Sphere first = as_bonded(body, i, heated), second = as_bonded(partner, j, heated);
    const real bonded_length = LENGTH_OF(posture.bonded_offset);
    *numbers = bond_of(step, i, j, first, second, bonded_length, kind, joints, beams);
#if HEAT
    const Link link = link_of(step, i, j, first, second, kind, heated);
    *flow = through_bond(link, bonded_length, MATERIAL_OF(kind[i]), MATERIAL_OF(kind[j]), temperature, theirs, heated);
#if EXPANDS
    posture.free_strain = strain_of(step, link, temperature, theirs);
#endif
#endif
#if SCATTERED_BONDS
    numbers->tensile_strength *= bond_strength[BOND_SLOT(k, i)];
    numbers->shear_strength *= bond_strength[BOND_SLOT(k, i)];
#endif
#if BOND_TABLES
    *numbers = bond_at(step, *numbers, MATERIAL_OF(kind[i]), MATERIAL_OF(kind[j]), temperature, theirs, heated);
#endif
    Reaction acting;
    bond_total(body, partner, offset, posture, *numbers, step.lead, &acting);
#if EXPANSION_WORK
    expansion_work_of_bond(link.first_growth, acting.load.normal, bonded_length, work);
#endif
#if SOFTENING_WORK
    *work += softening_of(step, acting.load, *numbers, MATERIAL_OF(kind[i]), MATERIAL_OF(kind[j]), temperature, theirs,
                          heated);
#endif
    return acting;
}

// What the bonds of a particle do to it. Both particles of a bond see it fail; the one of lower rank writes it down.
DEVICE void sum_bonds(const Step step, const u32 i, const Sphere body, GLOBAL const Quad *RESTRICT place,
                      GLOBAL const Quad *RESTRICT motion, GLOBAL const Quad *RESTRICT spin,
                      GLOBAL const Quad *RESTRICT orientation, GLOBAL const Quad *RESTRICT bonded_place,
                      GLOBAL const u32 *RESTRICT kind, GLOBAL const u32 *RESTRICT rank,
                      GLOBAL const Interaction *RESTRICT interactions, GLOBAL const Joint *RESTRICT joints,
                      GLOBAL const Bond *RESTRICT beams, GLOBAL const u32 *RESTRICT slice, GLOBAL u32 *RESTRICT other,
                      GLOBAL u32 *RESTRICT bond_other, GLOBAL const u32 *RESTRICT bond_start,
                      GLOBAL const real *RESTRICT bond_strength, GLOBAL u32 *RESTRICT broken,
                      GLOBAL real *RESTRICT released, const Heated heated, Heat *heat,
#if LEDGER
                      GLOBAL const Quad *RESTRICT kick_by_half, GLOBAL const Quad *RESTRICT twist_by_half, Quad *account,
#endif
                      Vec3 *force, Vec3 *moment)
{
    Vec3 f = zero(), m = zero();
    const Vec3 bonded = vector(LOAD(bonded_place, i));
    Posture posture;
    posture.first_orientation = quaternion(LOAD(orientation, i));
    posture.free_strain = 0.0;
#if LEDGER && BOND_DASHPOTS
    const u32 my_rank = rank[i];
    real damping = 0.0;
#endif
    int breaks = 0;
    // A slot is read while the one before it is worked on.
    u32 next = step.bond_slots ? bond_other[BOND_SLOT(0, i)] : NOBODY;
    for (u32 k = 0; next != NOBODY; ++k) {
        const u32 entry = next;
        next = k + 1u < step.bond_slots ? bond_other[BOND_SLOT(k + 1u, i)] : NOBODY;
        if (!(entry & HOLDS))
            continue;
        const u32 j = entry & ~HOLDS;
        const Quad x = LOAD(place, j);
        const real theirs = TEMPERATURE_AT(j, LOAD(spin, j));
        Sphere partner = BONDED_SPHERE(x, j);
        partner.radius = RADIUS_OF_PARTNER(x);
        const Vec3 offset = offset_between(step, body.position, vector(x));
        Bond numbers;
        real flow, work;
        const Reaction acting = evaluate_bond(step, i, j, k, body, partner, offset, posture, orientation, bonded_place,
                                              kind, joints, beams, bond_strength, bonded, heated, heat->temperature, theirs,
                                              &numbers, &flow, &work);
#if HEAT
        // Added before it is known whether the bond holds, so that nothing is kept meanwhile.
        heat->bonds += flow;
#endif
        // While a fresh state is prepared nothing breaks.
        if (acting.failure > 0.0 && step.history_dt > 0.0) {
            breaks = 1;
            continue;
        }
        f = plus(f, acting.force);
        m = plus(m, acting.first_moment);
#if EXPANSION_WORK
        heat->work_of_bonds += work;
#endif
#if LEDGER && BOND_DASHPOTS
        if (MAKES_HEAT || my_rank < rank[j]) {
            real loss;
#if GEAR
            bond_loss(body, partner, body, partner, offset, numbers, step.history_dt, step.lead, &loss);
#else
            bond_loss(body, partner, settled(body, vector(kick_by_half[i]), vector(twist_by_half[i])),
                      settled(partner, vector(kick_by_half[j]), vector(twist_by_half[j])), offset, numbers,
                      step.history_dt, step.lead, &loss);
#endif
#if MAKES_HEAT
            heat->made_by_bonds += half_of_heat(step, 0.0, loss);
            damping += my_rank < rank[j] ? loss : 0.0;
#else
            damping += loss;
#endif
        }
#endif
    }
#if LEDGER && BOND_DASHPOTS
    account->y += damping;
#endif
    *force = f;
    *moment = m;
    if (!breaks)
        return;
    // Bonds seldom break. Which ones did is found out by evaluating them once more: kept out of the loop above, this costs
    // it no registers. What goes through the others is summed anew.
    heat->bonds = 0.0;
    for (u32 k = 0; k < step.bond_slots; ++k) {
        const u32 entry = bond_other[BOND_SLOT(k, i)];
        if (entry == NOBODY || !(entry & HOLDS))
            continue;
        const u32 j = entry & ~HOLDS;
        const Sphere partner = sphere(place[j], motion[j], spin[j]);
        const real theirs = TEMPERATURE_AT(j, LOAD(spin, j));
        const Vec3 offset = offset_between(step, body.position, partner.position);
        Bond numbers;
        real flow, work;
        const Reaction acting = evaluate_bond(step, i, j, k, body, partner, offset, posture, orientation, bonded_place,
                                              kind, joints, beams, bond_strength, bonded, heated, heat->temperature, theirs,
                                              &numbers, &flow, &work);
        if (!(acting.failure > 0.0)) {
#if HEAT
            heat->bonds += flow;
#endif
            continue;
        }
        bond_other[BOND_SLOT(k, i)] = j;
        let_touch(i, j, slice, other);
        if (rank[i] < rank[j]) {
            const u32 at = bond_start[rank[i]] + k;
            broken[at] = step.number | (u32)acting.failure << FAILURE_BITS;
            released[at] = energy_of_breakage(step, body, partner, offset, acting.load, numbers,
                                              INTERACTION(MATERIAL_OF(kind[i]), MATERIAL_OF(kind[j])));
        }
    }
}
#endif

// Rows in a new order: from the order before, into a room for some of the planes, and back from it.
kernel take_bonds
{
    FOR_EACH(i, particles) {
        const u32 source = order[i];
        for (u32 k = 0; k < planes; ++k) {
            const u32 entry = bond_other[(size_t)(first + k) * particles + source];
            room[(size_t)k * particles + i] =
                entry == NOBODY ? NOBODY : (entry & HOLDS) | index_of[entry & ~HOLDS];
        }
    }
}

kernel put_bonds
{
    FOR_EACH(i, particles) {
        for (u32 k = 0; k < planes; ++k)
            bond_other[(size_t)(first + k) * particles + i] = room[(size_t)k * particles + i];
    }
}

// The places of bonds in the table go along.
kernel take_numbers
{
    FOR_EACH(i, particles) {
        const u32 source = order[i];
        for (u32 k = 0; k < planes; ++k)
            room[(size_t)k * particles + i] = bond_number[(size_t)(first + k) * particles + source];
    }
}

// Bonds find their particles where they are now.
kernel follow_ends
{
    FOR_EACH(e, count) {
        bond_ends[e] = (bond_ends[e] & HOLDS) | index_of[bond_ends[e] & ~HOLDS];
    }
}

kernel invert_order
{
    FOR_EACH(i, particles) {
        index_of[order[i]] = i;
    }
}

// Factors on strengths, in the same way.
kernel take_strengths
{
    FOR_EACH(i, particles) {
        const u32 source = order[i];
        for (u32 k = 0; k < planes; ++k)
            room[(size_t)k * particles + i] = strength[(size_t)(first + k) * particles + source];
    }
}

kernel put_strengths
{
    FOR_EACH(i, particles) {
        for (u32 k = 0; k < planes; ++k)
            strength[(size_t)(first + k) * particles + i] = room[(size_t)k * particles + i];
    }
}
#endif

#if LOCAL_DAMPING
// Local damping of the components that forces govern; the power that it takes, W.
DEVICE real damp_one(const Step step, const Vec3 velocity, const Vec3 kick, const u32 held, Vec3 *force)
{
    const Vec3 whole = *force;
    Vec3 damped;
    local_damping(whole, velocity, step.local_damping, &damped);
    *force = prescribe(damped, whole, held);
    return inner(minus(whole, *force), plus(velocity, kick));
}

DEVICE real damp_locally(const Step step, const Sphere body, const Constraint held, const Vec3 kick, const Vec3 twist,
                         Vec3 *force, Vec3 *moment)
{
    const real taken = damp_one(step, body.velocity, kick, held.components, force);
    return taken + damp_one(step, body.angular_velocity, twist, held.components >> 3, moment);
}
#endif
