// Stages `contact`, `gather` and `boundary`: forces and moments of touching pairs, walls, gravity, applied forces.

#if HEAT_THROUGH_CONTACTS && BONDS_KEEP_OFF
// What a particle that touches others or walls conducts. Where bonds keep contact off, few do: kept out of the loop over
// contacts, this costs it no registers.
DEVICE void conduct_through_contacts(const Step step, const u32 i, const Sphere body, const u32 material,
                                     GLOBAL const Quad *RESTRICT place, GLOBAL const Quad *RESTRICT spin,
                                     GLOBAL const u32 *RESTRICT kind,
                                     GLOBAL const u32 *RESTRICT slice, GLOBAL const u32 *other,
                                     GLOBAL const Wall *RESTRICT walls, GLOBAL const Quad *RESTRICT wall_place,
                                     const Heated heated, Heat *heat)
{
    for (u32 k = slice[i / SLICE]; k < slice[i / SLICE + 1u]; ++k) {
        const u32 entry = other[SLOT(k, i)], j = entry & ~TOUCHING;
        if (!(entry & TOUCHING))
            continue;
        Touch touch;
        if (j < step.particles) {
            const Quad x = LOAD(place, j);
            const real radius = RADIUS_OF_PARTNER(x);
            touch_of_spheres(offset_between(step, body.position, vector(x)), body.radius + radius, &touch);
            heat->contacts += from_partner(step, body, radius, touch, material, MATERIAL_OF(kind[j]),
                                           TEMPERATURE_AT(j, LOAD(spin, j)), *heat, heated);
        } else {
            const Wall wall = walls[j - step.particles];
            touch_of_wall(body.position, body.radius, vector(wall_place[j - step.particles]), wall.normal, &touch);
            if (wall.first_piece < wall.end_piece)
                heat->foreign += from_wall(step, wall, body, touch, material, *heat, heated);
        }
    }
}
#endif

// What a particle feels. The row's order is the order of the sum: higher ranks, lower ranks, walls.
DEVICE u32 sum_contacts(const Step step, const u32 i, const Sphere body, const u32 material,
                        GLOBAL const Quad *RESTRICT place, GLOBAL const Quad *RESTRICT motion,
                        GLOBAL const Quad *RESTRICT spin, GLOBAL const u32 *RESTRICT kind,
                        GLOBAL const Interaction *RESTRICT interactions, GLOBAL const u32 *RESTRICT slice,
                        GLOBAL u32 *RESTRICT other, GLOBAL real *RESTRICT displacement,
                        GLOBAL const Wall *RESTRICT walls, GLOBAL const Quad *RESTRICT wall_place,
                        const Heated heated, Heat *heat,
#if LEDGER
                        GLOBAL const Quad *RESTRICT kick_by_half, GLOBAL const Quad *RESTRICT twist_by_half,
                        GLOBAL const u32 *RESTRICT rank, Quad *account,
#endif
                        const Vec3 bond_force, const Vec3 bond_moment, Vec3 *force, Vec3 *moment)
{
    u32 flags = 0;
    int touches = 0;
    Vec3 f = zero(), m = zero();
    const u32 end = slice[i / SLICE + 1u];
    u32 k = slice[i / SLICE];
#if LEDGER
    const u32 my_rank = rank[i];
    Vec3 my_kick = zero(), my_twist = zero();
#if !GEAR
    my_kick = vector(kick_by_half[i]);
#if MOMENTS
    my_twist = vector(twist_by_half[i]);
#endif
#endif
    real friction = 0.0, damping = 0.0, stiffening = 0.0, released = 0.0;
#endif
    for (; k < end; ++k) {
        const u32 entry = other[SLOT(k, i)];
#if BONDS_KEEP_OFF
        if (entry & BONDED)
            continue;
#endif
        const u32 j = entry & ~TOUCHING;
        if (j >= step.particles)
            break;
        const Quad x = LOAD(place, j);
#if FRICTION
        if (k + 1u < end)
            will_read_displacement(displacement, k + 1u, i);
#endif
        const real radius = RADIUS_OF_PARTNER(x);
        Touch touch;
        touch_of_spheres(offset_between(step, body.position, vector(x)), body.radius + radius, &touch);
        if (touch.overlap > 0.0) {
#if CONTACTS_BESIDE_BONDS
            if (!beside_bond(step, i, j, heated.bond_other))
#endif
#if HEAT_THROUGH_CONTACTS && !BONDS_KEEP_OFF
                heat->contacts += from_partner(step, body, radius, touch, material, MATERIAL_OF(kind[j]),
                                               TEMPERATURE_AT(j, LOAD(spin, j)), *heat, heated);
#endif
            const Quad v = LOAD(motion, j);
#if MOMENTS
            const Quad w = LOAD(spin, j);
#else
            const Quad w = QUAD(0.0, 0.0, 0.0, 0.0);
#endif
            Sphere partner = sphere(x, v, w);
            partner.radius = radius;
            partner.mass = MASS_OF_PARTNER(v);
            Vec3 kept = zero();
#if FRICTION
            if (entry & TOUCHING)
                kept = displacement_at(displacement, k, i);
#endif
            Response response;
            real arm;
            lever_arm(body.radius, touch.overlap, &arm);
#if LEDGER && !GEAR
            real partner_arm;
            lever_arm(radius, touch.overlap, &partner_arm);
            Kick mine, theirs;
            mine.velocity = my_kick;
            mine.rolling = times(my_twist, arm);
            theirs.velocity = vector(kick_by_half[j]);
#if MOMENTS
            theirs.rolling = times(vector(twist_by_half[j]), partner_arm);
#else
            theirs.rolling = zero();
#endif
            settled_contact_of_spheres(body, partner, touch, mine, theirs, kept,
                                       INTERACTION(material, MATERIAL_OF(kind[j])), step.history_dt, step.lead, &response);
#else
            contact_of_spheres(body, partner, touch, kept, INTERACTION(material, MATERIAL_OF(kind[j])),
                               step.history_dt, step.lead, &response);
#endif
            touches = 1;
            f = plus(f, response.force);
#if MOMENTS
            m = plus(m, times(response.moment_per_arm, arm));
#endif
#if FRICTION
            keep_displacement(displacement, k, i, step.frozen ? kept : response.displacement);
#endif
            if (!(entry & TOUCHING))
                other[SLOT(k, i)] = j | TOUCHING;
            if (touch.overlap > step.overlap_limit * (radius < body.radius ? radius : body.radius) && !BOTH_HELD(kind, i, j))
                flags |= CRUSHED;
#if MAKES_HEAT
            heat->made_at_contacts += half_of_heat(step, response.losses.friction, response.losses.damping);
#endif
#if EXPANSION_WORK
            real elastic;
            elastic_between_spheres(body.radius, radius, touch.overlap, INTERACTION(material, MATERIAL_OF(kind[j])),
                                    &elastic);
            heat->pressure_of_contacts += elastic;
#endif
#if LEDGER
            if (my_rank < rank[j]) {
                friction += response.losses.friction;
                damping += response.losses.damping;
                stiffening += response.losses.stiffening;
            }
#endif
        } else if (entry & TOUCHING) {
            other[SLOT(k, i)] = j;
#if LEDGER && FRICTION
            if (my_rank < rank[j]) {
                real energy;
                released_by_spheres(body, sphere(x, motion[j],
#if MOMENTS
                                                 spin[j]
#else
                                                 QUAD(0.0, 0.0, 0.0, 0.0)
#endif
                                                 ), touch, displacement_at(displacement, k, i),
                                    INTERACTION(material, MATERIAL_OF(kind[j])), step.history_dt, step.lead, &energy);
                released += energy;
            }
#endif
        }
    }
#if LEDGER
    account->x += friction;
    account->y += damping;
    account->z += stiffening - released;
#endif
    for (; k < end; ++k) {
        const u32 entry = other[SLOT(k, i)];
        const u32 j = entry & ~TOUCHING;
        if (j == NOBODY)
            break;
        const u32 w = j - step.particles;
        const Wall wall = walls[w];
        Touch touch;
        touch_of_wall(body.position, body.radius, vector(wall_place[w]), wall.normal, &touch);
        if (touch.overlap > 0.0) {
            Vec3 kept = zero();
#if FRICTION
            if (entry & TOUCHING)
                kept = displacement_at(displacement, k, i);
#endif
            Response response;
            real arm;
            lever_arm(body.radius, touch.overlap, &arm);
#if LEDGER && !GEAR
            Kick mine;
            mine.velocity = my_kick;
            mine.rolling = times(my_twist, arm);
            settled_contact_with_wall(body, touch, wall.normal, wall.velocity, mine, kept,
                                      INTERACTION(material, wall.material), step.history_dt, step.lead, &response);
#else
            contact_with_wall(body, touch, wall.normal, wall.velocity, kept, INTERACTION(material, wall.material),
                              step.history_dt, step.lead, &response);
#endif
            touches = 1;
            if (touch.overlap > step.overlap_limit * body.radius
                && !(BOTH_HELD(kind, i, i) && inner(wall.velocity, wall.velocity) == 0.0))
                flags |= CRUSHED;
            f = plus(f, response.force);
#if MOMENTS
            m = plus(m, times(response.moment_per_arm, arm));
#endif
#if HEAT_THROUGH_CONTACTS && !BONDS_KEEP_OFF
            if (wall.first_piece < wall.end_piece)
                heat->foreign += from_wall(step, wall, body, touch, material, *heat, heated);
#endif
#if MAKES_HEAT
            // A wall that has a temperature takes its half away.
            const real share = half_of_heat(step, response.losses.friction, response.losses.damping);
            heat->made_at_walls += wall.first_piece < wall.end_piece ? share : 2.0 * share;
#endif
#if EXPANSION_WORK
            real elastic;
            elastic_at_wall(body.radius, touch.overlap, INTERACTION(material, wall.material), &elastic);
            heat->pressure_of_walls += elastic;
#endif
#if FRICTION
            keep_displacement(displacement, k, i, step.frozen ? kept : response.displacement);
#endif
            if (!(entry & TOUCHING))
                other[SLOT(k, i)] = j | TOUCHING;
#if LEDGER
            account->x += response.losses.friction;
            account->y += response.losses.damping;
            account->z += response.losses.stiffening;
            account->w += inner(response.force, wall.velocity) * step.history_dt;
#endif
        } else if (entry & TOUCHING) {
            other[SLOT(k, i)] = j;
#if LEDGER && FRICTION
            real energy;
            released_by_wall(body, touch, wall.normal, wall.velocity, displacement_at(displacement, k, i),
                             INTERACTION(material, wall.material), step.history_dt, step.lead, &energy);
            account->z -= energy;
#endif
        }
    }
#if BONDS
    f = plus(f, bond_force);
    m = plus(m, bond_moment);
#endif
    *force = plus(f, times(step.gravity, body.mass));
    *moment = m;
#if HEAT_THROUGH_CONTACTS && BONDS_KEEP_OFF
    if (touches)
        conduct_through_contacts(step, i, body, material, place, spin, kind, slice, other, walls, wall_place, heated, heat);
#endif
    return flags;
}

#if LEDGER && CONSTRAINED
// Power of the forces on prescribed components, W.
DEVICE real power(const Vec3 force, const Vec3 given, const u32 held)
{
    return 0.0 + force.x * (held & 1u ? given.x : 0.0) + force.y * (held & 2u ? given.y : 0.0)
         + force.z * (held & 4u ? given.z : 0.0);
}

#if RAMPS
DEVICE real gain_of_square(const u32 held, const real before, const real now)
{
    return held ? (now - before) * (now + before) : 0.0;
}

// What prescribed components gained in kinetic energy since the step before, J.
DEVICE real gain(const real inertia, const Vec3 before, const Vec3 now, const u32 held)
{
    return 0.5 * inertia
         * (0.0 + gain_of_square(held & 1u, before.x, now.x) + gain_of_square(held & 2u, before.y, now.y)
            + gain_of_square(held & 4u, before.z, now.z));
}
#endif

// Work of prescribed motion and of applied forces in this step, booked.
DEVICE void book_external(const Step step, const Sphere body, const Vec3 f, const Vec3 m, const Constraint held,
                          const Constraint before, Quad *account)
{
    account->w -= power(f, held.velocity, held.components) * step.history_dt;
#if MOMENTS
    account->w -= power(m, held.angular_velocity, held.components >> 3) * step.history_dt;
#endif
#if RAMPS
    account->w += gain(body.mass, before.velocity, held.velocity, held.components);
#if MOMENTS
    real inertia;
    sphere_inertia(body.mass, body.radius, &inertia);
    account->w += gain(inertia, before.angular_velocity, held.angular_velocity, held.components >> 3);
#endif
#endif
#if APPLIED_FORCES
    account->w += inner(times(plus(before.force, held.force), 0.5), body.velocity) * step.history_dt;
#endif
}
#endif

kernel contact
{
    const u32 flags = halted(step, status);
    if (!flags) {
        FOR_EACH(i, step.particles) {
#if MOMENTS
            const Quad turning = LOAD(spin, i);
#else
            const Quad turning = QUAD(0.0, 0.0, 0.0, 0.0);
#endif
            const Sphere body = sphere(LOAD(place, i), LOAD(motion, i), turning);
            Heated heated;
            LOOK_UP(heated);
            Heat heat = heat_at(TEMPERATURE_AT(i, turning));
            Vec3 f, m, bond_force = zero(), bond_moment = zero();
#if LEDGER
            Quad account = accounts[i];
#endif
#if BONDS_APART
            sum_reactions(step, i, bond_number, reaction, bond_flow, &heat,
#if LEDGER && BOND_DASHPOTS
                          bond_lost, &account,
#endif
#if EXPANSION_WORK
                          bond_work,
#endif
                          &bond_force, &bond_moment);
#elif BONDS
            sum_bonds(step, i, body, place, motion, spin, orientation, bonded_place, kind, rank, interactions, joints, beams,
                      slice, other, bond_other, bond_start, bond_strength, broken, released, heated, &heat,
#if LEDGER
                      kick_by_half, twist_by_half, &account,
#endif
                      &bond_force, &bond_moment);
#endif
            const u32 wrong = sum_contacts(step, i, body, MATERIAL_OF(kind[i]), place, motion, spin, kind, interactions,
                                           slice, other, displacement, walls, wall_place, heated, &heat,
#if LEDGER
                                           kick_by_half, twist_by_half, rank, &account,
#endif
                                           bond_force, bond_moment, &f, &m);
            if (wrong)
                raise_flags(step, status, wrong);
#if APPLIED_FORCES || CONSTRAINED && (LEDGER || LOCAL_DAMPING)
            const Constraint held = HELD(kind[i], step.time);
#elif LOCAL_DAMPING
            const Constraint held = free_of_constraints();
#endif
#if APPLIED_FORCES
            f = plus(f, held.force);
#endif
#if LOCAL_DAMPING
            Vec3 kick = zero(), twist = zero();
#if LEDGER && !GEAR
            kick = vector(kick_by_half[i]);
            twist = vector(twist_by_half[i]);
#endif
            const real taken = damp_locally(step, body, held, kick, twist, &f, &m);
#if LEDGER
            account.y += taken * step.history_dt;
#endif
#endif
#if LEDGER
#if CONSTRAINED
            if (CONSTRAINT_OF(kind[i]))
                book_external(step, body, f, m, held, HELD(kind[i], step.former_time), &account);
#endif
            if (!step.frozen)
                accounts[i] = account;
#endif
            force[i] = quad(f, heat_rate_of(step, i, MATERIAL_OF(kind[i]), &heat, heated));
#if EXPANSION_WORK
            const real work = work_per_kelvin_of(i, MATERIAL_OF(kind[i]), heat, heated);
            work_per_kelvin[i] = work;
            if (!step.frozen)
                book_expansion(i, work, warming[i], heat_accounts);
#endif
#if HEAT && LEDGER
            if (!step.frozen)
                book_heat(i, heat.foreign * step.heat_dt, heat_accounts);
#endif
#if MAKES_HEAT
            if (!step.frozen)
                heat_accounts[i].z += made_heat(heat);
#endif
#if MOMENTS
            moment[i] = quad(m, 0.0);
#endif
        }
    }
    hand_on(step, status, flags, 1u);
}
