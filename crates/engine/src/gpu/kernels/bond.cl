// Stage `bond`: forces and moments of bonded pairs, and which of them break.
#if BONDS

// Rows of bonds, in planes of one bond of each particle: higher ranks first, then lower ones. A slot holds the other
// particle, with a bit while the bond holds, or NOBODY behind the last.
#define HOLDS               0x80000000u
#define BOND_SLOT(k, i)     ((size_t)(k) * step.particles + (i))
#define FAILURE_BITS        30u

DEVICE Bond bond_of(const Step step, const u32 i, const u32 j, const real radius, const real other_radius,
                    const Vec3 bonded_offset, GLOBAL const u32 *RESTRICT kind, GLOBAL const Joint *RESTRICT joints)
{
#if ALIKE_BONDS
    return step.bond;
#else
    Bond bond;
    bond_between(joints[MATERIAL_OF(kind[i]) * step.materials + MATERIAL_OF(kind[j])], radius, other_radius,
                 sqrt(inner(bonded_offset, bonded_offset)), 1.0, &bond);
    return bond;
#endif
}

// The velocities of the end of the step, as well as they are known.
DEVICE Sphere settled(Sphere sphere, const Vec3 kick, const Vec3 twist)
{
    sphere.velocity = plus(sphere.velocity, kick);
    sphere.angular_velocity = plus(sphere.angular_velocity, twist);
    return sphere;
}

// What the bonds of a particle do to it. Both particles of a bond see it fail; the one of lower rank writes it down.
DEVICE void sum_bonds(const Step step, const u32 i, const Sphere body, GLOBAL const Quad *RESTRICT place,
                      GLOBAL const Quad *RESTRICT motion, GLOBAL const Quad *RESTRICT spin,
                      GLOBAL const Quad *RESTRICT orientation, GLOBAL const Quad *RESTRICT bonded_place,
                      GLOBAL const u32 *RESTRICT kind, GLOBAL const u32 *RESTRICT rank,
                      GLOBAL const Interaction *RESTRICT interactions, GLOBAL const Joint *RESTRICT joints,
                      GLOBAL const u32 *RESTRICT slice, GLOBAL u32 *RESTRICT other,
                      GLOBAL u32 *RESTRICT bond_other, GLOBAL const u32 *RESTRICT bond_start,
                      GLOBAL const real *RESTRICT bond_strength, GLOBAL u32 *RESTRICT broken,
                      GLOBAL real *RESTRICT released,
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
    for (u32 k = 0; k < step.bond_slots; ++k) {
        const u32 entry = bond_other[BOND_SLOT(k, i)];
        if (entry == NOBODY)
            break;
        if (!(entry & HOLDS))
            continue;
        const u32 j = entry & ~HOLDS;
        const Quad x = LOAD(place, j);
#if BOND_DASHPOTS
        Sphere partner = sphere(x, LOAD(motion, j), LOAD(spin, j));
#else
        Sphere partner = sphere(x, QUAD(0.0, 0.0, 0.0, 0.0), QUAD(0.0, 0.0, 0.0, 0.0));
#endif
        partner.radius = RADIUS_OF_PARTNER(x);
        const Vec3 offset = offset_between(step, body.position, vector(x));
        posture.bonded_offset = offset_between(step, bonded, vector(LOAD(bonded_place, j)));
        posture.second_orientation = quaternion(LOAD(orientation, j));
        Bond bond = bond_of(step, i, j, body.radius, partner.radius, posture.bonded_offset, kind, joints);
#if SCATTERED_BONDS
        bond.tensile_strength *= bond_strength[BOND_SLOT(k, i)];
        bond.shear_strength *= bond_strength[BOND_SLOT(k, i)];
#endif
        Reaction reaction;
        bond_total(body, partner, offset, posture, bond, &reaction);
        // While a fresh state is prepared nothing breaks.
        if (reaction.failure > 0.0 && step.history_dt > 0.0) {
            bond_other[BOND_SLOT(k, i)] = j;
#if BONDS_KEEP_OFF
            for (u32 c = slice[i / SLICE]; c < slice[i / SLICE + 1u]; ++c)
                if (other[SLOT(c, i)] == (j | BONDED))
                    other[SLOT(c, i)] = j;
#endif
            if (rank[i] < rank[j]) {
                partner = sphere(x, motion[j], spin[j]);
                real energy;
                bond_release(body, partner, offset, reaction.load, bond, step.history_dt, &energy);
#if BONDS_KEEP_OFF
                Touch touch;
                touch_of_spheres(offset, body.radius + partner.radius, &touch);
                if (touch.overlap > 0.0) {
                    real begun;
                    contact_begun(body, partner, touch, INTERACTION(MATERIAL_OF(kind[i]), MATERIAL_OF(kind[j])),
                                  step.history_dt, &begun);
                    energy -= begun;
                }
#endif
                const u32 at = bond_start[rank[i]] + k;
                broken[at] = step.number | (u32)reaction.failure << FAILURE_BITS;
                released[at] = energy;
            }
            continue;
        }
        f = plus(f, reaction.force);
        m = plus(m, reaction.first_moment);
#if LEDGER && BOND_DASHPOTS
        if (my_rank < rank[j]) {
            real loss;
#if GEAR
            bond_loss(body, partner, body, partner, offset, bond, step.history_dt, &loss);
#else
            bond_loss(body, partner, settled(body, vector(kick_by_half[i]), vector(twist_by_half[i])),
                      settled(partner, vector(kick_by_half[j]), vector(twist_by_half[j])), offset, bond,
                      step.history_dt, &loss);
#endif
            damping += loss;
        }
#endif
    }
#if LEDGER && BOND_DASHPOTS
    account->y += damping;
#endif
    *force = f;
    *moment = m;
}

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
